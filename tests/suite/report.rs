//! The page of a comparison, its metrics and its worst places.

use std::fs;
use std::process::Command;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use tempfile::tempdir;
use trueray::compare::{BySphere, Metrics, OnSphere, heatmap, worst_places};
use trueray::film::{Leniency, Picture, decode};
use trueray::settings::Settings;

use super::support::{Case, scene_of};

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
    let rgb = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)).collect();
    Picture::new(width, height, rgb).unwrap()
}

fn metrics(a: &Picture, b: &Picture) -> Metrics {
    Metrics::between(a, b).unwrap()
}

#[test]
fn rmse_psnr_and_percentiles_are_those_by_hand() {
    // Of 300 samples one is off by 30, two by 10 and the others by 0.
    let a = picture(10, 10, |_, _| [50; 3]);
    let b = picture(10, 10, |x, y| match (x, y) {
        (3, 4) => [80, 50, 40],
        (9, 9) => [50, 60, 50],
        _ => [50; 3],
    });
    let found = metrics(&a, &b);
    let rmse = (1100.0_f64 / 300.0).sqrt();
    assert!((found.rmse - rmse).abs() < 1e-12 && (found.psnr - 20.0 * (255.0 / rmse).log10()).abs() < 1e-12);
    assert_eq!((found.level_p50, found.level_p95, found.level_p99, found.level_max), (0, 0, 10, 30));
    assert_eq!(found.ssim, None, "no window fits");
    let same = metrics(&a, &a);
    assert!(same.rmse == 0.0 && same.psnr == f64::INFINITY && same.level_max == 0);
    assert!(Metrics::between(&a, &picture(9, 10, |_, _| [0; 3])).is_err());
}

#[test]
fn ssim_is_that_by_hand() {
    let c1 = (0.01_f64 * 255.0).powi(2);
    // Of flat pictures only the means count.
    let flat = |level| picture(16, 12, |_, _| [level; 3]);
    let expected = (2.0 * 100.0 * 150.0 + c1) / (100.0_f64.powi(2) + 150.0_f64.powi(2) + c1);
    assert!((metrics(&flat(100), &flat(150)).ssim.unwrap() - expected).abs() < 1e-9);
    let noise = |seed: u32| {
        picture(14, 13, |x, y| {
            [0, 1, 2].map(|c| (x * 83 + y * 57 + c * 31 + seed * (x * y + 7)).wrapping_mul(97) as u8)
        })
    };
    assert!((metrics(&noise(1), &noise(1)).ssim.unwrap() - 1.0).abs() < 1e-12);
    // The paper's equation, written down window by window.
    let (a, b) = (noise(1), noise(2));
    let luma = |picture: &Picture, x, y| {
        let [r, g, b] = picture.pixel(x, y).map(f64::from);
        0.299 * r + 0.587 * g + 0.114 * b
    };
    let weight = |x: u32, y: u32| (-((x as f64 - 5.0).powi(2) + (y as f64 - 5.0).powi(2)) / (2.0 * 1.5 * 1.5)).exp();
    let all: f64 = (0..121).map(|k| weight(k % 11, k / 11)).sum();
    let mut sum = 0.0;
    for (left, top) in (0..4).flat_map(|left| (0..3).map(move |top| (left, top))) {
        let mean = |value: &dyn Fn(u32, u32) -> f64| -> f64 {
            (0..121).map(|k| weight(k % 11, k / 11) / all * value(left + k % 11, top + k / 11)).sum()
        };
        let (mean_a, mean_b) = (mean(&|x, y| luma(&a, x, y)), mean(&|x, y| luma(&b, x, y)));
        let variance_a = mean(&|x, y| (luma(&a, x, y) - mean_a).powi(2));
        let variance_b = mean(&|x, y| (luma(&b, x, y) - mean_b).powi(2));
        let covariance = mean(&|x, y| (luma(&a, x, y) - mean_a) * (luma(&b, x, y) - mean_b));
        let c2 = (0.03_f64 * 255.0).powi(2);
        sum += (2.0 * mean_a * mean_b + c1) * (2.0 * covariance + c2)
            / ((mean_a.powi(2) + mean_b.powi(2) + c1) * (variance_a + variance_b + c2));
    }
    let found = metrics(&a, &b).ssim.unwrap();
    assert!((found - sum / 12.0).abs() < 1e-9 && found < 0.9, "{found}, {}", sum / 12.0);
}

#[test]
fn worst_places_are_apart() {
    let black = picture(40, 20, |_, _| [0; 3]);
    let other = picture(40, 20, |x, y| match (x, y) {
        (5, 5) => [0, 200, 0],
        (6, 5) => [0, 199, 0],
        (30, 10) => [0, 0, 201],
        (14, 5) => [3, 0, 0],
        _ => [0; 3],
    });
    assert_eq!(worst_places(&black, &other, 20).unwrap(), [[30, 10], [5, 5], [14, 5]]);
    assert_eq!(worst_places(&black, &other, 1).unwrap(), [[30, 10]]);
}

const SPHERES: &str =
    "SPHERE left -2 0 -4 1 1 1 1 0 0 1 0 0 0 1\nSPHERE right 2 0 -4 1 1 1 0 1 0 1 0 0 0 1\nAMBIENT 1 1 1\nBACK 0 0 1\n";

/// A scene, its picture and one in which `changed` says what pixels become.
fn wrong(changed: impl Fn([u8; 3]) -> [u8; 3]) -> (Case, Picture) {
    let case = Case::new(&scene_of(SPHERES), &Settings::classic());
    let picture = picture(40, 40, |x, y| changed(case.expected.pixel(x, y)));
    (case, picture)
}

#[test]
fn differing_pixels_are_counted_by_sphere() {
    let (case, theirs) = wrong(|[red, green, blue]| [red / 2, green, if blue > 0 { 254 } else { 0 }]);
    let viewed = case.scene.viewed(&case.settings);
    let of = |color: [u8; 3]| case.expected.pixels().iter().filter(|&&pixel| pixel == color).count() as u64;
    let unexplained: Vec<_> = (0..40).map(|x| [x, 0]).chain((0..5).map(|x| [x, 1])).chain([[10, 20]]).collect();
    let found = BySphere::of(&theirs, &case.expected, &viewed, &unexplained).unwrap();
    let background = OnSphere { sphere: None, differing: of([0, 0, 255]), unexplained: 45 };
    let left = OnSphere { sphere: Some(0), differing: of([255, 0, 0]), unexplained: 1 };
    assert_eq!((found.counts, found.step), (vec![background, left], 1));
}

/// The means are those of the authors' program, the package `flip-evaluator` 1.7 of `PyPI`, which calculates in `f32`:
/// `evaluate(a, b, "LDR", applyMagma=False, parameters={"ppd": 67.0})` of samples in 0..=1.
#[test]
fn flip_is_that_of_its_authors() {
    let noise = |width, height, seed: u32| {
        picture(width, height, |x, y| {
            [0, 1, 2].map(|c| (x * 83 + y * 57 + c * 31 + seed * (x * y + 7)).wrapping_mul(97) as u8)
        })
    };
    // Slopes with an edge, and of the second a point and a spot besides.
    let slopes = |k: u32| {
        picture(40, 32, |x, y| {
            let slope = [6 * x + k, 7 * y + 2 * k, 3 * (x + y) + 3 * k].map(|level| level as u8);
            match (k, x, y) {
                (0, ..) if x < 20 => slope,
                (0, ..) => slope.map(|level| 255 - level),
                (_, 5, 3) => [255; 3],
                (_, 20..22, 10..14) => [200, 10, 30],
                _ if x < 20 => slope,
                _ => slope.map(|level| 255 - level),
            }
        })
    };
    let flip = |a: &Picture, b: &Picture| metrics(a, b).flip;
    for (a, b, expected) in [
        (noise(24, 17, 1), noise(24, 17, 2), 0.447_754_8),
        (slopes(0), slopes(9), 0.346_821_8),
        (noise(3, 2, 1), noise(3, 2, 2), 0.859_322_3),
    ] {
        let found = flip(&a, &b);
        assert!((found - expected).abs() < 2e-6, "{found} for {expected}");
        assert!((flip(&b, &a) - found).abs() < 1e-12);
        assert_eq!(flip(&a, &a), 0.0);
    }
    // Where there is no feature at all, single precision shows some: its root is of the order of 1e-4.
    let flat = |level| picture(16, 12, |_, _| [level; 3]);
    assert!((flip(&flat(100), &flat(150)) - 0.463_724_3).abs() < 1e-4);
    // Rows are calculated in bands, which leave no trace.
    let (tall, long) = (|seed| noise(9, 150, seed), |seed| noise(150, 9, seed));
    let turned = |wide: &Picture| picture(9, 150, |x, y| wide.pixel(y, x));
    assert!((flip(&turned(&long(1)), &turned(&long(2))) - flip(&long(1), &long(2))).abs() < 1e-9);
    let mut changed = tall(1).into_rgb();
    changed[3 * 9 * 140] ^= 0xff;
    assert!(flip(&Picture::new(9, 150, changed).unwrap(), &tall(1)) > 0.0);
}

/// What stands in quotes after each `src=`.
fn sources(page: &str) -> Vec<&str> {
    page.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

fn embedded(source: &str) -> Picture {
    let png = BASE64_STANDARD.decode(source.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
    decode(png, Leniency::Strict).unwrap().picture
}

#[test]
fn the_page_has_all_its_parts_and_needs_nothing_else() {
    let (case, theirs) = wrong(|[red, green, blue]| [red / 2, green, blue]);
    let place = tempdir().unwrap();
    let run = |arguments: &str| {
        let arguments = arguments.split_whitespace();
        let output =
            Command::new(env!("CARGO_BIN_EXE_trueray")).args(arguments).current_dir(place.path()).output().unwrap();
        (output.status.code().unwrap(), fs::read_to_string(place.path().join("r.html")).unwrap_or_default())
    };
    let text = format!("NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 40\n{SPHERES}OUTPUT s.ppm\n");
    fs::write(place.path().join("<s>.txt"), text).unwrap();
    theirs.write(place.path().join("a<b>.ppm")).unwrap();
    case.expected.write(place.path().join("right.png")).unwrap();

    let (code, page) = run("compare --device cpu --explain --scene <s>.txt a<b>.ppm --report r.html");
    assert_eq!(code, 1);
    let images = sources(&page);
    assert!(embedded(images[0]) == case.expected && embedded(images[1]) == theirs, "B lies under A");
    assert!(embedded(images[2]) == heatmap(&theirs, &case.expected).unwrap());
    // Of each place A, B and the heat, around the pixel.
    let places = worst_places(&theirs, &case.expected, 20).unwrap();
    assert_eq!(images.len(), 3 + 3 * places.len());
    for ([x, y], crops) in places.iter().zip(images[3..].chunks(3)) {
        assert!(page.contains(&format!("<b>x {x}, y {y}</b>")));
        let crop = embedded(crops[1]);
        let left = x.saturating_sub(4).min(31);
        let top = y.saturating_sub(4).min(31);
        assert_eq!((crop.width(), crop.height()), (9, 9));
        assert_eq!(crop.pixel(x - left, y - top), case.expected.pixel(*x, *y));
        assert!(page.contains(&format!("--x: {}; --y: {}; ", x - left, y - top)));
    }
    for part in [
        "RMSE",
        "PSNR",
        "SSIM",
        "FLIP",
        "p95",
        "a&lt;b&gt;.ppm",
        "sphere 'left'",
        "Likely cause",
        "Pixels by decision",
        "prefers-color-scheme",
        "type=\"range\"",
        "value=\"blink\"",
        "value=\"heat\"",
        "51 levels and more: pale yellow",
        "<b>different</b>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    for loaded in ["http:", "https:", "@import", "url(", "<link"] {
        assert!(!page.contains(loaded), "{loaded}");
    }

    let (code, page) = run("compare right.png a<b>.ppm --report r.html");
    assert_eq!(code, 1);
    assert!(embedded(sources(&page)[1]) == case.expected && !page.contains("Pixels by sphere"));
    let json = Command::new(env!("CARGO_BIN_EXE_trueray"))
        .args(["compare", "right.png", "a<b>.ppm", "--json"])
        .current_dir(place.path())
        .output()
        .unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["metrics"]["flip"], metrics(&case.expected, &theirs).flip);
    assert!(json["metrics"]["ssim"].is_number());
    let (code, page) = run("compare right.png right.png --report r.html");
    assert!(code == 0 && page.contains("No pixel differs.") && page.contains("infinite"));
    assert_eq!(run("compare right.png a<b>.ppm --report right.png").0, 2, "an input is not written");
}

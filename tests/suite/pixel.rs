//! `trueray pixel`: the record of a pixel is the picture's, in the units of the file, and tells what decides it.

use std::fs;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use trueray::cpu::{Decision, Inspector, PixelRecord, RayKind, Reference, SampleRecord, ShadowRecord, Verdict};
use trueray::effects::Effects;
use trueray::film::Picture;
use trueray::pattern::Pattern;
use trueray::scene::{Scene, parse};
use trueray::settings::Settings;
use trueray::{DVec3, Tier, View};

use crate::support::{gpu, scaled, scene, scene_files, scene_of};

/// The scenes, with no more pixels than a test has time for.
pub(crate) fn scenes(pixels: u32) -> impl Iterator<Item = (String, Scene)> {
    scene_files(&["basic", "effects", "refraction", "hard", "show"]).into_iter().map(move |file| {
        let mut scene = scene(&file);
        while scene.width * scene.height > pixels {
            (scene.width, scene.height) = (scene.width.div_ceil(2), scene.height.div_ceil(2));
        }
        (file.file_stem().unwrap().to_string_lossy().into_owned(), scene)
    })
}

/// What looks into a scene's pixels, and its reference.
pub(crate) fn inspector(scene: &Scene, settings: &Settings) -> (Inspector, Reference<f64>) {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    (Inspector::new(&viewed, &effects), Reference::new(&viewed, &effects))
}

/// All pixels of a scene's picture with their columns and rows.
pub(crate) fn places(scene: &Scene) -> impl Iterator<Item = [u32; 2]> + use<> {
    let (width, height) = (scene.width, scene.height);
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

/// Equal, or both no number.
pub(crate) fn same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(&a, b)| a == b || (a.is_nan() && b.is_nan()))
}

/// The record agrees with itself: what is added up is the colour, and the hit is what the tests say.
#[track_caller]
fn assert_consistent(sample: &SampleRecord, place: &str) {
    let sum =
        sample.rays.iter().fold([0.0; 3], |sum: [f64; 3], ray| std::array::from_fn(|c| sum[c] + ray.contribution[c]));
    assert!(same(sum, sample.color), "{place}: {sum:?} for {:?}", sample.color);
    for (index, ray) in sample.rays.iter().enumerate() {
        let taken: Vec<_> = ray
            .tests
            .iter()
            .filter_map(|test| match test.verdict {
                Verdict::LesserTaken => Some((test.sphere, test.roots.unwrap()[0], false)),
                Verdict::GreaterTaken => Some((test.sphere, test.roots.unwrap()[1], true)),
                _ => None,
            })
            .collect();
        let hit: Vec<_> = ray.hit.iter().map(|hit| (hit.sphere, hit.t, hit.inside)).collect();
        assert_eq!(taken, hit, "{place}, ray {index}");
        assert!(ray.test_count >= ray.tests.len() as u64, "{place}, ray {index}");
        assert_eq!(ray.kind == RayKind::Primary, index == 0, "{place}");
        if let Some(parent) = ray.parent {
            assert!(parent < index && sample.rays[parent].bounces + 1 == ray.bounces, "{place}, ray {index}");
            let start = sample.rays[parent].hit.as_ref().unwrap().position;
            assert_eq!(start, ray.origin, "{place}, ray {index}");
        }
        for light in ray.hit.iter().flat_map(|hit| &hit.lights) {
            let blocked = light.shadow.as_ref().is_some_and(|shadow| shadow.blocked);
            assert_eq!(light.lit, light.n_dot_l > 0.0 && !blocked, "{place}, ray {index}");
            assert_eq!(light.shadow.as_ref().and_then(|shadow| shadow.blocker).is_some(), blocked, "{place}");
        }
    }
}

#[test]
fn the_record_is_the_pictures_on_all_scenes() {
    let four = Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() };
    for (name, scene) in scenes(150) {
        for (settings, step) in [(Settings::classic(), 1), (Settings::exact(), 5), (four, 17)] {
            let (inspector, reference) = inspector(&scene, &settings);
            let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
            reference.rows(0, &mut rgb).unwrap();
            let picture = Picture::new(scene.width, scene.height, rgb).unwrap();
            for [x, y] in places(&scene).step_by(step) {
                let record = inspector.pixel(x, y).unwrap();
                let place = format!("{name}, x {x}, y {y}");
                let color = reference.color(x, y).unwrap().to_array();
                assert!(same(record.color, color), "{place}: {:?} for {color:?}", record.color);
                assert_eq!(record.levels, picture.pixel(x, y), "{place}");
                assert_eq!(record.scaled.map(|level| level as u8), record.levels, "{place}");
                assert_eq!(record.samples.len(), settings.pattern.count() as usize);
                record.samples.iter().for_each(|sample| assert_consistent(sample, &place));
            }
            assert_eq!(inspector.pixel(scene.width, 0), None);
        }
    }
}

/// A mirror above a ball, with a light.
const MIRROR: &str = "SPHERE mirror 0 0 -5 2 1 1 1 0 0 0.1 0.5 0.5 0.5 10\nSPHERE ball 1.5 1.5 -3 0.5 0.5 0.5 0 1 0 0.1 0.8 0 0 1\n\
                      LIGHT lamp 3 3 0 1 1 1\nAMBIENT 1 1 1\nBACK 0 0 0.3\n";

/// All lengths of a record are those of the file, whatever the units of the kernels are.
#[test]
fn the_record_is_in_the_units_of_the_file() {
    // No pixel of it looks at a border.
    let (plain, [x, y]) = (scene_of(MIRROR), [23, 18]);
    let settings = Settings::exact();
    let record = |scene: &Scene, settings: &Settings| inspector(scene, settings).0.pixel(x, y).unwrap();
    let expected = record(&plain, &settings);
    assert_eq!(expected.samples[0].rays.len(), 2);
    for factor in [2_f64.powi(60), 2_f64.powi(-60)] {
        let found = record(&scaled(&plain, factor), &settings);
        assert_eq!(found.color, expected.color, "{factor}");
        for (index, (ray, other)) in expected.samples[0].rays.iter().zip(&found.samples[0].rays).enumerate() {
            let times = |v: [f64; 3], k: f64| v.map(|x| x * k);
            // Directions of reflection rays have unit length in any units.
            let along = if index == 0 { factor } else { 1.0 };
            assert_eq!(other.origin, times(ray.origin, factor), "{factor}");
            assert_eq!(other.direction, times(ray.direction, along), "{factor}");
            assert_eq!(ray.tests.len(), other.tests.len());
            for (test, other) in ray.tests.iter().zip(&other.tests) {
                let per_t = along / factor;
                let numbers = [test.a * per_t * per_t, test.b * per_t, test.c, test.discriminant * per_t * per_t];
                assert_eq!(numbers, [other.a, other.b, other.c, other.discriminant], "{factor}");
                assert_eq!(test.roots.map(|roots| roots.map(|t| t / per_t)), other.roots, "{factor}");
            }
            let (Some(hit), Some(other)) = (&ray.hit, &other.hit) else { continue };
            assert_eq!(times(hit.position, factor), other.position);
            assert_eq!((hit.t / along * factor, hit.normal, hit.view), (other.t, other.normal, other.view));
            let shadows = hit.lights.iter().zip(&other.lights).map(|(light, other)| [&light.shadow, &other.shadow]);
            for [shadow, other] in shadows {
                let direction = |shadow: &Option<ShadowRecord>| shadow.as_ref().map(|shadow| shadow.direction);
                assert_eq!(direction(shadow).map(|v| times(v, factor)), direction(other), "{factor}");
            }
        }
    }
    // The eye elsewhere: the same place in the world.
    let eye = DVec3::new(4.0, -8.0, 16.0);
    let mut moved = plain.clone();
    moved.spheres.iter_mut().for_each(|sphere| sphere.center += eye);
    moved.lights.iter_mut().for_each(|light| light.position += eye);
    let view = View::new(eye, None, DVec3::Y).unwrap();
    let found = record(&moved, &Settings { view, ..settings });
    assert_eq!(found.samples[0].rays[0].origin, eye.to_array());
    let [hit, other] = [&expected, &found].map(|record| record.samples[0].rays[0].hit.clone().unwrap());
    let off = DVec3::from_array(hit.position) + eye - DVec3::from_array(other.position);
    assert!(off.length() < 1e-13, "{off}");
}

/// The equation of the specification, from the numbers of the file.
#[test]
fn the_coefficients_are_those_of_the_specification() {
    let record = inspector(&scene_of(MIRROR), &Settings::classic()).0.pixel(20, 20).unwrap();
    let ray = &record.samples[0].rays[0];
    assert_eq!((ray.origin, ray.direction), ([0.0; 3], [0.0, 0.0, -1.0]));
    let test = ray.tests.iter().find(|test| test.sphere == 0).unwrap();
    assert_eq!((test.a, test.b, test.c, test.discriminant), (1.0, -5.0, 24.0, 1.0));
    assert_eq!((test.roots, test.verdict), (Some([4.0, 6.0]), Verdict::LesserTaken));
    // No sphere reaches the image plane.
    assert_eq!(ray.t_min, 0.0);
    let hit = ray.hit.as_ref().unwrap();
    assert_eq!((hit.position, hit.normal, hit.view), ([0.0, 0.0, -4.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]));
    let to_light = DVec3::new(3.0, 3.0, 4.0).normalize();
    assert!((hit.lights[0].n_dot_l - to_light.z).abs() < 1e-15);
    // R·V of a normal towards the eye.
    assert!((hit.lights[0].specular_cosine.unwrap() - to_light.z).abs() < 1e-15);
    let mirrored = &record.samples[0].rays[1];
    assert_eq!((mirrored.kind, mirrored.parent, mirrored.weight), (RayKind::Reflection, Some(0), 0.5));
    assert_eq!((mirrored.direction, mirrored.t_min, mirrored.hit.is_none()), ([0.0, 0.0, 1.0], 1e-3, true));
    assert_eq!(mirrored.background, None);
    let cut = scene_of("SPHERE s 0 0 -2 1.5 1.5 1.5 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1\n");
    let record = inspector(&cut, &Settings::classic()).0.pixel(20, 20).unwrap();
    let ray = &record.samples[0].rays[0];
    assert_eq!((ray.t_min, ray.tests[0].roots), (1.000_001, Some([0.5, 3.5])));
    assert_eq!(ray.tests[0].verdict, Verdict::GreaterTaken);
    assert!(ray.hit.as_ref().is_some_and(|hit| hit.inside && hit.normal == [0.0, 0.0, 1.0]));
}

/// A scene with a decision in the pixel that it is about, and how far that is from the other answer.
struct Near {
    decision: Decision,
    /// As JSON and the table have it.
    names: [&'static str; 2],
    scene: String,
    margin: f64,
}

const WINDOW: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 8 8\n";

/// One for each kind of decision: of the ray straight ahead through pixel 4, 4.
fn near() -> Vec<Near> {
    let near = |decision, names, scene: String, margin| {
        let window = if decision == Decision::Epsilon {
            "NEAR 1e-4\nLEFT -1e-4\nRIGHT 1e-4\nBOTTOM -1e-4\nTOP 1e-4\nRES 8 8\n"
        } else {
            WINDOW
        };
        Near { decision, names, scene: format!("{window}{scene}"), margin }
    };
    // The sphere in the middle, seen at (0, 0, -4).
    let ball = "SPHERE ball 0 0 -5 1 1 1 1 0 0 0.1 0.5 0.5 0 5\n";
    let off = 1e-6;
    let shadow = |radius: f64| {
        format!("{ball}SPHERE blocker 0.5 2 -2 {radius} {radius} {radius} 1 1 1 0 0 0 0 1\nLIGHT l 0 4 0 1 1 1\n")
    };
    let square = |ratio: f64| (1.0 - ratio * ratio).abs();
    let sine = 1.0 - off;
    vec![
        near(
            Decision::Silhouette,
            ["silhouette", "silhouette"],
            format!("SPHERE s 1 0 -5 {r} {r} {r} 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n", r = 1.0 + off),
            square(1.0 / (1.0 + off)),
        ),
        near(
            Decision::Tie,
            ["tie", "two surfaces at one distance"],
            format!("{ball}SPHERE s 0 0 -6 {r} {r} {r} 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n", r = 2.0 - 4e-6),
            4e-6 / (4.0 + 4e-6),
        ),
        near(
            Decision::NearPlane,
            ["near_plane", "near plane"],
            format!("SPHERE s 0 0 -2 {r} {r} {r} 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n", r = 1.0 + off),
            2.0 * off,
        ),
        near(
            Decision::Epsilon,
            ["epsilon", "secondary epsilon"],
            "SPHERE s 0 0 0 0.00050001 0.00050001 0.00050001 1 0 0 1 0 0 0.5 1\nAMBIENT 1 1 1\n".into(),
            2e-8 / 0.000_500_01,
        ),
        near(Decision::ShadowEdge, ["shadow_edge", "shadow edge"], shadow(0.5 - off), square(0.5 / (0.5 - off))),
        near(Decision::ShadowEdge, ["shadow_edge", "shadow edge"], shadow(0.5 + off), square(0.5 / (0.5 + off))),
        near(
            Decision::Terminator,
            ["terminator", "terminator"],
            format!("{ball}LIGHT l 1 0 {z} 1 1 1\n", z = -4.0 + off),
            off,
        ),
        near(
            Decision::CriticalAngle,
            ["critical_angle", "critical angle"],
            format!("SPHERE s 1 0 0 2 2 2 1 1 1 0.1 0 0 0 1 0.9 {eta}\nAMBIENT 1 1 1\n", eta = 2.0 * sine),
            square(sine),
        ),
        near(
            Decision::QuantisationStep,
            ["quantisation_step", "quantisation step"],
            format!("SPHERE s 0 0 -5 1 1 1 {c} 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n", c = (100.0 - 255.0 * 1e-7) / 255.0),
            1e-7,
        ),
    ]
}

fn pixel(scene: &str, arguments: &str, driver: bool) -> Output {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.txt"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.arg("pixel").args(arguments.split_whitespace()).current_dir(folder.path()).stdin(Stdio::null());
    if !driver {
        let nowhere = folder.path().join("no-driver.json");
        command.env("VK_DRIVER_FILES", &nowhere).env("VK_ICD_FILENAMES", &nowhere);
    }
    command.output().unwrap()
}

#[track_caller]
fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The decision that a scene is made for is nearest but for the next level, and both outputs say so with its margin.
#[test]
fn each_decision_is_shown_with_its_margin() {
    for Near { decision, names: [json_name, name], scene, margin } in near() {
        let read = parse("scene.txt", scene.as_bytes());
        let read = read.scene.clone().unwrap_or_else(|| panic!("{}", read.report(false)));
        let record: PixelRecord = inspector(&read, &Settings::classic()).0.pixel(4, 4).unwrap();
        let others = |found: &&trueray::cpu::Margin| {
            decision == Decision::QuantisationStep || found.decision != Decision::QuantisationStep
        };
        let nearest = record.decisions.iter().find(others).unwrap_or_else(|| panic!("{decision:?}: {record:#?}"));
        assert_eq!(nearest.decision, decision, "{:?}", record.decisions);
        assert!((nearest.margin / margin - 1.0).abs() < 1e-3, "{decision:?}: {} for {margin}", nearest.margin);

        let json: Value =
            serde_json::from_str(&text(&pixel(&scene, "scene.txt 4 4 --device cpu --json", true))).unwrap();
        let decisions = json["reference"]["decisions"].as_array().unwrap();
        let found = decisions.iter().find(|found| found["decision"] == json_name).unwrap();
        assert_eq!(found["margin"].as_f64(), Some(nearest.margin));
        let table = text(&pixel(&scene, "scene.txt 4 4 --device cpu", true));
        let line = table.lines().rfind(|line| line.trim_start().starts_with(name)).unwrap_or_else(|| panic!("{table}"));
        let shown: f64 = line.trim_start()[name.len()..].split_whitespace().next().unwrap().parse().unwrap();
        assert!((shown / nearest.margin - 1.0).abs() < 1e-9, "{line}");
        assert!(table.contains("none, the CPU alone: --device cpu"), "{table}");
    }
}

#[test]
fn the_table_tells_rays_tests_light_and_colour() {
    let scene = format!("{WINDOW}{MIRROR}");
    let table = text(&pixel(&scene, "scene.txt 4 4 --device cpu", true));
    let table = table.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "ray 0 primary, weight 1",
        "ray 1 reflected where ray 0 ends, weight 0.5",
        "sphere 'mirror' (0)",
        "taken: the least root that counts",
        "light 'lamp' (0): N·L 0.6859943405",
        "hit nothing: black, since it was mirrored",
        "f32 on the CPU",
    ] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
}

#[test]
fn what_is_no_pixel_is_refused_and_no_device_is_told() {
    let scene = format!("{WINDOW}{MIRROR}");
    for place in ["8 0", "0 8", "-1 0", "0 -7", "5000000000 0"] {
        let output = pixel(&scene, &format!("scene.txt {place} --device cpu"), true);
        assert_eq!(output.status.code(), Some(2));
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(stderr.contains(&format!("there is no pixel {place}: x is from 0 to 7, y from 0 to 7")), "{stderr}");
    }
    // Each hit of the wall, from within, doubles the rays.
    let room = "SPHERE room 0 0 0 9 9 9 1 1 1 0.1 0 0 1 1 0.5 1\nSPHERE ball 0 0 -3 1 1 1 1 1 1 0.1 0 0 1 1 0.5 1.1\n";
    let output = pixel(&format!("{WINDOW}{room}"), "scene.txt 4 4 --device cpu --max-depth 24", true);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && stderr.contains(" rays, and a table 20000 at the most"), "{stderr}");
    assert!(text(&pixel(&scene, "scene.txt 4 4", false)).contains("none, the CPU alone: "));
    assert_eq!(pixel(&scene, "scene.txt 4 4 --device gpu", false).status.code(), Some(4));
}

/// Each tier of the device stands beside the reference, with the levels of its picture and the colour that they are of.
#[test]
fn tiers_of_the_device_stand_beside_the_reference() {
    let test = "pixel::tiers_of_the_device_stand_beside_the_reference";
    let Some(gpu) = gpu(test) else { return };
    let ladder: Vec<Tier> = gpu.ladder().to_vec();
    let is_double = gpu.device.info.f64;
    drop(gpu);
    let scene = format!("{WINDOW}{MIRROR}");
    let json: Value = serde_json::from_str(&text(&pixel(&scene, "scene.txt 4 4 --device gpu --json", true))).unwrap();
    let tiers = json["tiers"].as_array().unwrap();
    assert_eq!(
        tiers.iter().map(|tier| tier["tier"].as_str().unwrap()).collect::<Vec<_>>(),
        ladder.iter().map(|tier| tier.name()).collect::<Vec<_>>()
    );
    for tier in tiers {
        assert_eq!(tier["levels"], json["reference"]["levels"], "{tier}");
        assert_eq!((&tier["verdict"], &tier["difference"]), (&"same".into(), &serde_json::json!([0, 0, 0])));
        let triple = |value: &Value| [0, 1, 2].map(|c| value[c].as_f64().unwrap());
        let (color, expected) = (triple(&tier["color"]), triple(&json["reference"]["color"]));
        // Of the reference's colour, which is between 2⁻⁷ and 1.
        let last_place = |x: f64, bits: f64| 2_f64.powf(x.log2().floor() - bits);
        let off =
            |bits| -> [f64; 3] { std::array::from_fn(|c| (color[c] - expected[c]) / last_place(expected[c], bits)) };
        assert!(expected.iter().all(|c| (0.008..1.0).contains(c)), "{expected:?}");
        assert_eq!(triple(&tier["ulps"]), off(23.0), "{tier}");
        assert!(triple(&tier["ulps"]).iter().all(|ulps| ulps.abs() < 20.0), "{tier}");
        let is_double = is_double && tier["tier"] == "double";
        assert_eq!(tier["ulps_f64"].is_array(), is_double, "{tier}");
        if is_double {
            assert_eq!(triple(&tier["ulps_f64"]), off(52.0), "{tier}");
            assert!(triple(&tier["ulps_f64"]).iter().all(|ulps| ulps.abs() < 20.0), "{tier}");
        } else {
            // The colour of a tier in f32 is a number of f32.
            assert!(color.iter().all(|&c| f64::from(c as f32) == c), "{tier}");
        }
        assert_eq!(tier["by_reference"], false);
    }
    let table = text(&pixel(&scene, "scene.txt 4 4 --device gpu", true));
    let places = ["f32", "f64"].map(|scalar| table.matches(&format!(" units in the last place of {scalar}\n")).count());
    // Beside the reference's source in f32.
    assert_eq!(places, [1 + ladder.len() - usize::from(is_double), usize::from(is_double)], "{table}");
    assert_eq!(json["sphere_names"]["0"], "mirror");
    assert!(json["single"]["ulps"].as_array().unwrap().iter().all(|ulps| ulps.as_f64().unwrap().abs() < 20.0));
}

/// Where a ray may touch a sphere or not, the reference has decided, and what is shown says so.
#[test]
fn what_the_reference_has_decided_for_a_tier_is_told() {
    let test = "pixel::what_the_reference_has_decided_for_a_tier_is_told";
    if gpu(test).is_none() {
        return;
    }
    let scene = format!("{WINDOW}SPHERE s 1 0 -5 1 1 1 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n");
    let json: Value = serde_json::from_str(&text(&pixel(&scene, "scene.txt 4 4 --device gpu --json", true))).unwrap();
    for tier in json["tiers"].as_array().unwrap() {
        let tells_tangents = tier["tier"] != "fast";
        assert_eq!(tier["by_reference"], tells_tangents, "{tier}");
        assert!(!tells_tangents || tier["color"] == json["reference"]["color"], "{tier}");
    }
    let table = text(&pixel(&scene, "scene.txt 4 4 --device gpu", true));
    assert_eq!(table.matches("by the CPU reference: ").count(), json["tiers"].as_array().unwrap().len() - 1, "{table}");
}

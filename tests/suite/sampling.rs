//! Foveated and sparse sampling: which pixels are sampled, that they are those of the full picture, and how the others are
//! filled.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use trueray::cpu::{filled, nearest_samples};
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, render_partial, render_picture};
use trueray::gpu::Reconstructor;
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::sampling::{Density, Fill, Fovea, MAX_SIDE, Samples, packed, rank};
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{gpu, root, scene, scene_of};

fn foveated(center: [f64; 2], radius: f64, falloff: f64, far: f64) -> Density {
    Density { fovea: Some(Fovea { center, radius, falloff }), far }
}

/// Maps of all kinds for a picture of this size.
fn densities((width, height): (u32, u32)) -> Vec<Density> {
    let sides = [f64::from(width), f64::from(height)];
    let mut maps: Vec<_> = [1.0, 0.5, 0.25, 0.1, 1.0 / 16.0, 0.01, 1e-4, 1e-12].map(Density::sparse).to_vec();
    for far in [0.3, 1.0 / 16.0, 0.002] {
        maps.push(foveated([0.5 * sides[0], 0.5 * sides[1]], 6.0, 5.0, far));
        maps.push(foveated([0.0, sides[1]], 3.5, 20.0, far));
        maps.push(foveated([sides[0] * 0.8, sides[1] * 0.1], 0.0, 0.5, far));
    }
    maps
}

const SIZES: [(u32, u32); 7] = [(97, 61), (64, 64), (1, 1), (300, 1), (2, 230), (33, 8), (8, 120)];

#[test]
fn the_density_falls_as_it_is_documented() {
    let density = foveated([100.0, 50.0], 20.0, 10.0, 0.04);
    assert_eq!(density.at(100.0, 50.0), 1.0);
    assert_eq!(density.at(120.0, 50.0), 1.0);
    assert_eq!(density.at(130.0, 50.0), 0.25);
    assert_eq!(density.at(100.0, 90.0), 1.0 / 9.0);
    assert_eq!(density.at(160.0, 50.0), 0.04);
    assert!(density.is_inside(110, 50) && !density.is_inside(121, 50));
    assert_eq!(Density::sparse(0.3).at(7.0, 5.0), 0.3);
}

/// Fixed for all time: pictures in parts are reproducible.
#[test]
fn ranks_are_what_they_were() {
    assert_eq!([rank(0, 0), rank(1, 0), rank(0, 1), rank(5, 7)], [0, 3_242_174_889, 2_447_445_413, 3_278_221_264]);
}

#[test]
fn as_many_pixels_are_sampled_as_the_density_says() {
    for far in [0.5, 0.25, 0.1, 1.0 / 64.0] {
        for (x, y) in [(0, 0), (1234, 77), (40_000, 9_000)] {
            let count = (0..200 * 200).filter(|i| Density::sparse(far).takes(x + i % 200, y + i / 200)).count();
            let part = count as f64 / 40_000.0;
            assert!((part / far - 1.0).abs() < 0.02, "{part} for {far} at {x}, {y}");
        }
    }
    let density = foveated([300.0, 200.0], 50.0, 40.0, 0.05);
    let samples = Samples::new((640, 480), &density).unwrap();
    let forecast = density.forecast((640, 480));
    assert!((samples.pixels().len() as f64 / forecast - 1.0).abs() < 0.05, "{} for {forecast}", samples.pixels().len());
}

#[test]
fn a_greater_density_only_adds_samples() {
    for size in SIZES {
        let center = [f64::from(size.0) * 0.3, f64::from(size.1) * 0.6];
        let chain = [
            Density::sparse(0.01),
            foveated(center, 4.0, 3.0, 0.01),
            foveated(center, 4.0, 8.0, 0.02),
            foveated(center, 9.0, 8.0, 0.1),
            Density { far: 0.4, ..foveated(center, 9.0, 8.0, 0.1) },
            Density::FULL,
        ];
        for pair in chain.windows(2) {
            let [less, more] = [0, 1].map(|index| Samples::new(size, &pair[index]).unwrap());
            let more: std::collections::HashSet<_> = more.pixels().iter().copied().collect();
            assert!(less.pixels().iter().all(|pixel| more.contains(pixel)), "{pair:?} at {size:?}");
        }
        for density in densities(size) {
            let samples = Samples::new(size, &density).unwrap();
            let mut all = samples.pixels().to_vec();
            all.extend(Samples::missing(size, 0, size.1, &density));
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), size.0 as usize * size.1 as usize);
            assert!(!samples.pixels().is_empty());
            assert!(samples.pixels().iter().all(|&[x, y]| density.takes(x, y)));
        }
    }
}

fn distance_squared(a: [u32; 2], b: [u32; 2]) -> u64 {
    (0..2).map(|axis| u64::from(a[axis].abs_diff(b[axis])).pow(2)).sum()
}

/// Jump flooding may err in general; with these maps it does not.
#[test]
fn jump_flooding_finds_nearest_samples() {
    for size in SIZES {
        for density in densities(size) {
            let samples = Samples::new(size, &density).unwrap();
            for (index, owner) in nearest_samples(&samples).into_iter().enumerate() {
                let pixel = [index as u32 % size.0, index as u32 / size.0];
                let key = |sample: &&[u32; 2]| (distance_squared(pixel, **sample), packed(**sample));
                let best = *samples.pixels().iter().min_by_key(key).unwrap();
                assert_eq!([owner & 0xffff, owner >> 16], best, "{pixel:?} of {density:?} at {size:?}");
            }
        }
    }
}

/// A colour for each sample.
fn colors(samples: &Samples) -> Vec<[u8; 3]> {
    samples.pixels().iter().map(|&[x, y]| [(x * 7 + y) as u8, (x * y) as u8, (y * 11) as u8]).collect()
}

#[test]
fn filled_pixels_are_between_their_samples() {
    for size in SIZES {
        for density in densities(size) {
            let samples = Samples::new(size, &density).unwrap();
            let colors = colors(&samples);
            let owners = nearest_samples(&samples);
            for fill in Fill::ALL {
                let rgb = filled(&samples, &colors, fill).unwrap();
                let pixels = rgb.as_chunks::<3>().0;
                let at = |[x, y]: [u32; 2]| pixels[y as usize * size.0 as usize + x as usize];
                assert!(samples.pixels().iter().zip(&colors).all(|(&pixel, color)| at(pixel) == *color));
                if fill == Fill::Nearest {
                    let of_owner = |owner: &u32| at([owner & 0xffff, owner >> 16]);
                    assert!(owners.iter().map(of_owner).eq(pixels.iter().copied()));
                }
            }
            let even = filled(&samples, &vec![[3, 200, 255]; colors.len()], Fill::Smooth).unwrap();
            assert!(even.as_chunks::<3>().0.iter().all(|color| *color == [3, 200, 255]));
        }
    }
}

#[test]
fn the_device_fills_as_the_reference_does() {
    let Some(gpu) = gpu("sampling::the_device_fills_as_the_reference_does") else { return };
    let mut device = Reconstructor::new(&gpu).unwrap();
    for size in SIZES {
        for density in densities(size) {
            let samples = Samples::new(size, &density).unwrap();
            let colors = colors(&samples);
            assert_eq!(device.nearest_samples(&samples).unwrap(), nearest_samples(&samples), "{density:?} at {size:?}");
            for fill in Fill::ALL {
                let expected = filled(&samples, &colors, fill).unwrap();
                assert!(device.filled(&samples, &colors, fill).unwrap() == expected, "{fill} {density:?} at {size:?}");
            }
        }
    }
}

fn mirrors() -> Scene {
    let mut scene = scene_of(
        "SPHERE a -0.6 0 -4 1 1 1 1 0.5 0.2 0.1 0.6 0.3 0.5 20\nSPHERE b 1 0.2 -3.5 0.6 0.9 0.6 0.2 0.5 1 0.1 0.6 0.3 0.5 20\n\
         LIGHT l 3 4 1 1 1 1\nAMBIENT 1 1 1\nBACK 0.1 0.2 0.3",
    );
    (scene.width, scene.height) = (93, 70);
    scene
}

fn glass() -> Scene {
    let mut scene = scene(&root().join("scenes/refraction/bubbles.txt"));
    (scene.width, scene.height) = (80, 61);
    scene
}

/// Sampled pixels have the bytes of the full picture, with one sample a pixel and several, few spheres and many, mirrors and
/// glass, on the device with every tier and on the reference; a full density gives the full picture.
#[test]
fn sampled_pixels_are_those_of_the_full_picture() {
    let gpu = gpu("sampling::sampled_pixels_are_those_of_the_full_picture");
    let many = scene(&root().join("scenes/basic/ten-thousand-spheres.txt"));
    let many = Scene { width: 90, height: 90, ..many };
    let side = |samples| Settings { pattern: Pattern::Grid { side: samples }, ..Settings::exact() };
    let mut backends = vec![Backend::Reference];
    backends.extend(gpu.as_deref().into_iter().flat_map(|gpu| Tier::ALL.map(|tier| Backend::Device(gpu, tier))));
    backends.extend(gpu.as_deref().map(|gpu| Backend::Certified(gpu, Tier::Fast)));
    for (scene, settings) in [
        (mirrors(), Settings::classic()),
        (mirrors(), side(3)),
        (glass(), side(1)),
        (glass(), side(2)),
        (many, side(1)),
    ] {
        let size = (scene.width, scene.height);
        let effects = Effects::of(&scene.viewed(&settings));
        for &backend in &backends {
            let (full, _) =
                render_picture(&mut Engine::new(backend, scene.viewed(&settings), &effects).unwrap()).unwrap();
            let mut in_part = Engine::with(backend, scene.viewed(&settings), &effects, &Options::default()).unwrap();
            for density in [Density::FULL, Density::sparse(0.13), foveated([40.0, 30.0], 10.0, 12.0, 0.03)] {
                let samples = Samples::new(size, &density).unwrap();
                let rgb = render_partial(&mut in_part, backend, &samples, Fill::Smooth, |_| ()).unwrap().rgb;
                for &[x, y] in samples.pixels() {
                    let at = (y as usize * size.0 as usize + x as usize) * 3;
                    assert_eq!(rgb[at..at + 3], full[at..at + 3], "({x}, {y}) of {density:?} on {backend:?}");
                }
                assert!(density != Density::FULL || rgb == full);
            }
        }
    }
}

#[test]
fn too_large_a_picture_is_refused() {
    assert_eq!(Samples::obstacle((8192, 4096)), None);
    assert!(Samples::obstacle((8192, 4097)).unwrap().contains("8192x4097"));
    assert!(Samples::obstacle((MAX_SIDE + 1, 1)).is_some());
}

fn run(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 120 80\nSPHERE s 0 0 -3 2 2 2 1 0 0 1 0.5 0 0.2 1\n\
                     SPHERE t 1 0 -2 1 0.5 0.5 0 1 0 1 0.5 0 0.2 1\nLIGHT l 0 9 0 1 1 1\nAMBIENT 1 1 1\nBACK 0 0 1\n";

#[test]
fn the_command_line_renders_a_part_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("scene.txt"), SCENE).unwrap();
    let device = gpu("sampling::the_command_line_renders_a_part_and_says_so");
    for device in [Some("cpu"), device.as_ref().map(|_| "gpu")].into_iter().flatten() {
        let render = |options: &str| {
            let output = run(path, &format!("render --device {device} scene.txt {options}"));
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stderr).unwrap()
        };
        render("-o full.ppm");
        let full = std::fs::read(path.join("full.ppm")).unwrap();
        // Every pixel, one way or the other.
        render("--sparse 1 -o a.ppm");
        render("--foveate 0.1,0.9 --fovea-radius 2 --fill smooth -o b.ppm");
        assert!(std::fs::read(path.join("a.ppm")).unwrap() == full);
        assert!(std::fs::read(path.join("b.ppm")).unwrap() == full);

        let said = render("--foveate 30px,20px --density 0.1 --explain --stats --stats-json stats.json -o c.ppm");
        assert!(said.contains("foveated: all pixels within 12 of (30, 20)"), "{said}");
        let stats = std::fs::read(path.join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
        let stats = &stats["pictures"][0];
        let sampled = &stats["sampled"];
        let density = foveated([30.0, 20.0], 12.0, 12.0, 0.1);
        let samples = Samples::new((120, 80), &density).unwrap();
        assert_eq!(sampled["pixels"], samples.pixels().len());
        assert_eq!((&sampled["fill"], &sampled["far"]), (&"nearest".into(), &0.1.into()));
        assert_eq!(stats["rays"]["primary"], samples.pixels().len());
        assert!(said.contains(&format!("{} of 9600 pixels", samples.pixels().len())), "{said}");
        assert!(std::fs::read(path.join("c.ppm")).unwrap() != full);
    }
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.txt"), SCENE).unwrap();
    for (options, message) in [
        ("--foveate here", "expected center, or X,Y in parts"),
        ("--foveate 0.5", "expected center, or X,Y in parts"),
        ("--foveate 0.5,1.5", "expected center, or X,Y in parts"),
        ("--foveate -3px,4px", "expected center, or X,Y in parts"),
        ("--foveate center --sparse 0.1", "cannot be used with"),
        ("--foveate center --density 0", "above 0, up to 1"),
        ("--foveate center --falloff 0", "above 0, up to 100"),
        ("--foveate center --fovea-radius nan", "from 0 to 100"),
        ("--foveate center --fill best", "possible values: nearest, smooth"),
        ("--sparse 1.01", "above 0, up to 1"),
        ("--sparse 0.1 --falloff 1", "cannot be used with"),
        ("--falloff 1", "--foveate"),
        ("--fill smooth", "--foveate"),
        ("--sparse 0.1 --res 10000x10000", "too large to be sampled in part"),
    ] {
        let output = run(folder.path(), &format!("render --device cpu scene.txt -o a.ppm {options}"));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{options}: {stderr}");
        assert!(stderr.contains(message), "{options}: expected '{message}' in:\n{stderr}");
        assert!(!folder.path().join("a.ppm").exists());
    }
}

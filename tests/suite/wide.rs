//! Pictures of very many columns or rows: their places fit into whatever they are kept in.

use trueray::compare::Explanation;
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, Pixels};
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{cpu_picture, gpu, gpu_picture, scene_of};

/// A sphere beside the middle of the picture's far end, where columns and rows are greatest.
fn at_the_end(width: u32, height: u32) -> Scene {
    let (x, y) = if width > height { (3.8, 0.0) } else { (0.0, -3.8) };
    let scene = scene_of(&format!(
        "SPHERE s {x} {y} -4 0.3 0.3 0.3 0.2 0.7 0.3 0.3 0.7 0 0.2 1\nBACK 0.5 0.6 0.75\nAMBIENT 1 1 1\nLIGHT l 0 0 0 1 1 1"
    ));
    Scene { width, height, ..scene }
}

#[test]
fn pictures_of_very_many_columns_or_rows_are_those_of_the_reference() {
    let Some(gpu) = gpu("pictures_of_very_many_columns_or_rows_are_those_of_the_reference") else { return };
    let settings = Settings::exact();
    for (width, height) in [(600_000, 1), (1, 600_000), (2_000_000, 1), (524_296, 1)] {
        let scene = at_the_end(width, height);
        let effects = Effects::of(&scene, &settings);
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let reference = Reference::new(&scene, &settings, &effects);
        let seen = expected.pixels().iter().filter(|pixel| **pixel != [128, 153, 191]).count();
        assert!(seen > 10_000, "{width}x{height}: {seen}");
        for tier in Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
            let (picture, _) = gpu_picture(&gpu, tier, &scene, &settings, &effects);
            let judge = Backend::Device(&gpu, tier).judge();
            let explanation = Explanation::of(&picture, &expected, &reference, &judge);
            assert_eq!(explanation.unexplained, 0, "{width}x{height}, {tier}:\n{}", explanation.report());
            // Not because everything is explained.
            assert!(explanation.differing < seen as u64 / 20, "{width}x{height}, {tier}: {}", explanation.report());
        }
    }
}

/// The greatest pictures that a scene file may ask for, in pieces: the last rows, and single pixels.
#[test]
fn the_last_places_of_the_greatest_pictures_are_rendered() {
    let Some(gpu) = gpu("the_last_places_of_the_greatest_pictures_are_rendered") else { return };
    const MOST: u32 = 1 << 24;
    let settings = Settings::exact();
    for (width, height) in [(MOST, 1), (1, MOST), (3000, MOST), (MOST, MOST)] {
        let scene = at_the_end(width, height);
        let effects = Effects::of(&scene, &settings);
        let reference = Reference::<f64>::new(&scene, &settings, &effects);
        for tier in [Tier::Fast, Tier::Double].into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
            let backend = Backend::Device(&gpu, tier);
            let mut list: Engine<Pixels> =
                Engine::with(backend, &scene, &settings, &effects, &Options::default()).unwrap();
            let places: Vec<_> = (0..100).map(|i| (i as f64 / 99.0).powf(0.1)).collect();
            let at = |size: u32, part: f64| (f64::from(size - 1) * part) as u32;
            let pixels: Vec<_> = places
                .iter()
                .map(|&part| {
                    let [x, y] = if width > height { [part, 0.5] } else { [0.5, part] };
                    [at(width, x), at(height, y)]
                })
                .collect();
            let mut colors = vec![[0; 3]; pixels.len()];
            list.pixels(&pixels, &mut colors).unwrap();
            let mut seen = 0;
            for (&[x, y], color) in pixels.iter().zip(&colors) {
                let expected = settings.quantize.levels(reference.color(x, y).unwrap());
                let is_near = expected.iter().zip(color).all(|(a, b)| a.abs_diff(*b) <= 1);
                assert!(is_near, "{width}x{height}, {tier}, ({x}, {y}): {color:?}, not {expected:?}");
                seen += usize::from(expected != [128, 153, 191]);
            }
            assert!(seen > 3, "{width}x{height}: {seen}");
        }
    }
}

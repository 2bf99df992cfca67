//! The bound of error that renderers carry along, held against the reference: in `f32` on the CPU, pixel by pixel.

use trueray::accel::Rounding;
use trueray::bench::Family;
use trueray::cpu::{Bounded, Decision, Reference};
use trueray::effects::Effects;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{orthographic, scene, scene_files, widened};

/// What the unit roundoff of `f64` is to that of `f32`, and more.
const OTHERS: f64 = 1e-8;

/// The scene with no more pixels than a test has time for.
fn small(mut scene: Scene, pixels: u32) -> Scene {
    while scene.width * scene.height > pixels {
        (scene.width, scene.height) = (scene.width.div_ceil(2), scene.height.div_ceil(2));
    }
    scene
}

/// What some pictures came to.
#[derive(Default)]
struct Count {
    pixels: usize,
    different: usize,
    marked: usize,
}

impl Count {
    /// Renders `scene` in `f32` and in `f64`: what the bound is sure of is the same, and no colour is farther off than it says.
    #[track_caller]
    fn add(&mut self, name: &str, scene: &Scene, settings: &Settings) {
        let viewed = scene.viewed(settings);
        let effects = Effects::of(&viewed);
        let exact = Reference::<f64>::new(&viewed, &effects);
        let single = Reference::<f32>::with_rounding(&viewed, &effects, Rounding::SINGLE.certified());
        for [i, j] in (0..scene.height).flat_map(|j| (0..scene.width).map(move |i| [i, j])) {
            let Bounded { color, error, levels, doubt } = single.bounded(i, j, OTHERS).unwrap();
            let exact_color = exact.color(i, j).unwrap();
            let exact_levels = settings.quantize.levels(exact_color);
            let place = || format!("{name}, x {i}, y {j}: {color} for {exact_color}");
            assert!(doubt.is_some() || levels == exact_levels, "{}", place());
            if doubt.is_none_or(|doubt| doubt == Decision::QuantisationStep) {
                let off = (color - exact_color).abs().max_element();
                // What underflows counts for nothing.
                assert!(off <= error + 1e-30, "{}: {off:.2e} with a bound of {error:.2e}", place());
            }
            self.pixels += 1;
            self.different += usize::from(levels != exact_levels);
            self.marked += usize::from(doubt.is_some());
        }
    }
}

#[test]
fn no_colour_is_farther_off_than_the_bound() {
    let mut count = Count::default();
    for file in scene_files(&["basic", "effects", "refraction", "hard", "show"]) {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        for settings in [Settings::classic(), Settings::exact()] {
            count.add(&name, &small(scene(&file), 3000), &settings);
            count.add(&name, &small(widened(scene(&file)), 3000), &orthographic(settings));
        }
    }
    assert!(count.different > 100, "{} of {} differ: nothing is shown", count.different, count.pixels);
}

#[test]
fn few_pixels_of_common_scenes_are_in_doubt() {
    // Many spheres and mirrors show an error that grows from bounce to bounce.
    for (family, size, most) in [
        ("classic", 5, 0.01),
        ("spheres", 10, 0.01),
        ("spheres", 100, 0.03),
        ("spheres", 1000, 0.12),
        ("mirrors", 1000, 0.3),
    ] {
        let mut count = Count::default();
        let scene = small(Family::named(family).unwrap().scene(size), 9000);
        for settings in [Settings::classic(), Settings::exact()] {
            count.add(&format!("{family}, {size}"), &scene, &settings);
        }
        let share = count.marked as f64 / count.pixels as f64;
        assert!(share <= most, "{family}, {size}: {share}");
    }
}

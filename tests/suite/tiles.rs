//! No tile that a sphere covers is left out.

use std::collections::HashSet;

use proptest::prelude::*;
use trueray::accel::{Acceleration, Cover, Rounding};
use trueray::camera::Camera;
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::scene::Scene;
use trueray::settings::{Sampling, Settings};
use trueray::tiles::TILE;

use crate::support::scene_of;

/// Semi-axes from needles to discs.
fn semi_axis() -> impl Strategy<Value = f64> {
    prop_oneof![0.2..3.0, 0.01..0.2, 3.0..30.0]
}

/// Before, on and beyond the image plane, and behind the eye.
fn center() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        [-6.0..6.0, -6.0..6.0, -12.0..3.0],
        [-1.0..1.0, -1.0..1.0, -2.5..0.5],
        [-60.0..60.0, -60.0..60.0, -90.0..-20.0],
    ]
}

fn cover_of(scene: &Scene, settings: &Settings) -> Cover {
    let effects = Effects::of(scene, settings).set;
    Acceleration::new(scene, &Camera::new(scene, settings), effects, Rounding::DOUBLE).screen.cover()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_pixel_of_a_sphere_lies_in_a_covered_tile(
        spheres in prop::collection::vec((center(), [semi_axis(), semi_axis(), semi_axis()]), 1..4),
        window in [-2.0..2.0, -2.0..2.0],
        size in [0.1..3.0, 0.1..3.0],
        flip in any::<[bool; 2]>(),
        (width, height) in (1_u32..200, 1_u32..150),
        centered in any::<bool>(),
    ) {
        let line = |(p, s): &([f64; 3], [f64; 3])| {
            format!("SPHERE s {} {} {} {} {} {} 1 1 1 1 0 0 0 1\n", p[0], p[1], p[2], s[0], s[1], s[2])
        };
        let mut scene = scene_of(&(spheres.iter().map(line).collect::<String>() + "AMBIENT 1 1 1"));
        (scene.width, scene.height) = (width, height);
        let side = |low: f64, size: f64, flip| if flip { (low + size, low) } else { (low, low + size) };
        (scene.window.left, scene.window.right) = side(window[0], size[0], flip[0]);
        (scene.window.bottom, scene.window.top) = side(window[1], size[1], flip[1]);
        let sampling = if centered { Sampling::Center } else { Sampling::Corner };
        let settings = Settings { sampling, ..Settings::classic() };

        let cover = cover_of(&scene, &settings);
        let tiles: HashSet<[u32; 2]> = cover.covered(0, height).into_iter().collect();
        // One that leaves out no sphere by the same bounds.
        let effects = Effects::of(&scene, &settings);
        let reference = Reference::<f64>::with_rounding(&scene, &settings, &effects, Rounding::UNKNOWN);
        for y in 0..height {
            for x in 0..width {
                let tile = [x / TILE * TILE, y / TILE * TILE];
                let is_background = reference.color(x, y) == scene.background;
                prop_assert!(is_background || tiles.contains(&tile), "pixel {x} {y}");
            }
        }
        // In pieces the same tiles.
        let pieces: Vec<_> = (0..height).step_by(TILE as usize * 2).flat_map(|y| cover.covered(y, TILE * 2)).collect();
        prop_assert_eq!(pieces, cover.covered(0, height));
    }
}

/// The corners of a large disc's rectangle are left out.
#[test]
fn tiles_follow_the_outline() {
    let mut scene = scene_of("SPHERE s 0.5 0.2 -9 3 5 2 1 1 1 1 0 0 0 1");
    (scene.width, scene.height) = (800, 800);
    let outlined = cover_of(&scene, &Settings::classic()).covered(0, 800).len() as f64;
    // The ellipse covers π/4 of its rectangle, of about 267 × 444 pixels.
    let rectangle = 2.0 * 3.0 / 9.0 / 2.0 * 100.0 * (2.0 * 5.0 / 9.0 / 2.0 * 100.0);
    assert!(outlined < 0.95 * rectangle && outlined > 0.75 * rectangle, "{outlined} {rectangle}");
}

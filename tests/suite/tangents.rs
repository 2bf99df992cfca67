//! Rays that touch a sphere exactly hit it; what passes it by less than rounding sees does not.
//!
//! The answers come from integers: scenes of small whole numbers, of which many pixels' rays are tangent.

use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, Pixels};
use trueray::film::Picture;
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{cpu_picture, gpu, gpu_picture, say_skipped, scene_of};

/// One sphere alone before a black background, all numbers of which are these over `unit`.
struct Case {
    center: [i64; 3],
    semi_axes: [i64; 3],
    /// Distance of the image plane, and half the window's size.
    near: i64,
    window: i64,
    unit: i64,
    size: [u32; 2],
}

impl Case {
    fn scene(&self) -> Scene {
        let over = |x: i64| x as f64 / self.unit as f64;
        let [[x, y, z], [a, b, c]] = [self.center, self.semi_axes].map(|v| v.map(over));
        let window = over(self.window);
        let mut scene = scene_of(&format!("SPHERE s {x} {y} {z} {a} {b} {c} 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1"));
        scene.window.near = over(self.near);
        [scene.window.left, scene.window.bottom] = [-window; 2];
        [scene.window.right, scene.window.top] = [window; 2];
        [scene.width, scene.height] = self.size;
        scene
    }

    /// The sign of B² − AC, times squares, at the pixel: the window's corners and the pixel's place are over twice the size.
    fn discriminant(&self, settings: &Settings, pixel: [u32; 2]) -> i128 {
        let halves = |offset: f64| (2.0 * offset) as i128;
        let offset = settings.sampling.offset();
        let [width, height] = self.size.map(i128::from);
        let [i, j] = pixel.map(i128::from);
        let window = i128::from(self.window);
        let direction = [
            (2 * window * (2 * i + halves(offset.0)) - 2 * window * width) * height,
            (2 * window * height - 2 * window * (2 * j + halves(offset.1))) * width,
            -2 * i128::from(self.near) * width * height,
        ];
        let [a, b, c] = self.semi_axes.map(i128::from);
        let all = a * b * c;
        let into_object_space = |v: [i128; 3]| [v[0] * b * c, v[1] * a * c, v[2] * a * b];
        let d = into_object_space(direction);
        let s = into_object_space(self.center.map(i128::from));
        let moment = [s[1] * d[2] - s[2] * d[1], s[2] * d[0] - s[0] * d[2], s[0] * d[1] - s[1] * d[0]];
        let squared = |v: [i128; 3]| v.iter().map(|x| x * x).sum::<i128>();
        squared(d) * all * all - squared(moment)
    }
}

/// Spheres and ellipsoids of small whole numbers, and of whole tenths, which binary numbers do not hold.
fn cases() -> impl Iterator<Item = Case> {
    // Of Pythagorean triples there are many: a sphere of radius 3 at distance 5 covers a disc of radius 3/4.
    const PLACES: [[i64; 3]; 11] = [
        [0, 0, -5],
        [0, 0, -10],
        [0, 0, -13],
        [0, 0, -17],
        [0, 0, -25],
        [3, 0, -9],
        [4, 4, -10],
        [1, -1, -5],
        [-3, 4, -13],
        [0, 5, -12],
        [-7, 1, -11],
    ];
    const ELLIPSOIDS: [[i64; 3]; 4] = [[2, 4, 2], [1, 2, 1], [3, 3, 1], [5, 3, 2]];
    const SCALES: [(i64, i64, i64, [u32; 2]); 7] = [
        (1, 1, 1, [120, 120]),
        (1, 1, 1, [75, 75]),
        (1, 2, 1, [120, 60]),
        (1, 1, 10, [120, 120]),
        (1, 2, 10, [96, 40]),
        (3, 2, 10, [60, 60]),
        (1, 1, 100, [80, 40]),
    ];
    PLACES.into_iter().flat_map(|center| {
        (1..=8).map(|radius| [radius; 3]).chain(ELLIPSOIDS).flat_map(move |semi_axes| {
            SCALES.into_iter().map(move |(near, window, unit, size)| Case {
                center,
                semi_axes,
                near,
                window,
                unit,
                size,
            })
        })
    })
}

fn conventions() -> [Settings; 2] {
    [Settings::classic(), Settings::exact()]
}

/// Asserts that the picture shows the sphere just where the ray meets it; returns how many rays touch it.
fn assert_exact(case: &Case, settings: &Settings, picture: &Picture) -> usize {
    let mut tangents = 0;
    for (y, row) in (0..).zip(picture.rows()) {
        for (x, &color) in (0..).zip(row) {
            let discriminant = case.discriminant(settings, [x, y]);
            tangents += usize::from(discriminant == 0);
            assert_eq!(
                color == [255; 3],
                discriminant >= 0,
                "{:?} {:?} {:?}, pixel {x} {y}: B² - AC is {discriminant}",
                case.center,
                case.semi_axes,
                settings.sampling
            );
        }
    }
    tangents
}

/// No sphere that the eye or the image plane is in: then the nearer root is all that counts.
fn is_whole(case: &Case) -> bool {
    case.center[2] + case.semi_axes[2] < -case.near
}

#[test]
fn the_reference_hits_what_rays_touch() {
    let mut tangents = 0;
    for case in cases().filter(is_whole) {
        let scene = case.scene();
        for settings in conventions() {
            let (picture, _) = cpu_picture::<f64>(&scene, &settings, &Effects::of(&scene.viewed(&settings)));
            tangents += assert_exact(&case, &settings, &picture);
        }
    }
    assert!(tangents > 300, "{tangents}");
}

/// One unit in the last place decides, in either direction.
#[test]
fn the_last_place_of_a_radius_decides() {
    let settings = Settings::classic();
    let mut tangents = 0;
    for case in cases().filter(|case| is_whole(case) && case.semi_axes[0] == case.semi_axes[1]) {
        let scene = case.scene();
        let touched = (0..case.size[0]).flat_map(|x| (0..case.size[1]).map(move |y| [x, y]));
        let touched: Vec<_> = touched.filter(|&pixel| case.discriminant(&settings, pixel) == 0).collect();
        for (is_hit, next) in [(false, f64::next_down as fn(f64) -> f64), (true, f64::next_up)] {
            let mut scene = scene.clone();
            scene.spheres[0].scale = glam::DVec3::from_array(scene.spheres[0].scale.to_array().map(next));
            let reference = Reference::<f64>::new(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings)));
            for &[x, y] in &touched {
                assert_eq!(reference.color(x, y).unwrap().x == 1.0, is_hit, "{:?}, pixel {x} {y}", case.center);
                tangents += 1;
            }
        }
    }
    assert!(tangents > 200, "{tangents}");
}

/// Rays that touch a sphere, from the device: single pixels and whole pictures, also among several samples of a pixel.
#[test]
fn devices_hit_what_rays_touch() {
    let Some(gpu) = gpu("devices_hit_what_rays_touch") else { return };
    let mut tangents = 0;
    for case in cases().filter(is_whole).step_by(12) {
        let scene = case.scene();
        for settings in conventions() {
            let effects = Effects::of(&scene.viewed(&settings));
            for tier in [Tier::Robust, Tier::Double].into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
                let (picture, _) = gpu_picture(&gpu, tier, &scene, &settings, &effects);
                tangents += assert_exact(&case, &settings, &picture);
            }
        }
    }
    assert!(tangents > 50, "{tangents}");
}

/// With lights and mirrors, several samples and pixels of a list: the very bytes of the reference.
#[test]
fn what_follows_a_tangent_is_decided_too() {
    let Some(gpu) = gpu("what_follows_a_tangent_is_decided_too") else { return };
    if !gpu.device.info.f64 {
        return say_skipped("what_follows_a_tangent_is_decided_too", "the device has no f64");
    }
    let mut scene = scene_of(
        "SPHERE s 0 0 -5 3 3 3 0.9 0.5 0.3 0.3 0.6 0.4 0.5 9\nSPHERE m 3 4 -9 2 2 2 0.2 0.5 0.9 0.3 0.6 0.4 0.5 9\n\
         LIGHT l -4 5 0 0.8 0.8 0.8\nAMBIENT 0.4 0.4 0.4\nBACK 0.1 0.2 0.3",
    );
    (scene.width, scene.height) = (120, 120);
    for side in [1, 2] {
        let settings = Settings { pattern: Pattern::Grid { side }, ..Settings::classic() };
        let effects = Effects::of(&scene.viewed(&settings));
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let (picture, _) = gpu_picture(&gpu, Tier::Double, &scene, &settings, &effects);
        assert!(picture == expected, "{side}");
        // (3/4)(3/5, 4/5) lies on the grid of pixels, of which the ball covers a disc of radius 3/4.
        let touched: Vec<_> = [[45, 60], [75, 24], [105, 60], [60, 105], [60, 60]].to_vec();
        let backend = Backend::Device(&gpu, Tier::Double);
        let mut engine =
            Engine::<Pixels>::with(backend, scene.viewed(&settings), &effects, &Options::default()).unwrap();
        let mut colors = vec![[0; 3]; touched.len()];
        engine.pixels(&touched, &mut colors).unwrap();
        for (&[x, y], color) in touched.iter().zip(colors) {
            assert_eq!(color, expected.pixel(x, y), "{side}: {x} {y}");
        }
    }
}

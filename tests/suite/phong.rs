//! What a pixel must show, calculated here from the formula, with nothing of `src/` in it.
//!
//! Each case is one pixel whose hit point and normal are given by hand: a sphere is put where the pixel's ray meets it at
//! that point with that normal. The expected colour is a sum written out in the test. Every renderer has to show it: the
//! reference in each scalar by its unclamped colour, the device at each tier by its level, which has to be that of a
//! colour within the error of the tier.

use glam::DVec3;
use trueray::cpu::{Dd, Real, Reference};
use trueray::effects::Effects;
use trueray::gpu::Gpu;
use trueray::pattern::{Filter, Pattern};
use trueray::precision::Tier;
use trueray::scene::{Scene, parse};
use trueray::settings::{Quantize, SampleOffset, Secondary, Settings, Specular};
use trueray::tuning::Tuning;

use crate::support::{cpu_picture, gpu, gpu_picture, pairs};

/// What a sphere is made of.
#[derive(Clone, Copy)]
struct Material {
    color: DVec3,
    ka: f64,
    kd: f64,
    ks: f64,
    kr: f64,
    n: f64,
}

/// A point of a surface: where it is, its unit normal on the viewer's side, and the unit vector to where it is seen from.
#[derive(Clone, Copy)]
struct Point {
    at: DVec3,
    normal: DVec3,
    view: DVec3,
}

#[derive(Clone, Copy)]
struct Lamp {
    at: DVec3,
    intensity: DVec3,
}

const AMBIENT: DVec3 = v(0.5, 0.7, 0.3);
const BACK: DVec3 = v(0.31, 0.62, 0.93);

const CLAY: Material = Material { color: v(0.9, 0.6, 0.35), ka: 0.2, kd: 0.6, ks: 0.0, kr: 0.0, n: 1.0 };
const GLOSS: Material = Material { ks: 0.4, n: 20.0, ..CLAY };
/// Shows the ambient light alone: a flat colour, whatever the lamps do.
const FLAT: Material = Material { color: v(0.2, 0.9, 0.7), ka: 0.8, kd: 0.0, ks: 0.0, kr: 0.0, n: 1.0 };

/// Where the ray along the axis is met in most cases, and from where it comes.
const P: DVec3 = v(0.0, 0.0, -3.0);
const VIEW: DVec3 = v(0.0, 0.0, 1.0);
/// The ray along the axis; all directions have the near distance for their −z.
const AXIS: DVec3 = v(0.0, 0.0, -1.0);
/// A ray of 3-4-5, whose direction is not of unit length.
const SLANTED: DVec3 = v(0.75, 0.0, -1.0);

const fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Ka·Ia·O.
fn ambient(material: &Material) -> DVec3 {
    material.ka * AMBIENT * material.color
}

/// Kd·Ip·(N·L)·O + Ks·Ip·(R·V)ⁿ, or (N·H)ⁿ; nothing where N·L ≤ 0.
fn lit(point: &Point, material: &Material, lamp: &Lamp, specular: Specular) -> DVec3 {
    let Point { at, normal, view } = *point;
    let to_lamp = (lamp.at - at).normalize();
    let cosine = normal.dot(to_lamp);
    if cosine <= 0.0 {
        return DVec3::ZERO;
    }
    let shine = match specular {
        Specular::Phong => (2.0 * cosine * normal - to_lamp).dot(view),
        Specular::Blinn => (to_lamp + view).normalize().dot(normal),
    };
    let diffuse = material.kd * lamp.intensity * cosine * material.color;
    diffuse + material.ks * lamp.intensity * shine.max(0.0).powf(material.n)
}

/// The level of a colour.
fn level(color: f64, quantize: Quantize) -> u8 {
    let scaled = 255.0 * color.clamp(0.0, 1.0);
    match quantize {
        Quantize::Truncate => scaled.floor() as u8,
        Quantize::Round => (scaled + 0.5).floor() as u8,
        Quantize::Overscale => (scaled / 255.0 * 255.9).floor() as u8,
    }
}

/// A pixel and its colour.
struct Case {
    name: String,
    /// Direction of the pixel's ray, not of unit length; −z is the distance of the image plane.
    ray: DVec3,
    statements: Vec<String>,
    expected: DVec3,
    settings: Vec<(String, Settings)>,
}

fn case(name: impl Into<String>, ray: DVec3, statements: Vec<String>, expected: DVec3) -> Case {
    Case { name: name.into(), ray, statements, expected, settings: conventions() }
}

impl Case {
    /// Likewise, with these changes of the settings.
    fn with(mut self, change: impl Fn(&mut Settings)) -> Self {
        self.settings.iter_mut().for_each(|(_, settings)| change(settings));
        self
    }

    /// For the convention of this name alone.
    fn only(mut self, name: &str) -> Self {
        self.settings.retain(|(convention, _)| convention == name);
        assert!(!self.settings.is_empty());
        self
    }
}

fn conventions() -> Vec<(String, Settings)> {
    vec![("classic".to_owned(), Settings::classic()), ("exact".to_owned(), Settings::exact())]
}

fn numbers(vectors: &[DVec3]) -> String {
    vectors.iter().flat_map(DVec3::to_array).map(|x| format!(" {x}")).collect()
}

/// An ellipsoid with these semi-axes.
fn ellipsoid(center: DVec3, scale: DVec3, material: &Material) -> String {
    let Material { color, ka, kd, ks, kr, n } = material;
    format!("SPHERE s{} {ka} {kd} {ks} {kr} {n}", numbers(&[center, scale, *color]))
}

fn ball(center: DVec3, radius: f64, material: &Material) -> String {
    ellipsoid(center, DVec3::splat(radius), material)
}

/// A ball of radius 1 whose outside has this normal at the point.
fn outside(point: &Point, material: &Material) -> String {
    ball(point.at - point.normal, 1.0, material)
}

fn lamp(lamp: &Lamp) -> String {
    format!("LIGHT l{}", numbers(&[lamp.at, lamp.intensity]))
}

const SIZE: u32 = 8;
/// The pixel of the case.
const PIXEL: (u32, u32) = (5, 2);

/// The scene of a case, with a window in which the sample of the pixel lies on the ray. All its numbers are exact.
fn scene(case: &Case, sampling: SampleOffset) -> Scene {
    let (sx, sy) = match sampling {
        SampleOffset::Corner => (0.0, 0.0),
        SampleOffset::BottomLeft => (0.0, 1.0),
        SampleOffset::Center => (0.5, 0.5),
    };
    let side = 2.0;
    let left = case.ray.x - side * (f64::from(PIXEL.0) + sx) / f64::from(SIZE);
    let top = case.ray.y + side * (f64::from(PIXEL.1) + sy) / f64::from(SIZE);
    let (right, bottom, near) = (left + side, top - side, -case.ray.z);
    let text = format!(
        "NEAR {near}\nLEFT {left}\nRIGHT {right}\nBOTTOM {bottom}\nTOP {top}\nRES {SIZE} {SIZE}\nAMBIENT{}\nBACK{}\n{}\n",
        numbers(&[AMBIENT]),
        numbers(&[BACK]),
        case.statements.join("\n")
    );
    let parsed = parse(&case.name, text.as_bytes());
    parsed.scene.clone().unwrap_or_else(|| panic!("{}", parsed.report(false)))
}

/// The ways in which a device may follow mirrored rays.
#[derive(Clone, Copy)]
enum Ways {
    /// That which its tuning says.
    Tuned,
    /// Each.
    All,
}

impl Ways {
    fn tunings(self, own: Tuning) -> Vec<(&'static str, Tuning)> {
        let in_place = Tuning { in_place_below: 1e9, ..own };
        let at_once = Tuning { in_place_below: 0.0, in_turn_from: 1e9, ..own };
        let in_turn = Tuning { in_place_below: 0.0, in_turn_from: 0.0, ..own };
        match self {
            Self::Tuned => vec![("as tuned", own)],
            Self::All => vec![("in place", in_place), ("at once", at_once), ("in turn", in_turn)],
        }
    }
}

/// Relative error that each scalar may have: some twenty roundings, of which an exponent of 50 multiplies those of the
/// cosine.
const DOUBLE: f64 = 2e-14;
const SINGLE: f64 = 2e-5;
/// Whether every renderer shows what the cases expect.
fn check(test: &str, cases: &[Case], ways: Ways) {
    let mut failures = Vec::new();
    let mut device = gpu(test);
    let mut pairs = device.as_ref().and_then(|_| pairs());
    for case in cases {
        for (convention, settings) in &case.settings {
            let scene = scene(case, settings.sampling);
            let mut judge = Verdict { case, convention, settings, failures: &mut failures };
            judge.color("reference in f64", &color_of::<f64>(&scene, settings), DOUBLE);
            judge.color("reference in double-double", &color_of::<Dd>(&scene, settings), DOUBLE);
            judge.color("reference in f32", &color_of::<f32>(&scene, settings), SINGLE);
            let effects = Effects::of(&scene.viewed(settings));
            let (picture, _) = cpu_picture::<f64>(&scene, settings, &effects);
            judge.levels("reference", picture.pixel(PIXEL.0, PIXEL.1), DOUBLE);
            let mut on = |gpu: &mut Gpu, tiers: &[Tier], ways: Ways, name: &str| {
                let own = gpu.tuned().tuning;
                for (way, tuning) in ways.tunings(own) {
                    gpu.set_tuning(tuning).unwrap();
                    for &tier in tiers.iter().filter(|&&tier| gpu.kernel(tier).is_ok()) {
                        let (picture, _) = gpu_picture(gpu, tier, &scene, settings, &effects);
                        let tolerance = if tier == Tier::Double && gpu.device.info.f64 { DOUBLE } else { SINGLE };
                        let pixel = picture.pixel(PIXEL.0, PIXEL.1);
                        judge.levels(&format!("{name}, {tier}, {way}"), pixel, tolerance);
                    }
                }
                gpu.set_tuning(own).unwrap();
            };
            if let Some(gpu) = &mut device {
                on(gpu, &Tier::ALL, ways, "device");
            }
            if let Some(gpu) = &mut pairs {
                on(gpu, &[Tier::Double], Ways::Tuned, "device without f64");
            }
        }
    }
    drop((device, pairs));
    let count = failures.len();
    failures.truncate(40);
    assert!(count == 0, "{count} values are wrong:\n{}", failures.join("\n"));
}

fn color_of<T: Real>(scene: &Scene, settings: &Settings) -> DVec3 {
    Reference::<T>::new(&scene.viewed(settings), &Effects::of(&scene.viewed(settings))).color(PIXEL.0, PIXEL.1).unwrap()
}

/// Compares what renderers show with what a case expects.
struct Verdict<'a> {
    case: &'a Case,
    convention: &'a str,
    settings: &'a Settings,
    failures: &'a mut Vec<String>,
}

impl Verdict<'_> {
    fn color(&mut self, renderer: &str, color: &DVec3, tolerance: f64) {
        for (channel, (found, expected)) in ["red", "green", "blue"].iter().zip(channels(*color, self.case.expected)) {
            let error = (found - expected).abs() / expected.abs().max(1.0 / 255.0);
            if !(error <= tolerance) {
                self.fail(renderer, channel, &format!("{found} instead of {expected}, error {error:.1e}"));
            }
        }
    }

    /// The level has to be that of a colour within the tolerance: a single one, but for the few colours that near a step.
    fn levels(&mut self, renderer: &str, levels: [u8; 3], tolerance: f64) {
        let found = DVec3::from_array(levels.map(f64::from));
        for (channel, (found, expected)) in ["red", "green", "blue"].iter().zip(channels(found, self.case.expected)) {
            let [least, most] = [1.0 - tolerance, 1.0 + tolerance].map(|k| level(k * expected, self.settings.quantize));
            if !(f64::from(least.min(most))..=f64::from(least.max(most))).contains(&found) {
                self.fail(renderer, channel, &format!("level {found} instead of {least}, colour {expected}"));
            }
        }
    }

    fn fail(&mut self, renderer: &str, channel: &str, what: &str) {
        self.failures.push(format!("{}, {}: {renderer}, {channel}: {what}", self.case.name, self.convention));
    }
}

fn channels(a: DVec3, b: DVec3) -> [(f64, f64); 3] {
    [(a.x, b.x), (a.y, b.y), (a.z, b.z)]
}

/// A point on the ray along the axis with its normal turned to the right: neither along the ray nor along the light.
fn turned() -> Point {
    Point { at: P, normal: v(0.6, 0.0, 0.8), view: VIEW }
}

/// A lamp at an angle from the normal, in degrees, turned towards `aside`, which is at right angles to it.
fn lamp_at(point: &Point, degrees: f64, aside: DVec3, distance: f64) -> Lamp {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Lamp { at: point.at + distance * (cos * point.normal + sin * aside), intensity: v(0.8, 0.5, 1.1) }
}

#[test]
fn what_meets_nothing_shows_the_background() {
    let sphere = ball(v(5.0, 0.0, -3.0), 1.0, &CLAY);
    let behind = ball(v(0.0, 0.0, 3.0), 1.0, &CLAY);
    check(
        "what_meets_nothing_shows_the_background",
        &[
            case("no sphere", AXIS, vec![], BACK),
            case("beside it", AXIS, vec![sphere], BACK),
            case("behind the eye", AXIS, vec![behind], BACK),
        ],
        Ways::Tuned,
    );
}

#[test]
fn ambient_light_is_ka_times_intensity_times_colour() {
    let cases: Vec<_> = [0.0, 0.1, 0.77, 1.0, 3.0]
        .into_iter()
        .map(|ka| {
            let material = Material { ka, ..CLAY };
            let sphere = outside(&turned(), &material);
            case(format!("Ka {ka}"), AXIS, vec![sphere], ka * AMBIENT * CLAY.color)
        })
        .collect();
    check("ambient_light_is_ka_times_intensity_times_colour", &cases, Ways::Tuned);
}

#[test]
fn diffuse_light_goes_with_the_cosine_and_not_with_the_distance() {
    let point = turned();
    let mut cases = Vec::new();
    for (degrees, cosine) in [(0.0, 1.0), (30.0, 0.75_f64.sqrt()), (60.0, 0.5), (75.0, 75_f64.to_radians().cos())] {
        for (aside, distance) in [(v(0.0, 1.0, 0.0), 4.0), (v(0.0, -1.0, 0.0), 300.0), (v(0.8, 0.0, -0.6), 0.5)] {
            let lamp = lamp_at(&point, degrees, aside, distance);
            let expected = ambient(&CLAY) + CLAY.kd * lamp.intensity * cosine * CLAY.color;
            let statements = vec![outside(&point, &CLAY), self::lamp(&lamp)];
            cases.push(case(format!("{degrees} degrees, {distance} away"), AXIS, statements, expected));
        }
    }
    for degrees in [90.001, 120.0, 180.0] {
        let lamp = lamp_at(&point, degrees, v(0.0, 1.0, 0.0), 4.0);
        let statements = vec![outside(&point, &GLOSS), self::lamp(&lamp)];
        cases.push(case(format!("{degrees} degrees"), AXIS, statements, ambient(&GLOSS)));
    }
    let lamp = Lamp { at: P, intensity: v(1.0, 1.0, 1.0) };
    let head_on = Point { normal: VIEW, ..point };
    let statements = vec![outside(&head_on, &GLOSS), self::lamp(&lamp)];
    cases.push(case("a lamp at distance 0", AXIS, statements, ambient(&GLOSS)));
    check("diffuse_light_goes_with_the_cosine_and_not_with_the_distance", &cases, Ways::Tuned);
}

/// Directions to lamps above the horizon of [`turned`]: near the mirrored ray, off its plane, and so that R·V < 0.
const TO_LAMPS: [(&str, DVec3); 4] = [
    ("near the mirrored ray", v(0.95, 0.08, 0.34)),
    ("aside", v(0.7, 0.5, 0.9)),
    ("low", v(0.6, 0.9, 0.1)),
    ("R.V below 0", v(-0.6, 0.0, 0.8)),
];

fn specular_cases(specular: Specular) -> Vec<Case> {
    let oblique = Point { at: 4.0 * SLANTED, normal: v(0.0, 0.6, 0.8), view: v(-0.6, 0.0, 0.8) };
    let mut cases = Vec::new();
    for n in [0.0, 0.5, 1.0, 2.0, 50.0] {
        let material = Material { kd: 0.15, ks: 0.45, n, ..CLAY };
        for (name, to_lamp) in TO_LAMPS {
            for (ray, point) in [(AXIS, turned()), (SLANTED, oblique)] {
                let lamp = Lamp { at: point.at + 5.0 * to_lamp, intensity: v(0.8, 0.5, 1.1) };
                let expected = ambient(&material) + lit(&point, &material, &lamp, specular);
                let statements = vec![outside(&point, &material), self::lamp(&lamp)];
                let name = format!("n {n}, {name}, ray {ray}");
                cases.push(case(name, ray, statements, expected).with(|settings| settings.specular = specular));
            }
        }
    }
    cases
}

#[test]
fn specular_light_is_the_power_of_r_dot_v() {
    let cases = specular_cases(Specular::Phong);
    check("specular_light_is_the_power_of_r_dot_v", &cases, Ways::Tuned);
}

#[test]
fn specular_light_is_the_power_of_n_dot_h_on_request() {
    let cases = specular_cases(Specular::Blinn);
    check("specular_light_is_the_power_of_n_dot_h_on_request", &cases, Ways::Tuned);
}

/// The other places of a sample; the picture of the case has its ray through another window.
#[test]
fn a_sample_lies_where_the_settings_say() {
    let point = Point { at: 4.0 * SLANTED, normal: v(0.0, 0.6, 0.8), view: v(-0.6, 0.0, 0.8) };
    let lamp = lamp_at(&point, 40.0, v(1.0, 0.0, 0.0), 3.0);
    let statements = vec![outside(&point, &GLOSS), self::lamp(&lamp)];
    let expected = ambient(&GLOSS) + lit(&point, &GLOSS, &lamp, Specular::Phong);
    let mut cases = Vec::new();
    for sampling in [SampleOffset::Corner, SampleOffset::BottomLeft, SampleOffset::Center] {
        for quantize in [Quantize::Truncate, Quantize::Round, Quantize::Overscale] {
            let case = case(format!("{sampling:?}, {quantize:?}"), SLANTED, statements.clone(), expected);
            cases.push(case.with(|settings| (settings.sampling, settings.quantize) = (sampling, quantize)));
        }
    }
    check("a_sample_lies_where_the_settings_say", &cases, Ways::Tuned);
}

/// Patterns that are no grid, with the places of their samples from the middle of the pixel, by hand: those of the box from the order of
/// i·0.618 without whole parts, those of the tent at 1 − √(1/3), those of the Gaussian where a quarter of it is cut off.
fn scattered() -> [(Pattern, Vec<[f64; 2]>); 3] {
    let fibonacci = |count, filter| Pattern::Fibonacci { count, filter };
    let (a, b) = (1.0 - (1.0_f64 / 3.0).sqrt(), 0.330_362_271_5);
    [
        (fibonacci(4, Filter::Box), vec![[-0.375, 0.125], [-0.125, -0.375], [0.125, 0.375], [0.375, -0.125]]),
        (fibonacci(3, Filter::Tent), vec![[-a, 0.0], [0.0, -a], [a, a]]),
        (fibonacci(2, Filter::Gaussian), vec![[-b, b], [b, -b]]),
    ]
}

/// A ball on each sample's ray, each of its own colour, some brighter than white; and a sample that sees the background.
#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let width = 2.0 / f64::from(SIZE);
    let mut cases = Vec::new();
    for (name, settings) in conventions() {
        for side in [2, 3] {
            let (sx, sy) = settings.sampling.offset();
            let mut statements = Vec::new();
            let mut sum = BACK;
            for sample in 1..side * side {
                // From the pixel's corner, which lies so far from the ray of the case.
                let (i, j) = (f64::from(sample % side), f64::from(sample / side));
                let x = AXIS.x - sx * width + (i + sx) / f64::from(side) * width;
                let y = AXIS.y + sy * width - (j + sy) / f64::from(side) * width;
                let color = v(0.3 * f64::from(sample), 1.7 / f64::from(sample), 0.1 * f64::from(sample));
                let material = Material { color, ..FLAT };
                statements.push(ball(4.0 * v(x, y, -1.0), 0.01, &material));
                sum += ambient(&material);
            }
            let case = case(format!("{side} x {side}"), AXIS, statements, sum / f64::from(side * side));
            cases.push(case.only(&name).with(|settings| settings.pattern = Pattern::Grid { side }));
        }
        for (pattern, middles) in scattered() {
            let count = middles.len() as f64;
            let (sx, sy) = settings.sampling.offset();
            let mut statements = Vec::new();
            let mut sum = BACK;
            for (sample, [across, down]) in middles.iter().enumerate().skip(1) {
                let (i, j) = (0.5 + across + (sx - 0.5) / count, 0.5 + down + (sy - 0.5) / count);
                let (x, y) = (AXIS.x + (i - sx) * width, AXIS.y - (j - sy) * width);
                let color = v(0.3 * sample as f64, 1.7 / sample as f64, 0.1 * sample as f64);
                let material = Material { color, ..FLAT };
                statements.push(ball(4.0 * v(x, y, -1.0), 0.01, &material));
                sum += ambient(&material);
            }
            let case = case(format!("{pattern:?}"), AXIS, statements, sum / count);
            cases.push(case.only(&name).with(|settings| settings.pattern = pattern));
        }
    }
    check("a_pixel_is_the_mean_of_its_samples", &cases, Ways::Tuned);
}

#[test]
fn the_distance_of_the_image_plane_belongs_to_the_ray() {
    // Twice as far, and a window point twice as far out: the same ray.
    let point = Point { at: 4.0 * SLANTED, normal: v(0.0, 0.6, 0.8), view: v(-0.6, 0.0, 0.8) };
    let lamp = lamp_at(&point, 40.0, v(1.0, 0.0, 0.0), 3.0);
    let statements = vec![outside(&point, &GLOSS), self::lamp(&lamp)];
    let expected = ambient(&GLOSS) + lit(&point, &GLOSS, &lamp, Specular::Phong);
    let cases = [1.0, 2.0, 0.5].map(|near| case(format!("NEAR {near}"), near * SLANTED, statements.clone(), expected));
    check("the_distance_of_the_image_plane_belongs_to_the_ray", &cases, Ways::Tuned);
}

/// Lamps around the normal of [`turned`], all above its horizon, each of its own colour and strength.
fn ring(count: usize) -> Vec<Lamp> {
    let point = turned();
    let lamp = |k: usize| {
        let (sin, cos) = (k as f64 * 2.4).sin_cos();
        let aside = cos * v(0.0, 1.0, 0.0) + sin * v(0.8, 0.0, -0.6);
        let strength = 1.0 / count as f64;
        let intensity = strength * v(0.5 + 0.4 * cos, 0.6 - 0.3 * sin, 0.7 + 0.1 * (k % 3) as f64);
        Lamp { intensity, ..lamp_at(&point, 20.0 + 3.0 * k as f64, aside, 5.0 + k as f64) }
    };
    (0..count).map(lamp).collect()
}

#[test]
fn lights_add_up() {
    let point = turned();
    let mut cases = Vec::new();
    for count in [2, 3, 4, 5, 17] {
        let lamps = ring(count);
        let sum: DVec3 = lamps.iter().map(|lamp| lit(&point, &GLOSS, lamp, Specular::Phong)).sum();
        let mut statements: Vec<_> = lamps.iter().map(lamp).collect();
        statements.insert(count / 2, outside(&point, &GLOSS));
        cases.push(case(format!("{count} lamps"), AXIS, statements.clone(), ambient(&GLOSS) + sum));
        // One below the horizon, and one that is switched off, change nothing.
        statements.push(lamp(&lamp_at(&point, 150.0, v(0.0, 1.0, 0.0), 5.0)));
        statements.push(lamp(&Lamp { intensity: DVec3::ZERO, ..lamps[0] }));
        cases.push(case(format!("{count} lamps and two without light"), AXIS, statements, ambient(&GLOSS) + sum));
    }
    check("lights_add_up", &cases, Ways::Tuned);
}

/// Light that takes away again brings a sum above 1 back: nothing is clamped on the way.
#[test]
fn colours_are_clamped_once_at_the_end() {
    let point = turned();
    let bright = Lamp { intensity: v(4.0, 5.0, 6.0), ..lamp_at(&point, 35.0, v(0.0, 1.0, 0.0), 4.0) };
    let dark = Lamp { intensity: v(-3.4, -4.6, -5.3), ..lamp_at(&point, 30.0, v(0.0, -1.0, 0.0), 4.0) };
    let [plus, minus] = [bright, dark].map(|lamp| lit(&point, &GLOSS, &lamp, Specular::Phong));
    let sphere = outside(&point, &GLOSS);
    let all = |lamps: &[Lamp]| std::iter::once(sphere.clone()).chain(lamps.iter().map(lamp)).collect::<Vec<_>>();
    check(
        "colours_are_clamped_once_at_the_end",
        &[
            case("above 1", AXIS, all(&[bright]), ambient(&GLOSS) + plus),
            case("below 0", AXIS, all(&[dark]), ambient(&GLOSS) + minus),
            case("there and back", AXIS, all(&[bright, dark]), ambient(&GLOSS) + plus + minus),
            case("the other way round", AXIS, all(&[dark, bright]), ambient(&GLOSS) + plus + minus),
        ],
        Ways::Tuned,
    );
}

#[test]
fn an_ellipsoid_has_the_normal_of_its_surface() {
    let lamp = Lamp { at: v(2.0, 3.0, 1.0), intensity: v(0.8, 0.5, 1.1) };
    let mut cases = Vec::new();
    for unit in [v(0.6, 0.0, 0.8), v(0.0, 0.6, 0.8), v(0.48, 0.6, 0.64), v(-0.6, 0.0, 0.8), v(-0.48, -0.6, 0.64)] {
        for scale in [v(2.0, 0.5, 1.5), v(-2.0, 0.5, -1.5), v(0.3, 4.0, 1.0), v(1.7, 1.7, 1.7)] {
            let point = Point { at: P, normal: (unit / scale.abs()).normalize(), view: VIEW };
            let center = point.at - scale.abs() * unit;
            let statements = vec![ellipsoid(center, scale, &GLOSS), self::lamp(&lamp)];
            let expected = ambient(&GLOSS) + lit(&point, &GLOSS, &lamp, Specular::Phong);
            cases.push(case(format!("axes {scale}, at {unit}"), AXIS, statements, expected));
        }
    }
    check("an_ellipsoid_has_the_normal_of_its_surface", &cases, Ways::Tuned);
}

#[test]
fn the_nearest_surface_is_seen_and_of_equal_ones_the_first() {
    let material = |red: f64| Material { color: v(red, 0.4, 0.9), ..FLAT };
    let materials = [0.3, 0.6, 0.95].map(material);
    let flat = |k: usize| ambient(&materials[k]);
    let ball = |z: f64, radius: f64, k: usize| ball(v(0.0, 0.0, z), radius, &materials[k]);
    let nested = [ball(-5.0, 2.0, 1), ball(-4.0, 1.0, 2)];
    let [larger, smaller] = nested.clone();
    check(
        "the_nearest_surface_is_seen_and_of_equal_ones_the_first",
        &[
            case("nearest first", AXIS, vec![ball(-3.0, 1.0, 0), ball(-6.0, 1.0, 1), ball(-9.0, 1.0, 2)], flat(0)),
            case("nearest last", AXIS, vec![ball(-9.0, 1.0, 2), ball(-6.0, 1.0, 1), ball(-3.0, 1.0, 0)], flat(0)),
            case("nearest between", AXIS, vec![ball(-9.0, 1.0, 2), ball(-3.0, 1.0, 0), ball(-6.0, 1.0, 1)], flat(0)),
            case("two at one place", AXIS, vec![ball(-4.0, 1.0, 0), ball(-4.0, 1.0, 1)], flat(0)),
            case("two at one place, the other first", AXIS, vec![ball(-4.0, 1.0, 1), ball(-4.0, 1.0, 0)], flat(1)),
            case("two that touch from inside", AXIS, nested.to_vec(), flat(1)),
            case("two that touch from inside, the smaller first", AXIS, vec![smaller, larger], flat(2)),
        ],
        Ways::Tuned,
    );
}

/// The way from P to a lamp ten units away: (0.6, 0, 0.8).
const TO_LAMP: DVec3 = v(0.6, 0.0, 0.8);

#[test]
fn what_stands_between_a_point_and_a_lamp_takes_its_light() {
    let point = Point { at: P, normal: VIEW, view: VIEW };
    let lamp = Lamp { at: P + 10.0 * TO_LAMP, intensity: v(0.8, 0.5, 1.1) };
    let other = Lamp { at: P + 3.0 * v(-0.6, 0.0, 0.8), intensity: v(0.2, 0.4, 0.3) };
    let [light, other_light] = [lamp, other].map(|lamp| lit(&point, &GLOSS, &lamp, Specular::Phong));
    let dark = ambient(&GLOSS);
    let on_the_way = |distance: f64| P + distance * TO_LAMP;
    let up = v(0.0, 1.0, 0.0);
    let blocked = [
        ("half-way", on_the_way(5.0), DVec3::splat(0.5)),
        ("aside, but not far enough", on_the_way(5.0) + 0.6 * up, DVec3::splat(0.61)),
        ("around the lamp", on_the_way(10.0), DVec3::splat(1.0)),
        ("just before the lamp", on_the_way(9.0), DVec3::splat(0.9)),
        ("around the point, not the lamp", P, DVec3::splat(8.0)),
        ("cut by the image plane", v(1.575, 0.0, -0.9), DVec3::splat(0.2)),
        ("behind the eye", on_the_way(8.0), DVec3::splat(0.3)),
        ("a thin disc", on_the_way(5.0), v(0.4, 0.4, 0.01)),
        ("the edge of a disc", on_the_way(5.0) + 0.45 * up, v(0.01, 0.5, 0.4)),
    ];
    let clear = [
        ("beyond the lamp", on_the_way(12.0), DVec3::splat(1.0)),
        ("just beyond the lamp", on_the_way(11.0), DVec3::splat(0.9)),
        ("behind the point", on_the_way(-4.0), DVec3::splat(0.5)),
        ("aside", on_the_way(5.0) + 0.6 * up, DVec3::splat(0.59)),
        ("around both", v(3.0, 0.0, 1.0), DVec3::splat(50.0)),
        ("beside the edge of a disc", on_the_way(5.0) + 0.55 * up, v(0.01, 0.5, 0.4)),
    ];
    let mut cases = Vec::new();
    let all = blocked.map(|case| (case, dark)).into_iter().chain(clear.map(|case| (case, dark + light)));
    for ((name, center, scale), expected) in all {
        let (sphere, blocker) = (outside(&point, &GLOSS), ellipsoid(center, scale, &CLAY));
        let lamps = [self::lamp(&lamp), self::lamp(&other)];
        let one = vec![sphere.clone(), blocker.clone(), lamps[0].clone()];
        cases.push(case(name, AXIS, one, expected));
        let two = vec![blocker, sphere, lamps[1].clone(), lamps[0].clone()];
        // The other lamp is blocked only by what is around the point.
        let is_around = name == "around the point, not the lamp";
        if !is_around {
            cases.push(case(format!("{name}, beside another lamp"), AXIS, two, expected + other_light));
        }
    }
    check("what_stands_between_a_point_and_a_lamp_takes_its_light", &cases, Ways::Tuned);
}

/// In the classic convention blockers count from a thousandth of the way to the lamp on.
#[test]
fn blockers_count_from_a_thousandth_of_the_way_or_from_the_start() {
    let point = Point { at: P, normal: VIEW, view: VIEW };
    let lamp = Lamp { at: P + 10.0 * TO_LAMP, intensity: v(0.8, 0.5, 1.1) };
    let light = lit(&point, &GLOSS, &lamp, Specular::Phong);
    let statements = |distance: f64, radius: f64| {
        vec![outside(&point, &GLOSS), ball(P + distance * TO_LAMP, radius, &CLAY), self::lamp(&lamp)]
    };
    // From 0.0021 to 0.0079 of ten units, and from 0.008 to 0.012.
    let (near, across) = (statements(0.005, 0.0029), statements(0.01, 0.002));
    check(
        "blockers_count_from_a_thousandth_of_the_way_or_from_the_start",
        &[
            case("nearer", AXIS, near.clone(), ambient(&GLOSS) + light).only("classic"),
            case("nearer", AXIS, near, ambient(&GLOSS)).only("exact"),
            case("nearer and farther", AXIS, across, ambient(&GLOSS)),
            case("farther", AXIS, statements(0.02, 0.009), ambient(&GLOSS)),
        ],
        Ways::Tuned,
    );
}

/// A ball whose inner wall is met: [`Point::normal`] is on the viewer's side, towards the centre.
fn inner_wall(point: &Point, radius: f64, material: &Material) -> String {
    ball(point.at + radius * point.normal, radius, material)
}

#[test]
fn inner_walls_are_lit_from_inside_and_shadowed_by_themselves() {
    let inside = Point { at: v(0.0, 0.0, -1.9), normal: VIEW, view: VIEW };
    let slanted = Point { at: 2.0 * SLANTED, normal: v(-0.8, 0.0, 0.6), view: v(-0.6, 0.0, 0.8) };
    let intensity = v(0.8, 0.5, 1.1);
    let mut cases = Vec::new();
    let mut add = |name: &str, ray, wall: &str, point: &Point, at, is_lit: bool, more: Option<String>| {
        let lamp = Lamp { at, intensity };
        let light = if is_lit { lit(point, &GLOSS, &lamp, Specular::Phong) } else { DVec3::ZERO };
        let mut statements = vec![wall.to_owned(), self::lamp(&lamp)];
        statements.extend(more);
        cases.push(case(name, ray, statements, ambient(&GLOSS) + light));
    };
    // From −0.1 to −1.9, cut at −1.
    let cut = inner_wall(&inside, 0.9, &GLOSS);
    add("cut, lamp inside", AXIS, &cut, &inside, v(0.3, 0.2, -1.2), true, None);
    add("cut, lamp in the part that is cut away", AXIS, &cut, &inside, v(0.1, 0.2, -0.4), true, None);
    add("cut, lamp before it", AXIS, &cut, &inside, v(0.1, 0.3, 2.0), false, None);
    add("cut, lamp behind it", AXIS, &cut, &inside, v(0.1, 0.2, -4.0), false, None);
    let stone = ball(v(0.15, 0.1, -1.55), 0.05, &CLAY);
    add("cut, a stone before the lamp", AXIS, &cut, &inside, v(0.3, 0.2, -1.2), false, Some(stone));
    // The eye is inside.
    let around = inner_wall(&slanted, 2.0, &GLOSS);
    add("around the eye, lamp inside", SLANTED, &around, &slanted, v(0.1, 0.5, 0.2), true, None);
    add("around the eye, lamp near the mirrored ray", SLANTED, &around, &slanted, v(0.2, 0.1, -1.9), true, None);
    add("around the eye, lamp outside", SLANTED, &around, &slanted, v(0.0, 4.0, 2.0), false, None);
    // An ellipsoid around the eye, met at (0.6, 0, −0.8) of its unit sphere.
    let (scale, unit) = (v(2.0, 1.0, 3.0), v(0.6, 0.0, -0.8));
    let point = Point { at: P, normal: -(unit / scale).normalize(), view: VIEW };
    let egg = ellipsoid(P - scale * unit, scale, &GLOSS);
    add("an ellipsoid, lamp inside", AXIS, &egg, &point, v(-0.5, 0.3, -1.0), true, None);
    add("an ellipsoid, lamp outside", AXIS, &egg, &point, v(-0.5, 3.0, 1.0), false, None);
    check("inner_walls_are_lit_from_inside_and_shadowed_by_themselves", &cases, Ways::Tuned);
}

/// The light comes from before the image plane: an outer side is lit, and an inner wall keeps it out.
#[test]
fn what_lies_before_the_image_plane_or_just_touches_it_is_cut_away() {
    let lamp = Lamp { at: v(0.0, 0.5, 1.0), intensity: v(0.8, 0.5, 1.1) };
    let front = |z: f64| ball(v(0.0, 0.0, z - 2.0), 2.0, &GLOSS);
    let outer = |z: f64| {
        let point = Point { at: v(0.0, 0.0, z), normal: VIEW, view: VIEW };
        ambient(&GLOSS) + lit(&point, &GLOSS, &lamp, Specular::Phong)
    };
    let mut cases = Vec::new();
    for (name, z, is_cut) in [
        ("before the image plane", -0.9, true),
        ("before it by a little", -0.9999, true),
        ("touching it", -1.0, true),
        ("behind it by less than a millionth", -(1.0 + 5e-7), true),
        ("behind it by a little", -(1.0 + 3e-6), false),
        ("behind it", -1.1, false),
    ] {
        let expected = if is_cut { ambient(&GLOSS) } else { outer(z) };
        cases.push(case(name, AXIS, vec![front(z), self::lamp(&lamp)], expected));
    }
    // Wholly before the image plane: it is not there.
    cases.push(case("a bead before it", AXIS, vec![ball(v(0.0, 0.0, -0.5), 0.4, &GLOSS)], BACK));
    check("what_lies_before_the_image_plane_or_just_touches_it_is_cut_away", &cases, Ways::Tuned);
}

const MIRROR: Material = Material { kr: 0.6, ..GLOSS };

/// Thirty small balls far off the ways of the rays: mirrored rays go through a grid.
fn crowd() -> Vec<String> {
    (0..30).map(|k| ball(v(25.0, f64::from(k) * 2.5 - 30.0, f64::from(k % 5) - 3.0), 1.0, &CLAY)).collect()
}

/// Each case alone, and those that `is_also` says in a crowd.
fn alone_and_in_a_crowd(cases: Vec<Case>, is_also: impl Fn(&str) -> bool) -> Vec<Case> {
    let crowded = |case: &Case| Case {
        name: format!("{} in a crowd", case.name),
        statements: case.statements.iter().cloned().chain(crowd()).collect(),
        settings: case.settings.clone(),
        ..*case
    };
    let crowded: Vec<_> = cases.iter().filter(|case| is_also(&case.name)).map(crowded).collect();
    cases.into_iter().chain(crowded).collect()
}

/// Two mirrors face each other, the eye between them: each bounce adds what the other one shows.
#[test]
fn each_bounce_adds_kr_times_what_it_meets() {
    let ahead = Point { at: P, normal: VIEW, view: VIEW };
    let behind = Point { at: v(0.0, 0.0, 4.0), normal: -VIEW, view: -VIEW };
    let lamp = Lamp { at: v(0.0, 2.0, 0.0), intensity: v(0.3, 0.2, 0.4) };
    let mut cases = Vec::new();
    for (name, first, second) in [("Kr below 1", 0.6, 0.8), ("Kr above 1", 1.3, 0.9), ("one mirror", 0.7, 0.0)] {
        let first = Material { kr: first, ka: 0.1, ..GLOSS };
        let second = Material { kr: second, ka: 0.05, color: v(0.2, 0.5, 0.8), ..GLOSS };
        let statements = vec![outside(&ahead, &first), outside(&behind, &second), self::lamp(&lamp)];
        let shown =
            |point: &Point, material: &Material| ambient(material) + lit(point, material, &lamp, Specular::Phong);
        let surfaces = [(shown(&ahead, &first), first.kr), (shown(&behind, &second), second.kr)];
        for max_depth in [0, 1, 2, 3, 6] {
            let mut expected = DVec3::ZERO;
            let mut weight = 1.0;
            for bounce in 0..=max_depth {
                let (color, kr) = surfaces[bounce % 2];
                expected += weight * color;
                weight *= kr;
            }
            let name = format!("{name}, depth {max_depth}");
            let case = case(name, AXIS, statements.clone(), expected);
            cases.push(case.with(|settings| settings.max_depth = max_depth as u32));
        }
    }
    check(
        "each_bounce_adds_kr_times_what_it_meets",
        &alone_and_in_a_crowd(cases, |name| name == "Kr below 1, depth 3"),
        Ways::All,
    );
}

#[test]
fn a_mirror_shows_what_the_mirrored_ray_meets() {
    let mirror = turned();
    // 2 (N.V) N − V.
    let way = v(0.96, 0.0, 0.28);
    let lamp = Lamp { at: v(2.0, 4.0, 1.0), intensity: v(0.6, 0.5, 0.7) };
    let local = ambient(&MIRROR) + lit(&mirror, &MIRROR, &lamp, Specular::Phong);
    let target = |normal: DVec3| Point { at: P + 5.0 * way, normal, view: -way };
    let shown = |name: &str, spheres: &[String], mirrored: DVec3| {
        let mut statements = vec![outside(&mirror, &MIRROR), self::lamp(&lamp)];
        statements.extend_from_slice(spheres);
        case(name, AXIS, statements, local + MIRROR.kr * mirrored)
    };
    let seen = |point: &Point, material: &Material| ambient(material) + lit(point, material, &lamp, Specular::Phong);
    let head_on = target(-way);
    let oblique = target(v(-0.8, 0.6, 0.0));
    let far = Point { at: P + 9.0 * way, ..head_on };
    let glow = Material { ka: 9.0, color: v(0.4, 0.5, 0.7), ..FLAT };
    let wall = target(v(-0.6, 0.64, -0.48));
    let cases = vec![
        shown("nothing: black, not the background", &[], DVec3::ZERO),
        shown("a ball head-on", &[outside(&head_on, &GLOSS)], seen(&head_on, &GLOSS)),
        shown("a ball from aside", &[outside(&oblique, &GLOSS)], seen(&oblique, &GLOSS)),
        shown("the nearer of two", &[outside(&far, &FLAT), outside(&oblique, &GLOSS)], seen(&oblique, &GLOSS)),
        shown("brighter than white on the way", &[outside(&head_on, &glow)], ambient(&glow)),
        shown("the inner wall of what is around", &[inner_wall(&wall, 9.0, &GLOSS)], seen(&wall, &GLOSS))
            .with(|settings| settings.max_depth = 1),
    ];
    check("a_mirror_shows_what_the_mirrored_ray_meets", &alone_and_in_a_crowd(cases, |_| true), Ways::All);
}

#[test]
fn of_equal_hits_of_a_mirrored_ray_the_first_in_the_file_counts() {
    let mirror = Point { at: P, normal: VIEW, view: VIEW };
    // Both touch the ray's way back through the eye at z = 4.
    let balls = [(0.3, 1.0), (0.8, 0.5)].map(|(red, radius)| {
        let material = Material { color: v(red, 0.4, 0.9), ..FLAT };
        (ball(v(0.0, 0.0, 4.0 + radius), radius, &material), ambient(&material))
    });
    let case = |first: usize| {
        let statements = vec![balls[first].0.clone(), outside(&mirror, &MIRROR), balls[1 - first].0.clone()];
        case(format!("ball {first} first"), AXIS, statements, ambient(&MIRROR) + MIRROR.kr * balls[first].1)
    };
    let cases = alone_and_in_a_crowd(vec![case(0), case(1)], |_| true);
    check("of_equal_hits_of_a_mirrored_ray_the_first_in_the_file_counts", &cases, Ways::All);
}

/// In the classic convention the hit of a mirrored ray counts beyond a thousandth of a unit; the other conventions' hits all do.
#[test]
fn mirrored_rays_count_from_a_thousandth_of_a_unit_or_from_the_start() {
    let mirror = turned();
    let way = v(0.96, 0.0, 0.28);
    let local = ambient(&MIRROR);
    let statements =
        |distance: f64, radius: f64| vec![outside(&mirror, &MIRROR), ball(P + distance * way, radius, &FLAT)];
    // From 0.0003 to 0.0007, from 0.0006 to 0.0014, and from 0.0015 on.
    let (near, across, far) = (statements(5e-4, 2e-4), statements(1e-3, 4e-4), statements(2e-3, 5e-4));
    let shown = local + MIRROR.kr * ambient(&FLAT);
    check(
        "mirrored_rays_count_from_a_thousandth_of_a_unit_or_from_the_start",
        &[
            case("nearer", AXIS, near.clone(), local).only("classic"),
            case("nearer", AXIS, near, shown).only("exact"),
            case("nearer and farther", AXIS, across, shown),
            case("farther", AXIS, far, shown),
        ],
        Ways::All,
    );
}

/// The eye is in a mirror: rays go to and fro through its centre, along its own inner wall's analytic other root.
#[test]
fn a_mirror_from_inside_repeats_its_own_wall() {
    let lamp = Lamp { at: v(0.0, 0.5, 0.3), intensity: v(0.2, 0.25, 0.15) };
    let walls =
        [-2.0, 2.0].map(|z| Point { at: v(0.0, 0.0, z), normal: v(0.0, 0.0, -z / 2.0), view: v(0.0, 0.0, -z / 2.0) });
    let shown = walls.map(|wall| ambient(&MIRROR) + lit(&wall, &MIRROR, &lamp, Specular::Phong));
    let mut cases = Vec::new();
    for max_depth in [0, 1, 2, 5] {
        let expected = (0..=max_depth).map(|k| MIRROR.kr.powi(k) * shown[k as usize % 2]).sum();
        let statements = vec![ball(DVec3::ZERO, 2.0, &MIRROR), self::lamp(&lamp)];
        let case = case(format!("depth {max_depth}"), AXIS, statements, expected);
        cases.push(case.with(|settings| settings.max_depth = max_depth.unsigned_abs()));
    }
    check(
        "a_mirror_from_inside_repeats_its_own_wall",
        &alone_and_in_a_crowd(cases, |name| name == "depth 5"),
        Ways::All,
    );
}

/// The conventions say what the tests above take for granted.
#[test]
fn the_conventions_are_those_of_the_specification() {
    let classic = Settings::classic();
    assert_eq!((classic.sampling, classic.quantize), (SampleOffset::Corner, Quantize::Truncate));
    assert_eq!((classic.specular, classic.max_depth), (Specular::Phong, 3));
    let exact = Settings::exact();
    assert_eq!((exact.sampling, exact.quantize), (SampleOffset::Center, Quantize::Round));
    assert_eq!(classic.secondary, Secondary { shadow: 1e-3, reflection: 1e-3 });
    assert_eq!(exact.secondary, Secondary { shadow: 0.0, reflection: 0.0 });
    assert_eq!((exact.specular, exact.max_depth), (Specular::Phong, 3));
}

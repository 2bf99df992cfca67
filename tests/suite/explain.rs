//! What rounding explains, and what it does not: right pictures have no unexplained pixels, wrong ones nearly nothing else.

use std::fmt::Write as _;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};
use std::process::Command;

use glam::DVec3;
use trueray::accel::Rounding;
use trueray::compare::Explanation;
use trueray::cpu::{Dd, Decision, Finding, Judge, Real, Reference};
use trueray::effects::{Effect, Effects, Request};
use trueray::engine::Backend;
use trueray::film::{Format, Picture, Target};
use trueray::pattern::Pattern;
use trueray::precision::{self, Selection, Tier};
use trueray::scene::{Scene, parse};
use trueray::settings::{Settings, Specular};
use trueray::stress::Random;

use crate::support::{Case, cpu_picture, gpu, gpu_picture, orthographic, root, scene, scene_files, scene_of, widened};

const FOLDERS: [&str; 5] = ["basic", "effects", "refraction", "hard", "show"];

fn conventions() -> [Settings; 2] {
    [Settings::classic(), Settings::exact()]
}

/// The scenes, with no more pixels than a test has time for.
fn scenes(pixels: u32) -> impl Iterator<Item = (String, Scene)> {
    scene_files(&FOLDERS).into_iter().map(move |file| {
        let mut scene = scene(&file);
        while scene.width * scene.height > pixels {
            (scene.width, scene.height) = (scene.width.div_ceil(2), scene.height.div_ceil(2));
        }
        (file.file_stem().unwrap().to_string_lossy().into_owned(), scene)
    })
}

/// The case's picture in another scalar.
fn picture<T: Real>(case: &Case) -> Picture {
    cpu_picture::<T>(&case.scene, &case.settings, &case.effects).0
}

/// What `auto` takes on software devices.
fn tier(case: &Case) -> Tier {
    let ladder = [Tier::Fast, Tier::Double, Tier::Robust];
    Selection::of(&case.scene.viewed(&case.settings), &case.effects, precision::Request::Auto, &ladder).tier
}

/// The unclamped colours of the reference in `T`, by the margins of `f32`.
#[track_caller]
fn assert_colors_explained<T: Real>(case: &Case, what: &str) {
    let trial = Judge::of(Tier::Fast).trial(&case.reference);
    let other = Reference::<T>::new(&case.scene.viewed(&case.settings), &case.effects);
    let (width, height) = case.reference.size();
    for [i, j] in (0..height).flat_map(|j| (0..width).map(move |i| [i, j])) {
        let color = other.color(i, j).unwrap();
        let finding = trial.explain_color(i, j, color);
        let exact = case.reference.color(i, j).unwrap();
        assert!(matches!(finding, Finding::Explained(_)), "{what}: x {i}, y {j}: {color} for {exact}: {finding:?}");
    }
}

fn mapped(picture: &Picture, level: impl Fn(u8) -> u8) -> Picture {
    let rgb = picture.rgb().iter().map(|&old| level(old)).collect();
    Picture::new(picture.width(), picture.height(), rgb).unwrap()
}

/// Each changes levels by one at the least, everywhere or where the scene gives it a reason.
fn gross_mistakes(case: &Case) -> Vec<(&'static str, Picture)> {
    let right = &case.expected;
    let gamma = |level: u8| (255.0 * (f64::from(level) / 255.0).powf(1.0 / 2.2) + 0.5) as u8;
    vec![
        ("black", mapped(right, |_| 0)),
        ("128 more, modulo 256", mapped(right, |level| level ^ 0x80)),
        ("gamma 2.2", mapped(right, gamma)),
        ("254 for 255", mapped(right, |level| level.min(254))),
        ("the lowest bit cleared", mapped(right, |level| level & !1)),
        ("a level more", mapped(right, |level| level.saturating_add(1))),
        ("a level less", mapped(right, |level| level.saturating_sub(1))),
    ]
}

/// Pictures of the scene as a renderer with a fault shows it. Many of their pixels are off by less than a level.
fn faulty_renderers(case: &Case) -> Vec<(&'static str, Picture)> {
    let render = |scene: &Scene, settings: &Settings| {
        cpu_picture::<f64>(scene, settings, &Effects::of(&scene.viewed(settings))).0
    };
    let changed = |change: fn(&mut Scene)| {
        let mut scene = case.scene.clone();
        change(&mut scene);
        render(&scene, &case.settings)
    };
    let unshadowed =
        Effects::requested(&case.scene.viewed(&case.settings), &Request::Changed(vec![(Effect::Shadows, false)]));
    vec![
        ("depth 1", render(&case.scene, &Settings { max_depth: 1, ..case.settings })),
        ("Kr a third more", changed(|scene| scene.spheres.iter_mut().for_each(|s| s.kr *= 4.0 / 3.0))),
        ("no shadows", cpu_picture::<f64>(&case.scene, &case.settings, &unshadowed).0),
        ("a hundredth larger", changed(|scene| scene.spheres.iter_mut().for_each(|s| s.scale *= 1.01))),
    ]
}

/// Counts of differing pixels and of unexplained ones among them.
#[derive(Debug, Default, Clone, Copy)]
struct Found {
    differing: u64,
    unexplained: u64,
}

impl Found {
    fn add(&mut self, explanation: &Explanation) {
        self.differing += explanation.differing;
        self.unexplained += explanation.unexplained;
    }

    /// Whether this share of the wrong pixels is unexplained; one or two alone may happen to stand at an edge or a step.
    fn is_at_least(&self, share: f64) -> bool {
        let explained = (self.differing - self.unexplained) as f64;
        explained <= ((1.0 - share) * self.differing as f64).max(2.0)
    }
}

#[test]
fn wrong_pictures_stay_unexplained() {
    let mut worst = Vec::new();
    // Of the pixels that are judged again by who counts every rounding.
    let (mut again, mut proven) = (0, 0);
    for (name, scene) in scenes(10_000) {
        for settings in conventions() {
            let case = Case::new(&scene, &settings);
            let judge = Judge::of(tier(&case));
            for (least, mistakes) in [(0.99, gross_mistakes(&case)), (0.95, faulty_renderers(&case))] {
                let mut all = Found::default();
                for (what, wrong) in mistakes {
                    let explanation = case.explained(&wrong, judge);
                    let mut found = Found::default();
                    found.add(&explanation);
                    all.add(&explanation);
                    again += explanation.unexplained.min(1000);
                    proven += explanation.proven;
                    // Of one kind alone there may be but a few hundred wrong pixels.
                    if !found.is_at_least(2.0 * least - 1.0 - 0.03) {
                        worst.push(format!("{name}, {:?}, {what}:\n{}", settings.sampling, explanation.report()));
                    }
                }
                if !all.is_at_least(least) {
                    worst.push(format!("{name}, {:?}: {all:?}", settings.sampling));
                }
            }
        }
    }
    assert!(worst.is_empty(), "{}", worst.join("\n"));
    assert!(proven <= again && 10 * proven >= 9 * again, "{proven} of {again}");
}

/// What moves colours by hundredths of a level is found as well.
#[test]
fn small_mistakes_are_found_in_ordinary_scenes() {
    for (growth, least) in [(1e-3, 0.97), (1e-4, 0.8), (1e-5, 0.2)] {
        let mut found = Found::default();
        for file in ["basic/seventeen-lights", "basic/odd-size", "effects/everything", "show/showcase"] {
            let scene = scene(&root().join(format!("scenes/{file}.txt")));
            let case = Case::new(&scene, &Settings::classic());
            let mut grown = scene.clone();
            grown.spheres.iter_mut().for_each(|sphere| sphere.scale *= 1.0 + growth);
            let wrong = cpu_picture::<f64>(&grown, &case.settings, &case.effects).0;
            found.add(&case.explained(&wrong, Judge::of(Tier::Fast)));
        }
        println!("{growth}: {found:?}");
        assert!(found.is_at_least(least), "{growth}: {found:?}");
    }
}

/// `f32` whose quotients and roots are off by as much as Vulkan allows.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Loose(f32);

impl Loose {
    /// Off by up to two units in the last place, by its own bits.
    fn off(x: f32) -> Self {
        if x == 0.0 || !x.is_finite() {
            return Self(x);
        }
        let hash = u64::from(x.to_bits() ^ 0x5bd1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let units = 4.0 * (hash as f64 / (1_u64 << 24) as f64) - 2.0;
        Self((f64::from(x) * (1.0 + units * f64::from(f32::EPSILON))) as f32)
    }
}

impl Add for Loose {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Loose {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Loose {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for Loose {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if self == other { Self::ONE } else { Self::off(self.0 / other.0) }
    }
}

impl Neg for Loose {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Loose {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl MulAssign for Loose {
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

impl Real for Loose {
    const PROVES: bool = false;
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const FAR: Self = Self(f32::FAR);
    const MAX_THROUGHPUT: Self = Self(f32::MAX_THROUGHPUT);
    const UNIT: f64 = f32::UNIT;
    const ROUNDING: Rounding = f32::ROUNDING;

    fn from_f64(x: f64) -> Self {
        Self(x as f32)
    }
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn sqrt(self) -> Self {
        Self::off(self.0.sqrt())
    }
    fn exp(self) -> Self {
        Self(self.0.exp())
    }
    fn log1p(self) -> Self {
        Self(self.0.ln_1p())
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

/// Discs, needles, mirrors as large as floors, near contacts, glass, ellipsoids; everything in each, but mostly of one kind.
fn random_scene(seed: u64, width: u32) -> Scene {
    let mut random = Random::new(seed, 0);
    let mut text = format!("NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -0.75\nTOP 0.75\nRES {width} {}\n", width * 3 / 4);
    let _ = writeln!(text, "BACK {} 0.5 0.7\nAMBIENT 0.3 0.25 0.2", random.within(0.0, 1.0));
    let (mut last_center, mut last_radius) = (DVec3::new(0.0, 0.0, -5.0), 1.0);
    for index in 0..2 + random.bits() % 9 {
        let kind = if random.within(0.0, 1.0) < 0.6 { seed % 6 } else { random.bits() % 6 };
        let mut scale = DVec3::splat(random.within(0.3, 1.2));
        let mut center = random.in_box(1.0) * DVec3::new(3.0, 2.2, 3.0) + DVec3::new(0.0, 0.0, -5.8);
        let axis = (random.bits() % 3) as usize;
        match kind {
            0 => scale[axis] *= 10.0_f64.powf(-random.within(0.5, 3.5)),
            1 => {
                let long = scale[axis];
                scale *= 10.0_f64.powf(-random.within(0.5, 2.0));
                scale[axis] = long;
            }
            2 => {
                scale *= 10.0_f64.powf(random.within(0.0, 2.5));
                center = DVec3::new(random.within(-2.0, 2.0), -scale.x - random.within(0.5, 1.5), -6.0);
            }
            3 => {
                let gap = [0.0, 1e-7, random.within(-1e-3, 1e-3)][axis];
                center = last_center + random.unit() * (last_radius + scale.x + gap);
            }
            5 => scale = DVec3::splat(0.6) + random.in_box(0.4),
            _ => {}
        }
        (last_center, last_radius) = (center, scale.x);
        let mirror = if kind == 2 || random.within(0.0, 1.0) < 0.4 { random.within(0.1, 1.0) } else { 0.0 };
        let exponent = [0.0, 1.0, 10.0, 100.0, 3000.0][(random.bits() % 5) as usize];
        let glass =
            if kind == 4 { format!("{} {}", random.within(0.2, 1.0), random.within(1.05, 2.4)) } else { String::new() };
        let [r, g, b, ka, kd, ks] = [1.0, 1.0, 1.0, 0.6, 0.9, 0.8].map(|most| random.within(0.0, most));
        let (c, s) = (center, scale);
        let _ = writeln!(
            text,
            "SPHERE s{index} {} {} {} {} {} {} {r} {g} {b} {ka} {kd} {ks} {mirror} {exponent} {glass}",
            c.x, c.y, c.z, s.x, s.y, s.z
        );
    }
    for index in 0..=random.bits() % 4 {
        let place = random.in_box(1.0) * DVec3::new(8.0, 6.0, 6.0) + DVec3::new(0.0, 2.0, -1.0);
        let [r, g, b] = [(); 3].map(|()| random.within(0.0, 1.0));
        let _ = writeln!(text, "LIGHT l{index} {} {} {} {r} {g} {b}", place.x, place.y, place.z);
    }
    let parsed = parse("random", text.as_bytes());
    parsed.scene.clone().unwrap_or_else(|| panic!("{}", parsed.report(false)))
}

/// By every tier, in plain `f32` on the CPU, with loose quotients and with more digits than the reference has.
/// `TRUERAY_EXPLAIN_SCENES` and `TRUERAY_EXPLAIN_WIDTH` make a long run of it.
#[test]
fn right_pictures_of_random_scenes_are_explained() {
    let number = |variable, default| std::env::var(variable).map_or(default, |value| value.parse().unwrap());
    let (count, width) = (number("TRUERAY_EXPLAIN_SCENES", 48), number("TRUERAY_EXPLAIN_WIDTH", 64) as u32);
    let gpu = gpu("right_pictures_of_random_scenes_are_explained");
    let (mut pixels, mut differing) = (0, 0);
    for seed in 0..count {
        let eyed = random_scene(seed, width);
        let wide = widened(eyed.clone());
        let [classic, exact] = conventions();
        for (scene, settings) in [(&eyed, classic), (&eyed, exact), (&wide, orthographic(exact))] {
            let deep =
                Settings { pattern: Pattern::Grid { side: 2 }, specular: Specular::Blinn, max_depth: 5, ..settings };
            let case = Case::new(scene, if seed % 5 == 4 { &deep } else { &settings });
            let name = |what| format!("seed {seed}, {:?}, {what}", settings.sampling);
            let mut pictures = vec![
                ("f32", picture::<f32>(&case), Judge::of(Tier::Fast)),
                ("loose", picture::<Loose>(&case), Judge::of(Tier::Fast)),
                ("double-double", picture::<Dd>(&case), Judge::of(Tier::Double)),
            ];
            if let Some(gpu) = &gpu {
                for tier in Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
                    let (picture, _) = gpu_picture(gpu, tier, scene, &case.settings, &case.effects);
                    pictures.push((tier.name(), picture, Backend::Device(gpu, tier).judge()));
                }
            }
            // Each colour, not only those at a step.
            assert_colors_explained::<f32>(&case, &name("f32"));
            assert_colors_explained::<Loose>(&case, &name("loose"));
            for (what, picture, judge) in pictures {
                pixels += case.expected.pixel_count();
                differing += case.assert_explained(&name(what), &picture, judge).differing;
            }
        }
    }
    println!("{pixels} pixels, of which {differing} differ");
    assert!(differing > 0);
}

/// The reference in double-double against that in `f64`, by the margins of `f64`; a scene with the Sun where it is.
#[test]
fn more_digits_than_the_reference_has_are_explained() {
    let sun = "SPHERE ball 0.5 -0.5 -5.3 0.5 0.5 0.5 0.2 0.5 0.9 0.3 0.6 0.2 0 50\n\
               SPHERE big -1.3 -0.2 -6 0.8 0.8 0.8 0.7 0.4 0.5 0.4 0.7 0.1 0 50\n\
               SPHERE floor 0 -1.2 -5.5 4 0.2 3 0.7 0.8 0.7 0.3 0.7 0 0 20\n\
               LIGHT sun 45406837453.08622 121084899874.89659 60542449937.448296 0.9 0.9 0.8\n\
               BACK 0.7 0.8 0.2\nAMBIENT 0.2 0.2 0.2";
    for (name, scene) in scenes(3000).chain([("sun".to_owned(), scene_of(sun))]) {
        for settings in conventions() {
            let case = Case::new(&scene, &settings);
            case.assert_explained(&name, &picture::<Dd>(&case), Judge::of(Tier::Double));
        }
    }
}

/// The kinds of decisions that explain `picture`, and how many pixels nothing does.
fn findings(scene: &Scene, picture: &Picture) -> (Vec<Decision>, u64) {
    let explanation = Case::new(scene, &Settings::classic()).explained(picture, Judge::of(Tier::Fast));
    (explanation.explained.into_keys().collect(), explanation.unexplained)
}

/// The picture of `scene` with pixel (19, 20) as it is in that of `other`.
fn with_pixel_of(scene: &Scene, other: &Scene) -> Picture {
    let mut rgb = Case::new(scene, &Settings::classic()).expected.rgb().to_vec();
    let pixel = (20 * scene.width as usize + 19) * 3;
    rgb[pixel..pixel + 3].copy_from_slice(&Case::new(other, &Settings::classic()).expected.rgb()[pixel..pixel + 3]);
    Picture::new(scene.width, scene.height, rgb).unwrap()
}

/// A decision explains what the path shows on which it is taken the other way, and no other value.
#[test]
fn decisions_explain_their_own_other_side_alone() {
    let lit = "AMBIENT 1 1 1\nLIGHT l 0 0 5 0.5 0.5 0.5\n";
    // The ray of pixel (19, 20) is along (-0.05, 0, -1).
    let edge = |size: f64| {
        // Its distance from the centre is that of the sphere's surface, but for little.
        let distance = (1.0 - 5.0 * 0.05) / (1.0_f64 + 0.05 * 0.05).sqrt();
        let radius = distance * size;
        scene_of(&format!(
            "SPHERE s -1 0 -5 {radius} {radius} {radius} 0.9 0.5 0.2 0.4 0 0 0 1\nBACK 0.1 0.2 0.8\n{lit}"
        ))
    };
    let tie = |ahead: f64| {
        scene_of(&format!(
            "SPHERE a 0 0 -5 1 1 1 0.9 0.5 0.2 0.4 0 0 0 1\nSPHERE b 0 0 -5 {ahead} {ahead} {ahead} 0.1 0.3 0.8 0.7 0 0 0 1\n{lit}"
        ))
    };
    let shadow = |size: f64| {
        // Where the ray meets the sphere, and halfway from there to the light.
        let (a, b) = (1.0 + 0.05 * 0.05, 5.0_f64);
        let hit = DVec3::new(-0.05, 0.0, -1.0) * ((b - (b * b - a * 24.0).sqrt()) / a);
        let (middle, radius) = (0.5 * (hit + DVec3::new(3.0, 0.0, 2.0)), 0.1 * size);
        scene_of(&format!(
            "SPHERE far 0 0 -5 1 1 1 0.9 0.5 0.2 0.2 0.7 0 0 1\nLIGHT l 3 0 2 0.5 0.5 0.5\nAMBIENT 1 1 1\n\
             SPHERE s {} {} {} {radius} {radius} {radius} 1 1 1 0 0 0 0 1",
            middle.x,
            middle.y + 0.1,
            middle.z
        ))
    };
    for (scene, other, decision) in [
        (edge(1.0 - 1e-8), edge(1.0 + 1e-8), Decision::Silhouette),
        (edge(1.0 + 1e-8), edge(1.0 - 1e-8), Decision::Silhouette),
        (tie(1.0 - 1e-8), tie(1.0 + 1e-8), Decision::Tie),
        (shadow(1.0 - 1e-8), shadow(1.0 + 1e-8), Decision::ShadowEdge),
        (shadow(1.0 + 1e-8), shadow(1.0 - 1e-8), Decision::ShadowEdge),
    ] {
        let picture = with_pixel_of(&scene, &other);
        assert_eq!(findings(&scene, &picture), (vec![decision], 0));
        // Any other value is not that of the other side.
        let pixel = (20 * 40 + 19) * 3;
        for level in [0, 1, 37, 128, 254, 255] {
            let mut rgb = picture.rgb().to_vec();
            rgb[pixel] = level;
            let wrong = Picture::new(40, 40, rgb).unwrap();
            assert_eq!(findings(&scene, &wrong).1, 1, "{decision:?}, level {level}");
        }
    }
    // Where the sphere is surely there, nothing excuses the background.
    assert_eq!(findings(&edge(1.01), &with_pixel_of(&edge(1.01), &edge(0.99))).1, 1);
}

/// What is not rounded has no margin: the background, ambient light, what is clamped.
#[test]
fn constants_have_no_margin() {
    let scenes = [
        "BACK 1 0.6 0.2",
        "BACK 1 1 1\nSPHERE s 0 0 -5 1 1 1 1 0.5 0.25 0.5 0 0 0 1\nAMBIENT 1 1 1",
        "SPHERE s 0 0 -2 9 9 9 1 1 1 1 1 0 0 1\nAMBIENT 2 2 2\nLIGHT l 1 1 0 1 1 1",
        "SPHERE m 0 0 -5 3 3 3 0 0 0 0 0 0 0.5 1\nSPHERE w 0 0 0 99 99 99 1 1 1 0.5 0 0 0 1\nAMBIENT 1 1 1",
    ];
    for text in scenes {
        let scene = scene_of(text);
        for settings in conventions() {
            let case = Case::new(&scene, &settings);
            for tier in Tier::ALL {
                for (less, more) in [(1, 0), (0, 1)] {
                    let wrong = mapped(&case.expected, |level| level.saturating_sub(less).saturating_add(more));
                    let explanation = case.explained(&wrong, Judge::of(tier));
                    let right = explanation.differing - explanation.unexplained;
                    assert!(right * 100 <= explanation.differing, "{text}, {tier}:\n{}", explanation.report());
                }
            }
        }
    }
}

/// Balls of metal on a mirror of radius 5000: rounding moves much of what it shows, but not just anywhere.
const FLOOR: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -.75\nTOP .75\nRES 160 120\n\
    SPHERE s0 -146.25 69.487 -629.13 47.855 47.855 47.855 0.596 0.560 0.721 0.3 0.6 0.4 0.5 30\n\
    SPHERE s1 115.49 -81.228 -408.5 88.504 88.504 88.504 0.546 0.810 0.202 0.3 0.6 0.4 0.5 30\n\
    SPHERE s2 -21.845 44.308 -468.63 96.169 96.169 96.169 0.921 0.224 0.220 0.3 0.6 0.4 0.5 30\n\
    SPHERE floor 0 -5100 -500 5000 5000 5000 0.7 0.8 0.7 0.3 0.5 0 0.3 20\n\
    LIGHT l 300 600 200 0.8 0.8 0.8\nBACK .2 .3 .5\nAMBIENT .3 .3 .3\n";

#[test]
fn the_command_line_refuses_wrong_pictures_and_says_as_what_it_judged() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    std::fs::write(path("floor.txt"), FLOOR).unwrap();
    std::fs::write(path("bright.txt"), FLOOR.replace("0.5 0 0.3 20", "0.5 0 0.4 20")).unwrap();
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_trueray")).args(arguments).current_dir(place.path()).output().unwrap()
    };
    let earth = root().join("scenes/hard/earth-at-one-metre.txt");
    let earth = earth.to_str().unwrap();
    let size = scene(earth.as_ref());
    let black = Picture::new(size.width, size.height, vec![0; (size.width * size.height * 3) as usize]).unwrap();
    black.save(&Target::from_argument(path("black.ppm").as_os_str()), Format::default()).unwrap();
    assert!(
        run(&["render", "-q", "--device", "cpu", "--max-depth", "1", "-o", "depth.ppm", "floor.txt"]).status.success()
    );
    assert!(run(&["render", "-q", "--device", "cpu", "-o", "bright.ppm", "bright.txt"]).status.success());
    assert!(run(&["render", "-q", "--device", "cpu", "-o", "right.ppm", "floor.txt"]).status.success());
    // Pairs of f32 judge no finer than robust.
    let has_f64 = gpu("the_command_line_refuses_wrong_pictures").is_none_or(|gpu| gpu.device.info.f64);
    let double = if has_f64 { "double" } else { "robust" };
    for (arguments, code, judged_as) in [
        (["--scene", earth, "black.ppm"].as_slice(), 1, double),
        (&["--scene", earth, "black.ppm", "--precision", "robust"], 1, "robust"),
        (&["--scene", "floor.txt", "depth.ppm", "--precision", "fast"], 1, "fast"),
        (&["--scene", "floor.txt", "depth.ppm"], 1, ""),
        (&["--scene", "floor.txt", "bright.ppm", "--precision", "fast"], 1, "fast"),
        (&["--scene", "floor.txt", "right.ppm", "--device", "cpu"], 0, "double"),
    ] {
        let text = run(&[&["compare"], arguments].concat());
        let said = String::from_utf8_lossy(&text.stdout).into_owned();
        assert_eq!(text.status.code(), Some(code), "{arguments:?}\n{said}");
        assert!(said.contains(&format!("judged as         {judged_as}")), "{said}");
        let json = run(&[&["compare", "--json"], arguments].concat());
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        let explanation = &json["explanation"];
        assert!(explanation["judged_as"].as_str().unwrap().contains(judged_as), "{json}");
        let [differing, unexplained] = ["differing", "unexplained"].map(|key| explanation[key].as_f64().unwrap());
        assert!(unexplained >= 0.99 * differing, "{json}");
    }
}

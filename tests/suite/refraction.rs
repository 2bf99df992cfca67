//! Refraction: Snell's law against formulas of its own, depth, the stack, glass that cannot be seen, odd indices.

use glam::DVec3;
use proptest::prelude::*;
use trueray::compare::{Difference, Explanation};
use trueray::cpu::oracle::{GlassBody, Passage, refracted};
use trueray::cpu::{Dd, Judge, Reference};
use trueray::effects::{Effects, Request};
use trueray::engine::Backend;
use trueray::film::Picture;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{Case, cpu_picture, gpu, gpu_picture, pairs, root, say_skipped, scene, scene_files, scene_of};

fn ball(eta: f64) -> GlassBody {
    GlassBody { center: DVec3::ZERO, scale: DVec3::ONE, eta }
}

/// The path of a ray that comes down the z axis at `b` from it, in `f64` and in double-double.
fn passages(b: f64, body: GlassBody, bounces: u32) -> [Passage; 2] {
    let (origin, direction) = (DVec3::new(b, 0.0, 5.0), DVec3::NEG_Z);
    [refracted::<f64>(origin, direction, &[body], bounces), refracted::<Dd>(origin, direction, &[body], bounces)]
}

/// −z, turned by `angle` towards −x.
fn turned(angle: f64) -> DVec3 {
    DVec3::new(-angle.sin(), 0.0, -angle.cos())
}

/// A ball turns a ray by the difference of the angles on the way in, and by as much on the way out.
#[test]
fn a_ball_bends_as_the_angles_say() {
    for eta in [0.5, 0.75, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.0 + 1e-3, 1.33, 1.5, 2.5, 100.0] {
        for b in [0.0, 1e-9, 0.1, 0.3, 0.49, 0.7, 0.9, 0.999] {
            if b >= eta {
                continue;
            }
            let (outer, inner) = (f64::asin(b), f64::asin(b / eta));
            for (bounces, angle) in [(1, outer - inner), (2, 2.0 * (outer - inner))] {
                // On the way out errors of an angle grow by eta and more.
                for (passage, at_most) in passages(b, ball(eta), bounces).iter().zip([1e-12 * eta.max(1.0), 1e-13]) {
                    let error = (passage.direction - turned(angle)).length();
                    assert!(error < at_most, "eta {eta}, b {b}, {bounces}: {error:.1e}");
                }
            }
            // The chord between the two has the length 2 cos.
            for passage in passages(b, ball(eta), 1) {
                let (t, _, inside) = passage.hit.unwrap();
                assert!(inside && (t - 2.0 * inner.cos()).abs() < 1e-12, "eta {eta}, b {b}: {t}");
            }
        }
    }
}

/// Beyond the critical angle a bubble is a mirror; a ray that was born in glass goes round and round.
#[test]
fn beyond_the_critical_angle_all_is_reflected() {
    for b in [0.750_000_1, 0.8, 0.999] {
        for passage in passages(b, ball(0.75), 1) {
            let mirrored = turned(2.0 * f64::asin(b) - std::f64::consts::PI);
            assert!((passage.direction - mirrored).length() < 1e-12, "{b}: {passage:?}");
            assert_eq!(passage.hit, None);
        }
    }
    // Starts inside, at b from the centre; every chord is as long as the first whole one.
    for (b, eta) in [(0.7, 1.5), (0.5, 2.5), (0.99, 1.1)] {
        let (origin, direction) = (DVec3::new(b, 0.0, 0.0), DVec3::NEG_Z);
        for bounces in 1..6 {
            let passage = refracted::<f64>(origin, direction, &[ball(eta)], bounces);
            let (t, _, inside) = passage.hit.unwrap();
            let chord = 2.0 * (1.0 - b * b).sqrt();
            assert!(inside && (t - chord).abs() < 1e-13 * f64::from(bounces), "{b}: {t}, not {chord}");
        }
    }
    // Within the critical angle the same ray leaves with eta.
    let passage = refracted::<f64>(DVec3::new(0.5, 0.0, 0.0), DVec3::NEG_Z, &[ball(1.5)], 1);
    let out = turned(f64::asin(0.75) - f64::asin(0.5));
    assert!((passage.direction - out).length() < 1e-13, "{passage:?}");
    assert_eq!(passage.hit, None);
}

proptest! {
    /// Snell's law as cross products, at any ellipsoid: n × t = (n × d)/eta, and the length of the direction stays.
    #[test]
    fn cross_products_with_the_normal_keep_their_ratio(
        target in [-0.7_f64..0.7, -0.7..0.7, -0.7..0.7],
        axes in [0.2_f64..3.0, 0.2..3.0, 0.2..3.0],
        eta in prop_oneof![0.3_f64..3.0, 0.999_999..1.000_001],
        length in 0.1_f64..10.0,
    ) {
        let (scale, target) = (DVec3::from_array(axes), DVec3::from_array(target) * 0.8);
        let origin = DVec3::new(4.0, 5.0, 6.0);
        let direction = (target * scale - origin).normalize() * length;
        let body = GlassBody { center: DVec3::ZERO, scale, eta };
        let passage = refracted::<f64>(origin, direction, &[body], 1);
        let place = passage.origin;
        prop_assert!(((place / scale).length() - 1.0).abs() < 1e-13);
        let normal = (place / (scale * scale)).normalize();
        let (d, t) = (direction / length, passage.direction / passage.direction.length());
        let sine = normal.cross(d).length() / eta;
        if sine < 1.0 {
            prop_assert!((passage.direction.length() / length - 1.0).abs() < 1e-13);
            prop_assert!((normal.cross(t) - normal.cross(d) / eta).length() < 1e-13 / eta.min(1.0));
            prop_assert!(normal.dot(t) < 0.0);
        } else {
            prop_assert!((normal.dot(t) + normal.dot(d)).abs() < 1e-13 && normal.dot(t) > 0.0);
        }
    }

    /// eta = 1 leaves the direction as it is, to the last bit, in and out.
    #[test]
    fn no_bend_without_a_ratio(
        direction in [-1.0_f64..1.0, -1.0..1.0, -9.0..-0.1],
        b in [-0.9_f64..0.9, -0.9..0.9],
        axes in [0.7_f64..3.0, 0.7..3.0, 0.01..3.0],
    ) {
        let direction = DVec3::from_array(direction);
        let scale = DVec3::from_array(axes);
        let through = DVec3::new(b[0] * scale.x, b[1] * scale.y, 0.0) * 0.7;
        let body = GlassBody { center: DVec3::ZERO, scale, eta: 1.0 };
        for bounces in 1..3 {
            let passage = refracted::<f64>(through - direction * 20.0, direction, &[body], bounces);
            prop_assert_eq!(passage.direction, direction);
            prop_assert_eq!(passage.hit.is_some(), bounces == 1);
        }
    }
}

fn conventions() -> [Settings; 2] {
    [Settings::classic(), Settings::exact()]
}

/// Everything that renders, by name: the reference and each tier of the device.
fn pictures(scene: &Scene, settings: &Settings, test: &str) -> Vec<(String, Picture)> {
    let effects = Effects::of(&scene.viewed(settings));
    let (picture, not_finite) = cpu_picture::<f64>(scene, settings, &effects);
    assert_eq!(not_finite, 0);
    let mut pictures = vec![("reference".to_owned(), picture)];
    if let Some(gpu) = gpu(test) {
        for tier in Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
            let (picture, not_finite) = gpu_picture(&gpu, tier, scene, settings, &effects);
            assert_eq!(not_finite, 0, "{tier}");
            pictures.push((tier.to_string(), picture));
        }
    }
    pictures
}

/// Nor in mirrors: behind them a ray shows black as long as it hits nothing, whatever it passes.
#[test]
fn air_is_not_seen_in_mirrors_either() {
    let walls = "SPHERE m -1.5 0 -9 1 1 1 0.9 0.2 0.2 0.4 0.6 0.5 0.3 30\nSPHERE n 1.5 1 -9 1 1 1 0.2 0.9 0.2 0.4 0.6 0.5 0.3 30\n\
                 LIGHT l 3 5 -7 0.8 0.8 0.8\nAMBIENT 0.5 0.5 0.5\nBACK 0.8 0.7 0.6\n";
    let air = "SPHERE a 0 0 -3 1 1 1 0.5 0.5 0.5 0 0 0 0 1 1 1\nSPHERE b 0.2 0.1 -6 1 1 1 0.5 0.5 0.5 0 0 0 0 1 1 1\n";
    for base in conventions() {
        let settings = Settings { max_depth: 8, ..base };
        let [with, without] = [format!("{walls}{air}"), walls.into()]
            .map(|text| pictures(&scene_of(&text), &settings, "air_is_not_seen_in_mirrors_either"));
        for ((name, with), (_, without)) in with.iter().zip(&without) {
            assert!(with == without, "{name}");
        }
    }
}

/// Bodies of air in air cannot be seen.
#[test]
fn glass_with_an_index_of_one_is_invisible() {
    let mut with = scene(&root().join("scenes/refraction/invisible.txt"));
    (with.width, with.height) = (397, 301);
    let mut without = with.clone();
    without.spheres.retain(|sphere| sphere.kt == 0.0);
    assert_eq!(with.spheres.len() - without.spheres.len(), 3);
    for base in conventions() {
        let settings = Settings { max_depth: 8, ..base };
        let [with, without] =
            [&with, &without].map(|scene| pictures(scene, &settings, "glass_with_an_index_of_one_is_invisible"));
        for ((name, with), (_, without)) in with.iter().zip(&without) {
            let difference = Difference::between(with, without).unwrap();
            // Single precision may move a silhouette by a rounding.
            let at_most = if ["reference", "double"].contains(&name.as_str()) { 0 } else { 5 };
            assert!(difference.differing.over_0 <= at_most, "{name}: {:?}", difference.differing);
        }
    }
}

/// A pillar of light in the middle of the picture: each surface adds Ka, and what each depth adds follows by hand.
#[test]
fn each_depth_adds_what_it_must() {
    const KA: f64 = 0.01;
    const KR: f64 = 0.5;
    const KT: f64 = 0.5;
    const BACK: f64 = 0.4;
    // From inside, with so much depth left: the mirrored ray meets the wall again, the refracted one the background, which
    // only rays show that were never mirrored.
    fn inner(depth: u32, background: f64) -> f64 {
        if depth == 0 { KA } else { KA + KR * inner(depth - 1, 0.0) + KT * background }
    }
    let mut scene =
        scene_of(&format!("SPHERE s 0 0 -5 1 1 1 1 1 1 {KA} 0 0 {KR} 1 {KT} 1.5\nAMBIENT 1 1 1\nBACK {BACK} 0 0"));
    (scene.width, scene.height) = (9, 9);
    for base in conventions() {
        for max_depth in 0..=12 {
            let settings = Settings { max_depth, sampling: Settings::exact().sampling, ..base };
            let expected = if max_depth == 0 { KA } else { KA + KT * inner(max_depth - 1, BACK) };
            let effects = Effects::of(&scene.viewed(&settings));
            assert_eq!(effects.depth, max_depth);
            let color = Reference::<f64>::new(&scene.viewed(&settings), &effects).color(4, 4).unwrap();
            assert!((color.x - expected).abs() < 1e-14, "depth {max_depth}: {} instead of {expected}", color.x);
            for (name, picture) in pictures(&scene, &settings, "each_depth_adds_what_it_must") {
                let level = settings.quantize.levels(DVec3::splat(expected))[0];
                assert!(picture.pixel(4, 4)[0].abs_diff(level) <= 1, "{name}, depth {max_depth}");
            }
        }
    }
}

/// Full trees: the rays of every depth wait beside each other. A stack that is too small loses or overwrites some.
#[test]
fn deep_trees_fit_the_stack() {
    let mut scene = scene(&root().join("scenes/refraction/deep.txt"));
    (scene.width, scene.height) = (32, 24);
    for max_depth in [1, 2, 7, 13] {
        let settings = Settings { max_depth, ..Settings::exact() };
        let effects = Effects::of(&scene.viewed(&settings));
        assert_eq!((effects.depth, effects.waiting(&scene)), (max_depth, max_depth));
        let all = pictures(&scene, &settings, "deep_trees_fit_the_stack");
        for (name, picture) in all.iter().filter(|(name, _)| name == "double") {
            assert!(*picture == all[0].1, "{name}, depth {max_depth}");
        }
    }
    // Chains never branch: one place is enough, however deep.
    let chain =
        scene_of("SPHERE s 0 0 -5 1 1 1 1 1 1 1 0 0 0 1 0.9 1.5\nSPHERE m 3 0 -5 1 1 1 1 1 1 1 0 0 1 1\nAMBIENT 1 1 1");
    let settings = Settings { max_depth: 1000, ..Settings::exact() };
    assert_eq!(Effects::of(&chain.viewed(&settings)).waiting(&chain), 1);
    let none = Effects::requested(&chain.viewed(&settings), &"-refraction".parse().unwrap());
    assert_eq!(none.waiting(&chain), 0);
}

/// Indices beyond the range of the scalars give a picture all the same.
#[test]
fn odd_indices_stay_finite() {
    for eta in ["1e-300", "1e-30", "1e-10", "0.9999999", "1.0000001", "1e10", "1e30", "1e300"] {
        let scene = scene_of(&format!(
            "SPHERE a 0 0 -5 1.5 1.5 1.5 1 1 1 0.1 0.5 0.5 0.9 9 1.1 {eta}\nSPHERE b 0.2 0.3 -5 0.7 0.4 0.5 1 1 1 0.1 0.5 0.5 0.9 9 1.1 {eta}\n\
             SPHERE c 0 0 -1 0.6 0.6 0.6 1 1 1 0.1 0.5 0.5 0 9 1 {eta}\nLIGHT l 3 3 3 1 1 1\nAMBIENT 1 1 1\nBACK 0.2 0.3 0.4"
        ));
        for base in conventions() {
            let settings = Settings { max_depth: 8, ..base };
            pictures(&scene, &settings, "odd_indices_stay_finite");
            let (_, not_finite) = cpu_picture::<f32>(&scene, &settings, &Effects::of(&scene.viewed(&settings)));
            assert_eq!(not_finite, 0, "{eta}");
        }
    }
}

/// Kt and Kr beyond 1 at great depth overflow nothing.
#[test]
fn glass_that_amplifies_stays_finite() {
    let text =
        "SPHERE a 0 0 -5 1 1 1 1 1 1 1 0 0 0 1 1e30 1.5\nSPHERE m 0 0 -5 9 9 9 1 1 1 1 0 0 1e30 1\nAMBIENT 1 1 1";
    for base in conventions() {
        pictures(&scene_of(text), &Settings { max_depth: 60, ..base }, "glass_that_amplifies_stays_finite");
    }
}

/// The kernel of `double` on devices without `f64`, which render nothing else that way here.
#[test]
fn pairs_differ_from_the_reference_only_where_explained() {
    if gpu("pairs_differ_from_the_reference_only_where_explained").is_none() {
        return;
    }
    let gpu = pairs().unwrap();
    if gpu.kernel(Tier::Double).is_err() {
        return say_skipped("pairs_differ_from_the_reference_only_where_explained", "no error-free transforms");
    }
    for file in scene_files(&["refraction"]) {
        for settings in conventions() {
            let (case, name) = (Case::of(&file, &settings), file.display().to_string());
            let (picture, not_finite) = gpu_picture(&gpu, Tier::Double, &case.scene, &settings, &case.effects);
            assert_eq!(not_finite, 0, "{name}");
            case.assert_explained(&name, &picture, Backend::Device(&gpu, Tier::Double).judge());
        }
    }
}

/// A picture of other glass is wrong, and the margins do not excuse it. Only glass differs, which is full of edges.
#[test]
fn wrong_glass_stays_unexplained() {
    type Mistake = fn(&mut Scene);
    let settings = Settings::exact();
    let mistakes: [(&str, Mistake); 4] = [
        ("eta upside down", |scene| scene.spheres.iter_mut().for_each(|s| s.eta = 1.0 / s.eta)),
        ("another eta", |scene| scene.spheres.iter_mut().for_each(|s| s.eta = 1.0 + (s.eta - 1.0) * 1.1)),
        ("Kt forgotten", |scene| scene.spheres.iter_mut().for_each(|s| s.kt = 0.0)),
        ("Kt a little less", |scene| scene.spheres.iter_mut().for_each(|s| s.kt *= 0.97)),
    ];
    for file in ["glass-ball", "total-reflection", "glass-in-glass", "bubbles", "ellipsoids", "eye-inside"] {
        let scene = scene(&root().join(format!("scenes/refraction/{file}.txt")));
        let effects = Effects::of(&scene.viewed(&settings));
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let reference = Reference::new(&scene.viewed(&settings), &effects);
        for (name, mistake) in mistakes {
            let mut wrong = scene.clone();
            mistake(&mut wrong);
            let (picture, _) = cpu_picture::<f64>(&wrong, &settings, &Effects::of(&wrong.viewed(&settings)));
            for tier in Tier::ALL {
                let explanation = Explanation::of(&picture, &expected, &reference, &Judge::of(tier));
                let share = explanation.unexplained as f64 / explanation.differing as f64;
                let case = format!("{file}, {name}, {tier}");
                assert!(explanation.differing > 200, "{case}: {}", explanation.differing);
                assert!(share > 0.8, "{case}: {share}\n{}", explanation.report());
            }
        }
    }
}

/// Switched off by hand, glass is opaque again.
#[test]
fn refraction_can_be_switched_off() {
    let scene = scene(&root().join("scenes/effects/refraction.txt"));
    let mut opaque = scene.clone();
    opaque.spheres.iter_mut().for_each(|sphere| sphere.kt = 0.0);
    for settings in conventions() {
        let off: Request = "-refraction".parse().unwrap();
        let effects = Effects::requested(&scene.viewed(&settings), &off);
        let (picture, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let (expected, _) = cpu_picture::<f64>(&opaque, &settings, &Effects::of(&opaque.viewed(&settings)));
        assert!(picture == expected);
        if let Some(gpu) = gpu("refraction_can_be_switched_off") {
            let on_gpu = gpu_picture(&gpu, Tier::Fast, &scene, &settings, &effects).0;
            let expected = gpu_picture(&gpu, Tier::Fast, &opaque, &settings, &Effects::of(&opaque.viewed(&settings))).0;
            assert!(on_gpu == expected);
        }
    }
}

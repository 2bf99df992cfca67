//! What a scene calls for, and why.

use proptest::prelude::*;
use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::settings::Settings;

use crate::support::{cpu_picture, scaled, scene_of};

/// A plain sphere line: name, centre, radius, and Ka Kd Ks Kr n.
fn sphere(name: &str, center: [f64; 3], radius: f64, coefficients: &str) -> String {
    let [x, y, z] = center;
    format!("SPHERE {name} {x} {y} {z} {radius} {radius} {radius} 1 1 1 {coefficients}\n")
}

const LIGHT: &str = "LIGHT l 5 5 0 1 1 1\n";

/// Scene text, effect, whether it is on, part of the reason.
fn table() -> Vec<(String, Effect, bool, &'static str)> {
    let lone = |coefficients| sphere("s", [0.0, 0.0, -5.0], 1.0, coefficients);
    let lit_pair = |[x, y, z]: [f64; 3]| {
        sphere("a", [0.0, 0.0, -5.0], 1.0, "0 1 0 0 1") + &sphere("b", [x, y, z], 0.5, "0 1 0 0 1") + LIGHT
    };
    vec![
        (lone("1 0 0 0 1") + "AMBIENT 1 1 1", Effect::Ambient, true, "sphere 's' has Ka > 0"),
        (lone("1 0 0 0 1"), Effect::Ambient, false, "AMBIENT is 0"),
        (lone("0 0 0 0 1") + "AMBIENT 1 1 1", Effect::Ambient, false, "no sphere has a Ka"),
        ("AMBIENT 1 1 1".into(), Effect::Ambient, false, "no sphere has a Ka"),
        (lone("0 1 0 0 1") + LIGHT, Effect::Diffuse, true, "has Kd > 0"),
        (lone("0 1 0 0 1"), Effect::Diffuse, false, "no lights"),
        (lone("0 1 0 0 1") + "LIGHT l 1 1 1 0 0 0", Effect::Diffuse, false, "intensity 0"),
        (lone("0 0 1 0 1") + LIGHT, Effect::Specular, true, "has Ks > 0"),
        (lone("0 1 0 0 1") + LIGHT, Effect::Specular, false, "no sphere has a Ks"),
        (lone("0 1 0 0 1") + LIGHT, Effect::Shadows, false, "the only sphere is convex and seen from outside"),
        (lone("1 0 0 0 1") + LIGHT, Effect::Shadows, false, "no surface is lit"),
        (lit_pair([2.0, 2.0, -3.0]), Effect::Shadows, true, "sphere 'b' may stand between light 'l' and sphere 'a'"),
        (
            lit_pair([-45.0, -45.0, -50.0]),
            Effect::Shadows,
            true,
            "sphere 'a' may stand between light 'l' and sphere 'b'",
        ),
        (
            sphere("a", [-3.0, 0.0, -5.0], 1.0, "0 1 0 0 1")
                + &sphere("b", [3.0, 0.0, -5.0], 1.0, "0 1 0 0 1")
                + "LIGHT l 0 100 -5 1 1 1",
            Effect::Shadows,
            false,
            "no sphere stands between",
        ),
        (sphere("s", [0.0, 0.0, -1.0], 0.5, "0 1 0 0 1") + LIGHT, Effect::Shadows, true, "seen from inside"),
        (sphere("s", [0.0, 0.0, -9000.0], 9.0, "0 1 0 0 1") + LIGHT, Effect::Shadows, false, "convex"),
        (sphere("s", [0.0, 0.0, -9e5], 9.0, "0 1 0 0 1") + "LIGHT l 0 20 -9e5 1 1 1", Effect::Shadows, false, "convex"),
        (lone("1 0 0 1 1"), Effect::Reflections, false, "alone, convex and seen from outside"),
        (lone("1 0 0 0 1"), Effect::Reflections, false, "no sphere has Kr > 0"),
        (lone("1 0 0 1 1") + &sphere("b", [5.0, 0.0, -5.0], 1.0, "1 0 0 0 1"), Effect::Reflections, true, "one bounce"),
        (lone("1 0 0 1 1") + &sphere("b", [5.0, 0.0, -5.0], 1.0, "1 0 0 1 1"), Effect::Reflections, true, "'s' has Kr"),
        (lone("1 0 0 0 1"), Effect::Refraction, false, "no sphere has Kt > 0"),
        (lone("1 0 0 0 1 0 1.5"), Effect::Refraction, false, "no sphere has Kt > 0"),
        (lone("1 0 0 0 1 0.5 1.5"), Effect::Refraction, true, "sphere 's' has Kt > 0"),
        (lone("0 1 0 0 1 0.5 1.5") + LIGHT, Effect::Shadows, true, "shows inner walls"),
        (lone("1 0 0 1 1 0.5 1.5"), Effect::Reflections, true, "'s' has Kr > 0"),
        (lone("1 0 0 0 1"), Effect::Shells, false, "wholly beyond the image plane"),
        (sphere("s", [0.0, 0.0, -1.4], 0.4, "1 0 0 0 1"), Effect::Shells, true, "sphere 's' is not wholly beyond"),
        (sphere("s", [0.0, 0.0, 5.0], 0.4, "1 0 0 0 1"), Effect::Shells, true, "sphere 's' is not wholly beyond"),
        (lone("1 0 0 0 1"), Effect::Ellipsoids, false, "three equal semi-axes"),
        (sphere("s", [0.0, 0.0, -5e20], 1e20, "1 0 0 0 1"), Effect::Ellipsoids, false, "three equal semi-axes"),
        (
            lone("1 0 0 0 1") + &sphere("dust", [0.0, 0.0, -5.0], 1e-12, "1 0 0 0 1"),
            Effect::Ellipsoids,
            true,
            "sphere 'dust' is so small or large that its size must be scaled out",
        ),
        ("SPHERE s 0 0 -5 1 -1 1 1 1 1 1 0 0 0 1".into(), Effect::Ellipsoids, false, "three equal semi-axes"),
        ("SPHERE s 0 0 -5 1 2 1 1 1 1 1 0 0 0 1".into(), Effect::Ellipsoids, true, "unequal semi-axes"),
    ]
}

#[test]
fn effects_follow_from_the_scene() {
    for (text, effect, on, reason) in table() {
        let effects = Effects::of(&scene_of(&text).viewed(&Settings::classic()));
        let row = effects.rows.iter().find(|row| row.effect == effect).unwrap();
        assert!(row.on == on && row.reason.contains(reason), "{text}{effect}: {row:?}, expected {on}: {reason}");
        assert_eq!(effects.set.has(effect), on);
    }
}

#[test]
fn only_the_depth_that_can_matter_is_followed() {
    let mirror = sphere("m", [0.0, 0.0, -5.0], 1.0, "1 0 0 1 1");
    let plain = sphere("p", [5.0, 0.0, -5.0], 1.0, "1 0 0 0 1");
    let touching = sphere("t", [2.0, 0.0, -5.0], 1.0, "1 0 0 0 1");
    let second = sphere("n", [5.0, 0.0, -5.0], 1.0, "1 0 0 1 1");
    let settings = Settings { max_depth: 7, ..Settings::classic() };
    let depth = |text: String| Effects::of(&scene_of(&text).viewed(&settings)).depth;
    assert_eq!(depth(mirror.clone()), 0);
    assert_eq!(depth(mirror.clone() + &plain), 1);
    assert_eq!(depth(mirror.clone() + &touching), 7);
    assert_eq!(depth(mirror.clone() + &second), 7);
    let glass = sphere("g", [5.0, 0.0, -5.0], 1.0, "1 0 0 0 1 0.5 1.5");
    assert_eq!(depth(glass.clone()), 7);
    assert_eq!(depth(mirror + &glass), 7);
    let flat = Settings { max_depth: 0, ..Settings::classic() };
    assert!(!Effects::of(&scene_of(&glass).viewed(&flat)).set.has(Effect::Refraction));
}

#[test]
fn requests_are_read_from_text() {
    let set = |effects: &[Effect]| effects.iter().copied().collect::<EffectSet>();
    assert_eq!("auto".parse(), Ok(Request::Auto));
    assert_eq!("all".parse(), Ok(Request::Exactly(EffectSet::ALL)));
    assert_eq!("none".parse(), Ok(Request::Exactly(EffectSet::NONE)));
    assert_eq!("ambient, shells".parse(), Ok(Request::Exactly(set(&[Effect::Ambient, Effect::Shells]))));
    assert_eq!(
        "-shadows,+shells".parse(),
        Ok(Request::Changed(vec![(Effect::Shadows, false), (Effect::Shells, true)]))
    );
    assert!("ambient,-shadows".parse::<Request>().unwrap_err().contains("not both"));
    assert!("fog".parse::<Request>().unwrap_err().contains("no effect is called 'fog'"));
    assert!("".parse::<Request>().is_err());
}

#[test]
fn a_forced_effect_says_so() {
    let scene = scene_of("SPHERE s 0 0 -5 1 1 1 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1");
    let settings = Settings::classic();
    let forced = Effects::requested(&scene.viewed(&settings), &"-ambient,+reflections".parse().unwrap());
    assert!(!forced.set.has(Effect::Ambient) && forced.set.has(Effect::Reflections));
    assert_eq!(forced.depth, settings.max_depth);
    let row = forced.rows.iter().find(|row| row.effect == Effect::Ambient).unwrap();
    assert!(!row.on && row.reason.starts_with("forced off; the scene: "), "{row:?}");
    let all = Effects::requested(&scene.viewed(&settings), &Request::Exactly(EffectSet::ALL));
    assert_eq!((all.set, all.depth), (EffectSet::ALL, settings.max_depth));
}

/// Centres around and beyond the image plane, radii that touch, cut and swallow each other.
fn any_sphere() -> impl Strategy<Value = String> {
    let coefficient = || prop_oneof![Just(0.0), Just(0.5)];
    let axis = || prop_oneof![Just(1.0), Just(0.5), 0.1..2.5];
    let axes = prop_oneof![axis().prop_map(|s| [s; 3]), [axis(), axis(), axis()]];
    let coefficients = [coefficient(), coefficient(), coefficient(), coefficient()];
    let glass = prop_oneof![4 => Just(String::new()), 1 => (0.5_f64..2.0).prop_map(|eta| format!("0.8 {eta}"))];
    ([-3.0..3.0, -3.0..3.0, -9.0..-0.5], axes, coefficients, glass).prop_map(
        |([x, y, z], [a, b, c], [ka, kd, ks, kr], glass)| {
            format!("SPHERE s {x} {y} {z} {a} {b} {c} 0.9 0.6 0.3 {ka} {kd} {ks} {kr} 20 {glass}\n")
        },
    )
}

fn any_light() -> impl Strategy<Value = String> {
    [-6.0..6.0, -6.0..6.0, -12.0..6.0].prop_map(|[x, y, z]: [f64; 3]| format!("LIGHT l {x} {y} {z} 0.7 0.6 0.5\n"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// What the rules leave out would have changed nothing, whatever the scene.
    #[test]
    fn what_is_left_out_changes_no_pixel(
        spheres in prop::collection::vec(any_sphere(), 1..4),
        lights in prop::collection::vec(any_light(), 0..3),
        exact in any::<bool>(),
        exponent in prop_oneof![Just(0), -900..900_i32],
    ) {
        let mut scene = scene_of(&(spheres.concat() + &lights.concat() + "AMBIENT 0.2 0.3 0.4\nBACK 0.1 0.2 0.3"));
        (scene.width, scene.height) = (32, 24);
        let mut settings = if exact { Settings::exact() } else { Settings::classic() };
        let factor = 2_f64.powi(exponent);
        let scene = scaled(&scene, factor);
        settings.secondary.reflection *= factor;
        let all = Effects::requested(&scene.viewed(&settings), &Request::Exactly(EffectSet::ALL));
        let auto = Effects::of(&scene.viewed(&settings));
        let [with, without] = [&all, &auto].map(|effects| cpu_picture::<f64>(&scene, &settings, effects));
        prop_assert!(with == without, "{}, depth {}", auto.set, auto.depth);
    }
}

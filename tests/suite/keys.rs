//! The assignment's official pictures, from the folder that `TRUERAY_KEYS` names.

use std::path::PathBuf;

use trueray::compare::{Difference, Explanation};
use trueray::cpu::{Judge, Reference};
use trueray::effects::Effects;
use trueray::film::{Leniency, Picture, read_picture};
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{cpu_picture, gpu, gpu_picture, say_skipped, scene};

/// Scene and official picture of each key in the folder; `None`, said aloud, where no folder is named.
fn keys(test: &str) -> Option<Vec<(String, Scene, Picture)>> {
    let Some(folder) = std::env::var_os("TRUERAY_KEYS") else {
        say_skipped(test, "TRUERAY_KEYS names no folder of official pictures");
        return None;
    };
    let folder = PathBuf::from(folder);
    let mut keys = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(subject) = name.strip_prefix("key").and_then(|name| name.strip_suffix(".png")) {
            let scene = scene(&folder.join(format!("test{subject}.txt")));
            let key = read_picture(&folder.join(&name), Leniency::Strict).unwrap().picture;
            keys.push((subject.to_owned(), scene, key));
        }
    }
    assert!(!keys.is_empty(), "no key*.png in {}", folder.display());
    Some(keys)
}

#[test]
fn reference_matches_every_key_bit_for_bit() {
    let Some(keys) = keys("reference_matches_every_key_bit_for_bit") else { return };
    let settings = Settings::classic();
    for (subject, scene, key) in keys {
        let effects = Effects::of(&scene.viewed(&settings));
        let (picture, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let difference = Difference::between(&picture, &key).unwrap();
        // The official Illum picture itself is off by one level in 3 pixels.
        let allowed = if subject == "Illum" { 3 } else { 0 };
        assert!(difference.differing.over_0 <= allowed, "{subject}:\n{}", difference.report("reference", "key"));
        assert_eq!(difference.differing.over_1, 0, "{subject}");
    }
}

#[test]
fn gpu_matches_every_key_within_f32() {
    let test = "gpu_matches_every_key_within_f32";
    let (Some(keys), Some(gpu)) = (keys(test), gpu(test)) else { return };
    let settings = Settings::classic();
    for (subject, scene, key) in keys {
        let effects = Effects::of(&scene.viewed(&settings));
        let (picture, not_finite) = gpu_picture(&gpu, Tier::Fast, &scene, &settings, &effects);
        let difference = Difference::between(&picture, &key).unwrap();
        let report = difference.report("GPU", "key");
        assert!(difference.differing.over_0 <= 40 && difference.differing.over_1 <= 8, "{subject}:\n{report}");
        assert_eq!(not_finite, 0, "{subject}");

        let reference = Reference::new(&scene.viewed(&settings), &effects);
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let explanation = Explanation::of(&picture, &expected, &reference, &Judge::of(Tier::Fast));
        assert_eq!(explanation.unexplained, 0, "{subject}:\n{}", explanation.report());
    }
}

#[test]
fn gpu_at_double_matches_every_key_bit_for_bit() {
    let test = "gpu_at_double_matches_every_key_bit_for_bit";
    let (Some(keys), Some(gpu)) = (keys(test), gpu(test)) else { return };
    if !gpu.device.info.f64 {
        return say_skipped(test, "the device has no f64");
    }
    let settings = Settings::classic();
    for (subject, scene, key) in keys {
        let effects = Effects::of(&scene.viewed(&settings));
        let (picture, _) = gpu_picture(&gpu, Tier::Double, &scene, &settings, &effects);
        let difference = Difference::between(&picture, &key).unwrap();
        // As for the reference.
        let allowed = if subject == "Illum" { 3 } else { 0 };
        assert!(difference.differing.over_0 <= allowed, "{subject}:\n{}", difference.report("GPU", "key"));
        assert_eq!(difference.differing.over_1, 0, "{subject}");
    }
}

/// White where nothing is rounded has no margin.
#[test]
fn keys_with_254_for_255_are_unexplained() {
    let Some(keys) = keys("keys_with_254_for_255_are_unexplained") else { return };
    let settings = Settings::classic();
    for (subject, scene, _) in keys {
        let effects = Effects::of(&scene.viewed(&settings));
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let rgb = expected.rgb().iter().map(|&level| level.min(254)).collect();
        let wrong = Picture::new(scene.width, scene.height, rgb).unwrap();
        let reference = Reference::new(&scene.viewed(&settings), &effects);
        for tier in Tier::ALL {
            let explanation = Explanation::of(&wrong, &expected, &reference, &Judge::of(tier));
            let explained = explanation.differing - explanation.unexplained;
            assert!(explained * 100 <= explanation.differing, "{subject}, {tier}:\n{}", explanation.report());
        }
    }
}

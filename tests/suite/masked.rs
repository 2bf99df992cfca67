//! Devices that offer less than the one here: the same picture with what they have, or a refusal that names what is missing.
//!
//! `TRUERAY_MASKED=all` renders every scene of `scenes/` with every mask at every tier, where otherwise a few stand for them.

use trueray::effects::Effects;
use trueray::engine::Backend;
use trueray::gpu::{Choice, Device, Error, Gpu, LEAST_BUFFERS, MAX_TABLES, Mask, Tables};
use trueray::precision::Tier;
use trueray::tuning::Tuning;

use crate::golden::all_subjects;
use crate::support::{Case, KEPT, gpu, gpu_picture, is_set, say};

/// Those that between them need every table.
const SOME: [&str; 7] = [
    "basic/ten-thousand-spheres",
    "effects/everything",
    "effects/same-place",
    "hard/mirror-corridor",
    "refraction/glass-in-glass",
    "show/glass",
    "show/showcase",
];

/// Devices of the field, and what each is taken to hold its tables in.
fn masks() -> Vec<(&'static str, Mask, Tables)> {
    let none = Mask::default();
    vec![
        ("no f64", Mask { no_f64: true, ..none }, Tables::Buffers),
        ("no 64-bit integers", Mask { no_int64: true, ..none }, Tables::Buffers),
        ("8 storage buffers", Mask { storage_buffers: Some(8), ..none }, Tables::Stored),
        ("4 storage textures", Mask { storage_textures: Some(4), ..none }, Tables::Buffers),
        (
            "the least of Vulkan",
            Mask {
                storage_buffers: Some(LEAST_BUFFERS),
                storage_textures: Some(4),
                sampled_textures: Some(16),
                uniform_bytes: Some(16_384),
                invocations: Some(128),
                no_f64: true,
                no_int64: true,
                no_shared_memory: true,
                ..none
            },
            Tables::Sampled,
        ),
        ("128 invocations", Mask { invocations: Some(128), ..none }, Tables::Buffers),
        ("no SPIR-V", Mask { no_spirv: true, ..none }, Tables::Buffers),
    ]
}

fn masked(mask: &Mask) -> Gpu {
    let gpu = Gpu::with(Device::masked(&Choice::Gpu, mask).unwrap()).unwrap();
    let mut gpu = gpu.keeping_kernels(KEPT);
    // As hardware does.
    let tuning = Tuning { texture_tables: false, ..gpu.tuned().tuning };
    gpu.set_tuning(tuning).unwrap();
    gpu
}

/// Whether the device has too few bindings of some kind for all tables, as `SwiftShader` has.
fn offers_little(gpu: &Gpu) -> bool {
    let info = &gpu.device.info;
    info.max_storage_buffers < MAX_TABLES + LEAST_BUFFERS || info.max_storage_textures < MAX_TABLES
}

#[test]
fn every_scene_is_rendered_with_what_there_is() {
    let Some(usual) = gpu("every_scene_is_rendered_with_what_there_is") else { return };
    let (offers_little, has_f64) = (offers_little(&usual), usual.device.info.f64);
    drop(usual);
    let is_whole = is_set("TRUERAY_MASKED");
    let subjects = all_subjects().filter(|(name, ..)| is_whole || SOME.contains(&name.as_str()));
    let cases: Vec<_> = subjects.map(|(name, scene, settings)| (name, Case::new(&scene, &settings))).collect();
    let mut rendered = 0;
    for (name, mask, tables) in masks() {
        let gpu = masked(&mask);
        assert!(gpu.tables() == tables || offers_little, "{name}: {:?}", gpu.tables());
        let tiers: Vec<_> = Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()).collect();
        assert_eq!(gpu.device.info.f64, has_f64 && !mask.no_f64 && !mask.no_int64, "{name}");
        for (scene_name, case) in &cases {
            let tiers = if is_whole { &tiers[..] } else { &tiers[..1] };
            for &tier in tiers {
                let who = format!("{scene_name} at {tier}, {name}");
                let (picture, not_finite) = gpu_picture(&gpu, tier, &case.scene, &case.settings, &case.effects);
                assert_eq!(not_finite, 0, "{who}");
                case.assert_explained(&who, &picture, Backend::Device(&gpu, tier).judge());
                rendered += 1;
            }
        }
    }
    if is_whole {
        say(
            "every_scene_is_rendered_with_what_there_is",
            &format!("{rendered} pictures, none with an unexplained pixel"),
        );
    }
}

/// Tables in buffers, in storage textures and in sampled ones: the same bytes at every tier.
#[test]
fn what_holds_the_tables_changes_no_byte() {
    let Some(usual) = gpu("what_holds_the_tables_changes_no_byte") else { return };
    let mut others = [
        masked(&Mask::default()),
        masked(&Mask { storage_buffers: Some(8), ..Mask::default() }),
        masked(&Mask { storage_buffers: Some(8), storage_textures: Some(4), ..Mask::default() }),
    ];
    let kinds = others.each_ref().map(Gpu::tables);
    assert!(kinds == [Tables::Buffers, Tables::Stored, Tables::Sampled] || offers_little(&usual), "{kinds:?}");
    // In place, as it is; bounce by bounce in both ways.
    let walks = |tuning: Tuning| {
        let at_once = Tuning { in_place_below: 0.0, in_turn_from: 1e9, ..tuning };
        [tuning, at_once, Tuning { in_turn_from: 0.0, ..at_once }]
    };
    for (name, scene, settings) in all_subjects() {
        if !SOME.contains(&name.as_str()) {
            continue;
        }
        let effects = Effects::of(&scene.viewed(&settings));
        for tier in Tier::ALL.into_iter().filter(|&tier| usual.kernel(tier).is_ok()) {
            let (expected, _) = gpu_picture(&usual, tier, &scene, &settings, &effects);
            for gpu in &mut others {
                let own = gpu.tuned().tuning;
                for tuning in walks(own) {
                    gpu.set_tuning(tuning).unwrap();
                    let (picture, _) = gpu_picture(gpu, tier, &scene, &settings, &effects);
                    assert!(picture == expected, "{name} at {tier} in {:?}, {tuning:?}", gpu.tables());
                }
                gpu.set_tuning(own).unwrap();
            }
        }
    }
}

/// Quotients and square roots that are some units in the last place off, as Vulkan allows and beyond: corrected, the same bytes.
#[test]
fn a_device_that_divides_badly_gives_the_same_bytes() {
    let Some(usual) = gpu("a_device_that_divides_badly_gives_the_same_bytes") else { return };
    let off = |units_off| {
        let mask = Mask { units_off, ..Mask::default() };
        Gpu::with(Device::masked(&Choice::Gpu, &mask).unwrap()).unwrap().keeping_kernels(KEPT)
    };
    // So bad that nothing is corrected.
    let [bad, worse, hopeless] = [2, 8, 100].map(off);
    let mut changed = 0;
    for (name, scene, settings) in all_subjects().filter(|(name, ..)| SOME.contains(&name.as_str())) {
        let effects = Effects::of(&scene.viewed(&settings));
        for tier in Tier::ALL.into_iter().filter(|&tier| usual.kernel(tier).is_ok()) {
            let (expected, _) = gpu_picture(&usual, tier, &scene, &settings, &effects);
            for (gpu, units) in [(&bad, 2), (&worse, 8)] {
                let (picture, _) = gpu_picture(gpu, tier, &scene, &settings, &effects);
                assert!(picture == expected, "{name} at {tier}, {units} units off");
            }
            let (picture, _) = gpu_picture(&hopeless, tier, &scene, &settings, &effects);
            changed += usize::from(picture != expected);
        }
    }
    assert!(changed > 0, "quotients change nothing");
}

#[test]
fn a_limit_that_is_too_small_is_named() {
    if gpu("a_limit_that_is_too_small_is_named").is_none() {
        return;
    }
    let opened = Device::masked(&Choice::Gpu, &Mask { invocations: Some(32), ..Mask::default() });
    let error = opened.and_then(Gpu::with).unwrap_err();
    assert!(matches!(error, Error::Unsuitable { .. }), "{error}");
    assert!(error.to_string().contains("max_compute_invocations_per_workgroup"), "{error}");
}

//! Every scene of `scenes/`, rendered by everything that renders.

use std::path::Path;

use trueray::cpu::{Judge, Reference};
use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::engine::{Backend, Engine, render_bands};
use trueray::gpu;
use trueray::gpu::{Ahead, Choice, Gpu, GpuRenderer, Tables};
use trueray::pattern::Pattern;
use trueray::precision::{self, Demand, Selection, Tier};
use trueray::settings::{Settings, Specular};
use trueray::tuning::{Class, Tuning};

use crate::support::{Case, cpu_picture, gpu, gpu_picture, root, scene, scene_files, scene_of};

/// Scenes whose every pixel all tiers promise.
const ORDINARY: [&str; 3] = ["basic", "effects", "refraction"];

fn conventions() -> [(&'static str, Settings); 3] {
    let blinn = Settings { specular: Specular::Blinn, max_depth: 5, ..Settings::exact() };
    [("classic", Settings::classic()), ("exact", Settings::exact()), ("exact, blinn, depth 5", blinn)]
}

/// Runs `check` for every ordinary scene in every convention.
fn for_each_case(check: impl Fn(&str, &Case)) {
    for file in scene_files(&ORDINARY) {
        for (name, settings) in conventions() {
            check(&format!("{}, {name}", short(&file)), &Case::of(&file, &settings));
        }
    }
}

/// The case with all effects, called for or not.
fn all_effects(case: &Case) -> Effects {
    Effects::requested(&case.scene.viewed(&case.settings), &Request::Exactly(EffectSet::ALL))
}

fn short(file: &Path) -> String {
    file.file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
fn gpu_differs_from_the_reference_only_where_explained() {
    let Some(gpu) = gpu("gpu_differs_from_the_reference_only_where_explained") else { return };
    for_each_case(|name, case| {
        let (picture, not_finite) = gpu_picture(&gpu, Tier::Fast, &case.scene, &case.settings, &case.effects);
        assert_eq!(not_finite, 0, "{name}");
        case.assert_explained(name, &picture, Judge::of(Tier::Fast));
    });
}

/// The same algorithm in the shader's precision without a driver: what it explains is no driver's doing.
#[test]
fn single_precision_differs_from_the_reference_only_where_explained() {
    for_each_case(|name, case| {
        let (picture, not_finite) = cpu_picture::<f32>(&case.scene, &case.settings, &case.effects);
        assert_eq!(not_finite, 0, "{name}");
        case.assert_explained(name, &picture, Judge::of(Tier::Fast));
    });
}

#[test]
fn what_a_scene_does_not_call_for_changes_no_byte_on_the_gpu() {
    let Some(gpu) = gpu("what_a_scene_does_not_call_for_changes_no_byte_on_the_gpu") else { return };
    for_each_case(|name, case| {
        let [specialised, generic] = [&case.effects, &all_effects(case)]
            .map(|effects| gpu_picture(&gpu, Tier::Fast, &case.scene, &case.settings, effects).0);
        assert!(specialised == generic, "{name}: {}", case.effects.set);
    });
}

#[test]
fn what_a_scene_does_not_call_for_changes_no_byte_on_the_cpu() {
    for_each_case(|name, case| {
        let (generic, _) = cpu_picture::<f64>(&case.scene, &case.settings, &all_effects(case));
        assert!(case.expected == generic, "{name}: {}", case.effects.set);
    });
}

/// For each effect there is a scene of its name that needs it.
#[test]
fn switching_off_a_needed_effect_changes_the_picture() {
    let Some(gpu) = gpu("switching_off_a_needed_effect_changes_the_picture") else { return };
    let settings = Settings::classic();
    for effect in Effect::ALL {
        let scene = scene(&root().join(format!("scenes/effects/{effect}.txt")));
        let needed = Effects::of(&scene.viewed(&settings));
        assert!(needed.set.has(effect), "{effect}");
        let without = Effects::requested(&scene.viewed(&settings), &Request::Changed(vec![(effect, false)]));
        assert!(
            gpu_picture(&gpu, Tier::Fast, &scene, &settings, &needed)
                != gpu_picture(&gpu, Tier::Fast, &scene, &settings, &without),
            "{effect}"
        );
        let [with, without] = [needed, without].map(|effects| cpu_picture::<f64>(&scene, &settings, &effects));
        assert!(with != without, "{effect} on the CPU");
    }
}

#[test]
fn bands_give_the_same_bytes_as_one_piece() {
    let Some(gpu) = gpu("bands_give_the_same_bytes_as_one_piece") else { return };
    let scene = scene(&root().join("scenes/effects/reflections.txt"));
    let settings = Settings::classic();
    let effects = Effects::of(&scene.viewed(&settings));
    let (whole, _) = gpu_picture(&gpu, Tier::Fast, &scene, &settings, &effects);
    let mut renderer = GpuRenderer::new(&gpu, &scene.viewed(&settings), &effects, Tier::Fast).unwrap();
    let row_bytes = scene.width as usize * 3;
    let mut pieces = Vec::new();
    let mut first = 0;
    // They need not be whole tiles.
    for rows in [8, 24, 16, 3, 1, 4, 9, 2, 1000] {
        let rows = rows.min(scene.height - first);
        let mut rgb = vec![0; row_bytes * rows as usize];
        assert!(renderer.rows(first, &mut rgb).unwrap().cut.is_empty());
        pieces.extend(rgb);
        first += rows;
    }
    assert!(whole.rgb() == pieces);
}

/// A picture of many bands, dispatches that stay short, and the same rays as the reference.
#[test]
fn a_large_picture_is_rendered_in_short_dispatches() {
    let Some(gpu) = gpu("a_large_picture_is_rendered_in_short_dispatches") else { return };
    let mut scene = scene_of("SPHERE s 0 0 -5 2 2 2 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1\nBACK 0 0 1");
    (scene.width, scene.height) = (4001, 3003);
    let settings = Settings::classic();
    let effects = Effects::of(&scene.viewed(&settings));
    let mut engine = Engine::new(Backend::Device(&gpu, Tier::Fast), scene.viewed(&settings), &effects).unwrap();
    let mut white = 0_u64;
    let mut bands = 0;
    render_bands(&mut engine, |band| {
        bands += 1;
        white += band.rgb.as_chunks::<3>().0.iter().filter(|pixel| **pixel == [255; 3]).count() as u64;
        Ok::<_, gpu::Error>(())
    })
    .unwrap();
    assert!(bands > 1);
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    Reference::<f64>::new(&scene.viewed(&settings), &effects).rows(0, &mut rgb).unwrap();
    let expected = rgb.as_chunks::<3>().0.iter().filter(|pixel| **pixel == [255; 3]).count() as u64;
    assert!(white.abs_diff(expected) <= 40, "{white} {expected}"); // silhouettes
    let times = engine.times();
    assert!(times.dispatches > 1 && times.longest_dispatch_ms > 0.0);
}

/// The tiers that this device can run.
fn tiers(gpu: &Gpu) -> impl Iterator<Item = Tier> {
    Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok())
}

/// Precision above `fast`: hard scenes too, and at every tier what is left out changes no byte.
#[test]
fn robust_and_double_differ_from_the_reference_only_where_explained() {
    let test = "robust_and_double_differ_from_the_reference_only_where_explained";
    let Some(gpu) = gpu(test) else { return };
    for file in scene_files(&["basic", "effects", "refraction", "hard"]) {
        for (convention, settings) in &conventions()[..2] {
            let case = Case::of(&file, settings);
            for tier in tiers(&gpu).filter(|&tier| tier > Tier::Fast) {
                let name = format!("{}, {convention}, {tier}", short(&file));
                let (picture, not_finite) = gpu_picture(&gpu, tier, &case.scene, settings, &case.effects);
                assert_eq!(not_finite, 0, "{name}");
                case.assert_explained(&name, &picture, Backend::Device(&gpu, tier).judge());
                let generic = gpu_picture(&gpu, tier, &case.scene, settings, &all_effects(&case)).0;
                assert!(picture == generic, "{name}: {}", case.effects.set);
            }
        }
    }
}

/// `auto` never picks a tier whose own picture the reference cannot explain, and stays with `fast` where nothing is hard.
#[test]
fn auto_picks_a_tier_that_covers_the_scene() {
    let Some(gpu) = gpu("auto_picks_a_tier_that_covers_the_scene") else { return };
    let settings = Settings::exact();
    for file in scene_files(&["hard"]) {
        let case = Case::of(&file, &settings);
        let (viewed, request) = (case.scene.viewed(&settings), precision::Request::Auto);
        let tier = Selection::of(&viewed, &case.effects, request, gpu.ladder()).tier;
        if gpu.kernel(tier).is_ok() {
            let (picture, _) = gpu_picture(&gpu, tier, &case.scene, &settings, &case.effects);
            case.assert_explained(&short(&file), &picture, Backend::Device(&gpu, tier).judge());
        }
    }
    let plain =
        scene_of("SPHERE a 0 0 -5 1 1 1 1 1 1 1 1 1 0 50\nSPHERE b 1 0 -4 1 2 1 1 1 1 1 1 1 1 50\nLIGHT l 5 5 5 1 1 1");
    let effects = Effects::of(&plain.viewed(&settings));
    assert_eq!(
        Selection::of(&plain.viewed(&settings), &effects, precision::Request::Auto, gpu.ladder()).tier,
        Tier::Fast
    );
}

/// What was parsed before a device was open is what a software device with its class's tuning renders with; where it is for other
/// kernels, it changes nothing.
#[test]
fn kernels_are_parsed_ahead_for_the_picture_that_follows() {
    let Some(own) = gpu("kernels_are_parsed_ahead_for_the_picture_that_follows") else { return };
    let (settings, software) = (Settings::classic(), Tuning::of(Class::Software));
    let is_expected = own.tables() == Tables::Stored && own.tuned().tuning == software;
    let ahead_of = |scene: &trueray::scene::Scene| {
        Ahead::of(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings)), precision::Request::Auto)
    };
    let glass = scene(&root().join("scenes/refraction/glass-ball.txt"));
    for file in scene_files(&["basic"]) {
        let scene = scene(&file);
        let effects = Effects::of(&scene.viewed(&settings));
        let tier = Selection::of(&scene.viewed(&settings), &effects, precision::Request::Auto, own.ladder()).tier;
        let (expected, _) = gpu_picture(&own, tier, &scene, &settings, &effects);
        for ahead in [ahead_of(&scene), ahead_of(&glass)].into_iter().flatten() {
            let specialisation = *ahead.specialisation();
            let gpu = Gpu::open(&Choice::Auto).unwrap().having(Some(ahead));
            if is_expected && specialisation.refraction.is_none() {
                let renderer = GpuRenderer::new(&gpu, &scene.viewed(&settings), &effects, tier).unwrap();
                assert_eq!(renderer.specialisation(), &specialisation, "{}", short(&file));
            }
            assert!(gpu_picture(&gpu, tier, &scene, &settings, &effects).0 == expected, "{}", short(&file));
        }
    }
}

#[test]
fn a_lost_device_is_an_error_and_no_panic() {
    // A device of its own: the shared one must live on.
    if gpu("a_lost_device_is_an_error_and_no_panic").is_none() {
        return;
    }
    let own = Gpu::open(&Choice::Gpu).unwrap();
    let scene = scene_of("SPHERE s 0 0 -5 2 2 2 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1");
    let settings = Settings::classic();
    let effects = Effects::of(&scene.viewed(&settings));
    let mut renderer = GpuRenderer::new(&own, &scene.viewed(&settings), &effects, Tier::Fast).unwrap();
    let mut rgb = vec![0; 40 * 40 * 3];
    assert!(renderer.rows(0, &mut rgb).unwrap().cut.is_empty());
    own.device.destroy();
    let error = renderer.rows(0, &mut rgb).unwrap_err();
    assert!(matches!(error, gpu::Error::Lost(_)), "{error:?}");
}

/// Black left of x = 0, white right of it, through the middle of the pixel column 1 of 3.
#[test]
fn samples_average_an_edge() {
    let text = "SPHERE s 1e4 0 -10 1e4 1e4 1e4 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1\nBACK 0 0 0";
    let mut scene = scene_of(text);
    (scene.width, scene.height) = (3, 3);
    let gpu = gpu("samples_average_an_edge");
    for (side, expected) in [(1, None), (2, Some(128)), (4, Some(128)), (6, Some(128))] {
        let settings = Settings { pattern: Pattern::Grid { side }, ..Settings::exact() };
        let effects = Effects::of(&scene.viewed(&settings));
        let mut pictures = vec![cpu_picture::<f64>(&scene, &settings, &effects).0];
        if let Some(gpu) = &gpu {
            pictures.extend(tiers(gpu).map(|tier| gpu_picture(gpu, tier, &scene, &settings, &effects).0));
        }
        for picture in pictures {
            assert_eq!([picture.pixel(0, 1), picture.pixel(2, 1)], [[0; 3], [255; 3]], "{side}");
            if let Some(level) = expected {
                assert_eq!(picture.pixel(1, 1), [level; 3], "{side}");
            }
        }
    }
}

/// The mean of equal colours is that colour: no rim around the tiles that spheres cover.
#[test]
fn samples_of_one_colour_change_no_level() {
    let Some(gpu) = gpu("samples_of_one_colour_change_no_level") else { return };
    let scene = scene_of("SPHERE s 0 0 -5 0.5 0.5 0.5 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1\nBACK 0.2 0.6 0.1");
    for side in [1, 2, 3, 5] {
        let settings = Settings { pattern: Pattern::Grid { side }, ..Settings::classic() };
        let effects = Effects::of(&scene.viewed(&settings));
        let background = settings.quantize.levels(scene.background);
        let inside_a_covered_tile = (16, 16);
        let (on_cpu, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let (on_gpu, _) = gpu_picture(&gpu, Tier::Fast, &scene, &settings, &effects);
        for picture in [on_cpu, on_gpu] {
            assert_eq!(picture.pixel(0, 0), background, "{side}");
            assert_eq!(picture.pixel(inside_a_covered_tile.0, inside_a_covered_tile.1), background, "{side}");
        }
    }
}

#[test]
fn pictures_of_several_samples_differ_from_the_reference_only_where_explained() {
    let Some(gpu) = gpu("pictures_of_several_samples_differ_from_the_reference_only_where_explained") else { return };
    for (side, base) in [(2, Settings::classic()), (3, Settings::exact())] {
        let settings = Settings { pattern: Pattern::Grid { side }, ..base };
        for file in scene_files(&["effects"]) {
            let case = Case::new(&scene(&file), &settings);
            let name = format!("{}, {side} × {side} samples", short(&file));
            let (picture, not_finite) = gpu_picture(&gpu, Tier::Fast, &case.scene, &settings, &case.effects);
            assert_eq!(not_finite, 0, "{name}");
            case.assert_explained(&name, &picture, Judge::of(Tier::Fast));
            if side == 2 {
                let (generic, _) = gpu_picture(&gpu, Tier::Fast, &case.scene, &settings, &all_effects(&case));
                assert!(picture == generic, "{name}: {}", case.effects.set);
            }
        }
    }
}

/// Mirrors meet themselves at analytic roots, not where rounding says: balls on a floor that is far larger than the epsilon.
#[test]
fn large_mirrors_show_no_acne() {
    let Some(gpu) = gpu("large_mirrors_show_no_acne") else { return };
    for radius in [100.0, 500.0, 5000.0, 15000.0] {
        let mut scene = scene_of(&format!(
            "SPHERE floor 0 {} -8 {radius} {radius} {radius} 0.6 0.6 0.5 0.2 0.5 0 0.3 1\n\
             SPHERE a -1.5 0.1 -6 0.8 0.8 0.8 0.9 0.2 0.2 0.2 0.5 0.3 0.4 30\n\
             SPHERE b 0.4 -0.2 -5 0.5 0.5 0.5 0.2 0.9 0.2 0.2 0.5 0.3 0.4 30\n\
             SPHERE c 1.7 0.4 -8 1.1 1.1 1.1 0.2 0.2 0.9 0.2 0.5 0.3 0.4 30\n\
             LIGHT l -3 5 0 0.7 0.7 0.7\nAMBIENT 0.4 0.4 0.4\nBACK 0.3 0.5 0.8",
            -1.0 - radius
        ));
        (scene.width, scene.height) = (320, 240);
        let settings = Settings::classic();
        let case = Case::new(&scene, &settings);
        let demand = Demand::of(&scene.viewed(&settings), &case.effects);
        for tier in tiers(&gpu) {
            let name = format!("radius {radius}, {tier}");
            let (picture, _) = gpu_picture(&gpu, tier, &scene, &settings, &case.effects);
            // A pixel of acne is none that lies next to a silhouette or a shadow.
            let differing = case.assert_explained(&name, &picture, Backend::Device(&gpu, tier).judge()).differing;
            assert!(tier < Tier::Double || demand.beyond(tier, &scene).is_none(), "{name}");
            assert!(demand.beyond(tier, &scene).is_some() || differing <= 7, "{name}: {differing} of 76,800");
        }
    }
}

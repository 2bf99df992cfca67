//! How many rays a picture takes, whoever renders it: the faster renderer must not count other rays.

use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::engine::{Backend, Engine, Options, Pixels, Rays, render_partial, render_picture};
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::sampling::{Density, Fill, Samples};
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::tuning::Tuning;

use crate::support::{gpu, scene, scene_files, scene_of};

const COUNTED: Options = Options {
    certified: false,
    linear: false,
    terms: false,
    one_ray: false,
    count_rays: true,
    count_tests: false,
    device_clock: false,
    pixel_ms: None,
};

/// The rays of the whole picture, and the picture.
fn counted(backend: Backend, scene: &Scene, settings: &Settings, effects: &Effects) -> (Rays, Vec<u8>) {
    let mut engine = Engine::with(backend, scene.viewed(settings), effects, &COUNTED).unwrap();
    let (rgb, _) = render_picture(&mut engine).unwrap();
    (engine.rays().unwrap(), rgb)
}

/// `f64` on the device decides as the reference does; and every sample has its primary ray, also where no sphere is near.
#[test]
fn the_device_counts_the_rays_of_the_reference() {
    let Some(gpu) = gpu("the_device_counts_the_rays_of_the_reference") else { return };
    let three = Settings { pattern: Pattern::Grid { side: 3 }, max_depth: 5, ..Settings::exact() };
    for (index, file) in scene_files(&["basic", "effects", "refraction"]).into_iter().enumerate() {
        let mut scene = scene(&file);
        // Parts of tiles at the edges.
        (scene.width, scene.height) = (61, 45);
        for (name, settings) in [("classic", Settings::classic()), ("exact", Settings::exact()), ("3 x 3", three)] {
            if settings == three && index % 4 != 0 {
                continue;
            }
            let case = format!("{}, {name}", file.display());
            let effects = Effects::of(&scene.viewed(&settings));
            let (expected, picture) = counted(Backend::Reference, &scene, &settings, &effects);
            let samples = u64::from(settings.pattern.count());
            assert_eq!(expected.primary, 61 * 45 * samples, "{case}");
            let (fast, _) = counted(Backend::Device(&gpu, Tier::Fast), &scene, &settings, &effects);
            assert_eq!(fast.primary, expected.primary, "{case}");
            if gpu.device.info.f64 {
                let (double, same) = counted(Backend::Device(&gpu, Tier::Double), &scene, &settings, &effects);
                assert_eq!(double, expected, "{case}");
                assert!(same == picture, "{case}");
            }
        }
    }
}

/// However paths are walked, and whatever is simulated.
#[test]
fn rays_are_counted_alike_however_they_are_walked() {
    let Some(mut gpu) = gpu("rays_are_counted_alike_however_they_are_walked") else { return };
    let mut scene = scene_of(
        "SPHERE a 0 0 -5 1 1 1 1 1 1 0.1 0.6 0.2 0.5 9\nSPHERE b 1.5 0 -4 0.5 0.5 0.5 1 1 1 0 1 0 0.5 1\n\
         SPHERE c -1.5 1 -6 1 1 1 1 1 1 0 1 0 0.5 1\nLIGHT l 3 4 1 1 1 1\nLIGHT m -3 4 1 1 1 1\nAMBIENT 1 1 1",
    );
    (scene.width, scene.height) = (43, 37);
    let settings = Settings::exact();
    let own = gpu.tuned().tuning;
    let only = |effects: &[Effect]| Request::Exactly(effects.iter().copied().collect::<EffectSet>());
    for request in
        [Request::Auto, only(&EffectSet::ALL.iter().collect::<Vec<_>>()), only(&[Effect::Shadows]), only(&[])]
    {
        let effects = Effects::requested(&scene.viewed(&settings), &request);
        let (expected, _) = counted(Backend::Reference, &scene, &settings, &effects);
        for (in_place_below, in_turn_from) in [(0.0, 1e9), (0.0, 0.0), (1e9, 1e9)] {
            gpu.set_tuning(Tuning { in_place_below, in_turn_from, ..own }).unwrap();
            let (rays, _) = counted(Backend::Device(&gpu, Tier::Fast), &scene, &settings, &effects);
            assert_eq!(rays, expected, "{} {in_place_below} {in_turn_from}", effects.set);
        }
        gpu.set_tuning(own).unwrap();
    }
}

#[test]
fn rays_of_a_part_of_the_pixels_are_counted() {
    let gpu = gpu("rays_of_a_part_of_the_pixels_are_counted");
    let scene = scene_of(
        "SPHERE a 0.3 0 -5 1 1 1 1 1 1 0 1 0 0.5 1\nSPHERE b 1.5 0 -4 0.5 0.5 0.5 1 1 1 0 1 0 0.5 1\nLIGHT l 3 4 1 1 1 1",
    );
    let settings = Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() };
    let effects = Effects::of(&scene.viewed(&settings));
    let samples = Samples::new((scene.width, scene.height), &Density::sparse(0.2)).unwrap();
    let count = |backend| {
        let mut engine = Engine::with(backend, scene.viewed(&settings), &effects, &COUNTED).unwrap();
        render_partial(&mut engine, backend, &samples, Fill::Nearest, |_| ()).unwrap();
        engine.rays().unwrap()
    };
    let expected = count(Backend::Reference);
    assert_eq!(expected.primary, 4 * samples.pixels().len() as u64);
    assert!(expected.shadow > 0 && expected.reflection > 0);
    if let Some(gpu) = &gpu {
        assert_eq!(count(Backend::Device(gpu, Tier::Fast)), expected);
    }
}

/// More than 16 bits hold, in one sample of one pixel.
#[test]
fn a_pixel_may_take_a_hundred_thousand_rays() {
    let Some(gpu) = gpu("a_pixel_may_take_a_hundred_thousand_rays") else { return };
    let light = |i: u32| format!("LIGHT l{i} {} 1 -3 1e-6 1e-6 1e-6\n", f64::from(i) / 200.0);
    let lights: String = (0..300).map(light).collect();
    // Inside a mirror every ray meets it again, and nothing stands before a light.
    let mut scene = scene_of(&format!("SPHERE s 0 0 -3 10 10 10 1 1 1 1 0.5 0 1 10\nAMBIENT 1 1 1\n{lights}"));
    (scene.width, scene.height) = (2, 1);
    for settings in [
        Settings { max_depth: 500, ..Settings::exact() },
        Settings { max_depth: 250, pattern: Pattern::Grid { side: 2 }, ..Settings::exact() },
    ] {
        let mut effects = Effects::of(&scene.viewed(&settings));
        effects.set = effects.set.with(Effect::Shadows, true);
        let (expected, _) = counted(Backend::Reference, &scene, &settings, &effects);
        let pixels = u64::from(scene.width * scene.height);
        assert!(expected.shadow > pixels * 100_000 && expected.reflection > pixels * 100, "{expected:?}");
        let (rays, _) = counted(Backend::Device(&gpu, Tier::Fast), &scene, &settings, &effects);
        assert_eq!(rays, expected);
    }
}

/// Counts are asked for when a renderer is made, and not later.
#[test]
fn rays_that_are_not_asked_for_are_not_counted() {
    let Some(gpu) = gpu("rays_that_are_not_asked_for_are_not_counted") else { return };
    let scene = scene_of("SPHERE a 0 0 -5 1 1 1 1 1 1 0 1 0 0.5 1\nLIGHT l 3 4 1 1 1 1");
    let (settings, backend) = (Settings::classic(), Backend::Device(&gpu, Tier::Fast));
    let effects = Effects::of(&scene.viewed(&settings));
    let mut engine = Engine::new(backend, scene.viewed(&settings), &effects).unwrap();
    render_picture(&mut engine).unwrap();
    assert_eq!(engine.rays(), None);
    let engine: Engine<Pixels> = Engine::with(backend, scene.viewed(&settings), &effects, &Options::default()).unwrap();
    assert_eq!(engine.rays(), None);
}

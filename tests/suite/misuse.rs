//! What makes no sense is an error, never another picture, whoever renders. What the types exclude is beside
//! `trueray::gpu::GpuRenderer`.

use glam::DVec3;
use trueray::area::Area;
use trueray::cpu::{Reference, filled};
use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::engine::{Backend, Engine, Filler, Options, Pixels, render_partial, render_picture};
use trueray::gpu::{Batch, Error, Kernel, ProbeRay, Prober, Question, RawBatch, Surface, echo_layout};
use trueray::misuse::Misuse;
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::sampling::{Density, Fill, MAX_PIXELS, MAX_SIDE, Samples};
use trueray::scene::{MAX_RESOLUTION, Scene};
use trueray::settings::Settings;
use trueray::tuning::Tuning;

use crate::support::{gpu, scene_of};

const SIZE: (u32, u32) = (40, 40);

fn mirrors() -> Scene {
    scene_of(
        "SPHERE a 0 0 -4 1 1 1 1 0.5 0.2 0.1 0.6 0 0.5 20\nSPHERE b 1 0 -3 0.6 1 0.6 0.2 0.5 1 0.1 0.6 0 0.5 20\n\
              LIGHT l 3 4 1 1 1 1\nAMBIENT 1 1 1\nBACK 0.1 0.2 0.3",
    )
}

#[test]
fn only_rows_and_pixels_of_the_picture_are_rendered() {
    let gpu = gpu("only_rows_and_pixels_of_the_picture_are_rendered");
    let (scene, settings) = (mirrors(), Settings::classic());
    let effects = Effects::of(&scene.viewed(&settings));
    let backends = std::iter::once(Backend::Reference).chain(gpu.iter().map(|gpu| Backend::Device(gpu, Tier::Fast)));
    for backend in backends {
        let mut rows = Engine::new(backend, scene.viewed(&settings), &effects).unwrap();
        let (whole, _) = render_picture(&mut rows).unwrap();
        for (first, bytes) in [(0, 1), (0, 119), (0, 4801), (0, 4920), (39, 240), (40, 120), (u32::MAX, 120)] {
            let error = rows.rows(first, &mut vec![0; bytes]).unwrap_err();
            assert_eq!(error, Error::Misuse(Misuse::Rows { first, bytes, size: SIZE }), "{backend:?}");
        }
        rows.rows(40, &mut []).unwrap();
        // Any row may be the first one.
        let mut some = vec![0; 120 * 23];
        rows.rows(13, &mut some).unwrap();
        assert!(some == whole[13 * 120..36 * 120], "{backend:?}");

        let mut list: Engine<Pixels> =
            Engine::with(backend, scene.viewed(&settings), &effects, &Options::default()).unwrap();
        let mut color = [[7; 3]];
        for pixel in [[40, 0], [0, 40], [100, 100], [u32::MAX, u32::MAX]] {
            let error = list.pixels(&[pixel], &mut color).unwrap_err();
            assert_eq!(error, Error::Misuse(Misuse::Pixel { pixel, area: Area::whole(SIZE) }), "{backend:?}");
        }
        assert_eq!(color, [[7; 3]]);
        for colors in [0, 2] {
            let error = list.pixels(&[[1, 2]], &mut vec![[0; 3]; colors]).unwrap_err();
            assert_eq!(error, Error::Misuse(Misuse::Colors { pixels: 1, colors }), "{backend:?}");
        }
        // And after all that the right ones.
        list.pixels(&[[20, 21]], &mut color).unwrap();
        assert_eq!(color[0], whole[(21 * 40 + 20) * 3..][..3], "{backend:?}");

        let other = Samples::new((39, 40), &Density::sparse(0.5)).unwrap();
        let error = render_partial(&mut list, backend, &other, Fill::Nearest, |_| ()).unwrap_err();
        assert_eq!(error, Error::Misuse(Misuse::Samples { of: (39, 40), size: SIZE }));
        let error = Filler::new(backend).unwrap().filled(&other, &[[0; 3]], Fill::Nearest).unwrap_err();
        assert!(matches!(error, Error::Misuse(Misuse::Colors { colors: 1, .. })), "{error}");
    }
    let reference = Reference::<f64>::new(&scene.viewed(&settings), &effects);
    assert!(reference.color(39, 39).is_some());
    assert_eq!([reference.color(40, 0), reference.color(0, 40), reference.color(100, 100)], [None; 3]);
}

#[test]
fn pictures_out_of_range_are_refused() {
    let gpu = gpu("pictures_out_of_range_are_refused");
    let (scene, settings) = (mirrors(), Settings::classic());
    let effects = Effects::of(&scene.viewed(&settings));
    let sized = |width, height| Scene { width, height, ..scene.clone() };
    for backend in std::iter::once(Backend::Reference).chain(gpu.iter().map(|gpu| Backend::Device(gpu, Tier::Fast))) {
        for (scene, settings, name) in [
            (sized(0, 40), settings, "width"),
            (sized(40, 0), settings, "height"),
            (sized(MAX_RESOLUTION + 1, 1), settings, "width"),
            (sized(40, 40), Settings { pattern: Pattern::Grid { side: 0 }, ..settings }, "samples"),
            (sized(40, 40), Settings { pattern: Pattern::Grid { side: Pattern::MAX_SIDE + 1 }, ..settings }, "samples"),
            (sized(40, 40), Settings { max_depth: Settings::MAX_DEPTH + 1, ..settings }, "max_depth"),
        ] {
            let error = Engine::new(backend, scene.viewed(&settings), &effects).unwrap_err();
            assert!(matches!(&error, Error::Misuse(Misuse::Picture(why)) if why.contains(name)), "{error}");
        }
    }
    for size in [(0, 5), (5, 0), (MAX_SIDE + 1, 1), (8192, (MAX_PIXELS / 8192) as u32 + 1)] {
        assert!(matches!(Samples::new(size, &Density::FULL), Err(Misuse::Picture(_))), "{size:?}");
    }
    let samples = Samples::new(SIZE, &Density::FULL).unwrap();
    assert_eq!(filled(&samples, &[], Fill::Smooth), Err(Misuse::Colors { pixels: 1600, colors: 0 }));
}

/// The kernels follow the indices of a batch unchecked.
#[test]
fn batches_whose_parts_do_not_fit_together_are_refused() {
    let Some(gpu) = gpu("batches_whose_parts_do_not_fit_together_are_refused") else { return };
    let ray =
        |first, end, own| ProbeRay { origin: DVec3::ZERO, direction: DVec3::NEG_Z, first, end, primary: false, own };
    let surface = Surface { center: DVec3::new(0.0, 0.0, -5.0), scale: DVec3::ONE };
    let batch = |rays: Vec<ProbeRay>, lights| Batch {
        rays,
        surfaces: vec![surface; 3],
        lights: vec![DVec3::ZERO; lights],
        bounces: 1,
        eta: 1.5,
        exponent: 1.0,
    };
    let mut prober = Prober::new(&gpu, Kernel::Tier(Tier::Fast)).unwrap();
    let good = batch(vec![ray(0, 3, Some(2)), ray(1, 2, None), ray(3, 3, None)], 3);
    let all = [Question::Nearest, Question::Blocked, Question::Lit, Question::Bounce, Question::Refract];
    for question in all {
        assert_eq!(prober.ask(question, &good).unwrap().len(), 3, "{question:?}");
        for wrong in [
            ray(0, 4, None),
            ray(2, 1, None),
            ray(4, 4, None),
            ray(0, 3, Some(3)),
            ray(1, 2, Some(0)),
            ray(0, 3, Some(4_000_000_000)),
        ] {
            let error = prober.ask(question, &batch(vec![ray(0, 3, None), wrong], 2)).unwrap_err();
            assert!(
                matches!(&error, Error::Misuse(Misuse::Batch(why)) if why.contains("ray 1 ")),
                "{question:?}: {error}"
            );
        }
    }
    let rays = vec![ray(0, 3, None); 640];
    for lights in [0, 1, 641] {
        let error = prober.ask(Question::Lit, &batch(rays.clone(), lights)).unwrap_err();
        assert!(error.to_string().contains("lights for 640 rays"), "{error}");
    }
    let deep = Batch { bounces: u32::MAX, ..good };
    assert!(matches!(prober.ask(Question::Bounce, &deep), Err(Error::Misuse(Misuse::Batch(_)))));
    let raw = RawBatch { rays: vec![[[0.0; 6]; 2]], shapes: Vec::new() };
    assert_eq!(prober.ask_raw(&raw).unwrap_err(), Error::Misuse(Misuse::Batch("0 shapes for 1 rays".into())));
}

#[test]
fn tunings_out_of_their_limits_are_refused() {
    let Some(mut gpu) = gpu("tunings_out_of_their_limits_are_refused") else { return };
    let own = gpu.tuned().tuning;
    for (tuning, name) in [
        (Tuning { workgroup: 0, ..own }, "workgroup"),
        (Tuning { workgroup: gpu.device.info.max_invocations + 1, ..own }, "workgroup"),
        (Tuning { path_mib: u32::MAX, ..own }, "path_mib"),
        (Tuning { paths: 0, ..own }, "paths"),
        (Tuning { dispatch_ms: f64::NAN, ..own }, "dispatch_ms"),
    ] {
        let error = gpu.set_tuning(tuning).unwrap_err();
        assert!(matches!(&error, Misuse::Tuning(why) if why.contains(name)), "{error}");
        assert_eq!(gpu.tuned().tuning, own);
    }
}

/// The kernel that echoes a scene reads two spheres with all their numbers.
#[test]
fn other_scenes_are_not_echoed() {
    let Some(gpu) = gpu("other_scenes_are_not_echoed") else { return };
    let settings = Settings::classic();
    let echo = |scene: &Scene, effects: EffectSet| {
        let effects = Effects::requested(&scene.viewed(&settings), &Request::Exactly(effects));
        echo_layout(&gpu, &scene.viewed(&settings), &effects, Kernel::Tier(Tier::Fast))
    };
    let (two, none) = (mirrors(), scene_of("LIGHT l 3 4 1 1 1 1"));
    assert!(echo(&two, EffectSet::ALL).is_ok());
    let refused = |result| matches!(result, Err(Error::Misuse(Misuse::Picture(_))));
    assert!(
        refused(echo(&none, EffectSet::ALL)) && refused(echo(&two, EffectSet::ALL.with(Effect::Ellipsoids, false)))
    );
}

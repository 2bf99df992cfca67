//! Lists of spheres leave out nothing: pictures are byte for byte those for which every list has every sphere.

use std::sync::Arc;

use glam::DVec3;
use trueray::accel::{Acceleration, Density, Lists, Rounding};
use trueray::cpu::Reference;
use trueray::effects::{EffectSet, Effects};
use trueray::engine::{Backend, Engine, Options, render_picture};
use trueray::gpu::{Gpu, GpuRenderer, Kernel};
use trueray::kept::Kept;
use trueray::pattern::Pattern;
use trueray::precision::{Request, Selection, Tier};
use trueray::scene::{Scene, Sphere};
use trueray::settings::Settings;
use trueray::stress::Random;
use trueray::tuning::Tuning;
use trueray::verify::Verify;
use trueray::view::View;

use crate::support::scene_of;

/// Kinds of scenes, each with its own difficulty.
const KINDS: u64 = 15;

/// A random scene: its kind is `seed` modulo [`KINDS`].
fn random_scene(seed: u64) -> Scene {
    let mut random = Random::new(4, seed);
    let kind = seed % KINDS;
    let mut scene = scene_of("AMBIENT 0.2 0.2 0.2\nBACK 0.1 0.2 0.3");
    (scene.width, scene.height) = (17 + (random.bits() % 40) as u32, 9 + (random.bits() % 40) as u32);
    let far = if kind == 8 { DVec3::new(1e5, -2e5, -3e5) } else { DVec3::ZERO };
    let count = match kind {
        0 => random.bits() % 5,
        1 => 400,
        2 | 14 => 1000,
        // Few numbers, here and of lights: where all spheres are tested, a kernel is for so many of both.
        _ => [17, 136][(random.bits() % 2) as usize],
    };
    let cluster: Vec<DVec3> = (0..4).map(|_| random.in_box(6.0)).collect();
    for index in 0..count {
        let spread = if kind == 7 { 0.1 } else { 6.0 };
        let mut center = random.in_box(spread) + DVec3::new(0.0, 0.0, -9.0);
        let mut scale = DVec3::splat(random.within(0.1, 1.2));
        match kind {
            // All in one place; many of them in one place.
            2 => (center, scale) = (DVec3::new(0.3, 0.2, -8.0), DVec3::splat(2.0)),
            3 if index % 2 == 0 => (center, scale) = (DVec3::new(0.0, 0.0, -6.0), DVec3::new(1.0, 2.0, 1.5)),
            // One around everything, the eye included.
            4 if index == 5 => (center, scale) = (DVec3::ZERO, DVec3::splat(60.0)),
            // Discs and needles.
            5 => {
                scale = DVec3::from_array([(); 3].map(|()| random.magnitude(-3.0, 0.5)));
            }
            6 => scale *= DVec3::new(random.within(0.5, 2.0), random.within(0.5, 2.0), 1.0),
            // Close to the eye: cut by the image plane, around the eye, behind it.
            7 => center = random.in_box(2.5),
            // A huge one below tiny ones.
            9 if index == 0 => (center, scale) = (DVec3::new(0.0, -1e4, -9.0), DVec3::splat(1e4 - 3.0)),
            9 | 10 => scale *= 0.1,
            // As small as pixels, so that tiles become smaller, too.
            14 => scale *= 0.05,
            // Touching: equal distances along shared tangents and in shared points.
            11 => (center, scale) = ((center / 2.0).round() * 2.0, DVec3::ONE),
            _ => {}
        }
        if kind == 10 {
            center = cluster[index as usize % 4] + random.in_ball() * 0.5 + DVec3::new(0.0, 0.0, -9.0);
        }
        scene.spheres.push(Sphere {
            center: center + far,
            scale,
            color: random.in_box(0.5) + DVec3::splat(0.5),
            ka: 0.4,
            kd: 0.6,
            ks: 0.4,
            kr: if random.bits().is_multiple_of(2) { random.within(0.1, 1.0) } else { 0.0 },
            n: 20.0,
            kt: 0.0,
            eta: 1.0,
        });
        scene.sphere_names.push("s");
    }
    let lights = match kind {
        12 => 40,
        _ => [0, 1, 3, 5][(random.bits() % 4) as usize],
    };
    for index in 0..lights {
        // Far, among the spheres, inside one, on a surface.
        let position = match (index, scene.spheres.first()) {
            (1, Some(sphere)) => sphere.center + sphere.scale * 0.3,
            (2, Some(sphere)) => sphere.center + DVec3::new(sphere.scale.x, 0.0, 0.0),
            _ => far + random.in_box(if index == 0 { 40.0 } else { 8.0 }),
        };
        scene.lights.push(trueray::scene::Light { position, intensity: DVec3::splat(1.0 / lights as f64) });
        scene.light_names.push("l");
    }
    if kind == 8 {
        // Look at what is far off: the eye stays.
        scene.window.left = -1.0 + far.x / -far.z;
        scene.window.right = 1e-5 * 4.0 + far.x / -far.z;
        scene.window.left = scene.window.right - 8e-5;
        (scene.window.bottom, scene.window.top) = (far.y / -far.z - 4e-5, far.y / -far.z + 4e-5);
    }
    scene
}

fn settings_of(seed: u64) -> Settings {
    let settings = if (seed / KINDS).is_multiple_of(2) { Settings::classic() } else { Settings::exact() };
    Settings {
        max_depth: [3, 0, 1, 8][(seed / KINDS % 4) as usize],
        pattern: Pattern::Grid { side: 1 + u32::from(seed % 23 == 22) },
        ..settings
    }
}

fn cpu(scene: &Scene, settings: &Settings, rounding: Rounding) -> Vec<u8> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(&scene.viewed(settings));
    Reference::<f64>::with_rounding(&scene.viewed(settings), &effects, rounding).rows(0, &mut rgb).unwrap();
    rgb
}

fn device(gpu: &Gpu, kernel: Kernel, scene: &Scene, settings: &Settings, rounding: Rounding) -> Vec<u8> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(&scene.viewed(settings));
    let renderer = GpuRenderer::with_rounding(gpu, &scene.viewed(settings), &effects, kernel, rounding);
    assert!(renderer.unwrap().rows(0, &mut rgb).unwrap().cut.is_empty());
    rgb
}

fn first_difference(a: &[u8], b: &[u8], scene: &Scene) -> Option<(usize, usize)> {
    let at = a.iter().zip(b).position(|(a, b)| a != b)? / 3;
    Some((at % scene.width as usize, at / scene.width as usize))
}

#[test]
fn the_reference_leaves_out_nothing() {
    for seed in 0..420 {
        let (scene, settings) = (random_scene(seed), settings_of(seed));
        let all = cpu(&scene, &settings, Rounding::UNKNOWN);
        let lists = cpu(&scene, &settings, Rounding::DOUBLE);
        assert_eq!(first_difference(&all, &lists, &scene), None, "scene {seed}");
    }
}

#[test]
fn the_device_leaves_out_nothing_at_any_tier() {
    let Some(mut gpu) = crate::support::gpu("the_device_leaves_out_nothing_at_any_tier") else { return };
    let own = gpu.tuned().tuning;
    let at_once = Tuning { in_place_below: 0.0, in_turn_from: 1e9, ..own };
    let in_place = Tuning { in_place_below: 1e9, ..at_once };
    let in_turn = Tuning { in_turn_from: 0.0, paths: 5, ..at_once };
    // Tiles as small as it helps, too.
    let small = |tuning: Tuning| Tuning { density: Density { longest_tile: 0.0, ..tuning.density }, ..tuning };
    let kernels: Vec<_> = Tier::ALL.into_iter().filter_map(|tier| gpu.kernel(tier).ok()).collect();
    for kernel in kernels {
        for seed in 0..210 {
            let (scene, settings) = (random_scene(seed), settings_of(seed));
            gpu.set_tuning(at_once).unwrap();
            let all = device(&gpu, kernel, &scene, &settings, Rounding::UNKNOWN);
            gpu.set_tuning(
                [small(at_once), in_place, in_turn, at_once, small(in_place), small(in_turn)][seed as usize % 6],
            )
            .unwrap();
            let lists = device(&gpu, kernel, &scene, &settings, kernel.rounding());
            gpu.set_tuning(own).unwrap();
            assert_eq!(first_difference(&all, &lists, &scene), None, "{kernel:?}, scene {seed}");
        }
    }
}

/// So many discs around one point, each of which hides all before it, so that only who comes to the end sees the last one.
fn coincident(count: u32, center: DVec3, radius: f64) -> Scene {
    let mut scene = scene_of("AMBIENT 1 1 1");
    (scene.width, scene.height) = (8, 8);
    scene.spheres = (0..count)
        .map(|index| Sphere {
            center,
            scale: DVec3::new(radius, radius, 1.0 + f64::from(index) * 1e-5),
            color: DVec3::splat(f64::from(index) / f64::from(count)),
            ka: 1.0,
            kd: 0.0,
            ks: 0.0,
            kr: 0.0,
            n: 1.0,
            kt: 0.0,
            eta: 1.0,
        })
        .collect();
    (0..scene.spheres.len()).for_each(|_| scene.sphere_names.push("s"));
    scene
}

/// The whole picture, or the device says which pixels are not to be used; then an engine leaves them to the reference if it has
/// one, and refuses the picture if not.
fn assert_whole_or_refused(gpu: &Gpu, scene: &Scene) {
    let settings = Settings::classic();
    let expected = cpu(scene, &settings, Rounding::DOUBLE);
    for kernel in Tier::ALL.into_iter().filter_map(|tier| gpu.kernel(tier).ok()) {
        let effects = Effects::of(&scene.viewed(&settings));
        let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
        let mut renderer =
            GpuRenderer::with_rounding(gpu, &scene.viewed(&settings), &effects, kernel, kernel.rounding()).unwrap();
        match renderer.rows(0, &mut rgb) {
            Ok(rendered) => {
                let mut whole = rgb;
                for [x, y] in rendered.cut {
                    let at = (y * scene.width + x) as usize * 3;
                    whole[at..at + 3].copy_from_slice(&expected[at..at + 3]);
                }
                assert_eq!(first_difference(&whole, &expected, scene), None, "{kernel:?}");
            }
            Err(error) => panic!("{kernel:?}: {error}"),
        }
    }
    let engine = |verify| {
        let (backend, effects) = (Backend::Device(gpu, Tier::Fast), Effects::of(&scene.viewed(&settings)));
        let mut engine =
            Engine::verified(backend, scene.viewed(&settings), &effects, &Options::default(), verify).unwrap();
        render_picture(&mut engine).map(|picture| (picture.0, engine.cut()))
    };
    let (whole, cut) = engine("1".parse().unwrap()).unwrap();
    assert_eq!(first_difference(&whole, &expected, scene), None);
    match engine(Verify::Nothing) {
        Ok((picture, _)) => assert!(cut == 0 && picture == expected),
        Err(error) => assert!(cut > 0 && error.to_string().contains("turns of a loop"), "{error}"),
    }
}

/// More spheres under one tile than some devices have turns of a loop for.
#[test]
fn a_list_that_is_too_long_for_a_device_is_no_other_picture() {
    let Some(gpu) = crate::support::gpu("a_list_that_is_too_long_for_a_device_is_no_other_picture") else { return };
    assert_whole_or_refused(&gpu, &coincident(80_000, DVec3::new(0.0, 0.0, -5.0), 2.0));
}

/// So many behind the eye, where only a mirror shows them.
fn mirrored(count: u32) -> Scene {
    let mut scene = coincident(count, DVec3::new(0.0, 0.0, 60.0), 40.0);
    let mirror = Sphere { center: DVec3::new(0.0, 0.0, -54.0), scale: DVec3::splat(50.0), kr: 1.0, ..scene.spheres[0] };
    scene.spheres.push(mirror);
    scene.sphere_names.push("mirror");
    scene
}

#[test]
fn a_walk_that_is_too_long_for_a_device_is_no_other_picture() {
    let Some(mut gpu) = crate::support::gpu("a_walk_that_is_too_long_for_a_device_is_no_other_picture") else { return };
    let scene = mirrored(80_000);
    let own = gpu.tuned().tuning;
    for (in_place_below, in_turn_from) in [(0.0, 0.0), (0.0, 1e9), (1e9, 1e9)] {
        gpu.set_tuning(Tuning { in_place_below, in_turn_from, ..own }).unwrap();
        assert_whole_or_refused(&gpu, &scene);
    }
    gpu.set_tuning(own).unwrap();
}

/// The picture of `scene` with each way to walk: at once, in turn, in place.
fn walked(gpu: &mut Gpu, scene: &Scene, settings: &Settings) -> [Vec<u8>; 3] {
    let own = gpu.tuned().tuning;
    let pictures = [(0.0, 1e9), (0.0, 0.0), (1e9, 1e9)].map(|(in_place_below, in_turn_from)| {
        gpu.set_tuning(Tuning { in_place_below, in_turn_from, ..own }).unwrap();
        device(gpu, Kernel::Tier(Tier::Fast), scene, settings, Rounding::SINGLE)
    });
    gpu.set_tuning(own).unwrap();
    pictures
}

/// Walks that are too long together, but none by itself.
#[test]
fn long_walks_in_turn_are_walked_at_once_instead() {
    let Some(mut gpu) = crate::support::gpu("long_walks_in_turn_are_walked_at_once_instead") else { return };
    let mut scene = mirrored(6000);
    (scene.width, scene.height) = (64, 64);
    let [at_once, in_turn, in_place] = walked(&mut gpu, &scene, &Settings::classic());
    assert_eq!(first_difference(&at_once, &in_turn, &scene), None);
    assert_eq!(first_difference(&at_once, &in_place, &scene), None);
    // They are seen at all.
    assert!(at_once.chunks(3).filter(|pixel| pixel.iter().all(|&level| level > 200)).count() > 100);
}

/// Bounces that are too long together, but none by itself: to and fro between mirrors.
#[test]
fn long_bounces_in_place_are_walked_at_once_instead() {
    let Some(mut gpu) = crate::support::gpu("long_bounces_in_place_are_walked_at_once_instead") else { return };
    let mut scene = mirrored(21_000);
    scene.spheres.iter_mut().for_each(|sphere| sphere.kr = 0.5);
    let [at_once, in_turn, in_place] = walked(&mut gpu, &scene, &Settings::classic());
    assert_eq!(first_difference(&at_once, &in_turn, &scene), None);
    assert_eq!(first_difference(&at_once, &in_place, &scene), None);
}

/// More bounces, each with many lights, than an invocation has turns for, in the samples of one pixel or in one of them. Each adds
/// as much as any other, so that the picture shows whether one is missing.
#[test]
fn many_bounces_in_place_are_walked_at_once_instead() {
    let Some(mut gpu) = crate::support::gpu("many_bounces_in_place_are_walked_at_once_instead") else { return };
    let light = |i: u32| format!("LIGHT l{i} {} 1 -3 1e-6 1e-6 1e-6\n", f64::from(i) / 20.0);
    let lights: String = (0..60).map(light).collect();
    for (samples, max_depth) in [(1, 900), (4, 60)] {
        let ambient = 0.7 / f64::from(max_depth);
        let mut scene = scene_of(&format!(
            "SPHERE s 0 0 -3 10 10 10 1 1 1 1 0.5 0 1 10\nAMBIENT {ambient} {ambient} {ambient}\n{lights}"
        ));
        (scene.width, scene.height) = (8, 8);
        let settings = Settings { pattern: Pattern::Grid { side: samples }, max_depth, ..Settings::classic() };
        let [at_once, in_turn, in_place] = walked(&mut gpu, &scene, &settings);
        assert_eq!(first_difference(&at_once, &in_turn, &scene), None);
        assert_eq!(first_difference(&at_once, &in_place, &scene), None);
        assert!(at_once.iter().all(|&level| level > 150), "{:?}", at_once.iter().min());
    }
}

/// An eye among the spheres of [`random_scene`], or a little beside them.
fn random_eye(random: &mut Random, scene: &Scene) -> View {
    let far = scene.spheres.first().map_or(DVec3::ZERO, |sphere| sphere.center);
    // Where the window looks at what is far off, the eye stays where that is seen.
    let reach = if far.length() > 1e4 && scene.spheres.len() > 1 { 1e-3 } else { 3.0 };
    let eye = random.in_box(reach);
    let look_at = (reach > 1.0).then(|| DVec3::new(0.0, 0.0, -9.0) + random.in_box(2.0));
    View::new(eye, look_at, DVec3::Y).unwrap()
}

/// What one eye leaves to the next has room for what the next one's rounding may take for a hit.
#[test]
fn lists_that_eyes_share_leave_out_nothing() {
    let gpu = crate::support::gpu("lists_that_eyes_share_leave_out_nothing");
    let kernels = gpu.iter().flat_map(|gpu| Tier::ALL.into_iter().filter_map(|tier| gpu.kernel(tier).ok()));
    let renderers: Vec<Option<Kernel>> = kernels.map(Some).chain([None]).collect();
    for kernel in renderers {
        for seed in 0..if kernel.is_some() { KINDS } else { 4 * KINDS } {
            let (scene, kept) = (random_scene(seed), Kept::default());
            let mut random = Random::new(5, seed);
            for eye in 0..3 {
                let settings = Settings { view: random_eye(&mut random, &scene), ..settings_of(seed) };
                let viewed = scene.viewed_again(&settings, &kept);
                let effects = Effects::of(&viewed);
                let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
                let all = if let (Some(gpu), Some(kernel)) = (&gpu, kernel) {
                    let renderer = GpuRenderer::with_rounding(gpu, &viewed, &effects, kernel, kernel.rounding());
                    assert!(renderer.unwrap().rows(0, &mut rgb).unwrap().cut.is_empty());
                    device(gpu, kernel, &scene, &settings, Rounding::UNKNOWN)
                } else {
                    let reference = Reference::<f64>::with_rounding(&viewed, &effects, Rounding::DOUBLE);
                    reference.rows(0, &mut rgb).unwrap();
                    cpu(&scene, &settings, Rounding::UNKNOWN)
                };
                assert_eq!(first_difference(&all, &rgb, &scene), None, "{kernel:?}, scene {seed}, eye {eye}");
            }
        }
    }
}

/// The lists of the screen, what is said of effects and the choice of a tier are those of an eye that comes alone.
#[test]
fn eyes_that_share_find_what_each_finds_alone() {
    for seed in 0..8 * KINDS {
        let (scene, kept) = (random_scene(seed), Kept::default());
        let mut random = Random::new(6, seed);
        for eye in 0..4 {
            let settings = Settings { view: random_eye(&mut random, &scene), ..settings_of(seed) };
            let found = [scene.viewed(&settings), scene.viewed_again(&settings, &kept)].map(|viewed| {
                let effects = Effects::of(&viewed);
                let selection = Selection::of(&viewed, &effects, Request::Auto, &Tier::ALL);
                let accel = Acceleration::new(&viewed, effects.set, Rounding::SINGLE);
                (effects, selection, accel.screen.shift, accel.screen.lists)
            });
            assert!(found[0] == found[1], "scene {seed}, eye {eye}");
        }
    }
}

#[test]
fn lists_are_kept_for_eyes_that_are_near_each_other() {
    let scene = random_scene(1);
    let kept = Kept::default();
    let lists = |x: f64| {
        let view = View::new(DVec3::new(x, 0.0, 0.0), None, DVec3::Y).unwrap();
        let viewed = scene.viewed_again(&Settings { view, ..Settings::default() }, &kept);
        Acceleration::new(&viewed, EffectSet::ALL, Rounding::SINGLE)
    };
    let (first, near, far) = (lists(0.0), lists(3.0), lists(300.0));
    let is_same = |a: &Lists, b: &Lists| Arc::ptr_eq(&a.entries, &b.entries);
    let grids = [&first, &near, &far].map(|accel| &accel.grid.as_ref().unwrap().lists);
    assert!(is_same(grids[0], grids[1]) && !is_same(grids[0], grids[2]));
    assert!(!first.lights.lists.is_empty() && is_same(&first.lights.lists[0], &near.lights.lists[0]));
    assert!(first.screen.lists != near.screen.lists);
    assert!(first.room.is_some() && first.room == near.room && first.room != far.room, "the same place in tables");

    let kept = Kept::default();
    let mut lit = scene.clone();
    lit.lights[0].position += DVec3::X / 64.0;
    let [before, again, moved] = [&scene, &scene, &lit].map(|scene| {
        let viewed = scene.viewed_again(&Settings::default(), &kept);
        Acceleration::new(&viewed, EffectSet::ALL, Rounding::SINGLE)
    });
    assert!(is_same(&before.lights.lists[0], &again.lights.lists[0]));
    assert!(!is_same(&before.lights.lists[0], &moved.lights.lists[0]), "a light has moved");
}

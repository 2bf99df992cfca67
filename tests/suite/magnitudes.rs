//! Numbers of any size that a scene file may have: the same picture as at usual sizes, or a refusal.

use std::cmp::Ordering;

use glam::DVec3;
use trueray::cpu::{Reference, Tally, picked};
use trueray::effects::Effects;
use trueray::exact::ExactScene;
use trueray::gpu::{Gpu, GpuRenderer, Kernel, Rows};
use trueray::limits;
use trueray::precision::{self, Selection, Tier};
use trueray::scene::{Light, Scene, Sphere, Window};
use trueray::settings::{Secondary, Settings};
use trueray::stress::Random;
use trueray::view::View;

use trueray::accel::Rounding;

use crate::support::{cpu_picture, gpu, gpu_picture, scaled, scene, scene_files, scene_of};

/// All tiers that the device has.
fn kernels(gpu: &Gpu) -> Vec<Kernel> {
    Tier::ALL.into_iter().filter_map(|tier| gpu.kernel(tier).ok()).collect()
}

/// The reference's picture, with lists for a renderer that rounds like this.
fn cpu(scene: &Scene, settings: &Settings, rounding: Rounding) -> Vec<u8> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(&scene.viewed(settings));
    let tally = Reference::<f64>::with_rounding(&scene.viewed(settings), &effects, rounding).rows(0, &mut rgb);
    assert_eq!(tally.unwrap().not_finite, 0);
    rgb
}

/// The device's picture; none where it refuses the scene or has not as many turns of a loop.
fn device(gpu: &Gpu, kernel: Kernel, scene: &Scene, settings: &Settings, rounding: Rounding) -> Option<Vec<u8>> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(&scene.viewed(settings));
    let mut renderer = GpuRenderer::with_rounding(gpu, &scene.viewed(settings), &effects, kernel, rounding).ok()?;
    match renderer.rows(0, &mut rgb) {
        Ok(rendered) if !rendered.cut.is_empty() => return None,
        Ok(rendered) => {
            assert_eq!(
                rendered.not_finite,
                0,
                "{kernel:?}: {:?}",
                precision::Demand::of(&scene.viewed(settings), &effects)
            );
        }
        Err(error) => panic!("{error}"),
    }
    Some(rgb)
}

/// Whether the kernel refuses the scene.
fn is_refused(gpu: &Gpu, kernel: Kernel, scene: &Scene, settings: &Settings) -> bool {
    let viewed = scene.viewed(settings);
    GpuRenderer::<Rows>::with_rounding(gpu, &viewed, &Effects::of(&viewed), kernel, kernel.rounding()).is_err()
}

/// How many pixels differ.
fn differing(a: &[u8], b: &[u8]) -> usize {
    assert_eq!(a.len(), b.len());
    a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count()
}

/// Which do, in pictures of this width.
fn pixels_that_differ(a: &[u8], b: &[u8], width: u32) -> Vec<[u32; 2]> {
    let differing = a.chunks(3).zip(b.chunks(3)).enumerate().filter(|(_, (a, b))| a != b);
    differing.map(|(index, _)| [index as u32 % width, index as u32 / width]).collect()
}

/// What the reference's pixel took.
fn tally(scene: &Scene, settings: &Settings, pixel: [u32; 2]) -> Tally {
    let viewed = scene.viewed(settings);
    Reference::<f64>::new(&viewed, &Effects::of(&viewed)).pixels(&[pixel], &mut [[0; 3]]).unwrap()
}

/// Some spheres ahead of the eye with a mirror or two, and lights.
fn usual_scene(random: &mut Random) -> Scene {
    let mut scene = scene_of("AMBIENT 0.2 0.2 0.2\nBACK 0.1 0.2 0.3");
    (scene.width, scene.height) = (33, 25);
    // Few numbers, since where all spheres are tested a kernel is for one.
    for index in 0..[4, 13, 43][(random.bits() % 3) as usize] {
        scene.spheres.push(Sphere {
            center: random.in_box(4.0) + DVec3::new(0.0, 0.0, -7.0),
            scale: DVec3::from_array([(); 3].map(|()| random.within(0.3, 1.2))),
            color: random.in_box(0.4) + DVec3::splat(0.6),
            ka: 0.5,
            kd: 0.6,
            ks: 0.3,
            kr: if index % 4 == 0 { 0.5 } else { 0.0 },
            n: 20.0,
            kt: if index % 7 == 6 { 0.4 } else { 0.0 },
            eta: 1.4,
        });
        scene.sphere_names.push("s");
    }
    for _ in 0..=random.bits() % 3 {
        scene.lights.push(Light { position: random.in_box(9.0), intensity: DVec3::splat(0.4) });
        scene.light_names.push("l");
    }
    scene
}

/// A scene with numbers of sizes that differ without measure.
fn odd_scene(seed: u64) -> (Scene, Settings) {
    let mut random = Random::new(14, seed);
    let mut scene = usual_scene(&mut random);
    let settings = if seed.is_multiple_of(2) { Settings::exact() } else { Settings::classic() };
    let mut settings = Settings { max_depth: 3, ..settings };
    // How far from usual: some decades, or all that there are.
    let most = [6.0, 20.0, 60.0, 300.0][(seed / 2 % 4) as usize];
    let kind = seed / 8 % 8;
    let spheres = scene.spheres.len();
    let direction = random.in_box(1.0);
    match kind {
        // Suns.
        0 => scene.lights.iter_mut().for_each(|light| light.position *= random.magnitude(3.0, most)),
        // Tiny spheres among the others, some of them around a light or the eye.
        1 => {
            for (index, sphere) in scene.spheres.iter_mut().enumerate().filter(|(index, _)| index % 2 == 0) {
                sphere.scale *= random.magnitude(-most, -1.0);
                if index % 4 == 0 {
                    sphere.center = scene.lights[0].position;
                }
            }
        }
        // A floor, a sky.
        2 => {
            let radius = random.magnitude(2.0, most);
            scene.spheres[0].scale = DVec3::splat(radius);
            scene.spheres[0].center = DVec3::new(0.0, -radius - 3.0, -7.0);
            scene.spheres[1].scale = DVec3::splat(random.magnitude(2.0, most));
        }
        // Discs and needles.
        3 => scene.spheres.iter_mut().for_each(|sphere| sphere.scale[0] *= random.magnitude(-most, 0.0)),
        // The eye far off, looking back.
        4 => {
            let eye = direction * random.magnitude(2.0, most);
            let target = DVec3::new(0.0, 0.0, -7.0);
            settings.view = View::new(eye, Some(target), DVec3::Y).unwrap_or(View::FILE);
            let width = 8.0 / (eye - target).length();
            if width > 0.0 && width.is_finite() {
                scene.window = Window { near: 1.0, left: -width, right: width, bottom: -width, top: width };
            }
        }
        // A window of another size, or aslant.
        5 => {
            let factor = random.magnitude(-most, 0.5);
            let Window { near, left, right, bottom, top } = scene.window;
            let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * factor);
            scene.window = Window { near, left, right, bottom, top };
            if random.bits().is_multiple_of(2) {
                scene.window.near *= random.magnitude(-most, 0.0);
            }
        }
        // Each on its own.
        6 => {
            for sphere in &mut scene.spheres {
                let factor = random.magnitude(-most / 2.0, most / 2.0);
                sphere.center *= factor;
                sphere.scale *= factor;
            }
            scene.lights.iter_mut().for_each(|light| light.position *= random.magnitude(-most, most));
        }
        // Behind each other, of the same apparent size.
        _ => {
            for index in 0..spheres {
                let factor = 10_f64.powf(most * index as f64 / spheres as f64 - most / 2.0);
                scene.spheres[index].center *= factor;
                scene.spheres[index].scale *= factor;
            }
        }
    }
    // And all of it in other units.
    let factor =
        if (seed / 64).is_multiple_of(2) { 1.0 } else { 2_f64.powi((random.within(-1.0, 1.0) * most) as i32 * 2) };
    (scaled(&scene, factor), settings)
}

/// Of scenes that are not refused: the lists leave out nothing, and rays from the eye meet what all spheres together say.
#[test]
fn lists_hold_at_every_magnitude() {
    let mut rendered = 0;
    for seed in 0..768 {
        let (scene, settings) = odd_scene(seed);
        if limits::problem(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings))).is_some() {
            continue;
        }
        rendered += 1;
        let lists = cpu(&scene, &settings, Rounding::DOUBLE);
        let all = cpu(&scene, &settings, Rounding::UNKNOWN);
        assert_eq!(differing(&lists, &all), 0, "scene {seed}");
        let background = cpu_picture::<f64>(
            &Scene { spheres: Vec::new(), ..scene.clone() },
            &settings,
            &Effects::of(&Scene { spheres: Vec::new(), ..scene.clone() }.viewed(&settings)),
        );
        let empty = background.0.rgb()[..3].to_vec();
        let has_glass = scene.spheres.iter().any(|sphere| sphere.kt != 0.0);
        let viewed = scene.viewed(&settings);
        for (index, pixel) in lists.chunks(3).enumerate().step_by(if has_glass { 7 } else { 3 }) {
            let [x, y] = [index as u32 % scene.width, index as u32 / scene.width];
            let hit = picked(&viewed, x, y);
            assert!(hit.is_some() || pixel == empty, "scene {seed}, pixel {x} {y}");
            assert!(hit.is_none() || pixel != empty, "scene {seed}, pixel {x} {y}: {hit:?}");
        }
    }
    assert!(rendered > 500, "{rendered}");
}

#[test]
fn lists_hold_at_every_magnitude_and_tier() {
    let Some(gpu) = gpu("lists_hold_at_every_magnitude_and_tier") else { return };
    for kernel in kernels(&gpu) {
        let mut rendered = 0;
        for seed in (1..768).step_by(11) {
            let (scene, settings) = odd_scene(seed);
            if limits::problem(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings))).is_some() {
                continue;
            }
            let lists = device(&gpu, kernel, &scene, &settings, kernel.rounding());
            // So few spheres take few turns, wherever rays leave the grid.
            assert!(lists.is_some() || is_refused(&gpu, kernel, &scene, &settings), "{kernel:?}, scene {seed}: cut");
            // Walks past all spheres in every cell are long.
            let all = device(&gpu, kernel, &scene, &settings, Rounding::UNKNOWN);
            let (Some(lists), Some(all)) = (lists, all) else { continue };
            rendered += 1;
            assert_eq!(differing(&lists, &all), 0, "{kernel:?}, scene {seed}");
            if kernel == Kernel::Tier(Tier::Double) {
                // With what exact arithmetic decides, where `f64` has bits enough.
                let (double, _) =
                    gpu_picture(&gpu, Tier::Double, &scene, &settings, &Effects::of(&scene.viewed(&settings)));
                let expected = cpu(&scene, &settings, Rounding::DOUBLE);
                let wrong = pixels_that_differ(double.rgb(), &expected, scene.width);
                let unexplained = wrong.iter().filter(|&&pixel| tally(&scene, &settings, pixel).more_bits == 0);
                assert_eq!(unexplained.count(), 0, "scene {seed}");
            }
        }
        // Single precision refuses more of them.
        assert!(rendered > 25, "{rendered}");
    }
}

/// From far away a light shines from the same direction as from farther still.
#[test]
fn shadows_of_a_far_light_do_not_depend_on_its_distance() {
    let shared = gpu("shadows_of_a_far_light_do_not_depend_on_its_distance");
    let mut with_shadows = 0;
    for seed in 0..8 {
        let mut random = Random::new(15, seed);
        let mut near = usual_scene(&mut random);
        let direction = (random.unit() + DVec3::new(0.0, 1.0, 0.5)).normalize();
        near.lights.truncate(1);
        let at = |distance: f64| {
            let mut scene = near.clone();
            scene.lights[0].position = direction * distance;
            scene
        };
        let settings = Settings { max_depth: 2, ..Settings::exact() };
        let expected = cpu(&at(1e7), &settings, Rounding::UNKNOWN);
        let unlit = {
            let none = Effects::requested(&near.viewed(&settings), &"-shadows".parse().unwrap());
            cpu_picture::<f64>(&at(1e7), &settings, &none).0
        };
        if differing(&expected, unlit.rgb()) <= 5 {
            continue;
        }
        with_shadows += 1;
        for exponent in (8..24).chain([60, 100, 150, 200, 300]) {
            let scene = at(10_f64.powi(exponent));
            let effects = Effects::of(&scene.viewed(&settings));
            // A thousandth of a pixel's width from a shadow's edge, at 10⁸, is seen by none or one of the pixels.
            let difference = differing(&cpu(&scene, &settings, Rounding::DOUBLE), &expected);
            assert!(difference <= 1, "scene {seed}, 1e{exponent}: {difference}");
            let Some(gpu) = &shared else { continue };
            let demand = precision::Demand::of(&scene.viewed(&settings), &effects);
            for kernel in kernels(gpu) {
                let Kernel::Tier(tier) = kernel else { continue };
                if demand.reach.value > tier.promise().reach {
                    assert!(exponent > 13, "{tier}");
                    continue;
                }
                let picture = device(gpu, kernel, &scene, &settings, kernel.rounding()).unwrap();
                let difference = differing(&picture, &expected);
                assert!(
                    difference <= if tier == Tier::Double { 1 } else { 4 },
                    "{tier}, scene {seed}, 1e{exponent}: {difference}"
                );
            }
        }
        // In classic the least distance of a blocker is a part of the way to the light: beyond all spheres.
        let settings = Settings { max_depth: 2, ..Settings::classic() };
        let expected = cpu(&at(1e9), &settings, Rounding::DOUBLE);
        for exponent in [12, 17, 30, 300] {
            assert!(differing(&cpu(&at(10_f64.powi(exponent)), &settings, Rounding::DOUBLE), &expected) <= 1);
        }
    }
    assert!(with_shadows > 3, "{with_shadows}");
}

/// A file's numbers times a power of two are the same picture, byte for byte, and so are the effects that `auto` leaves out. But where a
/// ray touches a sphere, or a light lies on one: the decimals of the product are others, of which it may miss it.
#[test]
fn no_picture_depends_on_its_units() {
    for file in scene_files(&["basic", "effects", "hard", "refraction", "show"]) {
        let mut original = scene(&file);
        (original.width, original.height) = (40, 30);
        for base in [Settings::classic(), Settings::exact()] {
            let expected = cpu(&original, &base, Rounding::DOUBLE);
            let exact = ExactScene::new(&original.viewed(&base), true);
            for exponent in [-900, -480, -100, -30, 30, 100, 480, 900] {
                let factor = 2_f64.powi(exponent);
                let Secondary { shadow, reflection } = base.secondary;
                let settings = Settings { secondary: Secondary { shadow, reflection: reflection * factor }, ..base };
                let scene = scaled(&original, factor);
                assert_eq!(limits::problem(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings))), None);
                let actual = cpu(&scene, &settings, Rounding::DOUBLE);
                for pixel in pixels_that_differ(&actual, &expected, scene.width) {
                    let touches = (0..scene.spheres.len()).any(|s| exact.discriminant(pixel, s) == Ordering::Equal);
                    let ties = tally(&original, &base, pixel).undecided > 0;
                    assert!(touches || ties, "{} times 2^{exponent}, pixel {pixel:?}", file.display());
                }
            }
        }
    }
}

/// Spheres wholly beyond the image plane look the same through any window of the same shape.
#[test]
fn no_picture_depends_on_the_size_of_its_window() {
    let shared = gpu("no_picture_depends_on_the_size_of_its_window");
    let mut random = Random::new(16, 0);
    let mut scene = usual_scene(&mut random);
    scene.spheres.retain(|sphere| sphere.center.z < -3.0);
    for settings in [Settings::classic(), Settings::exact()] {
        let expected = cpu(&scene, &settings, Rounding::DOUBLE);
        let kernels = shared.as_deref().map(kernels).unwrap_or_default();
        let on_device = |kernel: Kernel, scene: &Scene| {
            device(shared.as_deref().unwrap(), kernel, scene, &settings, kernel.rounding()).unwrap()
        };
        let pictures: Vec<_> = kernels.iter().map(|&kernel| on_device(kernel, &scene)).collect();
        for exponent in [-800, -300, -100, -66, -40, -20, -5, 1] {
            let window = scaled(&scene, 2_f64.powi(exponent)).window;
            let small = Scene { window, ..scene.clone() };
            assert_eq!(differing(&cpu(&small, &settings, Rounding::DOUBLE), &expected), 0, "2^{exponent}");
            for (&kernel, picture) in kernels.iter().zip(&pictures) {
                assert_eq!(differing(&on_device(kernel, &small), picture), 0, "{kernel:?}, 2^{exponent}");
            }
            let [seen, small] = [&scene, &small].map(|scene| picked(&scene.viewed(&settings), 16, 12));
            if let (Some(seen), Some(small)) = (seen, small) {
                assert_eq!((seen.sphere, seen.position), (small.sphere, small.position));
                assert_eq!(seen.t, small.t * 2_f64.powi(exponent));
            } else {
                assert_eq!(seen, small);
            }
        }
        // Aslant: so near to the eye that most rays are all but parallel to the image plane.
        for near in [1e-3, 1e-8, 1e-20, 1e-40] {
            let window = Window { near, left: -1.0, right: 0.7, bottom: -0.6, top: 1.0 };
            let aslant = Scene { window, ..scene.clone() };
            let lists = cpu(&aslant, &settings, Rounding::DOUBLE);
            assert_eq!(differing(&cpu(&aslant, &settings, Rounding::UNKNOWN), &lists), 0, "{near}");
            for &kernel in &kernels {
                let limit = usize::from(kernel != Kernel::Tier(Tier::Double));
                assert!(differing(&on_device(kernel, &aslant), &lists) <= limit, "{kernel:?}, {near}");
            }
        }
    }
}

/// Inside a sphere that shows nothing but its ambient light and itself: 1 + k + k² + … + k^depth times that.
fn inside_a_mirror(kr: f64) -> Scene {
    let mut scene = scene_of(&format!("SPHERE hall 0 0 0 5 5 5 1 1 1 0.5 0 0 {kr} 1\nAMBIENT 1 1 1"));
    (scene.width, scene.height) = (8, 8);
    scene
}

#[test]
fn negative_mirrors_alternate_between_white_and_black() {
    let shared = gpu("negative_mirrors_alternate_between_white_and_black");
    for kr in [-2.0_f64, -6e5, -6e25] {
        let scene = inside_a_mirror(kr);
        for bounces in 0..10_i32 {
            let max_depth = bounces.unsigned_abs();
            let settings = Settings { max_depth, ..Settings::exact() };
            let effects = Effects::of(&scene.viewed(&settings));
            let sum: f64 = (0..=bounces).map(|bounce| kr.powi(bounce)).sum();
            let level = (255.0 * (0.5 * sum).clamp(0.0, 1.0) + 0.5) as u8;
            let (expected, not_finite) = cpu_picture::<f64>(&scene, &settings, &effects);
            assert_eq!(not_finite, 0);
            assert!(expected.rgb().iter().all(|&l| l == level), "{kr}, depth {max_depth}: {level}");
            let Some(gpu) = &shared else { continue };
            let selection = Selection::of(&scene.viewed(&settings), &effects, precision::Request::Auto, gpu.ladder());
            let kernel = gpu.kernel(selection.tier).unwrap();
            let Some(picture) = device(gpu, kernel, &scene, &settings, kernel.rounding()) else {
                // Pairs of f32 have no greater range than one.
                assert!(!gpu.device.info.f64 && kr < -1e5, "{kr}, depth {max_depth}, {}", selection.tier);
                continue;
            };
            assert!(picture == expected.rgb(), "{kr}, depth {max_depth}, {}", selection.tier);
        }
    }
}

/// The last of three bounces between two mirrors outweighs the one before it, though what it shows is a thousand times darker.
#[test]
fn the_weight_of_a_ray_is_not_limited_where_that_would_be_seen() {
    let mut scene = scene_of(
        "SPHERE bright 0 0 -5 1 1 1 1 1 1 1 0 0 -6e25 1\nSPHERE dark 0 0 5 1 1 1 1 1 1 1e-3 0 0 -6e25 1\nAMBIENT 1 1 1",
    );
    (scene.width, scene.height) = (9, 9);
    let middle = 3 * (4 * 9 + 4);
    for (max_depth, level) in [(1, 0), (2, 255), (3, 0), (4, 255)] {
        let settings = Settings { max_depth, ..Settings::exact() };
        let picture = cpu(&scene, &settings, Rounding::DOUBLE);
        assert_eq!(picture[middle..middle + 3], [level; 3], "depth {max_depth}");
    }
}

/// What is too bright for `f32` takes `double`, and `fast` refuses it rather than show something else.
#[test]
fn colours_beyond_single_precision_take_double() {
    let shared = gpu("colours_beyond_single_precision_take_double");
    let mirrors = "SPHERE a -1 0 -5 1 1 1 1 1 1 0.5 0.5 0.5 -6e25 9\nSPHERE b 1 0 -5 1 1 1 1 1 1 0.5 0.5 0.5 -6e25 9\n\
                   SPHERE c 0 1.8 -6 1 1 1 1 0.5 0.2 0.5 0.5 0.5 0 9\nLIGHT l 3 3 3 1 1 1\nAMBIENT 1 1 1";
    let ball = "SPHERE a 0 0 -5 1 1 1 0.5 0.5 0.5 0.5 0.5 0.5 0 9\n";
    let cases = [
        (mirrors.to_owned(), "sphere 'a'"),
        (format!("{ball}LIGHT l 5 5 0 1e39 0.2 0.2\nLIGHT m -5 5 0 -1e39 0.2 0.2\n"), "sphere 'a'"),
        (format!("{ball}AMBIENT 0.1 1e39 0.1"), "AMBIENT or BACK"),
        (format!("{ball}AMBIENT 1 1 1\nBACK 0 0 1e39"), "AMBIENT or BACK"),
        (ball.replace("0.5 0.5 0.5 0 9", "1e200 0.5 0.5 0 9") + "AMBIENT 1 1 1e100", "sphere 'a'"),
    ];
    for (text, source) in cases {
        let scene = scene_of(&text);
        let settings = Settings::classic();
        let effects = Effects::of(&scene.viewed(&settings));
        assert_eq!(limits::problem(&scene.viewed(&settings), &effects), None);
        let (expected, not_finite) = cpu_picture::<f64>(&scene, &settings, &effects);
        assert_eq!(not_finite, 0);
        let selection = Selection::of(&scene.viewed(&settings), &effects, precision::Request::Auto, &Tier::ALL);
        assert_eq!((selection.tier, selection.covered), (Tier::Double, true), "{text}");
        assert!(selection.reason.contains("brightness"), "{}", selection.reason);
        let Some(gpu) = &shared else { continue };
        for kernel in kernels(gpu) {
            let renderer =
                GpuRenderer::with_rounding(gpu, &scene.viewed(&settings), &effects, kernel, kernel.rounding());
            if kernel == Kernel::Tier(Tier::Double) {
                let picture = device(gpu, kernel, &scene, &settings, kernel.rounding()).unwrap();
                assert_eq!(differing(&picture, expected.rgb()), 0, "{text}");
            } else {
                let why = renderer.unwrap_err().to_string();
                assert!(why.contains(source) && why.contains("f32") && why.contains("--precision double"), "{why}");
            }
        }
    }
}

/// 0 to the power of 0 is 1, and to that of the least number 0: it stays a number at every tier.
#[test]
fn the_least_exponent_is_none_of_zero() {
    let shared = gpu("the_least_exponent_is_none_of_zero");
    let text = |n: &str| {
        format!("SPHERE a 0 0 -5 1 1 1 1 1 1 0.2 0.2 0.6 0 {n}\nLIGHT l 4 4 0 1 1 1\nAMBIENT 0.2 0.2 0.2\nBACK 0 0 0")
    };
    let settings = Settings::classic();
    for (n, same) in [("1e-60", "1e-30"), ("1e-320", "1e-30"), ("0", "0.0")] {
        let [scene, other] = [n, same].map(|n| scene_of(&text(n)));
        let expected = cpu(&scene, &settings, Rounding::DOUBLE);
        assert_eq!(differing(&expected, &cpu(&other, &settings, Rounding::DOUBLE)), 0, "{n}");
        let Some(gpu) = &shared else { continue };
        for kernel in kernels(gpu) {
            let [picture, other] =
                [&scene, &other].map(|scene| device(gpu, kernel, scene, &settings, kernel.rounding()).unwrap());
            assert_eq!(differing(&picture, &other), 0, "{n}, {kernel:?}");
            assert!(differing(&picture, &expected) < 4, "{n}, {kernel:?}");
        }
    }
}

/// Rounding of directions is enlarged by as much as rays are bent.
#[test]
fn strong_refraction_takes_double() {
    for (eta, tier) in [("1.5", Tier::Fast), ("0.75", Tier::Fast), ("300", Tier::Double), ("0.001", Tier::Double)] {
        let scene = scene_of(&format!("SPHERE a 0 0 -5 1 1 1 1 1 1 0.2 0.2 0 0 1 0.8 {eta}\nAMBIENT 1 1 1"));
        let viewed = scene.viewed(&Settings::classic());
        let request = precision::Request::Auto;
        let selection = Selection::of(&viewed, &Effects::of(&viewed), request, &Tier::ALL);
        assert_eq!(selection.tier, tier, "{eta}: {}", selection.reason);
    }
}

/// Where even `f64` leaves its range there is a reason instead of a picture.
#[test]
fn what_f64_cannot_hold_is_refused() {
    let ball = "SPHERE a 0 0 -5 1 1 1 0.5 0.5 0.5 0.5 0.5 0.5 0 9\n";
    let cases = [
        (format!("{ball}SPHERE tiny 0 0 -5 1e-130 1 1 1 1 1 1 0 0 0 1"), "sphere 'tiny'"),
        (format!("{ball}SPHERE huge 0 -1e130 0 1e130 1e130 1e130 1 1 1 1 0 0 0 1"), "sphere 'a'"),
        (ball.replace("0.5 0.5 0.5 0 9", "1e200 0.5 0.5 0 9") + "AMBIENT 1 1 1e101", "beyond what f64 adds up"),
        (
            ball.replace("0.5 0.5 0.5 0 9", "0.5 0.5 0.5 -1e110 9") + "SPHERE b 1 0 -6 1 1 1 1 1 1 1 1 1 1 1",
            "sphere 'a'",
        ),
    ];
    for (text, reason) in cases {
        let scene = scene_of(&text);
        let settings = Settings::classic();
        let why = limits::problem(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings))).unwrap_or_default();
        assert!(why.contains(reason), "{text}: {why}");
    }
    let scene = scene_of(ball);
    let problem = |scene: &Scene, settings: &Settings| {
        limits::problem(&scene.viewed(settings), &Effects::of(&scene.viewed(settings)))
    };
    let with_near = |near: f64| Scene { window: Window { near, ..scene.window }, ..scene.clone() };
    assert!(problem(&with_near(1e-60), &Settings::classic()).unwrap().contains("NEAR"));
    assert!(problem(&with_near(1e300), &Settings::classic()).unwrap().contains("NEAR"));
    // Not all kernels can hold what the reference can.
    if let Some(gpu) = gpu("what_f64_cannot_hold_is_refused") {
        let dust = scene_of(&format!("{ball}SPHERE dust 0 0 -4 1e-30 1 1 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1"));
        let (settings, effects) = (Settings::classic(), Effects::of(&dust.viewed(&Settings::classic())));
        assert_eq!(problem(&dust, &settings), None);
        for kernel in kernels(&gpu) {
            let renderer =
                GpuRenderer::with_rounding(&gpu, &dust.viewed(&settings), &effects, kernel, kernel.rounding());
            match kernel {
                Kernel::Tier(Tier::Double) => assert!(renderer.is_ok()),
                _ => assert!(renderer.unwrap_err().to_string().contains("sphere 'dust'")),
            }
        }
    }
    let view = View::new(DVec3::new(1e308, 0.0, 0.0), None, DVec3::Y).unwrap();
    let mut far = scene.clone();
    far.spheres[0].center.x = -1e308;
    let why = problem(&far, &Settings { view, ..Settings::classic() }).unwrap();
    assert!(why.contains("sphere 'a' is so far from the eye"), "{why}");
    assert_eq!(problem(&scene, &Settings::classic()), None);
}

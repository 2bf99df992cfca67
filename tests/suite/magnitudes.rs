//! Numbers of any size that a scene file may have: the same picture as at usual sizes, or a refusal.

use glam::DVec3;
use trueray::cpu::{Reference, seen_through};
use trueray::effects::{Effects, Request};
use trueray::gpu::{Gpu, GpuRenderer, Kernel};
use trueray::limits;
use trueray::precision::{self, Selection, Tier};
use trueray::scene::{Light, Scene, Sphere, Window};
use trueray::settings::{Secondary, Settings};
use trueray::stress::Random;
use trueray::view::View;

use trueray::accel::Rounding;

use crate::support::{cpu_picture, gpu, scene, scene_files, scene_of};

/// The reference's picture, with lists for a renderer that rounds like this.
fn cpu(scene: &Scene, settings: &Settings, rounding: Rounding) -> Vec<u8> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(scene, settings);
    let tally = Reference::<f64>::with_rounding(scene, settings, &effects, rounding).rows(0, &mut rgb);
    assert_eq!(tally.not_finite, 0);
    rgb
}

/// The device's picture; none where it refuses.
fn device(gpu: &Gpu, kernel: Kernel, scene: &Scene, settings: &Settings, rounding: Rounding) -> Option<Vec<u8>> {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let effects = Effects::of(scene, settings);
    let mut renderer = GpuRenderer::with_rounding(gpu, scene, settings, &effects, kernel, rounding).ok()?;
    assert_eq!(renderer.rows(0, &mut rgb).unwrap(), 0);
    Some(rgb)
}

/// How many pixels differ.
fn differing(a: &[u8], b: &[u8]) -> usize {
    assert_eq!(a.len(), b.len());
    a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count()
}

/// Some spheres ahead of the eye with a mirror or two, and lights.
fn usual_scene(random: &mut Random) -> Scene {
    let mut scene = scene_of("AMBIENT 0.2 0.2 0.2\nBACK 0.1 0.2 0.3");
    (scene.width, scene.height) = (33, 25);
    for index in 0..4 + random.bits() % 40 {
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

/// `scene` in other units.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let Window { near, left, right, bottom, top } = scene.window;
    let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * factor);
    scene.window = Window { near, left, right, bottom, top };
    for sphere in &mut scene.spheres {
        sphere.center *= factor;
        sphere.scale *= factor;
    }
    scene.lights.iter_mut().for_each(|light| light.position *= factor);
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
    let factor = if seed / 64 % 2 == 0 { 1.0 } else { 2_f64.powi((random.within(-1.0, 1.0) * most) as i32 * 2) };
    (scaled(&scene, factor), settings)
}

/// Of scenes that are not refused: the lists leave out nothing, and rays from the eye meet what all spheres together say.
#[test]
fn lists_hold_at_every_magnitude() {
    let mut rendered = 0;
    for seed in 0..768 {
        let (scene, settings) = odd_scene(seed);
        if limits::problem(&scene, &settings, &Effects::of(&scene, &settings)).is_some() {
            continue;
        }
        rendered += 1;
        let lists = cpu(&scene, &settings, Rounding::DOUBLE);
        let all = cpu(&scene, &settings, Rounding::UNKNOWN);
        assert_eq!(differing(&lists, &all), 0, "scene {seed}");
        let background = cpu_picture::<f64>(
            &Scene { spheres: Vec::new(), ..scene.clone() },
            &settings,
            &Effects::of(&Scene { spheres: Vec::new(), ..scene.clone() }, &settings),
        );
        let empty = background.0.rgb()[..3].to_vec();
        let has_glass = scene.spheres.iter().any(|sphere| sphere.kt != 0.0);
        for (index, pixel) in lists.chunks(3).enumerate().step_by(if has_glass { 7 } else { 3 }) {
            let [x, y] = [index as u32 % scene.width, index as u32 / scene.width];
            let hit = seen_through(&scene, &settings, x, y);
            assert!(hit.is_some() || pixel == empty, "scene {seed}, pixel {x} {y}");
            assert!(hit.is_none() || pixel != empty, "scene {seed}, pixel {x} {y}: {hit:?}");
        }
    }
    assert!(rendered > 500, "{rendered}");
}

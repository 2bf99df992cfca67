//! A camera that moves: the file's own one stays what it is, any other sees the world from where it is.

use std::ffi::OsStr;
use std::process::Command;

use glam::DVec3;
use proptest::prelude::*;
use trueray::accel::{Acceleration, Density, Rounding};
use trueray::camera::Camera;
use trueray::compare::{Difference, Explanation};
use trueray::cpu::{Judge, Reference};
use trueray::effects::{EffectSet, Effects, Request};
use trueray::engine::Backend;
use trueray::film::Picture;
use trueray::pattern::{Filter, Pattern};
use trueray::precision::Tier;
use trueray::scene::{Fov, Scene, Window};
use trueray::settings::{SampleOffset, Settings};
use trueray::view::{Projection, View, ViewError};

use crate::support::{cpu_picture, gpu, gpu_picture, scaled, scene_of};

/// Ellipsoids before each other, mirrors, shadows.
const WORLD: &str = "SPHERE floor 0 -12 -9 10 10 10 0.4 0.6 0.5 0.3 0.6 0.2 0.2 20\n\
    SPHERE ball 0.5 -0.5 -5 1 1.5 0.75 0.9 0.3 0.2 0.2 0.6 0.5 0.3 50\n\
    SPHERE disc -1.5 0.25 -6 1.25 0.25 1 0.2 0.4 0.9 0.2 0.7 0.3 0.2 8\n\
    SPHERE needle 1.25 1 -4 0.125 1 0.125 0.2 0.9 0.4 0.3 0.7 0.3 0 8\n\
    LIGHT a 4 6 2 0.7 0.7 0.6\nLIGHT b -5 3 -2 0.4 0.4 0.5\nBACK 0.1 0.1 0.2\nAMBIENT 0.3 0.3 0.3";

fn world() -> Scene {
    let mut scene = scene_of(WORLD);
    (scene.width, scene.height) = (96, 72);
    (scene.window.bottom, scene.window.top) = (-0.75, 0.75);
    scene
}

fn with(view: View) -> Settings {
    Settings { view, ..Settings::exact() }
}

fn moved(scene: &Scene, by: DVec3) -> Scene {
    let mut scene = scene.clone();
    scene.spheres.iter_mut().for_each(|s| s.center += by);
    scene.lights.iter_mut().for_each(|l| l.position += by);
    scene
}

/// A quarter turn around the y axis: −z becomes +x.
fn turned(scene: &Scene) -> Scene {
    let turn = |v: DVec3| DVec3::new(-v.z, v.y, v.x);
    let mut scene = scene.clone();
    for sphere in &mut scene.spheres {
        sphere.center = turn(sphere.center);
        sphere.scale = turn(sphere.scale).abs();
    }
    scene.lights.iter_mut().for_each(|l| l.position = turn(l.position));
    scene
}

fn reference(scene: &Scene, settings: &Settings) -> Picture {
    cpu_picture::<f64>(scene, settings, &Effects::of(&scene.viewed(settings))).0
}

fn differing(a: &Picture, b: &Picture) -> u64 {
    Difference::between(a, b).unwrap().differing.over_0
}

#[test]
fn the_default_is_the_camera_of_the_file() {
    let explicit = View::new(DVec3::ZERO, Some(DVec3::new(0.0, 0.0, -7.3)), DVec3::new(0.0, 49.0, 3.0)).unwrap();
    assert_eq!(explicit, View::FILE);
    assert_eq!(View::new(DVec3::ZERO, None, DVec3::Y), Ok(View::FILE));
    // Its rays are exactly (x, y, −near).
    let scene = world();
    let camera = Camera::new(&scene.viewed(&Settings::exact()));
    for (i, j) in [(0, 0), (17, 35), (95, 71)] {
        assert_eq!(camera.column(i) + camera.row(j), DVec3::new(camera.x(i), camera.y(j), -1.0));
    }
}

#[test]
fn what_is_no_view_is_refused() {
    let view = |eye: [f64; 3], look_at: [f64; 3], up: [f64; 3]| View::new(eye.into(), Some(look_at.into()), up.into());
    assert_eq!(view([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 1.0, 0.0]), Err(ViewError::NoDirection));
    assert_eq!(view([0.0; 3], [0.0, -2.0, 0.0], [0.0, 1.0, 0.0]), Err(ViewError::UpAlongView));
    assert_eq!(view([0.0; 3], [0.0, 0.0, -1.0], [0.0; 3]), Err(ViewError::NoUp));
    assert_eq!(view([f64::NAN, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]), Err(ViewError::NotFinite));
    assert_eq!(view([1e308, 0.0, 0.0], [-1e308, 0.0, 0.0], [0.0, 1.0, 0.0]), Err(ViewError::NotFinite));
}

#[test]
fn axes_are_orthonormal() {
    let near = View::new(DVec3::ZERO, Some(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 2.0, 3.0 + 1e-7)).unwrap();
    let [x, y, z] = near.axes();
    for (a, b, product) in [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)] {
        assert!((a.dot(b) - product).abs() < 1e-15);
    }
    assert!(x.cross(y).dot(z) > 0.0);
}

#[test]
fn a_field_of_view_is_a_symmetric_window() {
    let fov = |degrees| Fov::from_degrees(degrees).unwrap();
    assert_eq!(fov(90.0).window(1.0, (40, 40)), Window::default());
    let half = Window { near: 2.0, left: -4.0, right: 4.0, bottom: -2.0, top: 2.0 };
    assert_eq!(fov(90.0).window(2.0, (64, 32)), half);
    for degrees in [1e-9, 0.5, 30.0, 60.0, 89.999, 90.001, 120.0, 179.9] {
        let top = fov(degrees).window(1.0, (3, 4)).top;
        let tangent = (degrees.to_radians() / 2.0).tan();
        assert!((top - tangent).abs() <= 1e-12 * tangent, "{degrees}: {top}");
        // The angle between the rays through both edges.
        assert!((2.0 * top.atan().to_degrees() - degrees).abs() <= 1e-12 * degrees, "{degrees}");
    }
    for degrees in [0.0, -0.0, -30.0, 180.0, 360.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Fov::from_degrees(degrees), None, "{degrees}");
    }
    // NEAR and the angle are extreme: the scene keeps its window.
    let mut scene = world();
    scene.window.near = 1e308;
    let own = scene.window;
    assert!(scene.set_fov(fov(179.0)).is_err());
    scene.window.near = 1e-200;
    assert!(scene.set_fov(fov(1e-200)).is_err());
    assert_eq!(scene.window, Window { near: 1e-200, ..own });
}

/// The option, wherever the camera is taken, gives what a scene file with that window gives.
#[test]
fn fov_shows_what_a_file_with_its_window_shows() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).display().to_string();
    let mut scene = world();
    std::fs::write(file("scene.txt"), scene.to_string()).unwrap();
    (scene.width, scene.height) = (32, 48);
    scene.window = Window { near: 1.0, left: -2.0 / 3.0, right: 2.0 / 3.0, bottom: -1.0, top: 1.0 };
    std::fs::write(file("window.txt"), scene.to_string()).unwrap();
    let run = |args: &str, scene: &str, output: &str| {
        let picture = args.starts_with("render").then(|| ["-o".into(), file(output)]);
        let words =
            args.split_whitespace().map(str::to_owned).chain([file(scene)]).chain(picture.into_iter().flatten());
        trueray(words)
    };
    let expected = run("render -q --device cpu", "window.txt", "window.png");
    assert_eq!(expected.status.code(), Some(0));
    let output = run("render --device cpu --fov 90 --res 32x48", "scene.txt", "fov.png");
    let said = String::from_utf8_lossy(&output.stderr);
    // Its pixels are square: no picture is distorted.
    assert!(output.status.success() && !said.contains("warning"), "{said}");
    assert_eq!(std::fs::read(file("fov.png")).unwrap(), std::fs::read(file("window.png")).unwrap());
    let compared = format!("compare --fov 90 --res 32x48 --device cpu {} --scene", file("window.png"));
    assert_eq!(run(&compared, "scene.txt", "").status.code(), Some(0));
    let pixel = |args: &str, scene: &str| {
        let output = trueray(format!("pixel --json --device cpu {args} {} 20 30", file(scene)).split_whitespace());
        let pixel: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        pixel["reference"].clone()
    };
    assert_eq!(pixel("--fov 90 --res 32x48", "scene.txt"), pixel("", "window.txt"));
    for (degrees, code, message) in [
        ("0", 2, "expected an angle above 0 and below 180 degrees"),
        ("-20", 2, "expected an angle"),
        ("180", 2, "expected an angle"),
        ("nan", 2, "expected an angle"),
        ("1e-323", 2, "--fov: right of the window is 0: expected another number"),
    ] {
        let output = run(&format!("render --device cpu --fov {degrees}"), "scene.txt", "none.png");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(code) && said.contains(message), "{degrees}: {said}");
    }
    let bench = trueray(["bench", "--fov", "40", "--list"]);
    assert_eq!(bench.status.code(), Some(2));
}

/// Renderers have the eye at the origin and usual units, and a copy of the scene only where one of them takes it.
#[test]
fn a_scene_is_moved_to_its_eye() {
    let (scene, at_origin) = (world(), Settings::classic());
    assert!(std::ptr::eq(scene.viewed(&at_origin).scene(), &raw const scene));
    let eye = DVec3::new(3.0, -2.0, 8.0);
    let settings = Settings { view: View::new(eye, None, DVec3::Y).unwrap(), ..at_origin };
    let viewed = scene.viewed(&settings);
    assert_eq!((viewed.scene(), viewed.settings()), (&moved(&scene, -eye), &at_origin));
    assert_eq!(viewed.in_file(), (&scene, &settings));
    assert_eq!((viewed.factor(), viewed.eye_distance()), (1.0, eye.length()));
    // The greatest coordinate is 12: in the units of kernels 1.5.
    let tiny = scaled(&scene, 2_f64.powi(-60));
    let viewed = tiny.viewed(&at_origin);
    assert_eq!((viewed.scene(), viewed.factor()), (&scaled(&scene, 0.125), 2_f64.powi(57)));
    assert_eq!(viewed.settings().secondary.reflection, at_origin.secondary.reflection * 2_f64.powi(57));
    assert_eq!(viewed.settings().secondary.shadow, at_origin.secondary.shadow);
}

#[test]
fn world_and_eye_moved_alike_show_the_same_picture() {
    let scene = world();
    let expected = reference(&scene, &Settings::exact());
    // By whole numbers, so that no coordinate is rounded.
    for eye in [DVec3::new(3.0, -2.0, 8.0), DVec3::new(1e6, 1e6, -1e6)] {
        let settings = with(View::new(eye, None, DVec3::Y).unwrap());
        assert_eq!(differing(&reference(&moved(&scene, eye), &settings), &expected), 0);
    }
}

#[test]
fn world_and_eye_turned_alike_show_the_same_picture() {
    let scene = world();
    let settings = with(View::new(DVec3::ZERO, Some(DVec3::new(5.0, 0.0, 0.0)), DVec3::Y).unwrap());
    assert_eq!(differing(&reference(&turned(&scene), &settings), &reference(&scene, &Settings::exact())), 0);
    // And with the head to the side: up along −z, that is to the right.
    let upright = with(View::new(DVec3::ZERO, None, DVec3::X).unwrap());
    let [right, up, _] = upright.view.axes();
    assert_eq!((right, up), (DVec3::NEG_Y, DVec3::X));
}

/// Views from around the world of [`world`], and from behind, where it has been moved.
fn views(offset: DVec3) -> Vec<View> {
    let target = DVec3::new(0.0, 0.0, -5.0);
    let places = [[0.3, 0.7, 2.0], [-4.1, 2.3, -1.7], [5.2, 1.1, -9.3], [0.1, 6.3, -5.2], [1.7, 0.4, -14.0]];
    let ups = [[0.0, 1.0, 0.0], [0.4, 1.0, -0.3], [1.0, 0.2, 0.1], [0.0, 0.0, -1.0], [-0.2, -1.0, 0.0]];
    let view = |(&eye, up): (&[f64; 3], [f64; 3])| {
        View::new(DVec3::from(eye) + offset, Some(target + offset), up.into()).unwrap()
    };
    places.iter().zip(ups).map(view).collect()
}

#[test]
fn every_tier_shows_what_the_reference_does_from_anywhere() {
    let Some(gpu) = gpu("every_tier_shows_what_the_reference_does_from_anywhere") else { return };
    let far = DVec3::new(1e6, -1e6, 1e6);
    for offset in [DVec3::ZERO, far] {
        for view in views(offset) {
            let scene = moved(&world(), offset);
            let settings = with(view);
            let auto = Effects::of(&scene.viewed(&settings));
            let all = Effects::requested(&scene.viewed(&settings), &Request::Exactly(EffectSet::ALL));
            let exact = Reference::<f64>::new(&scene.viewed(&settings), &auto);
            let expected = reference(&scene, &settings);
            assert!(differing(&expected, &reference(&world(), &Settings::exact())) > 100, "another picture");
            for tier in Tier::ALL {
                for effects in [&auto, &all] {
                    let (picture, not_finite) = gpu_picture(&gpu, tier, &scene, &settings, effects);
                    assert_eq!(not_finite, 0);
                    let judge = Backend::Device(&gpu, tier).judge();
                    let explanation = Explanation::of(&picture, &expected, &exact, &judge);
                    assert_eq!(explanation.unexplained, 0, "{tier} {view:?} {offset}");
                }
            }
        }
    }
}

/// The judge must not explain everything: a view that differs by half a pixel is not explained.
#[test]
fn a_slightly_other_view_is_not_explained() {
    let (settings, other) = (with(views(DVec3::ZERO)[1]), with(views(DVec3::new(0.02, 0.0, 0.0))[1]));
    let scene = world();
    let exact = Reference::<f64>::new(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings)));
    let (expected, shown) = (reference(&scene, &settings), reference(&scene, &other));
    assert!(Explanation::of(&shown, &expected, &exact, &Judge::of(Tier::Fast)).unexplained > 0);
}

/// Semi-axes from needles to discs.
fn semi_axis() -> impl Strategy<Value = f64> {
    prop_oneof![0.2..3.0, 0.01..0.2, 3.0..30.0]
}

/// Before, on and beyond the image plane, and behind the eye.
fn center() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        [-6.0..6.0, -6.0..6.0, -12.0..3.0],
        [-1.0..1.0, -1.0..1.0, -2.5..0.5],
        [-60.0..60.0, -60.0..60.0, -90.0..-20.0],
    ]
}

fn direction() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        [-1.0..1.0, -1.0..1.0, -1.0..1.0],
        // Along an axis but for little.
        [-1e-4..1e-4, -1.0..1.0, -1e-9..1e-9],
        Just([0.0, 0.0, -1.0]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Against rays that are tested with all spheres, in the axes of the world: nothing of the lists takes part.
    #[test]
    fn lists_have_every_sphere_that_a_pixel_sees(
        spheres in prop::collection::vec((center(), [semi_axis(), semi_axis(), semi_axis()]), 1..5),
        (ahead, up) in (direction(), direction()),
        window in [-2.0..2.0, -2.0..2.0],
        size in [0.1..3.0, 0.1..3.0],
        flip in any::<[bool; 2]>(),
        (width, height) in (1_u32..200, 1_u32..150),
        sampling in prop::sample::select(vec![SampleOffset::Corner, SampleOffset::BottomLeft, SampleOffset::Center]),
        pattern in prop::sample::select(vec![
            Pattern::ONE,
            Pattern::Grid { side: 2 },
            Pattern::Grid { side: 3 },
            Pattern::Fibonacci { count: 3, filter: Filter::Box },
            Pattern::Fibonacci { count: 2, filter: Filter::Tent },
            Pattern::Fibonacci { count: 4, filter: Filter::Gaussian },
        ]),
        longest_tile in prop::sample::select(vec![0.0, 1.0, 1e9]),
        near in prop::sample::select(vec![1e-3, 0.1, 1.0, 2.0]),
        projection in prop::sample::select(vec![Projection::Perspective, Projection::Orthographic]),
    ) {
        let Ok(view) = View::new(DVec3::ZERO, Some(ahead.into()), up.into()) else { return Ok(()) };
        let view = view.projected(projection);
        // The places above are those in the picture's axes, so that the spheres are mostly in view.
        let [right, upwards, back] = view.axes();
        let line = |(p, s): &([f64; 3], [f64; 3])| {
            let DVec3 { x, y, z } = right * p[0] + upwards * p[1] + back * p[2];
            format!("SPHERE s {x} {y} {z} {} {} {} 1 1 1 1 0 0 0 1\n", s[0], s[1], s[2])
        };
        let mut scene = scene_of(&(spheres.iter().map(line).collect::<String>() + "AMBIENT 1 1 1"));
        (scene.width, scene.height) = (width, height);
        scene.window.near = near;
        let ends = |low: f64, size: f64, flip| if flip { (low + size, low) } else { (low, low + size) };
        (scene.window.left, scene.window.right) = ends(window[0], size[0], flip[0]);
        (scene.window.bottom, scene.window.top) = ends(window[1], size[1], flip[1]);
        let settings = Settings { sampling, pattern, view, ..Settings::classic() };
        let density = Density { longest_tile, ..Density::DEFAULT };
        let viewed = scene.viewed(&settings);
        let (camera, side) = (Camera::new(&viewed), pattern.side());

        for rounding in [Rounding::SINGLE, Rounding::COMPENSATED, Rounding::DOUBLE] {
            let lists = Acceleration::with_density(&viewed, EffectSet::ALL, rounding, &density).screen;
            for j in 0..height * side {
                for i in 0..width * side {
                    let sum = camera.column(i) + camera.row(j);
                    let (start, ray) = if camera.is_parallel() { (sum, camera.direction()) } else { (DVec3::ZERO, sum) };
                    for (index, sphere) in scene.spheres.iter().enumerate() {
                        if sees(start, ray, sphere) {
                            let listed = lists.at(i / side, j / side);
                            prop_assert!(listed.contains(&(index as u32)), "sample {i} {j} sphere {index}");
                        }
                    }
                }
            }
            // What devices render beyond the picture has lists, too.
            for [x, y] in lists.cover().covered(0, height) {
                prop_assert!((x + 7) >> lists.shift < lists.across);
                prop_assert!(lists.tile(x + 7, y + 7) < lists.lists.cells());
            }
            // Tiles that are covered are those with lists, in pieces as well.
            let pieces: Vec<_> = (0..height).step_by(16).flat_map(|y| lists.cover().covered(y, 16)).collect();
            prop_assert_eq!(pieces, lists.cover().covered(0, height));
        }
    }
}

/// Whether a ray from this place meets the sphere at t ≥ 1.
fn sees(start: DVec3, ray: DVec3, sphere: &trueray::scene::Sphere) -> bool {
    let (s, d) = ((sphere.center - start) / sphere.scale, ray / sphere.scale);
    let (a, b, c) = (d.length_squared(), s.dot(d), s.length_squared() - 1.0);
    let discriminant = b * b - a * c;
    discriminant >= 0.0 && b + discriminant.sqrt() >= a
}

/// The corners of a large disc's rectangle are left out, also where the camera is turned.
#[test]
fn tiles_follow_the_outline() {
    let mut scene = scene_of("SPHERE s 0.5 0.2 -9 3 5 2 1 1 1 1 0 0 0 1");
    (scene.width, scene.height) = (800, 800);
    let count = |scene: &Scene, view| {
        let settings = Settings { view, ..Settings::classic() };
        Acceleration::new(&scene.viewed(&settings), EffectSet::ALL, Rounding::SINGLE)
            .screen
            .cover()
            .covered(0, 800)
            .len() as f64
    };
    let outlined = count(&scene, View::FILE);
    // The ellipse covers π/4 of its rectangle, of about 267 × 444 pixels.
    let rectangle = 2.0 * 3.0 / 9.0 / 2.0 * 100.0 * (2.0 * 5.0 / 9.0 / 2.0 * 100.0);
    assert!(outlined < 0.95 * rectangle && outlined > 0.75 * rectangle, "{outlined} {rectangle}");
    // The same disc seen by an eye turned with it.
    let beside = View::new(DVec3::ZERO, Some(DVec3::X), DVec3::Y).unwrap();
    assert!((count(&turned(&scene), beside) - outlined).abs() <= 2.0);
    // Rolled by 45 degrees it covers about as many tiles, though its rectangle is larger.
    let rolled = count(&scene, View::new(DVec3::ZERO, None, DVec3::new(1.0, 1.0, 0.0)).unwrap());
    assert!((rolled / outlined - 1.0).abs() < 0.06, "{rolled} {outlined}");
}

fn trueray<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_trueray")).args(args).output().unwrap()
}

#[test]
fn the_command_line_moves_the_camera() {
    let file = crate::support::root().join("scenes/basic/one-sphere.txt");
    let folder = std::env::temp_dir().join(format!("trueray-camera-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let render = |name: &str, options: &[&str]| {
        let output = folder.join(name);
        let mut args = vec!["render".as_ref(), file.as_os_str(), "-o".as_ref(), output.as_os_str()];
        args.extend(["--device", "cpu", "--res", "40x30"].iter().chain(options).map(OsStr::new));
        let run = trueray(args);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        std::fs::read(output).unwrap()
    };
    let plain = render("plain.ppm", &[]);
    assert!(render("same.ppm", &["--eye", "0,0,0", "--look-at", "0,0,-3", "--up", "0,2,0"]) == plain);
    assert!(render("other.ppm", &["--eye", "-0.5,0.25,0.5", "--look-at", "-0.5,0,-9"]) != plain);
    std::fs::remove_dir_all(&folder).unwrap();

    let refused = |options: &[&str], what: &str| {
        let mut args = vec!["check".as_ref(), file.as_os_str()];
        args.extend(options.iter().map(OsStr::new));
        let run = trueray(args);
        let message = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{message}");
        assert!(message.contains(what), "{message}");
    };
    refused(&["--eye", "1,2,3", "--look-at", "1,2,3"], "the same point");
    refused(&["--up", "0,0,4"], "parallel");
    refused(&["--eye", "1,nan,3"], "finite");
    refused(&["--eye", "1,2"], "X,Y,Z");
}

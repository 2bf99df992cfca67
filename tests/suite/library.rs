//! The front door: what a Rust program gets, and what it is told where it asks for something that cannot be.

use std::path::{Path, PathBuf};
use std::process::Command;

use trueray::errors::Invalid;
use trueray::scene::MAX_RESOLUTION;
use trueray::settings::Secondary;
use trueray::{DVec3, Difference, Error, Light, Picture, Renderer, Scene, Settings, Sphere, Tier, Verify, Window};

use crate::support::{gpu, root, say_skipped};

fn scene() -> Scene {
    let spheres =
        vec![Sphere::new([0.0, 0.0, -4.0], 1.5, [0.9, 0.3, 0.1]), Sphere::new([1.0, 1.0, -6.0], 2.0, [0.1, 0.3, 0.9])];
    let lights = vec![Light { position: DVec3::new(3.0, 5.0, 0.0), intensity: DVec3::splat(0.9) }];
    Scene { spheres, lights, ambient: DVec3::splat(0.2), ..Scene::new(Window::default(), 48, 40) }
}

#[test]
fn every_device_shows_what_the_reference_explains() {
    if gpu("every_device_shows_what_the_reference_explains").is_none() {
        return;
    }
    let (scene, settings) = (scene(), Settings::default());
    let expected = Renderer::reference().render(&scene, &settings).unwrap();
    for index in 0..Renderer::devices().unwrap().len() {
        let renderer = Renderer::on(&index.to_string()).unwrap();
        assert!(renderer.device().is_some());
        let picture = renderer.render(&scene, &settings).unwrap();
        let explanation = renderer.explain(&picture, &scene, &settings).unwrap();
        assert_eq!(explanation.unexplained, 0);
        let difference = Difference::between(&picture, &expected).unwrap();
        assert_eq!(difference.differing.over_0, explanation.differing);
    }
    let renderer = Renderer::new().unwrap();
    let double = renderer.clone().with_precision(Tier::Double).with_verification(Verify::All);
    let certified = renderer.with_certification();
    std::thread::scope(|scope| {
        for clone in [double, certified] {
            let (scene, settings, expected) = (&scene, &settings, &expected);
            scope.spawn(move || assert!(clone.render(scene, settings).unwrap() == *expected));
        }
    });
}

#[test]
fn the_reference_explains_no_other_picture() {
    let (scene, settings) = (scene(), Settings::default());
    let reference = Renderer::reference();
    let mut moved = scene.clone();
    moved.spheres[0].center.x += 0.1;
    let picture = reference.render(&moved, &settings).unwrap();
    assert!(reference.explain(&picture, &scene, &settings).unwrap().unexplained > 20);
    let small = Picture::new(1, 1, vec![0; 3]).unwrap();
    assert!(matches!(reference.explain(&small, &scene, &settings), Err(Error::Size(_))));
}

#[test]
fn numbers_that_no_file_may_have_are_refused() {
    type Change = fn(&mut Scene);
    let changes: [(Change, &str); 12] = [
        (|scene| scene.spheres[1].scale.y = 0.0, "sy of sphere 1 is 0: expected a number other than 0"),
        (|scene| scene.spheres[0].center.z = f64::NAN, "pz of sphere 0 is NaN: expected a finite number"),
        (|scene| scene.spheres[0].n = -1.0, "n of sphere 0 is -1: expected 0 or a number greater than 0"),
        (|scene| scene.spheres[0].eta = 0.0, "eta of sphere 0 is 0: expected a number greater than 0"),
        (|scene| scene.lights[0].intensity.y = f64::INFINITY, "Ig of light 0 is inf: expected a finite number"),
        (|scene| scene.lights[0].position.x = f64::NAN, "px of light 0 is NaN: expected a finite number"),
        (|scene| scene.window.near = -1.0, "n of NEAR is -1: expected a number greater than 0"),
        (|scene| scene.window.right = scene.window.left, "right of the window is -1: expected another number"),
        (|scene| scene.background.x = f64::NAN, "r of BACK is NaN"),
        (|scene| scene.ambient.z = f64::NAN, "Ib of AMBIENT is NaN"),
        (|scene| scene.width = 0, "width of the picture is 0: expected 1 to 16777216 pixels"),
        (|scene| scene.height = MAX_RESOLUTION + 1, "height of the picture is 16777217"),
    ];
    for (change, message) in changes {
        let mut scene = scene();
        change(&mut scene);
        let error = Renderer::reference().render(&scene, &Settings::default()).unwrap_err();
        assert!(matches!(error, Error::Invalid(Invalid { .. })), "{error}");
        assert!(error.to_string().starts_with(message), "{error}");
    }
    let mut far = scene();
    far.spheres[0].center.x = 1e300;
    far.spheres[1].scale.x = 1e-300;
    let error = Renderer::reference().render(&far, &Settings::default()).unwrap_err();
    assert!(matches!(error, Error::Unrenderable(_)));
    assert!(error.to_string().ends_with("least semi-axis of sphere 0"), "no label: {error}");
    let vast = Scene::new(Window::default(), MAX_RESOLUTION, MAX_RESOLUTION);
    assert!(matches!(Renderer::reference().render(&vast, &Settings::default()), Err(Error::Unrenderable(_))));
    for (shadow, reflection) in [(-1.0, 0.0), (1.0, 0.0), (f64::NAN, 0.0), (0.0, -1.0), (0.0, f64::NAN)] {
        let settings = Settings { secondary: Secondary { shadow, reflection }, ..Settings::default() };
        let error = Renderer::reference().render(&scene(), &settings).unwrap_err().to_string();
        assert!(error.starts_with("rays cannot begin at "), "{error}");
    }
    let depth = Settings { max_depth: u32::MAX, ..Settings::default() };
    assert!(matches!(Renderer::reference().render(&scene(), &depth), Err(Error::Device(_))));
}

#[test]
fn files_are_read_and_written_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Renderer::reference().render(&scene(), &Settings::default()).unwrap();
    for name in ["a.png", "a.ppm"] {
        let path = folder.path().join(name);
        picture.write(&path).unwrap();
        assert!(Picture::read(&path).unwrap() == picture);
    }
    let error = picture.write(folder.path().join("a.jpg")).unwrap_err().to_string();
    assert!(error.contains("a.jpg") && error.contains("has to end in .ppm or .png"), "{error}");
    assert!(!folder.path().join("a.jpg").exists());
    let error = Scene::read(folder.path().join("none.txt")).unwrap_err().to_string();
    assert!(error.starts_with("cannot read the scene ") && error.contains("none.txt"), "{error}");
    let error = Scene::from_text("mine", b"NEAR 1\nSPHEER").unwrap_err().to_string();
    assert!(error.contains("mine:2:1") && error.contains("did you mean `SPHERE`"), "{error}");
}

/// An example, where they have been compiled beside this test.
fn example(test: &str, name: &str) -> Option<Command> {
    let mut path = PathBuf::from(env!("CARGO_BIN_EXE_trueray"));
    path.set_file_name("examples");
    path.push(name);
    if !path.exists() {
        say_skipped(test, "the examples are not compiled: `cargo test` does it");
        return None;
    }
    Some(Command::new(path))
}

#[test]
fn examples_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = root().join("scenes/basic/ellipsoid.txt");
    let run = |name: &str, arguments: &[&Path], files: &[&str]| {
        let Some(mut command) = example("examples_run", name) else { return };
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        for file in files {
            assert!(Picture::read(folder.path().join(file)).unwrap().pixels().iter().any(|pixel| *pixel != [0; 3]));
        }
    };
    run("render", &[&scene, Path::new("one.png")], &["one.png"]);
    run("own_spheres", &[], &["own_spheres.png"]);
    run("frame_loop", &[&scene], &["frame_0.png", "frame_7.png"]);
    run("compare_devices", &[&scene], &[]);
}

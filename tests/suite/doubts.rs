//! Doubts about scenes without errors: what can hardly be meant is said, and nothing else.

use glam::DVec3;
use trueray::doubts::doubts;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::view::View;

use crate::support::{scaled, scene, scene_files, scene_of};

const LIT: &str = "LIGHT l 0 5 0 1 1 1\n";

fn of(scene: &Scene) -> Vec<String> {
    doubts(scene, &Settings::classic(), None)
}

/// The only doubt about a scene, in any units.
#[track_caller]
fn only(statements: &str) -> String {
    let scene = scene_of(statements);
    for factor in [1e-9, 1.0, 1e9] {
        let found = of(&scaled(&scene, factor));
        assert_eq!((found.len(), &found), (1, &of(&scene)));
    }
    of(&scene).remove(0)
}

#[test]
fn a_picture_in_which_nothing_is_seen() {
    for (spheres, why) in [
        ("", "no SPHERE"),
        ("SPHERE s 0 0 5 1 1 1 1 1 1 1 1 1 0 1\nSPHERE t 0 0 9 8 8 9 1 1 1 1 1 1 0 1\n", "behind the eye"),
        ("SPHERE s 0 0 0 0.9 0.9 0.9 1 1 1 1 1 1 0 1\n", "before the image plane"),
        ("SPHERE s 0 0 0 9 9 0.9 1 1 1 1 1 1 0 1\n", "before the image plane"),
        ("SPHERE s 20 0 -5 1 1 1 1 1 1 1 1 1 0 1\n", "beside the window"),
        ("SPHERE s 0 -6.5 -5 9 1 1 1 1 1 1 1 1 0 1\n", "beside the window"),
    ] {
        let found = only(&format!("{LIT}{spheres}"));
        assert!(found.starts_with("nothing can be seen: ") && found.contains(why), "{found}");
    }
    for sphere in [
        "0 0 0 2 2 2",
        "0 0 -5 1 1 1",
        "5 0 -5 1 1 1",
        "0 -6.3 -5 9 1 1",
        "0 0 1e300 1 1 1e301",
        "-1e308 0 -1e308 1 1 1",
    ] {
        let scene = scene_of(&format!("{LIT}SPHERE s {sphere} 1 1 1 1 1 1 0 1\n"));
        assert!(of(&scene).is_empty(), "{sphere}: {:?}", of(&scene));
    }
}

#[test]
fn the_eye_may_turn_to_what_is_behind() {
    let scene = scene_of(&format!("{LIT}SPHERE s 0 0 5 1 1 1 1 1 1 1 1 1 0 1\n"));
    let looking = |target: DVec3| Settings {
        view: View::new(DVec3::ZERO, Some(target), DVec3::Y).unwrap(),
        ..Settings::classic()
    };
    assert!(doubts(&scene, &looking(DVec3::Z), None).is_empty());
    assert_eq!(doubts(&scene, &looking(DVec3::X), None).len(), 1);
}

#[test]
fn spheres_that_ask_for_light() {
    let sphere = |kd: &str, ks: &str| format!("SPHERE s 0 0 -5 1 1 1 1 1 1 1 {kd} {ks} 0 1\n");
    assert!(only(&sphere("1", "0")).starts_with("there is no LIGHT"));
    assert!(only(&sphere("0", "1")).starts_with("there is no LIGHT"));
    assert!(only(&format!("{}LIGHT l 0 5 0 0 0 0\n", sphere("1", "0"))).starts_with("every LIGHT has intensity 0"));
    assert!(of(&scene_of(&sphere("0", "0"))).is_empty());
    assert!(of(&scene_of(&format!("{LIT}{}", sphere("1", "1")))).is_empty());
}

#[test]
fn sizes_that_distort() {
    let mut square = scene_of(&format!("{LIT}SPHERE s 0 0 -5 1 1 1 1 1 1 1 1 1 0 1\n"));
    let sized = |scene: &Scene, size| doubts(scene, &Settings::classic(), Some(size));
    assert_eq!(
        sized(&square, (1920, 1080)),
        ["--res 1920x1080 distorts the picture: the scene's is 40 × 40; 1920x1920 keeps its shape"]
    );
    for size in [(8, 8), (1, 1), (1000, 1000), (40, 40)] {
        assert!(sized(&square, size).is_empty());
    }
    // A window that is wider than the file's picture: its own shape, and square pixels.
    square.window.left *= 2.0;
    square.window.right *= 2.0;
    for size in [(300, 300), (300, 150), (33, 17)] {
        assert!(sized(&square, size).is_empty(), "{size:?}");
    }
    assert_eq!(sized(&square, (300, 200)).len(), 1);
}

/// No false alarm: these four are what they are said to be.
#[test]
fn the_scenes_of_the_project_are_above_doubt() {
    let odd = ["behind-the-eye", "lights-off-dark", "no-lights", "no-spheres"];
    let mut doubted: Vec<_> = scene_files(&["basic", "effects", "hard", "refraction", "show"])
        .into_iter()
        .filter(|file| !of(&scene(file)).is_empty())
        .map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    doubted.sort();
    assert_eq!(doubted, odd);
}

//! Many views in one process: each frame is the picture of a run of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::thread::sleep;
use std::time::{Duration, Instant};

use glam::DVec3;
use serde_json::Value;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, render_picture};
use trueray::film::Picture;
use trueray::gpu::Gpu;
use trueray::kept::Kept;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::tuning::Tuning;
use trueray::verify::Verify;
use trueray::view::{Projection, View};
use trueray::views::{Frame, NoCenter, Placement, table, turntable};
use trueray::{Fov, Renderer, Window};

use crate::support::{Folder, gpu, root, scene, scene_of};

/// Three spheres, one of them a mirror and one an ellipsoid, and a light that casts shadows.
const SCENE: &str = "SPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\nSPHERE b 2 1 -5 0.5 1 0.5 0.1 0.8 0.3 0.3 0.6 0.2 0 10\n\
                     SPHERE c -2 -1 -4 0.6 0.6 0.6 0.2 0.3 0.9 0.3 0.6 0.2 0 10\nLIGHT l 5 6 0 0.9 0.9 0.8\n\
                     AMBIENT 0.3 0.3 0.3\nBACK 0.1 0.1 0.2\n";
const HEAD: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\n";
/// Where the file's camera is.
const START: Placement =
    Placement { eye: DVec3::ZERO, look_at: None, up: DVec3::Y, fov: None, projection: Projection::Perspective };

/// With the scene in `scene.txt`.
fn folder() -> Folder {
    Folder::with_scene(&format!("{HEAD}RES 24 16\n{SCENE}OUTPUT own.png\n"))
}

fn picture(place: &Folder, name: &str) -> Picture {
    Picture::read(place.path(name)).unwrap()
}

/// Renders on the CPU, and compares code and message.
#[track_caller]
fn render(place: &Folder, arguments: &str, code: i32, message: &str) -> Output {
    place.exits(&format!("render --device cpu {arguments}"), code, message)
}

fn view(eye: [f64; 3], look_at: Option<[f64; 3]>) -> View {
    View::new(eye.into(), look_at.map(DVec3::from), DVec3::Y).unwrap()
}

// --- pictures -----------------------------------------------------------------------------------------------------------

/// Scenes with all effects between them, from eyes that share lists and from one that is too far away for that.
#[test]
fn frames_are_the_pictures_of_single_runs_at_every_tier() {
    let Some(gpu) = gpu("frames_are_the_pictures_of_single_runs_at_every_tier") else { return };
    let views = [
        View::FILE,
        view([0.4, 0.3, 0.5], Some([0.0, 0.0, -10.0])),
        view([-3.0, 1.0, -2.0], Some([0.0, 0.0, -9.0])),
        view([0.0, 900.0, 0.0], Some([0.0, 0.0, -10.0])),
    ];
    let device = |tier| Backend::Device(&gpu, tier);
    let certified = Backend::Certified(&gpu, Tier::Fast);
    let backends = [device(Tier::Fast), device(Tier::Robust), device(Tier::Double), certified, Backend::Reference];
    for name in ["effects/refraction.txt", "show/showcase.txt"] {
        let mut scene = scene(&root().join("scenes").join(name));
        (scene.width, scene.height) = (56, 40);
        for backend in backends {
            let kept = Kept::default();
            for (number, view) in views.into_iter().enumerate() {
                let settings = Settings { view, ..Settings::default() };
                let picture = |viewed| {
                    let effects = Effects::of(&viewed);
                    let some = Verify::Some(std::num::NonZero::<u32>::MIN);
                    let mut engine = Engine::verified(backend, viewed, &effects, &Options::default(), some).unwrap();
                    render_picture(&mut engine).unwrap().0
                };
                let single = picture(scene.viewed(&settings));
                assert!(picture(scene.viewed_again(&settings, &kept)) == single, "{name}, {backend:?}, view {number}");
            }
        }
    }
}

/// What one frame leaves to the next is what that needs, whatever is another's between them: size, window, light, levels, effects, the tier.
#[test]
fn what_frames_share_is_made_anew_where_it_differs() {
    let Some(mut gpu) = gpu("what_frames_share_is_made_anew_where_it_differs") else { return };
    let own = gpu.tuned().tuning;
    for texture_tables in [true, false] {
        gpu.set_tuning(Tuning { texture_tables, ..own }).unwrap();
        let kept = Kept::default();
        (0..24).for_each(|number| assert_frame_is_that_of_a_single_run(&gpu, number, &kept));
    }
    gpu.set_tuning(own).unwrap();
}

/// Of frames that differ in all that frames can, some in this and some in that.
fn assert_frame_is_that_of_a_single_run(gpu: &Gpu, number: u32, kept: &Kept) {
    let mut scene = scene(&root().join("scenes/show/showcase.txt"));
    (scene.width, scene.height) = [(40, 24), (64, 48), (24, 56)][number as usize / 2 % 3];
    scene.window.right += f64::from(number % 3);
    scene.ambient *= f64::from(1 + number / 6 % 2);
    scene.lights[0].intensity *= f64::from(1 + number / 5 % 2);
    let x = 0.25 * f64::from(number);
    let settings = if (number / 4).is_multiple_of(2) { Settings::classic() } else { Settings::exact() };
    let settings = Settings { view: view([x, 0.2, x], Some([0.0, 0.0, -10.0])), ..settings };
    let request = if number % 7 == 6 { "-ambient,-shadows" } else { "auto" }.parse().unwrap();
    let device = |tier| Backend::Device(gpu, tier);
    let certified = Backend::Certified(gpu, Tier::Fast);
    let backend = [device(Tier::Fast), certified, device(Tier::Robust), device(Tier::Double)][number as usize / 3 % 4];
    let picture = |viewed| {
        let effects = Effects::requested(&viewed, &request);
        let mut engine = Engine::new(backend, viewed, &effects).unwrap();
        render_picture(&mut engine).unwrap().0
    };
    let single = picture(scene.viewed(&settings));
    assert!(picture(scene.viewed_again(&settings, kept)) == single, "frame {number}, {backend:?}");
}

/// Eyes so far apart that kernels have other units for them: nothing that has a length goes from one to the other.
#[test]
fn frames_in_other_units_share_no_length() {
    let Some(gpu) = gpu("frames_in_other_units_share_no_length") else { return };
    let mut scene = scene_of(SCENE);
    (scene.width, scene.height) = (40, 32);
    for sphere in &mut scene.spheres {
        (sphere.center, sphere.scale) = (sphere.center * 1.4e8, sphere.scale * 1.4e8);
    }
    scene.lights[0].position *= 1.4e8;
    let device = |tier| Backend::Device(&gpu, tier);
    for backend in [device(Tier::Fast), device(Tier::Double), Backend::Reference] {
        let (kept, mut factors) = (Kept::default(), Vec::new());
        for z in [1e6, 3e8, 2e6, 3.1e8, 3e8] {
            let settings = Settings { view: view([0.0, 0.0, z], None), ..Settings::default() };
            let picture = |viewed| {
                let effects = Effects::of(&viewed);
                render_picture(&mut Engine::new(backend, viewed, &effects).unwrap()).unwrap().0
            };
            let single = picture(scene.viewed(&settings));
            factors.push(scene.viewed(&settings).factor());
            assert!(picture(scene.viewed_again(&settings, &kept)) == single, "{backend:?}, z {z}");
            assert!(single.chunks(3).any(|pixel| pixel != &single[..3]), "z {z}: nothing is seen");
        }
        assert!(factors[0] == factors[2] && factors[0] != factors[1], "{factors:?}");
    }
}

/// Each frame is prepared while the one before it is still to be rendered, as in a film; some eyes come back.
#[test]
fn frames_at_once_have_tables_of_their_own() {
    let Some(gpu) = gpu("frames_at_once_have_tables_of_their_own") else { return };
    let mut scene = scene(&root().join("scenes/show/showcase.txt"));
    (scene.width, scene.height) = (48, 32);
    let kept = Kept::default();
    let settings =
        |x: u32| Settings { view: view([f64::from(x), 0.0, 0.0], Some([0.0, 0.0, -9.0])), ..Settings::default() };
    let engine = |viewed| {
        let effects = Effects::of(&viewed);
        Engine::new(Backend::Device(&gpu, Tier::Fast), viewed, &effects).unwrap()
    };
    let mut before: Option<(Engine, u32)> = None;
    for x in [0, 1, 2, 0, 3, 3, 4] {
        let next = engine(scene.viewed_again(&settings(x), &kept));
        if let Some((mut frame, x)) = before.replace((next, x)) {
            let expected = render_picture(&mut engine(scene.viewed(&settings(x)))).unwrap().0;
            assert!(render_picture(&mut frame).unwrap().0 == expected, "eye {x}");
        }
    }
}

/// All that a row can say: the eye, the size, the window, another scene.
#[test]
fn rows_are_what_options_and_scene_files_say() {
    let place = folder();
    fs::create_dir(place.path("folder")).unwrap();
    place.write("folder/other.txt", format!("{HEAD}RES 10 12\nSPHERE s 0 0 -4 1 1 1 1 1 0 1 0 0 0 1\nAMBIENT 1 1 1\n"));
    place.write(
        "folder/views.csv",
        "eye_x,eye_y,eye_z,at_x,at_y,at_z,up_x,up_y,up_z,width,height,near,left,right,bottom,top,fov,scene\n\
         ,,,,,,,,,,,,,,,,,\n\
         0.5,0.2,1,0,0,-6,1,1,0,,,,,,,,,\n\
         ,,,,,,,,,12,,0.5,,2,,,,\n\
         1,,,,,,,,,,,,,,,,,other.txt\n\
         -0.5,,,,,,,,,,,,,,,,,\n\
         ,,,,,,,,,12,,0.5,,,,,60,\n",
    );
    render(&place, "-q --views folder/views.csv scene.txt -o f%d.png", 0, "");
    let own = Scene::from_text("own", &fs::read(place.path("scene.txt")).unwrap()).unwrap();
    let other = Scene::from_text("other", &fs::read(place.path("folder/other.txt")).unwrap()).unwrap();
    let mut sized = Scene { width: 12, ..own.clone() };
    sized.window = Window { near: 0.5, right: 2.0, ..own.window };
    let seen = Scene { window: Fov::from_degrees(60.0).unwrap().window(0.5, (12, 16)), ..sized.clone() };
    let turned = View::new(DVec3::new(0.5, 0.2, 1.0), Some(DVec3::new(0.0, 0.0, -6.0)), DVec3::new(1.0, 1.0, 0.0));
    for (number, scene, view) in [
        (1, &own, View::FILE),
        (2, &own, turned.unwrap()),
        (3, &sized, View::FILE),
        (4, &other, view([1.0, 0.0, 0.0], None)),
        (5, &own, view([-0.5, 0.0, 0.0], None)),
        (6, &seen, View::FILE),
    ] {
        let expected = Renderer::reference().render(scene, &Settings { view, ..Settings::default() }).unwrap();
        assert!(picture(&place, &format!("f{number}.png")) == expected, "frame {number}");
    }
    // What a row leaves empty is as in the options.
    place.write("two.csv", "eye_x,eye_y,fov\n,,20\n2,,\n");
    render(&place, "-q --views two.csv scene.txt --eye 1,1,1 --look-at 0,0,-6 --res 6x6 --fov 50 -o g%d.ppm", 0, "");
    let settings = Settings { view: view([2.0, 1.0, 1.0], Some([0.0, 0.0, -6.0])), ..Settings::default() };
    let small = Scene { width: 6, height: 6, window: Fov::from_degrees(50.0).unwrap().window(1.0, (6, 6)), ..own };
    assert!(picture(&place, "g2.ppm") == Renderer::reference().render(&small, &settings).unwrap());
}

#[test]
fn the_library_renders_many_views() {
    let scene = scene_of(SCENE);
    let renderer = Renderer::reference();
    let views = renderer.views(&scene, &Settings::exact()).unwrap();
    for x in [0.0, 0.5, 40.0] {
        let view = view([x, 0.0, 0.0], Some([0.0, 0.0, -5.0]));
        let single = renderer.render(&scene, &Settings { view, ..Settings::exact() }).unwrap();
        assert!(views.render(&view).unwrap() == single, "x {x}");
    }
    let mut wrong = scene.clone();
    wrong.spheres[0].scale.x = 0.0;
    assert!(renderer.views(&wrong, &Settings::default()).is_err());
}

// --- which frames ---------------------------------------------------------------------------------------------------------

#[test]
fn a_turntable_goes_around_once() {
    let scene = scene_of("SPHERE a 1 0 -5 2 1 1 1 1 1 1 0 0 0 1\nSPHERE b -1 1 -7 1 1 1 1 1 1 1 0 0 0 1\n");
    // The box from (-2, -1, -8) to (3, 2, -4).
    let center = DVec3::new(0.5, 0.5, -6.0);
    let all = turntable(4, &scene, &START).unwrap();
    assert_eq!(all[0], START);
    let view = |placement: &Placement| placement.view().unwrap();
    let [_, _, back] = view(&all[0]).axes();
    for (quarter, placement) in all.iter().enumerate() {
        let turned = |v: DVec3| (0..quarter).fold(v, |v, _| DVec3::new(v.z, v.y, -v.x));
        let [right, up, behind] = view(placement).axes();
        assert!((placement.eye - center - turned(-center)).length() < 1e-12, "{placement:?}");
        assert!((behind - turned(back)).length() < 1e-12 && up == DVec3::Y && right.y == 0.0, "{placement:?}");
    }
    let (eye, look_at) = (DVec3::new(0.0, 2.0, 0.0), Some(DVec3::new(0.0, 0.0, -6.0)));
    let start = Placement { eye, look_at, up: DVec3::Z, fov: None, projection: Projection::Perspective };
    let all = turntable(7, &scene, &start).unwrap();
    assert!(
        all.len() == 7
            && all.iter().all(|placement| placement.look_at.unwrap().distance(DVec3::new(0.0, 0.0, -6.0)) < 1e-12)
    );
    assert!(all.iter().all(|placement| (placement.eye.z - start.eye.z).abs() < 1e-12), "around the axis along up");
    assert_eq!(turntable(3, &scene_of(""), &START), Err(NoCenter));
    assert_eq!(turntable(3, &scene_of(""), &start).unwrap().len(), 3);
}

#[test]
fn frames_are_chosen_and_keep_their_numbers() {
    let place = folder();
    render(&place, "-q --turntable 12 --frames 10-11,2 scene.txt -o f%03d.png --stats-json stats.json", 0, "");
    assert_eq!(place.files(), ["f002.png", "f010.png", "f011.png", "scene.txt", "stats.json"]);
    let stats: Value = serde_json::from_slice(&fs::read(place.path("stats.json")).unwrap()).unwrap();
    let pictures = stats["pictures"].as_array().unwrap();
    let frames: Vec<_> = pictures.iter().map(|picture| picture["frame"].as_u64().unwrap()).collect();
    assert_eq!(frames, [2, 10, 11]);
    assert!(pictures[1]["output"] == "f010.png" && pictures[1]["rays"]["primary"] == 24 * 16, "{stats}");
    // A folder, or nothing: the name that OUTPUT gives, with a number.
    render(&place, "--turntable 2 --stats --progress json scene.txt", 0, "2 frames, 24 × 16 on");
    assert!(picture(&place, "own_0002.png") != picture(&place, "own_0001.png"));
    let said = render(&place, "--turntable 2 --progress json scene.txt", 0, "").stderr;
    let said = String::from_utf8(said).unwrap();
    let last: Value = serde_json::from_str(said.lines().find(|line| line.starts_with('{')).unwrap()).unwrap();
    assert!(last["frames"] == 2 && last["frames_done"] == 2 && last["finished"] == true, "{said}");
}

// --- refusals -------------------------------------------------------------------------------------------------------------

#[test]
fn what_makes_no_sense_is_refused_before_anything_is_rendered() {
    let place = folder();
    place.write("views.csv", "eye_x\n1\n");
    place.write("views.ppm", "eye_x\n1\n2\n");
    let files = place.files();
    for (arguments, code, message) in [
        ("--turntable 2 scene.txt -o frame.png", 2, "no place for the number of the frame\n  help: -o frame_%04d.png"),
        ("--turntable 2 scene.txt -o -", 2, "frames do not go to standard output"),
        ("--turntable 2 --views views.csv scene.txt -o f%d.png", 2, "cannot be used with"),
        ("--frames 1 scene.txt -o f.png", 2, "--frames"),
        ("--turntable 2 --frames 1-3 scene.txt -o f%d.png", 2, "there is no frame 3, but 2 frames"),
        ("--turntable 2 --frames 3-1 scene.txt -o f%d.png", 2, "no range such as 1-50"),
        ("--turntable 0 scene.txt -o f%d.png", 2, "0 is not in"),
        ("--turntable 2 scene.txt scene.txt -o f%d.png", 2, "several scenes"),
        ("--turntable 2 --show scene.txt -o f%d.png", 2, "--show"),
        ("--turntable 2 --aov t scene.txt -o f%d.png", 2, "--aov"),
        ("--turntable 2 --certificate c.json scene.txt -o f%d.png", 2, "--certificate"),
        ("--turntable 2 --sparse 0.5 scene.txt -o f%d.png", 2, "--sparse"),
        ("--turntable 2 scene.txt -o f%d.jpg", 2, "written as .ppm, .png, .pfm or .exr"),
        ("--turntable 2 scene.txt -o none/f%d.png", 6, "there is no folder none"),
        ("--views none.csv scene.txt -o f%d.png", 3, "cannot read the views none.csv"),
        ("--views views.ppm scene.txt -o views.ppm%%%d --format p6", 0, ""),
    ] {
        render(&place, arguments, code, message);
        let new = place.files().into_iter().filter(|name| !files.contains(name)).collect::<Vec<_>>();
        let expected: &[&str] = if code == 0 { &["views.ppm%1", "views.ppm%2"] } else { &[] };
        assert_eq!(new, expected, "{arguments}");
    }
}

#[test]
fn no_frame_is_an_input_or_another_output() {
    let place = folder();
    place.write("scene3.txt", fs::read_to_string(place.path("scene.txt")).unwrap());
    place.write("views1.ppm", "eye_x,scene\n,\n,scene3.txt\n");
    for arguments in [
        "--turntable 3 scene3.txt -o scene%d.txt --format p6",
        "--views views1.ppm scene.txt -o views%d.ppm",
        "--views views1.ppm scene.txt -o s%d.ppm --stats-json s2.ppm",
    ] {
        let files = place.files();
        render(&place, arguments, 6, "would overwrite");
        assert_eq!(place.files(), files, "{arguments}");
    }
    place.write("again.csv", "eye_x,scene\n0,\n1,\n2,scene3.txt\n");
    render(&place, "--views again.csv scene.txt -o scene%d.txt --format p6", 6, "frame 3 would overwrite scene3.txt");
    assert!(!place.path("scene1.txt").exists());
}

#[test]
fn a_frame_that_fails_is_named_and_keeps_no_other_from_being_rendered() {
    let place = folder();
    place.write("bad.txt", "NEAR\n");
    place.write("views.csv", "eye_x,left,scene\n0,,\n1e200,,\n0,1,\n0,,bad.txt\n0.5,,\n");
    let output = render(
        &place,
        "-q --views views.csv scene.txt -o f%d.png",
        3,
        "trueray: frame 2: the scene cannot be rendered",
    );
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("frame 3: right of the window is 1") && said.contains("frame 4: its scene"), "{said}");
    assert_eq!(place.files(), ["bad.txt", "f1.png", "f5.png", "scene.txt", "views.csv"]);
}

/// Of a frame whose file cannot be written, no more is rendered than what is on its way.
#[cfg(target_os = "linux")]
#[test]
fn a_frame_without_a_file_is_not_rendered_on() {
    let place = folder();
    std::os::unix::fs::symlink("/dev/full", place.path("f1.ppm")).unwrap();
    place.write("views.csv", "width,height\n2048,4096\n");
    let arguments = "-q --views views.csv scene.txt -o f%d.ppm --timeline t.json";
    render(&place, arguments, 6, "frame 1: cannot write f1.ppm: ");
    let steps: Vec<Value> = serde_json::from_slice(&place.read("t.json")).unwrap();
    let traced = steps.iter().filter(|step| step["ph"] == "B" && step["name"] == "trace by the reference");
    let pixels: u64 = traced.map(|step| step["args"]["pixels"].as_str().unwrap().parse::<u64>().unwrap()).sum();
    assert!((1..2048 * 4096).contains(&pixels), "{pixels}");

    // No disk has room for it, and its first band would take minutes.
    place.write("views.csv", "width,height\n16777216,16777216\n");
    let mut child = place.command("render --device cpu -q --views views.csv scene.txt -o g%d.ppm").spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(50));
    }
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(6), "after {:?}", start.elapsed());
}

/// What is wrong, with the line, the column and the token.
#[test]
fn errors_of_a_table_name_line_column_and_token() {
    for (text, place, message) in [
        ("", "1:1", "the file has no header"),
        ("eye_x,eye_y\n", "1:12", "the file has no frame"),
        ("eye_x,eys_y\n1,2\n", "1:7", "no column is called 'eys_y'"),
        ("eye_x,eye_y,eye_x\n1,2,3\n", "1:13", "a second column eye_x"),
        ("eye_x,eye_y\n1,2,3\n", "2:5", "a row of 3 cells"),
        ("eye_x,eye_y\n\n1\n", "3:2", "a row of 1 cell"),
        ("eye_x\n1\nNaN\n", "3:1", "eye_x is no finite number: 'NaN'"),
        ("eye_x,eye_y\r\n1, 1e999\r\n", "2:4", "eye_y is no finite number: '1e999'"),
        ("eye_x,eye_y\n1,two\n", "2:3", "eye_y is no finite number: 'two'"),
        ("width\n0\n", "2:1", "width is out of range: '0'"),
        ("height\n1.5\n", "2:1", "height is out of range: '1.5'"),
        ("near\n-1\n", "2:1", "near is out of range: '-1'"),
        ("fov\n180\n", "2:1", "fov is out of range: '180'"),
        ("left,right\n1,1\n", "2:3", "left is '1' and right is '1'"),
        ("bottom,top\n0,1\n-1e308,1e308\n", "3:8", "bottom is '-1e308' and top is '1e308'"),
        ("top,fov\n1,40\n", "2:3", "both fov and top say how large the window is"),
        ("eye_x,at_x,at_y\n1,2,3\n", "2:3", "at_z is missing"),
        ("eye_x,eye_y,eye_z,at_x,at_y,at_z\n 1,2,3,1,2,3\n", "2:2", "eye and look-at are the same point"),
        ("at_x,at_y,at_z,up_x,up_y,up_z\n0,5,0,0,1,0\n", "2:1", "up is parallel to the direction of view"),
        ("scene,eye_x\n\"a,b,1\n", "2:1", "a quote that nothing closes"),
    ] {
        let report = table("v.csv", Path::new(""), text.as_bytes(), &START, false).unwrap_err();
        let told = report.contains(&format!("v.csv:{place}\n")) && report.contains(&format!("error: {message}"));
        assert!(told, "{text:?}: expected {place} and {message} in:\n{report}");
    }
    let report = table("v.csv", Path::new(""), b"eye_x\nx\n1\ny\n", &START, false).unwrap_err();
    assert!(report.contains("v.csv:2:1") && report.contains("v.csv:4:1"), "all of them:\n{report}");
}

#[test]
fn tables_as_other_programs_write_them_are_read() {
    let text = "\u{FEFF}scene, \"eye_x\" ,up_y\r\n\"a \"\"b\"\", c.txt\", 1.5 ,\r\n\r\n,,1\r\n";
    let frames = table("v.csv", Path::new("folder"), text.as_bytes(), &START, false).unwrap();
    let first =
        Frame { scene: Some(PathBuf::from("folder/a \"b\", c.txt")), ..Frame::seen_by(view([1.5, 0.0, 0.0], None)) };
    assert_eq!(frames, [first, Frame::seen_by(View::FILE)]);
}

/// Frames that are there stay, the missing one comes, and one of another picture is refused. The reader of a table and of particles are
/// one option away from each other.
#[test]
fn frames_are_resumed_and_particles_turn() {
    let place = folder();
    render(&place, "scene.txt --turntable 3 --resume -o a_%d.png", 0, "3 frames");
    let first = fs::read(place.path("a_1.png")).unwrap();
    fs::remove_file(place.path("a_2.png")).unwrap();
    let stamp = || fs::metadata(place.path("a_1.png")).unwrap().modified().unwrap();
    let before = stamp();
    render(&place, "scene.txt --turntable 3 --resume -o a_%d.png", 0, "2 frames there already");
    assert_eq!((stamp(), fs::read(place.path("a_1.png")).unwrap()), (before, first));
    assert!(place.path("a_2.png").is_file());
    render(&place, "scene.txt --turntable 4 --resume -o a_%d.png", 6, "frame 2: ");
    render(&place, "scene.txt --turntable 4 --progress openjd --resume -o a_%d.png", 6, "openjd_fail: frame 2: ");
    // The scene of a frame that is not chosen is an input as well.
    place.write("table.csv", "scene\nother_2.txt\nscene.txt\n");
    fs::copy(place.path("scene.txt"), place.path("other_2.txt")).unwrap();
    render(&place, "scene.txt --views table.csv --frames 2 --format p6 -o other_%d.txt", 6, "an input of this run");
    render(&place, "scene.txt --turntable 3 --tile 0/2 -o b_%d.png", 2, "do not go with --crop or --tile");

    place.write("water.xyz", "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
    render(&place, "water.xyz --turntable 2 --radius 0.5 --res 32x24 -o w_%d.png", 0, "2 frames");
    render(&place, "water.xyz --radius 0.5 --fit ball --res 32x24 -o single.png", 0, "");
    assert_eq!(picture(&place, "w_1.png"), picture(&place, "single.png"));
    assert_ne!(picture(&place, "w_2.png"), picture(&place, "single.png"));

    // The lights turn with the eye, also where frames share lists; a view of the table is the run with that eye.
    place.write("far.csv", "eye_x,eye_y,eye_z,at_x,at_y,at_z\n0,0,0,0,0,-9\n1,0,-18,0,0,-9\n0,0,1,0,0,-9\n");
    for light in ["headlight", "dome:4"] {
        let options = format!("water.xyz --radius 0.5 --light {light} --res 32x24");
        render(&place, &format!("{options} --views far.csv -o v_%d.png"), 0, "3 frames");
        render(&place, &format!("{options} --eye 1,0,-18 --look-at 0,0,-9 -o eye.png"), 0, "");
        assert_eq!(picture(&place, "v_2.png"), picture(&place, "eye.png"), "{light}");
        render(&place, &format!("{options} --eye 0,0,1 --look-at 0,0,-9 -o eye.png"), 0, "");
        assert_eq!(picture(&place, "v_3.png"), picture(&place, "eye.png"), "{light}");
    }
}

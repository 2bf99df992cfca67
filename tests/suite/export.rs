//! Scenes for other renderers: what is written, what is refused, and where a renderer is installed, its picture.

use std::path::Path;
use std::process::{Command, Stdio};

use trueray::compare::Difference;
use trueray::effects::Effects;
use trueray::export::{Export, Obstacle, Peer, export};
use trueray::film::{Leniency, Picture, read_picture};
use trueray::pattern::Pattern;
use trueray::scene::Scene;
use trueray::settings::{Quantize, SampleOffset, Settings, Specular};
use trueray::view::Projection;

use crate::support::{cpu_picture, orthographic, root, say_skipped, scene, scene_files, scene_of, widened};

const BALL: &str = "SPHERE ball 0.5 1 -6 2 2 2 0.9 0.5 0.25 0.5 0.25 0.75 0 30\n";
const LAMP: &str = "LIGHT lamp 3 4 5 1 0.5 0.25\nLIGHT dark 1 1 1 0 0 0\n";
const MIRRORS: &str = "SPHERE a -2 0 -6 1 1 1 1 1 1 0 0 0 0.5 1\nSPHERE b 2 0 -6 1 1 1 1 1 1 0 0 0 0.5 1\n";

fn written(scene: &Scene, settings: &Settings, peer: Peer) -> Result<Export, Vec<Obstacle>> {
    export(scene, settings, &Effects::of(&scene.viewed(settings)), peer)
}

/// The file with the settings that the peer's own habits want.
#[track_caller]
fn text(statements: &str, settings: &Settings, peer: Peer) -> String {
    let quantize = if peer == Peer::PovRay { Quantize::Round } else { Quantize::Truncate };
    let export = written(&scene_of(statements), &Settings { quantize, ..*settings }, peer).unwrap();
    assert!(export.warnings.is_empty(), "{:?}", export.warnings);
    export.text
}

#[track_caller]
fn assert_has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no '{part}' in\n{text}");
    }
}

#[test]
fn povray_gets_every_term() {
    let scene = format!("{BALL}{LAMP}AMBIENT 0.5 1 0\nBACK 0.1 0.2 0.3\n");
    let file = text(&scene, &Settings::exact(), Peer::PovRay);
    assert_has(
        &file,
        &[
            "#version 3.7;",
            "assumed_gamma 1 adc_bailout 0 max_trace_level 1 ",
            "direction <0.0, 0.0, -1.0>\n  right <2.0, 0, 0> up <0, 2.0, 0>",
            "background { rgb <0.1, 0.2, 0.3> }",
            "light_source { <3.0, 4.0, 5.0>, rgb <1.0, 0.5, 0.25> }",
            "sphere { <0.5, 1.0, -6.0>, 2.0 pigment { rgb <0.9, 0.5, 0.25> } finish { ambient rgb <0.25, 0.5, 0.0> diffuse 0.25 \
             phong 0.75 phong_size 30.0 } }",
            "+W40 +H40",
        ],
    );
    assert_eq!(file.matches("light_source").count(), 1, "a lamp without light takes time for nothing");
    assert!(!file.contains("reflection"), "a single mirror-less ball");

    let blinn = text(&scene, &Settings { specular: Specular::Blinn, ..Settings::exact() }, Peer::PovRay);
    assert_has(&blinn, &[&format!("specular 0.75 roughness {:?} }}", 1.0 / 30.0)]);
    let egg = text(&BALL.replace("2 2 2", "1 -2 3"), &Settings::exact(), Peer::PovRay);
    assert_has(&egg, &["sphere { <0, 0, 0>, 1 scale <1.0, 2.0, 3.0> translate <0.5, 1.0, -6.0> "]);
}

#[test]
fn povray_gets_mirrors_and_a_sky_for_the_eye_alone() {
    let black = text(MIRRORS, &Settings::exact(), Peer::PovRay);
    assert_has(&black, &["max_trace_level 4 ", "reflection 0.5 }", "background { rgb <0.0, 0.0, 0.0> }"]);
    let sky = text(&format!("{MIRRORS}BACK 0.1 0.2 0.3"), &Settings::exact(), Peer::PovRay);
    assert_has(&sky, &["background { rgb 0 }", "pigment { rgb <0.1, 0.2, 0.3> }", "hollow no_shadow no_reflection }"]);
    let shallow = text(MIRRORS, &Settings { max_depth: 1, ..Settings::exact() }, Peer::PovRay);
    assert_has(&shallow, &["max_trace_level 2 "]);
}

#[test]
fn povray_cuts_spheres_open_for_the_eye_alone() {
    let shell = |z: &str| {
        text(&format!("SPHERE s 0 0 {z} 0.4 0.4 0.4 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1"), &Settings::exact(), Peer::PovRay)
    };
    let beyond = shell("-1.5");
    assert!(!beyond.contains("no_image") && !beyond.contains("clipped_by"));
    let cut = shell("-1.2");
    assert_has(&cut, &["hollow clipped_by { plane { z, -1.0 } } no_shadow no_reflection }", "hollow no_image }"]);
    let hidden = shell("-0.5");
    assert!(hidden.contains("no_image") && !hidden.contains("clipped_by"), "{hidden}");
    let behind = shell("0.5");
    assert!(!behind.contains("no_image") && !behind.contains("clipped_by"), "{behind}");
}

/// A window that is neither around the view nor square, and spheres that only the one or only the other projection shows or cuts.
#[test]
fn parallel_rays_are_those_of_the_window() {
    let mut scene = scene_of(&format!("{BALL}{LAMP}"));
    scene.window.near = 2.0;
    (scene.window.left, scene.window.right, scene.window.bottom, scene.window.top) = (-3.0, 5.0, -1.0, 3.0);
    (scene.width, scene.height) = (8, 4);
    let settings = orthographic(Settings { quantize: Quantize::Round, ..Settings::exact() });
    assert_has(
        &written(&scene, &settings, Peer::PovRay).unwrap().text,
        &[
            "camera { orthographic location <1.0, 1.0, 0.0> direction <0.0, 0.0, -1.0>\n  right <8.0, 0, 0> up <0, 4.0, 0> }",
        ],
    );
    // Samples in the upper right corner of a pixel, whose side is 1.
    let written = written(&scene, &settings, Peer::Tachyon).unwrap().text;
    assert_has(&written, &["PROJECTION ORTHOGRAPHIC\n", "FRUSTUM -3.5 4.5 -1.5 2.5\n"]);

    let cut = |place: &str, settings: &Settings| {
        text(&format!("SPHERE s {place} 0.4 0.4 0.4 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1"), settings, Peer::PovRay)
            .contains("clipped_by")
    };
    let parallel = orthographic(Settings::exact());
    assert!(cut("0 0 -1.2", &Settings::exact()) && cut("0 0 -1.2", &parallel));
    assert!(cut("1.6 0 -1.2", &Settings::exact()) && !cut("1.6 0 -1.2", &parallel), "beside the beam");
    assert!(!cut("1.3 0 -0.7", &Settings::exact()) && cut("1.3 0 -0.7", &parallel), "beside the pyramid");
}

#[test]
fn tachyon_gets_every_term() {
    let file =
        text(&format!("{BALL}{LAMP}AMBIENT 0.5 0.5 0.5\nBACK 0.1 0.2 0.3\n"), &Settings::classic(), Peer::Tachyon);
    assert!(file.starts_with("BEGIN_SCENE\nRESOLUTION 40 40\n") && file.ends_with("END_SCENE\n"), "{file}");
    assert_has(
        &file,
        &[
            "-shade_phong",
            "RAYDEPTH 1\n",
            "BACKGROUND 0.1 0.2 0.3\n",
            "LIGHT CENTER 3.0 4.0 -5.0 RAD 0 COLOR 1.0 0.5 0.25\n",
            "SPHERE CENTER 0.5 1.0 6.0 RAD 2.0\n",
            "AMBIENT 0.25 DIFFUSE 0.25 SPECULAR 0.0 OPACITY 1 PHONG PLASTIC 0.75 PHONG_SIZE 30.0 COLOR 0.9 0.5 0.25 TEXFUNC 0",
        ],
    );
    assert_eq!(file.matches("LIGHT ").count(), 1);
    let mirrors = text(MIRRORS, &Settings::classic(), Peer::Tachyon);
    assert_has(&mirrors, &["RAYDEPTH 4\n", "SPECULAR 0.5 "]);
    // Of two surfaces at one distance Tachyon shows the last one.
    assert!(mirrors.find("CENTER 2.0").unwrap() < mirrors.find("CENTER -2.0").unwrap());
}

#[test]
fn samples_lie_where_the_convention_wants_them() {
    let mut scene = scene_of(BALL);
    scene.window.near = 2.0;
    (scene.window.left, scene.window.right, scene.window.bottom, scene.window.top) = (2.0, 10.0, -3.0, 1.0);
    (scene.width, scene.height) = (8, 4);
    let frustum = |sampling, peer| {
        let settings = Settings { sampling, ..Settings::classic() };
        let text = written(&scene, &settings, peer).unwrap().text;
        let marker = if peer == Peer::Tachyon { "FRUSTUM " } else { "direction " };
        let line = text.split_once(marker).unwrap().1.lines().next().unwrap();
        line.trim_matches(['<', '>']).split([' ', ',']).filter_map(|x| x.parse().ok()).collect::<Vec<f64>>()
    };
    // Pixels are squares of side ½ at distance 1. Tachyon samples the upper right corner of a pixel, POV-Ray its centre.
    assert_eq!(frustum(SampleOffset::Corner, Peer::Tachyon), [0.5, 4.5, -1.5, 0.5]);
    assert_eq!(frustum(SampleOffset::BottomLeft, Peer::Tachyon), [0.5, 4.5, -2.0, 0.0]);
    assert_eq!(frustum(SampleOffset::Center, Peer::Tachyon), [0.75, 4.75, -1.75, 0.25]);
    assert_eq!(frustum(SampleOffset::Center, Peer::PovRay), [3.0, -0.5, -1.0]);
    assert_eq!(frustum(SampleOffset::Corner, Peer::PovRay), [2.75, -0.25, -1.0]);
    assert_eq!(frustum(SampleOffset::BottomLeft, Peer::PovRay), [2.75, -0.75, -1.0]);
}

/// What stands in the way of `peer`, in words.
fn obstacles(statements: &str, peer: Peer) -> Vec<String> {
    written(&scene_of(statements), &Settings::classic(), peer).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn what_cannot_be_expressed_is_named() {
    let both = [
        (BALL.replace(" 0 30", " 0 30 0.5 1.5"), "sphere 'ball': refraction"),
        (format!("{}{LAMP}", BALL.replace(" 0 30", " 0 0")), "sphere 'ball': n = 0"),
        (BALL.replace("0.75 0 30", "0.75 -1 30"), "a coefficient is negative"),
    ];
    for (statements, what) in both {
        for peer in Peer::ALL {
            let found = obstacles(&statements, peer);
            assert!(found.len() == 1 && found[0].contains(what), "{peer}: {found:?}");
        }
    }
    let povray = [
        (BALL.replace("-6 2 2 2", "-2e7 1e6 1e6 1e6"), "nothing beyond a distance of 1e7"),
        (BALL.replace("2 2 2", "1e-4 1e-4 1e-4"), "tolerance of 1e-3"),
        (BALL.replace("-6 2 2 2", "-9e6 2 2 2"), "too many radii from the origin"),
        (MIRRORS.replace("-6 1 1 1", "-9e6 9.5e5 9.5e5 9.5e5") + "BACK 1 0 0", "a sky around all this is beyond 1e7"),
    ];
    for (statements, what) in povray {
        let found = obstacles(&statements, Peer::PovRay);
        assert!(found.len() == 1 && found[0].contains(what), "{found:?}");
    }
    let tachyon = [
        (BALL.replace("2 2 2", "2 2 2.5"), "no ellipsoids"),
        (BALL.replace("-6 2 2 2", "-2 2 2 2"), "not wholly beyond the image plane"),
        (BALL.replace("-6 2 2 2", "-0.5 0.2 0.2 0.2").replace("0.5 1", "0 0"), "not wholly beyond the image plane"),
        (format!("{BALL}AMBIENT 0.5 0.4 0.5"), "AMBIENT is coloured"),
        (format!("{MIRRORS}BACK 0 0 0.1"), "BACK with reflections"),
        (BALL.replace("2 2 2", "1e-5 1e-5 1e-5"), "tolerance of 5e-5"),
        (BALL.replace("-6 2 2 2", "-1e30 1e29 1e29 1e29"), "single precision"),
    ];
    for (statements, what) in tachyon {
        let found = obstacles(&statements, Peer::Tachyon);
        assert!(found.len() == 1 && found[0].contains(what), "{found:?}");
    }
    let several = format!("{MIRRORS}{}BACK 1 1 1", BALL.replace("2 2 2", "2 1 2"));
    assert_eq!(obstacles(&several, Peer::Tachyon).len(), 2);
    let grid =
        written(&scene_of(BALL), &Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::classic() }, Peer::PovRay)
            .unwrap_err();
    assert!(matches!(&grid[..], [Obstacle::Settings(what)] if what.contains("one sample a pixel")), "{grid:?}");
}

#[test]
fn what_does_no_harm_is_no_obstacle() {
    // Colour that no sphere reflects, a background that no reflection ray can see, and spheres that no eye ray meets.
    for harmless in [
        BALL.replace("0.5 0.25 0.75", "0 0.25 0.75") + "AMBIENT 0.5 0.4 0.5",
        BALL.replace("0.75 0 30", "0.75 1 30") + "BACK 1 1 1",
        BALL.to_owned() + "SPHERE behind 0 0 5 2 2 2 1 1 1 1 0 0 0 1",
        BALL.to_owned() + "SPHERE aside 9 0 -1 2 2 2 1 1 1 1 0 0 0 1",
    ] {
        text(&harmless, &Settings::classic(), Peer::Tachyon);
    }
}

#[test]
fn what_comes_out_slightly_different_is_a_warning() {
    let warnings =
        |statements: &str, settings: &Settings, peer| written(&scene_of(statements), settings, peer).unwrap().warnings;
    let twins = format!("{BALL}{BALL}");
    for peer in Peer::ALL {
        assert!(
            warnings(&twins, &Settings::classic(), peer).iter().any(|w| w.contains("the first in the file is seen"))
        );
    }
    assert!(warnings(BALL, &Settings::classic(), Peer::PovRay)[0].contains("--quantize round"));
    assert!(warnings(BALL, &Settings::exact(), Peer::Tachyon)[0].contains("--quantize truncate"));
    let faint = format!("{}{LAMP}", BALL.replace(" 0 30", " 0.001 0.5"));
    assert_eq!(warnings(&faint, &Settings::classic(), Peer::Tachyon).len(), 2);
    let far = BALL.replace("-6 2 2 2", "-6e5 2 2 2").replace("0.5 1", "0 0");
    assert_eq!(warnings(&far.replace("-6e5", "-1e5"), &Settings::exact(), Peer::PovRay).len(), 1);
    assert_eq!(warnings(&far, &Settings::classic(), Peer::Tachyon).len(), 1);
    // A thousandth of the way to the light is more than a tenth of a ball.
    let other = BALL.replace("ball 0.5", "other 4.5");
    let far_light = format!("{BALL}{other}LIGHT sun 2000 0 0 1 1 1\n");
    assert!(warnings(&far_light, &Settings::classic(), Peer::Tachyon)[0].contains("nearer than 2.0e0"));
    assert!(warnings(&far_light, &Settings::exact(), Peer::PovRay).is_empty());
}

#[test]
fn every_scene_is_written_or_refused() {
    let mut written_for = [0, 0];
    for file in scene_files(&["basic", "effects", "hard", "show"]) {
        for (peer, count) in Peer::ALL.into_iter().zip(&mut written_for) {
            match written(&scene(&file), &Settings::classic(), peer) {
                Ok(export) => {
                    *count += 1;
                    assert!(!export.text.contains("NaN") && !export.text.contains("inf"), "{}", file.display());
                }
                Err(obstacles) => assert!(!obstacles.is_empty()),
            }
        }
    }
    assert!(written_for[0] > 60 && written_for[1] > 20, "{written_for:?}");
}

#[test]
fn the_program_writes_and_has_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    let head = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 40\n";
    std::fs::write(folder.path().join("s.txt"), format!("{head}{BALL}")).unwrap();
    std::fs::write(folder.path().join("egg.txt"), format!("{head}{}", BALL.replace("2 2 2", "2 1 2"))).unwrap();
    let run = |arguments: &str, code: i32, message: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.args(arguments.split_whitespace()).current_dir(folder.path()).stdin(Stdio::null());
        let output = command.output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{stderr}");
        assert!(stderr.contains(message), "{stderr}");
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(run("export s.txt --to tachyon", 0, "").starts_with("BEGIN_SCENE"));
    assert_eq!(run("export s.txt --to povray -o s.pov", 0, "warning: POV-Ray rounds levels"), "");
    let written = std::fs::read_to_string(folder.path().join("s.pov")).unwrap();
    assert!(written.contains("+W40 +H40"));
    assert!(run("export s.txt --to povray --res 80x60 --quantize round", 0, "").contains("+W80 +H60"));
    run("export s.txt --to mitsuba", 2, "expected povray or tachyon");
    run("export s.txt", 2, "--to");
    run("export s.txt --to povray --spp 4", 2, "one sample a pixel");
    run("export s.txt --to povray --eye 0,0,1 --projection orthographic", 2, "leave --eye, --look-at and --up out");
    assert!(run("export s.txt --to povray --projection orthographic", 0, "").contains("camera { orthographic "));
    run("export s.txt --to povray --effects=-shadows", 0, "");
    run("export s.txt --to povray --effects=+shadows", 2, "leave --effects out");
    run("export egg.txt --to tachyon -o egg.dat", 3, "egg.txt: Tachyon cannot express this scene:\n  sphere 'ball': ");
    assert!(!folder.path().join("egg.dat").exists());
    run("export missing.txt --to povray", 3, "missing.txt");
    run("export s.txt --to povray -o nowhere/s.pov", 6, "nowhere");
    run("export s.txt --to povray -o s.txt", 6, "would overwrite s.txt, an input of this run");
}

/// The picture of an installed renderer; `None`, said aloud, where it is not.
fn picture_of(peer: Peer, scene: &Scene, settings: &Settings, folder: &Path, test: &str) -> Option<Picture> {
    let file = folder.join("scene");
    let picture = folder.join("picture.ppm");
    std::fs::write(&file, written(scene, settings, peer).unwrap().text).unwrap();
    let mut command = Command::new(peer.name());
    match peer {
        Peer::PovRay => command.args([
            format!("+I{}", file.display()),
            format!("+O{}", picture.display()),
            format!("+W{}", scene.width),
            format!("+H{}", scene.height),
            "+FP".into(),
            "File_Gamma=1".into(),
            "-A".into(),
            "-D".into(),
        ]),
        Peer::Tachyon => command.arg(&file).args(["-shade_phong", "-format", "PPM", "-o"]).arg(&picture),
    };
    let Ok(output) = command.stdin(Stdio::null()).output() else {
        say_skipped(test, &format!("{peer} is not installed"));
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(read_picture(&picture, Leniency::Strict).unwrap().picture)
}

#[test]
fn installed_renderers_show_our_picture() {
    let test = "installed_renderers_show_our_picture";
    let cases = [
        (Peer::PovRay, Quantize::Round, ["basic/off-centre-window", "basic/window-corner", "effects/three-mirrors"]),
        (
            Peer::Tachyon,
            Quantize::Truncate,
            ["basic/off-centre-window", "effects/coloured-shadows", "effects/same-place"],
        ),
    ];
    for ((peer, quantize, names), projection) in cases
        .into_iter()
        .flat_map(|case| [Projection::Perspective, Projection::Orthographic].map(|projection| (case, projection)))
    {
        for name in names {
            let folder = tempfile::tempdir().unwrap();
            let mut scene = scene(&root().join("scenes").join(name).with_extension("txt"));
            let mut settings = Settings { quantize, ..Settings::classic() };
            if projection == Projection::Orthographic {
                settings = orthographic(settings);
                scene = widened(scene);
                // Of round numbers: no ray touches a sphere.
                scene.window.left -= 0.0117;
                scene.window.top += 0.0071;
            }
            let Some(theirs) = picture_of(peer, &scene, &settings, folder.path(), test) else { break };
            let (ours, _) = cpu_picture::<f64>(&scene, &settings, &Effects::of(&scene.viewed(&settings)));
            let differing = Difference::between(&ours, &theirs).unwrap().differing;
            // Each rounds on its own: a level here and there.
            assert!(differing.over_0 <= 3 && differing.over_1 == 0, "{peer}, {name}, {projection:?}: {differing:?}");
        }
    }
}

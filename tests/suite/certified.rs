//! Certified pictures: the reference's in every pixel, however they are rendered; and how that is verified.

use std::path::Path;
use std::process::{Command, Output};

use trueray::bench::Family;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, Pixels, Stages, render_picture};
use trueray::film::{Format, Picture, Target};
use trueray::gpu::{Choice, Device, Gpu, GpuRenderer, Kernel, Mask, Quotients, Rows};
use trueray::pattern::Pattern;
use trueray::precision::{Request, Selection, Tier};
use trueray::scene::Scene;
use trueray::settings::{Settings, Specular};
use trueray::verify::Verify;

use crate::support::{cpu_picture, gpu, scene, scene_files};
use crate::tuning::{cases, tunings};

/// More unsure pixels than there are.
const NEVER: usize = usize::MAX;

fn selection(gpu: &Gpu, scene: &Scene, settings: &Settings) -> (Effects, Selection) {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    let selection = Selection::of(&viewed, &effects, Request::Certified, gpu.ladder());
    (effects, selection)
}

fn engine<'a>(gpu: &'a Gpu, scene: &Scene, settings: &Settings, double_from: usize) -> Engine<'a> {
    let (effects, selection) = selection(gpu, scene, settings);
    let backend = Backend::of(Some(gpu), &selection);
    Engine::new(backend, scene.viewed(settings), &effects).unwrap().with_double_from(double_from)
}

/// Fails where the certified picture is not the reference's; by which stages it is.
#[track_caller]
fn assert_certified(case: &str, gpu: &Gpu, scene: &Scene, settings: &Settings, double_from: usize) -> Stages {
    let mut engine = engine(gpu, scene, settings, double_from);
    let (rgb, not_finite) = render_picture(&mut engine).unwrap();
    let (expected, expected_not_finite) = cpu_picture::<f64>(scene, settings, &Effects::of(&scene.viewed(settings)));
    let wrong = rgb.as_chunks::<3>().0.iter().zip(expected.pixels()).filter(|(own, expected)| own != expected).count();
    assert_eq!((wrong, not_finite), (0, expected_not_finite), "{case}");
    let stages = engine.stages().unwrap();
    assert_eq!(stages.kernel + stages.double + stages.reference, expected.pixel_count(), "{case}: {stages:?}");
    stages
}

fn conventions() -> [(&'static str, Settings); 3] {
    let blinn = Settings { specular: Specular::Blinn, max_depth: 5, ..Settings::exact() };
    [("classic", Settings::classic()), ("exact", Settings::exact()), ("exact, blinn, depth 5", blinn)]
}

#[test]
fn every_scene_is_the_reference() {
    let Some(gpu) = gpu("certified::every_scene_is_the_reference") else { return };
    for file in scene_files(&["basic", "effects", "refraction", "hard", "show"]) {
        let scene = scene(&file);
        let is_hard = ["hard", "show"].iter().any(|folder| file.parent().unwrap().ends_with(folder));
        for (name, settings) in &conventions()[..if is_hard { 3 } else { 1 }] {
            assert_certified(&format!("{}, {name}", file.display()), &gpu, &scene, settings, NEVER);
        }
    }
}

#[test]
fn double_renders_again_what_fast_is_unsure_of() {
    let Some(gpu) = gpu("certified::double_renders_again_what_fast_is_unsure_of") else { return };
    let has_double = gpu.device.info.f64;
    let mut scenes: Vec<_> =
        scene_files(&["hard"]).iter().map(|file| (file.display().to_string(), scene(file))).collect();
    for name in ["mirrors", "ellipsoids"] {
        let mut scene = Family::named(name).unwrap().scene(1000);
        (scene.width, scene.height) = (70, 37);
        scenes.push((name.into(), scene));
    }
    let mut unsure = 0;
    for (name, scene) in scenes {
        let alone = assert_certified(&name, &gpu, &scene, &Settings::exact(), NEVER);
        let both = assert_certified(&name, &gpu, &scene, &Settings::exact(), 1);
        assert_eq!((alone.kernel, alone.double), (both.kernel, 0), "{name}");
        assert!(has_double || both.double == 0, "{name}");
        unsure += alone.reference;
    }
    assert!(unsure > 0);
}

/// What a kernel is sure of is right without anything beside it.
#[test]
fn what_kernels_are_sure_of_is_right() {
    let Some(gpu) = gpu("certified::what_kernels_are_sure_of_is_right") else { return };
    let options = Options { certified: true, ..Options::default() };
    for file in scene_files(&["hard", "refraction"]) {
        let scene = scene(&file);
        for (name, settings) in conventions() {
            let (effects, selection) = selection(&gpu, &scene, &settings);
            for tier in [Tier::Fast, Tier::Double] {
                if tier < selection.tier || tier == Tier::Double && !gpu.device.info.f64 {
                    continue;
                }
                let viewed = scene.viewed(&settings);
                let mut renderer = GpuRenderer::<Rows>::with(&gpu, &viewed, &effects, tier, &options).unwrap();
                let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
                let rendered = renderer.rows(0, &mut rgb).unwrap();
                let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
                let pixels = rgb.as_chunks_mut::<3>().0;
                for [x, y] in rendered.unsure.into_iter().chain(rendered.cut) {
                    pixels[y as usize * scene.width as usize + x as usize] = expected.pixel(x, y);
                }
                let wrong = pixels.iter().zip(expected.pixels()).filter(|(own, expected)| own != expected).count();
                assert_eq!(wrong, 0, "{}, {name}, {tier}", file.display());
            }
        }
    }
}

/// Kept paths and paths in place, trees, several samples, both kinds of tables; bands of any height; verified or not.
#[test]
fn no_way_of_working_changes_a_byte() {
    let Some(mut gpu) = gpu("certified::no_way_of_working_changes_a_byte") else { return };
    let own = gpu.tuned().tuning;
    for (name, scene, settings) in cases() {
        let (effects, selection) = selection(&gpu, &scene, &settings);
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        for (number, mut tuning) in tunings().into_iter().enumerate() {
            tuning.workgroup = tuning.workgroup.min(gpu.device.info.max_invocations);
            gpu.set_tuning(tuning).unwrap();
            let (rows, verify) = [(37, Verify::Nothing), (8, Verify::All), (13, Verify::Nothing)][number % 3];
            let backend = Backend::of(Some(&gpu), &selection);
            let engine = Engine::verified(backend, scene.viewed(&settings), &effects, &Options::default(), verify);
            let mut engine = engine.unwrap().with_double_from([NEVER, 200][number % 2]);
            let mut rgb = vec![0; expected.rgb().len()];
            for (band, first) in rgb.chunks_mut(rows * scene.width as usize * 3).zip((0..).step_by(rows)) {
                engine.rows(first, band).unwrap();
            }
            let stages = engine.stages().unwrap();
            drop(engine);
            gpu.set_tuning(own).unwrap();
            assert!(rgb == expected.rgb(), "{name} in bands of {rows} rows with {tuning:?}: {stages:?}");
            assert!(
                settings.pattern == Pattern::ONE || stages.reference == expected.pixel_count(),
                "{name}: {stages:?}"
            );
        }
    }
}

#[test]
fn lists_of_pixels_are_certified_too() {
    let Some(gpu) = gpu("certified::lists_of_pixels_are_certified_too") else { return };
    for (name, scene, settings) in cases() {
        let (effects, selection) = selection(&gpu, &scene, &settings);
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let backend = Backend::of(Some(&gpu), &selection);
        // Some of them twice.
        let pixels: Vec<_> = (0..2000).map(|k| [k * 7 % scene.width, k * 11 % scene.height]).collect();
        for double_from in [NEVER, 1] {
            let engine = Engine::<Pixels>::with(backend, scene.viewed(&settings), &effects, &Options::default());
            let mut engine = engine.unwrap().with_double_from(double_from);
            let mut colors = vec![[0; 3]; pixels.len()];
            engine.pixels(&pixels, &mut colors).unwrap();
            for (&[x, y], color) in pixels.iter().zip(colors) {
                assert_eq!(color, expected.pixel(x, y), "{name}: {x} {y}");
            }
        }
    }
}

/// What quotients and square roots are off is corrected; a device that is too bad for that is found out.
#[test]
fn a_device_that_divides_badly_is_right_or_refused() {
    let Some(gpu) = gpu("certified::a_device_that_divides_badly_is_right_or_refused") else { return };
    drop(gpu);
    for (units_off, is_refused) in [(0, false), (1, false), (8, false), (100, true)] {
        let mask = Mask { units_off, ..Mask::default() };
        let gpu = Gpu::with(Device::masked(&Choice::Gpu, &mask).unwrap()).unwrap();
        for (name, settings) in conventions() {
            for file in ["hard/mirror-corridor.txt", "effects/everything.txt", "hard/needles.txt"] {
                let scene = scene(&crate::support::root().join("scenes").join(file));
                let (effects, selection) = selection(&gpu, &scene, &settings);
                if !is_refused {
                    assert_certified(&format!("{file}, {name}, {units_off} off"), &gpu, &scene, &settings, NEVER);
                    continue;
                }
                let backend = Backend::of(Some(&gpu), &selection);
                let error = Engine::<Rows>::new(backend, scene.viewed(&settings), &effects).unwrap_err();
                assert!(error.to_string().contains("quotients are off by up to 100."), "{error}");
            }
        }
        let measured = Quotients::measure(&gpu, Kernel::Tier(Tier::Fast)).unwrap();
        // Few units are corrected.
        let most = if is_refused { 110.0 } else { 0.5001 };
        assert!(measured.quotient <= most && measured.root <= most, "{measured:?}");
    }
}

/// What `fast` covers, or nearly so, it begins; elsewhere `double` does.
#[test]
fn the_first_kernel_is_one_that_is_mostly_sure() {
    let of = |file: &str| {
        let scene = scene(&crate::support::root().join("scenes").join(file));
        let viewed = scene.viewed(&Settings::classic());
        Selection::of(&viewed, &Effects::of(&viewed), Request::Certified, &Tier::ALL)
    };
    for (file, tier) in [("basic/overlap.txt", Tier::Fast), ("hard/earth-at-one-metre.txt", Tier::Double)] {
        let selection = of(file);
        assert_eq!(
            (selection.tier, selection.certified, selection.covered),
            (tier, true, true),
            "{}",
            selection.reason
        );
        assert_eq!(selection.to_string(), "certified");
    }
    assert_eq!("certified".parse(), Ok(Request::Certified));
    assert!("sure".parse::<Request>().unwrap_err().contains("or certified"));
}

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 64 48\nSPHERE a -0.7 0 -4 1 1 1 1 0 0 0.2 0.6 0.4 0.5 40\n\
                     SPHERE b 0.9 0.3 -5 1 1.4 1 0 1 0 0.2 0.6 0.4 0.5 40\nSPHERE floor 0 -11.5 -6 10 10 10 0.5 0.5 1 0.2 0.6 0.2 0.3 10\n\
                     SPHERE c 0 -0.5 -6 1 1 1 1 1 0 0.2 0.6 0.4 0.5 40\nLIGHT l 3 5 0 0.8 0.8 0.8\nBACK 0.2 0.3 0.4\nAMBIENT 0.3 0.3 0.3\n";

fn run(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trueray")).args(arguments.split_whitespace()).current_dir(folder).output().unwrap()
}

#[track_caller]
fn assert_run(folder: &Path, arguments: &str, code: i32, message: &str) -> String {
    let output = run(folder, arguments);
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{said}");
    assert!(said.contains(message), "{arguments}: expected '{message}' in:\n{said}");
    said
}

#[test]
fn verify_refuses_every_wrong_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("scene.txt"), SCENE).unwrap();
    let expected = |options: &str| {
        assert_run(path, &format!("render -q --device cpu {options} scene.txt -o right.png"), 0, "");
        Picture::read(path.join("right.png")).unwrap()
    };
    let right = expected("");
    let verified = assert_run(path, "verify --device cpu right.png --scene scene.txt", 0, "verdict           right");
    assert!(!verified.contains("wrong"), "{verified}");
    let planted = [
        ("sphere", SCENE.replace("0.9 0.3 -5 1 1.4", "0.9009 0.3 -5 1 1.4"), ""),
        ("light", SCENE.replace("LIGHT l 3 5 0", "LIGHT l 3.03 5 0"), ""),
        ("exponent", SCENE.replace("0.5 40\n", "0.5 41\n"), ""),
        ("own shadow", SCENE.to_owned(), "--effects=-shadows"),
        ("epsilon", SCENE.to_owned(), "--secondary-epsilon 0.2"),
    ];
    let mut pictures: Vec<_> = planted
        .into_iter()
        .map(|(name, text, options)| {
            std::fs::write(path.join("planted.txt"), text).unwrap();
            assert_run(path, &format!("render -q --device cpu {options} planted.txt -o planted.png"), 0, "");
            (name, Picture::read(path.join("planted.png")).unwrap())
        })
        .collect();
    let mut rgb = right.rgb().to_vec();
    rgb[3 * (64 * 47 + 63) + 1] ^= 1;
    pictures.push(("one bit", Picture::new(64, 48, rgb).unwrap()));
    for (name, picture) in pictures {
        picture.save(&Target::File(path.join("wrong.ppm")), Format::P6).unwrap();
        let differing = picture.pixels().iter().zip(right.pixels()).filter(|(a, b)| a != b).count();
        let at = picture.pixels().iter().zip(right.pixels()).position(|(a, b)| a != b);
        let at = at.unwrap_or_else(|| panic!("{name} changes nothing")) as u32;
        let (x, y) = (at % 64, at / 64);
        let (own, reference) = (picture.pixel(x, y), right.pixel(x, y));
        let said = assert_run(path, "verify --device cpu wrong.ppm --scene scene.txt", 1, "verdict           wrong");
        let first = format!("first             x {x}, y {y}: {own:?}, and the reference has {reference:?}");
        assert!(said.contains(&first), "{name}: expected '{first}' in:\n{said}");
        let json = run(path, "verify --json --device cpu wrong.ppm --scene scene.txt");
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        assert_eq!(json["verdict"], "wrong", "{name}");
        assert_eq!((&json["wrong_pixels"], &json["first"]["y"]), (&differing.into(), &y.into()), "{name}: {json}");
    }
    for (arguments, message) in [
        ("verify none.png --scene scene.txt", "none.png"),
        ("verify right.png --scene none.txt", "none.txt"),
        ("verify right.png --scene scene.txt --res 32x32", "right.png has 64 × 48 pixels, the scene 32 × 32"),
        ("verify scene.txt --scene scene.txt", "scene.txt"),
        ("verify right.png", "--scene"),
    ] {
        assert_run(path, arguments, 2, message);
    }
    let trouble = run(path, "verify --json right.png --scene scene.txt --res 32x32");
    let trouble: serde_json::Value = serde_json::from_slice(&trouble.stdout).unwrap();
    assert_eq!(trouble["verdict"], "trouble");
}

#[test]
fn a_certificate_is_of_one_picture() {
    let Some(gpu) = gpu("certified::a_certificate_is_of_one_picture") else { return };
    let device = gpu.device.info.to_string();
    drop(gpu);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("scene.txt"), SCENE).unwrap();
    let json = |name: &str| {
        let text = std::fs::read_to_string(path.join(name)).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    };
    let certified = "render --device gpu --precision certified";
    let said =
        assert_run(path, &format!("{certified} --stats --certificate a.json scene.txt -o a.ppm"), 0, "certified");
    assert!(said.contains("by the CPU reference"), "{said}");
    assert_run(path, "render -q --device cpu --certificate cpu.json scene.txt -o cpu.ppm", 0, "");
    assert!(std::fs::read(path.join("a.ppm")).unwrap() == std::fs::read(path.join("cpu.ppm")).unwrap());
    let (own, cpu) = (json("a.json"), json("cpu.json"));
    for part in ["program", "system", "cpu", "scene", "settings", "effects", "depth", "picture"] {
        assert!(own[part] == cpu[part] && !own[part].is_null(), "{part}: {own}\n{cpu}");
    }
    assert_eq!(own["device"], device);
    assert_eq!(own["roundings"]["quotient_units"], 2.5);
    assert_eq!((&own["picture"]["width"], &own["picture"]["height"]), (&64.into(), &48.into()));
    let all: u64 = ["kernel", "double", "reference"].iter().map(|stage| own["stages"][stage].as_u64().unwrap()).sum();
    assert_eq!((all, &cpu["stages"]["reference"]), (64 * 48, &(64 * 48).into()));

    // Labels and the name of the picture do not matter; anything else does.
    std::fs::write(path.join("same.txt"), SCENE.replace("SPHERE a", "SPHERE another") + "OUTPUT other.ppm\n").unwrap();
    for scene in ["scene.txt", "same.txt"] {
        for device in ["cpu", "gpu"] {
            let arguments = format!("verify --device {device} a.ppm --scene {scene} --certificate a.json");
            assert_run(
                path,
                &arguments,
                0,
                "certificate       of this scene, these settings and this picture; the rest of it is a claim",
            );
        }
    }
    std::fs::write(path.join("moved.txt"), SCENE.replace("3 5 0 0.8", "3 5.000000000000001 0 0.8")).unwrap();
    assert_run(
        path,
        &format!("{certified} -q --certificate exact.json --convention exact scene.txt -o exact.ppm"),
        0,
        "",
    );
    for (arguments, message) in [
        ("a.ppm --scene moved.txt --certificate a.json", "of something else: scene.sha256 is"),
        ("exact.ppm --scene scene.txt --certificate a.json", "of something else: picture.sha256 is"),
        // What was asked for, before what follows from it.
        ("a.ppm --scene scene.txt --certificate exact.json", "of something else: settings.quantize is \"round\" there"),
        ("exact.ppm --scene scene.txt --certificate a.json --convention exact", "of something else: settings.quantize"),
        (
            "a.ppm --scene scene.txt --certificate a.json --max-depth 2",
            "of something else: settings.max_depth is 3 there and 2 here",
        ),
        ("a.ppm --scene scene.txt --certificate a.json --effects=-shadows", "of something else: effects"),
        (
            "a.ppm --scene scene.txt --certificate a.json --projection orthographic",
            "of something else: settings.view.projection is none there and \"orthographic\" here",
        ),
    ] {
        assert_run(path, &format!("verify --device cpu {arguments}"), 1, message);
    }
    assert_run(
        path,
        "verify --device cpu a.ppm --scene scene.txt --certificate scene.txt",
        2,
        "the certificate scene.txt",
    );

    for (arguments, message) in [
        ("render --device gpu --certificate b.json scene.txt -o b.ppm", "needs a certified picture"),
        ("render --device cpu --certificate b.json scene.txt same.txt", "takes one scene"),
        ("render --precision certified --certificate b.json --sparse 0.5 scene.txt -o b.ppm", "whole pictures"),
        ("study --precision certified scene.txt", "is no tier"),
        ("bench --tune --precision certified", "is no tier"),
    ] {
        assert_run(path, arguments, 2, message);
    }
    assert_run(path, "render --device cpu --certificate scene.txt scene.txt -o b.ppm", 6, "would overwrite");
    assert!(!path.join("b.json").exists() && !path.join("b.ppm").exists());
}

//! Tunings: what they may change and what not, and how they are kept.

use std::path::{Path, PathBuf};

use trueray::accel::Density;
use trueray::bench::Family;
use trueray::effects::Effects;
use trueray::gpu::{DeviceKind, Gpu, GpuRenderer};
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::tuning::{Class, KNOBS, Tuning};

use crate::support::{driver_cache, gpu, scene, scene_files};

/// Each number at its least, and at its greatest; and some in between.
pub(crate) fn tunings() -> [Tuning; 5] {
    let class = Tuning::of(Class::Software);
    let ends = [0, 1].map(|end| {
        let mut tuning = class;
        for knob in &KNOBS {
            (knob.set)(&mut tuning, knob.limits[end]);
        }
        tuning
    });
    let density = Density { grid_cells: 0.3, light_entries: 1.0, ..class.density };
    let in_turn = Tuning { paths: 256, in_place_below: 0.0, in_turn_from: 0.0, texture_tables: false, ..class };
    let at_once = Tuning { workgroup: 256, in_place_below: 0.0, in_turn_from: 1e9, ..class };
    [ends[0], ends[1], Tuning { workgroup: 48, density, ..at_once }, in_turn, at_once]
}

fn render(gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings) -> Vec<u8> {
    let effects = Effects::of(&scene.viewed(settings));
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    assert!(
        GpuRenderer::new(gpu, &scene.viewed(settings), &effects, tier)
            .unwrap()
            .rows(0, &mut rgb)
            .unwrap()
            .cut
            .is_empty()
    );
    rgb
}

/// Scenes of every kind of kernel, each with its settings.
pub(crate) fn cases() -> Vec<(String, Scene, Settings)> {
    let small = |mut scene: Scene| {
        (scene.width, scene.height) = (70, 37);
        scene
    };
    let family = |name: &str, size| (format!("{name} {size}"), small(Family::named(name).unwrap().scene(size)));
    let file = scene_files(&["refraction"]).swap_remove(0);
    let glass = (file.display().to_string(), small(scene(&file)));
    let (classic, samples) =
        (Settings::classic(), Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() });
    [
        (family("classic", 5), samples),
        (family("ellipsoids", 100), classic),
        (family("mirrors", 1000), classic),
        (glass, classic),
    ]
    .map(|((name, scene), settings)| (name, scene, settings))
    .into()
}

#[test]
fn no_tuning_changes_a_byte() {
    let Some(mut gpu) = gpu("no_tuning_changes_a_byte") else { return };
    let own = gpu.tuned().tuning;
    for tier in Tier::ALL {
        if gpu.kernel(tier).is_err() {
            continue;
        }
        for (name, scene, settings) in cases() {
            gpu.set_tuning(Tuning::of(Class::Software)).unwrap();
            let expected = render(&gpu, tier, &scene, &settings);
            for mut tuning in tunings() {
                tuning.workgroup = tuning.workgroup.min(gpu.device.info.max_invocations);
                gpu.set_tuning(tuning).unwrap();
                let picture = render(&gpu, tier, &scene, &settings);
                let changed = picture.iter().zip(&expected).filter(|(a, b)| a != b).count();
                gpu.set_tuning(own).unwrap();
                assert_eq!(changed, 0, "{name} at {tier} with {tuning:?}");
            }
        }
    }
}

#[test]
fn numbers_out_of_their_limits_are_refused_by_name() {
    for class in [Class::Software, Class::Integrated, Class::Discrete] {
        let tuning = Tuning::of(class);
        assert_eq!(tuning.problem(), None);
        for knob in &KNOBS {
            for (value, is_valid) in [
                (knob.limits[0], true),
                (knob.limits[1], true),
                (knob.limits[0] - 1.0, false),
                (knob.limits[1] + 1.0, false),
            ] {
                // Whole numbers below 0 become 0.
                let mut changed = tuning;
                (knob.set)(&mut changed, value);
                let is_kept = (knob.get)(&changed) == value;
                let problem = changed.problem();
                assert_eq!(problem.is_none(), is_valid || !is_kept, "{} {value}: {problem:?}", knob.name);
                assert!(problem.is_none_or(|problem| problem.contains(knob.name)));
            }
            for &candidate in knob.candidates {
                let mut changed = tuning;
                (knob.set)(&mut changed, candidate);
                assert_eq!((knob.get)(&changed), candidate, "{}", knob.name);
                assert_eq!(changed.problem(), None, "{} {candidate}", knob.name);
            }
        }
    }
}

#[test]
fn classes_follow_from_the_type() {
    let of =
        [DeviceKind::Software, DeviceKind::Integrated, DeviceKind::Discrete, DeviceKind::Virtual, DeviceKind::Other]
            .map(DeviceKind::class);
    assert_eq!(of, [Class::Software, Class::Integrated, Class::Discrete, Class::Discrete, Class::Integrated]);
}

/// Runs the program with a cache folder of its own.
fn run(cache: &Path, ignore: bool, arguments: &str) -> (String, String, Option<i32>) {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(cache).env("XDG_CACHE_HOME", cache);
    command.env("MESA_SHADER_CACHE_DIR", driver_cache()).env_remove("TRUERAY_NO_TUNING");
    if ignore {
        command.env("TRUERAY_NO_TUNING", "1");
    }
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code())
}

#[test]
fn what_is_kept_is_used_and_said_or_refused_aloud() {
    let Some(gpu) = gpu("what_is_kept_is_used_and_said_or_refused_aloud") else { return };
    let (name, driver, index) = (gpu.device.info.name.clone(), gpu.device.info.driver.clone(), gpu.device.info.index);
    drop(gpu);
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path();
    let device = format!("--device {index}");

    // Measured as little as possible: what matters is the file.
    let tune = format!("bench --tune --runs 1 --max-spheres 5 --res 16x16 {device}");
    let (table, errors, code) = run(cache, false, &tune);
    assert_eq!(code, Some(0), "{errors}");
    for knob in &KNOBS {
        assert!(table.contains(knob.name), "{}: {table}", knob.name);
    }
    // There may be compiled kernels and records of self-tests beside it.
    let files = std::fs::read_dir(cache.join("trueray")).unwrap().map(|entry| entry.unwrap().path());
    let is_tuning = |file: &PathBuf| file.file_name().unwrap().to_string_lossy().starts_with("tuning-");
    let files: Vec<_> = files.filter(is_tuning).collect();
    let [file] = &files[..] else { panic!("{files:?}") };
    assert!(table.contains(&file.display().to_string()), "{table}");

    let text = |workgroup: &str, name: &str| {
        let mut tuning = serde_json::to_value(Tuning::of(Class::Software)).unwrap();
        tuning["workgroup"] = serde_json::from_str(workgroup).unwrap();
        serde_json::json!({ "device": name, "driver": driver, "tuning": tuning }).to_string()
    };
    let scene = cache.join("scene.txt");
    let small =
        "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 9 9\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n";
    std::fs::write(&scene, small).unwrap();
    let render = format!("render scene.txt -o out.ppm --explain {device}");

    std::fs::write(file, text("32", &name)).unwrap();
    let path = file.display().to_string();
    let (_, used, _) = run(cache, false, &render);
    assert!(used.contains("workgroup 32") && used.contains(&path), "{used}");
    let (listed, _, _) = run(cache, false, "devices");
    assert!(listed.contains("workgroup 32") && listed.contains(&path), "{listed}");
    let (_, ignored, _) = run(cache, true, &render);
    assert!(!ignored.contains("workgroup 32") && !ignored.contains(&path), "{ignored}");

    let foreign = text("32", "Another GPU");
    for (contents, why) in [
        ("not JSON", "expected"),
        ("", "EOF"),
        (text("0", &name).as_str(), "workgroup is 0"),
        (text("100000", &name).as_str(), "workgroup is 100000"),
        (text("-1", &name).as_str(), "-1"),
        (text("\"64\"", &name).as_str(), "string"),
        (foreign.as_str(), "Another GPU"),
        (text("32", &name).replace("dispatch_ms", "dispatch").as_str(), "dispatch"),
    ] {
        std::fs::write(file, contents).unwrap();
        for command in [&render, "devices"] {
            let (_, errors, code) = run(cache, false, command);
            assert_eq!(code, Some(0), "{errors}");
            assert!(errors.contains(&path) && errors.contains(why), "{contents}: {errors}");
            assert!(!errors.contains("workgroup 32"), "{errors}");
        }
    }
    let quiet = format!("render -q scene.txt -o out.ppm {device}");
    assert_eq!(run(cache, false, &quiet), (String::new(), String::new(), Some(0)));
    std::fs::remove_file(file).unwrap();
    std::fs::create_dir(file).unwrap();
    let (_, errors, code) = run(cache, false, &render);
    assert!(code == Some(0) && errors.contains(&path), "{errors}");
    // What cannot be mended by the program is told whoever asks, and nobody else.
    let plain = quiet.replace(" -q", "");
    assert!(!run(cache, false, &plain).1.contains(&path));
    let (_, errors, code) = run(cache, false, &tune);
    assert!(code == Some(6) && errors.contains(&path), "{errors}");
}

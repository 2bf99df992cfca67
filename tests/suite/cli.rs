//! The program as its users run it: exit codes, messages, files.

use std::process::{Command, Output, Stdio};

use crate::support::{Folder, assert_exit, driver_cache, gpu, say_skipped};

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 16 8\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\n\
                     AMBIENT 1 1 1\nBACK 0 0 1\nOUTPUT out.ppm\n";

/// Runs without any Vulkan driver.
fn run_without_driver(place: &Folder, arguments: &str) -> Output {
    let nowhere = place.path("no-driver.json");
    let mut command = place.command(arguments);
    command.env("VK_DRIVER_FILES", &nowhere).env("VK_ICD_FILENAMES", &nowhere).output().unwrap()
}

#[test]
fn one_argument_writes_output_into_the_working_directory() {
    let place = Folder::with_scene(SCENE);
    let folder = tempfile::tempdir().unwrap();
    let scene = place.folder().join("scene.txt");
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    let output = command.arg(&scene).current_dir(folder.path()).output().unwrap();
    assert_exit(&output, 0, "out.ppm: 16 × 8 on ");
    let picture = std::fs::read(folder.path().join("out.ppm")).unwrap();
    assert!(picture.starts_with(b"P6\n16 8\n255\n"));
    assert_eq!(picture.len(), 12 + 16 * 8 * 3);
    assert_eq!(place.files(), ["scene.txt"]);
}

/// Two rows of pixels a line, to their side the messages.
#[test]
fn a_picture_is_shown_in_the_terminal() {
    let place = Folder::with_scene(SCENE);
    let shown = stdout(place.run("render --device cpu scene.txt --show"));
    assert_eq!((shown.lines().count(), shown.matches('▀').count()), (4, 16 * 4), "{shown}");
    assert!(shown.starts_with("\x1b[38;2;0;0;255m\x1b[48;2;0;0;255m▀"), "{shown:?}");
    assert!(place.files().contains(&"out.ppm".to_owned()));
    assert_eq!(stdout(place.run("render --device cpu --show=blocks scene.txt")), shown);
    let sixels = stdout(place.run("render --device cpu --show=sixel scene.txt"));
    assert!(sixels.starts_with("\x1bP0;1;0q\"1;1;16;8#0;2;0;0;100") && sixels.ends_with("\x1b\\\n"), "{sixels:?}");
    assert!(stdout(place.run("render --device cpu --show=kitty scene.txt")).starts_with("\x1b_Ga=T,f=100,"));
    assert_exit(
        &place.run("render --device cpu --show=ascii scene.txt"),
        2,
        "possible values: auto, blocks, kitty, sixel",
    );
    assert_exit(&place.run("render --device cpu scene.txt -o - --show"), 2, "--show prints to standard output");
}

#[test]
fn without_output_the_scene_names_the_picture() {
    let place = Folder::with_scene(&SCENE.replace("OUTPUT out.ppm\n", ""));
    assert_exit(&place.run("render --device cpu scene.txt"), 0, "scene.ppm");
    assert_eq!(place.files(), ["scene.ppm", "scene.txt"]);
}

#[test]
fn renders_without_a_driver_on_the_reference_and_says_so() {
    let place = Folder::with_scene(SCENE);
    let output = run_without_driver(&place, "scene.txt");
    assert_exit(&output, 0, "rendering on the CPU reference: no Vulkan device");
    // Why there is none: the one driver that was asked for is not there.
    assert_exit(&output, 0, "no-driver.json");
    assert_exit(&output, 0, "on the CPU reference (f64)");
    assert_eq!(place.files(), ["out.ppm", "scene.txt"]);
}

#[test]
fn a_required_device_never_falls_back() {
    let place = Folder::with_scene(SCENE);
    assert_exit(&run_without_driver(&place, "render --device gpu scene.txt"), 4, "no-driver.json");
    assert_exit(&run_without_driver(&place, "render --device 0 scene.txt"), 4, "no-driver.json");
    assert_exit(&run_without_driver(&place, "devices"), 4, "`--device cpu` renders without any");
    assert_eq!(place.files(), ["scene.txt"]);
}

#[test]
fn a_device_that_is_not_there_lists_those_that_are() {
    let Some(gpu) = gpu("a_device_that_is_not_there_lists_those_that_are") else { return };
    let place = Folder::with_scene(SCENE);
    let name = &gpu.device.info.name;
    for arguments in ["render --device 99 scene.txt", "render --device no-such-device scene.txt"] {
        let output = place.run(arguments);
        assert_exit(&output, 4, "there are:\n  0: ");
        assert_exit(&output, 4, name);
    }
    let output = place.command("scene.txt").env("WGPU_ADAPTER_NAME", "no-such-device").output().unwrap();
    assert_exit(&output, 4, "WGPU_ADAPTER_NAME 'no-such-device' matches no Vulkan device; there are:");
    let output = place.command("scene.txt").env("WGPU_BACKEND", "gl").output().unwrap();
    assert_exit(&output, 4, "WGPU_BACKEND leaves out Vulkan");
    assert_eq!(place.files(), ["scene.txt"]);

    let list = place.run("devices --json");
    let list: serde_json::Value = serde_json::from_slice(&list.stdout).unwrap();
    assert_eq!(list[gpu.device.info.index]["name"], name.as_str());
    assert!(list[gpu.device.info.index]["f64"].is_boolean());
    assert_exit(&place.run(&format!("render --device {} scene.txt", gpu.device.info.index)), 0, name);
}

#[test]
fn cpu_and_gpu_write_the_same_simple_picture() {
    let Some(_gpu) = gpu("cpu_and_gpu_write_the_same_simple_picture") else { return };
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("render --device cpu -o cpu.ppm scene.txt"), 0, "");
    assert_exit(&place.run("render --device gpu -o gpu.ppm scene.txt"), 0, "");
    let [cpu, gpu] = ["cpu.ppm", "gpu.ppm"].map(|name| std::fs::read(place.folder().join(name)).unwrap());
    assert!(cpu == gpu);
    assert_exit(&place.run("compare cpu.ppm gpu.ppm"), 0, "");
    assert_exit(&place.run("compare --scene scene.txt gpu.ppm"), 0, "");
}

/// Every kind of bad input: exit code 3, a message that names the place, and no picture touched.
#[test]
fn bad_scenes_are_refused_and_touch_nothing() {
    let statement = |line: &str| format!("{SCENE}{line}\n");
    let cases = [
        (SCENE.replace("TOP 1", "TP 1"), "TOP"),
        (SCENE.replace("NEAR 1", "NEAR 1 1 1"), "NEAR"),
        (SCENE.replace("NEAR 1\n", ""), "NEAR"),
        (SCENE.replace("NEAR 1", "NEAR 0"), "NEAR"),
        (SCENE.replace("RIGHT 1", "RIGHT -1"), "RIGHT"),
        (SCENE.replace("RES 16 8", "RES 16 0"), "RES"),
        (SCENE.replace("RES 16 8", "RES 1.5 8"), "1.5"),
        (SCENE.replace("2 2 2", "2 0 2"), "0"),
        (SCENE.replace("2 2 2", "2 nan 2"), "nan"),
        (SCENE.replace("2 2 2", "2 inf 2"), "inf"),
        (SCENE.replace("2 2 2", "2 two 2"), "two"),
        (SCENE.replace("out.ppm", "folder/out.ppm"), "folder/out.ppm"),
        (statement("RES 4 4"), "RES"),
        (statement("CUBE c 0 0 0 1 1 1"), "CUBE"),
        (statement("SPHERE t 0 0 -5 1 1 1 1 1 1 1 1 1 50"), "Kr"),
        (statement("SPHERE t 0 0 -5 1 1 1 1 1 1 1 1 1 0 50 1 1 1 1"), "SPHERE"),
        ("\u{0}\u{1}\u{2}".into(), "scene.txt"),
        (String::new(), "NEAR"),
    ];
    for (scene, message) in cases {
        let place = Folder::with_scene(&scene);
        std::fs::write(place.folder().join("out.ppm"), "old").unwrap();
        let output = place.run("render --device cpu scene.txt");
        assert_exit(&output, 3, message);
        assert_exit(&output, 3, "scene.txt:");
        assert_eq!(std::fs::read(place.folder().join("out.ppm")).unwrap(), b"old");
        assert_eq!(place.files(), ["out.ppm", "scene.txt"]);
    }
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("nowhere.txt"), 3, "cannot read the scene nowhere.txt");
    assert_exit(&place.run("render --device cpu ."), 3, "cannot read the scene .");
}

#[test]
fn a_bad_scene_does_not_keep_the_others_from_being_rendered() {
    let place = Folder::with_scene(SCENE);
    std::fs::write(place.folder().join("bad.txt"), "NEAR").unwrap();
    assert_exit(&place.run("render --device cpu bad.txt scene.txt"), 3, "out.ppm: 16 × 8");
    assert_eq!(place.files(), ["bad.txt", "out.ppm", "scene.txt"]);
}

/// Where a sphere both mirrors and refracts, every bounce doubles the rays; a chain of them may be as deep as mirrors.
#[test]
fn a_tree_of_rays_that_never_ends_is_refused() {
    let glass = |kr: &str| SCENE.to_owned() + &format!("SPHERE t 0 0 -9 1 1 1 1 1 1 1 1 1 {kr} 50 0.5 1.5\n");
    let place = Folder::with_scene(&glass("0.1"));
    assert_exit(&place.run("render --device cpu --max-depth 33 scene.txt"), 2, "--max-depth 32 is the most");
    assert_eq!(place.files(), ["scene.txt"]);
    assert_exit(&place.run("render --device cpu --max-depth 32 scene.txt"), 0, "out.ppm");
    assert_exit(&Folder::with_scene(&glass("0")).run("render --device cpu --max-depth 1000 scene.txt"), 0, "out.ppm");
}

#[test]
fn wrong_arguments_are_usage_errors() {
    let place = Folder::with_scene(SCENE);
    for arguments in [
        "",
        "render",
        "render --res 0x5 scene.txt",
        "render --res 5 scene.txt",
        "render --effects fog scene.txt",
        "render --convention wrong scene.txt",
        "render --secondary-epsilon 2 scene.txt",
        "render --max-depth 99999 scene.txt",
        "render --format bmp scene.txt",
        "render -o a.ppm scene.txt scene.txt",
        "compare a.ppm",
        "compare --scene scene.txt --device cpu",
        "compare missing.ppm missing.ppm",
        "render --device cpu - -",
        "check - -",
        "study --device cpu - -",
    ] {
        assert_exit(&place.run(arguments), 2, "");
        assert_eq!(place.files(), ["scene.txt"], "{arguments}");
    }
}

#[test]
fn output_that_cannot_be_written_is_its_own_code() {
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("render --device cpu -o missing/out.ppm scene.txt"), 6, "missing/out.ppm");
    assert_exit(
        &place.run("render --device cpu -o scene.txt scene.txt"),
        6,
        "would overwrite scene.txt, an input of this run",
    );
    assert_eq!(std::fs::read_to_string(place.folder().join("scene.txt")).unwrap(), SCENE);
    assert_exit(&place.run("render --device cpu --stats-json missing/stats.json scene.txt"), 6, "missing/stats.json");
    assert_exit(&place.run("render --device cpu --timeline missing/t.json scene.txt"), 6, "missing/t.json");
}

#[test]
fn pictures_go_to_standard_output_in_every_format() {
    let place = Folder::with_scene(SCENE);
    for (format, magic) in [("p6", &b"P6\n16 8\n255\n"[..]), ("p3", b"P3\n16 8\n255\n"), ("png", b"\x89PNG\r\n")] {
        let output = place.run(&format!("render --device cpu --format {format} -o - scene.txt"));
        assert_exit(&output, 0, "standard output: 16 × 8");
        assert!(output.stdout.starts_with(magic));
    }
    assert_eq!(place.files(), ["scene.txt"]);
}

#[test]
fn a_scene_comes_from_standard_input() {
    let place = Folder::with_scene(SCENE);
    let file = std::fs::File::open(place.folder().join("scene.txt")).unwrap();
    let output = place.command("render --device cpu -q -").stdin(file).output().unwrap();
    assert_exit(&output, 0, "");
    assert!(output.stderr.is_empty());
    assert_eq!(place.files(), ["out.ppm", "scene.txt"]);
}

#[test]
fn stats_tell_device_effects_rays_and_times() {
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("render --device cpu --res 20x10 --stats-json stats.json scene.txt"), 0, "20 × 10");
    let stats = std::fs::read_to_string(place.folder().join("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
    let stats = &stats["pictures"][0];
    assert_eq!(stats["device"], "the CPU reference (f64)");
    assert_eq!(stats["effects"]["set"], serde_json::json!(["ambient"]));
    assert_eq!(stats["rays"]["primary"], 200);
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_mib"].as_f64().unwrap() > 1.0);
    }
    for time in ["parse_ms", "prepare_ms", "compile_ms", "render_ms", "read_back_ms", "write_ms", "total_ms"] {
        assert!(stats[time].is_f64(), "{time}");
    }
    assert_exit(&place.run("render --device cpu --stats-json stats.json --no-ray-counts scene.txt"), 0, "");
    assert!(std::fs::read_to_string(place.folder().join("stats.json")).unwrap().contains("\"rays\": null"));
    assert_exit(&place.run("render --device cpu --stats --explain scene.txt"), 0, "effects (depth 0)");
}

#[test]
fn a_timeline_has_every_step_from_begin_to_end() {
    let place = Folder::with_scene(SCENE);
    let steps = |device: &str| {
        assert_exit(&place.run(&format!("render --device {device} --timeline t.json scene.txt")), 0, "");
        let text = std::fs::read_to_string(place.folder().join("t.json")).unwrap();
        let events: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
        let of_phase = |phase: &str| {
            let events = events.iter().filter(|event| event["ph"] == phase);
            let mut names: Vec<_> = events.map(|event| event["name"].as_str().unwrap().to_owned()).collect();
            names.sort();
            names
        };
        assert_eq!(of_phase("B"), of_phase("E"));
        let name = |thread: &serde_json::Value| thread["args"]["name"].as_str().map(str::to_owned);
        assert!(events.iter().filter(|event| event["ph"] == "M").any(|thread| name(thread).is_some()));
        of_phase("B")
    };
    let assert_has = |steps: &[String], expected: &[&str]| {
        for step in expected {
            assert!(steps.iter().any(|own| own == step), "{step} in {steps:?}");
        }
    };
    let everywhere = ["read scene", "picture", "prepare", "write rows", "finish file"];
    let on_cpu = steps("cpu");
    assert_has(&on_cpu, &everywhere);
    assert_has(&on_cpu, &["trace by the reference"]);
    if gpu("a_timeline_has_every_step_from_begin_to_end").is_some() {
        let on_device = steps("gpu");
        assert_has(&on_device, &everywhere);
        let device = ["open device", "load drivers", "create device", "make lists", "upload tables", "parse shader"];
        assert_has(&on_device, &device);
        assert_has(&on_device, &["translate kernel", "compile kernel", "first dispatch", "dispatch", "read back"]);
    }
}

#[test]
fn check_summarises_without_rendering() {
    let place = Folder::with_scene(SCENE);
    let output = place.run("check scene.txt");
    assert_exit(&output, 0, "");
    let text = String::from_utf8(output.stdout).unwrap();
    for part in ["16 × 8, 1 sphere, 0 lights", "(-2, -2, -7) to (2, 2, -3)", "sphere 's' has Ka > 0", "no warnings"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    std::fs::write(place.folder().join("bad.txt"), SCENE.replace("TOP", "TP")).unwrap();
    let output = place.run("check --json scene.txt bad.txt");
    assert_exit(&output, 3, "");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&json[0]["ok"], &json[1]["ok"]), (&true.into(), &false.into()));
    assert_eq!(json[1]["messages"][0]["token"], "TP");
    assert_eq!(json[1]["messages"][0]["line"], 5);
    assert_eq!(place.files(), ["bad.txt", "scene.txt"]);
}

#[test]
fn compare_has_three_exit_codes_and_draws_its_findings() {
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("render --device cpu -q -o a.ppm scene.txt"), 0, "");
    assert_exit(&place.run("render --device cpu -q --effects none -o b.png scene.txt"), 0, "");
    assert_exit(&place.run("compare a.ppm a.ppm"), 0, "");
    let output = place.run("compare a.ppm b.png --heatmap heat.png --three-wide wide.ppm");
    assert_exit(&output, 1, "");
    assert!(String::from_utf8(output.stdout).unwrap().contains("verdict           different"));
    assert_exit(&place.run("compare a.ppm b.png --max-differing 1000"), 0, "");
    assert_exit(&place.run("compare a.ppm b.png --max-level 254"), 1, "");
    assert_exit(&place.run("compare a.ppm missing.ppm"), 2, "missing.ppm");
    let json = place.run("compare --json a.ppm b.png");
    assert_exit(&json, 1, "");
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["max_level"], 255);

    // A picture that is not the scene's is unexplained.
    let output = place.run("compare --scene scene.txt b.png");
    assert_exit(&output, 1, "");
    assert!(String::from_utf8(output.stdout).unwrap().contains("unexplained"));
    assert_exit(&place.run("compare --scene scene.txt a.ppm"), 0, "");
    assert_exit(&place.run("compare --scene scene.txt --res 9x9 a.ppm"), 2, "9 × 9");
    assert_eq!(place.files(), ["a.ppm", "b.png", "heat.png", "scene.txt", "wide.ppm"]);
}

#[test]
fn pictures_are_the_same_bytes_every_time() {
    let place = Folder::with_scene(SCENE);
    for format in ["p6", "p3", "png"] {
        let run = || place.run(&format!("render --format {format} -o - scene.txt")).stdout;
        assert!(run() == run(), "{format}");
    }
}

#[test]
fn stress_lists_judges_and_fails_where_a_promise_is_broken() {
    let place = Folder::with_scene(SCENE);
    let list = place.run("stress --list");
    assert_exit(&list, 0, "");
    assert!(String::from_utf8(list.stdout).unwrap().contains("terminator"));
    assert_exit(&place.run("stress --class no-such-class"), 2, "");
    assert_exit(&place.run("stress --precision exact"), 2, "");
    assert_exit(&run_without_driver(&place, "stress --count 100"), 4, "no Vulkan device");

    let Some(_gpu) = gpu("stress_lists_judges_and_fails_where_a_promise_is_broken") else { return };
    let output = place.run("stress --count 20000 --class far --precision fast --json");
    assert_exit(&output, 0, "");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["broken"], 0);
    assert_exit(&place.run("stress --count 20000 --class far --precision schoolbook"), 1, "");
}

/// 400 million pixels pass through a bounded buffer.
#[cfg(target_os = "linux")]
#[test]
fn a_huge_picture_needs_little_memory() {
    let place = Folder::with_scene(&SCENE.replace("RES 16 8", "RES 20000 20000"));
    let scene = place.folder().join("scene.txt");
    let small = peak_memory(place.command("render -q --res 8x8 -o /dev/null scene.txt"));
    let huge = peak_memory(place.command("render -q -o /dev/null scene.txt"));
    assert!(scene.exists());
    assert!(huge - small < 512 << 10, "{huge} KiB, {small} KiB of them for 8 × 8 pixels");
}

/// The greatest resident size of a successful run, in KiB.
#[cfg(target_os = "linux")]
fn peak_memory(mut command: Command) -> i64 {
    let mut child = command.spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        peak = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse().ok()).unwrap_or(0).max(peak);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    peak
}

/// A reader that has seen enough, as `head` has, is no reason to panic or to change the exit code.
#[test]
fn a_closed_pipe_is_no_panic() {
    let place = Folder::with_scene(SCENE);
    for arguments in ["check scene.txt", "--help", "stress --list", "compare --json scene.txt scene.txt"] {
        let mut child = place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"), "{arguments}");
        assert!(output.status.code().is_some_and(|code| code == 0 || code == 2), "{arguments}");
    }
}

/// Numbers beyond the range of a tier or of all of them: a reason, and no picture.
#[test]
fn scenes_beyond_the_range_of_numbers_are_refused() {
    let bright = SCENE.replace("1 0 0 1 0 0 0 1\n", "1 0 0 1e200 0 0 0 1\n");
    let too_bright = bright.replace("AMBIENT 1 1 1", "AMBIENT 1 1 1e150");
    let tiny = format!("{SCENE}SPHERE t 0 0 -5 1e-200 1 1 1 1 1 1 0 0 0 1\n");
    for (scene, reason) in [(&too_bright, "sphere 's'"), (&tiny, "sphere 't'")] {
        let place = Folder::with_scene(scene);
        let check = place.run("check scene.txt");
        assert_exit(&check, 3, "");
        assert!(String::from_utf8_lossy(&check.stdout).contains("the scene cannot be rendered"));
        for arguments in ["render scene.txt --device cpu", "scene.txt"] {
            let output = place.run(arguments);
            assert_exit(&output, 3, "the scene cannot be rendered");
            assert!(String::from_utf8_lossy(&output.stderr).contains(reason));
        }
        assert_eq!(place.files(), ["scene.txt"]);
    }
    let place = Folder::with_scene(&bright);
    assert_exit(&place.run("render scene.txt --device cpu -o c.ppm"), 0, "");
    if let Some(gpu) = gpu("scenes_beyond_the_range_of_numbers_are_refused") {
        assert_exit(&place.run("render scene.txt --precision fast -o f.ppm"), 4, "fast cannot render this scene");
        // Pairs of f32 have no greater range than one.
        let (code, files) = if gpu.device.info.f64 {
            (0, &["c.ppm", "d.ppm", "scene.txt"][..])
        } else {
            (4, &["c.ppm", "scene.txt"][..])
        };
        assert_exit(&place.run("render scene.txt --explain -o d.ppm"), code, "brightness");
        assert_eq!(place.files(), files);
    }
}

/// Caches are a convenience: where there is no place for them, nothing is said and nothing is left behind.
#[test]
fn a_cache_folder_that_cannot_be_used_is_no_news() {
    let Some(gpu) = gpu("a_cache_folder_that_cannot_be_used_is_no_news") else { return };
    let place = Folder::with_scene(SCENE);
    let run = |variables: &[(&str, &str)]| {
        let arguments = format!("render -q --precision robust --device {} scene.txt", gpu.device.info.index);
        let mut command = place.command(&arguments);
        command.env_remove("XDG_CACHE_HOME").env_remove("HOME").env("TRUERAY_KERNEL_CACHE", "1");
        // Mesa would have a cache of its own in the same folder.
        command.env("MESA_SHADER_CACHE_DIR", driver_cache());
        command.envs(variables.iter().copied()).output().unwrap()
    };
    for variables in [
        &[("HOME", "")][..],
        &[("HOME", ".")],
        &[("HOME", "folder")],
        &[("XDG_CACHE_HOME", "folder"), ("HOME", "folder")],
        &[("XDG_CACHE_HOME", ""), ("HOME", "folder")],
        // A file, or something in one, is no folder.
        &[("XDG_CACHE_HOME", "/dev/null")],
        &[("HOME", "/dev/null")],
    ] {
        let output = run(variables);
        assert_exit(&output, 0, "");
        assert!(output.stderr.is_empty(), "{variables:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(place.files(), ["out.ppm", "scene.txt"], "{variables:?}");
    }
}

/// A thread of which the system has none is no reason to panic: there are fewer, or it is said.
#[cfg(target_os = "linux")]
#[test]
fn few_threads_are_enough() {
    let place = Folder::with_scene(SCENE);
    let mut many = place.command("render --device cpu scene.txt");
    let start = std::time::Instant::now();
    assert_exit(&many.env("RAYON_NUM_THREADS", "100000").output().unwrap(), 0, "out.ppm");
    assert!(start.elapsed().as_secs() < 30);

    // The system's limit is for users, not for root: another user's command of the same program, with as few threads as this.
    let folder = place.folder().join("nobody");
    let program = place.folder().join("program");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("scene.txt"), SCENE).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_trueray"), &program).unwrap();
    for path in [place.folder(), &folder] {
        std::fs::set_permissions(path, std::os::unix::fs::PermissionsExt::from_mode(0o777)).unwrap();
    }
    let limited = |threads: u32, arguments: &str| {
        let mut command = Command::new("setpriv");
        command.args(["--reuid=54321", "--regid=54321", "--clear-groups", "prlimit", &format!("--nproc={threads}")]);
        command.arg(&program).args(arguments.split_whitespace()).current_dir(&folder).stdin(Stdio::null());
        command.env("HOME", "/").output()
    };
    let can = limited(100, "check scene.txt").is_ok_and(|output| output.status.success());
    if !can {
        return say_skipped("few_threads_are_enough", "this user cannot be limited");
    }
    for threads in 1..8 {
        let output = limited(threads, "render --device cpu scene.txt").unwrap();
        assert_exit(&output, 0, "out.ppm");
        let output = limited(threads, "render scene.txt").unwrap();
        let Some(code) = output.status.code() else {
            // SwiftShader aborts where it gets no thread.
            let gpu = gpu("few_threads_are_enough").unwrap();
            assert!(gpu.device.info.driver.contains("SwiftShader"), "{threads} threads: {output:?}");
            continue;
        };
        assert!(code == 0 || code == 7, "{threads} threads");
        assert_exit(&output, code, if code == 0 { "out.ppm" } else { "the system refuses threads" });
    }
    assert_exit(&limited(1, "view --device cpu scene.txt").unwrap(), 7, "the system gives no thread");
}

#[test]
fn the_shader_of_a_scene_can_be_read() {
    if gpu("the_shader_of_a_scene_can_be_read").is_none() {
        return;
    }
    let place = Folder::with_scene(SCENE);
    let printed = |arguments: &str| {
        let output = place.run(&format!("shader scene.txt {arguments}"));
        assert_exit(&output, 0, "");
        String::from_utf8(output.stdout).unwrap()
    };
    let names = |text: &str| {
        let module = naga::front::wgsl::parse_str(text).unwrap();
        module.entry_points.into_iter().map(|entry| entry.name).collect::<Vec<_>>()
    };
    let text = printed("");
    assert!(text.starts_with("// trace_tiles, the kernel of scene.txt at "), "{text}");
    assert!(text.contains("\n// ==== shaders/slots_tiles.wgsl, slot `slots` ====\n"), "{text}");
    // The scene has one sphere, ambient light alone and no mirror.
    assert!(text.contains("// AMBIENT = 1\n// DIFFUSE = 0\n"), "{text}");
    assert_eq!(names(&text), ["trace_tiles"]);
    assert_eq!(names(&printed("--spp 4 --entry resolve")), ["resolve"]);
    assert_eq!(names(&printed("--sparse 0.5")), ["trace_samples"]);
    // Each tier has its own.
    let fast = printed("--precision fast");
    assert!(fast.contains("shaders/real_f32.wgsl") && fast.contains("shaders/kernel_plain.wgsl"), "{fast}");
    assert!(printed("--precision robust").contains("shaders/kernel_robust.wgsl"));

    let text = printed("--spirv");
    assert!(text.starts_with("; trace_tiles, the kernel of scene.txt at "), "{text}");
    assert!(text.contains("OpEntryPoint GLCompute") && text.contains("NoContraction"), "{text}");
    assert!(!text.contains("OpFunctionCall"), "{text}");
}

#[test]
fn a_shader_that_is_not_there_is_refused_with_those_that_are() {
    let place = Folder::with_scene(SCENE);
    assert_exit(&place.run("shader --device cpu scene.txt"), 2, "the CPU reference runs no shader");
    assert_exit(&run_without_driver(&place, "shader scene.txt"), 4, "");
    assert_exit(&place.run("shader missing.txt"), 3, "cannot read the scene missing.txt");
    if gpu("a_shader_that_is_not_there_is_refused_with_those_that_are").is_some() {
        let message = "this picture has no kernel `walk_paths`\n  help: it has trace_tiles, resolve";
        assert_exit(&place.run("shader --spp 4 --entry walk_paths scene.txt"), 2, message);
    }
}

fn stdout(output: Output) -> String {
    assert_exit(&output, 0, "");
    String::from_utf8(output.stdout).unwrap()
}

/// The commands that `--help` lists.
fn commands(place: &Folder) -> Vec<String> {
    let help = stdout(place.run("--help"));
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = lines.map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

/// Whether every option of an example is there and has a value of its kind: `--help` at its end is what is carried out.
#[test]
fn each_command_has_two_examples_that_are_understood() {
    let place = Folder::with_scene(SCENE);
    let commands = commands(&place);
    assert!(commands.len() > 8, "{commands:?}");
    for command in commands {
        let help = stdout(place.run(&format!("{command} --help")));
        let examples = help.lines().skip_while(|line| *line != "Examples:").skip(1).take_while(|line| !line.is_empty());
        let examples: Vec<_> = examples.map(str::trim).collect();
        assert_eq!(examples.len(), 2, "{command}: {help}");
        for example in examples {
            let arguments = example.strip_prefix("trueray ").unwrap().split(" > ").next().unwrap();
            assert!(arguments.split(' ').next() == Some(command.as_str()), "{example}");
            assert!(stdout(place.run(&format!("{arguments} --help"))) == help, "{example}");
        }
    }
}

/// Nothing is left for the group without a subject but what every program has.
#[test]
fn options_stand_in_groups() {
    let place = Folder::with_scene(SCENE);
    let groups = |command: &str| {
        let help = stdout(place.run(&format!("{command} -h")));
        let mut groups: Vec<(String, Vec<String>)> = Vec::new();
        for line in help.lines().take_while(|line| *line != "Examples:") {
            if let Some(heading) = line.strip_suffix(':').filter(|line| !line.starts_with(' ')) {
                groups.push((heading.to_owned(), Vec::new()));
            } else if let (Some((_, options)), Some(at)) = (groups.last_mut(), line.find("--")) {
                options.push(line[at + 2..].split([' ', '=']).next().unwrap().to_owned());
            }
        }
        groups
    };
    let render = groups("render");
    let headings: Vec<_> = render.iter().map(|(heading, _)| heading.as_str()).collect();
    let expected = ["Options", "Scene", "Picture", "Camera", "Particles", "Sampling", "Device", "Output"];
    assert_eq!(headings, expected);
    for (heading, option) in
        [(2, "res"), (3, "eye"), (4, "radius"), (5, "foveate"), (6, "device"), (7, "output"), (7, "color")]
    {
        assert!(render[heading].1.iter().any(|other| other == option), "{option}: {render:?}");
    }
    for command in commands(&place) {
        let groups = groups(&command);
        let options = &groups.iter().find(|(heading, _)| heading == "Options").unwrap().1;
        assert_eq!(options, &["help"], "{command}");
    }
}

/// Without any driver: no device is looked for.
#[test]
fn the_version_is_short_and_long() {
    let place = Folder::with_scene(SCENE);
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(stdout(run_without_driver(&place, "-V")), format!("trueray {version}\n"));
    let long = stdout(run_without_driver(&place, "--version"));
    assert!(long.starts_with(&format!("trueray {version}\ncommit ")), "{long}");
    for part in [std::env::consts::OS, std::env::consts::ARCH, "features "] {
        assert!(long.contains(part), "{part} in {long}");
    }
}

#[test]
fn completions_know_every_command_in_every_shell() {
    let place = Folder::with_scene(SCENE);
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = stdout(run_without_driver(&place, &format!("completions {shell}")));
        for command in commands(&place) {
            assert!(script.contains(&command), "{command} for {shell}");
        }
        assert!(script.contains("look-at"), "{shell}");
    }
    assert_exit(&place.run("completions tcsh"), 2, "tcsh");
}

#[test]
fn every_command_has_a_manual_page() {
    let place = Folder::with_scene(SCENE);
    let page = stdout(run_without_driver(&place, "man"));
    assert!(page.contains(".TH trueray 1") && page.contains("Exit codes"), "{page}");
    for command in commands(&place) {
        assert!(page.contains(&format!("trueray\\-{command}(1)")), "{command} in {page}");
        let page = stdout(run_without_driver(&place, &format!("man {command}")));
        assert!(page.contains(&format!(".TH trueray-{command} 1")) && page.contains("Examples:"), "{page}");
    }
    let version = stdout(run_without_driver(&place, "--version"));
    let (_, last) = page.split_once(".SH VERSION\n").unwrap();
    assert!(last.starts_with(".nf\n") && last.lines().count() == 1 + version.lines().count(), "{last}");
    assert_exit(&place.run("man walk"), 2, "there is no command `walk`");
}

/// Whoever keeps the help in a file has to know that it is not there.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_on_the_disk_is_no_success() {
    let place = Folder::with_scene(SCENE);
    let run = |arguments: &str| {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        place.command(arguments).stdout(full).output().unwrap()
    };
    for arguments in ["--help", "-h", "render --help", "--version", "man", "check scene.txt"] {
        assert_exit(&run(arguments), 6, "cannot write standard output");
    }
    assert_exit(&run("--no-such-option"), 2, "--no-such-option");
}

/// `--device cpu` is a way out where it is one.
#[test]
fn only_commands_that_take_the_reference_advise_it() {
    let place = Folder::with_scene(SCENE);
    let help = "help: `--device cpu` renders without any";
    for arguments in ["render --device gpu scene.txt", "study --device gpu scene.txt", "bench --device gpu", "devices"]
    {
        assert_exit(&run_without_driver(&place, arguments), 4, help);
    }
    for arguments in ["stress", "shader scene.txt", "bench --tune", "compare --scene scene.txt"] {
        let code = if arguments.starts_with("compare") { 2 } else { 4 };
        let output = run_without_driver(&place, arguments);
        assert_exit(&output, code, "no Vulkan device");
        assert!(!String::from_utf8_lossy(&output.stderr).contains("--device cpu"), "{arguments}");
    }
}

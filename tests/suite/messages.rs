//! What the program says in words: of files that are no scenes, of commands mistyped, of names that would fool a terminal.

use std::io::Write as _;
use std::process::{Command, Output, Stdio};

use crate::support::{Folder, gpu};

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 16 16\nSPHERE s 0 0 -5.5 1.9 2 2 1 0.5 0.3 1 0 0 0 1\n\
                     AMBIENT 0.9 0.9 0.9\nBACK 0 0 1\nOUTPUT out.ppm\n";

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
}

#[track_caller]
fn assert_exit(output: &Output, code: i32, message: &str) {
    let said = said(output);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(message), "expected '{message}' in:\n{said}");
    assert!(!said.contains("panicked"), "{said}");
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn what_is_no_scene_is_named_in_one_line() {
    let kinds: [(&str, &[u8], &str); 9] = [
        ("a.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a PNG picture"),
        ("a.jpg", b"\xff\xd8\xff\xe0", "a JPEG picture"),
        ("a.bmp", b"BM6\x30\0\0\0\0\0\0", "a BMP picture"),
        ("a.ppm", b"P3\n2 2\n255\n0 0 0", "a PPM picture"),
        ("a.pgm", b"P5 2 2 255\n", "a PGM picture"),
        ("a.pdf", b"%PDF-1.7", "a PDF document"),
        ("a.out", b"\x7fELF\x02\x01", "a program"),
        ("a.zip", b"PK\x03\x04", "a ZIP archive or an office document"),
        ("a.bin", b"NEAR 1\n\0\0", "binary data"),
    ];
    let place = Folder::with(&kinds.map(|(name, contents, _)| (name, contents)));
    std::fs::create_dir(place.folder().join("folder")).unwrap();
    for (name, _, kind) in kinds {
        for command in ["", "check ", "render --device cpu "] {
            let output = place.run(&format!("{command}{name}"));
            assert_exit(&output, 3, "");
            assert_eq!(said(&output), format!("trueray: {name}: this is {kind}, not a scene\n"));
        }
    }
    assert_exit(&place.run("folder"), 3, "trueray: cannot read the scene folder: that is a folder\n");
    let unread = place.run("check --json a.png");
    assert_exit(&unread, 3, "");
    assert_eq!(json(&unread)[0]["unread"], "a.png: this is a PNG picture, not a scene");
    // Text that begins alike is only a scene with an error.
    for text in ["P3X 1\n", "BMX 1\n", "MZ1\n"] {
        let place = Folder::with(&[("scene.txt", text.as_bytes())]);
        assert_exit(&place.run("check scene.txt"), 3, "unknown keyword");
    }
}

#[test]
fn a_mistyped_command_renders_nothing() {
    let place = Folder::with(&[("scene.txt", SCENE.as_bytes()), ("rendr", SCENE.as_bytes())]);
    for (word, command) in
        [("chek", "check"), ("Check", "check"), ("comapre", "compare"), ("rneder", "render"), ("stres", "stress")]
    {
        let output = place.run(&format!("{word} scene.txt"));
        assert_exit(
            &output,
            2,
            &format!("there is no file `{word}` and no command of that name; did you mean `{command}`?"),
        );
    }
    assert_exit(&place.run("chek"), 2, "did you mean `check`?");
    assert_exit(&place.run("-q check scene.txt"), 2, "options follow the command: write `trueray check …`");
    assert_eq!(place.files(), ["rendr", "scene.txt"]);
    // What resembles no command is a file that is missing, and a file is a file.
    assert_exit(&place.run("homework.txt"), 3, "cannot read the scene homework.txt");
    assert_exit(&place.run("--device cpu rendr"), 0, "");
}

#[test]
fn doubts_are_warnings_of_check_and_render() {
    let behind = SCENE.replace("0 0 -5.5", "0 0 5");
    let place = Folder::with(&[("scene.txt", SCENE.as_bytes()), ("behind.txt", behind.as_bytes())]);
    let warning = "trueray: behind.txt: warning: nothing can be seen: every sphere is behind the eye";
    let output = place.run("check behind.txt");
    assert_exit(&output, 0, warning);
    assert_exit(&output, 0, "  1 warning\n");
    let summary = json(&place.run("check --json behind.txt"));
    assert_eq!(summary[0]["warnings"], 1);
    assert!(summary[0]["doubts"][0].as_str().unwrap().starts_with("nothing can be seen"));
    assert_exit(&place.run("render --device cpu behind.txt"), 0, warning);
    assert_eq!(said(&place.run("render --device cpu -q behind.txt")), "");
    let output = place.run("check --res 32x20 scene.txt");
    assert_exit(&output, 0, "--res 32x20 distorts the picture: the scene's is 16 × 16; 32x32 keeps its shape");
    let good = place.run("render --device cpu --res 32x32 scene.txt");
    assert_exit(&good, 0, "");
    assert!(!said(&good).contains("warning"));
    assert_exit(&place.run("check scene.txt"), 0, "(-1.9, -2, -7.5) to (1.9, 2, -3.5)");
}

#[test]
fn check_doubts_a_name_that_render_refuses() {
    let place = Folder::with(&[("scene.txt", SCENE.replace("out.ppm", ".hidden.ppm").as_bytes())]);
    let why = "OUTPUT would write `.hidden.ppm`, a hidden file";
    assert_exit(&place.run("check scene.txt"), 0, &format!("warning: without -o there is no picture: {why}\n"));
    assert_exit(&place.run("render --device cpu scene.txt"), 6, why);
    std::fs::write(place.folder().join("scene.txt"), SCENE.replace("out.ppm", "out.jpg")).unwrap();
    let why = "warning: without -o there is no picture: out.jpg: pictures are written as .ppm, .png, .pfm or .exr";
    assert_exit(&place.run("check scene.txt"), 0, why);
    // File systems take 255 bytes, however many letters these are.
    for (letters, fits) in [(250, true), (252, false)] {
        let name = format!("ä{}.ppm", "n".repeat(letters - 1));
        std::fs::write(place.folder().join("scene.txt"), SCENE.replace("out.ppm", &name)).unwrap();
        let why = if fits { "" } else { "its name has 257 bytes, and file systems take 255" };
        let checked = place.run("check scene.txt");
        assert_exit(&checked, 0, why);
        assert_eq!(said(&checked).contains("there is no picture"), !fits);
        assert_exit(&place.run("render --device cpu scene.txt"), if fits { 0 } else { 6 }, why);
    }
}

#[test]
fn a_comparison_says_why_it_looks_at_no_device() {
    let place = Folder::with(&[("scene.txt", SCENE.as_bytes())]);
    assert_exit(&place.run("render --device cpu scene.txt"), 0, "");
    let compare = |device| {
        let mut command = place.command_of(["compare", "--scene", "scene.txt", "--device", device, "out.ppm"]);
        command.env("VK_DRIVER_FILES", place.folder().join("none.json")).output().unwrap()
    };
    assert_exit(&compare("auto"), 0, "judged as a picture of hardware, since no device can be used here: no Vulkan");
    assert!(!said(&compare("cpu")).contains("Vulkan"));
}

#[test]
fn patience_is_a_number_of_seconds() {
    let place = Folder::with(&[("scene.txt", SCENE.as_bytes())]);
    for patience in ["soon", "-1", "0", ""] {
        let output = place.command_of(["check", "scene.txt"]).env("TRUERAY_PATIENCE", patience).output().unwrap();
        assert_exit(&output, 2, "TRUERAY_PATIENCE is ");
    }
}

/// An escape that sets the window's title, a bell, marks of the direction of writing and of nothing.
const HOSTILE: &str = "a\u{1b}]0;PWN\u{7}\u{202e}\u{2066}\u{61c}\u{200b}\u{9b}b";

#[track_caller]
fn assert_harmless(output: &Output) {
    let said = said(output);
    let is_harmless = |c: char| c == '\n' || !(c.is_control() || "\u{202e}\u{2066}\u{61c}\u{200b}".contains(c));
    assert!(said.chars().all(is_harmless), "{said:?}");
    assert!(said.contains("␛]0;PWN␇\\u{202e}\\u{2066}\\u{61c}\\u{200b}\\u{9b}"), "{said}");
}

#[cfg(unix)]
#[test]
fn no_name_is_obeyed_by_a_terminal() {
    let named =
        |sphere: &str| SCENE.replace("SPHERE s", &format!("SPHERE {sphere}")).replace("1 0 0 0 1\n", "1 1 1 1 1\n");
    let light = format!("LIGHT {HOSTILE} 1 2 3 1 1 1\n");
    let scene = named(HOSTILE) + &light + &format!("SPHERE {HOSTILE} 0 1 -4 1 1 1 1 1 1 0 1 1 1 1\n");
    let place = Folder::with(&[("scene.txt", scene.as_bytes()), ("good.txt", SCENE.as_bytes())]);
    let file = format!("{HOSTILE}.txt");
    std::fs::write(place.folder().join(&file), &scene).unwrap();
    let picture = format!("{HOSTILE}.ppm");
    let run = |arguments: &[&str]| place.command_of(arguments).output().unwrap();
    for arguments in [
        &["check", "scene.txt"][..],
        &["check", &file],
        &["render", "--device", "cpu", "--explain", "scene.txt"],
        &["render", "--device", "cpu", "-v", &file],
        &["render", "--device", "cpu", "good.txt", "-o", &picture],
        &["render", "--device", "cpu", "good.txt", "-o", &format!("none/{picture}")],
        &["export", "scene.txt", "--to", "tachyon"],
        &["compare", &picture, &picture],
        &["compare", &file, &picture],
        &["compare", "--lenient", &format!("no{file}"), &picture],
        &[&format!("no{file}")],
    ] {
        assert_harmless(&run(arguments));
    }
    // JSON has the names as they are, escaped in its own way.
    let summary = json(&run(&["check", "--json", &file]));
    assert_eq!(summary[0]["scene"], file.as_str());
}

#[test]
fn colour_is_a_choice() {
    let place = Folder::with(&[("bad.txt", b"NEAR x\n")]);
    let is_coloured = |output: Output| {
        assert_exit(&output, 3, "");
        said(&output).contains('\u{1b}')
    };
    assert!(!is_coloured(place.run("check bad.txt")), "no terminal");
    assert!(is_coloured(place.run("check --color always bad.txt")));
    assert!(is_coloured(place.run("--color=always bad.txt")));
    assert!(is_coloured(place.run("--color always check bad.txt")), "before the command");
    assert!(is_coloured(place.run("--color=never --color=always check bad.txt")));
    assert!(!is_coloured(place.run("--color never check bad.txt")));
    assert_exit(&place.run("--color sometimes bad.txt"), 2, "sometimes");
    assert!(!is_coloured(place.run("check --color never bad.txt")));
    let coloured = place.command_of(["check", "--color", "always", "bad.txt"]).env("NO_COLOR", "1").output().unwrap();
    assert!(is_coloured(coloured), "what is asked for outweighs the environment");
    assert_exit(&place.run("check --color sometimes bad.txt"), 2, "");
    assert!(said(&place.run("check --color always")).contains('\u{1b}'), "clap's own errors");
}

/// A terminal, as `script` gives one.
#[cfg(target_os = "linux")]
#[test]
fn colour_needs_a_terminal_that_wants_it() {
    let place = Folder::with(&[("bad.txt", b"NEAR x\n")]);
    let run = |variable: &str, value: &str| {
        let line = format!("{} check bad.txt", env!("CARGO_BIN_EXE_trueray"));
        let mut command = Command::new("script");
        command.args(["-qec", &line, "/dev/null"]).current_dir(place.folder()).stdin(Stdio::null());
        command.env_remove("NO_COLOR").env("TERM", "xterm").env(variable, value);
        command.output().ok().map(|output| said(&output).contains('\u{1b}'))
    };
    if run("A", "b").is_none() {
        crate::support::say_skipped("colour_needs_a_terminal_that_wants_it", "no `script`");
        return;
    }
    assert_eq!(run("A", "b"), Some(true));
    assert_eq!(run("NO_COLOR", "1"), Some(false));
    assert_eq!(run("NO_COLOR", ""), Some(true), "empty is not set");
    assert_eq!(run("TERM", "dumb"), Some(false));
}

#[test]
fn compare_reads_standard_input() {
    let place = Folder::with(&[
        ("a.ppm", b"P6\n1 1\n255\nabc"),
        ("b.ppm", b"P6\n1 1\n255\nabd"),
        ("scene.txt", SCENE.as_bytes()),
    ]);
    let piped = |arguments: &str| {
        let arguments: Vec<_> = arguments.split_whitespace().collect();
        let mut command = place.command_of(arguments);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Nobody reads it where the arguments are refused.
        let _ = child.stdin.take().unwrap().write_all(b"P6\n1 1\n255\nabc");
        child.wait_with_output().unwrap()
    };
    assert_exit(&piped("compare - a.ppm"), 0, "A                 standard input\n");
    assert_exit(&piped("compare a.ppm -"), 0, "B                 standard input\n");
    assert_exit(&piped("compare - b.ppm"), 1, "different");
    assert_exit(&piped("compare - -"), 2, "only one of the pictures can be standard input");
    assert_exit(
        &piped("compare --scene scene.txt --device cpu -"),
        2,
        "standard input has 1 × 1 pixels, the scene 16 × 16",
    );
    assert_exit(&piped("compare --scene scene.txt --res 1x1 --device cpu -"), 1, "unexplained");
}

#[test]
fn troubles_of_compare_are_json_where_that_is_asked_for() {
    let place =
        Folder::with(&[("a.ppm", b"P6\n1 1\n255\nabc"), ("b.ppm", b"P6\n2 1\n255\nabcdef"), ("bad.txt", b"NEAR x\n")]);
    for (arguments, error) in [
        ("a.ppm none.ppm", "none.ppm: "),
        ("a.ppm b.ppm", "the pictures differ in size: A is 1x1, B is 2x1"),
        ("a.ppm bad.txt", "bad.txt: no known picture format"),
        ("a.ppm", "compare takes two pictures"),
        ("--scene bad.txt a.ppm", "`x` is not a number"),
        ("--scene none.txt a.ppm", "cannot read the scene none.txt"),
    ] {
        let output = place.run(&format!("compare --json {arguments}"));
        assert_exit(&output, 2, "");
        let json = json(&output);
        assert_eq!(json["verdict"], "trouble");
        assert!(json["error"].as_str().unwrap().contains(error), "{json}");
        assert!(output.stderr.is_empty(), "{}", said(&output));
    }
    std::fs::write(place.folder().join("long.ppm"), b"P6\n1 1\n255\nabcd").unwrap();
    let output = place.run("compare --json --lenient a.ppm long.ppm");
    assert_exit(&output, 0, "");
    assert_eq!(json(&output)["warnings"][0], "B: data after the last sample, ignored: 1 byte");
    assert!(output.stderr.is_empty());
}

#[test]
fn the_heat_map_comes_with_its_legend() {
    let place = Folder::with(&[("a.ppm", b"P6\n2 1\n255\nabcdef"), ("b.ppm", b"P6\n2 1\n255\nabddez")]);
    let output = place.run("compare a.ppm b.ppm --heatmap heat.png");
    assert_exit(&output, 1, "heat map          1 level: purple (1 pixel)\n");
    assert_exit(&output, 1, "                  11 to 50 levels: amber (1 pixel)\n");
    let json = json(&place.run("compare --json a.ppm b.ppm --three-wide wide.ppm"));
    assert_eq!((&json["heat_map"][0]["pixels"], &json["heat_map"][0]["color"][0]), (&1.into(), &120.into()));
    assert!(!said(&place.run("compare a.ppm b.ppm")).contains("heat map"));
}

/// Half a megabyte that stands for twelve gigabytes, beside a picture of one pixel and beside itself.
#[test]
fn a_vast_picture_is_refused_by_its_header() {
    let mut bomb = Vec::new();
    let mut encoder = png::Encoder::new(&mut bomb, 65528, 65535);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, &vec![0; 600_000]).unwrap();
    let place = Folder::with(&[("a.ppm", b"P6\n1 1\n255\nabc"), ("bomb.png", &bomb)]);
    for pictures in ["bomb.png a.ppm", "a.ppm bomb.png", "bomb.png bomb.png"] {
        let output = place.run(&format!("compare --lenient {pictures}"));
        assert_exit(&output, 2, "the header promises 65528x65535 pixels; at most 1073741824 are read");
    }
}

#[test]
fn statistics_have_one_shape() {
    let other = SCENE.replace("OUTPUT ", "OUTPUT other-");
    assert_ne!(other, SCENE);
    let place = Folder::with(&[("a.txt", SCENE.as_bytes()), ("b.txt", other.as_bytes())]);
    for (scenes, count) in [("a.txt", 1), ("a.txt b.txt", 2), ("none.txt", 0)] {
        std::fs::create_dir_all(place.folder().join("out")).unwrap();
        place.run(&format!("render --device cpu --stats-json stats.json -o out {scenes}"));
        let stats = std::fs::read(place.folder().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
        assert_eq!(stats["pictures"].as_array().unwrap().len(), count, "{scenes}");
    }
}

#[test]
fn another_template_of_the_assignment_scales_by_255_9() {
    let place = Folder::with(&[("scene.txt", SCENE.as_bytes())]);
    assert_exit(&place.run("render --device cpu -q -o 255.ppm scene.txt"), 0, "");
    assert_exit(&place.run("render --device cpu -q --quantize 255.9 -o 2559.ppm scene.txt"), 0, "");
    let [a, b] = ["255.ppm", "2559.ppm"].map(|name| std::fs::read(place.folder().join(name)).unwrap());
    // The sphere is 0.9 · (1, 0.5, 0.3): 229.5, 114.75 and 68.85 of 255, 230.31, 115.155 and 69.093 of 255.9.
    let middle = 13 + (8 * 16 + 8) * 3;
    assert_eq!((&a[middle..middle + 3], &b[middle..middle + 3]), (&[229, 114, 68][..], &[230, 115, 69][..]));
    assert_exit(&place.run("compare --scene scene.txt --device cpu --quantize 255.9 2559.ppm"), 0, "");
    assert_exit(&place.run("compare --scene scene.txt --device cpu 2559.ppm"), 1, "");
    if gpu("another_template_of_the_assignment_scales_by_255_9").is_some() {
        for tier in ["fast", "robust", "double"] {
            let render = format!("render --device gpu --precision {tier} -q --quantize 255.9 -o gpu.ppm scene.txt");
            assert_exit(&place.run(&render), 0, "");
            assert!(std::fs::read(place.folder().join("gpu.ppm")).unwrap() == b, "{tier}");
        }
    }
}

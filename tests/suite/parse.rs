//! The scene parser: what it reads, what it refuses and in which words.

use std::fmt::Write;

use proptest::prelude::*;
use trueray::scene::{Diagnostic, MAX_RESOLUTION, Parsed, Scene, Severity, Window, parse};

use crate::support::scene_files;

/// Everything that has no default, in lines 1 to 6.
const REQUIRED: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 4 3\n";

const SPHERE: &str = "SPHERE s 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 0 50";

/// [`REQUIRED`] with `line` in the place of the line of the same keyword, else at the end as line 7.
fn scene_with(line: &str) -> String {
    let keyword = |line: &str| line.split_whitespace().next().unwrap_or_default().to_owned();
    let mut lines: Vec<&str> = REQUIRED.lines().collect();
    match lines.iter().position(|&old| keyword(old) == keyword(line)) {
        Some(index) => lines[index] = line,
        None => lines.push(line),
    }
    lines.join("\n")
}

fn read(text: impl AsRef<[u8]>) -> Parsed {
    parse("scene.txt", text.as_ref())
}

/// The scene of a text in which nothing is wrong or unusual.
#[track_caller]
fn scene(text: impl AsRef<[u8]>) -> Scene {
    let parsed = read(text);
    assert_eq!(parsed.diagnostics, []);
    parsed.scene.unwrap()
}

/// The only diagnostic of a text.
#[track_caller]
fn only(text: impl AsRef<[u8]>) -> Diagnostic {
    let mut parsed = read(text);
    assert_eq!(parsed.diagnostics.len(), 1, "{}", parsed.report(false));
    parsed.diagnostics.remove(0)
}

fn places(parsed: &Parsed) -> Vec<(usize, usize, &str)> {
    parsed.diagnostics.iter().map(|found| (found.line, found.column, found.token.as_str())).collect()
}

#[test]
fn a_classic_scene_is_read_as_written() {
    let text =
        format!("{REQUIRED}{SPHERE}\nLIGHT l -30 3e1 +.5 0.7 1.6 0\nBACK 1 0.5 0\nAMBIENT 0.2 0.3 2\nOUTPUT a.ppm\n");
    let scene = scene(&text);
    assert_eq!(scene.window, Window { near: 1.0, left: -1.0, right: 1.0, bottom: -1.0, top: 1.0 });
    assert_eq!((scene.width, scene.height), (4, 3));
    let [sphere] = scene.spheres[..] else { panic!("{:?}", scene.spheres) };
    assert_eq!(sphere.center.to_array(), [0.0, 0.0, -10.0]);
    assert_eq!(sphere.scale.to_array(), [2.0, 4.0, 2.0]);
    assert_eq!(sphere.color.to_array(), [0.5, 0.0, 0.0]);
    assert_eq!([sphere.ka, sphere.kd, sphere.ks, sphere.kr, sphere.n], [1.0, 1.0, 0.9, 0.0, 50.0]);
    assert_eq!([sphere.kt, sphere.eta], [0.0, 1.0]);
    let [light] = scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert_eq!(light.position.to_array(), [-30.0, 30.0, 0.5]);
    assert_eq!(light.intensity.to_array(), [0.7, 1.6, 0.0]);
    assert_eq!(scene.background.to_array(), [1.0, 0.5, 0.0]);
    assert_eq!(scene.ambient.to_array(), [0.2, 0.3, 2.0]);
    assert_eq!(scene.output.as_deref(), Some("a.ppm"));
}

#[test]
fn what_is_absent_has_the_documented_default() {
    let scene = scene(REQUIRED);
    assert_eq!((scene.spheres.len(), scene.lights.len()), (0, 0));
    assert_eq!(scene.background.to_array(), [0.0; 3]);
    assert_eq!(scene.ambient.to_array(), [0.0; 3]);
    assert_eq!(scene.output, None);
}

#[test]
fn refraction_is_read_from_two_more_numbers() {
    let scene = scene(scene_with(&format!("{SPHERE} 0.8 1.5")));
    assert_eq!([scene.spheres[0].n, scene.spheres[0].kt, scene.spheres[0].eta], [50.0, 0.8, 1.5]);
}

#[test]
fn the_order_of_lines_is_free() {
    let text = format!("{REQUIRED}{SPHERE}\nLIGHT l 0 0 0 1 1 1\nBACK 1 1 1\nAMBIENT 1 1 1\nOUTPUT a.ppm");
    let reversed: Vec<&str> = text.lines().rev().collect();
    assert_eq!(scene(reversed.join("\n")), scene(&text));
}

#[test]
fn layout_does_not_matter() {
    let text = format!("{REQUIRED}{SPHERE}\n");
    let plain = scene(&text);
    let layouts = [
        ("no final newline", text.trim_end().to_owned()),
        ("CRLF", text.replace('\n', "\r\n")),
        ("CR", text.replace('\n', "\r")),
        ("byte order mark", format!("\u{FEFF}{text}")),
        ("runs of blanks and tabs", text.replace(' ', " \t  ")),
        ("leading and trailing blanks", text.replace('\n', "\t \n \t")),
        ("blank lines", text.replace('\n', "\n\n \n")),
        ("comment lines", text.replace('\n', "\n# NEAR 7 \u{e9}\n   #\n")),
        ("trailing comments", text.replace('\n', " # half\n")),
        ("comments without a blank before", text.replace('\n', "#1\n")),
    ];
    for (what, text) in layouts {
        assert_eq!(read(&text).scene.as_ref(), Some(&plain), "{what}: {}", read(&text).report(false));
    }
}

#[test]
fn names_are_labels() {
    let mut text = REQUIRED.to_owned();
    let names = ["s1", "s1", "7", "SPHERE", "a-name-of-more-than-twenty-characters", "größe"];
    for name in names {
        writeln!(text, "{}", SPHERE.replacen(" s ", &format!(" {name} "), 1)).unwrap();
    }
    let scene = scene(text + "LIGHT l 0 0 0 1 1 1\n");
    assert_eq!(scene.sphere_names.len(), names.len());
    for (index, name) in names.into_iter().enumerate() {
        assert_eq!(scene.sphere_names.get(index), name);
    }
    assert_eq!(scene.light_names.get(0), "l");
}

#[test]
fn names_that_are_not_utf8_are_kept_readable() {
    let scene = scene([REQUIRED.as_bytes(), b"LIGHT l\xFF 0 0 0 1 1 1"].concat());
    assert_eq!(scene.light_names.get(0), "l\u{FFFD}");
}

#[test]
fn legal_edges_pass_without_a_word() {
    for line in [
        "RES 20000 20000",
        "RES 1 16777216",
        "NEAR 0.000001",
        "SPHERE s 0 0 -10 -2 4 -2 0.5 0 0 1 1 0.9 0 50",
        "SPHERE s 1e6 -1e300 0 1 1 1 0 0.5 1 0 0 0 0 0",
        "SPHERE s 0 0 0 1 1 1 0 0 0 0 0 0 0 12.5 0 0.1",
        "LIGHT l 0 0 0 100 0 1.5",
        "AMBIENT 0 2 -0",
        "OUTPUT test..ppm",
        "OUTPUT ab:c.ppm-",
    ] {
        assert_eq!(read(scene_with(line)).report(false), "", "{line}");
    }
}

/// A line, what the message says, and column and token of the error.
type Case = (&'static str, &'static str, usize, &'static str);

const ERRORS: &[Case] = &[
    // Keywords
    ("TP 1", "unknown keyword `TP`", 1, "TP"),
    ("  sphere s", "unknown keyword `sphere`", 3, "sphere"),
    ("CUBE c 0 0 0", "unknown keyword `CUBE`", 1, "CUBE"),
    ("0 0 -10", "unknown keyword `0`", 1, "0"),
    ("FOO\u{e9}\u{1b} 1", "unknown keyword `FOO\u{e9}␛`", 1, "FOO\u{e9}␛"),
    // Numbers of fields
    ("NEAR 1 1 1", "NEAR has 3 fields instead of 1", 8, "1"),
    ("NEAR", "NEAR has 0 fields instead of 1", 5, "end of line"),
    ("RES 4", "RES has 1 field instead of 2", 6, "end of line"),
    ("BACK 0 0", "BACK has 2 fields instead of 3", 9, "end of line"),
    ("AMBIENT 0 0 0 0", "AMBIENT has 4 fields instead of 3", 15, "0"),
    ("LIGHT", "LIGHT has no name", 6, "end of line"),
    ("LIGHT l 0 0 0 1 1 # 1", "LIGHT has 5 fields after its name instead of 6", 18, "end of line"),
    ("SPHERE", "SPHERE has no name", 7, "end of line"),
    ("SPHERE s", "SPHERE has 0 fields after its name instead of 14 or 16", 9, "end of line"),
    ("SPHERE s 0 0 -9 2 4 2 0.5 0 0 1 1 1 50", "has 13 fields after its name", 39, "end of line"),
    ("SPHERE s 0 0 -9 2 4 2 0.5 0 0 1 1 1 0 50 1", "has 15 fields after its name", 43, "end of line"),
    ("SPHERE s 0 0 -9 2 4 2 0.5 0 0 1 1 1 0 50 1 2 3 4", "has 18 fields after its name", 46, "3"),
    ("OUTPUT", "OUTPUT has no name", 7, "end of line"),
    ("OUTPUT my picture.ppm", "OUTPUT has 1 field after its name instead of 0", 11, "picture.ppm"),
    // Numbers
    ("NEAR x", "`x` is not a number", 6, "x"),
    ("NEAR 0x10", "`0x10` is not a number", 6, "0x10"),
    ("NEAR 1,5", "`1,5` is not a number", 6, "1,5"),
    ("NEAR 1e", "`1e` is not a number", 6, "1e"),
    ("NEAR 1e5.5", "`1e5.5` is not a number", 6, "1e5.5"),
    ("NEAR .", "`.` is not a number", 6, "."),
    ("NEAR -", "`-` is not a number", 6, "-"),
    ("NEAR 1.2.3", "`1.2.3` is not a number", 6, "1.2.3"),
    ("NEAR --1", "`--1` is not a number", 6, "--1"),
    ("LEFT NaN", "`NaN` is not a finite number", 6, "NaN"),
    ("LEFT -inf", "`-inf` is not a finite number", 6, "-inf"),
    ("LEFT 1e999", "`1e999` is too large", 6, "1e999"),
    ("LIGHT l 0 0 z 1 1 1", "`z` is not a number", 13, "z"),
    // Ranges
    ("NEAR 0", "`n` of NEAR cannot be 0", 6, "0"),
    ("NEAR -1", "`n` of NEAR cannot be -1", 6, "-1"),
    ("RIGHT -1.0", "LEFT and RIGHT are the same", 7, "-1.0"),
    ("TOP -1", "BOTTOM and TOP are the same", 5, "-1"),
    ("RES 0 3", "`0` is not a number of pixels", 5, "0"),
    ("RES 4 -3", "`-3` is not a number of pixels", 7, "-3"),
    ("RES 600.0 3", "`600.0` is not a number of pixels", 5, "600.0"),
    ("RES 16777217 3", "`16777217` is not a number of pixels", 5, "16777217"),
    ("RES 99999999999999999999 3", "is not a number of pixels", 5, "99999999999999999999"),
    ("SPHERE s 0 0 -9 2 0 2 1 0 0 1 1 1 0 50", "`sy` of SPHERE cannot be 0", 19, "0"),
    ("SPHERE s 0 0 -9 2 1 -0.0 1 0 0 1 1 1 0 50", "`sz` of SPHERE cannot be -0.0", 21, "-0.0"),
    ("SPHERE s 0 0 -9 2 1 2 1 0 0 1 1 1 0 -1", "`n` of SPHERE cannot be -1", 37, "-1"),
    ("SPHERE s 0 0 -9 2 1 2 1 0 0 1 1 1 0 5 0 0", "`eta` of SPHERE cannot be 0", 41, "0"),
    ("SPHERE s 0 0 -9 2 1 2 1 0 0 1 1 1 0 5 1 -1.5", "`eta` of SPHERE cannot be -1.5", 41, "-1.5"),
    // Output
    ("OUTPUT pics/a.ppm", "OUTPUT `pics/a.ppm` is not a plain file name", 8, "pics/a.ppm"),
    ("OUTPUT /a.ppm", "is not a plain file name", 8, "/a.ppm"),
    ("OUTPUT pics\\a.ppm", "is not a plain file name", 8, "pics\\a.ppm"),
    ("OUTPUT c:a.ppm", "is not a plain file name", 8, "c:a.ppm"),
    ("OUTPUT ..", "is not a plain file name", 8, ".."),
    ("OUTPUT a\u{7}.ppm", "is not a plain file name", 8, "a␇.ppm"),
];

#[test]
fn each_error_names_line_column_and_token() {
    for &(line, message, column, token) in ERRORS {
        let text = scene_with(line);
        let number = text.lines().position(|other| other == line).unwrap() + 1;
        let parsed = read(&text);
        assert_eq!(parsed.scene, None, "{line}");
        assert_eq!((parsed.errors, parsed.warnings), (1, 0), "{line}: {}", parsed.report(false));
        assert_eq!(places(&parsed), [(number, column, token)], "{line}");
        let found = &parsed.diagnostics[0];
        assert_eq!(found.severity, Severity::Error, "{line}");
        assert!(found.message.contains(message), "{line}: {}", found.message);
        assert!(found.expected.contains("expected"), "{line}: {}", found.expected);
        assert!(parsed.report(false).contains(&format!("scene.txt:{number}:{column}\n")), "{}", parsed.report(false));
    }
}

#[test]
fn errors_come_with_the_hint_that_a_beginner_needs() {
    for (line, help) in [
        ("TP 1", "did you mean `TOP`?"),
        ("RIHGT 1", "did you mean `RIGHT`?"),
        ("SPHER s", "did you mean `SPHERE`?"),
        ("BACKGROUND 0 0 0", "did you mean `BACK`?"),
        ("NEAR=1", "did you mean `NEAR`?"),
        ("Output a.ppm", "keywords are upper case: write `OUTPUT`"),
        ("CUBE c", "only spheres are rendered"),
        ("PLANE p", "only spheres are rendered"),
        ("TETRA t", "only spheres are rendered"),
        ("CYLINDER c", "only spheres are rendered"),
        ("1 1 1", "does this line continue the one before?"),
        ("CAMERA", "the keywords are NEAR LEFT RIGHT"),
        ("LIGHT\u{a0}l", "invisible character U+00A0"),
        ("NEAR 1 1 1", "the line is written `NEAR n`"),
        ("NEAR 1 LEFT 2", "put LEFT on a line of its own"),
        ("NEAR \u{2212}1", "write the minus sign as `-`: -1"),
        ("NEAR 1,5", "write the decimal point as `.`: 1.5"),
        ("NEAR 1.5,", "separated by blanks only: write 1.5"),
        ("NEAR 1,1,1", "not by commas"),
        ("NEAR 0.5f", "without the letter: 0.5"),
        ("NEAR -0x1F", "numbers are decimal"),
        ("NEAR -1", "in front of the eye"),
        ("RES 6e2 3", "write 600"),
        ("SPHERE s 0 0 -9 2 4 2 1 0 0 1 1 1 50", "50, looks like `n`: is one before it missing, such as `Kr`?"),
        ("SPHERE 0 0 -9 2 4 2 1 0 0 1 1 1 0 50", "is the name missing? `0` was taken for it"),
        ("SPHERE s 0 0 -9 2 4 2 1 0 0 1 1 1 0 50 1", "`Kt` and `eta` come together"),
        ("LIGHT l#2 0 0 0 1 1 1", "`#` starts a comment, also within a word"),
        ("SPHERE s 0 0 -9 0 4 2 1 0 0 1 1 1 0 5", "use a small scale"),
        ("OUTPUT pics/a.ppm", "OUTPUT names a file, not a path; use -o to choose a folder"),
        ("SPHERE s", "`SPHERE name px py pz sx sy sz r g b Ka Kd Ks Kr n [Kt eta]`"),
    ] {
        let found = only(scene_with(line));
        let text = found.help.unwrap_or_default();
        assert!(text.contains(help), "{line}: {text}");
    }
}

#[test]
fn a_name_with_a_blank_is_recognised() {
    let parsed = read(scene_with("SPHERE my ball 0 0 -9 2 4 2 1 0 0 1 1 1 0 50"));
    assert_eq!(places(&parsed), [(7, 11, "ball"), (7, 45, "end of line")]);
    assert!(parsed.diagnostics[1].help.as_ref().unwrap().contains("a name cannot contain blanks"));
}

#[test]
fn each_required_statement_is_missed_by_itself() {
    for keyword in ["NEAR", "LEFT", "RIGHT", "BOTTOM", "TOP", "RES"] {
        let text: Vec<&str> = REQUIRED.lines().filter(|line| !line.starts_with(keyword)).collect();
        let found = only(text.join("\n") + "\n");
        assert_eq!((found.line, found.token.as_str()), (5, "end of file"));
        assert_eq!(found.message, format!("the scene has no {keyword}"));
        assert!(found.expected.contains(&format!("`{keyword} ")), "{}", found.expected);
    }
}

#[test]
fn an_empty_file_misses_six_statements() {
    for text in ["", "\n", "\u{FEFF}", "# nothing"] {
        let parsed = read(text);
        assert_eq!(parsed.errors, 6, "{text:?}");
        assert!(parsed.diagnostics.iter().all(|found| found.line == 1 && found.token == "end of file"), "{text:?}");
    }
}

#[test]
fn a_misspelt_statement_is_not_missing_too() {
    let found = only(REQUIRED.replace("TOP", "TP"));
    assert_eq!((found.line, found.column, found.token.as_str()), (5, 1, "TP"));
    let found = only(REQUIRED.replace("RES 4 3", "RES 4 x"));
    assert_eq!((found.line, found.column, found.token.as_str()), (6, 7, "x"));
}

#[test]
fn a_second_statement_names_the_line_of_the_first() {
    for line in
        ["NEAR 1", "LEFT -1", "RIGHT 1", "BOTTOM -1", "TOP 1", "RES 4 3", "BACK 0 0 0", "AMBIENT 0 0 0", "OUTPUT a"]
    {
        let first = scene_with(line);
        let number = first.lines().position(|other| other == line).unwrap() + 1;
        let found = only(format!("{first}\n\n{line}\n"));
        assert_eq!(found.line, first.lines().count() + 2, "{line}");
        assert!(found.message.ends_with(&format!("; the first is in line {number}")), "{line}: {}", found.message);
    }
}

#[test]
fn a_window_that_overflows_is_refused() {
    let text = REQUIRED.replace("LEFT -1", "LEFT -1e308").replace("RIGHT 1", "RIGHT 1e308");
    assert_eq!(only(text).message, "LEFT and RIGHT are too far apart");
}

#[test]
fn all_errors_are_found_in_one_run_in_the_order_of_the_file() {
    let text = "RES 0 y\nLIGHT l 0 zero 0 1 1 one\nBACK 0 0 0\nBACK 0 0\nTP 1\nNEAR 1\nLEFT 2\nRIGHT 2\nSPHERE\n";
    assert_eq!(
        places(&read(text)),
        [
            (1, 5, "0"),
            (1, 7, "y"),
            (2, 11, "zero"),
            (2, 22, "one"),
            (4, 1, "BACK"),
            (4, 9, "end of line"),
            (5, 1, "TP"),
            (8, 7, "2"),
            (9, 7, "end of line"),
            (9, 7, "end of file"),
        ]
    );
}

#[test]
fn unusual_numbers_are_warnings_and_keep_the_scene() {
    for (line, message, column, token) in [
        ("BACK 0 1.7 0", "`g` of BACK is outside 0 to 1: 1.7", 8, "1.7"),
        ("AMBIENT 0 0 -1", "`Ib` of AMBIENT is negative: -1", 13, "-1"),
        ("LIGHT l 0 0 0 1 -2 1", "`Ig` of LIGHT is negative: -2", 17, "-2"),
        ("SPHERE s 0 0 -9 1 1 1 1.01 0 0 1 1 1 0 5", "`r` of SPHERE is outside 0 to 1", 23, "1.01"),
        ("SPHERE s 0 0 -9 1 1 1 1 0 0 -1 1 1 0 5", "`Ka` of SPHERE is outside 0 to 1: -1", 29, "-1"),
        ("SPHERE s 0 0 -9 1 1 1 1 0 0 1 2 1 0 5", "`Kd` of SPHERE is outside", 31, "2"),
        ("SPHERE s 0 0 -9 1 1 1 1 0 0 1 1 3 0 5", "`Ks` of SPHERE is outside", 33, "3"),
        ("SPHERE s 0 0 -9 1 1 1 1 0 0 1 1 1 4 5", "`Kr` of SPHERE is outside", 35, "4"),
        ("SPHERE s 0 0 -9 1 1 1 1 0 0 1 1 1 0 5 6 2", "`Kt` of SPHERE is outside", 39, "6"),
        ("LEFT 3", "LEFT is greater than RIGHT", 7, "1"),
        ("TOP -3", "BOTTOM is greater than TOP", 5, "-3"),
        ("LIGHT l 1e-310 0 0 1 1 1", "`1e-310` is too near to 0", 9, "1e-310"),
        ("LIGHT l 0 -1e-999 0 1 1 1", "`-1e-999` is too near to 0", 11, "-1e-999"),
    ] {
        let parsed = read(scene_with(line));
        assert!(parsed.scene.is_some(), "{line}");
        assert_eq!((parsed.errors, parsed.warnings), (0, 1), "{line}: {}", parsed.report(false));
        let found = &parsed.diagnostics[0];
        assert_eq!((found.severity, found.column, found.token.as_str()), (Severity::Warning, column, token), "{line}");
        assert!(found.message.starts_with(message), "{line}: {}", found.message);
    }
}

#[test]
fn a_scale_that_underflows_is_a_zero_scale() {
    let parsed = read(scene_with("SPHERE s 0 0 -9 1 1e-999 1 1 0 0 1 1 1 0 5"));
    assert_eq!(parsed.scene, None);
    assert_eq!(places(&parsed), [(7, 19, "1e-999"); 2]);
    let messages: Vec<&str> = parsed.diagnostics.iter().map(|found| found.message.as_str()).collect();
    assert_eq!(messages, ["`1e-999` is too near to 0 for full precision", "`sy` of SPHERE cannot be 1e-999"]);
}

#[test]
fn errors_are_bounded_and_counted() {
    let parsed = read(format!("{REQUIRED}{}", "NOPE\n".repeat(1000)));
    assert_eq!((parsed.errors, parsed.diagnostics.len()), (1000, 50));
    assert_eq!(parsed.omitted.len(), 1);
    assert_eq!((parsed.omitted[0].severity, parsed.omitted[0].count), (Severity::Error, 950));
    assert!(parsed.report(false).ends_with("\nerror: 950 more errors are not shown\n\n"));
}

#[test]
fn warnings_are_bounded_by_kind_and_counted() {
    let line = "SPHERE s 0 0 -9 1 1 1 2 3 0 -1 1 1 0 5\n";
    let parsed = read(format!("{}{}BACK -1 0 0", REQUIRED.replace("TOP 1", "TOP -2"), line.repeat(100)));
    assert_eq!(parsed.scene.as_ref().unwrap().spheres.len(), 100);
    assert_eq!((parsed.errors, parsed.warnings, parsed.diagnostics.len()), (0, 302, 41));
    let omitted: Vec<String> = parsed.omitted.iter().map(ToString::to_string).collect();
    let expected = [
        "181 more warnings about colours outside 0 to 1 are not shown",
        "80 more warnings about coefficients outside 0 to 1 are not shown",
    ];
    assert_eq!(omitted, expected);
}

/// The help of every error, in order.
fn helps(text: impl AsRef<[u8]>) -> Vec<String> {
    read(text).diagnostics.into_iter().filter_map(|found| found.help).collect()
}

#[test]
fn a_statement_broken_over_two_lines_is_recognised() {
    let broken = "broken over two lines";
    for (text, line) in [
        ("SPHERE s 0 0 -10 2 4 2\n0.5 0 0 1 1 0.9 0 50\n", 7),
        ("SPHERE s 0 0 -10 2 4 2 # the place\n\n # the rest\n\t0.5 0 0 1 1 0.9 0 50 0.5 1.5\n", 7),
        ("LIGHT\nl 0 0 0 1 1 1\n", 7),
        ("BACK 0\n0 0\n", 7),
    ] {
        let helps = helps(format!("{REQUIRED}{text}"));
        assert_eq!(helps.len(), 2, "{helps:?}");
        assert!(helps.iter().all(|help| help.contains(broken)), "{helps:?}");
        assert!(helps[1].contains(&format!("line {line} ")), "{helps:?}");
    }
    // Another mistake, and a line that fits no statement before it.
    for text in [
        "SPHERE s 0 0 -10 2 4 2\nLIGHT l 0 0 0 1 1 1\n",
        "SPHERE s 0 0 -10 2 4 2\n",
        "BACK 0 0\n1 1\n",
        "BACK 0 0 0\n1 1\n",
    ] {
        let helps = helps(format!("{REQUIRED}{text}"));
        assert!(helps.iter().all(|help| !help.contains(broken)), "{helps:?}");
    }
}

#[test]
fn a_colour_that_looks_like_a_level_is_named_as_such() {
    for (line, help) in [
        ("BACK 0 255 0", "write 1"),
        ("BACK 0 0 128", "write 0.502"),
        ("BACK 2 0 0", "write 0.008"),
        ("AMBIENT 255 1 1", "write 1"),
        ("LIGHT l 0 0 255 0 255 1.5", "write 1"),
    ] {
        let found = only(scene_with(line)).help.unwrap();
        assert!(found.ends_with(help) && found.contains("a level of 0 to 255"), "{found}");
    }
    for line in ["BACK 1.5 0 0", "BACK -1 0 0", "BACK 256 0 0"] {
        assert_eq!(only(scene_with(line)).help, None);
    }
    scene(scene_with("LIGHT l 0 0 0 100 254 256"));
}

#[test]
fn utf16_is_named_as_such() {
    for mark in [b"\xFF\xFE", b"\xFE\xFF"] {
        let found = only([mark, "N\0E\0A\0R\0".as_bytes()].concat());
        assert_eq!((found.line, found.column, found.message.as_str()), (1, 1, "the file is UTF-16 text"));
    }
}

#[test]
fn columns_count_characters() {
    let found = only([REQUIRED.as_bytes(), b"LIGHT \xFF\xC3\xA9\xE2\x82 0 0 x 1 1 1"].concat());
    assert_eq!((found.line, found.column, found.token.as_str()), (7, 15, "x"));
    let found = only(format!("\u{FEFF}{}", REQUIRED.replacen("NEAR", "NEER", 1)));
    assert_eq!((found.line, found.column, found.token.as_str()), (1, 1, "NEER"));
}

#[test]
fn long_lines_and_tokens_are_shown_in_part() {
    let line = format!("NEAR {}1 {} 1", " ".repeat(100_000), "€".repeat(100_000));
    let parsed = read(scene_with(&line));
    let found = &parsed.diagnostics[0];
    assert_eq!((found.line, found.column), (1, 100_008));
    assert_eq!(found.token, "€".repeat(40) + "…");
    let report = parsed.report(false);
    assert!(report.contains("scene.txt:1:100008\n") && report.len() < 2000, "{} bytes: {report}", report.len());
    assert!(!report.contains('\u{FFFD}'), "no character is cut in two: {report}");
}

#[test]
fn nothing_in_a_report_is_obeyed_by_a_terminal() {
    let parsed = parse("a\x1b[2J.txt", b"\x1b[31mX\x00\x7f\xff \xe2\x80\xae\nLIGHT \xc2\x9b l\n");
    let report = parsed.report(false);
    let is_safe = |c: char| c == '\n' || (!c.is_control() && c != '\u{202e}');
    assert!(report.chars().all(is_safe), "{report:?}");
    assert!(report.contains("a␛[2J.txt:1:1\n"), "{report}");
    assert!(report.contains("1 │ ␛[31mX␀␡\u{FFFD} \\u{202e}\n"), "{report}");
}

const UNKNOWN: &str = "\
error: unknown keyword `TP`
  ┌─ scene.txt:5:1
  │
5 │ TP 1
  │ ^^ expected a keyword
  │
  = help: did you mean `TOP`?

";

const SECOND: &str = "\
error: a second RES; the first is in line 6
  ┌─ scene.txt:9:1
  │
6 │ RES 4 3
  │ --- the first is here
  ·
9 │ RES 20000 20000
  │ ^^^ expected only one RES in the file

";

const NO_KR: &str = "\
error: SPHERE has 13 fields after its name instead of 14 or 16
  ┌─ scene.txt:7:44
  │
7 │     SPHERE s1 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 50 # no Kr
  │                                               ^ expected `n`, the specular exponent
  │
  = help: the last number, 50, looks like `n`: is one before it missing, such as `Kr`?
    the line is written `SPHERE name px py pz sx sy sz r g b Ka Kd Ks Kr n [Kt eta]`

";

const BRIGHT: &str = "\
warning: `g` of BACK is outside 0 to 1: 1.7
  ┌─ scene.txt:7:8
  │
7 │ BACK 0 1.7 0
  │        ^^^ usually 0 to 1: the green of the background

";

#[test]
fn reports_read_as_intended() {
    assert_eq!(read(REQUIRED.replace("TOP", "TP")).report(false), UNKNOWN);
    assert_eq!(read(format!("{REQUIRED}\n\nRES 20000 20000\n")).report(false), SECOND);
    let line = "\tSPHERE s1 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 50 # no Kr";
    assert_eq!(read(scene_with(line)).report(false), NO_KR);
    assert_eq!(read(scene_with("BACK 0 1.7 0")).report(false), BRIGHT);
    assert_eq!(read(REQUIRED).report(false), "");
}

#[test]
fn colours_are_only_added() {
    let parsed = read(REQUIRED.replace("TOP", "TP"));
    let colored = parsed.report(true);
    assert!(colored.contains("\x1b["), "{colored:?}");
    let mut plain = String::new();
    for (index, part) in colored.split("\x1b[").enumerate() {
        plain.push_str(if index == 0 { part } else { part.split_once('m').unwrap().1 });
    }
    assert_eq!(plain, parsed.report(false));
}

/// The number that the parser reads from a token, if it takes it.
fn number(token: &str) -> Option<f64> {
    Some(read(format!("{REQUIRED}LIGHT l {token} 0 0 0 0 0")).scene?.lights[0].position.x)
}

/// The same from the standard library.
fn number_of_std(token: &str) -> Option<f64> {
    token.parse().ok().filter(|number: &f64| number.is_finite())
}

#[test]
fn numbers_at_the_edges_are_rounded_correctly() {
    for token in [
        "0",
        "-0",
        "-0.0e5",
        "+.5",
        "5.",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "9007199254740992",
        "9007199254740993",
        "9007199254740993e-3",
        "9007199254740991e22",
        "9999999999999999999",
        "18446744073709551616",
        "0.1000000000000000055511151231257827",
        "123456789012345678901234567890",
        "2.2250738585072011e-308",
        "5e-324",
        "2e-324",
        "1.7976931348623157e308",
        "1e99999999999999999999",
        "1e-99999999999999999999",
        "0.00000000000000000000000000000000000000001e41",
        "8.5e-22",
        "1E+5",
        "1e+",
        "e5",
        "+",
        "1_0",
        "infinity",
    ] {
        assert_eq!(number(token).map(f64::to_bits), number_of_std(token).map(f64::to_bits), "{token}");
    }
}

/// A line of words that the parser knows, some out of place.
fn soup() -> impl Strategy<Value = String> {
    let keywords =
        "NEAR|LEFT|RIGHT|BOTTOM|TOP|RES|SPHERE|LIGHT|BACK|AMBIENT|OUTPUT|CUBE|near|TP|#|\r|\u{FEFF}|\u{e9}|/";
    let word = prop_oneof![1 => keywords, 4 => "-?[0-9]{1,3}(\\.[0-9])?", 1 => "nan|1e999|1e-999|0x1|1,5|-|x#y"];
    (keywords, prop::collection::vec(word, 0..20)).prop_map(|(first, rest)| format!("{first} {}", rest.join(" ")))
}

/// Holds for whatever text: the counts agree, the order is that of the file, and the report can be written.
fn check_invariants(text: &[u8]) {
    let parsed = read(text);
    assert_eq!(parsed.scene.is_some(), parsed.errors == 0);
    let omitted: usize = parsed.omitted.iter().map(|rest| rest.count).sum();
    assert_eq!(parsed.diagnostics.len() + omitted, parsed.errors + parsed.warnings);
    assert!(parsed.diagnostics.is_sorted_by_key(|found| (found.line, found.column)));
    let report = parsed.report(false);
    for found in &parsed.diagnostics {
        let place = format!("scene.txt:{}:{}\n", found.line, found.column);
        assert!(report.contains(&place) && report.contains(&found.message), "{place}{report}");
    }
    if let Some(scene) = parsed.scene {
        assert!((1..=MAX_RESOLUTION).contains(&scene.width) && (1..=MAX_RESOLUTION).contains(&scene.height));
        assert!(scene.spheres.iter().all(|sphere| sphere.scale.min_element() != 0.0 && sphere.center.is_finite()));
        assert_eq!(scene.spheres.len(), scene.sphere_names.len());
        assert_eq!(scene.lights.len(), scene.light_names.len());
    }
}

proptest! {
    #[test]
    fn any_bytes_are_answered(text in prop::collection::vec(any::<u8>(), 0..300)) {
        check_invariants(&text);
    }

    #[test]
    fn any_bytes_within_a_scene_are_answered(noise in prop::collection::vec(any::<u8>(), 0..12), at in 0..100_usize) {
        let text = format!("{REQUIRED}{SPHERE}\nLIGHT l 0 0 0 1 1 1\n");
        let (before, after) = text.as_bytes().split_at(at.min(text.len()));
        check_invariants(&[before, &noise, after].concat());
    }

    #[test]
    fn any_soup_of_words_is_answered(lines in prop::collection::vec(soup(), 0..12)) {
        check_invariants(lines.join("\n").as_bytes());
        check_invariants(format!("{REQUIRED}{}", lines.join("\r\n")).as_bytes());
    }

    #[test]
    fn decimals_are_rounded_correctly(token in "[-+]?[0-9]{1,22}(\\.[0-9]{0,22})?([eE][-+]?[0-9]{1,3})?") {
        prop_assert_eq!(number(&token).map(f64::to_bits), number_of_std(&token).map(f64::to_bits));
    }

    #[test]
    fn short_decimals_are_rounded_correctly(mantissa in 0..=1_u64 << 54, exponent in -25..=25_i32) {
        let token = format!("{mantissa}e{exponent}");
        prop_assert_eq!(number(&token).map(f64::to_bits), number_of_std(&token).map(f64::to_bits));
    }

    #[test]
    fn every_finite_number_survives(number in any::<f64>().prop_filter("finite", |number| number.is_finite())) {
        for token in [format!("{number}"), format!("{number:e}")] {
            prop_assert_eq!(self::number(&token).map(f64::to_bits), Some(number.to_bits()));
        }
    }

    #[test]
    fn what_counts_as_a_number_is_what_std_takes(token in "[-+.eE0-9]{1,8}") {
        prop_assert_eq!(number(&token).map(f64::to_bits), number_of_std(&token).map(f64::to_bits));
    }
}

#[test]
fn scenes_survive_being_written() {
    let glass = format!(
        "{REQUIRED}SPHERE g 0.1 1e-300 -1e300 -2 3 4 1.5 0 0 1 1 0.9 -0.1 0.5 0.75 1.33\nOUTPUT p.ppm\nLIGHT l 1 2 3 0 0 1"
    );
    let parsed = read(&glass).scene.unwrap();
    assert_eq!(read(parsed.to_string()).scene.unwrap(), parsed);
    for file in scene_files(&["basic", "effects", "hard", "show"]) {
        let scene = crate::support::scene(&file);
        assert_eq!(read(scene.to_string()).scene.unwrap(), scene, "{}", file.display());
    }
}

//! `trueray grade`: whose picture is which, verdicts of whatever is handed in, scores, and the names of JSON and CSV.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::{TempDir, tempdir};
use trueray::film::{Format, Picture, Target};
use trueray::grade::{COLUMNS, Folder, Sought, score};
use trueray::settings::{Settings, Specular};

use super::support::{Case, scene};

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 40\nSPHERE ball 0 0 -4 2 2 2 0.8 0.4 0.2 0.3 0.6 0.5 0 20\n\
    LIGHT lamp 3 5 0 0.9 0.9 0.9\nBACK 0.2 0.3 0.4\nAMBIENT 0.5 0.5 0.5\nOUTPUT handed-in.ppm\n";

fn place(scene: &str) -> TempDir {
    let folder = tempdir().unwrap();
    for name in ["scenes", "theirs"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("scenes/ball.txt"), scene).unwrap();
    folder
}

fn grade(folder: &TempDir, options: &str) -> Output {
    let arguments = format!("grade --device cpu --scenes scenes --theirs theirs {options}");
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder.path()).output().unwrap()
}

#[track_caller]
fn assert_exit(output: &Output, code: i32, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(stderr.contains(message) && !stderr.contains("panicked"), "{message} in {stderr}");
}

/// The right picture of the scene in `folder`, by these settings.
fn rendered(folder: &TempDir, settings: &Settings) -> Picture {
    Case::new(&scene(&folder.path().join("scenes/ball.txt")), settings).expected.clone()
}

fn files_of(folders: &[(&str, &[&str])], scenes: &[(&str, Option<&str>)]) -> (Vec<String>, Vec<String>) {
    let place = tempdir().unwrap();
    for (folder, files) in folders {
        fs::create_dir_all(place.path().join(folder)).unwrap();
        for file in *files {
            fs::write(place.path().join(folder).join(file), "").unwrap();
        }
    }
    let sought: Vec<_> = scenes
        .iter()
        .map(|(stem, output)| Sought { stem: (*stem).into(), output: output.map(str::to_owned) })
        .collect();
    let found = Folder::read(place.path(), &sought).unwrap();
    let relative = |path: &Path| path.strip_prefix(place.path()).unwrap().display().to_string().replace('\\', "/");
    let of_one = |submission: &trueray::grade::Submission| {
        let files = submission.pictures.iter().map(|file| file.as_deref().map_or_else(|| "–".into(), relative));
        format!("{}: {}", submission.student.as_deref().unwrap_or("all"), files.collect::<Vec<_>>().join(" "))
    };
    let extras = found.extras.iter().map(|extra| format!("{}: {}", relative(Path::new(&extra.picture)), extra.reason));
    (found.submissions.iter().map(of_one).collect(), extras.collect())
}

#[test]
fn a_picture_bears_the_name_of_its_scene_or_output() {
    let scenes = [("a", Some("out-a.ppm")), ("b", None), ("c", Some("out-c.ppm"))];
    let files = ["out-a.ppm", "a.ppm", "b.PPM", "out-c.png", "notes.txt", "other.bmp", "._b.png"];
    let (found, extras) = files_of(&[("", &files)], &scenes);
    assert_eq!(found, ["all: out-a.ppm b.PPM out-c.png"]);
    assert_eq!(extras, ["a.ppm: another picture of a is graded", "other.bmp: no scene has this name"]);
    // A format that is read comes before one that is not.
    assert_eq!(files_of(&[("", &["b.bmp", "b.png"])], &scenes[1..2]).0, ["all: b.png"]);
}

#[test]
fn folders_are_students_where_no_picture_lies_beside_them() {
    let scenes = [("a", None), ("b", None)];
    let (found, extras) = files_of(
        &[
            ("", &["list.csv"]),
            ("ann", &["a.ppm"]),
            ("bob/out/deep", &["b.ppm"]),
            ("bob", &["b.png"]),
            (".git", &["a.ppm"]),
            ("grades_files", &["001-a.html"]),
        ],
        &scenes,
    );
    // How deep a picture lies matters less than its ending.
    assert_eq!(found, ["ann: ann/a.ppm –", "bob: – bob/out/deep/b.ppm"]);
    assert_eq!(extras, ["bob/b.png: another picture of b is graded", "grades_files: pages, no pictures"]);
    let (found, extras) = files_of(&[("", &["a.ppm"]), ("ann", &["b.ppm"])], &scenes);
    assert_eq!((found, extras), (vec!["all: a.ppm –".to_owned()], vec!["ann: a folder beside pictures".to_owned()]));
}

/// A link to a folder is a student; one below it, which may lead back, is not followed.
#[cfg(unix)]
#[test]
fn links_to_folders_are_students() {
    use std::os::unix::fs::symlink;
    let place = tempdir().unwrap();
    let students = place.path().join("students");
    fs::create_dir_all(place.path().join("elsewhere")).unwrap();
    fs::create_dir_all(&students).unwrap();
    fs::write(place.path().join("elsewhere/a.ppm"), "").unwrap();
    symlink(place.path().join("elsewhere"), students.join("ann")).unwrap();
    symlink(&students, place.path().join("elsewhere/back")).unwrap();
    let found = Folder::read(&students, &[Sought { stem: "a".into(), output: None }]).unwrap();
    let names: Vec<_> =
        found.submissions.iter().map(|found| (found.student.as_deref(), found.pictures.len())).collect();
    assert_eq!(names, [(Some("ann"), 1)]);
    assert!(found.submissions[0].pictures[0].is_some() && found.extras.is_empty(), "{found:?}");
}

#[test]
fn the_score_is_the_rule() {
    let black = Picture::new(10, 1, vec![0; 30]).unwrap();
    let with = |levels: &[u8]| {
        let mut rgb = vec![0; 30];
        levels.iter().enumerate().for_each(|(at, level)| rgb[3 * at] = *level);
        (Picture::new(10, 1, rgb).unwrap(), (0..levels.len() as u32).map(|x| [x, 0]).collect::<Vec<_>>())
    };
    for (levels, expected) in
        [(&[][..], 100), (&[2], 97), (&[3], 95), (&[10], 95), (&[11], 90), (&[1, 2, 10, 200], 80), (&[255; 10], 0)]
    {
        let (picture, unexplained) = with(levels);
        assert_eq!(score(&picture, &black, &unexplained), expected, "{levels:?}");
        // What rounding explains costs nothing.
        assert_eq!(score(&picture, &black, &[]), 100);
    }
    let large = Picture::new(1000, 1000, vec![0; 3_000_000]).unwrap();
    let mut rgb = vec![0; 3_000_000];
    rgb[0] = 1;
    assert_eq!(score(&Picture::new(1000, 1000, rgb).unwrap(), &large, &[[0, 0]]), 99, "not quite full");
}

/// A folder with a student for each kind of picture.
fn all_kinds() -> (TempDir, BTreeMap<&'static str, &'static str>) {
    let folder = place(SCENE);
    let right = rendered(&folder, &Settings::classic());
    let bytes = |format| {
        let path = folder.path().join("bytes");
        right.save(&Target::File(path.clone()), format).unwrap();
        fs::read(path).unwrap()
    };
    let (ppm, png) = (bytes(Format::P6), bytes(Format::Png));
    let blinn = Settings { specular: Specular::Blinn, ..Settings::classic() };
    let mut p3 = String::from_utf8(bytes(Format::P3)).unwrap();
    p3.truncate(p3.len() / 2);
    let mut broken = png.clone();
    broken[60] ^= 0x55;
    let mut wrong = rendered(&folder, &blinn).rgb().to_vec();
    let mut mistaken = b"P6\n40 40\n255\n".to_vec();
    mistaken.append(&mut wrong);
    let files: Vec<(&str, &str, Vec<u8>, &str)> = vec![
        ("s01", "ball.ppm", ppm.clone(), "same"),
        ("s02", "handed-in.ppm", png.clone(), "same"),
        ("s03", "ball.png", png.clone(), "same"),
        ("s04", "ball.ppm", mistaken, "different"),
        ("s05", "notes.ppm", ppm.clone(), "missing"),
        ("s06", "ball.ppm", ppm[..ppm.len() - 7].to_vec(), "truncated"),
        ("s07", "ball.png", png[..png.len() / 2].to_vec(), "truncated"),
        ("s08", "ball.ppm", p3.into_bytes(), "truncated"),
        ("s09", "ball.ppm", Vec::new(), "truncated"),
        ("s10", "ball.ppm", b"P6\n39 40\n255\n".iter().copied().chain(vec![0; 39 * 40 * 3]).collect(), "wrong_size"),
        ("s11", "ball.png", broken, "damaged"),
        ("s12", "ball.ppm", [&ppm[..], b"more"].concat(), "damaged"),
        ("s13", "ball.bmp", b"BM\0\0".to_vec(), "unsupported"),
        ("s14", "ball.pgm", b"P5\n40 40\n255\n".to_vec(), "unsupported"),
        ("s15", "ball.ppm", b"P6\n40 40\n65535\n".iter().copied().chain(vec![0; 40 * 40 * 6]).collect(), "unsupported"),
        ("s16", "ball.jpg", vec![0xff, 0xd8, 0xff, 0xe0], "unsupported"),
        ("s17", "ball.ppm", b"P6\n4000000 4000000\n255\n".to_vec(), "wrong_size"),
        ("s18", "ball.ppm", b"hello, world".to_vec(), "unsupported"),
        ("s19", "ball.png", b"\x89PNG\r\n\x1a\n\0\0".to_vec(), "truncated"),
    ];
    let mut verdicts = BTreeMap::new();
    for (student, name, bytes, verdict) in files {
        let own = folder.path().join("theirs").join(student);
        fs::create_dir(&own).unwrap();
        fs::write(own.join(name), bytes).unwrap();
        verdicts.insert(student, verdict);
    }
    fs::create_dir(folder.path().join("theirs/s20")).unwrap();
    verdicts.insert("s20", "missing");
    (folder, verdicts)
}

#[test]
fn whatever_is_handed_in_has_its_row() {
    let (folder, verdicts) = all_kinds();
    let output = grade(&folder, "--json g.json --csv g.csv --html g.html");
    assert_exit(&output, 1, "");
    let table = String::from_utf8(output.stdout).unwrap();
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("g.json")).unwrap()).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), verdicts.len());
    for row in rows {
        let student = row["student"].as_str().unwrap();
        assert_eq!(row["verdict"], verdicts[student], "{row}");
        let line = table.lines().find(|line| line.starts_with(&format!("{student}/ball "))).unwrap();
        assert!(line.contains(&format!("  {:>5}  ", row["score"])), "{line}");
        let is_compared = ["same", "different"].contains(&verdicts[student]);
        assert_eq!(row["differing"].is_object(), is_compared, "{row}");
        match verdicts[student] {
            "same" => assert_eq!(row["score"], 100),
            "different" => assert!(row["score"].as_u64().is_some_and(|score| (1..100).contains(&score)), "{row}"),
            "missing" => assert!(row["score"] == 0 && row["detail"].is_null(), "{row}"),
            _ => assert!(row["score"] == 0 && row["detail"].as_str().is_some_and(|why| why.len() > 10), "{row}"),
        }
        // Its page is there, and the overview leads to it.
        let page = row["page"].as_str();
        assert_eq!(page.is_some(), is_compared, "{row}");
        if let Some(page) = page {
            assert!(fs::read_to_string(folder.path().join(page)).unwrap().contains("data:image/png"), "{page}");
            assert!(fs::read_to_string(folder.path().join("g.html")).unwrap().contains(&format!("href=\"{page}\"")));
        }
    }
    assert_eq!(json["full"], 3);
    assert!(table.ends_with("\nfull score  3 of 20\n"), "{table}");
    assert_eq!(rows[3]["causes"][0]["name"], "specular-blinn", "{}", rows[3]);
    assert!(table.contains("  specular-blinn\n"), "{table}");
    let extra = &json["not_graded"][0];
    assert!(extra["picture"].as_str().unwrap().ends_with("notes.ppm") && extra["reason"] == "no scene has this name");

    // The names that programs rely on.
    let names: Vec<_> = rows[3].as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "causes",
        "cut_short",
        "detail",
        "differing",
        "explained",
        "max_level",
        "page",
        "picture",
        "pixels",
        "scene",
        "score",
        "student",
        "unexplained",
        "verdict",
        "warnings",
    ];
    assert_eq!(names, expected);
    let csv = fs::read_to_string(folder.path().join("g.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next().unwrap(), COLUMNS.join(","));
    let record: Vec<_> = lines.nth(3).unwrap().split(',').collect();
    assert_eq!((record[0], record[1], record[3], record[13]), ("s04", "ball", "different", "specular-blinn"), "{csv}");
    assert_eq!(record[6], rows[3]["differing"]["over_0"].to_string());
    let documented = fs::read_to_string(super::support::root().join("src/cli/README.md")).unwrap();
    for name in expected.iter().chain(&COLUMNS) {
        assert!(documented.contains(&format!("`{name}`")), "{name} is in src/cli/README.md");
    }
}

/// File systems that take names for UTF-8 alone have no such folders.
#[cfg(target_os = "linux")]
#[test]
fn students_whose_names_look_alike_are_kept_apart() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = place(SCENE);
    let right = rendered(&folder, &Settings::classic());
    let students = [&b"ann\xff"[..], b"ann\xfe", b"a\xcc\x81nn", b"tab\x01", "tab\u{2401}".as_bytes()];
    for student in students {
        let own = folder.path().join("theirs").join(OsStr::from_bytes(student));
        fs::create_dir(&own).unwrap();
        if student != students[0] {
            right.write(own.join("ball.ppm")).unwrap();
        }
    }
    let json: Value = serde_json::from_slice(&grade(&folder, "--no-explain --json -").stdout).unwrap();
    let scores: Vec<_> = json["students"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["student"].as_str().unwrap(), &one["score"]))
        .collect();
    let (none, full) = (Value::from(0.0), Value::from(100.0));
    let expected = [
        ("ann\u{FFFD}", &full),
        ("ann\u{FFFD} (2)", &none),
        ("a\u{301}nn", &full),
        ("tab\u{2401}", &full),
        ("tab\u{2401} (2)", &full),
    ];
    assert_eq!(scores, expected);
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_said_to_be_what_it_is() {
    use std::os::unix::fs::symlink;
    let folder = place(SCENE);
    let theirs = folder.path().join("theirs");
    for student in ["device", "folder", "link", "pipe", "socket"] {
        fs::create_dir(theirs.join(student)).unwrap();
    }
    let picture = |student: &str| theirs.join(student).join("ball.ppm");
    symlink("/dev/zero", picture("device")).unwrap();
    symlink(folder.path(), picture("folder")).unwrap();
    symlink("nothing.ppm", picture("link")).unwrap();
    assert!(Command::new("mkfifo").arg(picture("pipe")).status().unwrap().success());
    let _socket = std::os::unix::net::UnixListener::bind(picture("socket")).unwrap();
    let json: Value = serde_json::from_slice(&grade(&folder, "--json -").stdout).unwrap();
    let rows = json["rows"].as_array().unwrap();
    let found: Vec<_> = rows.iter().map(|row| row["detail"].as_str().unwrap()).collect();
    let expected = [
        "a device, no picture",
        "a link to a folder, no picture",
        "a link to a file that is not there",
        "a pipe, no picture",
        "a socket, no picture",
    ];
    assert_eq!(found, expected);
    assert!(rows.iter().all(|row| row["verdict"] == "damaged" && row["score"] == 0), "{rows:?}");
    // A file beside it is graded.
    rendered(&folder, &Settings::classic()).write(theirs.join("pipe/handed-in.png")).unwrap();
    let json: Value = serde_json::from_slice(&grade(&folder, "--json -").stdout).unwrap();
    assert_eq!(json["rows"][3]["verdict"], "same");
}

#[test]
fn exit_codes_tell_whether_all_is_right() {
    let folder = place(SCENE);
    let right = rendered(&folder, &Settings::classic());
    right.write(folder.path().join("theirs/ball.ppm")).unwrap();
    let output = grade(&folder, "--csv -");
    assert_exit(&output, 0, "");
    let csv = String::from_utf8(output.stdout).unwrap();
    assert!(csv.contains("\n,ball,") && csv.contains(",same,100,1600,0,0,0,0,0,0,0,"), "{csv}");
    // Another convention has other pictures, and a time of 0 seeks no cause but says so.
    let output = grade(&folder, "--convention exact --explain-seconds 0");
    assert_exit(&output, 1, "");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("different") && table.contains("no cause was sought"), "{table}");
    let table = String::from_utf8(grade(&folder, "--convention exact --no-explain").stdout).unwrap();
    assert!(table.contains("different") && !table.contains("sought"), "{table}");
    // What was cut off is repaired where that is asked for.
    let mut bytes = fs::read(folder.path().join("theirs/ball.ppm")).unwrap();
    bytes.push(0);
    fs::write(folder.path().join("theirs/ball.ppm"), bytes).unwrap();
    assert_exit(&grade(&folder, ""), 1, "");
    assert_exit(&grade(&folder, "--lenient"), 0, "");

    assert_exit(&grade(&folder, "--html -"), 2, "--html needs a file");
    assert_exit(&grade(&folder, "--csv theirs/ball.ppm"), 6, "an input of this run");
    fs::write(folder.path().join("scenes/ball.txt"), "RES 4").unwrap();
    assert_exit(&grade(&folder, ""), 3, "ball.txt");
    fs::remove_file(folder.path().join("scenes/ball.txt")).unwrap();
    assert_exit(&grade(&folder, ""), 2, "no scene file");
    fs::remove_dir_all(folder.path().join("scenes")).unwrap();
    assert_exit(&grade(&folder, ""), 2, "scenes: ");
}

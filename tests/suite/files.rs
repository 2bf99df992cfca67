//! Files: nothing that a run reads or has written is lost, and nothing half-written stays.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{Folder, gpu, say};

/// A scene without its size and its OUTPUT.
const SCENE: &str =
    "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n";
/// A picture that was there before.
const OLD: &str = "P6\n1 1\n255\nold";

/// With a small scene in `scene.txt` that ends in these lines.
fn with_scene(lines: &str) -> Folder {
    let place = Folder::new();
    write_scene(&place, "scene.txt", &format!("RES 16 8\n{lines}"));
    place
}

fn write_scene(place: &Folder, name: &str, lines: &str) {
    place.write(name, format!("{SCENE}{lines}\n"));
}

// --- inputs and outputs ---------------------------------------------------------------------------------------------

/// Two scenes and two pictures, each also under other names; whatever would replace one of them changes nothing.
#[cfg(unix)]
#[test]
fn no_input_is_an_output_under_whatever_name() {
    let place = Folder::new();
    write_scene(&place, "a.txt", "RES 16 8\nOUTPUT b.txt");
    write_scene(&place, "b.txt", "RES 16 8\nOUTPUT b.ppm");
    place.exits("render -q --device cpu b.txt -o p.ppm", 0, "");
    place.exits("render -q --device cpu b.txt -o q.png", 0, "");
    std::os::unix::fs::symlink("b.txt", place.path("soft.ppm")).unwrap();
    fs::hard_link(place.path("b.txt"), place.path("hard.ppm")).unwrap();
    fs::create_dir(place.path("folder")).unwrap();
    let before: Vec<_> = ["a.txt", "b.txt", "p.ppm", "q.png"].map(|name| place.read(name)).into();
    let files = place.files();
    let input = "an input of this run";
    for (arguments, code) in [
        ("a.txt b.txt", 6),
        ("render --device cpu --allow-any-output --format p6 a.txt b.txt", 6),
        ("render --device cpu b.txt -o b.txt --format p6", 6),
        ("render --device cpu b.txt -o folder/../b.txt --format p6", 6),
        ("render --device cpu b.txt -o soft.ppm", 6),
        ("render --device cpu b.txt -o hard.ppm", 6),
        ("render --device cpu soft.ppm -o b.txt --format p6", 6),
        ("render --device cpu b.txt -o new.ppm --stats-json b.txt", 6),
        ("study --device cpu b.txt --report b.txt", 6),
        ("study --device cpu b.txt --csv hard.ppm", 6),
        ("study --device cpu b.txt --json soft.ppm", 6),
        ("export b.txt --to povray -o hard.ppm", 6),
        ("compare p.ppm q.png --heatmap p.ppm", 2),
        ("compare p.ppm q.png --three-wide q.png", 2),
        ("compare --scene hard.ppm p.ppm --heatmap b.txt", 2),
    ] {
        place.exits(arguments, code, input);
        let after: Vec<_> = ["a.txt", "b.txt", "p.ppm", "q.png"].map(|name| place.read(name)).into();
        assert!(before == after && files == place.files(), "{arguments}");
    }
    // What the shell redirects is a file of the run as well.
    let scene = || fs::OpenOptions::new().read(true).append(true).open(place.path("b.txt")).unwrap();
    for (arguments, code) in [("render --device cpu - -o b.txt --format p6", 6), ("render --device cpu b.txt -o -", 6)]
    {
        let output = place.command(arguments).stdin(scene()).stdout(scene()).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(input), "{arguments}");
        assert!(place.read("b.txt") == before[1]);
    }
}

#[test]
fn no_two_outputs_are_one_file() {
    let place = Folder::new();
    write_scene(&place, "a.txt", "RES 16 8\nOUTPUT out.ppm");
    write_scene(&place, "b.txt", "RES 16 8\nOUTPUT out.ppm");
    fs::create_dir(place.path("folder")).unwrap();
    let files = place.files();
    for (arguments, code) in [
        ("a.txt b.txt", 6),
        ("render --device cpu a.txt a.txt", 6),
        ("render --device cpu a.txt b.txt -o folder", 6),
        ("render --device cpu a.txt -o p.json --format png --stats-json ./p.json", 6),
        ("render --device cpu a.txt --stats-json out.ppm", 6),
        ("study --device cpu a.txt --report r --csv ./r", 6),
        ("study --device cpu a.txt --csv - --json -", 6),
        ("bench --no-cpu --report r --json folder/../r", 6),
        ("compare a.ppm b.ppm --heatmap h.ppm --three-wide h.ppm", 2),
    ] {
        place.exits(arguments, code, "would overwrite");
        assert_eq!(place.files(), files, "{arguments}");
        assert_eq!(fs::read_dir(place.path("folder")).unwrap().count(), 0, "{arguments}");
    }
    // Nothing is lost in a device.
    place.exits("render --device cpu a.txt -o /dev/null --stats-json /dev/null", 0, "");
}

/// The part of a name after its last dot is no more of it than that.
#[test]
fn scenes_without_output_have_a_name_each() {
    let place = Folder::new();
    for name in ["v.1.txt", "v.2.txt", "plain"] {
        write_scene(&place, name, "RES 16 8");
    }
    place.exits("render -q --device cpu v.1.txt v.2.txt plain", 0, "");
    assert_eq!(place.files(), ["plain", "plain.ppm", "v.1.ppm", "v.1.txt", "v.2.ppm", "v.2.txt"]);
}

// --- names ----------------------------------------------------------------------------------------------------------

/// Who writes a scene does not choose what of the user's it replaces.
#[cfg(unix)]
#[test]
fn output_is_a_picture_and_replaces_pictures_alone() {
    let outside = Folder::new();
    outside.write("target.ppm", OLD);
    let fresh = |output: &str| {
        let place = with_scene(&format!("OUTPUT {output}"));
        place.write("text.ppm", "not a picture");
        place.write("P6.ppm", "P6rotten");
        place.write("old.PPM", OLD);
        fs::write(place.path("old.png"), b"\x89PNG\r\n\x1a\n").unwrap();
        place.write("empty.ppm", "");
        place.write("inner.ppm", OLD);
        fs::create_dir(place.path("folder.ppm")).unwrap();
        std::os::unix::fs::symlink(outside.path("target.ppm"), place.path("out-link.ppm")).unwrap();
        std::os::unix::fs::symlink(outside.path("nothing.ppm"), place.path("new-link.ppm")).unwrap();
        std::os::unix::fs::symlink("inner.ppm", place.path("in-link.ppm")).unwrap();
        place
    };
    for (output, why) in [
        (".bashrc", "hidden"),
        (".hidden.ppm", "hidden"),
        ("Makefile", "no picture's name"),
        ("grade.sh", "no picture's name"),
        ("scene2.txt", "no picture's name"),
        ("text.ppm", "does not begin like"),
        ("P6.ppm", "does not begin like"),
        ("out-link.ppm", "a link out of the folder"),
        ("new-link.ppm", "a link out of the folder"),
    ] {
        let place = fresh(output);
        let files = place.files();
        let stderr = place.exits("render --device cpu scene.txt", 6, why).stderr;
        assert!(String::from_utf8(stderr).unwrap().contains("--allow-any-output"));
        assert_eq!(place.files(), files, "{output}");
        assert_eq!(place.read("text.ppm"), b"not a picture");
        assert_eq!(outside.files(), ["target.ppm"]);
        assert_eq!(outside.read("target.ppm"), OLD.as_bytes());
        // Whoever renders may choose the same.
        place.exits("render --device cpu --format p6 --allow-any-output scene.txt", 0, "");
        fs::write(outside.path("target.ppm"), OLD).unwrap();
        let _ = fs::remove_file(outside.path("nothing.ppm"));
    }
    for output in ["old.PPM", "old.png", "empty.ppm", "in-link.ppm", "new.pnm"] {
        fresh(output).exits("render --device cpu scene.txt", 0, output);
    }
    for output in ["a\u{202E}gpj.ppm", "a\u{200B}.ppm"] {
        let place = fresh(output);
        let files = place.files();
        place.exits("render --device cpu scene.txt", 3, "OUTPUT");
        assert_eq!(place.files(), files);
    }
    fresh("folder.ppm").exits("render --device cpu scene.txt", 6, "no regular file");
    // The scene's name is the user's, but the file there need not be a picture.
    let place = with_scene("");
    place.write("scene.ppm", "notes");
    place.exits("render --device cpu scene.txt", 6, "does not begin like");
    place.exits("render --device cpu scene.txt -o scene.ppm", 0, "");
}

/// A scene that is refused does not keep the others from being rendered.
#[test]
fn a_refused_name_is_that_scenes_own_trouble() {
    let place = with_scene("OUTPUT out.ppm");
    write_scene(&place, "bad.txt", "RES 16 8\nOUTPUT Makefile");
    place.exits("render --device cpu bad.txt scene.txt", 6, "bad.txt: OUTPUT would write `Makefile`");
    assert_eq!(place.files(), ["bad.txt", "out.ppm", "scene.txt"]);
}

#[test]
fn an_unknown_ending_is_an_error_unless_a_format_is_asked_for() {
    for name in ["a.bmp", "a.jpg", "a.hdr", "a.tif"] {
        let place = with_scene(&format!("OUTPUT {name}"));
        place.exits("scene.txt", 2, ".ppm, .png, .pfm or .exr");
        place.exits(&format!("render --device cpu scene.txt -o x-{name}"), 2, "--format p6, p3, png, pfm or exr");
        place.exits(&format!("compare scene.txt scene.txt --heatmap {name}"), 2, ".ppm or .png");
        assert_eq!(place.files(), ["scene.txt"]);
        place.exits("render --device cpu --format png scene.txt", 0, "");
        assert!(place.read(name).starts_with(b"\x89PNG"));
        place.exits(&format!("render --device cpu --format p3 scene.txt -o x-{name}"), 0, "");
        assert!(place.read(&format!("x-{name}")).starts_with(b"P3"));
    }
}

#[test]
fn quotes_are_no_part_of_a_name() {
    let place = with_scene("OUTPUT \"a.ppm\"");
    place.exits("scene.txt", 3, "expected a file name without quotes");
    assert_eq!(place.files(), ["scene.txt"]);
    let place = with_scene("OUTPUT bob's.ppm");
    place.exits("render --device cpu scene.txt", 0, "bob's.ppm");
}

/// A link to a file that is yet to be made: it is made like any other, and the link stays.
#[cfg(unix)]
#[test]
fn a_link_to_nothing_yet_is_followed() {
    let place = with_scene("");
    fs::create_dir(place.path("folder")).unwrap();
    std::os::unix::fs::symlink("folder/new.ppm", place.path("link.ppm")).unwrap();
    place.exits("render --device cpu -o link.ppm --stats-json folder/new.ppm scene.txt", 6, "would overwrite");
    // Too large to be complete: nothing of it stays behind the link either.
    let limited = "ulimit -f 1; exec \"$0\" render --device cpu --res 400x400 -o link.ppm scene.txt";
    let mut shell = Command::new("sh");
    shell.args(["-c", limited, env!("CARGO_BIN_EXE_trueray")]).current_dir(place.folder());
    assert_eq!(shell.output().unwrap().status.code(), Some(6));
    assert_eq!(fs::read_dir(place.path("folder")).unwrap().count(), 0);
    place.exits("render --device cpu -o link.ppm scene.txt", 0, "");
    assert!(place.read("folder/new.ppm").starts_with(b"P6\n16 8"));
    assert!(fs::symlink_metadata(place.path("link.ppm")).unwrap().is_symlink());
}

// --- room -----------------------------------------------------------------------------------------------------------

/// Hundreds of terabytes: refused before the first byte.
#[cfg(unix)]
#[test]
fn a_picture_that_cannot_fit_is_not_begun() {
    for (output, format) in [("big.ppm", "p6"), ("big.ppm", "p3"), ("big.png", "png")] {
        let place = Folder::new();
        write_scene(&place, "scene.txt", &format!("RES 16777216 16777216\nOUTPUT {output}"));
        let start = Instant::now();
        place.exits(&format!("render --device cpu --format {format} scene.txt"), 6, "B are free");
        assert!(start.elapsed() < Duration::from_secs(20));
        assert_eq!(place.files(), ["scene.txt"]);
    }
}

/// Beyond the limit of a file's size nothing replaces what was there.
#[cfg(unix)]
#[test]
fn a_limit_of_file_size_is_an_error_and_leaves_the_old_file() {
    let place = with_scene("OUTPUT out.ppm");
    place.write("out.ppm", OLD);
    place.write("stats.json", "old");
    for (arguments, name) in [
        ("render -q --device cpu --res 400x400 scene.txt", "out.ppm"),
        ("render -q --device cpu --res 400x400 -o new.ppm scene.txt", "new.ppm"),
        ("render -q --device cpu -o /dev/null --stats-json stats.json scene.txt", "stats.json"),
    ] {
        // In blocks of 512 or 1024 bytes.
        let limited = format!("ulimit -f 1; exec \"$0\" {arguments}");
        let output = Command::new("sh")
            .args(["-c", &limited, env!("CARGO_BIN_EXE_trueray")])
            .current_dir(place.folder())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(6), "{arguments}: {stderr}");
        assert!(stderr.contains(name), "{stderr}");
        assert_eq!(place.read("out.ppm"), OLD.as_bytes());
        assert_eq!(place.read("stats.json"), b"old");
        assert_eq!(place.files(), ["out.ppm", "scene.txt", "stats.json"]);
    }
}

// --- interruptions --------------------------------------------------------------------------------------------------

/// Numbers that are the same on every machine.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as f64 / (1_u64 << 31) as f64
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap().success());
}

/// The signals by name and number.
#[cfg(unix)]
const SIGNALS: [(&str, i32); 4] = [("INT", 2), ("TERM", 15), ("HUP", 1), ("XCPU", 24)];

/// Interrupts at random moments: the old picture or the whole new one, and nothing beside it. `TRUERAY_INTERRUPTS` says how many.
#[cfg(unix)]
#[test]
fn interrupts_leave_the_old_picture_or_the_new_one_and_nothing_else() {
    use std::os::unix::process::ExitStatusExt;

    let count = std::env::var("TRUERAY_INTERRUPTS").ok().and_then(|count| count.parse().ok()).unwrap_or(24);
    let place = Folder::new();
    write_scene(&place, "scene.txt", "RES 1500 1500\nOUTPUT out.ppm");
    let command = || place.command("render -q --device cpu scene.txt");
    let start = Instant::now();
    assert!(command().status().unwrap().success());
    let (all, new) = (start.elapsed(), place.read("out.ppm"));
    let mut state = 7;
    let (mut interrupted, mut latency) = (0, Duration::ZERO);
    for (signal, number) in SIGNALS.into_iter().cycle().take(count) {
        place.write("out.ppm", OLD);
        let mut child = command().spawn().unwrap();
        sleep(all.mul_f64(random(&mut state)));
        send(signal, &child);
        let start = Instant::now();
        let status = child.wait().unwrap();
        latency = latency.max(start.elapsed());
        let now = place.read("out.ppm");
        if status.success() {
            assert!(now == new);
        } else {
            // SIGTERM asks for another try, as soon as the program has begun.
            let is_stopped = signal == "TERM" && status.code() == Some(75);
            assert!(is_stopped || status.signal() == Some(number), "{signal}: {status}");
            assert!(now == OLD.as_bytes() || now == new, "{signal}: {} bytes", now.len());
            interrupted += 1;
        }
        assert_eq!(place.files(), ["out.ppm", "scene.txt"], "{signal}");
    }
    say("interrupts", &format!("{interrupted} of {count} in time, {:.0} ms at the most", latency.as_secs_f64() * 1e3));
    assert!(interrupted > count / 4, "{interrupted} of {count}");
    assert!(latency < Duration::from_secs(5), "{latency:?}");
}

/// What a killed process leaves goes with the next run of the same picture, but not while another process writes it.
#[cfg(unix)]
#[test]
fn what_a_kill_leaves_goes_with_the_next_run() {
    let place = Folder::new();
    write_scene(&place, "scene.txt", "RES 6000 6000\nOUTPUT out.ppm");
    place.write("out.ppm", OLD);
    let left = |place: &Folder| place.files().iter().filter(|name| name.contains(".trueray-")).count();
    let started = |others: usize| {
        let child = place.command("render -q --device cpu scene.txt").spawn().unwrap();
        let start = Instant::now();
        while left(&place) <= others {
            assert!(start.elapsed() < Duration::from_secs(60), "it never began to write");
            sleep(Duration::from_millis(1));
        }
        child
    };
    let mut killed = started(0);
    send("KILL", &killed);
    killed.wait().unwrap();
    assert_eq!(left(&place), 1);
    assert_eq!(place.read("out.ppm"), OLD.as_bytes());

    // Its file goes when the next one begins; that one's does not when a third does.
    let mut first = place.command("render -q --device cpu scene.txt").spawn().unwrap();
    sleep(Duration::from_millis(300));
    assert_eq!(left(&place), 1);
    let mut second = started(1);
    assert_eq!(left(&place), 2);
    send("INT", &second);
    second.wait().unwrap();
    assert_eq!(left(&place), 1);
    send("INT", &first);
    first.wait().unwrap();
    assert_eq!(place.files(), ["out.ppm", "scene.txt"]);

    send("KILL", &started(0));
    sleep(Duration::from_millis(200));
    place.exits("render -q --device cpu --res 8x8 scene.txt", 0, "");
    assert_eq!(place.files(), ["out.ppm", "scene.txt"]);
    assert_ne!(place.read("out.ppm"), OLD.as_bytes());
}

/// `nohup` and shells that start something in the background want signals ignored.
#[cfg(target_os = "linux")]
#[test]
fn ignored_signals_stay_ignored() {
    let place = Folder::new();
    write_scene(&place, "scene.txt", "RES 2000 2000\nOUTPUT out.ppm");
    let command = "trap '' HUP; exec \"$0\" render -q --device cpu scene.txt";
    let mut shell = Command::new("sh");
    shell.args(["-c", command, env!("CARGO_BIN_EXE_trueray")]).current_dir(place.folder());
    let mut child = shell.spawn().unwrap();
    sleep(Duration::from_millis(100));
    send("HUP", &child);
    assert!(child.wait().unwrap().success());
    assert_eq!(place.files(), ["out.ppm", "scene.txt"]);
}

// --- progress and unfinished measurements ---------------------------------------------------------------------------

/// The events of `--progress json`.
fn events(stderr: &[u8]) -> Vec<serde_json::Value> {
    let lines = std::str::from_utf8(stderr).unwrap().lines().filter(|line| line.starts_with('{'));
    lines.map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn progress_tells_percent_and_time_left_and_ends_with_an_event() {
    let place = with_scene("OUTPUT out.ppm");
    let output = place.exits("render --device cpu --progress json scene.txt", 0, "");
    let few = events(&output.stderr);
    assert_eq!(few.len(), 1);
    assert_eq!((&few[0]["percent"], &few[0]["finished"]), (&100.0.into(), &true.into()));

    let output = place.exits("render --device cpu --progress json --res 1500x1500 --spp 25 scene.txt", 0, "");
    let many = events(&output.stderr);
    let (last, before) = many.split_last().unwrap();
    assert_eq!(
        (&last["percent"], &last["finished"], &last["seconds_left"]),
        (&100.0.into(), &true.into(), &0.0.into())
    );
    let percents: Vec<_> = before.iter().map(|event| event["percent"].as_f64().unwrap()).collect();
    // As many as seconds, about, from the beginning on.
    let seconds = last["seconds"].as_f64().unwrap();
    assert!(percents.is_sorted() && percents.len() as f64 >= seconds / 3.0 - 1.0, "{percents:?} in {seconds} s");
    assert!(before.iter().all(|event| event["seconds_left"].as_f64().is_some() && event["finished"] == false));

    let output = place.exits("render --device cpu --progress lines scene.txt", 0, "scene.txt: 100 %");
    assert!(events(&output.stderr).is_empty());
    for arguments in ["render -q --device cpu --progress json scene.txt", "render --device cpu scene.txt"] {
        assert!(events(&place.exits(arguments, 0, "").stderr).is_empty(), "{arguments}");
    }
}

/// Runs until `ready` says so, interrupts, and returns what the program said.
#[cfg(unix)]
fn interrupted(place: &Folder, arguments: &str, ready: impl Fn(&Path) -> bool) -> Output {
    use std::os::unix::process::ExitStatusExt;
    let printed = fs::File::create(place.path("printed")).unwrap();
    let child = place.command(arguments).stdout(printed).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !ready(&place.path("printed")) {
        assert!(start.elapsed() < Duration::from_secs(120), "{arguments}: it never came so far");
        sleep(Duration::from_millis(20));
    }
    send("INT", &child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

#[cfg(unix)]
#[test]
fn interrupted_measurements_are_written() {
    let place = with_scene("OUTPUT out.ppm");
    // A table begins when the first scene is done.
    let lines = |least: usize| move |printed: &Path| fs::read_to_string(printed).unwrap().lines().count() >= least;
    let bench = "bench --device cpu --families classic,spheres --res 16x16 --runs 20 --report b.html --csv b.csv";
    let output = interrupted(&place, bench, lines(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted"));
    assert!(fs::read_to_string(place.path("b.csv")).unwrap().lines().count() >= 2);
    assert!(fs::read_to_string(place.path("b.html")).unwrap().ends_with("</html>"));

    // The first scene is done, the second takes for ever.
    write_scene(&place, "large.txt", "RES 3000 3000");
    let study = "study --device cpu scene.txt large.txt --runs 3 --spp-list 1 --depths 0 --report s.html --json s.json";
    let output = interrupted(&place, study, lines(10));
    assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted"));
    let json: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    assert_eq!(json["studies"][0]["scene"], "scene.txt");
    assert!(fs::read_to_string(place.path("s.html")).unwrap().ends_with("</html>"));
    assert!(place.files().iter().all(|name| !name.contains(".trueray-")));

    // Of the first scene at least one picture is graded, the second takes for ever.
    for folder in ["scenes", "theirs"] {
        fs::create_dir(place.path(folder)).unwrap();
    }
    write_scene(&place, "scenes/a.txt", "RES 16 8");
    write_scene(&place, "scenes/b.txt", "RES 9000 9000");
    place.exits("render -q --device cpu scenes/a.txt -o a.ppm", 0, "");
    for student in ["ann", "bob"] {
        fs::create_dir(place.path(&format!("theirs/{student}"))).unwrap();
        fs::copy(place.path("a.ppm"), place.path(&format!("theirs/{student}/a.ppm"))).unwrap();
    }
    let grade = "grade --device cpu --scenes scenes --theirs theirs --html g.html --csv g.csv --json g.json";
    let pages = |printed: &Path| fs::read_dir(printed.with_file_name("g_files")).is_ok_and(|pages| pages.count() == 2);
    let output = interrupted(&place, grade, pages);
    assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted; what was graded is written"));
    let json: serde_json::Value = serde_json::from_slice(&place.read("g.json")).unwrap();
    assert_eq!((&json["interrupted"], &json["rows"][0]["score"]), (&true.into(), &100.into()));
    assert!(fs::read_to_string(place.path("g.html")).unwrap().contains("Interrupted: not all"));
    assert!(fs::read_to_string(place.path("g.csv")).unwrap().lines().count() >= 2);

    if gpu("interrupted_measurements_are_written").is_some() {
        let json = place.exits(
            "stress --count 64 --class far --precision fast --json --progress json",
            0,
            "\"finished\":true",
        );
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        assert!(json.get("interrupted").is_none());
        interrupted(&place, "stress --count 20000 --precision fast", lines(4));
        // However far it came, that is what it prints.
        let start = Instant::now();
        interrupted(&place, "stress --count 20000 --json", |_| start.elapsed() > Duration::from_secs(2));
        let json: serde_json::Value = serde_json::from_slice(&place.read("printed")).unwrap();
        assert_eq!(json["interrupted"], true);
        assert!(json["rows"].is_array());
    }
}

//! Parts of a picture: each pixel is that of the whole one, files say what they are of, and `merge` takes what fits together alone.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use tempfile::TempDir;
use trueray::area::Area;
use trueray::bench::Family;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, render_picture};
use trueray::film::{Format, PictureWriter, RowReader, Target};
use trueray::gpu::Gpu;
use trueray::misuse::Misuse;
use trueray::part::{Claim, Puzzle, overlap};
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::verify::Verify;

use crate::support::{Folder, gpu, root, say, scene};

const SIZE: (u32, u32) = (93, 61);

/// Spheres large and small, mirrors, shadows, glass.
fn scenes() -> Vec<Scene> {
    let file = |name: &str| scene(&root().join("scenes").join(name));
    let many = Family::named("spheres").unwrap().scene(400);
    let sized = |scene| Scene { width: SIZE.0, height: SIZE.1, ..scene };
    [file("show/showcase.txt"), file("effects/refraction.txt"), many].map(sized).into()
}

fn area(left: u32, right: u32, top: u32, bottom: u32) -> Area {
    Area { top, left, width: right - left, height: bottom - top }
}

/// A pixel, a row, a column, corners, tiles and what cuts through them.
fn areas() -> Vec<Area> {
    let (width, height) = SIZE;
    vec![
        area(46, 47, 30, 31),
        area(0, width, 17, 18),
        area(41, 42, 0, height),
        area(0, 8, 0, 8),
        area(89, width, 59, height),
        area(3, 71, 5, 50),
        area(40, 64, 16, 40),
        Area::whole(SIZE),
    ]
}

fn cut(rgb: &[u8], area: Area) -> Vec<u8> {
    let row = |y: u32| &rgb[(y * SIZE.0 + area.left) as usize * 3..(y * SIZE.0 + area.right()) as usize * 3];
    (area.top..area.bottom()).flat_map(row).copied().collect()
}

fn backends(gpu: Option<&Gpu>) -> Vec<Backend<'_>> {
    let of = |gpu| [Tier::Fast, Tier::Robust, Tier::Double].map(|tier| Backend::Device(gpu, tier));
    let certified = |gpu| Backend::Certified(gpu, Tier::Fast);
    let devices = gpu.into_iter().flat_map(|gpu| of(gpu).into_iter().chain([certified(gpu)]));
    std::iter::once(Backend::Reference).chain(devices).collect()
}

#[test]
fn each_pixel_of_a_part_is_that_of_the_picture_whatever_renders() {
    let gpu = gpu("each_pixel_of_a_part_is_that_of_the_picture_whatever_renders");
    for (scene, settings) in scenes().iter().zip([Settings::classic(), Settings::exact(), Settings::exact()]) {
        let effects = Effects::of(&scene.viewed(&settings));
        for backend in backends(gpu.as_deref()) {
            let options = Options { count_rays: true, ..Options::default() };
            let mut engine = Engine::with(backend, scene.viewed(&settings), &effects, &options).unwrap();
            let (whole, _) = render_picture(&mut engine).unwrap();
            let rays = engine.rays();
            let mut parts = Vec::new();
            for area in areas() {
                let viewed = scene.viewed(&settings).within(area).unwrap();
                let verify = Verify::Some(std::num::NonZero::new(16).unwrap());
                let mut engine = Engine::verified(backend, viewed, &effects, &options, verify).unwrap();
                // What is unsure goes through `double`, too.
                engine = engine.with_double_from(1);
                let (rgb, _) = render_picture(&mut engine).unwrap();
                assert!(rgb == cut(&whole, area), "{area} at {backend:?}");
                parts.push((area, engine.rays()));
            }
            assert_eq!(parts.last().unwrap().1, rays, "the whole as a part");
            let primary = parts[0].1.unwrap().primary;
            assert_eq!(primary, u64::from(settings.pattern.count()), "a pixel");
        }
    }
}

/// A part costs no more than its pixels: no other tile is dispatched or listed.
#[test]
fn a_part_takes_no_more_than_it_needs() {
    let (scene, settings) = (&scenes()[2], Settings::classic());
    let effects = Effects::of(&scene.viewed(&settings));
    let listed = |viewed: &trueray::viewed::ViewedScene| {
        let lists = trueray::accel::Acceleration::new(viewed, effects.set, trueray::accel::Rounding::SINGLE);
        let cover = lists.screen.cover();
        (lists.screen.lists.entries.len(), cover.covered(0, SIZE.1).len())
    };
    let (entries, tiles) = listed(&scene.viewed(&settings));
    let part = area(40, 64, 16, 40);
    let (few_entries, few_tiles) = listed(&scene.viewed(&settings).within(part).unwrap());
    assert!(few_tiles <= 9 && tiles > 50, "{few_tiles} of {tiles}");
    assert!(few_entries * 5 < entries, "{few_entries} of {entries}");
}

#[test]
fn tiles_have_every_row_once() {
    for (count, height) in [(1, 1), (3, 3), (4, 32), (5, 100), (8, 61), (9, 61), (61, 61), (7, 16_777_216)] {
        let mut next = 0;
        for index in 0..count {
            let tile = Area::tile(index, count, (10, height)).unwrap();
            assert_eq!((tile.left, tile.width, tile.top), (0, 10, next), "{index} of {count}");
            assert!(tile.height > 0);
            assert!(next % 8 == 0 || count > height.div_ceil(8), "whole tiles while there are enough");
            next = tile.bottom();
        }
        assert_eq!(next, height);
    }
    for (index, count, height) in [(2, 2, 10), (0, 0, 10), (0, 11, 10)] {
        let error = Area::tile(index, count, (10, height)).unwrap_err();
        assert_eq!(error, Misuse::Tile { index, count, height });
    }
}

#[test]
fn only_parts_of_the_picture_are_rendered() {
    let (scene, settings) = (&scenes()[0], Settings::classic());
    for area in [area(0, 94, 0, 1), area(93, 94, 0, 1), area(0, 1, 61, 62), area(0, 1, 60, 62)] {
        let error = scene.viewed(&settings).within(area).unwrap_err();
        assert_eq!(error, Misuse::Area { area, size: SIZE });
    }
}

#[test]
fn what_is_missing_is_named_whole() {
    let size = (10, 10);
    assert!(Puzzle::new(size, &[Area::whole(size)]).missing.is_empty());
    assert_eq!(Puzzle::new(size, &[]).missing, [Area::whole(size)]);
    let missing = Puzzle::new(size, &[area(0, 4, 0, 10), area(4, 10, 0, 3), area(6, 10, 3, 7)]).missing;
    assert_eq!(missing, [area(4, 6, 3, 7), area(4, 10, 7, 10)]);
    let missing = Puzzle::new(size, &[area(2, 4, 2, 4)]).missing;
    assert_eq!(missing, [area(0, 10, 0, 2), area(0, 2, 2, 4), area(4, 10, 2, 4), area(0, 10, 4, 10)]);
    assert_eq!(overlap(&[area(0, 5, 0, 5), area(5, 10, 0, 5), area(0, 10, 5, 10)]), None);
    assert_eq!(overlap(&[area(0, 10, 5, 10), area(9, 10, 0, 5), area(2, 3, 9, 12)]), Some([0, 2]));
}

// --- the program ----------------------------------------------------------------------------------------------------

/// With a scene in `scene.txt`.
fn folder() -> Folder {
    Folder::with_scene(&fs::read_to_string(root().join("scenes/effects/shadows.txt")).unwrap())
}

/// Renders with these options to this file.
#[track_caller]
fn render(place: &Folder, options: &str, output: &str) {
    place.exits(&format!("render -q --device cpu --res 50x40 {options} scene.txt -o {output}"), 0, "");
}

#[test]
fn parts_make_the_very_file_of_one_run() {
    let place = folder();
    for ending in ["png", "ppm"] {
        render(&place, "", &format!("one.{ending}"));
    }
    let merged = |parts: &str| {
        for ending in ["png", "ppm"] {
            place.exits(&format!("merge {parts} -o merged.{ending}"), 0, "50 × 40 from");
            assert!(place.read(&format!("merged.{ending}")) == place.read(&format!("one.{ending}")), "{parts}");
        }
    };
    for index in 0..3 {
        render(&place, &format!("--tile {index}/3"), &format!("tile-{index}.png"));
    }
    merged("tile-2.png tile-0.png tile-1.png");
    for (index, crop) in ["0,13,0,40", "13,50,0,1", "13,14,1,40", "14,50,1,40"].iter().enumerate() {
        render(&place, &format!("--crop {crop}"), &format!("crop-{index}.{}", ["ppm", "png"][index % 2]));
    }
    merged("crop-0.ppm crop-1.png crop-2.ppm crop-3.png");
    render(&place, "--resume", "whole.png");
    merged("whole.png");
    // A part is an ordinary picture of its size.
    place.exits("compare --scene scene.txt tile-0.png", 2, "");
    place.exits("compare crop-2.ppm crop-2.ppm", 0, "");
}

/// A device's parts in files, at the tier that `auto` takes and certified, where the CPU has a share.
#[test]
fn parts_of_a_device_make_its_picture() {
    let test = "parts_of_a_device_make_its_picture";
    let Some(held) = gpu(test) else { return };
    drop(held);
    let place = folder();
    let device = |options: &str| place.exits(&format!("render -q --res 50x40 scene.txt {options}"), 0, "");
    device("--device gpu -o one.png");
    device("--device gpu --tile 0/2 -o a.png");
    device("--device gpu --tile 1/2 -o b.png");
    place.exits("merge a.png b.png -o merged.png", 0, "");
    assert!(place.read("merged.png") == place.read("one.png"));

    render(&place, "--tile 1/2", "cpu.png");
    place.exits("merge a.png cpu.png -o no.png", 2, "precision is");
    device("--device gpu --precision certified --tile 0/2 -o certified.png");
    place.exits("merge certified.png cpu.png -o merged.png", 0, "");
    render(&place, "", "cpu-one.png");
    assert!(place.read("merged.png") == place.read("cpu-one.png"));
    // As another device's.
    with_other_note(&place, "b.png", "other.png", |note| note.replacen(r#""device":""#, r#""device":"another "#, 1));
    place.exits("merge a.png other.png -o no.png", 2, "other.png by another");
    place.exits("merge --allow-mixed-devices a.png other.png -o mixed.png", 0, "");
    assert!(place.read("mixed.png") == place.read("one.png") && !place.path("no.png").exists());
}

/// The same picture with a note that `change` makes of its own.
fn with_other_note(place: &Folder, from: &str, to: &str, change: impl Fn(&str) -> String) {
    let mut reader = RowReader::open(&place.path(from)).unwrap();
    let (width, height) = reader.size();
    let note = change(reader.note().unwrap());
    let format = Format::from_extension(&place.path(to)).unwrap();
    let target = Target::File(place.path(to));
    let mut writer = PictureWriter::with_note(&target, format, (width, height), Some(&note)).unwrap();
    let mut row = vec![0; width as usize * 3];
    for _ in 0..height {
        reader.read(&mut row).unwrap();
        writer.write_rows(&row).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let place = folder();
    for (options, name) in [
        ("--crop 0,50,0,20", "top.png"),
        ("--crop 0,50,20,40", "low.png"),
        ("--crop 0,30,20,40", "left.ppm"),
        ("--crop 0,50,19,40", "more.png"),
        ("--max-depth 1 --crop 0,50,20,40", "depth.png"),
        ("--eye 0,0,0.1 --crop 0,50,20,40", "eye.png"),
        ("--effects=-shadows --crop 0,50,20,40", "effects.png"),
        ("", "plain.png"),
    ] {
        render(&place, options, name);
    }
    place.exits("render -q --device cpu --res 50x41 --crop 0,50,20,40 scene.txt -o size.png", 0, "");
    let scene = fs::read_to_string(place.path("scene.txt")).unwrap();
    fs::write(place.path("scene.txt"), format!("{scene}\nSPHERE another 0 0 -3 0.1 0.1 0.1 1 1 1 1 1 1 0 9\n"))
        .unwrap();
    place.exits("render -q --device cpu --res 50x40 --crop 0,50,20,40 scene.txt -o scene.png", 0, "");
    with_other_note(&place, "low.png", "version.png", |note| note.replacen("trueray 0", "trueray 99", 1));
    with_other_note(&place, "low.png", "lie.png", |note| note.replacen("[0,50,20,40]", "[0,50,20,39]", 1));
    with_other_note(&place, "low.png", "beyond.png", |note| note.replacen("[0,50,20,40]", "[0,50,21,41]", 1));
    with_other_note(&place, "low.png", "noise.png", |_| "{\"size\":7".into());
    let low = place.read("low.png");
    fs::write(place.path("cut.png"), &low[..low.len() - 12]).unwrap();
    fs::write(place.path("short.png"), &low[..low.len() / 2]).unwrap();
    let mut flipped = low.clone();
    let middle = low.len() - 30;
    flipped[middle] ^= 1;
    fs::write(place.path("flipped.png"), &flipped).unwrap();
    let left = place.read("left.ppm");
    fs::write(place.path("cut.ppm"), &left[..left.len() - 1]).unwrap();
    fs::write(place.path("long.ppm"), [&left[..], b"x"].concat()).unwrap();
    for (parts, code, message) in [
        ("top.png", 1, "--crop 0,50,20,40"),
        ("top.png left.ppm", 1, "--crop 30,50,20,40"),
        ("top.png more.png", 2, "top.png and more.png overlap"),
        ("top.png low.png low.png", 2, "low.png and low.png overlap"),
        ("top.png depth.png", 2, "depth.png is of another picture than top.png: "),
        ("top.png eye.png", 2, "settings.view.eye"),
        ("top.png effects.png", 2, "effects is"),
        ("top.png size.png", 2, "size is 50x41 there and 50x40 in top.png"),
        ("top.png scene.png", 2, "scene."),
        ("top.png version.png", 2, "program is"),
        ("top.png plain.png", 2, "plain.png: it does not say of what it is"),
        ("top.png lie.png", 2, "lie.png: it has 50x20 pixels, and its note is of 50x19"),
        ("top.png beyond.png", 2, "beyond.png: its note is of no part"),
        ("top.png noise.png", 2, "noise.png: its note is damaged"),
        ("top.png cut.png", 2, "cut.png"),
        ("top.png short.png", 2, "short.png"),
        ("top.png flipped.png", 2, "flipped.png"),
        ("top.png cut.ppm", 2, "cut.ppm: the file has"),
        ("top.png long.ppm", 2, "long.ppm: the file has"),
        ("top.png gone.png", 2, "gone.png"),
        ("top.png scene.txt", 2, "scene.txt"),
    ] {
        place.exits(&format!("merge {parts} -o no.png"), code, message);
        assert!(!place.path("no.png").exists(), "{parts}");
    }
    place.exits("merge top.png low.png -o top.png", 6, "an input of this run");
    place.exits("merge top.png low.png -o folder/no.png", 6, "there is no folder");
}

#[test]
fn parts_that_there_are_not_are_refused() {
    let place = folder();
    for (options, message) in [
        ("--crop 0,51,0,1 -o no.png", "the rectangle 0,51,0,1 is not within a picture of 50x40 pixels"),
        ("--crop 50,51,0,1 -o no.png", "not within"),
        ("--crop 4,4,0,1 -o no.png", "the rectangle is empty"),
        ("--crop 4,2,0,1 -o no.png", "the rectangle is empty"),
        ("--crop 4,5 -o no.png", "expected four numbers"),
        ("--crop -1,5,0,1 -o no.png", "expected four numbers"),
        ("--tile 2/2 -o no.png", "there is no part 2 of 2"),
        ("--tile 0/0 -o no.png", "there is no part 0 of 0"),
        ("--tile 1 -o no.png", "expected two numbers"),
        ("--tile 0/41 -o no.png", "a picture of 40 rows has no 41 parts"),
        ("--tile 0/2 --crop 0,1,0,1 -o no.png", "cannot be used with"),
        ("--tile 0/2", "need -o"),
        ("--tile 0/2 -o .", "no folder"),
        ("--tile 0/2 scene.txt -o no.png", ""),
        ("--tile 0/2 --sparse 0.5 -o no.png", "cannot be used with"),
        ("--crop 0,1,0,1 --aov t -o no.png", "cannot be used with"),
        ("--resume --certificate c.json -o no.png", "cannot be used with"),
        ("--resume -o -", "--resume needs a file"),
        ("--tile 0/2 --format p3 -o no.png", "no p3"),
    ] {
        place.exits(&format!("render --device cpu --res 50x40 scene.txt {options}"), 2, message);
        assert!(!place.path("no.png").exists(), "{options}");
    }
}

#[test]
fn what_is_there_and_whole_is_not_rendered_again() {
    let place = folder();
    let run = |options: &str, code: i32, message: &str| {
        place.exits(&format!("render --device cpu --res 50x40 --resume scene.txt {options}"), code, message)
    };
    let modified = |name: &str| fs::metadata(place.path(name)).unwrap().modified().unwrap();
    for name in ["a.png", "a.ppm"] {
        run(&format!("--tile 1/2 -o {name}"), 0, "50 × 24");
        let (before, time) = (place.read(name), modified(name));
        run(&format!("--tile 1/2 -o {name}"), 0, "is there already");
        assert_eq!(modified(name), time);
        for (options, message) in [
            ("--tile 0/2", "it is part 0,50,16,40, not 0,50,0,16"),
            ("--tile 1/2 --max-depth 7", "is another picture: "),
            ("", "it is part"),
        ] {
            run(&format!("{options} -o {name}"), 6, message);
        }
        assert!(place.read(name) == before && modified(name) == time);
        // Cut off, or nothing: what a crash of the system can leave.
        for length in [0, 5, 100, before.len() / 2, before.len() - 1] {
            fs::write(place.path(name), &before[..length]).unwrap();
            run(&format!("--tile 1/2 -o {name}"), 0, "50 × 24");
            assert!(place.read(name) == before, "{length} bytes of {name}");
        }
    }
    // What is cut off may be somebody else's, or a part of something else.
    render(&place, "", "plain.ppm");
    let plain = place.read("plain.ppm");
    render(&place, "--tile 0/2", "other.ppm");
    let other = place.read("other.ppm");
    for contents in [&plain[..plain.len() - 1], &other[..other.len() - 1], b"P6\n# my notes\n"] {
        fs::write(place.path("cut.ppm"), contents).unwrap();
        run("--tile 1/2 -o cut.ppm", 6, "cut.ppm is another picture");
        assert!(place.read("cut.ppm") == contents);
    }
    fs::write(place.path("text.png"), "not a picture").unwrap();
    run("-o text.png", 6, "text.png is another picture");
    render(&place, "", "plain.png");
    run("-o plain.png", 6, "it does not say of what it is");
    // A whole picture is one part; and without --resume all are replaced.
    run("-o whole.png", 0, "50 × 40");
    run("-o whole.png", 0, "is there already");
    render(&place, "", "whole.png");
    assert!(place.read("whole.png") == place.read("plain.png"));
}

/// What was asked for is named before what follows from it, such as the tier.
#[test]
fn the_cause_of_another_picture_is_named() {
    if gpu("parts::the_cause_of_another_picture_is_named").is_none() {
        return;
    }
    let place = folder();
    let run = |options: &str, code: i32, message: &str| {
        place.exits(&format!("render --device gpu --res 50x40 --resume scene.txt -o a.png {options}"), code, message)
    };
    run("--precision fast", 0, "");
    let asked = "is another picture: settings.view.projection is none there and \"orthographic\" here";
    run("--precision double --projection orthographic", 6, asked);
    run("--precision double --max-depth 1", 6, "is another picture: settings.max_depth is 3 there and 1 here");
    run("--precision double", 6, "is another picture: precision is \"fast\" there and \"double\" here");
}

/// Random ends of a division, each repeated until all parts are there. `TRUERAY_KILLS` says how many.
#[cfg(unix)]
#[test]
fn whatever_ends_a_run_its_repetition_ends_in_the_same_bytes() {
    let kills = std::env::var("TRUERAY_KILLS").ok().and_then(|count| count.parse().ok()).unwrap_or(6);
    let place = folder();
    let options = "render -q --device cpu --res 900x700 --spp 9 scene.txt";
    place.exits(&format!("{options} -o one.png"), 0, "");
    let tile = |index: u32| place.command(&format!("{options} --tile {index}/3 --resume -o part-{index}.png"));
    let start = Instant::now();
    assert!(tile(0).status().unwrap().success());
    let (all, mut ended, mut state) = (start.elapsed(), 0, 7_u64);
    for kill in 0..kills {
        let (index, signal) = (kill % 3, ["KILL", "TERM"][kill as usize / 3 % 2]);
        let _ = fs::remove_file(place.path(&format!("part-{index}.png")));
        let mut child = tile(index).spawn().unwrap();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        sleep(all.mul_f64((state >> 33) as f64 / (1_u64 << 31) as f64));
        Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
        let status = child.wait().unwrap();
        // A process without a code has ended by the signal: by SIGTERM before the program has begun.
        assert!(matches!(status.code(), Some(0 | 75) | None), "{signal}: {status}");
        ended += u32::from(!status.success());
        if kill % 3 == 2 || kill + 1 == kills {
            (0..3).for_each(|index| assert!(tile(index).status().unwrap().success(), "{index}"));
            place.exits("merge part-0.png part-1.png part-2.png -o merged.png", 0, "");
            assert!(place.read("merged.png") == place.read("one.png"), "after {kill}");
        }
    }
    say("parts", &format!("{ended} of {kills} runs ended before their time"));
    assert!(kills < 6 || ended > 1, "{ended} of {kills}");
    let left = fs::read_dir(place.folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(left.filter(|name| name.contains(".trueray-")).count(), 0, "nothing half-written stays");
}

/// What a scheduler reads of a run.
#[cfg(unix)]
#[test]
fn a_stopped_run_asks_to_be_repeated_and_tells_openjd_so() {
    let place = folder();
    let mut child = place
        .command("render --progress openjd --device cpu --res 3000x3000 --spp 256 scene.txt -o long.png")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    sleep(Duration::from_millis(2500));
    Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    let start = Instant::now();
    let code = child.wait().unwrap().code();
    assert!(start.elapsed() < Duration::from_secs(4), "between rows, not after the time of grace");
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(code, Some(75), "{stderr}");
    assert!(stderr.contains("openjd_fail: ended as it was asked to"), "{stderr}");
    assert!(!place.path("long.png").exists());
    let output =
        place.exits("render --progress openjd --device cpu --res 50x40 scene.txt -o a.png", 0, "openjd_status: ");
    let stderr = String::from_utf8_lossy(&output.stderr);
    let mut progress = stderr.lines().rev().filter_map(|line| line.strip_prefix("openjd_progress: "));
    assert_eq!(progress.next().map(|part| part.parse::<f64>().unwrap()), Some(100.0), "{stderr}");
    place.exits("render --progress openjd --device cpu gone.txt -o a.png", 3, "openjd_fail: ");
    fs::write(place.path("bad.txt"), "SPHER\n").unwrap();
    place.exits("render -q --progress openjd --device cpu bad.txt -o a.png", 3, "openjd_fail: ");
}

// --- whatever a file says -------------------------------------------------------------------------------------------

/// A picture of 3 by 2 pixels in each format, with a note.
fn noted(place: &TempDir, ending: &str, note: &str) -> Vec<u8> {
    let path = place.path().join(format!("noted.{ending}"));
    let format = Format::from_extension(&path).unwrap();
    let mut writer = PictureWriter::with_note(&Target::File(path.clone()), format, (3, 2), Some(note)).unwrap();
    writer.write_rows(&[9; 18]).unwrap();
    writer.finish().unwrap();
    fs::read(path).unwrap()
}

const NOTE: &str = r#"{"device":"ü","precision":"fast","size":[3,4],"area":[0,3,1,3],"scene":{"sha256":"0"}}"#;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(
        std::env::var("TRUERAY_FUZZ_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(300)
    ) })]

    #[test]
    fn changed_files_are_an_answer_and_no_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4), cut in any::<prop::sample::Index>(), cuts: bool) {
        let place = tempfile::tempdir().unwrap();
        for ending in ["png", "ppm"] {
            let mut bytes = noted(&place, ending, NOTE);
            for (index, byte) in &changes {
                let at = index.index(bytes.len());
                bytes[at] = *byte;
            }
            if cuts {
                bytes.truncate(cut.index(bytes.len()));
            }
            let path = place.path().join("changed");
            fs::write(&path, &bytes).unwrap();
            if let Ok(reader) = RowReader::open(&path) {
                let (size, note) = (reader.size(), reader.note().map(str::to_owned));
                let _ = note.map(|note| Claim::parse(&note, size));
                if size.0 < 1000 && size.1 < 100_000 {
                    let _ = reader.check();
                }
            }
        }
    }

    #[test]
    fn any_note_is_an_answer_and_no_panic(note in "\\PC{0,40}|[\\[\\]{}:,\"0-9a-z]{0,60}", changes in prop::collection::vec((any::<prop::sample::Index>(), any::<char>()), 0..4), width: u32, height: u32) {
        let _ = Claim::parse(&note, (width, height));
        let mut changed: Vec<char> = NOTE.chars().collect();
        for (index, c) in changes {
            let at = index.index(changed.len());
            changed[at] = c;
        }
        let changed: String = changed.into_iter().collect();
        if let Ok(claim) = Claim::parse(&changed, (3, 2)) {
            let _ = claim.difference(&Claim::parse(NOTE, (3, 2)).unwrap());
        }
        let numbers = format!(r#"{{"device":"","precision":"","size":[{width},{height}],"area":[{width},{height},0,{width}]}}"#);
        let _ = Claim::parse(&numbers, (width, height));
    }
}

#[test]
fn notes_come_back() {
    let place = tempfile::tempdir().unwrap();
    for ending in ["png", "ppm"] {
        noted(&place, ending, NOTE);
        let reader = RowReader::open(&place.path().join(format!("noted.{ending}"))).unwrap();
        assert_eq!((reader.size(), reader.note()), ((3, 2), Some(NOTE)));
        let claim = Claim::parse(NOTE, (3, 2)).unwrap();
        assert_eq!((claim.size, claim.area, claim.device.as_str()), ((3, 4), area(0, 3, 1, 3), "ü"));
        reader.check().unwrap();
    }
}

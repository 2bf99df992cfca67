//! Colour bars: where their colours, ticks and numbers are, in every kind of file; what stays as it was; what is refused.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster};
use trueray::DVec3;
use trueray::color_bar::{ColorBar, Side};
use trueray::film::Picture;
use trueray::import::{ColorScale, Map};
use trueray::linear::Linear;
use trueray::settings::Quantize;

use crate::support::{Folder, gpu};

const POINTS: &str = "x,y,z,speed,kind,none\n0,0,0,0,a,\n0.5,1,0.5,10,b,\n0,2,0,4,a,\n";
const USUAL: &str = "-q --device cpu --light headlight --radius 0.6";
/// What [`bar`] finds at 320 × 240: first and last column, first and last row.
const BAR: [u32; 4] = [276, 287, 58, 201];
const YELLOW: [u8; 3] = [0xfd, 0xe7, 0x25];
const PURPLE: [u8; 3] = [0x44, 0x01, 0x54];

fn folder() -> Folder {
    Folder::with(&[("a.csv", POINTS.as_bytes())])
}

#[track_caller]
fn picture(place: &Folder, options: &str) -> Picture {
    place.exits(&format!("render {USUAL} {options} a.csv -o a.ppm"), 0, "");
    Picture::read(place.path("a.ppm")).unwrap()
}

/// The columns and rows in which two pictures differ: the first and the last.
fn difference(a: &Picture, b: &Picture) -> [u32; 4] {
    let pixels = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
    let differing: Vec<_> = pixels.filter(|&(x, y)| a.pixel(x, y) != b.pixel(x, y)).collect();
    let [x, y] = [differing.iter().map(|at| at.0).collect::<Vec<_>>(), differing.iter().map(|at| at.1).collect()];
    [x.iter().min(), x.iter().max(), y.iter().min(), y.iter().max()].map(|end| *end.expect("they differ"))
}

/// Whether black letters on white are in the line that begins at this pixel, and nothing else is in the rows of their ink.
fn says(picture: &Picture, text: &str, [left, top]: [u32; 2]) -> bool {
    let glyph = |letter: char| get_raster(letter, FontWeight::Regular, RasterHeight::Size16).unwrap();
    let has_ink = |y: &u32| text.chars().any(|letter| (0..7).any(|x| glyph(letter).pixel(x, *y as usize) > Some(0)));
    (0..16).filter(has_ink).all(|y| {
        (0..7 * text.len() as u32).all(|x| {
            let letter = text.as_bytes()[x as usize / 7].into();
            let ink = glyph(letter).pixel(x as usize % 7, y as usize).unwrap();
            picture.pixel(left + x, top + y) == [255 - ink; 3]
        })
    })
}

/// The numbers of a bar on the right of a white picture of 320 × 240, each with the row of its tick, from top to bottom.
fn numbers(picture: &Picture, candidates: &[&str]) -> Vec<(u32, String)> {
    let [_, right, top, bottom] = BAR;
    let ticks = (top..=bottom).filter(|&y| picture.pixel(right + 3, y) == [0; 3]);
    ticks
        .map(|row| {
            // The middle of digits, of which there are ten or so rows of ink, is within a pixel of the tick.
            let tops = row - 9..=row - 7;
            let is_there = |text: &&&str| tops.clone().any(|top| says(picture, text, [right + 9, top]));
            (row, candidates.iter().rfind(is_there).unwrap_or_else(|| panic!("no number at {row}")).to_string())
        })
        .collect()
}

#[test]
fn colours_and_numbers_run_from_the_bottom_to_the_top() {
    let place = folder();
    let picture = picture(&place, "--color-by speed --color-bar --res 320x240");
    let [left, right, top, bottom] = BAR;
    for x in left..=right {
        assert_eq!([picture.pixel(x, top), picture.pixel(x, bottom)], [YELLOW, PURPLE]);
        // The frame, and paper around it.
        for y in [top - 1, bottom + 1] {
            assert_eq!(picture.pixel(x, y), [0; 3]);
        }
        assert_eq!(picture.pixel(x, bottom + 2), [255; 3]);
    }
    for y in top..=bottom {
        assert_eq!([picture.pixel(left - 1, y), picture.pixel(right + 1, y)], [[0; 3]; 2]);
        assert_eq!(picture.pixel(left - 2, y), [255; 3]);
        let at = f64::from(bottom - y) / 143.0 * 255.0;
        let colors = Map::Viridis.colors();
        let color = colors[at as usize].lerp(colors[(at as usize + 1).min(255)], at.fract());
        assert_eq!(picture.pixel(left + 4, y), Quantize::Truncate.levels(color), "row {y}");
    }
    let found = numbers(&picture, &["0", "1", "5", "10", "20"]);
    assert_eq!(found, [(58, "10".into()), (129, "5".into()), (201, "0".into())]);
    assert!(says(&picture, "speed", [275, 38]), "the title");
}

#[test]
fn a_range_decides_the_numbers_and_may_be_reversed() {
    let place = folder();
    let picture = picture(&place, "--color-by speed:viridis:0.1..-0.4 --color-bar --res 320x240");
    let [left, _, top, bottom] = BAR;
    // Numbers are longer now, so the bar is farther to the left.
    let shift = 7 * 2;
    assert_eq!([picture.pixel(left - shift, top), picture.pixel(left - shift, bottom)], [YELLOW, PURPLE]);
    for (part, text) in [(0.2, "0.0"), (0.6, "-0.2"), (1.0, "-0.4")] {
        let row = bottom - (part * 143.0_f64).round() as u32;
        assert_eq!(picture.pixel(left - shift + 14, row), [0; 3], "a tick at {row}");
        assert!((row - 9..=row - 7).any(|top| says(&picture, text, [left - shift + 20, top])), "{text} at {row}");
    }
}

#[test]
fn ink_is_white_on_dark() {
    let place = folder();
    let picture = picture(&place, "--color-by speed --color-bar --res 320x240 --background 0.1,0.1,0.2");
    let [left, right, top, _] = BAR;
    assert_eq!([picture.pixel(left, top), picture.pixel(left, top - 1)], [YELLOW, [255; 3]]);
    assert_eq!([picture.pixel(left - 2, top), picture.pixel(right + 3, 129)], [[0; 3], [255; 3]]);
}

#[test]
fn level_bars_run_from_left_to_right() {
    // Far from each other, so that what is above and below them is free.
    let place = Folder::with(&[("a.csv", b"x,y,z,speed\n0,0,0,0\n6,0.5,0,10\n")]);
    for side in ["top", "bottom"] {
        let picture = picture(&place, &format!("--color-by speed --color-bar={side} --res 320x240"));
        let row = if side == "top" { 10 + 20 + 4 } else { 240 - 10 - 36 + 4 };
        // 192 pixels in the middle of 320.
        assert_eq!([picture.pixel(64, row), picture.pixel(255, row)], [PURPLE, YELLOW], "{side}");
        assert_eq!([picture.pixel(63, row), picture.pixel(256, row)], [[0; 3]; 2], "{side}");
        // 10 pixels below, numbers begin.
        let below = row - 4 + 12 + 4;
        for (column, text) in [(64, "0"), (64 + 38, "2"), (64 + 153, "8"), (255, "10")] {
            assert_eq!(picture.pixel(column, below - 2), [0; 3], "{side}: a tick at {column}");
            let is_there = (column - 8..=column + 1).any(|left| says(&picture, text, [left, below]));
            assert!(is_there, "{side}: {text} at {column}");
        }
    }
}

#[test]
fn the_rest_of_the_picture_stays_as_it_is() {
    let place = folder();
    for (res, most) in [("320x240", 0.14), ("800x600", 0.08), ("400x1200", 0.1)] {
        let plain = picture(&place, &format!("--color-by speed --res {res}"));
        let (width, height) = (plain.width(), plain.height());
        for side in ["right", "left", "top", "bottom"] {
            let drawn = picture(&place, &format!("--color-by speed --color-bar={side} --res {res}"));
            let [left, right, top, bottom] = difference(&plain, &drawn);
            let (wide, high) = (right - left + 1, bottom - top + 1);
            assert!(left > 0 && top > 0 && right + 1 < width && bottom + 1 < height, "{side} at {res}: inside");
            let is_there = match side {
                "right" => left > width * 3 / 4,
                "left" => right < width / 4,
                "top" => bottom < height / 3,
                _ => top > height * 2 / 3,
            };
            assert!(is_there, "{side} at {res}: {left} to {right}, {top} to {bottom}");
            let part = f64::from(wide * high) / f64::from(width * height);
            assert!(part < most, "{side} at {res}: {part} of the picture");
        }
    }
}

/// Rows come in bands, which end anywhere.
#[test]
fn a_bar_in_bands_is_the_same() {
    let scale = ColorScale { column: "Ωmega".into(), map: Map::Coolwarm, range: (-3.0, 1e-3) };
    let (size, levels) = ((2400, 2000), (Quantize::Round, DVec3::splat(0.2)));
    for side in [Side::Right, Side::Top] {
        let bar = ColorBar::new(&scale, side, size, levels).unwrap();
        let pixels = size.0 as usize * size.1 as usize;
        let (mut whole, mut colors) = (vec![77; 3 * pixels], vec![Linear::default(); pixels]);
        bar.draw(0, &mut whole, &mut colors);
        let mut bands = vec![77; 3 * pixels];
        for (at, rows) in bands.chunks_mut(3 * 2400 * 7).enumerate() {
            bar.draw(7 * at as u32, rows, &mut []);
        }
        assert!(whole == bands && whole.iter().any(|&level| level != 77));
        // Where all is covered the levels are those of the colours, and where nothing is there is none.
        for (levels, linear) in whole.as_chunks::<3>().0.iter().zip(&colors) {
            match linear.coverage {
                0.0 => assert_eq!((*levels, linear.color), ([77; 3], DVec3::ZERO)),
                1.0 if linear.color.element_sum() > 0.0 => assert_eq!(*levels, Quantize::Round.levels(linear.color)),
                _ => {}
            }
        }
    }
}

/// What is no number does not show through.
#[test]
fn the_bar_covers_what_is_no_number() {
    let scale = ColorScale { column: "a".into(), map: Map::Gray, range: (0.0, 10.0) };
    let bar = ColorBar::new(&scale, Side::Right, (320, 240), (Quantize::Truncate, DVec3::ONE)).unwrap();
    let nothing = Linear { color: DVec3::NAN, coverage: 0.0 };
    let (mut rgb, mut linear) = (vec![0; 3 * 320 * 240], vec![nothing; 320 * 240]);
    bar.draw(0, &mut rgb, &mut linear);
    for [x, y] in [[280, 58], [290, 58], [275, 100]] {
        assert!(linear[y * 320 + x].color.is_finite(), "{x} {y}");
    }
}

fn png(place: &Folder, name: &str) -> (usize, Vec<u16>, Option<String>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(place.read(name))).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let samples = match info.bit_depth {
        png::BitDepth::Sixteen => bytes.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect(),
        _ => bytes.iter().map(|&byte| byte.into()).collect(),
    };
    let text = reader.info().utf8_text.iter().find(|text| text.keyword == "Description");
    (info.color_type.samples(), samples, text.map(|text| text.get_text().unwrap()))
}

/// The same bar in all of them, and each file that can says what it shows.
#[test]
fn every_kind_of_file_has_it() {
    let place = folder();
    let text = "colour bar: viridis from 0 to 10 for speed";
    let render = |options: &str, name: &str| {
        let options = format!("{USUAL} --color-by speed --color-bar --res 320x240 {options}");
        place.exits(&format!("render {options} a.csv -o {name}"), 0, "");
    };
    let at = |x: u32, y: u32| (y * 320 + x) as usize;
    let (end, tick) = (at(280, 58), at(290, 58));
    for (options, channels, factor) in
        [("", 3, 1), ("--alpha", 4, 1), ("--bits 16", 3, 257), ("--bits 16 --alpha", 4, 257)]
    {
        render(options, "a.png");
        let (found, samples, said) = png(&place, "a.png");
        assert_eq!((found, said.as_deref()), (channels, Some(text)), "{options}");
        let pixel = |at: usize| &samples[at * channels..][..channels];
        let opaque = [0xfd, 0xe7, 0x25, 255].map(|level: u16| level * factor);
        assert_eq!(pixel(end), &opaque[..channels], "{options}");
        assert_eq!(pixel(tick), &[0, 0, 0, 255 * factor][..channels], "{options}");
        if channels == 4 {
            assert_eq!(pixel(at(300, 20)), [0; 4], "nothing is there");
        }
    }
    render("", "a.ppm");
    assert!(place.read("a.ppm").starts_with(format!("P6\n# Description {text}\n320 240\n").as_bytes()));
    render("", "a.pfm");
    let file = place.read("a.pfm");
    let numbers = file[file.len() - 12 * 320 * 240..].as_chunks::<4>().0;
    let row = 240 - 1 - 58;
    let found: Vec<_> = numbers[3 * (row * 320 + 280)..][..3].iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    assert_eq!(found, YELLOW.map(|level| (f64::from(level) / 255.0) as f32));
    render("", "a.exr");
    let file = place.read("a.exr");
    assert!(file.windows(text.len()).any(|part| part == text.as_bytes()), "the attribute comments");
}

/// In each the values of one file, whose colours have one range.
#[test]
fn frames_have_one_bar() {
    let place = folder();
    let options = "--color-by speed --color-bar --res 320x240";
    place.exits(&format!("render {USUAL} {options} --turntable 3 a.csv -o f%d.png --stats-json s.json"), 0, "");
    let frames = [1, 2, 3].map(|k| Picture::read(place.path(&format!("f{k}.png"))).unwrap());
    let block = |picture: &Picture| (54..=206).flat_map(|y| picture.row(y)[274..312].to_vec()).collect::<Vec<_>>();
    assert!(frames.iter().all(|frame| block(frame) == block(&frames[0])) && frames[0] != frames[1]);
    assert_eq!(frames[0].pixel(280, 58), YELLOW);
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    let bar = serde_json::json!({"column": "speed", "map": "viridis", "range": [0.0, 10.0]});
    assert_eq!([0, 1, 2].map(|k| &stats["pictures"][k]["color_bar"]), [&bar; 3]);
}

/// What is rendered, verified and shown beside it knows nothing of the bar; what goes to the terminal is the file's picture.
#[test]
fn it_is_drawn_over_the_finished_picture() {
    if gpu("color_bar::it_is_drawn_over_the_finished_picture").is_none() {
        return;
    }
    let place = folder();
    let options = "-q --device gpu --precision fast --light headlight --radius 0.6 --color-by speed --res 320x240";
    place.exits(&format!("render {options} a.csv --aov error -o a.png"), 0, "");
    let plain = place.read("a.error.pfm");
    place.exits(&format!("render {options} --color-bar a.csv --aov error -o a.png"), 0, "");
    assert!(place.read("a.error.pfm") == plain, "no error");
    let shown = place.exits(&format!("render {options} --color-bar --show a.csv -o a.png"), 0, "").stdout;
    let without = place.exits(&format!("render {options} --show a.csv -o a.png"), 0, "").stdout;
    assert!(shown != without);
    place.exits(&format!("render {options} --color-bar --stats a.csv -o a.png"), 0, "viridis from 0 to 10 for speed");
    let stats = format!("render {USUAL} --color-by speed:gray:-1..1.5 --color-bar=left --stats a.csv -o a.png");
    place.exits(&stats, 0, "colour bar: gray from -1 to 1.5 for speed");
}

#[test]
fn what_has_no_bar_is_refused() {
    let place = folder();
    place.write("s.txt", "SPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\n");
    let by = "--color-by speed --color-bar";
    for (arguments, message) in [
        ("--color-bar a.csv", "--color-bar shows the numbers of a column\n  help: --color-by COLUMN"),
        ("--color-bar s.txt", "--color-by COLUMN takes colours from one"),
        ("--color-by 1,0,0 --color-bar a.csv", "shows the numbers of a column"),
        ("--color-by element --color-bar a.csv", "shows the numbers of a column"),
        ("--color-by speed:categories --color-bar a.csv", "categories have none"),
        ("--color-by kind --color-bar a.csv", "a.csv: --color-bar: the column of --color-by holds no numbers"),
        ("--color-by none --color-bar a.csv", "holds no numbers"),
        ("--color-by speed --color-bar=up a.csv", "possible values: right, left, top, bottom"),
        (&format!("{by} s.txt"), "holds no particles"),
        (&format!("{by} --certificate c.json a.csv"), "--color-bar does not go with --certificate"),
        (&format!("{by} --tile 0/2 a.csv"), "--color-bar does not go with --crop, --tile or --resume"),
        (&format!("{by} --resume a.csv"), "--color-bar does not go with --crop, --tile or --resume"),
        (&format!("{by} --turntable 2 --resume a.csv"), "does not go with --crop, --tile or --resume"),
        (&format!("{by} --res 60x60 a.csv"), "60 × 60 pixels is too small for a colour bar"),
        (&format!("{by} --res 60x600 a.csv"), "too small for a colour bar"),
        ("--color-by speed:viridis:1e12..1000000000001 --color-bar a.csv", "no short numbers tell values"),
    ] {
        let name = if arguments.contains("turntable") { "o%d.png" } else { "o.png" };
        place.exits(&format!("render {USUAL} {arguments} -o {name}"), 2, message);
        assert_eq!(place.files(), ["a.csv", "s.txt"], "{arguments}");
    }
}

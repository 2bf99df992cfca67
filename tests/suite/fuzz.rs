//! Random and mutated bytes for whatever reads files: an answer, never a panic.
//!
//! `TRUERAY_FUZZ_CASES` is the number of cases of each test; the default only keeps the tests themselves in order.

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, TestRunner};
use trueray::doubts::doubts;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, render_picture};
use trueray::film::{Encoded, Leniency, decode};
use trueray::import::{Format, Frames, Import, Options};
use trueray::limits;
use trueray::pattern::{Filter, Pattern};
use trueray::precision::{Request, Selection, Tier};
use trueray::scene::{foreign_kind, parse};
use trueray::settings::{Quantize, SampleOffset, Settings, Specular};

const CASES: u32 = 500;

/// A runner of so many cases that keeps no record of failures.
fn runner() -> TestRunner {
    let cases = std::env::var("TRUERAY_FUZZ_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(CASES);
    TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() })
}

/// What is done to bytes that are right.
#[derive(Debug, Clone)]
enum Change {
    Set(Index, u8),
    Flip(Index, u8),
    Remove(Index, u8),
    Insert(Index, Vec<u8>),
    Repeat(Index, u8),
    Cut(Index),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let change = prop_oneof![
        (any::<Index>(), any::<u8>()).prop_map(|(at, byte)| Change::Set(at, byte)),
        (any::<Index>(), 0..8_u8).prop_map(|(at, bit)| Change::Flip(at, bit)),
        (any::<Index>(), any::<u8>()).prop_map(|(at, count)| Change::Remove(at, count)),
        (any::<Index>(), proptest::collection::vec(any::<u8>(), 0..6))
            .prop_map(|(at, bytes)| Change::Insert(at, bytes)),
        (any::<Index>(), any::<u8>()).prop_map(|(at, count)| Change::Repeat(at, count)),
        any::<Index>().prop_map(Change::Cut),
    ];
    proptest::collection::vec(change, 0..5)
}

fn changed(mut bytes: Vec<u8>, changes: Vec<Change>) -> Vec<u8> {
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        let length = bytes.len();
        let part = |at: Index, count: u8| at.index(length)..length.min(at.index(length) + usize::from(count));
        match change {
            Change::Set(at, byte) => bytes[at.index(length)] = byte,
            Change::Flip(at, bit) => bytes[at.index(length)] ^= 1 << bit,
            Change::Remove(at, count) => drop(bytes.drain(part(at, count))),
            Change::Insert(at, more) => drop(bytes.splice(at.index(length)..at.index(length), more)),
            Change::Repeat(at, count) => {
                let again = bytes[part(at, count)].to_vec();
                bytes.splice(at.index(length)..at.index(length), again);
            }
            Change::Cut(at) => bytes.truncate(at.index(length)),
        }
    }
    bytes
}

/// Changed seeds, and now and then nothing but noise.
fn mutated(seeds: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let noise = proptest::collection::vec(any::<u8>(), 0..120);
    let changed = (proptest::sample::select(seeds), changes()).prop_map(|(seed, changes)| changed(seed, changes));
    prop_oneof![1 => noise, 9 => changed]
}

/// Reads a picture in every way; what the readers agree on is checked on the side.
fn read_picture(bytes: &[u8]) -> Result<(), TestCaseError> {
    let size = Encoded::from_stream("fuzz", bytes).and_then(|encoded| encoded.size());
    let strict = decode(bytes.to_vec(), Leniency::Strict);
    let lenient = decode(bytes.to_vec(), Leniency::Lenient(Quantize::Truncate));
    for reading in [&strict, &lenient].into_iter().flatten() {
        let read = (reading.picture.width(), reading.picture.height());
        prop_assert_eq!(size.as_ref().ok(), Some(&read));
    }
    if let Err(error) = &strict {
        prop_assert!(!error.to_string().contains("cannot make sense"), "the decoder panicked: {}", error);
    } else {
        prop_assert!(lenient.is_ok());
    }
    Ok(())
}

#[test]
fn scenes() {
    let seeds = [
        "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 4 3\nSPHERE s 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 0 50\n",
        "\u{feff}NEAR 1\r\nLEFT -1\rRIGHT 1 # right\nBOTTOM -1e0\nTOP +1\nRES 4 3\nLIGHT l 0 0 0 .3 3. 3e-1\nBACK 1 1 1\n\
         AMBIENT 0 0 0\nOUTPUT a.ppm\nSPHERE g 0 0 -10 2 4 2\n0.5 0 0 1 1 0.9 0 50 0.5 1.5\n",
    ];
    let seeds = seeds.map(|seed| seed.as_bytes().to_vec()).to_vec();
    let test = |text: Vec<u8>| {
        let _ = foreign_kind(&text);
        let parsed = parse("fuzz", &text);
        prop_assert_eq!(parsed.scene.is_some(), parsed.errors == 0);
        let report = parsed.report(false);
        prop_assert!(report.chars().all(|c| c == '\n' || c == '\t' || !c.is_control()), "{report:?}");
        Ok(())
    };
    runner().run(&mutated(seeds), test).unwrap();
}

/// Numbers that a scene may have and hardly any has.
fn number() -> impl Strategy<Value = String> {
    let sizes = [-300, -150, -45, -38, -30, -8, -3, 0, 0, 0, 1, 3, 7, 15, 19, 30, 38, 150, 300];
    let hostile = (any::<bool>(), 1..10_u32, proptest::sample::select(sizes.to_vec()))
        .prop_map(|(negative, digit, size)| format!("{}{digit}e{size}", if negative { "-" } else { "" }));
    let plain = prop_oneof![-3_i32..4, Just(0), Just(1)].prop_map(|x| x.to_string());
    let fine = (-4.0_f64..4.0).prop_map(|x| x.to_string());
    let digits = prop_oneof![Just("0.1"), Just("1.0000000000000002"), Just("5e-324"), Just("1.7976931348623157e308")]
        .prop_map(str::to_owned);
    prop_oneof![30 => plain, 30 => fine, 4 => hostile, 1 => digits]
}

/// Statements whose numbers are anything; most of what comes out is a scene.
fn hostile_scene() -> impl Strategy<Value = String> {
    let numbers = |count| proptest::collection::vec(number(), count).prop_map(|numbers| numbers.join(" "));
    let color = || proptest::collection::vec(prop_oneof![Just("0"), Just("1"), Just("0.5"), Just("1e-30")], 3..=3);
    let weights = || {
        let weight = prop_oneof![6 => Just("0"), 6 => Just("0.4"), 4 => Just("1"), 1 => Just("-2"), 1 => Just("1e20")];
        proptest::collection::vec(weight, 4..=4)
    };
    let exponent = proptest::sample::select(vec!["0", "1", "50", "1000000", "0.5"]);
    let glass =
        proptest::option::weighted(0.2, (0.0..1.0_f64, proptest::sample::select(vec!["1", "1.5", "0.3", "1e9"])));
    let side = prop_oneof![
        40 => proptest::sample::select(vec!["1", "2", "0.5", "1e-3", "0.1", "30"]),
        1 => proptest::sample::select(vec!["1e6", "1e-30", "1e30", "-1", "5e-324"]),
    ];
    let sphere = (numbers(3), proptest::collection::vec(side, 3..=3), color(), weights(), exponent, glass);
    let spheres = proptest::collection::vec(sphere, 0..7);
    let light = (numbers(3), proptest::collection::vec(prop_oneof![Just("0.8"), Just("0"), Just("1e9")], 3..=3));
    let lights = proptest::collection::vec(light, 0..3);
    let near = prop_oneof![8 => Just("1"), 1 => proptest::sample::select(vec!["0.01", "1e-300", "1e16", "1e40"])];
    let window = prop_oneof![
        8 => Just("LEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1"),
        1 => proptest::sample::select(vec![
            "LEFT 0\nRIGHT 1e-300\nBOTTOM 0\nTOP 1e30",
            "LEFT 1\nRIGHT -1\nBOTTOM 1\nTOP -1",
            "LEFT 1e15\nRIGHT 1.1e15\nBOTTOM -1e-9\nTOP 1e-9",
        ]),
    ];
    (near, window, spheres, lights, color()).prop_map(|(near, window, spheres, lights, back)| {
        let sphere = |(center, sides, color, weights, exponent, glass): &(_, Vec<_>, Vec<_>, Vec<_>, _, Option<_>)| {
            let glass = glass.map_or(String::new(), |(kt, eta): (f64, &str)| format!("{kt} {eta}"));
            let (sides, color, weights) = (sides.join(" "), color.join(" "), weights.join(" "));
            format!("SPHERE s {center} {sides} {color} {weights} {exponent} {glass}\n")
        };
        let light = |(position, color): &(String, Vec<_>)| format!("LIGHT l {position} {}\n", color.join(" "));
        let (spheres, lights): (String, String) =
            (spheres.iter().map(sphere).collect(), lights.iter().map(light).collect());
        let back = back.join(" ");
        format!("NEAR {near}\n{window}\nRES 5 4\nAMBIENT 0.2 0.2 0.2\nBACK {back}\n{spheres}{lights}")
    })
}

fn settings() -> impl Strategy<Value = Settings> {
    let sampling = proptest::sample::select(vec![SampleOffset::Corner, SampleOffset::BottomLeft, SampleOffset::Center]);
    let quantize = proptest::sample::select(vec![Quantize::Truncate, Quantize::Round, Quantize::Overscale]);
    let depth = proptest::sample::select(vec![0, 1, 3, 6]);
    let fibonacci = |count, filter| Pattern::Fibonacci { count, filter };
    let pattern = proptest::sample::select(vec![
        Pattern::ONE,
        Pattern::Grid { side: 2 },
        fibonacci(3, Filter::Box),
        fibonacci(5, Filter::Gaussian),
    ]);
    (any::<bool>(), sampling, quantize, any::<bool>(), depth, pattern).prop_map(
        |(is_exact, sampling, quantize, is_blinn, max_depth, pattern)| {
            let base = if is_exact { Settings::exact() } else { Settings::classic() };
            let specular = if is_blinn { Specular::Blinn } else { Specular::Phong };
            Settings { sampling, quantize, specular, max_depth, pattern, ..base }
        },
    )
}

/// Whatever is a scene has a picture or a refusal.
#[test]
fn hostile_scenes() {
    let rendered = std::cell::Cell::new(0_u32);
    let test = |(text, settings): (String, Settings)| {
        let parsed = parse("fuzz", text.as_bytes());
        let Some(scene) = parsed.scene else { return Ok(()) };
        let _ = doubts(&scene, &settings, None);
        let effects = Effects::of(&scene.viewed(&settings));
        if limits::problem(&scene.viewed(&settings), &effects).is_some() {
            return Ok(());
        }
        let _ = Selection::of(&scene.viewed(&settings), &effects, Request::default(), &Tier::ALL);
        if let Ok(mut engine) = Engine::new(Backend::Reference, scene.viewed(&settings), &effects) {
            let (rgb, _) = render_picture(&mut engine).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert_eq!(rgb.len(), 60);
            rendered.set(rendered.get() + 1);
        }
        Ok(())
    };
    let mut runner = runner();
    runner.run(&(hostile_scene(), settings()), test).unwrap();
    let cases = runner.config().cases;
    println!("{} of {cases} hostile scenes rendered", rendered.get());
    assert!(rendered.get() > cases / 2, "{} of {cases}", rendered.get());
}

#[test]
fn ppm() {
    let seeds = [
        &b"P6\n3 2\n255\nabcdefghijklmnopqr"[..],
        b"P6 # c\n3 2 # c\r255# c\nabcdefghijklmnopqr",
        b"P6\r\n2 1\r\n65535\r\nabcdefghijkl",
        b"P6 2 1 9\n\x00\x01\x02\x09\x08\x07",
        b"P3\n3 1\n255\n0 1 2 3 4 5 6 7 255\n",
        b"P3 1 1 7 # c\n-0 296 -4 # c\r",
    ];
    runner().run(&mutated(seeds.map(<[u8]>::to_vec).to_vec()), |bytes| read_picture(&bytes)).unwrap();
}

#[test]
fn png() {
    use png::{BitDepth, ColorType};
    let kinds = [
        (ColorType::Grayscale, BitDepth::One),
        (ColorType::Grayscale, BitDepth::Sixteen),
        (ColorType::Rgb, BitDepth::Eight),
        (ColorType::Rgba, BitDepth::Eight),
        (ColorType::GrayscaleAlpha, BitDepth::Sixteen),
        (ColorType::Indexed, BitDepth::Two),
        (ColorType::Indexed, BitDepth::Eight),
    ];
    let seeds = kinds.map(|(color, depth)| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 5, 3);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![9, 8, 7, 1, 2, 3, 4, 5, 6]);
            encoder.set_trns(vec![255, 255, 3]);
        }
        let row = color.samples() * 5 * depth as usize;
        let data: Vec<u8> = (0..row.div_ceil(8) * 3).map(|index| (index % 3) as u8).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        bytes
    });
    runner().run(&mutated(seeds.to_vec()), |bytes| read_picture(&mended(bytes))).unwrap();
}

/// Sets the checksums of every chunk right in three of four files, so that what lies behind them is reached.
fn mended(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)) % 4 == 0 {
        return bytes;
    }
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4).and_then(|length| length.try_into().ok()).map(u32::from_be_bytes) {
        let end = at + 8 + length as usize;
        if end + 4 > bytes.len() {
            break;
        }
        let sum = crate::film::crc(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
    bytes
}

/// Particles of every format, changed at random and read as each format: scenes that a file can hold, or errors.
#[test]
fn files_of_particles() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/import");
    let read = |name: &str| {
        let mut file = std::fs::read(folder.join(name)).unwrap();
        // Most of a protein is like the rest.
        file.truncate(4000);
        file
    };
    let mut seeds: Vec<_> = ["benzene.xyz", "argon.lammpstrj", "spiral.csv", "globe.ply"].map(read).into();
    let protein = std::fs::read(folder.join("gramicidin.pdb")).unwrap();
    seeds.push(protein[protein.len() - 2000..].to_vec());
    let entry = std::fs::read_to_string(folder.join("1yjp.cif")).unwrap();
    let atoms = entry.find("loop_\n_atom_site.").unwrap();
    seeds.push(format!("data_1\n{}", &entry[atoms..atoms + 2000]).into_bytes());
    let binary = "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar int i\nelement vertex 1\n\
                  property float x\nproperty float y\nproperty double z\nend_header\n\0";
    seeds.push([binary.as_bytes(), &[0; 16]].concat());
    seeds.push(b"//X Y Z R G B\n1 2 3 255 0 0\n4 nan 6 0 255 0\n7 8 9 0 0 nan\n".to_vec());
    seeds.push(b"2\n\nOH2 1 2 3\n2 4 5 6\n0\n\n".to_vec());
    let formats = [Format::Xyz, Format::Lammps, Format::Pdb, Format::Mmcif, Format::Table, Format::Ply];
    let options = [
        Options { frames: Frames::All, ..Options::default() },
        Options { frames: Frames::Last, coloring: "x".parse().unwrap(), ..Options::default() },
    ];
    let check = |bytes: Vec<u8>, options: &Options| {
        for format in Format::of(&bytes).into_iter().chain(formats) {
            for imported in Import::new("fuzz", format, &bytes[..], options.clone()) {
                let parsed = imported.parsed;
                // Of several frames one may be empty.
                let is_left_out = options.frames == Frames::All && parsed.errors == 0 && !parsed.diagnostics.is_empty();
                prop_assert_eq!(parsed.scene.is_none(), parsed.errors > 0 || parsed.scene.is_none() && is_left_out);
                prop_assert!(parsed.scene.is_none_or(|scene| scene.check().is_ok()));
            }
        }
        Ok(())
    };
    let strategy = (mutated(seeds), proptest::sample::select(options.to_vec()));
    runner().run(&strategy, |(bytes, options)| check(bytes, &options)).unwrap();
}

//! Random and mutated bytes for whatever reads files: an answer, never a panic.
//!
//! `TRUERAY_FUZZ_CASES` is the number of cases of each test; the default only keeps the tests themselves in order.

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, TestRunner};
use trueray::film::{Encoded, Leniency, decode};
use trueray::scene::{foreign_kind, parse};

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
    let lenient = decode(bytes.to_vec(), Leniency::Lenient);
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

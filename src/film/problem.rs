//! What can be wrong with a picture file, in words that name the place.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::surplus::SURPLUS;
use crate::words::{count, visible_path};

/// A picture file that could not be read. Its text names the file, the place in it and what is wrong there.
#[derive(Debug)]
pub struct ReadError {
    pub(super) path: PathBuf,
    pub(super) problem: Problem,
}

impl ReadError {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is wrong with it.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", visible_path(&self.path), self.problem)
    }
}

impl std::error::Error for ReadError {}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePosition {
    /// A line of text, counted from 1.
    Line(u64),
    /// A byte's offset from the start of the file, counted from 0.
    Byte(u64),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// Which sample of a picture. Its text counts samples from 1, columns and rows from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplePosition {
    /// The sample's number in reading order, counted from 0.
    pub index: u64,
    /// Column of its pixel.
    pub x: u32,
    /// Row of its pixel, 0 being the top one.
    pub y: u32,
    /// 0 red, 1 green, 2 blue.
    pub channel: u8,
}

impl SamplePosition {
    /// The position of sample `index` in a picture `width` pixels wide.
    pub(super) fn new(index: u64, width: u32) -> Self {
        let (pixel, channel) = (index / 3, index % 3);
        let width = width as u64;
        Self { index, x: (pixel % width) as u32, y: (pixel / width) as u32, channel: channel as u8 }
    }
}

impl fmt::Display for SamplePosition {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let channel = ["red", "green", "blue"][self.channel as usize];
        write!(f, "sample {} (x {}, y {}, {channel})", self.index + 1, self.x, self.y)
    }
}

/// What kind of trouble a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProblemKind {
    /// It ends before its picture does.
    CutOff,
    /// Another format, or pixels that are not 8 bits a channel and opaque.
    Unsupported,
    /// It breaks the rules of its format, or cannot be read at all.
    Damaged,
}

/// Why a file's contents are not a picture, in words that name the place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    message: String,
    lenient_helps: bool,
    kind: ProblemKind,
}

impl Problem {
    /// One that nothing gets over.
    pub(super) fn fatal(message: impl Into<String>) -> Self {
        Self { message: message.into(), lenient_helps: false, kind: ProblemKind::Damaged }
    }

    /// One that [`Leniency::Lenient`](super::Leniency::Lenient) gets over.
    pub(super) fn mendable(message: impl Into<String>) -> Self {
        Self { message: message.into(), lenient_helps: true, kind: ProblemKind::Damaged }
    }

    /// The same, of another kind than [`ProblemKind::Damaged`].
    pub(super) fn of_kind(self, kind: ProblemKind) -> Self {
        Self { kind, ..self }
    }

    /// A header that promises more samples than the file can hold.
    pub(super) fn too_large(width: u32, height: u32) -> Self {
        let message = format!("the header promises {width}x{height} pixels, more than the file can hold");
        Self::fatal(message).of_kind(ProblemKind::CutOff)
    }

    /// What kind of trouble it is.
    pub fn kind(&self) -> ProblemKind {
        self.kind
    }

    /// Whether [`Leniency::Lenient`](super::Leniency::Lenient) gets over it.
    pub fn lenient_helps(&self) -> bool {
        self.lenient_helps
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Self::fatal(error.to_string())
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// Something about a picture file that was got over.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Warning {
    /// Samples out of range became the nearest value in range.
    Clamped {
        /// How many.
        count: u64,
        /// Where the first one stands.
        place: FilePosition,
        /// Which one it is.
        sample: SamplePosition,
        /// What stands there.
        found: String,
    },
    /// Samples after the end of the file became 0.
    Missing {
        /// How many.
        count: u64,
        /// The first of them.
        first: SamplePosition,
    },
    /// Data after the last sample were ignored.
    Trailing {
        /// How many bytes.
        bytes: u64,
    },
    /// The header ended in CR LF where one byte is allowed; the LF was skipped.
    CrLfHeader,
    /// A PNG file is cut off after its pixels.
    PngCutOff,
    /// Data after the end of a PNG file were ignored.
    PngTrailing {
        /// How many bytes.
        bytes: u64,
    },
    /// Pixel data of a PNG file beyond its picture were ignored.
    PngSurplus,
    /// Samples were scaled, with rounding, from 0…maximum to 0…255.
    Scaled {
        /// The greatest value in the file's range.
        maximum: u32,
    },
    /// Pixels that are not opaque lost their transparency.
    AlphaDropped {
        /// How many.
        pixels: u64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Clamped { count, place, sample, found } => {
                write!(f, "samples out of range, clamped: {count}; the first at {place}: {sample} is {found}")
            }
            Self::Missing { count, first } => write!(f, "missing samples, taken as 0: {count}, from {first} on"),
            Self::Trailing { bytes } => write!(f, "data after the last sample, ignored: {}", count(*bytes, "byte")),
            Self::CrLfHeader => f.write_str("the header ends in CR LF; the LF was taken as part of it"),
            Self::PngCutOff => f.write_str("the PNG does not end with its IEND chunk; its pixels are complete"),
            Self::PngTrailing { bytes } => {
                write!(f, "data after the end of the PNG, ignored: {}", count(*bytes, "byte"))
            }
            Self::PngSurplus => write!(f, "{SURPLUS}, ignored"),
            Self::Scaled { maximum } => write!(f, "samples were scaled from 0..{maximum} to 0..255"),
            Self::AlphaDropped { pixels } => write!(f, "pixels not opaque, transparency ignored: {pixels}"),
        }
    }
}

//! What can be wrong with a picture file, in words that name the place.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

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

/// Why a file's contents are not a picture.
#[derive(Debug)]
#[non_exhaustive]
pub enum Problem {
    /// The file could not be read.
    Io(io::Error),
    /// The file is neither PPM nor PNG; the text says what it looks like.
    Unrecognised(String),
    /// The PPM header is wrong; the text says how.
    Header {
        /// Line of the header, counted from 1.
        line: u64,
        /// What is wrong in it.
        message: String,
    },
    /// A sample that is a whole number out of range.
    OutOfRange {
        /// Where it stands.
        place: FilePosition,
        /// Which sample it is.
        sample: SamplePosition,
        /// What stands there.
        found: String,
        /// The greatest value that the header allows.
        maximum: u32,
    },
    /// A sample that is no whole number.
    NotANumber {
        /// Where it stands.
        place: FilePosition,
        /// Which sample it is.
        sample: SamplePosition,
        /// What stands there.
        found: String,
        /// The greatest value that the header allows.
        maximum: u32,
    },
    /// The file ends before its last sample.
    Truncated {
        /// Where it ends.
        place: FilePosition,
        /// The first sample that is missing.
        missing: SamplePosition,
        /// Number of samples that the header promises.
        expected: u64,
    },
    /// Something follows the last sample.
    Trailing {
        /// Where it starts.
        place: FilePosition,
        /// What it is.
        found: String,
        /// Number of samples that the header promises.
        expected: u64,
    },
    /// The header ends in CR LF where one byte is allowed, so that the samples are one byte too many.
    CrLfHeader,
    /// A PNG file whose pixels are complete, but which is cut off before its end.
    PngCutOff,
    /// Something follows the end of a PNG file.
    PngTrailing {
        /// How many bytes.
        bytes: u64,
    },
    /// A valid picture that does not fit into 8-bit RGB without a loss; the text says why.
    Lossy(String),
    /// The header promises more samples than the file can hold.
    TooLarge {
        /// Pixels in a row, as the header says.
        width: u32,
        /// Rows, as the header says.
        height: u32,
    },
    /// More pixels than are decoded at all.
    TooManyPixels {
        /// Pixels in a row, as the header says.
        width: u32,
        /// Rows, as the header says.
        height: u32,
        /// The most that are.
        most: u64,
    },
    /// There is no memory for so many pixels.
    OutOfMemory {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A damaged PNG file; the text is the decoder's.
    Png(String),
}

impl Problem {
    /// Whether [`Leniency::Lenient`](super::Leniency::Lenient) gets over problems of this kind.
    pub fn lenient_helps(&self) -> bool {
        match self {
            Self::OutOfRange { .. }
            | Self::Truncated { .. }
            | Self::Trailing { .. }
            | Self::CrLfHeader
            | Self::PngCutOff
            | Self::PngTrailing { .. }
            | Self::Lossy(_) => true,
            Self::Io(_)
            | Self::Unrecognised(_)
            | Self::Header { .. }
            | Self::NotANumber { .. }
            | Self::TooLarge { .. }
            | Self::TooManyPixels { .. }
            | Self::OutOfMemory { .. }
            | Self::Png(_) => false,
        }
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Header { line, message } => write!(f, "line {line}: {message}"),
            Self::OutOfRange { place, sample, found, maximum } | Self::NotANumber { place, sample, found, maximum } => {
                write!(f, "{place}: {sample} is {found}; samples are whole numbers from 0 to {maximum}")
            }
            Self::Truncated { place, missing, expected } => {
                write!(f, "{place}: the file ends after {} of {expected} samples; {missing} is missing", missing.index)
            }
            Self::Trailing { place, found, expected } => {
                write!(f, "{place}: unexpected {found} after the last of {expected} samples")
            }
            Self::CrLfHeader => {
                f.write_str("the header ends in CR LF where one byte is allowed (written in text mode?)")
            }
            Self::PngCutOff => f.write_str("the PNG is cut off after its pixels: it does not end with its IEND chunk"),
            Self::PngTrailing { bytes } => write!(f, "data after the end of the PNG: {}", count(*bytes, "byte")),
            Self::TooManyPixels { width, height, most } => {
                write!(f, "the header promises {width}x{height} pixels; at most {most} are read")
            }
            Self::OutOfMemory { width, height } => write!(f, "there is no memory for {width}x{height} pixels"),
            Self::TooLarge { width, height } => {
                write!(f, "the header promises {width}x{height} pixels, more than the file can hold")
            }
            Self::Png(message) => write!(f, "damaged PNG: {message}"),
            Self::Unrecognised(message) | Self::Lossy(message) => f.write_str(message),
        }
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
            Self::Scaled { maximum } => write!(f, "samples were scaled from 0..{maximum} to 0..255"),
            Self::AlphaDropped { pixels } => write!(f, "pixels not opaque, transparency ignored: {pixels}"),
        }
    }
}

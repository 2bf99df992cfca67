//! Pictures in memory and in files: PPM (P6 and P3) and PNG, 8 bits a channel; and colours that are no levels yet, in files alone.
//!
//! Files are byte-deterministic: the same pixels always give the same bytes, without dates or names in them; a note of what they
//! are of is there only where it is asked for.
//! [`PictureWriter`] streams, so a picture never has to be in memory as a whole to be written;
//! [`read_picture`] recognises a file by its contents and is strict unless told otherwise.

mod exr;
mod linear;
mod pfm;
mod png;
mod ppm;
mod problem;
mod read;
mod rows;
mod surplus;
mod write;

use std::fmt;
use std::path::Path;
use std::str::FromStr;

pub(crate) use exr::encode_exr;
pub use linear::{Container, LinearFormat, LinearPicture, MOST_LINEAR_PIXELS};
pub(crate) use pfm::encode_pfm;
pub use problem::{FilePosition, Problem, ProblemKind, ReadError, SamplePosition, Warning};
pub use read::{Encoded, Leniency, Reading, decode, read_picture};
pub use rows::RowReader;
pub use write::{OutputError, PictureWriter, Target, encode_png, save_text};
pub(crate) use write::{save_by, save_bytes};

/// The greatest width and the greatest height of a [`Picture`], in pixels.
///
/// Sums of a few widths stay within `u32`, so pictures can be put side by side.
pub const MAX_SIDE: u32 = 1 << 30;

/// A picture of 8-bit RGB pixels.
///
/// Rows run from top to bottom, pixels from left to right, samples are red, green, blue. There is at least one pixel.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

impl Picture {
    /// A picture from `width`·`height`·3 samples.
    ///
    /// # Errors
    /// A side that is 0 or greater than [`MAX_SIDE`], or a number of samples that does not fit the sides.
    pub fn new(width: u32, height: u32, rgb: Vec<u8>) -> Result<Self, PictureError> {
        let expected = sample_count(width, height)?;
        if rgb.len() == expected {
            Ok(Self { width, height, rgb })
        } else {
            Err(PictureError::Samples { expected, found: rgb.len() })
        }
    }

    /// A picture of samples that were rendered for its sides, or computed from other pictures: they fit by construction.
    pub(crate) fn assemble(width: u32, height: u32, rgb: Vec<u8>) -> Self {
        debug_assert_eq!(rgb.len() as u64, width as u64 * height as u64 * 3);
        Self { width, height, rgb }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> u64 {
        self.width as u64 * self.height as u64
    }

    /// All samples, row by row.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// All samples, row by row, without a copy.
    pub fn into_rgb(self) -> Vec<u8> {
        self.rgb
    }

    /// All pixels in reading order.
    pub fn pixels(&self) -> &[[u8; 3]] {
        self.rgb.as_chunks().0
    }

    /// The pixels of row `y`, 0 being the top one.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, y: u32) -> &[[u8; 3]] {
        let width = self.width as usize;
        &self.pixels()[y as usize * width..][..width]
    }

    /// The rows from top to bottom.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = &[[u8; 3]]> + ExactSizeIterator {
        self.pixels().chunks_exact(self.width as usize)
    }

    /// The pixel in column `x` of row `y`, (0, 0) being the top left one.
    ///
    /// # Panics
    /// If the picture does not reach that far.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.row(y)[x as usize]
    }

    /// Reads a PPM or PNG file, which has to be as the formats demand.
    ///
    /// # Errors
    /// A file that cannot be read, or is no such picture.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Ok(read_picture(path.as_ref(), Leniency::Strict)?.picture)
    }

    /// Writes a PNG or PPM (P6) file, as the ending of its name says: complete, or not at all.
    ///
    /// # Errors
    /// A file that cannot be written, or has another ending.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), OutputError> {
        let target = Target::File(path.as_ref().to_owned());
        let format = Format::from_extension(path.as_ref()).ok_or_else(|| target.unknown_ending())?;
        self.save(&target, format)
    }

    /// Writes the whole picture, see [`PictureWriter`].
    pub fn save(&self, target: &Target, format: Format) -> Result<(), OutputError> {
        let mut writer = PictureWriter::create(target, format, self.width, self.height)?;
        writer.write_rows(&self.rgb)?;
        writer.finish()
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Picture").field("width", &self.width).field("height", &self.height).finish_non_exhaustive()
    }
}

/// `width`·`height`·3 where such a picture is possible.
fn sample_count(width: u32, height: u32) -> Result<usize, PictureError> {
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        return Err(PictureError::Sides { width, height });
    }
    let count = width as u64 * height as u64 * 3; // at most 3·2^60
    // No allocation can be greater than `isize`.
    isize::try_from(count).map(isize::cast_unsigned).map_err(|_| PictureError::Sides { width, height })
}

/// Why a [`Picture`] cannot exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PictureError {
    /// A side is 0, or greater than this machine or [`MAX_SIDE`] allows.
    Sides {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The number of samples is not width·height·3.
    Samples {
        /// Samples that the sides ask for.
        expected: usize,
        /// Samples that were given.
        found: usize,
    },
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Sides { width, height } if *width == 0 || *height == 0 => {
                write!(f, "a picture of {width}x{height} pixels has no pixels")
            }
            Self::Sides { width, height } => write!(f, "a picture of {width}x{height} pixels is too large"),
            Self::Samples { expected, found } => write!(f, "{found} samples given where the picture has {expected}"),
        }
    }
}

impl std::error::Error for PictureError {}

/// A file format that pictures are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Format {
    /// Binary PPM: a header and the samples as they are.
    #[default]
    P6,
    /// PPM in decimal text.
    P3,
    /// PNG, 8-bit RGB, without optional chunks.
    Png,
}

impl Format {
    /// All formats, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::P6, Self::P3, Self::Png];

    /// The name that [`FromStr`] reads: `p6`, `p3` or `png`.
    pub fn name(self) -> &'static str {
        match self {
            Self::P6 => "p6",
            Self::P3 => "p3",
            Self::Png => "png",
        }
    }

    /// Bytes that a picture takes at the least: P6 exactly so many; P3 if it is black all over; PNG if nothing can be compressed
    /// better.
    pub(crate) fn least_bytes(self, width: u32, height: u32) -> u64 {
        // DEFLATE makes no more than 1032 bytes of one.
        const BEST: u64 = 1032;
        let samples = (u64::from(width) * u64::from(height)).saturating_mul(3);
        match self {
            Self::P6 => samples,
            Self::P3 => samples.saturating_mul(2),
            Self::Png => samples / BEST,
        }
    }

    /// The format that a file name's extension asks for, in any case: `.ppm` and `.pnm` are [`Format::P6`], `.png` is
    /// [`Format::Png`].
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        if extension.eq_ignore_ascii_case("ppm") || extension.eq_ignore_ascii_case("pnm") {
            Some(Self::P6)
        } else if extension.eq_ignore_ascii_case("png") {
            Some(Self::Png)
        } else {
            None
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Format {
    type Err = String;

    /// Reads `p6`, `p3` or `png`, in any case.
    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(name));
        found.ok_or_else(|| format!("`{name}` is no picture format; there are p6, p3 and png"))
    }
}

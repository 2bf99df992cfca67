//! Reading pictures: a file is recognised by its first bytes, whatever its name.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::problem::{Problem, ProblemKind, ReadError, Warning};
use super::{Picture, png, ppm};
use crate::settings::Quantize;

/// What to do with a file that breaks its format's rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Leniency {
    /// It is an error.
    #[default]
    Strict,
    /// What has an obvious meaning is taken for that, with a warning: samples out of range are clamped, missing samples
    /// are 0, data after the last sample and transparency are ignored, 16-bit samples become levels of 8 bits by this rule, and a
    /// PNG that is cut off after its pixels, has more of them than its picture or is followed by other data is taken for what it holds.
    Lenient(Quantize),
}

impl Leniency {
    /// The level of 8 bits of a sample of 0..=`most`; fewer levels than that are spread evenly.
    pub(super) fn level(self, sample: u32, most: u32) -> u8 {
        let rule = match self {
            Self::Lenient(rule) if most > 255 => rule,
            _ => Quantize::Round,
        };
        rule.narrowed(sample, most)
    }
}

/// A picture that was read, with what had to be got over.
#[derive(Debug, Clone)]
pub struct Reading {
    /// The picture.
    pub picture: Picture,
    /// What is worth telling; also a strict reading has such, see [`Warning::Scaled`].
    pub warnings: Vec<Warning>,
    /// Chunks of a PNG (`gAMA`, `cHRM`, `sRGB`, `iCCP`) that say how its samples are to be shown. The samples are as stored.
    pub color_spaces: Vec<&'static str>,
}

/// A picture file that has been read but not decoded: its size is known before its pixels take memory.
#[derive(Debug)]
pub struct Encoded {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Encoded {
    /// Reads a file as far as it may be a picture.
    ///
    /// # Errors
    /// A file that cannot be read or is no picture by its first bytes.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let load = || load(File::open(path)?);
        Ok(Self {
            path: path.to_owned(),
            bytes: load().map_err(|problem| ReadError { path: path.to_owned(), problem })?,
        })
    }

    /// The same for a stream that messages call `name`.
    pub fn from_stream(name: &str, stream: impl Read) -> Result<Self, ReadError> {
        let path = PathBuf::from(name);
        match load(stream) {
            Ok(bytes) => Ok(Self { path, bytes }),
            Err(problem) => Err(ReadError { path, problem }),
        }
    }

    /// Width and height, as the header has them.
    ///
    /// # Errors
    /// A header that is wrong, or that promises more pixels than the file can hold or than are read at all.
    pub fn size(&self) -> Result<(u32, u32), ReadError> {
        let size = recognise(&self.bytes).and_then(|kind| match kind {
            Kind::Ppm => ppm::size(&self.bytes),
            Kind::Png => png::size(&self.bytes),
        });
        size.map_err(|problem| ReadError { path: self.path.clone(), problem })
    }

    /// Whether it is a PNG with 16 bits a channel.
    pub(crate) fn is_deep(&self) -> bool {
        self.bytes.starts_with(png::MAGIC) && png::is_deep(&self.bytes)
    }

    /// The levels of such a file without alpha: 3 a pixel.
    ///
    /// # Errors
    /// Contents that break the rules of their format, or are something else.
    pub(crate) fn decode_deep(self) -> Result<Vec<u16>, ReadError> {
        png::decode_deep(&self.bytes).map_err(|problem| ReadError { path: self.path, problem })
    }

    /// The picture; see [`read_picture`].
    ///
    /// # Errors
    /// Contents that break the rules of their format.
    pub fn decode(self, leniency: Leniency) -> Result<Reading, ReadError> {
        decode(self.bytes, leniency).map_err(|problem| ReadError { path: self.path, problem })
    }
}

/// Reads a PPM (P6 or P3) or PNG file.
///
/// Of PNG all kinds of 8 bits and less are accepted if they are opaque.
///
/// # Errors
/// A file that cannot be read, is none of these formats or breaks the rules of its own; see [`Problem`].
pub fn read_picture(path: &Path, leniency: Leniency) -> Result<Reading, ReadError> {
    Encoded::open(path)?.decode(leniency)
}

/// [`read_picture`] for a file's contents.
pub fn decode(bytes: Vec<u8>, leniency: Leniency) -> Result<Reading, Problem> {
    match recognise(&bytes)? {
        Kind::Ppm => ppm::decode(bytes, leniency),
        Kind::Png => png::decode(&bytes, leniency),
    }
}

fn load(mut file: impl Read) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    // First only as much as shows what it is: the rest may be endless.
    file.by_ref().take(png::MAGIC.len() as u64).read_to_end(&mut bytes)?;
    recognise(&bytes)?;
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

pub(super) enum Kind {
    Ppm,
    Png,
}

pub(super) fn recognise(bytes: &[u8]) -> Result<Kind, Problem> {
    let wanted = "wanted is PPM (P6 or P3) or PNG";
    let (looks_like, kind) = match bytes {
        [] => ("the file is empty", ProblemKind::CutOff),
        [b'P', b'3' | b'6', ..] => return Ok(Kind::Ppm),
        _ if bytes.starts_with(png::MAGIC) => return Ok(Kind::Png),
        [b'P', b'1' | b'4', ..] => ("this is PBM, black and white", ProblemKind::Unsupported),
        [b'P', b'2' | b'5', ..] => ("this is PGM, shades of grey", ProblemKind::Unsupported),
        [b'P', b'7', ..] => ("this is PAM", ProblemKind::Unsupported),
        [b'P', b'F' | b'f', ..] => ("this is PFM", ProblemKind::Unsupported),
        [b'p', b'3' | b'6', ..] => ("PPM starts with a capital P", ProblemKind::Damaged),
        [0xff, 0xd8, 0xff, ..] => ("this is JPEG, which does not keep pixels exactly", ProblemKind::Unsupported),
        [b'G', b'I', b'F', ..] => ("this is GIF", ProblemKind::Unsupported),
        [b'B', b'M', ..] => ("this is BMP", ProblemKind::Unsupported),
        [0xef, 0xbb, 0xbf, ..] => ("the file starts with a byte order mark", ProblemKind::Damaged),
        [0x89, b'P', b'N', b'G', ..] => {
            ("this is PNG with a damaged start (transferred as text?)", ProblemKind::Damaged)
        }
        _ => ("no known picture format", ProblemKind::Unsupported),
    };
    Err(Problem::fatal(format!("{looks_like}; {wanted}")).of_kind(kind))
}

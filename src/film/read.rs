//! Reading pictures: a file is recognised by its first bytes, whatever its name.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, GenericImageView, ImageDecoder, Limits};

use super::problem::{Problem, ReadError, Warning};
use super::{Picture, ppm};

/// What to do with a file that breaks its format's rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Leniency {
    /// It is an error.
    #[default]
    Strict,
    /// What has an obvious meaning is taken for that, with a warning: samples out of range are clamped, missing samples
    /// are 0, data after the last sample and transparency are ignored, 16-bit samples are rounded to 8 bits.
    Lenient,
}

/// A picture that was read, with what had to be got over.
#[derive(Debug, Clone)]
pub struct Reading {
    /// The picture.
    pub picture: Picture,
    /// What is worth telling; also a strict reading has such, see [`Warning::Scaled`].
    pub warnings: Vec<Warning>,
}

/// Reads a PPM (P6 or P3) or PNG file.
///
/// Of PNG all kinds of 8 bits and less are accepted if they are opaque.
///
/// # Errors
/// A file that cannot be read, is none of these formats or breaks the rules of its own; see [`Problem`].
pub fn read_picture(path: &Path, leniency: Leniency) -> Result<Reading, ReadError> {
    load(path).and_then(|bytes| decode(bytes, leniency)).map_err(|problem| ReadError { path: path.to_owned(), problem })
}

/// [`read_picture`] for a file's contents.
pub fn decode(bytes: Vec<u8>, leniency: Leniency) -> Result<Reading, Problem> {
    match recognise(&bytes)? {
        Kind::Ppm => ppm::decode(bytes, leniency),
        Kind::Png => decode_png(&bytes, leniency),
    }
}

fn load(path: &Path) -> Result<Vec<u8>, Problem> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    // First only as much as shows what it is: the rest may be endless.
    file.by_ref().take(PNG_MAGIC.len() as u64).read_to_end(&mut bytes)?;
    recognise(&bytes)?;
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

enum Kind {
    Ppm,
    Png,
}

const PNG_MAGIC: &[u8; 8] = b"\x89PNG\r\n\x1a\n";

/// The last chunk of every PNG file: length, name, checksum.
const PNG_END: &[u8; 12] = b"\0\0\0\0IEND\xae\x42\x60\x82";

fn recognise(bytes: &[u8]) -> Result<Kind, Problem> {
    let wanted = "wanted is PPM (P6 or P3) or PNG";
    let looks_like = match bytes {
        [] => "the file is empty",
        [b'P', b'3' | b'6', ..] => return Ok(Kind::Ppm),
        _ if bytes.starts_with(PNG_MAGIC) => return Ok(Kind::Png),
        [b'P', b'1' | b'4', ..] => "this is PBM, black and white",
        [b'P', b'2' | b'5', ..] => "this is PGM, shades of grey",
        [b'P', b'7', ..] => "this is PAM",
        [b'P', b'F' | b'f', ..] => "this is PFM",
        [b'p', b'3' | b'6', ..] => "PPM starts with a capital P",
        [0xff, 0xd8, 0xff, ..] => "this is JPEG, which does not keep pixels exactly",
        [b'G', b'I', b'F', ..] => "this is GIF",
        [b'B', b'M', ..] => "this is BMP",
        [0xef, 0xbb, 0xbf, ..] => "the file starts with a byte order mark",
        [0x89, b'P', b'N', b'G', ..] => "this is PNG with a damaged start (transferred as text?)",
        _ => "no known picture format",
    };
    Err(Problem::Unrecognised(format!("{looks_like}; {wanted}")))
}

fn decode_png(bytes: &[u8], leniency: Leniency) -> Result<Reading, Problem> {
    let damaged = |error: image::ImageError| Problem::Png(error.to_string());
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), png_limits(bytes)?).map_err(damaged)?;
    let color = decoder.color_type();
    let sixteen_bits = color.bytes_per_pixel() > color.channel_count();
    if sixteen_bits && leniency == Leniency::Strict {
        return Err(Problem::Lossy("the PNG has 16 bits a channel; pictures here have 8".into()));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    let mut warnings = Vec::new();
    if !bytes.ends_with(PNG_END) {
        if leniency == Leniency::Strict {
            return Err(Problem::PngEnd);
        }
        warnings.push(Warning::PngEnd);
    }
    if sixteen_bits {
        warnings.push(Warning::Scaled { maximum: 65535 });
    }
    if color.has_alpha() {
        warnings.extend(check_opaque(&image, leniency)?);
    }
    let image = image.into_rgb8();
    let (width, height) = image.dimensions();
    let picture = Picture::new(width, height, image.into_raw()).map_err(|wrong| Problem::Png(wrong.to_string()))?;
    Ok(Reading { picture, warnings })
}

/// Memory for decoding, after a check that the file can hold what its header promises.
fn png_limits(bytes: &[u8]) -> Result<Limits, Problem> {
    let number = |at: usize| bytes.get(at..at + 4).and_then(|field| field.try_into().ok()).map(u32::from_be_bytes);
    // The first chunk is IHDR; where it is not, the decoder finds out before it allocates anything.
    let (Some(width), Some(height), Some(&[depth, color])) = (number(16), number(20), bytes.get(24..26)) else {
        return Err(Problem::Png("the file ends within its header".into()));
    };
    let channels: u64 = match color {
        2 => 3,
        4 => 2,
        6 => 4,
        _ => 1,
    };
    let bits = width as u128 * height as u128 * (channels * depth as u64) as u128;
    let most_bits = bytes.len() as u128 * DEFLATE_RATIO * 8;
    if bits > most_bits {
        return Err(Problem::TooLarge { width, height });
    }
    let mut limits = Limits::no_limits();
    // Expanded to at most 4 channels of at least 8 bits, 64 MiB for everything beside the pixels.
    limits.max_alloc = Some((width as u64).saturating_mul(height as u64).saturating_mul(8).saturating_add(1 << 26));
    Ok(limits)
}

/// DEFLATE's greatest compression: 258 bytes for two bits.
const DEFLATE_RATIO: u128 = 1032;

fn check_opaque(image: &DynamicImage, leniency: Leniency) -> Result<Option<Warning>, Problem> {
    let mut see_through = image.pixels().filter(|(_, _, pixel)| pixel.0[3] != u8::MAX);
    let Some((x, y, _)) = see_through.next() else {
        return Ok(None);
    };
    match leniency {
        Leniency::Strict => Err(Problem::Lossy(format!("the pixel at x {x}, y {y} is not opaque"))),
        Leniency::Lenient => Ok(Some(Warning::AlphaDropped { pixels: 1 + see_through.count() as u64 })),
    }
}

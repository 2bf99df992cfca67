//! Reading PNG: all kinds of pixels become 8-bit RGB, and what surrounds them is looked at more closely than decoders do.

use std::fmt::Display;
use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Reader, Transformations};

use super::problem::{Problem, ProblemKind, Warning};
use super::read::{Leniency, Reading};
use super::surplus::{SURPLUS, has_surplus};
use super::{Picture, sample_count};
use crate::panics;
use crate::words::count;

pub(super) const MAGIC: &[u8; 8] = b"\x89PNG\r\n\x1a\n";

/// The chunk that ends every file: length, name, checksum.
const END: &[u8; 12] = b"\0\0\0\0IEND\xae\x42\x60\x82";

/// Chunks that say how samples are to be shown. They change no sample, so they are not obeyed but named.
const COLOR_SPACES: [&str; 4] = ["gAMA", "cHRM", "sRGB", "iCCP"];

/// The most pixels that are decoded: some hundred kilobytes of a file can stand for any number of them.
const MAX_PIXELS: u64 = 1 << 30;

/// DEFLATE's greatest compression: 258 bytes for two bits.
const DEFLATE_RATIO: u128 = 1032;

/// Memory for everything beside the pixels.
const BESIDE_PIXELS: usize = 1 << 26;

/// Width and height as the header has them, if the file can hold so many pixels and they may be decoded.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), Problem> {
    let number = |at: usize| bytes.get(at..at + 4).and_then(|field| field.try_into().ok()).map(u32::from_be_bytes);
    // The first chunk is IHDR; where it is not, the decoder finds out before it allocates anything.
    let (Some(width), Some(height), Some(&[depth, color])) = (number(16), number(20), bytes.get(24..26)) else {
        return Err(damaged("the file ends within its header").of_kind(ProblemKind::CutOff));
    };
    let channels: u64 = match color {
        2 => 3,
        4 => 2,
        6 => 4,
        _ => 1,
    };
    let bits = u128::from(width) * u128::from(height) * u128::from(channels * u64::from(depth));
    if bits > bytes.len() as u128 * DEFLATE_RATIO * 8 {
        return Err(Problem::too_large(width, height));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(Problem::fatal(format!(
            "the header promises {width}x{height} pixels; at most {MAX_PIXELS} are read"
        )));
    }
    // Decoders differ in what they make of it, and one panics.
    if let Some(length) = Chunks::of(bytes).palette.filter(|length| !length.is_multiple_of(3)) {
        return Err(damaged(format!("the palette has {}, not 3 for each colour", count(length as u64, "byte"))));
    }
    Ok((width, height))
}

/// Whether the header says that a channel has 16 bits.
pub(super) fn is_deep(bytes: &[u8]) -> bool {
    bytes.get(24) == Some(&16)
}

/// Levels of 16 bits: red, green and blue of each pixel.
pub(super) fn decode_deep(bytes: &[u8]) -> Result<Vec<u16>, Problem> {
    let mut levels = Vec::new();
    decode_into(bytes, Leniency::Strict, Some(&mut levels)).map(|_| levels)
}

pub(super) fn decode(bytes: &[u8], leniency: Leniency) -> Result<Reading, Problem> {
    decode_into(bytes, leniency, None)
}

/// With levels of 16 bits in `deep`, where they are wanted and there may be no others.
fn decode_into(bytes: &[u8], leniency: Leniency, deep: Option<&mut Vec<u16>>) -> Result<Reading, Problem> {
    let (width, height) = size(bytes)?;
    sample_count(width, height).map_err(damaged)?;
    let chunks = Chunks::of(bytes);
    let repaired;
    // What is whole of a file that is cut off can still hold all pixels.
    let whole = if chunks.ends {
        &bytes[..chunks.length]
    } else {
        repaired = [&bytes[..chunks.length], END].concat();
        &repaired
    };
    // A decoder's panic is a damaged file like any other.
    let decoded = panics::caught(|| pixels(whole, width, height, leniency, deep));
    let decoded =
        decoded.map_err(|why| damaged(format!("the decoder cannot make sense of it ({why})"))).and_then(|read| read);
    let (rgb, mut warnings) = decoded.map_err(|problem| match problem.kind() {
        ProblemKind::Damaged if !chunks.ends => problem.of_kind(ProblemKind::CutOff),
        _ => problem,
    })?;
    let end = if !chunks.ends {
        let why = "the PNG is cut off after its pixels: it does not end with its IEND chunk";
        Some((Problem::mendable(why).of_kind(ProblemKind::CutOff), Warning::PngCutOff))
    } else if chunks.length < bytes.len() {
        let bytes = (bytes.len() - chunks.length) as u64;
        let why = format!("data after the end of the PNG: {}", count(bytes, "byte"));
        Some((Problem::mendable(why), Warning::PngTrailing { bytes }))
    } else {
        None
    };
    match (end, leniency) {
        (Some((problem, _)), Leniency::Strict) => return Err(problem),
        (Some((_, warning)), Leniency::Lenient(_)) => warnings.insert(0, warning),
        (None, _) => {}
    }
    Ok(Reading { picture: Picture::assemble(width, height, rgb), warnings, color_spaces: chunks.color_spaces })
}

/// The file's outer structure.
struct Chunks {
    /// Bytes up to the end of the last whole chunk that counts.
    length: usize,
    /// Whether that is the one that ends the file.
    ends: bool,
    /// Bytes of the palette.
    palette: Option<usize>,
    /// Which of [`COLOR_SPACES`] there are.
    color_spaces: Vec<&'static str>,
}

impl Chunks {
    fn of(bytes: &[u8]) -> Self {
        let mut chunks = Self { length: MAGIC.len(), ends: false, palette: None, color_spaces: Vec::new() };
        while let Some((length, rest)) = bytes[chunks.length..].split_first_chunk::<4>()
            && let Some(name) = rest.first_chunk::<4>()
            // The name and the checksum are not counted.
            && let Some(end) = (u32::from_be_bytes(*length) as usize).checked_add(8).filter(|&end| end <= rest.len())
        {
            chunks.length += 4 + end;
            let found = COLOR_SPACES.into_iter().find(|known| known.as_bytes() == name);
            chunks.color_spaces.extend(found.filter(|found| !chunks.color_spaces.contains(found)));
            if name == b"PLTE" {
                chunks.palette = Some(end - 8);
            }
            if name == b"IEND" {
                chunks.ends = true;
                break;
            }
        }
        chunks
    }
}

fn damaged(why: impl Display) -> Problem {
    Problem::fatal(format!("damaged PNG: {why}"))
}

/// All samples in 8-bit RGB, and what was lost on the way.
fn pixels(
    bytes: &[u8],
    width: u32,
    height: u32,
    leniency: Leniency,
    deep: Option<&mut Vec<u16>>,
) -> Result<(Vec<u8>, Vec<Warning>), Problem> {
    let row_bytes = width as usize * 8; // at most 4 channels of 2 bytes
    let limits = png::Limits { bytes: BESIDE_PIXELS.saturating_add(row_bytes) };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::IDENTITY);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let mut rows = Rows::of(&reader, width, leniency, deep)?;
    let samples = width as usize * height as usize * 3;
    let out_of_memory = || Problem::fatal(format!("there is no memory for {width}x{height} pixels"));
    rows.rgb.try_reserve_exact(samples).map_err(|_| out_of_memory())?;
    if reader.info().interlaced {
        let size = reader.output_buffer_size().ok_or_else(out_of_memory)?;
        let mut raw = Vec::new();
        raw.try_reserve_exact(size).map_err(|_| out_of_memory())?;
        raw.resize(size, 0);
        let line = reader.next_frame(&mut raw).map_err(damaged)?.line_size;
        raw.chunks_exact(line).try_for_each(|row| rows.add(row))?;
    } else {
        while let Some(row) = reader.next_row().map_err(damaged)? {
            rows.add(row.data())?;
        }
    }
    reader.finish().map_err(damaged)?;
    if rows.rgb.len() != samples {
        return Err(damaged("rows are missing"));
    }
    if has_surplus(bytes, reader.info())? {
        match leniency {
            Leniency::Strict => return Err(Problem::mendable(SURPLUS)),
            Leniency::Lenient(_) => rows.warnings.push(Warning::PngSurplus),
        }
    }
    Ok((rows.rgb, rows.warnings))
}

/// Rows of a file on their way to RGB.
struct Rows<'d> {
    kind: Kind,
    depth: usize,
    width: usize,
    leniency: Leniency,
    rgb: Vec<u8>,
    /// Levels of 16 bits, where they are wanted.
    deep: Option<&'d mut Vec<u16>>,
    warnings: Vec<Warning>,
}

/// What the samples of a pixel mean; in some kinds one colour may be declared transparent.
enum Kind {
    Grey {
        transparent: Option<u16>,
    },
    Rgb {
        transparent: Option<[u16; 3]>,
    },
    /// Colours, and the opacity of the first of them.
    Palette {
        colors: Vec<[u8; 3]>,
        opacity: Vec<u8>,
    },
    GreyAlpha,
    Rgba,
}

impl<'d> Rows<'d> {
    fn of(
        reader: &Reader<Cursor<&[u8]>>,
        width: u32,
        leniency: Leniency,
        deep: Option<&'d mut Vec<u16>>,
    ) -> Result<Self, Problem> {
        let info = reader.info();
        let depth = info.bit_depth as usize;
        // The decoder keeps a declared colour in as many bytes as a sample takes.
        let declared = info.trns.as_deref();
        let declared: Option<Vec<u16>> = declared.map(|bytes| match info.bit_depth {
            BitDepth::Sixteen => bytes.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect(),
            _ => bytes.iter().map(|&byte| u16::from(byte)).collect(),
        });
        let kind = match info.color_type {
            ColorType::Grayscale => Kind::Grey { transparent: declared.and_then(|color| color.first().copied()) },
            ColorType::Rgb => Kind::Rgb { transparent: declared.and_then(|color| color.first_chunk().copied()) },
            ColorType::Indexed => Kind::Palette {
                colors: info.palette.as_deref().unwrap_or_default().as_chunks().0.to_vec(),
                opacity: info.trns.as_deref().unwrap_or_default().to_vec(),
            },
            ColorType::GrayscaleAlpha => Kind::GreyAlpha,
            ColorType::Rgba => Kind::Rgba,
        };
        let mut warnings = Vec::new();
        if deep.is_some() {
            if depth != 16 || !matches!(kind, Kind::Rgb { transparent: None }) {
                let message = "the PNG has another kind of pixels than opaque ones with 16 bits of red, green and blue";
                return Err(Problem::mendable(message).of_kind(ProblemKind::Unsupported));
            }
        } else if depth == 16 {
            if leniency == Leniency::Strict {
                let message = "the PNG has 16 bits a channel; pictures here have 8";
                return Err(Problem::mendable(message).of_kind(ProblemKind::Unsupported));
            }
            warnings.push(Warning::Scaled { maximum: 65535 });
        }
        Ok(Self { kind, depth, width: width as usize, leniency, rgb: Vec::new(), deep, warnings })
    }

    fn add(&mut self, row: &[u8]) -> Result<(), Problem> {
        if matches!((&self.kind, self.depth), (Kind::Rgb { transparent: None }, 8)) {
            self.rgb.extend_from_slice(row);
            return Ok(());
        }
        if let Some(deep) = &mut self.deep {
            deep.extend(row.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)));
        }
        for x in 0..self.width {
            let (color, opaque) = self.pixel(row, x)?;
            self.rgb.extend_from_slice(&color);
            if !opaque {
                self.see_through(x)?;
            }
        }
        Ok(())
    }

    /// A pixel's colour, and whether it is opaque.
    fn pixel(&self, row: &[u8], x: usize) -> Result<([u8; 3], bool), Problem> {
        let depth = self.depth;
        let most = (1_u32 << depth) - 1;
        let sample = |index: usize| match depth {
            16 => u16::from_be_bytes([row[2 * index], row[2 * index + 1]]),
            8 => row[index].into(),
            _ => u16::from(row[index * depth / 8] >> (8 - depth - index * depth % 8)) & most as u16,
        };
        let level = |sample: u16| self.leniency.level(sample.into(), most);
        Ok(match &self.kind {
            Kind::Grey { transparent } => {
                let grey = sample(x);
                ([level(grey); 3], *transparent != Some(grey))
            }
            Kind::Rgb { transparent } => {
                let color = [0, 1, 2].map(|channel| sample(3 * x + channel));
                (color.map(level), *transparent != Some(color))
            }
            Kind::Palette { colors, opacity } => {
                let index = sample(x) as usize;
                let color = colors.get(index).ok_or_else(|| self.beyond_palette(x, index, colors.len()))?;
                (*color, opacity.get(index).is_none_or(|&opacity| opacity == u8::MAX))
            }
            Kind::GreyAlpha => ([level(sample(2 * x)); 3], u32::from(sample(2 * x + 1)) == most),
            Kind::Rgba => {
                let color = [0, 1, 2].map(|channel| level(sample(4 * x + channel)));
                (color, u32::from(sample(4 * x + 3)) == most)
            }
        })
    }

    fn row_number(&self) -> usize {
        self.rgb.len().saturating_sub(1) / (3 * self.width)
    }

    fn beyond_palette(&self, x: usize, index: usize, colors: usize) -> Problem {
        let y = self.rgb.len() / (3 * self.width);
        damaged(format!("the pixel at x {x}, y {y} has index {index} in a palette of {colors} colours"))
    }

    /// Takes note of a pixel that is not opaque, just added.
    fn see_through(&mut self, x: usize) -> Result<(), Problem> {
        if self.leniency == Leniency::Strict {
            let message = format!("the pixel at x {x}, y {} is not opaque", self.row_number());
            return Err(Problem::mendable(message).of_kind(ProblemKind::Unsupported));
        }
        match self.warnings.last_mut() {
            Some(Warning::AlphaDropped { pixels }) => *pixels += 1,
            _ => self.warnings.push(Warning::AlphaDropped { pixels: 1 }),
        }
        Ok(())
    }
}

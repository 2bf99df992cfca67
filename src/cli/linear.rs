//! `--bits`, `--alpha` and the endings of `trueray render` that write colours in place of 8-bit levels.

use std::borrow::Cow;
use std::path::Path;
use std::str::FromStr;

use glam::DVec3;

use super::color_bar::in_words;
use super::failure::{Failure, USAGE};
use super::named::format_or_refusal;
use crate::certificate::Bits;
use crate::color_bar::ColorBar;
use crate::film::{
    Container, Format, LinearFormat, LinearPicture, MOST_LINEAR_PIXELS, OutputError, PictureWriter, Target,
};
use crate::linear::Linear;
use crate::settings::Quantize;

/// What a file has of each pixel.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct LinearOptions {
    /// Bits of each channel of a PNG: 8 or 16, with the same rule of quantisation
    #[arg(long, value_name = "N", value_parser = bits)]
    bits: Option<u8>,
    /// Write an alpha channel, of a PNG or EXR: the part of a pixel's samples that hit a sphere. The background is left out of the
    /// colour
    #[arg(long)]
    alpha: bool,
}

fn bits(text: &str) -> Result<u8, &'static str> {
    text.parse().ok().filter(|bits| [8, 16].contains(bits)).ok_or("expected 8 or 16")
}

/// What `--format` or the ending of a file's name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FileFormat {
    /// One of 8-bit levels; a PNG may have more.
    Levels(Format),
    Pfm,
    Exr,
}

impl FileFormat {
    /// What the ending of a file's name says.
    pub(super) fn by_ending(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().unwrap_or_default();
        if ending.eq_ignore_ascii_case("pfm") {
            Ok(Self::Pfm)
        } else if ending.eq_ignore_ascii_case("exr") {
            Ok(Self::Exr)
        } else {
            format_or_refusal(path, ".ppm, .png, .pfm or .exr").map(Self::Levels)
        }
    }
}

impl FromStr for FileFormat {
    type Err = String;

    /// Reads `p6`, `p3`, `png`, `pfm` or `exr`, in any case.
    fn from_str(name: &str) -> Result<Self, String> {
        match name.to_ascii_lowercase().as_str() {
            "pfm" => Ok(Self::Pfm),
            "exr" => Ok(Self::Exr),
            other => other
                .parse()
                .map(Self::Levels)
                .map_err(|_| format!("`{name}` is no picture format; there are p6, p3, png, pfm and exr")),
        }
    }
}

/// How a picture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// As 8-bit levels, row by row.
    Levels(Format),
    /// As colours.
    Linear(LinearFormat),
}

impl LinearOptions {
    /// How a file of this format is written.
    pub(super) fn coding(self, format: FileFormat) -> Result<Coding, Failure> {
        let refused = |why: &str| Err(Failure::new(USAGE, why));
        let linear = |container| Ok(Coding::Linear(LinearFormat { container, alpha: self.alpha }));
        match (format, self.bits) {
            (FileFormat::Levels(Format::Png), Some(16)) => linear(Container::Png16),
            (FileFormat::Levels(Format::Png), _) if self.alpha => linear(Container::Png8),
            (FileFormat::Levels(_), _) if self.alpha => refused("PPM has no alpha channel: --alpha is for PNG and EXR"),
            (FileFormat::Levels(_), Some(16)) => refused("--bits 16 is for PNG: PPM is written with 8 bits"),
            (FileFormat::Levels(format), _) => Ok(Coding::Levels(format)),
            (_, Some(_)) => refused("--bits is for PNG: PFM and EXR have 32-bit numbers"),
            (FileFormat::Pfm, None) if self.alpha => refused("PFM has no alpha channel: --alpha is for PNG and EXR"),
            (FileFormat::Pfm, None) => linear(Container::Pfm),
            (FileFormat::Exr, None) => linear(Container::Exr),
        }
    }
}

impl Coding {
    /// The format of 8-bit levels, if it is one.
    pub(super) fn levels(self) -> Option<Format> {
        match self {
            Self::Levels(format) => Some(format),
            Self::Linear(_) => None,
        }
    }

    /// Whether the file has levels, and no numbers that are none.
    pub(super) fn has_levels(self) -> bool {
        let is_png = |format: LinearFormat| matches!(format.container, Container::Png8 | Container::Png16);
        match self {
            Self::Levels(_) => true,
            Self::Linear(format) => is_png(format),
        }
    }

    /// The bits of a level, where the file has nothing but levels of red, green and blue.
    pub(super) fn hash_bits(self) -> Option<Bits> {
        match self {
            Self::Levels(_) => Some(Bits::Eight),
            Self::Linear(LinearFormat { container: Container::Png16, alpha: false }) => Some(Bits::Sixteen),
            Self::Linear(_) => None,
        }
    }

    /// Whether the renderer is asked for colours.
    pub(super) fn is_linear(self) -> bool {
        self.levels().is_none()
    }

    /// Refuses more pixels than are kept.
    pub(super) fn check_size(self, (width, height): (u32, u32)) -> Result<(), Failure> {
        if self.is_linear() && u64::from(width) * u64::from(height) > MOST_LINEAR_PIXELS {
            let why = format!("pictures of colours or with alpha have {MOST_LINEAR_PIXELS} pixels at the most");
            return Err(Failure::new(USAGE, why));
        }
        Ok(())
    }
}

/// A picture on its way to its file.
pub(super) struct Film {
    file: File,
    /// What is drawn over it.
    bar: Option<ColorBar>,
    width: u32,
    /// Rows so far.
    rows: u32,
}

enum File {
    Levels(PictureWriter),
    Linear(LinearPicture, Target),
}

/// What the text about a bar is called in a file.
const BAR_TEXT: &str = "Description";

impl Film {
    /// Opens the file, which says `note` of itself where there is one, else what `bar` shows.
    pub(super) fn new(
        coding: Coding,
        target: &Target,
        size: (u32, u32),
        note: Option<&str>,
        (quantize, background): (Quantize, DVec3),
        bar: Option<ColorBar>,
    ) -> Result<Self, OutputError> {
        let shown = bar.as_ref().map(|bar| in_words(bar.scale()));
        let text = shown.as_deref().map(|text| (BAR_TEXT, text));
        let file = match (coding, note) {
            (Coding::Levels(format), Some(_)) => File::Levels(PictureWriter::with_note(target, format, size, note)?),
            (Coding::Levels(format), None) => File::Levels(PictureWriter::with_text(target, format, size, text)?),
            (Coding::Linear(format), _) => {
                File::Linear(LinearPicture::new(format, size, quantize, background).with_text(text), target.clone())
            }
        };
        Ok(Self { file, bar, width: size.0, rows: 0 })
    }

    /// Takes the next rows: 3 bytes a pixel, and colours where the engine has them. Returns the levels with what is drawn over them.
    pub(super) fn write<'r>(&mut self, rgb: &'r [u8], linear: &[Linear]) -> Result<Cow<'r, [u8]>, OutputError> {
        let _span = tracing::info_span!("write rows").entered();
        let (mut rgb, mut linear) = (Cow::Borrowed(rgb), Cow::Borrowed(linear));
        let (first, rows) = (self.rows, (rgb.len() / 3) as u32 / self.width);
        self.rows += rows;
        if let Some(bar) = self.bar.as_ref().filter(|bar| bar.touches(first, rows)) {
            bar.draw(first, rgb.to_mut(), linear.to_mut());
        }
        match &mut self.file {
            File::Levels(writer) => writer.write_rows(&rgb)?,
            File::Linear(picture, _) => picture.add(&rgb, &linear),
        }
        Ok(rgb)
    }

    /// Completes the file.
    pub(super) fn finish(self) -> Result<(), OutputError> {
        match self.file {
            File::Levels(writer) => writer.finish(),
            File::Linear(picture, target) => picture.save(&target),
        }
    }
}

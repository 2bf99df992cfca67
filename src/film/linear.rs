//! Pictures of colours that are no 8-bit levels, or with an alpha channel: PNG, PFM and EXR.

use std::io;

use glam::DVec3;
use png::{BitDepth, ColorType};

use super::write::{OutputError, Target, encode_png_of, save_bytes};
use super::{encode_exr, encode_pfm};
use crate::linear::Linear;
use crate::settings::Quantize;

/// What such a picture is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// PNG of 8 bits a channel.
    Png8,
    /// PNG of 16 bits a channel.
    Png16,
    /// PFM: three 32-bit numbers a pixel.
    Pfm,
    /// EXR: the channels `R`, `G` and `B` of 32-bit numbers.
    Exr,
}

/// How a picture of colours is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LinearFormat {
    /// The kind of file.
    pub container: Container,
    /// Whether there is an alpha channel: the part of a pixel's samples that hit a sphere. Colours are without background then, straight
    /// in PNG and premultiplied in EXR, as their specifications say.
    pub alpha: bool,
}

/// The most pixels of such a picture, which is kept until it is written.
pub const MOST_LINEAR_PIXELS: u64 = 1 << 25;

/// A picture of colours on its way to a file.
#[derive(Debug)]
pub struct LinearPicture {
    format: LinearFormat,
    size: (u32, u32),
    quantize: Quantize,
    background: DVec3,
    /// A keyword and what the file says under it; PFM has no room for it.
    text: Option<(String, String)>,
    /// Samples of a PNG as the file has them, before compression.
    levels: Vec<u8>,
    /// Numbers of the other files.
    numbers: Vec<f32>,
}

impl LinearPicture {
    /// A picture without rows so far, before this background.
    pub fn new(format: LinearFormat, size: (u32, u32), quantize: Quantize, background: DVec3) -> Self {
        Self { format, size, quantize, background, text: None, levels: Vec::new(), numbers: Vec::new() }
    }

    /// The same whose file has a text under a keyword.
    pub(crate) fn with_text(self, text: Option<(&str, &str)>) -> Self {
        Self { text: text.map(|(keyword, text)| (keyword.into(), text.into())), ..self }
    }

    /// Adds rows: the levels of pixels, 3 bytes each, and their colours.
    pub fn add(&mut self, rgb: &[u8], linear: &[Linear]) {
        for (levels, linear) in rgb.as_chunks::<3>().0.iter().zip(linear) {
            self.add_pixel(*levels, linear);
        }
    }

    fn add_pixel(&mut self, levels: [u8; 3], linear: &Linear) {
        let LinearFormat { container, alpha } = self.format;
        let (background, coverage) = (self.background, linear.coverage);
        match container {
            // What is wholly covered has the levels of the picture without alpha.
            Container::Png8 if coverage == 1.0 || !alpha => self.levels.extend(levels),
            Container::Png8 => self.levels.extend(self.quantize.levels(linear.straight(background))),
            Container::Png16 => {
                let color = if alpha { linear.straight(background) } else { linear.color };
                self.levels.extend(self.quantize.levels16(color).into_iter().flat_map(u16::to_be_bytes));
            }
            Container::Pfm | Container::Exr => {
                let color = if alpha { linear.premultiplied(background) } else { linear.color };
                self.numbers.extend(color.as_vec3().to_array());
            }
        }
        if alpha {
            match container {
                Container::Png8 => self.levels.push((255.0 * coverage).round() as u8),
                Container::Png16 => self.levels.extend(((65535.0 * coverage).round() as u16).to_be_bytes()),
                Container::Pfm | Container::Exr => self.numbers.push(coverage as f32),
            }
        }
    }

    /// Writes the picture, all rows of which are there: the file is complete or not there at all.
    ///
    /// # Errors
    ///
    /// A folder that does not exist, a file or folder without write permission, rows that are missing, or whatever the system says.
    pub fn save(self, target: &Target) -> Result<(), OutputError> {
        let Self { format: LinearFormat { container, alpha }, size: (width, height), text, levels, numbers, .. } = self;
        let text = text.as_ref().map(|(keyword, text)| (keyword.as_str(), text.as_str()));
        let channels = if alpha { 4 } else { 3 };
        let color = if alpha { ColorType::Rgba } else { ColorType::Rgb };
        let file = match container {
            Container::Png8 => encode_png_of((width, height), (color, BitDepth::Eight), text, &levels),
            Container::Png16 => encode_png_of((width, height), (color, BitDepth::Sixteen), text, &levels),
            Container::Pfm => Ok(encode_pfm(width, height, channels, &numbers)),
            Container::Exr => {
                let channel = |(at, name): (usize, &&str)| {
                    let values = numbers.iter().copied().skip(at).step_by(channels).collect();
                    ((*name).to_owned(), values)
                };
                let named = ["R", "G", "B", "A"][..channels].iter().enumerate().map(channel).collect();
                encode_exr(width, height, named, text.map(|(_, text)| text)).map_err(io::Error::other)
            }
        };
        let file = file.map_err(|source| target.error("write", source))?;
        save_bytes(target, &file)
    }
}

//! Mistakes of whoever asks a renderer for something: nothing is rendered then.

use std::fmt;

use crate::area::Area;
use crate::pattern::Pattern;
use crate::scene::MAX_RESOLUTION;
use crate::settings::{Secondary, Settings};
use crate::viewed::ViewedScene;

/// What is asked for makes no sense.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Misuse {
    /// The picture, its number of samples or its depth is out of range.
    Picture(String),
    /// Rows that are not of the picture, or bytes that are no whole rows.
    Rows {
        /// The first row.
        first: u32,
        /// Room for its rows.
        bytes: usize,
        /// Width and height of the picture.
        size: (u32, u32),
    },
    /// A pixel that is not of the picture.
    Pixel {
        /// Its column and row.
        pixel: [u32; 2],
        /// The picture, or the part of it that is rendered.
        area: Area,
    },
    /// A rectangle that is empty or not within the picture.
    Area {
        /// The rectangle.
        area: Area,
        /// Width and height of the picture.
        size: (u32, u32),
    },
    /// A part of a picture that there is not.
    Tile {
        /// Its number, from 0.
        index: u32,
        /// Number of parts.
        count: u32,
        /// Rows of the picture.
        height: u32,
    },
    /// Not one colour for each pixel.
    Colors {
        /// Number of pixels.
        pixels: usize,
        /// Number of colours.
        colors: usize,
    },
    /// Samples of a picture of another size.
    Samples {
        /// Width and height of the picture that they are of.
        of: (u32, u32),
        /// Width and height of the picture.
        size: (u32, u32),
    },
    /// A number of a tuning that is out of its limits.
    Tuning(String),
    /// A batch of rays whose parts do not fit together.
    Batch(String),
}

impl fmt::Display for Misuse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Picture(why) | Self::Tuning(why) | Self::Batch(why) => f.write_str(why),
            Self::Rows { first, bytes, size: (width, height) } => {
                write!(f, "{bytes} bytes from row {first} on are no rows of a picture of {width}x{height} pixels")
            }
            Self::Pixel { pixel: [x, y], area: Area { top: 0, left: 0, width, height } } => {
                write!(f, "the pixel in column {x} and row {y} is not of a picture of {width}x{height} pixels")
            }
            Self::Pixel { pixel: [x, y], area } => {
                write!(f, "the pixel in column {x} and row {y} is not of the rectangle {area}")
            }
            Self::Area { area, size: (width, height) } => {
                write!(f, "the rectangle {area} is not within a picture of {width}x{height} pixels")
            }
            Self::Tile { index, count, .. } if index >= count => {
                write!(f, "there is no part {index} of {count}: they are counted from 0")
            }
            Self::Tile { count, height, .. } => write!(f, "a picture of {height} rows has no {count} parts"),
            Self::Colors { pixels, colors } => write!(f, "{colors} colours for {pixels} pixels"),
            Self::Samples { of: (of_width, of_height), size: (width, height) } => {
                write!(f, "samples of a picture of {of_width}x{of_height} pixels for one of {width}x{height}")
            }
        }
    }
}

impl std::error::Error for Misuse {}

/// Whether there is such a picture of `viewed`.
pub(crate) fn check_picture(viewed: &ViewedScene) -> Result<(), Misuse> {
    let (scene, settings) = (viewed.scene(), viewed.settings());
    let most = match settings.pattern {
        Pattern::Grid { .. } => Pattern::MAX_SIDE,
        Pattern::Fibonacci { .. } => Pattern::MAX_COUNT,
    };
    let numbers = [
        ("width", scene.width, 1..=MAX_RESOLUTION),
        ("height", scene.height, 1..=MAX_RESOLUTION),
        ("samples", settings.pattern.side(), 1..=most),
        ("max_depth", settings.max_depth, 0..=Settings::MAX_DEPTH),
    ];
    let Secondary { shadow, reflection } = settings.secondary;
    if !(0.0..1.0).contains(&shadow) || !(reflection >= 0.0) {
        return Err(Misuse::Picture(format!(
            "rays cannot begin at {shadow} of the way to a light and at a distance of {reflection}"
        )));
    }
    match numbers.into_iter().find(|(_, number, range)| !range.contains(number)) {
        None => Ok(()),
        Some((name, number, range)) => {
            Err(Misuse::Picture(format!("{name} is {number}, not from {} to {}", range.start(), range.end())))
        }
    }
}

/// Whether the picture has rows from `first` on for so many bytes, 3 a pixel; their number.
pub(crate) fn check_rows(size: (u32, u32), first: u32, bytes: usize) -> Result<u32, Misuse> {
    let row_bytes = size.0 as usize * 3;
    let rest = size.1.saturating_sub(first) as usize;
    if row_bytes > 0 && bytes.is_multiple_of(row_bytes) && bytes / row_bytes <= rest {
        Ok((bytes / row_bytes) as u32)
    } else {
        Err(Misuse::Rows { first, bytes, size })
    }
}

/// Whether all pixels are of this part of the picture, and there is a colour for each.
pub(crate) fn check_pixels(area: Area, pixels: &[[u32; 2]], colors: usize) -> Result<(), Misuse> {
    check_colors(pixels.len(), colors)?;
    match pixels.iter().find(|&&pixel| !area.has(pixel)) {
        None => Ok(()),
        Some(&pixel) => Err(Misuse::Pixel { pixel, area }),
    }
}

/// Whether there is a colour for each pixel.
pub(crate) fn check_colors(pixels: usize, colors: usize) -> Result<(), Misuse> {
    if pixels == colors { Ok(()) } else { Err(Misuse::Colors { pixels, colors }) }
}

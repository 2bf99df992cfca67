//! Pictures of a difference.

use super::{SizeMismatch, level};
use crate::film::Picture;

/// A range of level differences and its colour in the heat map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Band {
    /// The least level difference in the band; it ends where the next one starts.
    pub from: u8,
    /// The colour.
    pub color: [u8; 3],
    /// The range and the colour in words.
    pub legend: &'static str,
}

/// The heat map's scale, from the smallest differences to the greatest.
///
/// Entries of inferno, a colour map of matplotlib (N. J. Smith, S. van der Walt, CC0): its lightness grows in equal steps,
/// which every kind of colour vision sees. The greys of pixels that are the same are darker than all of it.
pub const SCALE: [Band; 5] = [
    Band { from: 1, color: [120, 28, 109], legend: "1 level: purple" },
    Band { from: 2, color: [188, 55, 84], legend: "2 levels: red" },
    Band { from: 3, color: [242, 116, 28], legend: "3 to 10 levels: orange" },
    Band { from: 11, color: [252, 178, 22], legend: "11 to 50 levels: amber" },
    Band { from: 51, color: [252, 255, 164], legend: "51 levels and more: pale yellow" },
];

/// The brightest grey of a pixel that is the same in both pictures.
const BRIGHTEST_SAME: u32 = 48;

impl Band {
    /// How many pixels of each band of [`SCALE`] two pictures have.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn counts(a: &Picture, b: &Picture) -> Result<[u64; SCALE.len()], SizeMismatch> {
        SizeMismatch::check(a, b)?;
        let mut counts = [0; SCALE.len()];
        let bands = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).filter_map(|(&a, &b)| band(level(a, b)));
        bands.for_each(|band| counts[band] += 1);
        Ok(counts)
    }
}

/// The place in [`SCALE`] of a level difference; `None` for no difference.
fn band(level: u8) -> Option<usize> {
    SCALE.iter().rposition(|band| band.from <= level)
}

/// The columns between the pictures of [`three_wide`]: black and white, to be seen beside any background.
const GAP: [[u8; 3]; 4] = [[255; 3], [0; 3], [0; 3], [255; 3]];

/// The difference of two pictures as a picture: pixels that are the same as dark greys of A, so that one sees where one
/// is, all others in the colour of their level difference on [`SCALE`].
///
/// # Errors
/// Pictures of different sizes.
pub fn heatmap(a: &Picture, b: &Picture) -> Result<Picture, SizeMismatch> {
    SizeMismatch::check(a, b)?;
    let pixels: Vec<[u8; 3]> = a.pixels().iter().zip(b.pixels()).map(|(&a, &b)| pixel_heat(a, b)).collect();
    Ok(Picture::assemble(a.width(), a.height(), pixels.into_flattened()))
}

/// A, B and the heat map side by side, with a thin black and white line between them.
///
/// # Errors
/// Pictures of different sizes.
pub fn three_wide(a: &Picture, b: &Picture) -> Result<Picture, SizeMismatch> {
    let heat = heatmap(a, b)?;
    let width = a.width() * 3 + 2 * GAP.len() as u32;
    let mut rgb = Vec::with_capacity(width as usize * a.height() as usize * 3);
    for y in 0..a.height() {
        for part in [a.row(y), &GAP, b.row(y), &GAP, heat.row(y)] {
            rgb.extend_from_slice(part.as_flattened());
        }
    }
    Ok(Picture::assemble(width, a.height(), rgb))
}

/// A pixel of [`heatmap`].
pub(super) fn pixel_heat(a: [u8; 3], b: [u8; 3]) -> [u8; 3] {
    match band(level(a, b)) {
        Some(band) => SCALE[band].color,
        None => [dark_grey(a); 3],
    }
}

fn dark_grey([red, green, blue]: [u8; 3]) -> u8 {
    // Rec. 709's weights in thousandths.
    let luma = (213 * red as u32 + 715 * green as u32 + 72 * blue as u32) / 1000;
    (luma * BRIGHTEST_SAME / 255) as u8
}

//! Letters of one width from 16 pixels on, as large as suits a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, RasterizedChar, get_raster, get_raster_width};

/// A line of text is this part of a picture's shorter side.
const LINES: i64 = 30;

/// A size of letters: that of a raster, or times as large.
#[derive(Debug, Clone, Copy)]
pub(super) struct Font {
    raster: RasterHeight,
    times: i64,
}

impl Font {
    /// For a picture with this shorter side.
    pub(super) fn of(side: i64) -> Self {
        let (raster, times) = match side / LINES {
            ..20 => (RasterHeight::Size16, 1),
            20..24 => (RasterHeight::Size20, 1),
            24..32 => (RasterHeight::Size24, 1),
            line => (RasterHeight::Size32, line / 32),
        };
        Self { raster, times }
    }

    /// Height of a line in pixels.
    pub(super) fn line(self) -> i64 {
        self.raster.val().cast_signed() as i64 * self.times
    }

    /// Width of `letters` letters in pixels.
    pub(super) fn width(self, letters: usize) -> i64 {
        (get_raster_width(FontWeight::Regular, self.raster) * letters).cast_signed() as i64 * self.times
    }

    /// From the top of a line to the middle of its digits.
    pub(super) fn middle(self) -> i64 {
        let has_ink = |row: &[u8]| row.iter().any(|&ink| ink > 0);
        let rows =
            || glyph('0', self.raster).into_iter().flat_map(|glyph| glyph.rows().enumerate().collect::<Vec<_>>());
        let inked = || rows().filter(|(_, row)| has_ink(row)).map(|(at, _)| at.cast_signed() as i64);
        let (first, last) = (inked().min().unwrap_or(0), inked().max().unwrap_or(0));
        (first + last + 1) * self.times / 2
    }

    /// How much of the pixel in column `x` and row `y` of a text is ink, 0 to 255. What is enlarged is smooth.
    pub(super) fn ink(self, text: &[char], x: i64, y: i64) -> u8 {
        let sample = |x: i64, y: i64| {
            let width = self.width(1) / self.times;
            let letter = usize::try_from(x.div_euclid(width)).ok().and_then(|at| text.get(at));
            let glyph = letter.and_then(|&letter| glyph(letter, self.raster));
            let row = usize::try_from(y).unwrap_or(usize::MAX);
            glyph.and_then(|glyph| glyph.pixel(x.rem_euclid(width) as usize, row)).map_or(0, i64::from)
        };
        // Places in 2n-ths of a raster's pixel, from the middle of its first one.
        let n = 2 * self.times;
        let [u, v] = [x, y].map(|at| 2 * at + 1 - self.times);
        let ([i, j], [p, q]) = ([u, v].map(|at| at.div_euclid(n)), [u, v].map(|at| at.rem_euclid(n)));
        let upper = sample(i, j) * (n - p) + sample(i + 1, j) * p;
        let lower = sample(i, j + 1) * (n - p) + sample(i + 1, j + 1) * p;
        ((upper * (n - q) + lower * q + n * n / 2) / (n * n)) as u8
    }
}

/// A letter; one that the font has not is shown as such.
fn glyph(letter: char, raster: RasterHeight) -> Option<RasterizedChar> {
    [letter, char::REPLACEMENT_CHARACTER].into_iter().find_map(|c| get_raster(c, FontWeight::Regular, raster))
}

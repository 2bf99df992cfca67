//! The score of a picture.

use crate::compare::level;
use crate::film::Picture;

/// The score of a picture that is right.
pub const FULL: u8 = 100;

/// The rule in words.
pub const RULE: &str = "100 where every pixel is the reference's or explained by rounding. Otherwise each unexplained pixel counts by its \
    level difference, a quarter up to 2 levels, a half up to 10, beyond that whole, and the score is the share of pixels that \
    is left, in percent, rounded down. 0 for a picture that is missing or cannot be compared.";

/// What an unexplained pixel that is off by so many levels counts, in quarters.
fn quarters(level: u8) -> u64 {
    match level {
        0..=2 => 1,
        3..=10 => 2,
        _ => 4,
    }
}

/// The score, 0 to [`FULL`], of a picture beside the reference's of the same size, by [`RULE`]; `unexplained` are the pixels, by column
/// and row, that rounding does not explain.
pub fn score(picture: &Picture, expected: &Picture, unexplained: &[[u32; 2]]) -> u8 {
    let lost: u64 = unexplained.iter().map(|&[x, y]| quarters(level(picture.pixel(x, y), expected.pixel(x, y)))).sum();
    let whole = picture.pixel_count() * 4;
    (u64::from(FULL) * (whole - lost) / whole) as u8
}

//! Rows of numbers without names of columns.

use super::columns::{LEVELS, is_missing};
use super::source::split_blanks;
use super::table::{separator, split_cells};
use crate::scene::{Span, parse_number};

/// The fields of a row between `separator`, or between blanks where there is none.
pub(super) fn split(line: &[u8], separator: Option<u8>, spans: &mut Vec<Span>) {
    match separator {
        Some(separator) => split_cells(line, separator, spans),
        None => split_blanks(line, spans),
    }
}

/// The numbers of a line that has as many as a point, and nothing else. What is missing is NaN.
pub(super) fn numbers(line: &[u8]) -> Option<Vec<f64>> {
    let mut spans = Vec::new();
    split(line, separator(line), &mut spans);
    if !matches!(spans.len(), 3 | 4 | 6 | 7) {
        return None;
    }
    let number = |span: &Span| {
        let token = &line[span.start..span.end];
        if is_missing(token) { Some(f64::NAN) } else { parse_number(token).ok() }
    };
    let numbers: Vec<_> = spans.iter().map(number).collect::<Option<_>>()?;
    numbers.iter().any(|number| !number.is_nan()).then_some(numbers)
}

/// What the columns of such a row are called. With a `count` of the points before them, intensities are before the colours.
pub(super) fn names(numbers: &[f64], has_count: bool) -> Vec<String> {
    let are_levels = |levels: &[f64]| levels.iter().all(|level| level.is_nan() || (0.0..=LEVELS).contains(level));
    let rest: &[&str] = match &numbers[3..] {
        [_] => &["intensity"],
        levels if levels.len() == 3 && are_levels(levels) => &["r", "g", "b"],
        [_, levels @ ..] if has_count && are_levels(levels) => &["intensity", "r", "g", "b"],
        [levels @ .., _] if levels.len() == 3 && !has_count && are_levels(levels) => &["r", "g", "b", "intensity"],
        _ => &[],
    };
    let known = ["x", "y", "z"].iter().chain(rest).map(|name| (*name).to_owned());
    let more = (4 + rest.len()..=numbers.len()).map(|number| format!("column_{number}"));
    known.chain(more).collect()
}

//! The colours of particles.

#![allow(clippy::unreadable_literal, reason = "colours are written as `rrggbb`")]

use glam::DVec3;
use serde::Serialize;

use super::columns::LEVELS;
use super::elements::Element;
use super::frame::Frame;
use super::map::Map;
use super::options::{ByColumn, Coloring};

/// What the colours of a column of numbers stand for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColorScale {
    /// The column's name.
    pub column: String,
    /// The colours.
    pub map: Map,
    /// The values at the beginning of the map and at its end; where they are one, it has the colour in the middle.
    pub range: (f64, f64),
}

impl ColorScale {
    /// Of a frame; none where its colours are no column's, or that has no numbers.
    pub(super) fn of(frame: &Frame, coloring: &Coloring, range: (f64, f64)) -> Option<Self> {
        let Coloring::Column(by) = coloring else { return None };
        let map = by.map_of(frame);
        let is_scale =
            map != Map::Categories && frame.words.len() == 0 && frame.values.iter().any(|value| !value.is_nan());
        is_scale.then(|| Self { column: by.name.clone(), map, range })
    }
}

impl ByColumn {
    /// The map that is taken.
    fn map_of(&self, frame: &Frame) -> Map {
        let usual = if frame.words.len() > 0 { Map::Categories } else { Map::Viridis };
        self.map.unwrap_or(usual)
    }
}

/// The colour of particles of which nothing else is known.
const PLAIN: u32 = 0x7fa6cc;
/// The colour of particles whose own is missing.
const MISSING: u32 = 0x808080;

/// A colour as `0xrrggbb`.
pub(super) fn hex_color(rgb: u32) -> DVec3 {
    DVec3::from([16, 8, 0].map(|shift| f64::from(rgb >> shift & 0xff) / LEVELS))
}

/// A colour as `#rrggbb` or `rrggbb`.
pub(super) fn hex_of(token: &[u8]) -> Option<DVec3> {
    let digits = token.strip_prefix(b"#").unwrap_or(token);
    let is_hex = digits.len() == 6 && digits.iter().all(u8::is_ascii_hexdigit);
    let text = str::from_utf8(digits).ok().filter(|_| is_hex)?;
    u32::from_str_radix(text, 16).ok().map(hex_color)
}

/// The least and the greatest value; 0 where all are missing.
pub(super) fn range_of(values: &[f64]) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.iter().fold(ends, |(low, high), &value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// The colour of each particle by its number. `range` is that of the values, where they are not categories.
pub(super) fn colors<'a>(frame: &'a Frame, coloring: &Coloring, range: (f64, f64)) -> Box<dyn Fn(usize) -> DVec3 + 'a> {
    let (plain, missing) = (hex_color(PLAIN), hex_color(MISSING));
    match coloring {
        Coloring::Fixed(color) => {
            let color = *color;
            Box::new(move |_| color)
        }
        Coloring::Column(by) => {
            let map = by.map_of(frame);
            let colors = map.colors();
            Box::new(move |index| match frame.values[index] {
                value if value.is_nan() => missing,
                value if map == Map::Categories => category(&colors, value as usize),
                value => mapped(&colors, value, range),
            })
        }
        Coloring::Auto if !frame.colors.is_empty() => {
            let greatest = frame.colors.iter().fold(0.0, |greatest: f64, color| greatest.max(color.max_element()));
            let levels = frame.levels.unwrap_or(if greatest > 1.0 { LEVELS } else { 1.0 });
            Box::new(move |index| if frame.colors[index].is_nan() { missing } else { frame.colors[index] / levels })
        }
        Coloring::Auto | Coloring::Element if frame.kinds.is_empty() => Box::new(move |_| plain),
        Coloring::Auto | Coloring::Element => {
            let categories = Map::Categories.colors();
            let elements = frame.elements.iter().enumerate();
            let colors: Vec<_> = elements
                .map(|(index, element)| element.map_or_else(|| category(&categories, index), Element::color))
                .collect();
            Box::new(move |index| colors[frame.kinds[index] as usize])
        }
    }
}

/// The colour of a category; later rounds of the palette are darker.
fn category(colors: &[DVec3], index: usize) -> DVec3 {
    const DARKER: f64 = 0.7;
    colors[index % colors.len()] * DARKER.powf((index / colors.len()).min(4) as f64)
}

/// The colour of a value between the ends of a map; beyond them that of the end.
fn mapped(colors: &[DVec3], value: f64, (low, high): (f64, f64)) -> DVec3 {
    color_at(colors, if low == high { 0.5 } else { ((value - low) / (high - low)).clamp(0.0, 1.0) })
}

/// The colour at a part of the way through a map, 0 to 1.
pub(crate) fn color_at(colors: &[DVec3], part: f64) -> DVec3 {
    let at = part * (colors.len() - 1) as f64;
    let below = (at as usize).min(colors.len() - 2);
    colors[below].lerp(colors[below + 1], at - below as f64)
}

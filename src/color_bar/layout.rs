//! Where a bar, its frame, its ticks and its texts are; lengths in pixels.

use super::Side;
use super::text::Font;
use super::ticks::{Tick, ticks};
use crate::import::ColorScale;

/// Numbers beside a bar at the most.
const MOST_TICKS: i64 = 7;
/// A bar is so many lines of text long at least, else the picture is too small.
const LEAST_LINES: i64 = 4;

/// Columns from `left` on and before `right`, likewise rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rect {
    pub(super) left: i64,
    pub(super) right: i64,
    pub(super) top: i64,
    pub(super) bottom: i64,
}

impl Rect {
    fn at(left: i64, top: i64, width: i64, height: i64) -> Self {
        Self { left, right: left + width, top, bottom: top + height }
    }

    pub(super) fn has(self, x: i64, y: i64) -> bool {
        (self.left..self.right).contains(&x) && (self.top..self.bottom).contains(&y)
    }

    fn widened(self, by: i64) -> Self {
        Self { left: self.left - by, right: self.right + by, top: self.top - by, bottom: self.bottom + by }
    }

    fn and(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            right: self.right.max(other.right),
            top: self.top.min(other.top),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// A line of text.
#[derive(Debug, Clone)]
struct Text {
    letters: Vec<char>,
    place: Rect,
}

/// How much of each pixel of some rows is covered, 0 to 255.
pub(super) struct Mask {
    area: Rect,
    cover: Vec<u8>,
}

impl Mask {
    fn new(area: Rect) -> Self {
        let pixels = (area.right - area.left) * (area.bottom - area.top);
        Self { area, cover: vec![0; pixels.max(0) as usize] }
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let Rect { left, right, top, .. } = self.area;
        self.area.has(x, y).then(|| ((y - top) * (right - left) + x - left) as usize)
    }

    /// 0 to 1.
    pub(super) fn at(&self, x: i64, y: i64) -> f64 {
        self.index(x, y).map_or(0.0, |at| f64::from(self.cover[at]) / 255.0)
    }

    /// Covers pixels of `place` as `ink` says, which gets their columns and rows within it.
    fn add(&mut self, place: Rect, ink: impl Fn(i64, i64) -> u8) {
        for y in place.top.max(self.area.top)..place.bottom.min(self.area.bottom) {
            for x in place.left..place.right {
                if let Some(at) = self.index(x, y) {
                    self.cover[at] = self.cover[at].max(ink(x - place.left, y - place.top));
                }
            }
        }
    }
}

/// Where everything is.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Around all that is drawn.
    pub(super) bounds: Rect,
    pub(super) bar: Rect,
    /// Sides of the frame, and ticks.
    lines: Vec<Rect>,
    texts: Vec<Text>,
    font: Font,
    /// How far the paper reaches around ink.
    halo: i64,
}

impl Layout {
    /// Of a picture of this width and height.
    ///
    /// # Errors
    ///
    /// Why there is none.
    pub(super) fn new(scale: &ColorScale, side: Side, size: [i64; 2]) -> Result<Self, String> {
        let [width, height] = size;
        let font = Font::of(width.min(height));
        let (line, letter) = (font.line(), font.width(1));
        let (stroke, halo) = (line / 16, line / 8);
        // From the picture's edges, and how long ticks are and how far numbers are from them.
        let (margin, tick, gap) = (line / 2 + halo, line / 4, line / 4);
        let thick = line * 3 / 4;
        let is_upright = side.is_upright();
        let length = (if is_upright { height } else { width }) * 3 / 5;
        let ticks =
            fitting(scale, length, if is_upright { |_, line| 2 * line } else { |label, _| label }, (line, letter))?;
        let longest = font.width(ticks.iter().map(|tick| tick.label.len()).max().unwrap_or(0));
        // Across the bar: itself, ticks and numbers; above it stands the title.
        let across = thick + tick + gap + if is_upright { longest } else { line };
        let title_height = line + gap;
        let [needed_width, needed_height] = if is_upright {
            [2 * (across + 2 * margin), length]
        } else {
            [length + longest, 2 * (across + title_height + 2 * margin)]
        };
        if length < LEAST_LINES * line || needed_width > width || needed_height > height {
            return Err(format!(
                "a picture of {width} × {height} pixels is too small for a colour bar and its numbers"
            ));
        }
        let letters = title(&scale.column, ((width - 2 * margin) / letter) as usize);
        let title_width = font.width(letters.len());
        let (bar, title_left) = match side {
            Side::Right | Side::Left => {
                let top = (height - length).midpoint(title_height);
                let left = if side == Side::Left { margin } else { width - margin - across };
                // As far as it reaches beyond the bar, towards the middle of the picture.
                let title_left = if side == Side::Left { left } else { left.min(width - margin - title_width) };
                (Rect::at(left, top, thick, length), title_left)
            }
            Side::Top | Side::Bottom => {
                let below = if side == Side::Top { margin + title_height } else { height - margin - across };
                (Rect::at((width - length) / 2, below, length, thick), (width - title_width) / 2)
            }
        };
        let frame = bar.widened(stroke);
        let mut texts = vec![Text { letters, place: Rect::at(title_left, bar.top - title_height, title_width, line) }];
        let mut lines = vec![
            Rect { right: bar.left, ..frame },
            Rect { left: bar.right, ..frame },
            Rect { bottom: bar.top, ..frame },
            Rect { top: bar.bottom, ..frame },
        ];
        for Tick { part, label } in ticks {
            let along = (part * (length - 1) as f64).round() as i64;
            let letters: Vec<_> = label.chars().collect();
            let wide = font.width(letters.len());
            let (mark, place) = if is_upright {
                let (x, y) = (bar.right + tick, bar.bottom - 1 - along);
                (Rect::at(bar.right, y - stroke / 2, tick, stroke), Rect::at(x + gap, y - font.middle(), wide, line))
            } else {
                let (x, y) = (bar.left + along, bar.bottom + tick);
                (Rect::at(x - stroke / 2, bar.bottom, stroke, tick), Rect::at(x - wide / 2, y, wide, line))
            };
            lines.push(mark);
            texts.push(Text { letters, place });
        }
        let drawn = lines.iter().copied().chain(texts.iter().map(|text| text.place)).reduce(Rect::and).unwrap_or(frame);
        let drawn = drawn.widened(halo);
        let bounds = Rect {
            left: drawn.left.max(0),
            right: drawn.right.min(width),
            top: drawn.top.max(0),
            bottom: drawn.bottom.min(height),
        };
        Ok(Self { bounds, bar, lines, texts, font, halo })
    }

    /// The ink of rows from `top` on and before `bottom`, and of those whose paper reaches there.
    pub(super) fn ink(&self, top: i64, bottom: i64) -> Mask {
        let mut mask = Mask::new(Rect { top: top - self.halo, bottom: bottom + self.halo, ..self.bounds });
        for line in &self.lines {
            mask.add(*line, |_, _| 255);
        }
        for Text { letters, place } in &self.texts {
            mask.add(*place, |x, y| self.font.ink(letters, x, y));
        }
        mask
    }

    /// The paper around this ink.
    pub(super) fn spread(&self, ink: &Mask) -> Mask {
        let spread = |mask: &Mask, [across, down]: [i64; 2]| {
            let mut spread = Mask::new(mask.area);
            for k in -self.halo..=self.halo {
                let at = |x: i64, y: i64| mask.index(x + k * across, y + k * down).map_or(0, |at| mask.cover[at]);
                spread.add(mask.area, |x, y| at(x + mask.area.left, y + mask.area.top));
            }
            spread
        };
        spread(&spread(ink, [1, 0]), [0, 1])
    }
}

/// As many ticks as there is room for along a bar of this length; `room` is what a number takes, of its width and its height.
fn fitting(
    scale: &ColorScale,
    length: i64,
    room: fn(i64, i64) -> i64,
    (line, letter): (i64, i64),
) -> Result<Vec<Tick>, String> {
    for most in (2..=MOST_TICKS).rev() {
        let ticks = ticks(scale.range, most as u32)?;
        let longest = ticks.iter().map(|tick| tick.label.len()).max().unwrap_or(0).cast_signed() as i64;
        let needed = room((longest + 2) * letter, line);
        let places: Vec<_> = ticks.iter().map(|tick| (tick.part * length as f64) as i64).collect();
        if places.windows(2).all(|pair| (pair[1] - pair[0]).abs() >= needed) {
            return Ok(ticks);
        }
    }
    ticks(scale.range, 1)
}

/// A column's name, cut where it has more letters than there is room for.
fn title(name: &str, most: usize) -> Vec<char> {
    let letters: Vec<_> = name.chars().collect();
    if letters.len() <= most {
        return letters;
    }
    letters.into_iter().take(most.saturating_sub(2)).chain(['.', '.']).collect()
}

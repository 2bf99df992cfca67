//! A colour bar over a picture: the colours of a column of numbers from one end of their map to the other, with round numbers beside them.
//!
//! It is drawn over rows that are finished, on their way to the file: what renders, verifies and certifies knows nothing of it.

mod layout;
mod text;
mod ticks;

use clap::ValueEnum;
use glam::DVec3;

use self::layout::{Layout, Rect};
use crate::import::{ColorScale, color_at};
use crate::linear::Linear;
use crate::settings::Quantize;

/// Where in the picture a bar stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say all")]
pub enum Side {
    Right,
    Left,
    Top,
    Bottom,
}

impl Side {
    /// Whether the bar is higher than wide.
    fn is_upright(self) -> bool {
        matches!(self, Self::Right | Self::Left)
    }
}

/// The bar of a picture.
#[derive(Debug, Clone)]
pub struct ColorBar {
    layout: Layout,
    is_upright: bool,
    scale: ColorScale,
    colors: Vec<DVec3>,
    /// Of text and lines, and of what surrounds them.
    ink: DVec3,
    paper: DVec3,
    quantize: Quantize,
    width: u32,
}

impl ColorBar {
    /// The bar of `scale` on this side of a picture of such a size before this background, whose colours become levels like this.
    ///
    /// # Errors
    ///
    /// Why there is none: the picture is too small, or no short numbers tell the values apart.
    pub fn new(
        scale: &ColorScale,
        side: Side,
        (width, height): (u32, u32),
        (quantize, background): (Quantize, DVec3),
    ) -> Result<Self, String> {
        let layout = Layout::new(scale, side, [width, height].map(i64::from))?;
        let light = background.clamp(DVec3::ZERO, DVec3::ONE).dot(DVec3::new(0.2126, 0.7152, 0.0722));
        let (ink, paper) = if light > 0.5 { (DVec3::ZERO, DVec3::ONE) } else { (DVec3::ONE, DVec3::ZERO) };
        let colors = scale.map.colors();
        Ok(Self { layout, is_upright: side.is_upright(), scale: scale.clone(), colors, ink, paper, quantize, width })
    }

    /// What it stands for.
    pub fn scale(&self) -> &ColorScale {
        &self.scale
    }

    /// Whether some of so many rows from row `first` on are drawn over.
    pub fn touches(&self, first: u32, rows: u32) -> bool {
        let (first, bounds) = (i64::from(first), self.layout.bounds);
        first < bounds.bottom && bounds.top < first + i64::from(rows)
    }

    /// Draws over whole rows from row `first` on, 3 bytes a pixel, and over the colours of the same pixels, where there are any.
    pub fn draw(&self, first: u32, rgb: &mut [u8], linear: &mut [Linear]) {
        let width = self.width as usize;
        let bounds = self.layout.bounds;
        let first = i64::from(first);
        let (top, bottom) =
            (bounds.top.max(first), bounds.bottom.min(first + (rgb.len() / 3 / width).cast_signed() as i64));
        if top >= bottom {
            return;
        }
        let ink = self.layout.ink(top, bottom);
        let paper = self.layout.spread(&ink);
        let level = |color: DVec3| DVec3::from(self.quantize.levels(color).map(f64::from));
        let pixels = rgb.as_chunks_mut::<3>().0;
        for y in top..bottom {
            for x in bounds.left..bounds.right {
                let [ink, paper] = [&ink, &paper].map(|mask| mask.at(x, y));
                let bar = self.color_at(x, y);
                let over = |below: DVec3, of: &dyn Fn(DVec3) -> DVec3| {
                    let below = bar.map_or_else(|| mix(below, of(self.paper), paper), of);
                    mix(below, of(self.ink), ink)
                };
                let at = (y - first) as usize * width + x as usize;
                let levels = over(DVec3::from(pixels[at].map(f64::from)), &level);
                pixels[at] = levels.to_array().map(|level| level.round() as u8);
                if let Some(linear) = linear.get_mut(at) {
                    linear.color = over(linear.color, &|color| color);
                    linear.coverage = over(DVec3::splat(linear.coverage), &|_| DVec3::ONE).x;
                }
            }
        }
    }

    /// The colour of the bar at this pixel, if it is there. Its first and last pixels have the colours of the ends.
    fn color_at(&self, x: i64, y: i64) -> Option<DVec3> {
        let bar @ Rect { left, right, top, bottom } = self.layout.bar;
        let (at, length) = if self.is_upright { (bottom - 1 - y, bottom - top) } else { (x - left, right - left) };
        bar.has(x, y).then(|| color_at(&self.colors, at as f64 / (length - 1) as f64))
    }
}

/// From one to the other; what is wholly covered does not count, not even where it is no number.
fn mix(below: DVec3, above: DVec3, part: f64) -> DVec3 {
    if part == 0.0 {
        below
    } else if part == 1.0 {
        above
    } else {
        below + (above - below) * part
    }
}

//! Where and how two pictures differ.
//!
//! The *level difference* of two pixels is the greatest absolute difference over their three channels, 0 to 255.

mod explain;
mod flip;
mod heatmap;
mod metrics;
mod page;
mod places;
mod resemblance;

use std::fmt;

use serde::Serialize;

use crate::film::Picture;
use crate::words::count;

pub use explain::{Explanation, UnexplainedPixel, Widths};
pub use flip::PIXELS_PER_DEGREE;
pub use heatmap::{Band, SCALE, heatmap, three_wide};
pub use metrics::{Metrics, SSIM_WINDOW};
pub use page::Comparison;
pub use places::{BySphere, OnSphere, worst_places};
pub use resemblance::{Resemblance, ResemblanceKind};

/// Two pictures that cannot be compared because their sizes differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeMismatch {
    /// Width and height of the first picture.
    pub a: (u32, u32),
    /// Width and height of the second picture.
    pub b: (u32, u32),
}

impl SizeMismatch {
    fn check(a: &Picture, b: &Picture) -> Result<(), Self> {
        Self::of((a.width(), a.height()), (b.width(), b.height()))
    }

    /// Whether two sizes are the same; an error if not.
    ///
    /// # Errors
    /// Sizes that differ.
    pub fn of(a: (u32, u32), b: (u32, u32)) -> Result<(), Self> {
        if a == b { Ok(()) } else { Err(Self { a, b }) }
    }
}

impl fmt::Display for SizeMismatch {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { a, b } = self;
        write!(f, "the pictures differ in size: A is {}x{}, B is {}x{}", a.0, a.1, b.0, b.1)
    }
}

impl std::error::Error for SizeMismatch {}

/// How two pictures of the same size differ.
///
/// Serialised, the field names are a stable interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels in the picture.
    pub pixels: u64,
    /// Pixels that differ, by more than so many levels.
    pub differing: Differing,
    /// The greatest level difference.
    pub max_level: u8,
    /// The greatest difference in red, green and blue.
    pub max_per_channel: [u8; 3],
    /// Mean of the absolute difference over all samples, in levels.
    pub mean: f64,
    /// The pixel with the greatest level difference, the first in reading order; `None` if no pixel differs.
    pub worst: Option<WorstPixel>,
    /// The smallest rectangle with all pixels that differ; `None` if there is none.
    pub bounds: Option<Bounds>,
    /// Changes of one picture that explain most of the difference.
    pub resemblances: Vec<Resemblance>,
}

/// Numbers of pixels whose level difference exceeds a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Differing {
    /// More than 0 levels: all pixels that differ.
    pub over_0: u64,
    /// More than 1 level.
    pub over_1: u64,
    /// More than 2 levels.
    pub over_2: u64,
    /// More than 10 levels.
    pub over_10: u64,
}

impl Differing {
    /// Thresholds and counts.
    pub fn by_threshold(self) -> [(u8, u64); 4] {
        [(0, self.over_0), (1, self.over_1), (2, self.over_2), (10, self.over_10)]
    }

    fn add(&mut self, level: u8) {
        self.over_0 += u64::from(level > 0);
        self.over_1 += u64::from(level > 1);
        self.over_2 += u64::from(level > 2);
        self.over_10 += u64::from(level > 10);
    }
}

/// A pixel and its values in both pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WorstPixel {
    /// Column, 0 being the left one.
    pub x: u32,
    /// Row, 0 being the top one.
    pub y: u32,
    /// Level difference.
    pub level: u8,
    /// Value in the first picture.
    pub a: [u8; 3],
    /// Value in the second picture.
    pub b: [u8; 3],
}

/// A rectangle of pixels, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Bounds {
    /// First column.
    pub x_min: u32,
    /// First row.
    pub y_min: u32,
    /// Last column.
    pub x_max: u32,
    /// Last row.
    pub y_max: u32,
}

impl Bounds {
    fn around(x: u32, y: u32) -> Self {
        Self { x_min: x, y_min: y, x_max: x, y_max: y }
    }

    fn with(self, x: u32, y: u32) -> Self {
        Self { x_min: self.x_min.min(x), y_min: self.y_min.min(y), x_max: self.x_max.max(x), y_max: self.y_max.max(y) }
    }
}

/// A pixel's value as reports have it.
fn value([red, green, blue]: [u8; 3]) -> String {
    format!("({red}, {green}, {blue})")
}

/// The absolute difference in each channel.
fn channel_differences(a: [u8; 3], b: [u8; 3]) -> [u8; 3] {
    std::array::from_fn(|channel| a[channel].abs_diff(b[channel]))
}

/// The level difference of two pixels.
pub fn level(a: [u8; 3], b: [u8; 3]) -> u8 {
    let [red, green, blue] = channel_differences(a, b);
    red.max(green).max(blue)
}

impl Difference {
    /// Compares two pictures pixel by pixel.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn between(a: &Picture, b: &Picture) -> Result<Self, SizeMismatch> {
        SizeMismatch::check(a, b)?;
        let mut found = Self {
            width: a.width(),
            height: a.height(),
            pixels: a.pixel_count(),
            differing: Differing::default(),
            max_level: 0,
            max_per_channel: [0; 3],
            mean: 0.0,
            worst: None,
            bounds: None,
            resemblances: Vec::new(),
        };
        let mut total = 0;
        for (y, (row_a, row_b)) in (0..).zip(a.rows().zip(b.rows())) {
            if row_a != row_b {
                total += found.add_row(y, row_a, row_b);
            }
        }
        found.mean = total as f64 / (found.pixels * 3) as f64;
        found.resemblances = resemblance::find(a, b, &found);
        Ok(found)
    }

    /// Takes a row into account; the sum of its samples' differences is returned.
    fn add_row(&mut self, y: u32, row_a: &[[u8; 3]], row_b: &[[u8; 3]]) -> u64 {
        let mut sum = 0;
        for (x, (&a, &b)) in (0..).zip(row_a.iter().zip(row_b)) {
            if a == b {
                continue;
            }
            let differences = channel_differences(a, b);
            let level = level(a, b);
            sum += differences.iter().map(|&difference| difference as u64).sum::<u64>();
            for (greatest, difference) in self.max_per_channel.iter_mut().zip(differences) {
                *greatest = difference.max(*greatest);
            }
            self.differing.add(level);
            self.bounds = Some(self.bounds.map_or(Bounds::around(x, y), |bounds| bounds.with(x, y)));
            if level > self.max_level {
                self.max_level = level;
                self.worst = Some(WorstPixel { x, y, level, a, b });
            }
        }
        sum
    }

    /// A table for people, several lines, each with a line break.
    ///
    /// The names say which pictures were compared, usually their file names.
    pub fn report(&self, name_a: &str, name_b: &str) -> String {
        let mut lines = vec![
            format!("A                 {name_a}"),
            format!("B                 {name_b}"),
            format!("size              {}x{}, {}", self.width, self.height, count(self.pixels, "pixel")),
        ];
        let digits = self.pixels.to_string().len();
        for (threshold, count) in self.differing.by_threshold() {
            let share = 100.0 * count as f64 / self.pixels as f64;
            let label = format!("differ by > {threshold}");
            lines.push(format!("{label:<17} {count:>digits$}  {share:>8.4} %"));
        }
        if let (Some(worst), Some(bounds)) = (self.worst, self.bounds) {
            lines.extend(self.details(worst, bounds));
        }
        lines.extend(self.resemblances.iter().map(|note| format!("note              {note}")));
        lines.into_iter().flat_map(|line| [line, "\n".into()]).collect()
    }

    fn details(&self, worst: WorstPixel, bounds: Bounds) -> [String; 4] {
        let [red, green, blue] = self.max_per_channel;
        let WorstPixel { x, y, level, a, b } = worst;
        let Bounds { x_min, y_min, x_max, y_max } = bounds;
        [
            format!("worst pixel       x {x}, y {y}: {}, A {}, B {}", count(level, "level"), value(a), value(b)),
            format!("worst by channel  red {red}, green {green}, blue {blue}"),
            format!("mean              {:.6} levels a sample", self.mean),
            format!("where             x {x_min} to {x_max}, y {y_min} to {y_max}"),
        ]
    }
}

/// How much two pictures may differ and still pass; `None` is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Pixels that may differ at all.
    pub over_0: Option<u64>,
    /// Pixels that may differ by more than 1 level.
    pub over_1: Option<u64>,
    /// Pixels that may differ by more than 2 levels.
    pub over_2: Option<u64>,
    /// Pixels that may differ by more than 10 levels.
    pub over_10: Option<u64>,
    /// The greatest level difference that any pixel may have.
    pub max_level: Option<u8>,
    /// The greatest mean absolute difference, in levels a sample.
    pub max_mean: Option<f64>,
}

impl Default for Limits {
    /// Nothing may differ.
    fn default() -> Self {
        Self { over_0: Some(0), ..Self::UNLIMITED }
    }
}

impl Limits {
    /// Everything may differ.
    pub const UNLIMITED: Self =
        Self { over_0: None, over_1: None, over_2: None, over_10: None, max_level: None, max_mean: None };

    /// Each limit that a difference exceeds, in words.
    pub fn exceeded(&self, difference: &Difference) -> Vec<String> {
        let allowed = [self.over_0, self.over_1, self.over_2, self.over_10];
        let mut exceeded: Vec<String> = allowed
            .into_iter()
            .zip(difference.differing.by_threshold())
            .filter_map(|(allowed, (threshold, count))| {
                let allowed = allowed.filter(|&allowed| count > allowed)?;
                Some(format!("pixels that differ by > {threshold}: {count}, limit {allowed}"))
            })
            .collect();
        if let Some(allowed) = self.max_level.filter(|&allowed| difference.max_level > allowed) {
            exceeded.push(format!("greatest level difference: {}, limit {allowed}", difference.max_level));
        }
        // Also a limit that is not a number is exceeded.
        if let Some(allowed) = self.max_mean.filter(|&allowed| allowed.is_nan() || difference.mean > allowed) {
            exceeded.push(format!("mean difference: {:.6}, limit {allowed}", difference.mean));
        }
        exceeded
    }
}

/// What a comparison comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every pixel is the same.
    Same,
    /// Pixels differ, but no limit is exceeded.
    WithinLimits,
    /// A limit is exceeded.
    Different,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Same => "same",
            Self::WithinLimits => "within limits",
            Self::Different => "different",
        })
    }
}

/// Measures a difference against limits.
pub fn verdict(difference: &Difference, limits: &Limits) -> Verdict {
    if !limits.exceeded(difference).is_empty() {
        Verdict::Different
    } else if difference.differing.over_0 > 0 {
        Verdict::WithinLimits
    } else {
        Verdict::Same
    }
}

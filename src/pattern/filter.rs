//! Filters of pixels, by importance sampling: samples are denser where the filter is greater, and all weigh the same (M. Ernst and
//! others, "Filter Importance Sampling", 2006). So each pixel has samples of its own, and a part of a picture is that of the whole. A
//! filter with negative lobes, such as Mitchell's, cannot be had so.

use std::cmp::Ordering;

use clap::ValueEnum;
use serde::Serialize;

/// What weighs a place by its distance from the middle of the pixel, across and down.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// The pixel itself, evenly.
    #[default]
    Box,
    /// Falls linearly to 0 at the middle of the next pixel.
    Tent,
    /// A Gaussian of standard deviation ½ pixel less its value at 1½ pixels, where it ends.
    Gaussian,
}

/// Where the Gaussian ends, in pixels from the middle.
const GAUSSIAN_RADIUS: f64 = 1.5;

impl Filter {
    /// Where each of `count` equal parts of the filter has its middle, from the pixel's edge in so many `steps` of its size; none for the
    /// box, whose parts are equal themselves. Both halves mirror each other, and nothing but basic operations of IEEE 754 is used, so
    /// that every machine has the same numbers.
    pub(super) fn spread(self, count: u32, steps: u32) -> Option<Vec<i64>> {
        let from_middle: fn(f64) -> f64 = match self {
            Self::Box => return None,
            Self::Tent => |below| 1.0 - (2.0 * below).sqrt(),
            Self::Gaussian => gaussian_quantile,
        };
        let half = i64::from(steps / 2);
        let distance = |part: u32| {
            let below = (f64::from(part) + 0.5) / f64::from(count);
            (from_middle(below) * f64::from(steps) + 0.5) as i64
        };
        let place = |part: u32| {
            let mirrored = count - 1 - part;
            match part.cmp(&mirrored) {
                Ordering::Less => half - distance(part),
                Ordering::Equal => half,
                Ordering::Greater => half + distance(mirrored),
            }
        };
        Some((0..count).map(place).collect())
    }
}

/// How far left of the middle, in pixels, this part of the Gaussian ends, by bisection.
fn gaussian_quantile(below: f64) -> f64 {
    let whole = gaussian_up_to(GAUSSIAN_RADIUS);
    let (mut left, mut right) = (0.0, GAUSSIAN_RADIUS);
    // Beyond the steps of any pattern.
    for _ in 0..40 {
        let middle = 0.5 * (left + right);
        if gaussian_up_to(middle) < (1.0 - 2.0 * below) * whole {
            left = middle;
        } else {
            right = middle;
        }
    }
    0.5 * (left + right)
}

/// The filter's integral from the middle to `x`: that of exp(−2t²) by its power series, less the rectangle below.
fn gaussian_up_to(x: f64) -> f64 {
    series(x, |n| 2.0 * n + 1.0) * x - series(GAUSSIAN_RADIUS, |_| 1.0) * x
}

/// The sum of (−2x²)ⁿ/(n! · `divisor`(n)).
fn series(x: f64, divisor: impl Fn(f64) -> f64) -> f64 {
    let (mut term, mut sum) = (1.0, 0.0);
    for n in 0..60 {
        let n = f64::from(n);
        sum += term / divisor(n);
        term *= -2.0 * x * x / (n + 1.0);
    }
    sum
}

//! How far two pictures are apart, in the figures that the literature uses.

use rayon::prelude::*;
use serde::Serialize;

use super::flip::mean_flip;
use super::{SizeMismatch, level};
use crate::film::Picture;

/// The side of SSIM's window, in pixels.
pub const SSIM_WINDOW: usize = 11;
/// The standard deviation of its Gaussian weights, in pixels.
const SSIM_SIGMA: f64 = 1.5;
/// (K₁L)² and (K₂L)² with K₁ = 0.01, K₂ = 0.03 and L = 255 levels.
const SSIM_C: [f64; 2] = [6.5025, 58.5225];

/// Metrics of two pictures of one size.
///
/// Serialised, the field names are a stable interface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metrics {
    /// Root of the mean squared difference of all samples, in levels.
    pub rmse: f64,
    /// Peak signal-to-noise ratio, 20 log₁₀(255 / RMSE), in dB; infinite (`null` in JSON) for pictures that are the same.
    pub psnr: f64,
    /// Mean structural similarity, −1 to 1; `None` for pictures that are narrower or lower than [`SSIM_WINDOW`].
    pub ssim: Option<f64>,
    /// Mean FLIP, 0 to 1: what is seen by somebody who flips between the pictures at 67 pixels a degree.
    pub flip: f64,
    /// The level difference that half of the pixels do not exceed.
    pub level_p50: u8,
    /// Likewise 95 of 100 pixels.
    pub level_p95: u8,
    /// Likewise 99 of 100.
    pub level_p99: u8,
    /// The greatest level difference.
    pub level_max: u8,
}

impl Metrics {
    /// # Errors
    /// Pictures of different sizes.
    pub fn between(a: &Picture, b: &Picture) -> Result<Self, SizeMismatch> {
        SizeMismatch::check(a, b)?;
        let mut histogram = [0_u64; 256];
        let mut squares = 0_u64;
        for (&a, &b) in a.pixels().iter().zip(b.pixels()) {
            histogram[usize::from(level(a, b))] += 1;
            squares += a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum::<u64>();
        }
        let rmse = (squares as f64 / (a.pixel_count() * 3) as f64).sqrt();
        let percentile = |part| percentile(&histogram, part);
        Ok(Self {
            rmse,
            psnr: 20.0 * (255.0 / rmse).log10(),
            ssim: ssim(a, b),
            flip: mean_flip(a, b),
            level_p50: percentile(50),
            level_p95: percentile(95),
            level_p99: percentile(99),
            level_max: percentile(100),
        })
    }
}

/// The least level that `part` of 100 pixels do not exceed (nearest rank).
fn percentile(histogram: &[u64; 256], part: u64) -> u8 {
    let rank = (histogram.iter().sum::<u64>() * part).div_ceil(100);
    let mut seen = 0;
    let reaches = |&count: &u64| {
        seen += count;
        seen >= rank
    };
    histogram.iter().position(reaches).map_or(u8::MAX, |level| level as u8)
}

/// The mean structural similarity of two pictures of one size: Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, Image
/// Quality Assessment: From Error Visibility to Structural Similarity, IEEE Transactions on Image Processing 13 (2004), equation
/// 13, with the constants and the Gaussian window given there, over all windows that lie within the picture, of Rec. 601's luma.
///
/// `None` where no window fits.
fn ssim(a: &Picture, b: &Picture) -> Option<f64> {
    let (width, height) = (a.width() as usize, a.height() as usize);
    if width < SSIM_WINDOW || height < SSIM_WINDOW {
        return None;
    }
    let weights = gaussian();
    let [a, b] = [a, b].map(|picture| picture.pixels().iter().map(|&pixel| luma(pixel)).collect::<Vec<_>>());
    // Each row of windows from its own rows of pixels: five sums down the columns, then along the row.
    let rows = (0..=height - SSIM_WINDOW).into_par_iter().map(|top| {
        let mut columns = vec![[0.0; 5]; width];
        for (row, weight) in weights.iter().enumerate() {
            let from = (top + row) * width;
            for ((sums, &a), &b) in columns.iter_mut().zip(&a[from..from + width]).zip(&b[from..from + width]) {
                for (sum, value) in sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                    *sum += weight * value;
                }
            }
        }
        columns.windows(SSIM_WINDOW).map(|window| similarity(window, &weights)).sum::<f64>()
    });
    // Summed in the order of rows, so that the last digit does not depend on threads.
    let sum: f64 = rows.collect::<Vec<_>>().iter().sum();
    Some(sum / ((width + 1 - SSIM_WINDOW) * (height + 1 - SSIM_WINDOW)) as f64)
}

/// The similarity in one window, from the sums of its columns.
fn similarity(columns: &[[f64; 5]], weights: &[f64; SSIM_WINDOW]) -> f64 {
    let mut means = [0.0; 5];
    for (column, weight) in columns.iter().zip(weights) {
        means.iter_mut().zip(column).for_each(|(mean, sum)| *mean += weight * sum);
    }
    let [a, b, aa, bb, ab] = means;
    let [c1, c2] = SSIM_C;
    let (variances, covariance) = (aa - a * a + bb - b * b, ab - a * b);
    (2.0 * a * b + c1) * (2.0 * covariance + c2) / ((a * a + b * b + c1) * (variances + c2))
}

/// Weights along one side of the window; their sum is 1.
fn gaussian() -> [f64; SSIM_WINDOW] {
    let middle = (SSIM_WINDOW / 2) as f64;
    let weights: [f64; SSIM_WINDOW] =
        std::array::from_fn(|at| (-0.5 * ((at as f64 - middle) / SSIM_SIGMA).powi(2)).exp());
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// Rec. 601's luma, 0 to 255.
fn luma([red, green, blue]: [u8; 3]) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

//! How far a picture is from another one, in levels and in linear colour.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use crate::cpu::{Real, Reference};

/// The distance of one picture from another of the same size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distance {
    /// Pixels that differ.
    pub differing: u64,
    /// Greatest difference of any sample of a channel, in levels.
    pub max_level: u8,
    /// Mean absolute difference of all channel samples, in levels.
    pub mean_level: f64,
    /// Root of the mean squared difference of all channel samples, in levels.
    pub rms_level: f64,
    /// Root of the mean squared difference of the unclamped linear colours, in units of full intensity; `None` where the
    /// picture is known in levels only.
    pub rms_linear: Option<f64>,
}

impl Distance {
    /// Between two pictures of 3 bytes a pixel.
    pub fn between(a: &[u8], b: &[u8]) -> Self {
        let (mut differing, mut max_level, mut sum, mut squares) = (0, 0, 0_u64, 0_u64);
        for (a, b) in a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0) {
            if a == b {
                continue;
            }
            differing += 1;
            for (a, b) in a.iter().zip(b) {
                let level = a.abs_diff(*b);
                max_level = level.max(max_level);
                sum += u64::from(level);
                squares += u64::from(level) * u64::from(level);
            }
        }
        let samples = a.len().max(1) as f64;
        Self {
            differing,
            max_level,
            mean_level: sum as f64 / samples,
            rms_level: (squares as f64 / samples).sqrt(),
            rms_linear: None,
        }
    }

    /// With the linear colours of both.
    pub(super) fn with_linear(self, a: &[DVec3], b: &[DVec3]) -> Self {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
        Self { rms_linear: Some((squares / (3 * a.len().max(1)) as f64).sqrt()), ..self }
    }
}

/// The unclamped linear colours of all pixels in reading order.
pub(super) fn linear_colors<T: Real>(reference: &Reference<T>, (width, height): (u32, u32)) -> Vec<DVec3> {
    let row = |j| (0..width).filter_map(move |i| reference.color(i, j));
    (0..height).into_par_iter().flat_map_iter(row).collect()
}

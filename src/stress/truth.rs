//! The same-ray truth: the answer to the very numbers that the device got.
//!
//! Tiers that carry low parts get every number of a batch exactly, since [`carried`] leaves it 48 bits; `fast` gets them
//! rounded to `f32`, and its truth is that of the rounded numbers, so that it answers for its arithmetic alone.

use glam::DVec3;
use rayon::prelude::*;

use super::metrics::{Metrics, U};
use crate::camera::NEAR_T_MIN;
use crate::cpu::oracle;
use crate::geometry::Ellipsoid;
use crate::gpu::{Answer, Batch, ProbeRay, Surface};

/// The nearest number that two `f32` carry exactly.
pub fn carried(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(|x| {
        let high = f64::from(x as f32);
        high + f64::from((x - high) as f32)
    }))
}

/// What `f32` leaves of a vector.
fn single(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// The numbers that the kernel got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Given {
    /// Rounded to `f32`.
    Rounded,
    /// As they are.
    Whole,
}

impl Given {
    pub(super) fn ray(self, ray: &ProbeRay) -> ProbeRay {
        match self {
            Self::Whole => *ray,
            Self::Rounded => ProbeRay { origin: single(ray.origin), direction: single(ray.direction), ..*ray },
        }
    }

    pub(super) fn surface(self, surface: &Surface) -> Surface {
        if self == Self::Whole {
            return *surface;
        }
        let Ellipsoid { center, inv_scale, radius, .. } = Ellipsoid::with_axes(surface.center, surface.scale);
        Surface { center: single(center), scale: f64::from(radius as f32) / single(inv_scale) }
    }

    fn t_min(self, ray: &ProbeRay) -> f64 {
        match (ray.primary, self) {
            (false, _) => 0.0,
            (true, Self::Whole) => NEAR_T_MIN,
            (true, Self::Rounded) => f64::from(NEAR_T_MIN as f32),
        }
    }
}

/// The true nearest hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// Its t; NaN where there is none.
    pub(super) t: f64,
    /// The surface, by its place in the batch.
    pub(super) surface: u32,
    /// Whether it is the greater root.
    pub(super) inside: bool,
}

/// The true nearest hit of every ray.
pub(super) fn expected(batch: &Batch, given: Given) -> Vec<Expected> {
    let nearest = |ray: &ProbeRay| {
        let ray = given.ray(ray);
        let t_min = given.t_min(&ray);
        let mut best = Expected { t: f64::NAN, surface: 0, inside: false };
        let mut best_low = 0.0;
        for index in (ray.first..ray.end).filter(|&index| ray.own != Some(index)) {
            let Surface { center, scale } = given.surface(&batch.surfaces[index as usize]);
            let Some(roots) = oracle::truth(ray.origin, ray.direction, center, scale).roots else { continue };
            let Some(inside) = roots.iter().position(|root| root.hi() > t_min) else { continue };
            let (t, low) = (roots[inside].hi(), roots[inside].lo());
            if !((t, low) >= (best.t, best_low)) {
                best = Expected { t, surface: index, inside: inside == 1 };
                best_low = low;
            }
        }
        best
    };
    batch.rays.par_iter().map(nearest).collect()
}

/// 1 − l² of a ray and a surface.
fn clearance(batch: &Batch, ray: &ProbeRay, surface: u32, given: Given) -> f64 {
    let (ray, surface) = (given.ray(ray), given.surface(&batch.surfaces[surface as usize]));
    oracle::truth(ray.origin, ray.direction, surface.center, surface.scale).clearance.hi()
}

/// Compares answers with the truth; `band` is the |1 − l²| below which a tier may be wrong.
pub(super) fn judge(batch: &Batch, answers: &[Answer], truth: &[Expected], given: Given, band: f64) -> Metrics {
    let mut metrics = Metrics { count: batch.rays.len() as u64, ..Metrics::default() };
    let mut errors = Vec::with_capacity(answers.len());
    for ((ray, answer), expected) in batch.rays.iter().zip(answers).zip(truth) {
        let hits = !expected.t.is_nan();
        if answer.found && !answer.value.is_finite() {
            metrics.not_finite += 1;
        }
        let disputed = match (answer.found, hits) {
            (false, false) => continue,
            (true, false) => {
                metrics.false_hits += 1;
                vec![answer.surface]
            }
            (false, true) => {
                metrics.false_misses += 1;
                vec![expected.surface]
            }
            (true, true) if answer.surface != expected.surface || answer.inside != expected.inside => {
                metrics.inversions += u64::from(answer.surface != expected.surface);
                metrics.wrong_roots += 1;
                vec![answer.surface, expected.surface]
            }
            (true, true) => {
                errors.push(((answer.value - expected.t).abs() / expected.t / U) as f32);
                continue;
            }
        };
        let beyond = disputed.iter().map(|&surface| clearance(batch, ray, surface, given).abs());
        let least = beyond.fold(f64::INFINITY, f64::min);
        metrics.misclassified = metrics.misclassified.max(least);
        metrics.wrong_beyond_band += u64::from(!(least < band));
    }
    metrics.set_errors(errors);
    metrics
}

/// The true cosine between the normal and the light where each ray meets its first surface, seen from outside; NaN where it
/// does not.
pub(super) fn cosines(batch: &Batch, given: Given) -> Vec<f64> {
    let cosine = |(ray, light): (&ProbeRay, &DVec3)| {
        let (ray, surface) = (given.ray(ray), given.surface(&batch.surfaces[ray.first as usize]));
        let light = if given == Given::Rounded { single(*light) } else { *light };
        let roots = oracle::truth(ray.origin, ray.direction, surface.center, surface.scale).roots;
        let t = roots.map_or(f64::NAN, |roots| roots[0].hi());
        let place = ray.origin + ray.direction * t;
        let normal = ((place - surface.center) / (surface.scale * surface.scale)).normalize();
        normal.dot((light - place).normalize())
    };
    batch.rays.par_iter().zip(&batch.lights).map(cosine).collect()
}

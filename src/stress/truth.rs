//! The same-ray truth: the answer to the very numbers that the device got.
//!
//! Tiers that carry low parts get every number of a batch exactly, since [`carried`] leaves it 48 bits; `fast` gets them
//! rounded to `f32`, and its truth is that of the rounded numbers, so that it answers for its arithmetic alone.

use glam::DVec3;
use rayon::prelude::*;

use super::metrics::{Metrics, U};
use super::path::{End, Own, Ray, Turn, follow, mirrored};
use crate::camera::NEAR_T_MIN;
use crate::cpu::oracle::truth_of;
use crate::cpu::{Dd, Real, Vec3};
use crate::geometry::Ellipsoid;
use crate::gpu::{Answer, Batch, Point, ProbeRay, Surface};
use crate::settings::Specular;

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
    fn vector(self, v: DVec3) -> DVec3 {
        if self == Self::Whole { v } else { single(v) }
    }

    fn ray(self, ray: &ProbeRay) -> Ray {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_f64(self.vector(v)));
        Ray { origin, direction }
    }

    fn surface(self, surface: &Surface) -> Surface {
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

/// The true end of the path of every ray.
pub(super) fn expected(batch: &Batch, given: Given, turn: Option<Turn>) -> Vec<End> {
    let end = |ray: &ProbeRay| {
        let surfaces = surfaces(batch, given, ray);
        let own = ray.own.map(|own| Own { surface: (own - ray.first) as usize, inside: false });
        follow(given.ray(ray), &surfaces, own, given.t_min(ray), turn.map(|turn| (turn, batch.bounces)))
    };
    batch.rays.par_iter().map(end).collect()
}

/// The surfaces that a ray can meet.
fn surfaces(batch: &Batch, given: Given, ray: &ProbeRay) -> Vec<Surface> {
    batch.surfaces[ray.first as usize..ray.end as usize].iter().map(|surface| given.surface(surface)).collect()
}

fn length(v: Vec3<Dd>) -> f64 {
    v.dot(v).sqrt().hi()
}

/// The errors of one answer in units of 2⁻²³: the relative one of t, that of the place in greatest semi-axes, and those of the
/// normal and of the mirrored direction, which have unit length. Where a path turns, its origin is off, and t in relation to itself
/// and the greatest semi-axis.
fn errors(answer: &Answer, end: &End, greatest: f64, turns: bool) -> Option<[f64; 4]> {
    let met = end.met?;
    let reach = if turns { greatest / length(end.ray.direction) } else { 0.0 };
    let t = ((Dd::from(answer.value) - met.t) / (met.t + Dd::from(reach))).abs().hi();
    let off = |known: DVec3, truth: Vec3<Dd>| length(Vec3::from_f64(known) - truth);
    let errors = answer.point.map_or([t, 0.0, 0.0, 0.0], |Point { place, place_low, normal, mirrored: direction }| {
        let place = length(Vec3::from_f64(place) + Vec3::from_f64(place_low) - met.place) / greatest;
        [t, place, off(normal, met.normal), off(direction, mirrored(end.ray.direction.normalize(), met.normal))]
    });
    Some(errors.map(|error| error / U))
}

/// The greater of two errors, of which a NaN is the greatest.
pub(super) fn worse(a: f64, b: f64) -> f64 {
    if a.total_cmp(&b).is_gt() { a } else { b }
}

/// Compares answers with the truth of paths that turn or do not; `band` is how near a path may come to another one where a tier may
/// be wrong.
pub(super) fn judge(batch: &Batch, answers: &[Answer], truth: &[End], turns: bool, given: Given, band: f64) -> Metrics {
    let mut metrics = Metrics { count: batch.rays.len() as u64, ..Metrics::default() };
    let mut relative = Vec::with_capacity(answers.len());
    let mut greatest: Option<[f64; 4]> = None;
    for ((ray, answer), end) in batch.rays.iter().zip(answers).zip(truth) {
        metrics.not_finite += u64::from(answer.found && !answer.value.is_finite());
        let met = end.met.map(|met| (ray.first + met.surface as u32, met.inside));
        match (answer.found.then_some((answer.surface, answer.inside)), met) {
            (None, None) => continue,
            (Some(_), None) => metrics.false_hits += 1,
            (None, Some(_)) => metrics.false_misses += 1,
            (Some(found), Some(met)) if found == met => {
                let scale = given.surface(&batch.surfaces[met.0 as usize]).scale;
                let Some(errors) = errors(answer, end, scale.abs().max_element(), turns) else { continue };
                relative.push(errors[0] as f32);
                let worst = greatest.get_or_insert([0.0; 4]);
                let steadiness = end.met.map_or(1.0, |met| met.steadiness);
                let weights = [1.0, 1.0, steadiness, steadiness].map(|weight| weight * end.cosine);
                *worst = std::array::from_fn(|i| worse(worst[i], (errors[i] * weights[i]).abs()));
                continue;
            }
            (Some(found), Some(met)) => {
                metrics.inversions += u64::from(found.0 != met.0);
                metrics.wrong_roots += 1;
            }
        }
        metrics.misclassified = worse(metrics.misclassified, end.margin);
        metrics.wrong_beyond_band += u64::from(!(end.margin < band));
    }
    metrics.set_errors(relative);
    if let Some([t, place, normal, mirrored]) = greatest {
        metrics.worst_t = Some(t);
        if answers.iter().any(|answer| answer.point.is_some()) {
            (metrics.worst_place, metrics.worst_normal, metrics.worst_mirrored) =
                (Some(place), Some(normal), Some(mirrored));
        }
    }
    metrics
}

/// What a light does at the point that a ray sees, in truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lighting {
    /// N·L.
    pub(super) cosine: f64,
    /// cosⁿ of the highlight.
    pub(super) highlight: f64,
    /// The cosine between ray and normal times the steadiness of the normal, by which errors are weighted.
    pub(super) seen: f64,
}

/// The lighting of each ray's first surface, seen from outside; NaN where it does not meet it.
pub(super) fn lighting(batch: &Batch, given: Given, model: Specular) -> Vec<Lighting> {
    let lighting = |(ray, &light): (&ProbeRay, &DVec3)| {
        let first = given.surface(&batch.surfaces[ray.first as usize]);
        let end = follow(given.ray(ray), &[first], None, 0.0, None);
        let Some(met) = end.met else { return Lighting { cosine: f64::NAN, highlight: f64::NAN, seen: 0.0 } };
        let to_light = (Vec3::from_f64(given.vector(light)) - met.place).normalize();
        let cosine = met.normal.dot(to_light);
        let view = -end.ray.direction.normalize();
        let closeness = match model {
            Specular::Phong => -view.dot(mirrored(to_light, met.normal)),
            Specular::Blinn => met.normal.dot((to_light + view).normalize()),
        };
        let power = || (Dd::from(batch.exponent) * (closeness - Dd::ONE).log1p()).exp().hi();
        let highlight = if closeness > Dd::ZERO { power() } else { 0.0 };
        Lighting { cosine: cosine.hi(), highlight, seen: end.cosine * met.steadiness }
    };
    batch.rays.par_iter().zip(&batch.lights).map(lighting).collect()
}

/// Whether something stands between the origin of each ray and t = 1, and how near it is to being otherwise: the least |1 − l²|
/// or distance of a root from either end that decides.
pub(super) fn blocked(batch: &Batch, given: Given) -> Vec<(bool, f64)> {
    let blocked = |ray: &ProbeRay| {
        let (line, own) = (given.ray(ray), ray.own.map(|own| own - ray.first));
        let (mut is_blocked, mut safest_blocker, mut nearest_other) = (false, 0.0_f64, f64::INFINITY);
        for (index, surface) in (0..).zip(surfaces(batch, given, ray)) {
            if own == Some(index) {
                continue;
            }
            let truth = truth_of(line.origin, line.direction, surface.center, surface.scale);
            let mut margin = truth.clearance.hi().abs();
            let roots = truth.roots.unwrap_or([Dd::from(-1.0); 2]);
            if truth.roots.is_some() {
                let ends = roots.map(|root| root.abs().hi().min((root - Dd::ONE).abs().hi()));
                margin = margin.min(ends[0]).min(ends[1]);
            }
            if roots.iter().any(|&root| root > Dd::ZERO && root < Dd::ONE) {
                is_blocked = true;
                safest_blocker = safest_blocker.max(margin);
            } else {
                nearest_other = nearest_other.min(margin);
            }
        }
        (is_blocked, if is_blocked { safest_blocker } else { nearest_other })
    };
    batch.rays.par_iter().map(blocked).collect()
}

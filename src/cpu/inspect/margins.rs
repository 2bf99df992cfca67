//! How far the decisions of the tracer are from being taken otherwise, among all spheres and not only those in its lists.

use std::collections::HashSet;

use super::record::Margin;
use crate::cpu::Decision;
use crate::cpu::intersect::{Hit, Own, Range, Ray, approach, exit_of, least_of, roots};
use crate::cpu::scene::{Shape, World};
use crate::cpu::vec3::{largest, length};

/// The spheres of a world but for those that equal an earlier one, which wins on every device.
#[derive(Debug, Clone)]
pub(super) struct Distinct(Vec<usize>);

impl Distinct {
    pub(super) fn of(world: &World<f64>) -> Self {
        let mut seen = HashSet::new();
        Self((0..world.shapes.all().len()).filter(|&sphere| seen.insert(world.shapes[sphere].bits())).collect())
    }
}

/// The least margin of each kind of decision.
#[derive(Debug, Clone, Default)]
pub(super) struct Least(Vec<Margin>);

impl Least {
    /// Takes a margin into account; NaN is none.
    pub(super) fn add(&mut self, margin: Margin) {
        if margin.margin.is_nan() {
            return;
        }
        match self.0.iter_mut().find(|known| known.decision == margin.decision) {
            Some(known) if margin.margin < known.margin => *known = margin,
            Some(_) => {}
            None => self.0.push(margin),
        }
    }

    /// Nearest first.
    pub(super) fn sorted(mut self) -> Vec<Margin> {
        self.0.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        self.0
    }
}

/// A ray whose search for the nearest hit has ended.
pub(super) struct Search<'a> {
    pub(super) world: &'a World<f64>,
    pub(super) ray: &'a Ray<f64>,
    pub(super) own: Option<&'a Own<f64>>,
    pub(super) range: &'a Range<f64>,
    pub(super) hit: Option<&'a Hit<f64>>,
    /// Of a primary ray: what its t is multiplied by for the image plane to be at 1.
    pub(super) stretch: Option<f64>,
}

impl Search<'_> {
    /// Hands each decision of the search to `add`, with its margin and the sphere.
    pub(super) fn each(&self, distinct: &Distinct, mut add: impl FnMut(Decision, f64, usize)) {
        distinct.0.iter().for_each(|&sphere| self.of_sphere(sphere, &mut add));
    }

    fn of_sphere(&self, sphere: usize, add: &mut impl FnMut(Decision, f64, usize)) {
        let Self { world, ray, range, hit, .. } = self;
        let shape = &world.shapes[sphere];
        let is_hit = hit.is_some_and(|hit| world.shapes[hit.sphere].bits() == shape.bits());
        let tie = |t: f64| hit.map(|hit| (t - hit.t) / t.abs());
        if let Some(own) = self.own.filter(|own| own.shape == shape.index) {
            if own.inside {
                let t = exit_of(own, ray.direction, shape);
                add(Decision::Epsilon, self.distance_from_start(t, sphere), sphere);
                if let Some(margin) = tie(t).filter(|_| t > range.t_min && !is_hit) {
                    add(Decision::Tie, margin, sphere);
                }
            }
            return;
        }
        let at_min = if self.stretch.is_some() { Decision::NearPlane } else { Decision::Epsilon };
        let at = approach(ray, shape);
        let clearance = at.discriminant.abs() / (shape.radius * shape.radius);
        let Some(both) = roots(&at, shape.radius) else {
            let closest = at.b / at.a;
            let is_before = hit.is_none_or(|hit| closest < hit.t);
            if is_hit || (closest > range.t_min && is_before) {
                add(Decision::Silhouette, clearance, sphere);
            }
            return;
        };
        let starts = match least_of(both, range) {
            _ if is_hit => {
                add(Decision::Silhouette, clearance, sphere);
                [Some(both.0), hit.filter(|hit| hit.inside).map(|_| both.1)]
            }
            Some((t, is_greater)) => {
                if let Some(margin) = tie(t) {
                    add(Decision::Tie, margin, sphere);
                }
                [is_greater.then_some(both.0), None]
            }
            None => [Some(both.1), None],
        };
        // Where no sphere reaches the image plane, nothing is decided there.
        for t in starts.into_iter().flatten().filter(|_| range.greater) {
            add(at_min, self.distance_from_start(t, sphere), sphere);
        }
    }

    /// How far a root lies from where roots begin to count.
    fn distance_from_start(&self, t: f64, sphere: usize) -> f64 {
        let distance = (t - self.range.t_min).abs();
        match self.stretch {
            Some(stretch) => distance * stretch,
            None => distance * length(self.ray.direction) / size(self.world, sphere),
        }
    }
}

/// Greatest semi-axis.
fn size(world: &World<f64>, sphere: usize) -> f64 {
    largest(world.materials[sphere].scale) * world.shapes[sphere].radius
}

/// How far a shadow ray is from being blocked or not, and by which sphere: of those that block it the one that does so most
/// clearly, of the others the one that comes nearest to it.
pub(super) fn shadow_margin(
    world: &World<f64>,
    distinct: &Distinct,
    ray: &Ray<f64>,
    own: &Own<f64>,
    is_blocked: bool,
) -> Option<(f64, usize)> {
    let (mut clearest, mut nearest) = (None::<(f64, usize)>, None::<(f64, usize)>);
    for &sphere in &distinct.0 {
        let Some((blocks, margin)) = crossing(ray, &world.shapes[sphere], own, world.shadow_t_min) else { continue };
        if blocks && clearest.is_none_or(|(known, _)| margin > known) {
            clearest = Some((margin, sphere));
        } else if !blocks && nearest.is_none_or(|(known, _)| margin < known) {
            nearest = Some((margin, sphere));
        }
    }
    if is_blocked { clearest.or(nearest) } else { nearest }
}

/// Whether a sphere stands between t = `t_min` and 1, and how far it is from the other answer; `None` where it never can be.
fn crossing(ray: &Ray<f64>, shape: &Shape<f64>, own: &Own<f64>, t_min: f64) -> Option<(bool, f64)> {
    let from_ends = |t: f64| (t - t_min).min(1.0 - t);
    if own.shape == shape.index {
        let margin = from_ends(exit_of(own, ray.direction, shape));
        return own.inside.then_some((margin > 0.0, margin.abs()));
    }
    let at = approach(ray, shape);
    let clearance = at.discriminant.abs() / (shape.radius * shape.radius);
    let Some((lesser, greater)) = roots(&at, shape.radius) else {
        return Some((false, clearance.max(-from_ends(at.b / at.a))));
    };
    let (first, last) = (from_ends(lesser), from_ends(greater));
    Some(match (first > 0.0, last > 0.0) {
        // Both go where the line no longer meets the sphere.
        (true, true) => (true, clearance.min(first.max(last))),
        (false, false) => (false, first.abs().min(last.abs())),
        _ => (true, first.max(last)),
    })
}

//! Decisions that even the last word leaves open are taken for ties, by the tracer's own rules: a tangent is a hit, of equal distances the
//! lower index counts, a root on the end of its range does not count, and a blocker ends before the light.

use std::cmp::Ordering;

use super::bound::Bound;
use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray, root_in};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface, min};
use super::vec3::length;
use super::witness::Witness;
use crate::roundings::NEAR;

/// Traces with a bound, and takes for a tie what that leaves open within [`Real::TIE`] of one.
#[derive(Debug)]
pub(super) struct Ties<T> {
    pub(super) bound: Bound<T, true>,
    /// What the ray in hand hits by these rules.
    hits: Vec<Hit<T>>,
    is_blocked: bool,
}

impl<T: Real> Ties<T> {
    /// Of a primary ray in `world`.
    pub(super) fn new(world: &World<T>, ray: &Ray<T>) -> Self {
        // A quotient of counts and a sum before it.
        let error = T::from_f64(4.0 * T::UNIT);
        let mut bound = Bound::new(world);
        bound.begin([error * length(ray.origin), error]);
        Self { bound, hits: Vec::new(), is_blocked: false }
    }

    /// Whether a line touches a sphere, for all that is known.
    fn is_edge(&self, shape: &Shape<T>, at: &Approach<T>) -> bool {
        let is_near = at.discriminant.abs() < T::from_f64(T::TIE) * shape.radius * shape.radius;
        is_near && self.bound.is_edge(shape, at, self.bound.reach(shape, at))
    }

    /// How near to its surface a place has to lie to be on it, for all that is known.
    fn near(&self, shape: &Shape<T>) -> T {
        let width = self.bound.width(shape, T::ZERO);
        min(T::from_f64(NEAR) * width * (shape.radius + width), T::from_f64(T::TIE))
    }

    /// The least root that counts.
    fn root(&self, shape: &Shape<T>, at: &Approach<T>, range: &Range<T>, sign: Option<Ordering>) -> Option<(T, bool)> {
        let is_edge = sign.is_none() && self.is_edge(shape, at);
        let at = at.decided(if is_edge { Some(Ordering::Equal) } else { sign });
        let t_min = range.t_min;
        let start = at.origin.dot(at.origin) - shape.radius * shape.radius - t_min * (at.b + at.b - t_min * at.a);
        if start.abs() > self.near(shape) {
            return root_in(range, &at, shape.radius);
        }
        // The ray begins on the surface: the other root is left.
        let closest = at.b / at.a;
        let t = closest + closest - t_min;
        (range.greater && t > t_min && t < range.t_max).then_some((t, true))
    }

    /// Whether a sphere stands between a point and a light.
    fn stands(&self, shape: &Shape<T>, crossing: &Crossing<T>, t_min: T) -> bool {
        let Crossing { at, start_squared, end_squared } = crossing;
        let is_edge = self.is_edge(shape, at);
        if !is_edge && at.discriminant < T::ZERO {
            return false;
        }
        let side = |squared: &T| {
            let beyond = *squared - shape.radius * shape.radius;
            if beyond.abs() <= self.near(shape) { Some(Ordering::Equal) } else { beyond.partial_cmp(&T::ZERO) }
        };
        let passes = at.b > at.a * t_min && at.b < at.a;
        match (side(start_squared), side(end_squared)) {
            (Some(Ordering::Greater), Some(Ordering::Less)) | (Some(Ordering::Less), Some(Ordering::Greater)) => true,
            (Some(Ordering::Greater), Some(_)) => passes,
            (Some(Ordering::Equal), Some(Ordering::Greater)) => at.b > at.a * t_min,
            _ => false,
        }
    }
}

impl<T: Real> Witness<T> for Ties<T> {
    fn search(&mut self, ray: &Ray<T>, light: bool) {
        self.bound.search(ray, light);
        self.hits.clear();
        self.is_blocked = false;
    }

    fn tested(
        &mut self,
        ray: &Ray<T>,
        shape: &Shape<T>,
        at: &Approach<T>,
        range: &Range<T>,
        sign: Option<Ordering>,
        root: Option<(T, bool)>,
    ) {
        self.bound.tested(ray, shape, at, range, sign, root);
        let hit = self.root(shape, at, range, sign);
        self.hits.extend(hit.map(|(t, inside)| Hit { t, sphere: shape.index as usize, inside }));
    }

    fn tested_own(&mut self, ray: &Ray<T>, own: &Own<T>, shape: &Shape<T>, t: T, range: &Range<T>) {
        self.bound.tested_own(ray, own, shape, t, range);
        let error = min(self.bound.exit_error(ray, shape), T::from_f64(T::TIE) * t.abs());
        let is_after = |a: T, b: T| a - b > error;
        if own.inside && is_after(t, range.t_min) && (range.t_max > T::ONE || is_after(range.t_max, t)) {
            self.hits.push(Hit { t, sphere: shape.index as usize, inside: true });
            self.is_blocked = true;
        }
    }

    fn crossed(&mut self, ray: &Ray<T>, shape: &Shape<T>, crossing: &Crossing<T>, blocks: bool, t_min: T) -> bool {
        self.is_blocked |= self.stands(shape, crossing, t_min);
        self.bound.crossed(ray, shape, crossing, blocks, t_min)
    }

    fn nearest(
        &mut self,
        world: &World<T>,
        ray: &Ray<T>,
        own: Option<&Own<T>>,
        range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        self.bound.nearest(world, ray, own, range, hit);
        let least = self.hits.iter().map(|hit| hit.t).reduce(|a, b| if b < a { b } else { a })?;
        let tied = least + min(self.bound.tie(least), T::from_f64(T::TIE) * least.abs());
        self.hits.iter().filter(|hit| hit.t <= tied).min_by_key(|hit| hit.sphere).copied()
    }

    fn background(&mut self, world: &World<T>) {
        self.bound.background(world);
    }

    fn surface(&mut self, world: &World<T>, ray: &Ray<T>, hit: &Hit<T>, at: &Approach<T>, surface: &Surface<T>) {
        self.bound.surface(world, ray, hit, at, surface);
    }

    fn lit(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, n_dot_l: T, is_lit: bool) -> bool {
        self.bound.lit(world, surface, light, n_dot_l, is_lit)
    }

    fn blocked(&mut self, world: &World<T>, ray: &Ray<T>, own: &Own<T>, is_blocked: bool) -> bool {
        self.bound.blocked(world, ray, own, is_blocked);
        self.is_blocked
    }

    fn shaded(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, terms: &LightTerms<T>) {
        self.bound.shaded(world, surface, light, terms);
    }

    fn reflected(&mut self, throughput: T) {
        self.bound.reflected(throughput);
    }

    fn refracted(&mut self, world: &World<T>, surface: &Surface<T>, snell: Snell<T>, throughput: T) -> Snell<T> {
        self.bound.refracted(world, surface, snell, throughput)
    }

    fn resumed(&mut self) {
        self.bound.resumed();
    }
}

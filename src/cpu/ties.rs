//! Decisions that 237 bits leave open are taken for ties, by the tracer's own rules: a tangent is a hit, of equal distances the
//! lower index counts, a root on the end of its range does not count, and a blocker ends before the light.

use std::cmp::Ordering;

use super::bound::Bound;
use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray, root_in};
use super::octuple::Octuple;
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface, min};
use super::witness::Witness;
use crate::roundings::{NEAR, TIE};

/// Traces with 237 bits and their bound, and takes for a tie what that leaves open.
#[derive(Debug)]
pub(super) struct Ties {
    pub(super) bound: Bound<Octuple, true>,
    /// What the ray in hand hits by these rules.
    hits: Vec<Hit<Octuple>>,
    is_blocked: bool,
}

impl Ties {
    /// Of rays in `world`, none of which has begun.
    pub(super) fn new(world: &World<Octuple>) -> Self {
        Self { bound: Bound::new(world), hits: Vec::new(), is_blocked: false }
    }

    /// Whether a line touches a sphere, for all that is known.
    fn is_edge(&self, shape: &Shape<Octuple>, at: &Approach<Octuple>) -> bool {
        let is_near = at.discriminant.abs() < Octuple::from_f64(TIE) * shape.radius * shape.radius;
        is_near && self.bound.is_edge(shape, at, self.bound.reach(shape, at))
    }

    /// How near to its surface a place has to lie to be on it, for all that is known.
    fn near(&self, shape: &Shape<Octuple>) -> Octuple {
        let width = self.bound.width(shape, Octuple::ZERO);
        min(Octuple::from_f64(NEAR) * width * (shape.radius + width), Octuple::from_f64(TIE))
    }

    /// The least root that counts.
    fn root(
        &self,
        shape: &Shape<Octuple>,
        at: &Approach<Octuple>,
        range: &Range<Octuple>,
        sign: Option<Ordering>,
    ) -> Option<(Octuple, bool)> {
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
    fn stands(&self, shape: &Shape<Octuple>, crossing: &Crossing<Octuple>, t_min: Octuple) -> bool {
        let Crossing { at, start_squared, end_squared } = crossing;
        let is_edge = self.is_edge(shape, at);
        if !is_edge && at.discriminant < Octuple::ZERO {
            return false;
        }
        let side = |squared: &Octuple| {
            let beyond = *squared - shape.radius * shape.radius;
            if beyond.abs() <= self.near(shape) { Some(Ordering::Equal) } else { beyond.partial_cmp(&Octuple::ZERO) }
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

impl Witness<Octuple> for Ties {
    fn search(&mut self, ray: &Ray<Octuple>, light: bool) {
        self.bound.search(ray, light);
        self.hits.clear();
        self.is_blocked = false;
    }

    fn tested(
        &mut self,
        ray: &Ray<Octuple>,
        shape: &Shape<Octuple>,
        at: &Approach<Octuple>,
        range: &Range<Octuple>,
        sign: Option<Ordering>,
        root: Option<(Octuple, bool)>,
    ) {
        self.bound.tested(ray, shape, at, range, sign, root);
        let hit = self.root(shape, at, range, sign);
        self.hits.extend(hit.map(|(t, inside)| Hit { t, sphere: shape.index as usize, inside }));
    }

    fn tested_own(
        &mut self,
        ray: &Ray<Octuple>,
        own: &Own<Octuple>,
        shape: &Shape<Octuple>,
        t: Octuple,
        range: &Range<Octuple>,
    ) {
        self.bound.tested_own(ray, own, shape, t, range);
        let error = min(self.bound.exit_error(ray, shape), Octuple::from_f64(TIE) * t.abs());
        let is_after = |a: Octuple, b: Octuple| a - b > error;
        if own.inside && is_after(t, range.t_min) && (range.t_max > Octuple::ONE || is_after(range.t_max, t)) {
            self.hits.push(Hit { t, sphere: shape.index as usize, inside: true });
            self.is_blocked = true;
        }
    }

    fn crossed(
        &mut self,
        ray: &Ray<Octuple>,
        shape: &Shape<Octuple>,
        crossing: &Crossing<Octuple>,
        blocks: bool,
        t_min: Octuple,
    ) -> bool {
        self.is_blocked |= self.stands(shape, crossing, t_min);
        self.bound.crossed(ray, shape, crossing, blocks, t_min)
    }

    fn nearest(
        &mut self,
        world: &World<Octuple>,
        ray: &Ray<Octuple>,
        own: Option<&Own<Octuple>>,
        range: &Range<Octuple>,
        hit: Option<Hit<Octuple>>,
    ) -> Option<Hit<Octuple>> {
        self.bound.nearest(world, ray, own, range, hit);
        let least = self.hits.iter().map(|hit| hit.t).reduce(|a, b| if b < a { b } else { a })?;
        let tied = least + min(self.bound.tie(least), Octuple::from_f64(TIE) * least.abs());
        self.hits.iter().filter(|hit| hit.t <= tied).min_by_key(|hit| hit.sphere).copied()
    }

    fn background(&mut self, world: &World<Octuple>) {
        self.bound.background(world);
    }

    fn surface(
        &mut self,
        world: &World<Octuple>,
        ray: &Ray<Octuple>,
        hit: &Hit<Octuple>,
        at: &Approach<Octuple>,
        surface: &Surface<Octuple>,
    ) {
        self.bound.surface(world, ray, hit, at, surface);
    }

    fn lit(
        &mut self,
        world: &World<Octuple>,
        surface: &Surface<Octuple>,
        light: &PointLight<Octuple>,
        n_dot_l: Octuple,
        is_lit: bool,
    ) -> bool {
        self.bound.lit(world, surface, light, n_dot_l, is_lit)
    }

    fn blocked(&mut self, world: &World<Octuple>, ray: &Ray<Octuple>, own: &Own<Octuple>, is_blocked: bool) -> bool {
        self.bound.blocked(world, ray, own, is_blocked);
        self.is_blocked
    }

    fn shaded(
        &mut self,
        world: &World<Octuple>,
        surface: &Surface<Octuple>,
        light: &PointLight<Octuple>,
        terms: &LightTerms<Octuple>,
    ) {
        self.bound.shaded(world, surface, light, terms);
    }

    fn reflected(&mut self, throughput: Octuple) {
        self.bound.reflected(throughput);
    }

    fn refracted(
        &mut self,
        world: &World<Octuple>,
        surface: &Surface<Octuple>,
        snell: Snell<Octuple>,
        throughput: Octuple,
    ) -> Snell<Octuple> {
        self.bound.refracted(world, surface, snell, throughput)
    }

    fn resumed(&mut self) {
        self.bound.resumed();
    }
}

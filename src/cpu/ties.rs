//! Decisions that double-double leaves open are taken for ties, by the tracer's own rules: a tangent is a hit, of equal distances the
//! lower index counts, a root on the end of its range does not count, and a blocker ends before the light.

use std::cmp::Ordering;

use super::bound::Bound;
use super::dd::Dd;
use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray, root_in};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface, min};
use super::vec3::length;
use super::witness::Witness;
use crate::roundings::{NEAR, TIE};

/// Traces in double-double, with its bound, and takes for a tie what that leaves open.
#[derive(Debug)]
pub(super) struct Ties {
    pub(super) bound: Bound<Dd, true>,
    /// What the ray in hand hits by these rules.
    hits: Vec<Hit<Dd>>,
    is_blocked: bool,
}

impl Ties {
    /// Of a primary ray in `world`.
    pub(super) fn new(world: &World<Dd>, ray: &Ray<Dd>) -> Self {
        // A quotient of counts and a sum before it.
        let error = Dd::from(4.0 * Dd::UNIT);
        let mut bound = Bound::new(world);
        bound.begin([error * length(ray.origin), error]);
        Self { bound, hits: Vec::new(), is_blocked: false }
    }

    /// Whether a line touches a sphere, for all that is known.
    fn is_edge(&self, shape: &Shape<Dd>, at: &Approach<Dd>) -> bool {
        let is_near = at.discriminant.abs() < Dd::from(TIE) * shape.radius * shape.radius;
        is_near && self.bound.is_edge(shape, at, self.bound.reach(shape, at))
    }

    /// How near to its surface a place has to lie to be on it, for all that is known.
    fn near(&self, shape: &Shape<Dd>) -> Dd {
        let width = self.bound.width(shape, Dd::ZERO);
        min(Dd::from(NEAR) * width * (shape.radius + width), Dd::from(TIE))
    }

    /// The least root that counts.
    fn root(
        &self,
        shape: &Shape<Dd>,
        at: &Approach<Dd>,
        range: &Range<Dd>,
        sign: Option<Ordering>,
    ) -> Option<(Dd, bool)> {
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
    fn stands(&self, shape: &Shape<Dd>, crossing: &Crossing<Dd>, t_min: Dd) -> bool {
        let Crossing { at, start_squared, end_squared } = crossing;
        let is_edge = self.is_edge(shape, at);
        if !is_edge && at.discriminant < Dd::ZERO {
            return false;
        }
        let side = |squared: &Dd| {
            let beyond = *squared - shape.radius * shape.radius;
            if beyond.abs() <= self.near(shape) { Some(Ordering::Equal) } else { beyond.partial_cmp(&Dd::ZERO) }
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

impl Witness<Dd> for Ties {
    fn search(&mut self, ray: &Ray<Dd>, light: bool) {
        self.bound.search(ray, light);
        self.hits.clear();
        self.is_blocked = false;
    }

    fn tested(
        &mut self,
        ray: &Ray<Dd>,
        shape: &Shape<Dd>,
        at: &Approach<Dd>,
        range: &Range<Dd>,
        sign: Option<Ordering>,
        root: Option<(Dd, bool)>,
    ) {
        self.bound.tested(ray, shape, at, range, sign, root);
        let hit = self.root(shape, at, range, sign);
        self.hits.extend(hit.map(|(t, inside)| Hit { t, sphere: shape.index as usize, inside }));
    }

    fn tested_own(&mut self, ray: &Ray<Dd>, own: &Own<Dd>, shape: &Shape<Dd>, t: Dd, range: &Range<Dd>) {
        self.bound.tested_own(ray, own, shape, t, range);
        let error = min(self.bound.exit_error(ray, shape), Dd::from(TIE) * t.abs());
        let is_after = |a: Dd, b: Dd| a - b > error;
        if own.inside && is_after(t, range.t_min) && (range.t_max > Dd::ONE || is_after(range.t_max, t)) {
            self.hits.push(Hit { t, sphere: shape.index as usize, inside: true });
            self.is_blocked = true;
        }
    }

    fn crossed(&mut self, ray: &Ray<Dd>, shape: &Shape<Dd>, crossing: &Crossing<Dd>, blocks: bool, t_min: Dd) -> bool {
        self.is_blocked |= self.stands(shape, crossing, t_min);
        self.bound.crossed(ray, shape, crossing, blocks, t_min)
    }

    fn nearest(
        &mut self,
        world: &World<Dd>,
        ray: &Ray<Dd>,
        own: Option<&Own<Dd>>,
        range: &Range<Dd>,
        hit: Option<Hit<Dd>>,
    ) -> Option<Hit<Dd>> {
        self.bound.nearest(world, ray, own, range, hit);
        let least = self.hits.iter().map(|hit| hit.t).reduce(|a, b| if b < a { b } else { a })?;
        let tied = least + min(self.bound.tie(least), Dd::from(TIE) * least.abs());
        self.hits.iter().filter(|hit| hit.t <= tied).min_by_key(|hit| hit.sphere).copied()
    }

    fn background(&mut self, world: &World<Dd>) {
        self.bound.background(world);
    }

    fn surface(&mut self, world: &World<Dd>, ray: &Ray<Dd>, hit: &Hit<Dd>, at: &Approach<Dd>, surface: &Surface<Dd>) {
        self.bound.surface(world, ray, hit, at, surface);
    }

    fn lit(
        &mut self,
        world: &World<Dd>,
        surface: &Surface<Dd>,
        light: &PointLight<Dd>,
        n_dot_l: Dd,
        is_lit: bool,
    ) -> bool {
        self.bound.lit(world, surface, light, n_dot_l, is_lit)
    }

    fn blocked(&mut self, world: &World<Dd>, ray: &Ray<Dd>, own: &Own<Dd>, is_blocked: bool) -> bool {
        self.bound.blocked(world, ray, own, is_blocked);
        self.is_blocked
    }

    fn shaded(&mut self, world: &World<Dd>, surface: &Surface<Dd>, light: &PointLight<Dd>, terms: &LightTerms<Dd>) {
        self.bound.shaded(world, surface, light, terms);
    }

    fn reflected(&mut self, throughput: Dd) {
        self.bound.reflected(throughput);
    }

    fn refracted(&mut self, world: &World<Dd>, surface: &Surface<Dd>, snell: Snell<Dd>, throughput: Dd) -> Snell<Dd> {
        self.bound.refracted(world, surface, snell, throughput)
    }

    fn resumed(&mut self) {
        self.bound.resumed();
    }
}

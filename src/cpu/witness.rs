//! What can be watched, and decided otherwise, while a ray is traced. `()` watches nothing, leaves everything as it is and costs
//! nothing.

use std::cmp::Ordering;

use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface};

/// Sees every decision that the tracer takes, in order, and may take it the other way.
pub(crate) trait Witness<T: Real> {
    /// The search along a ray begins: for the nearest hit, or for what stands before a `light`.
    fn search(&mut self, _ray: &Ray<T>, _light: bool) {}
    /// A ray has been tested with a sphere that it does not leave: with the sign of the discriminant where it was decided exactly, and with
    /// the root that counts.
    fn tested(
        &mut self,
        _ray: &Ray<T>,
        _shape: &Shape<T>,
        _at: &Approach<T>,
        _range: &Range<T>,
        _sign: Option<Ordering>,
        _root: Option<(T, bool)>,
    ) {
    }
    /// A ray has been tested with the sphere that it leaves, which it would leave again at `t`.
    fn tested_own(&mut self, _ray: &Ray<T>, _own: &Own<T>, _shape: &Shape<T>, _t: T, _range: &Range<T>) {}
    /// A shadow ray has been tested with a sphere, which blocks it or not; returns whether that ends the search.
    fn crossed(&mut self, _ray: &Ray<T>, _shape: &Shape<T>, _crossing: &Crossing<T>, blocks: bool, _t_min: T) -> bool {
        blocks
    }
    /// The search for the nearest hit has ended; returns the hit to go on with.
    fn nearest(
        &mut self,
        _world: &World<T>,
        _ray: &Ray<T>,
        _own: Option<&Own<T>>,
        _range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        hit
    }
    /// The ray in hand has hit nothing and adds the background.
    fn background(&mut self, _world: &World<T>) {}
    /// The surface of the hit is known.
    fn surface(&mut self, _world: &World<T>, _ray: &Ray<T>, _hit: &Hit<T>, _at: &Approach<T>, _surface: &Surface<T>) {}
    /// N·L of a light is known; returns whether the light lights.
    fn lit(
        &mut self,
        _world: &World<T>,
        _surface: &Surface<T>,
        _light: &PointLight<T>,
        _n_dot_l: T,
        is_lit: bool,
    ) -> bool {
        is_lit
    }
    /// A shadow ray has been tested; returns whether it is blocked.
    fn blocked(&mut self, _world: &World<T>, _ray: &Ray<T>, _own: &Own<T>, is_blocked: bool) -> bool {
        is_blocked
    }
    /// A light has added its terms.
    fn shaded(&mut self, _world: &World<T>, _surface: &Surface<T>, _light: &PointLight<T>, _terms: &LightTerms<T>) {}
    /// A reflection ray with this weight is about to be followed.
    fn reflected(&mut self, _throughput: T) {}
    /// A refraction ray with this weight is about to be put aside; returns how it is bent.
    fn refracted(&mut self, _world: &World<T>, _surface: &Surface<T>, snell: Snell<T>, _throughput: T) -> Snell<T> {
        snell
    }
    /// The refraction ray that was put aside last is about to be followed.
    fn resumed(&mut self) {}
}

impl<T: Real> Witness<T> for () {}

/// The first decides; the second only looks on.
impl<T: Real, A: Witness<T>, B: Witness<T>> Witness<T> for (&mut A, &mut B) {
    #[inline]
    fn search(&mut self, ray: &Ray<T>, light: bool) {
        self.0.search(ray, light);
        self.1.search(ray, light);
    }

    #[inline]
    fn tested(
        &mut self,
        ray: &Ray<T>,
        shape: &Shape<T>,
        at: &Approach<T>,
        range: &Range<T>,
        sign: Option<Ordering>,
        root: Option<(T, bool)>,
    ) {
        self.0.tested(ray, shape, at, range, sign, root);
        self.1.tested(ray, shape, at, range, sign, root);
    }

    #[inline]
    fn tested_own(&mut self, ray: &Ray<T>, own: &Own<T>, shape: &Shape<T>, t: T, range: &Range<T>) {
        self.0.tested_own(ray, own, shape, t, range);
        self.1.tested_own(ray, own, shape, t, range);
    }

    #[inline]
    fn crossed(&mut self, ray: &Ray<T>, shape: &Shape<T>, crossing: &Crossing<T>, blocks: bool, t_min: T) -> bool {
        self.1.crossed(ray, shape, crossing, blocks, t_min);
        self.0.crossed(ray, shape, crossing, blocks, t_min)
    }

    #[inline]
    fn nearest(
        &mut self,
        world: &World<T>,
        ray: &Ray<T>,
        own: Option<&Own<T>>,
        range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        let hit = self.0.nearest(world, ray, own, range, hit);
        self.1.nearest(world, ray, own, range, hit);
        hit
    }

    #[inline]
    fn background(&mut self, world: &World<T>) {
        self.0.background(world);
        self.1.background(world);
    }

    #[inline]
    fn surface(&mut self, world: &World<T>, ray: &Ray<T>, hit: &Hit<T>, at: &Approach<T>, surface: &Surface<T>) {
        self.0.surface(world, ray, hit, at, surface);
        self.1.surface(world, ray, hit, at, surface);
    }

    #[inline]
    fn lit(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, n_dot_l: T, is_lit: bool) -> bool {
        let is_lit = self.0.lit(world, surface, light, n_dot_l, is_lit);
        self.1.lit(world, surface, light, n_dot_l, is_lit);
        is_lit
    }

    #[inline]
    fn blocked(&mut self, world: &World<T>, ray: &Ray<T>, own: &Own<T>, is_blocked: bool) -> bool {
        let is_blocked = self.0.blocked(world, ray, own, is_blocked);
        self.1.blocked(world, ray, own, is_blocked);
        is_blocked
    }

    #[inline]
    fn shaded(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, terms: &LightTerms<T>) {
        self.0.shaded(world, surface, light, terms);
        self.1.shaded(world, surface, light, terms);
    }

    #[inline]
    fn reflected(&mut self, throughput: T) {
        self.0.reflected(throughput);
        self.1.reflected(throughput);
    }

    #[inline]
    fn refracted(&mut self, world: &World<T>, surface: &Surface<T>, snell: Snell<T>, throughput: T) -> Snell<T> {
        let snell = self.0.refracted(world, surface, snell, throughput);
        self.1.refracted(world, surface, snell, throughput);
        snell
    }

    #[inline]
    fn resumed(&mut self) {
        self.0.resumed();
        self.1.resumed();
    }
}

//! What can be watched, and decided otherwise, while a ray is traced. `()` watches nothing, leaves everything as it is and costs
//! nothing.

use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface};

/// Sees every decision that the tracer takes, in order, and may take it the other way.
pub(crate) trait Witness<T: Real> {
    /// The search along a ray begins: for the nearest hit, or for what stands before a `light`.
    fn search(&mut self, _ray: &Ray<T>, _light: bool) {}
    /// A ray has been tested with a sphere that it does not leave.
    fn tested(&mut self, _ray: &Ray<T>, _shape: &Shape<T>, _at: &Approach<T>, _range: &Range<T>) {}
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

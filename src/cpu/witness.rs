//! What can be watched, and decided otherwise, while a ray is traced. `()` watches nothing, leaves everything as it is and costs
//! nothing.

use super::intersect::{Hit, Own, Range, Ray};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, World};
use super::shade::{LightTerms, Surface};

/// Sees every decision that the tracer takes, in order, and may take it the other way.
pub(crate) trait Witness<T: Real> {
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
    fn surface(&mut self, _world: &World<T>, _ray: &Ray<T>, _hit: &Hit<T>, _surface: &Surface<T>) {}
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

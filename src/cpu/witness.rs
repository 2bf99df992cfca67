//! What can be watched while a ray is traced. `()` watches nothing and costs nothing.

use super::intersect::{Hit, Own, Range, Ray};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, World};
use super::shade::Surface;

/// Sees every decision that the tracer takes, in order.
pub(crate) trait Witness<T: Real> {
    /// The search for the nearest hit has ended.
    fn nearest(
        &mut self,
        _world: &World<T>,
        _ray: &Ray<T>,
        _own: Option<&Own<T>>,
        _range: &Range<T>,
        _hit: Option<&Hit<T>>,
    ) {
    }
    /// The surface of the hit is known.
    fn surface(&mut self, _world: &World<T>, _ray: &Ray<T>, _hit: &Hit<T>, _surface: &Surface<T>) {}
    /// N·L of a light is known; only a positive one lights.
    fn lit(&mut self, _world: &World<T>, _surface: &Surface<T>, _light: &PointLight<T>, _n_dot_l: T) {}
    /// A shadow ray is about to be tested.
    fn shadow(&mut self, _world: &World<T>, _ray: &Ray<T>, _own: &Own<T>) {}
    /// A light has added its terms.
    fn shaded(&mut self, _world: &World<T>, _surface: &Surface<T>, _light: &PointLight<T>, _specular: T) {}
    /// A reflection ray with this weight is about to be followed.
    fn reflected(&mut self, _throughput: T) {}
    /// A refraction ray with this weight has been put aside.
    fn refracted(&mut self, _world: &World<T>, _surface: &Surface<T>, _snell: &Snell<T>, _throughput: T) {}
    /// The refraction ray that was put aside last is about to be followed.
    fn resumed(&mut self) {}
}

impl<T: Real> Witness<T> for () {}

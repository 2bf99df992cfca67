//! Snell's law; read it beside `shaders/refract.wgsl`.

use super::intersect::{Own, Ray};
use super::real::Real;
use super::scene::World;
use super::shade::Surface;
use super::trace::reflection_ray;

/// How a surface bends the view ray, whose direction need not be normalised.
///
/// With d the unit direction of the ray, n the normal on its side, c = −d·n, and r the index of refraction where the ray
/// comes from over that where it goes, the refracted unit direction is r·d + (r·c − √k)·n with k = (r·c)² − (r² − 1), the
/// square of the refracted ray's cosine. r·c − √k is a difference of nearly equal numbers where r is near 1; it is
/// (r² − 1)/(r·c + √k), and so 0 for r = 1, which leaves the direction as it is, to the last bit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Snell<T> {
    /// r.
    pub ratio: T,
    /// c, at least 0.
    pub cosine: T,
    /// k; not above 0 where all light is reflected.
    pub square: T,
    /// r·c − √k: how much of the normal is added.
    pub bend: T,
}

impl<T: Real> Snell<T> {
    /// For a ray that meets the surface at `cosine` with the ratio r.
    pub(crate) fn new(ratio: T, cosine: T) -> Self {
        let along = ratio * cosine;
        let excess = (ratio - T::ONE) * (ratio + T::ONE);
        let square = along * along - excess;
        Self { ratio, cosine, square, bend: excess / (along + square.sqrt()) }
    }

    /// Whether all light is reflected. Ordered comparison: indices beyond the range of the scalar refract nothing.
    pub(crate) fn is_total(&self) -> bool {
        !(self.square > T::ZERO)
    }
}

/// Snell's law at `surface`: entering where it is seen from outside, leaving where it is seen from inside.
pub(crate) fn snell_at<T: Real>(world: &World<T>, surface: &Surface<T>) -> Snell<T> {
    let glass = &world.glasses[surface.sphere];
    let cosine = surface.normal.dot(surface.view);
    let ratio = if surface.own.inside { glass.eta } else { glass.inv_eta };
    Snell::new(ratio, if cosine > T::ZERO { cosine } else { T::ZERO })
}

/// The refracted ray, of the length of the one that meets the surface, or on total internal reflection the mirrored one, of
/// unit length; with the wall that it leaves.
pub(crate) fn refraction_ray<T: Real>(ray: &Ray<T>, surface: &Surface<T>, snell: &Snell<T>) -> (Ray<T>, Own<T>) {
    if snell.is_total() {
        return (reflection_ray(surface), surface.own);
    }
    let length = ray.direction.dot(ray.direction).sqrt();
    let direction = ray.direction * snell.ratio + surface.normal * (snell.bend * length);
    (Ray { origin: surface.position, direction }, Own { inside: !surface.own.inside, ..surface.own })
}

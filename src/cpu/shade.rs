//! The exact Phong model at a hit; read it beside `shaders/shade.wgsl`.

use super::intersect::{Hit, Own, Ray, any_hit, approach};
use super::real::Real;
use super::scene::{Material, World};
use super::vec3::Vec3;
use super::witness::Witness;
use crate::settings::Specular;

/// The lit point of a hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface<T> {
    pub position: Vec3<T>,
    /// Unit normal, on the side of the viewer.
    pub normal: Vec3<T>,
    /// Unit vector towards where the ray came from.
    pub view: Vec3<T>,
    pub own: Own<T>,
    pub sphere: usize,
}

#[allow(clippy::inline_always, reason = "a call costs a tenth of the picture: the hit goes through memory")]
#[inline(always)]
pub(crate) fn surface_at<T: Real, W: Witness<T>>(
    world: &World<T>,
    ray: &Ray<T>,
    hit: &Hit<T>,
    witness: &mut W,
) -> Surface<T> {
    let shape = &world.shapes[hit.sphere];
    let material = &world.materials[hit.sphere];
    // From the closest approach, half a chord back or forth: S' + τc' would lose what distance costs.
    let at = approach(ray, shape);
    let half_chord = at.direction * (max(at.discriminant, T::ZERO) / at.a).sqrt();
    let local = if hit.inside { at.perpendicular + half_chord } else { at.perpendicular - half_chord };
    let outward = (local * shape.inv_scale).normalize();
    let surface = Surface {
        position: shape.center + local * material.scale,
        normal: if hit.inside { -outward } else { outward },
        view: -ray.direction.normalize(),
        own: Own { shape: shape.index, inside: hit.inside, local },
        sphere: hit.sphere,
    };
    witness.surface(world, ray, hit, &at, &surface);
    surface
}

/// cosⁿ from d = 1 − cos: exp(n·log1p(−d)) keeps what a power of the rounded cosine loses near 1.
pub(crate) fn specular_power<T: Real>(d: T, n: T) -> T {
    if n <= T::ZERO {
        T::ONE
    } else if d < T::ONE {
        (n * (-d).log1p()).exp()
    } else {
        T::ZERO
    }
}

/// The unblocked light of one source.
pub(crate) struct LightTerms<T> {
    /// Unit vector.
    pub to_light: Vec3<T>,
    /// 1 − cos of the angle whose cosine the specular term is a power of.
    pub d: T,
    pub diffuse: T,
    pub specular: T,
}

/// The specular term, after 1 − cos of the angle whose cosine it is a power of.
fn specular_term<T: Real>(
    surface: &Surface<T>,
    material: &Material<T>,
    to_light: Vec3<T>,
    n_dot_l: T,
    model: Specular,
) -> (T, T) {
    // 1 − cos of the angle between two unit vectors is half the square of their difference.
    let (a, b) = match model {
        Specular::Phong => (surface.normal * (n_dot_l + n_dot_l) - to_light, surface.view),
        Specular::Blinn => ((to_light + surface.view).normalize(), surface.normal),
    };
    let difference = a - b;
    let d = T::from_f64(0.5) * difference.dot(difference);
    (d, material.ks * specular_power(d, material.n))
}

/// A colour and, where it reaches the surface, the light with this index.
#[inline]
fn with_light<T: Real, W: Witness<T>>(
    world: &World<T>,
    mut color: Vec3<T>,
    index: usize,
    surface: &Surface<T>,
    witness: &mut W,
) -> Vec3<T> {
    let (light, material) = (&world.lights[index], &world.materials[surface.sphere]);
    let shadow_ray = Ray { origin: surface.position, direction: light.position - surface.position };
    let distance_squared = shadow_ray.direction.dot(shadow_ray.direction);
    let to_light = shadow_ray.direction * (T::ONE / distance_squared.sqrt());
    let n_dot_l = surface.normal.dot(to_light);
    // Not lit from behind, and not by a light at distance 0, where N·L is NaN.
    if !witness.lit(world, surface, light, n_dot_l, n_dot_l > T::ZERO) {
        return color;
    }
    if world.shadows {
        let is_blocked = any_hit(world, &shadow_ray, &surface.own, index, witness);
        if witness.blocked(world, &shadow_ray, &surface.own, is_blocked) {
            return color;
        }
    }
    let diffuse = material.kd * n_dot_l;
    let (d, specular) = specular_term(surface, material, to_light, n_dot_l, world.specular);
    let terms = LightTerms { to_light, d, diffuse, specular };
    color += light.intensity * material.color * terms.diffuse;
    color += light.intensity * terms.specular;
    witness.shaded(world, surface, light, &terms);
    color
}

/// Colour of a surface point without its reflection.
#[inline]
pub(crate) fn local_color<T: Real, W: Witness<T>>(world: &World<T>, surface: &Surface<T>, witness: &mut W) -> Vec3<T> {
    let material = &world.materials[surface.sphere];
    let mut color = world.ambient * material.color * material.ka;
    for index in 0..world.lights.len() {
        color = with_light(world, color, index, surface, witness);
    }
    color
}

pub(crate) fn max<T: Real>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

pub(crate) fn min<T: Real>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

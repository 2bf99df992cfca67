//! A pixel's colour: the primary ray and its chain of reflections; read it beside `shaders/trace.wgsl` and
//! `shaders/path_in_place.wgsl`.

use super::intersect::{Hit, Primary, Ray, nearest_secondary, nearest_seen};
use super::real::Real;
use super::scene::World;
use super::shade::{Surface, local_color, surface_at};
use super::trace_refraction::tree_color;
use super::vec3::Vec3;
use super::witness::Witness;

/// The unclamped colour seen along `primary`.
pub(crate) fn trace<T: Real, W: Witness<T>>(world: &World<T>, primary: &Primary<T>, witness: &mut W) -> Vec3<T> {
    if world.refracts {
        return tree_color(world, primary, witness);
    }
    let hit = nearest_seen(world, primary, witness);
    let hit = witness.nearest(world, &primary.ray, None, &world.primary, hit);
    follow(world, primary.ray, hit, witness)
}

/// From the hit of a primary ray on, to the end of its path.
#[inline]
fn follow<T: Real, W: Witness<T>>(
    world: &World<T>,
    mut ray: Ray<T>,
    mut hit: Option<Hit<T>>,
    witness: &mut W,
) -> Vec3<T> {
    if hit.is_none() {
        witness.background(world);
        return world.background;
    }
    let mut color = Vec3::ZERO;
    let mut throughput = T::ONE;
    let mut depth = 0;
    // A reflection ray that hits nothing adds black.
    while let Some(found) = hit {
        let surface = surface_at(world, &ray, &found, witness);
        color += local_color(world, &surface, witness) * throughput;

        let kr = world.materials[surface.sphere].kr;
        if depth == world.max_depth || kr == T::ZERO {
            break;
        }
        depth += 1;
        throughput = throughput.weakened(kr);
        ray = reflection_ray(&surface);
        witness.reflected(throughput);
        hit = nearest_secondary(world, &ray, &surface.own, &world.reflection, witness);
        hit = witness.nearest(world, &ray, Some(&surface.own), &world.reflection, hit);
    }
    color
}

/// The mirrored view ray, of unit length.
pub(crate) fn reflection_ray<T: Real>(surface: &Surface<T>) -> Ray<T> {
    let n_dot_v = surface.normal.dot(surface.view);
    Ray { origin: surface.position, direction: surface.normal * (n_dot_v + n_dot_v) - surface.view }
}

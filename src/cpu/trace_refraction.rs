//! A pixel's colour where something refracts: the primary ray and its tree of reflections and refractions; read it beside
//! `shaders/path_tree.wgsl`.

use super::intersect::{Own, Primary, Ray, nearest_secondary, nearest_seen};
use super::real::Real;
use super::refract::{refraction_ray, snell_at};
use super::scene::World;
use super::shade::{local_color, surface_at};
use super::trace::reflection_ray;
use super::vec3::Vec3;
use super::witness::Witness;

/// A refraction ray that waits until the reflected ray beside it has been followed to its end.
struct Waiting<T> {
    ray: Ray<T>,
    own: Own<T>,
    throughput: T,
    depth: u32,
    shows_background: bool,
}

/// The unclamped colour seen along `primary`: depth-first, the reflected ray first. Each depth leaves one refraction ray
/// behind at the most, so that no more than `max_depth` wait.
#[inline(never)]
pub(super) fn tree_color<T: Real, W: Witness<T>>(world: &World<T>, primary: &Primary<T>, witness: &mut W) -> Vec3<T> {
    let (mut ray, mut own, mut range) = (primary.ray, None, world.primary);
    let mut color = Vec3::ZERO;
    let mut throughput = T::ONE;
    let mut depth = 0;
    let mut waiting: Vec<Waiting<T>> = Vec::new();
    // One looks through glass at the background; a ray that was reflected and hits nothing adds black.
    let mut shows_background = true;
    loop {
        let hit = match &own {
            None => nearest_seen(world, primary, witness),
            Some(own) => nearest_secondary(world, &ray, own, &range, witness),
        };
        let hit = witness.nearest(world, &ray, own.as_ref(), &range, hit);
        if let Some(found) = hit {
            let surface = surface_at(world, &ray, &found, witness);
            color += local_color(world, &surface, witness) * throughput;

            if depth < world.max_depth {
                let kt = world.glasses[surface.sphere].kt;
                if kt != T::ZERO {
                    let throughput = throughput.weakened(kt);
                    let snell = witness.refracted(world, &surface, snell_at(world, &surface), throughput);
                    let (ray, own) = refraction_ray(&ray, &surface, &snell);
                    waiting.push(Waiting { ray, own, throughput, depth: depth + 1, shows_background });
                }
                let kr = world.materials[surface.sphere].kr;
                if kr != T::ZERO {
                    depth += 1;
                    throughput = throughput.weakened(kr);
                    ray = reflection_ray(&surface);
                    own = Some(surface.own);
                    range = world.reflection;
                    shows_background = false;
                    witness.reflected(throughput);
                    continue;
                }
            }
        } else if shows_background {
            witness.background(world);
            color += world.background * throughput;
        }
        let Some(next) = waiting.pop() else { return color };
        (ray, own, range) = (next.ray, Some(next.own), world.refraction);
        (throughput, depth, shows_background) = (next.throughput, next.depth, next.shows_background);
        witness.resumed();
    }
}

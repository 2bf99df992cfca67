//! Where light goes, in double-double and by formulas of its own: the reference's code has no part in it.
//!
//! The root comes from the moment form of `cpu::oracle`. The point of the hit is origin + t direction, which loses nothing that
//! matters in 106 bits. A refracted ray keeps the part of its direction along the surface, times the ratio of the indices; the
//! rest of its unit length goes along the normal.

use glam::DVec3;

use crate::cpu::oracle::{GlassBody, Passage, quotient, truth_of};
use crate::cpu::{Dd, Real, Vec3};
use crate::gpu::Surface;

/// A ray whose numbers are exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Vec3<Dd>,
    pub(super) direction: Vec3<Dd>,
}

/// The wall that a ray leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Own {
    /// By its place among the surfaces.
    pub(super) surface: usize,
    /// Whether it is the inner one.
    pub(super) inside: bool,
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Met {
    pub(super) t: Dd,
    /// By its place among the surfaces.
    pub(super) surface: usize,
    /// Whether from inside.
    pub(super) inside: bool,
    pub(super) place: Vec3<Dd>,
    /// Of unit length, on the side of the ray.
    pub(super) normal: Vec3<Dd>,
    /// 1 − l², the square of the cosine between ray and normal where the surface is a sphere.
    pub(super) clearance: f64,
    /// The length of the gradient of |(x − centre)/scale|, times the least semi-axis: 1 on spheres, and little where an ellipsoid is
    /// pointed and its normal turns fast. Errors of normals grow like one over it.
    pub(super) steadiness: f64,
}

/// What two roots differ by in part of themselves, at the least: nothing less is told apart from the rounding of double-double.
const TIE: f64 = 1e-27;

/// The nearest root beyond `t_min`, and the least |1 − l²| of a surface that is not behind the ray; of equal roots the
/// first surface's.
pub(super) fn nearest(ray: &Ray, surfaces: &[Surface], own: Option<Own>, t_min: f64) -> (Option<Met>, f64) {
    let mut found: Option<(Dd, usize, bool, f64)> = None;
    let mut margin = f64::INFINITY;
    for (index, surface) in surfaces.iter().enumerate() {
        let own = own.filter(|own| own.surface == index);
        if own.is_some_and(|own| !own.inside) {
            continue;
        }
        let truth = truth_of(ray.origin, ray.direction, surface.center, surface.scale);
        let clearance = truth.clearance.hi();
        let Some(roots) = truth.roots else {
            if is_ahead(ray, surface) {
                margin = margin.min(clearance.abs());
            }
            continue;
        };
        // On its own inner wall a ray begins at the lesser root.
        let first = usize::from(own.is_some());
        let Some(root) = (first..2).find(|&root| roots[root] > Dd::from(t_min)) else { continue };
        margin = margin.min(clearance.abs());
        if found.is_none_or(|(t, ..)| t - roots[root] > t * Dd::from(TIE)) {
            found = Some((roots[root], index, root == 1, clearance));
        }
    }
    let met = |(t, surface, inside, clearance): (Dd, usize, bool, f64)| {
        let Surface { center, scale } = surfaces[surface];
        let place = ray.origin + ray.direction * t;
        let radii = Vec3::from_f64(scale.abs());
        let gradient = quotient(quotient(place - Vec3::from_f64(center), radii), radii);
        let outward = gradient.normalize();
        let normal = if inside { -outward } else { outward };
        let steadiness = gradient.to_f64().length() * scale.abs().min_element();
        Met { t, surface, inside, place, normal, clearance, steadiness }
    };
    (found.map(met), margin)
}

/// Whether the ray comes nearer to the centre of the surface.
fn is_ahead(ray: &Ray, surface: &Surface) -> bool {
    let scale = surface.scale;
    ((surface.center - ray.origin.to_f64()) / scale).dot(ray.direction.to_f64() / scale) > 0.0
}

/// The mirror image of a direction about a normal.
pub(super) fn mirrored(direction: Vec3<Dd>, normal: Vec3<Dd>) -> Vec3<Dd> {
    let along = direction.dot(normal);
    direction - normal * (along + along)
}

/// A unit direction behind a surface, the index of refraction being `ratio` times as great before it, and the square of its cosine;
/// no direction where all light is reflected. The normal is on the side of the ray.
pub(super) fn refracted(direction: Vec3<Dd>, normal: Vec3<Dd>, ratio: Dd) -> (Option<Vec3<Dd>>, Dd) {
    let along_surface = (direction - normal * direction.dot(normal)) * ratio;
    let square = Dd::ONE - along_surface.dot(along_surface);
    ((square > Dd::ZERO).then(|| along_surface - normal * square.sqrt()), square)
}

/// What happens at each surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Turn {
    /// Rays are mirrored.
    Mirrored,
    /// Rays are refracted by this index, or mirrored where all light is.
    Refracted(f64),
}

/// The end of a path: the last ray, and what it meets.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) met: Option<Met>,
    pub(super) ray: Ray,
    /// The product of all cosines between rays and normals on the way, in the spaces where the surfaces are spheres, and of the
    /// steadiness of the normals at all turns: errors grow like one over it.
    pub(super) cosine: f64,
    /// How near the path comes to another one: the least |1 − l²| of a surface, or square of the cosine of a refracted ray.
    pub(super) margin: f64,
}

/// Follows a ray up to `bounces` turns; its first root counts beyond `t_min`, the others beyond 0.
pub(super) fn follow(
    mut ray: Ray,
    surfaces: &[Surface],
    mut own: Option<Own>,
    t_min: f64,
    turns: Option<(Turn, u32)>,
) -> End {
    let (mut met, mut margin) = nearest(&ray, surfaces, own, t_min);
    let mut cosine = 1.0;
    let (turn, bounces) = turns.unwrap_or((Turn::Mirrored, 0));
    for _ in 0..bounces {
        let Some(at) = met else { break };
        cosine *= at.clearance.sqrt() * at.steadiness;
        let length = ray.direction.dot(ray.direction).sqrt();
        let direction = ray.direction * (Dd::ONE / length);
        let mut inside = at.inside;
        ray = Ray { origin: at.place, direction: mirrored(direction, at.normal) };
        if let Turn::Refracted(eta) = turn {
            let eta = Dd::from(eta);
            let (refracted, square) = refracted(direction, at.normal, if at.inside { eta } else { Dd::ONE / eta });
            margin = margin.min(square.hi().abs());
            cosine *= square.hi().abs().sqrt();
            if let Some(refracted) = refracted {
                ray.direction = refracted * length;
                inside = !inside;
            }
        }
        own = Some(Own { surface: at.surface, inside });
        let next = nearest(&ray, surfaces, own, 0.0);
        (met, margin) = (next.0, margin.min(next.1));
    }
    if let Some(at) = &met {
        cosine *= at.clearance.sqrt();
    }
    End { met, ray, cosine, margin }
}

/// What [`crate::cpu::oracle::refracted`] says too, by formulas of its own; the index of refraction is that of the first body.
pub fn passage(origin: DVec3, direction: DVec3, bodies: &[GlassBody], bounces: u32) -> Passage {
    let surfaces: Vec<_> = bodies.iter().map(|body| Surface { center: body.center, scale: body.scale }).collect();
    let eta = bodies.first().map_or(1.0, |body| body.eta);
    let ray = Ray { origin: Vec3::from_f64(origin), direction: Vec3::from_f64(direction) };
    let End { ray, met, .. } = follow(ray, &surfaces, None, 0.0, Some((Turn::Refracted(eta), bounces)));
    Passage {
        origin: ray.origin.to_f64(),
        direction: ray.direction.to_f64(),
        hit: met.map(|met| (met.t.hi(), met.surface, met.inside)),
    }
}

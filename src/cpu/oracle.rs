//! Where a ray meets an ellipsoid, in truth: all geometry from the `f64` inputs in the scalar asked for.
//!
//! The renderers round ellipsoids to their object space first; here nothing is rounded before the first operation. Two
//! independent formulas stand side by side: [`intersect`] runs the reference's own code, [`truth`] the moment form.

use std::sync::Arc;

use glam::DVec3;

use super::dd::Dd;
use super::intersect::{Hit, Own, Range, Ray, approach, nearest_of, roots};
use super::real::Real;
use super::refract::{refraction_ray, snell_at};
use super::scene::{Glass, Material, Shape, World};
use super::shade::surface_at;
use super::tangent::Tangents;
use super::vec3::Vec3;
use crate::settings::Specular;

/// What is known of a line and an ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Both roots in units of the direction, lesser first, equal where the line touches; none where it misses.
    ///
    /// Their relative error is about 1e-32, times 1/√clearance near a tangent, times the radius over the root where the
    /// origin lies near the surface: some 1e-25 at a clearance of 1e-12 or at 1e-7 radii from the surface.
    pub roots: Option<[Dd; 2]>,
    /// 1 − l², with l the distance of the line from the centre in the space where the ellipsoid is the unit sphere:
    /// 1 through the centre, 0 at a tangent, negative for a miss, NaN without direction or semi-axis.
    ///
    /// Its absolute error is below 2e-31·max(1, |S'|), |S'| being the distance of the origin in that space.
    pub clearance: Dd,
}

/// The line `origin` + t·`direction` and the ellipsoid |(x − `center`)/`scale`| = 1, in double-double.
///
/// The moment form: |c'|²t² + 2(S'·c')t + |S'|² − 1 = 0 has the discriminant |c'|² − |S'×c'|² (Lagrange's identity), free of
/// the cancellation in (S'·c')² − |c'|²(|S'|² − 1).
pub fn truth(origin: DVec3, direction: DVec3, center: DVec3, scale: DVec3) -> Truth {
    truth_of(Vec3::from_f64(origin), Vec3::from_f64(direction), center, scale)
}

/// The same of a line in double-double.
pub(crate) fn truth_of(origin: Vec3<Dd>, direction: Vec3<Dd>, center: DVec3, scale: DVec3) -> Truth {
    let radii = Vec3::from_f64(scale.abs());
    let s = quotient(origin - Vec3::from_f64(center), radii);
    let c = quotient(direction, radii);
    let a = c.dot(c);
    let moment = cross(s, c);
    let discriminant = a - moment.dot(moment);
    let clearance = discriminant / a;
    // Ordered comparison: a NaN is never a hit.
    let meets = clearance >= Dd::ZERO;
    Truth { roots: meets.then(|| stable_pair(a, s.dot(c), s.dot(s) - Dd::ONE, discriminant.sqrt())), clearance }
}

/// Both roots, lesser first, by the reference's own code in `T`: the formula of the renderer, without rounding the
/// ellipsoid to `f64` on the way into object space.
pub fn intersect<T: Real>(origin: DVec3, direction: DVec3, center: DVec3, scale: DVec3) -> Option<(T, T)> {
    let ray = Ray { origin: Vec3::from_f64(origin), direction: Vec3::from_f64(direction) };
    let inv_scale = quotient(Vec3::new(T::ONE, T::ONE, T::ONE), Vec3::from_f64(scale.abs()));
    let shape = Shape { center: Vec3::from_f64(center), inv_scale, radius: T::ONE, index: 0 };
    roots(&approach(&ray, &shape), shape.radius)
}

/// A body of glass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlassBody {
    /// Its centre.
    pub center: DVec3,
    /// Its semi-axes.
    pub scale: DVec3,
    /// Index of refraction of the inside relative to the outside.
    pub eta: f64,
}

/// The end of a path through glass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Where the last ray starts.
    pub origin: DVec3,
    /// Its direction, as long as that of the first ray, or of unit length after a total reflection.
    pub direction: DVec3,
    /// What it meets: t, the body by its place, and whether from inside; `None` where it misses all.
    pub hit: Option<(f64, usize, bool)>,
}

/// The path of the refraction ray through `bodies`, `bounces` surfaces long or until it misses all; by the reference's own code
/// in `T`, without rounding the bodies to `f64` on the way into object space.
pub fn refracted<T: Real>(origin: DVec3, direction: DVec3, bodies: &[GlassBody], bounces: u32) -> Passage {
    let world = glass_world::<T>(bodies);
    let mut ray = Ray { origin: Vec3::from_f64(origin), direction: Vec3::from_f64(direction) };
    let mut own: Option<Own<T>> = None;
    let all: Vec<u32> = (0..bodies.len() as u32).collect();
    let mut hit = nearest_of(&world, &ray, None, &world.refraction, &all, None, &mut ());
    for _ in 0..bounces {
        let Some(found) = hit else { break };
        let surface = surface_at(&world, &ray, &found, &mut ());
        let (next, wall) = refraction_ray(&ray, &surface, &snell_at(&world, &surface));
        ray = next;
        hit = nearest_of(&world, &ray, Some(own.insert(wall)), &world.refraction, &all, None, &mut ());
    }
    let met = |hit: Hit<T>| (hit.t.to_f64(), hit.sphere, hit.inside);
    Passage { origin: ray.origin.to_f64(), direction: ray.direction.to_f64(), hit: hit.map(met) }
}

/// `bodies` and nothing else.
fn glass_world<T: Real>(bodies: &[GlassBody]) -> World<T> {
    let ones = Vec3::new(T::ONE, T::ONE, T::ONE);
    let radii = |body: &GlassBody| Vec3::from_f64(body.scale.abs());
    let shape = |(index, body): (usize, &GlassBody)| Shape {
        center: Vec3::from_f64(body.center),
        inv_scale: quotient(ones, radii(body)),
        radius: T::ONE,
        index: index as u32,
    };
    let material = |body: &GlassBody| Material {
        scale: radii(body),
        color: Vec3::ZERO,
        ka: T::ZERO,
        kd: T::ZERO,
        ks: T::ZERO,
        kr: T::ZERO,
        n: T::ONE,
    };
    let glass = |body: &GlassBody| {
        let eta = T::from_f64(body.eta);
        Glass { kt: T::ONE, eta, inv_eta: T::ONE / eta }
    };
    let range = Range { t_min: T::ZERO, t_max: T::FAR, greater: true };
    World {
        shapes: bodies.iter().enumerate().map(shape).collect(),
        materials: bodies.iter().map(material).collect(),
        glasses: bodies.iter().map(glass).collect(),
        lights: Vec::new(),
        ambient: Vec3::ZERO,
        background: Vec3::ZERO,
        primary: range,
        shadow_t_min: T::ZERO,
        reflection: range,
        refraction: range,
        shadows: false,
        refracts: true,
        specular: Specular::Phong,
        max_depth: 0,
        allowance: T::FAR,
        light_allowance: T::FAR,
        ellipsoids: true,
        middle: Vec3::ZERO,
        extent: T::ONE,
        moved: 0.0,
        accel: Arc::default(),
        tangents: Tangents::default(),
        exact: Arc::default(),
    }
}

/// a/b, componentwise.
pub(crate) fn quotient<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    Vec3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

/// Vector product.
fn cross(a: Vec3<Dd>, b: Vec3<Dd>) -> Vec3<Dd> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// The roots of at² + 2bt + c = 0, lesser first, without cancellation; `root` is √(b² − ac).
fn stable_pair(a: Dd, b: Dd, c: Dd, root: Dd) -> [Dd; 2] {
    if b < Dd::ZERO {
        let q = root - b;
        [c / q, q / a]
    } else {
        let q = -(b + root);
        // q = 0: touches the surface at the very origin.
        [q / a, if q == Dd::ZERO { q } else { c / q }]
    }
}

//! How far rounding may move what a ray meets: bounds to first order, and to second order at grazing angles.
//!
//! Errors are in units of the unit roundoff u, half a unit in the last place: each operation and each input that is rounded
//! adds one. Chains of operations count as many as add up in fact, and what only changes a vector's length is kept apart from
//! what turns it.

use glam::DVec3;

use super::intersect::{Approach, Own, Ray, approach, exit_of};
use super::real::Real;
use super::scene::{Shape, World};
use super::shade::max;
use super::vec3::{Vec3, largest, length};
use crate::camera::Camera;
use crate::precision::Tier;
use crate::roundings;

/// Roundings of a place on the way into object space: of inputs, and of what is calculated from them.
const PLACE: f64 = 2.0;
/// Roundings of a point of a surface within object space: half a chord is a product, a quotient and a root.
const LOCAL: f64 = 6.0;
/// Roundings of a root of the quadratic beyond those of the place: products, sums, quotient.
const ROOT: f64 = 8.0;
/// Roundings that turn a unit vector: a product for each component, and the difference or sum before it.
pub(super) const ANGLE: f64 = 3.0;
/// Roundings of a unit vector's length: half a sum of three products, a root, a quotient and a product.
pub(super) const LENGTH: f64 = 8.0;

/// Unit roundoffs of a renderer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roundoff {
    /// Of shading, and of roots.
    pub shading: f64,
    /// Of inputs, places and intersections.
    pub geometry: f64,
}

impl Roundoff {
    /// Of the kernel of `tier`.
    pub(super) fn of(tier: Tier) -> Self {
        // `robust` intersects with pairs of f32 that carry at least 44 bits.
        let (shading, geometry) = match tier {
            Tier::Fast => (24, 24),
            Tier::Robust => (24, 44),
            Tier::Double => (53, 53),
        };
        Self { shading: 0.5_f64.powi(shading), geometry: 0.5_f64.powi(geometry) }
    }

    /// With every rounding that `src/roundings.rs` counts: no count here, which are of what adds up in fact, is smaller by more than this
    /// factor, that of the roundings of a place on its way into the object space of an ellipsoid.
    pub(super) fn counted(self) -> Self {
        const MORE: f64 = (roundings::PLACE + roundings::AXES) / PLACE;
        Self { shading: MORE * self.shading, geometry: MORE * self.geometry }
    }

    /// Whether shading is in `f32`.
    pub(super) fn is_single(&self) -> bool {
        self.shading > f64::from(f32::EPSILON) / 4.0
    }
}

/// What the error cone around a ray carries along its path; all errors are absolute.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// The surface that the ray leaves.
    pub own: Option<Own<f64>>,
    /// Error of the ray's origin, in world units.
    pub position: f64,
    /// Error of the ray's direction, as a fraction of its length.
    pub direction: f64,
    /// Where the ray's direction is known better than by the above: the error of its end at t = 1, in world units.
    pub end: Option<f64>,
    /// Weight of what is gathered next.
    pub throughput: f64,
    pub bounces: u32,
    /// Index among the rays of the tree.
    pub ray: usize,
}

impl Path {
    /// Of a ray from the eye, whose direction, or origin where it is parallel to others, is the sum of two rounded vectors.
    pub(super) fn primary(roundoff: Roundoff, camera: &Camera) -> Self {
        let (position, direction) = (camera.position_error(roundoff.geometry), PLACE * roundoff.geometry);
        Self { own: None, position, direction, end: None, throughput: 1.0, bounces: 0, ray: 0 }
    }
}

/// Where the rays of a cone meet a sphere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Both roots of the ray in the middle, lesser first: both the closest approach where it misses. Of the sphere that the ray
    /// leaves, the first is the start.
    pub t: [f64; 2],
    /// Their errors.
    pub error: [f64; 2],
    /// Whether every ray of the cone meets the sphere.
    pub is_sure: bool,
}

/// A ray with the cone around it.
pub(super) struct Margins<'a> {
    pub world: &'a World<f64>,
    pub ray: &'a Ray<f64>,
    pub path: &'a Path,
    pub roundoff: Roundoff,
}

impl Margins<'_> {
    /// Width of the cone at `t`, in world units, with the rounding of the way into `sphere`'s object space.
    fn width(&self, sphere: usize, t: f64) -> f64 {
        let Self { world, ray, path, roundoff } = self;
        let along = t.abs() * length(ray.direction);
        // The start of a ray may be off along its own surface, but lies on it but for rounding.
        let start = if self.leaves(sphere) { LOCAL * roundoff.geometry * size(world, sphere) } else { path.position };
        let place = PLACE * roundoff.geometry * (length(ray.origin) + length(world.shapes[sphere].center) + along);
        self.spread(start, t) + place
    }

    /// Whether a ray of the cone may meet anything within a ball from t = 0 to `t_max`.
    pub(super) fn may_meet(&self, center: DVec3, radius: f64, t_max: f64) -> bool {
        let (origin, direction) = (self.ray.origin.to_f64(), self.ray.direction.to_f64());
        let length = direction.length();
        let from_origin = center - origin;
        let along = from_origin.dot(direction) / length;
        let aside = (from_origin - direction * (along / length)).length();
        // The width at the far end of the ball, and what rounding takes there.
        let far = (along.abs() + radius) / length;
        let start = self.path.position.max(LOCAL * self.roundoff.geometry * radius);
        let place = PLACE * (origin.length() + center.length() + far * length) + (PLACE + LOCAL) * radius;
        let reach = radius + self.spread(start, far) + self.roundoff.geometry * place;
        // NaN is near.
        !(aside > reach || along < -reach || along > t_max * length + reach)
    }

    /// Width of a cone that starts with this one, at `t`.
    fn spread(&self, start: f64, t: f64) -> f64 {
        match self.path.end {
            // Both ends of the way are known.
            Some(end) => start * (1.0 - t).abs() + end * t.abs(),
            None => start + t.abs() * length(self.ray.direction) * self.path.direction,
        }
    }

    fn leaves(&self, sphere: usize) -> bool {
        self.path.own.is_some_and(|own| own.shape == self.world.shapes[sphere].index)
    }

    /// Where the cone meets `sphere`; `None` where every ray of it misses.
    pub(super) fn crossing(&self, sphere: usize) -> Option<Crossing> {
        let shape = &self.world.shapes[sphere];
        let at = approach(self.ray, shape);
        let closest = at.b / at.a;
        let distance = length(at.perpendicular);
        let width = self.width(sphere, closest);
        // |is∘perpendicular|/|perpendicular| is the gradient of the distance from the centre in object space.
        let steepest = largest(shape.inv_scale) * width;
        let sideways = length(at.perpendicular * shape.inv_scale) / distance * width;
        let error = steepest.min(sideways + 0.5 * steepest * steepest / distance)
            + LOCAL * self.roundoff.geometry * shape.radius;
        if distance - shape.radius > error {
            return None;
        }
        let half_chord = (at.discriminant.max(0.0) / at.a).sqrt();
        let t = [closest - half_chord, closest + half_chord];
        let along = at.direction * half_chord;
        let error_at = |t, local| self.root_error(sphere, &at, t, local);
        Some(Crossing {
            t,
            error: [error_at(t[0], at.perpendicular - along), error_at(t[1], at.perpendicular + along)],
            is_sure: shape.radius - distance > error,
        })
    }

    /// Where a ray that starts on the inner wall of `sphere`, its own, leaves it.
    pub(super) fn exit(&self, sphere: usize, own: &Own<f64>) -> Crossing {
        let shape = &self.world.shapes[sphere];
        let t = exit_of(own, self.ray.direction, shape);
        let local = own.local + self.ray.direction * shape.inv_scale * t;
        let at = approach(self.ray, shape);
        let slide = self.slide(shape, local) / length(self.ray.direction);
        // The start is rounded in object space.
        let start = LOCAL * self.roundoff.shading * shape.radius / at.a.sqrt();
        let error = slide + start + self.turned(own, shape, [at.a, t], self.root_error(sphere, &at, t, local));
        Crossing { t: [0.0, t], error: [0.0, error], is_sure: true }
    }

    /// How far the end of a chord at `local`, in object space, moves where its start is off along the surface: as far as the start,
    /// times the quotient of the cosines at both ends.
    fn slide(&self, shape: &Shape<f64>, local: Vec3<f64>) -> f64 {
        let Some(own) = &self.path.own else { return 0.0 };
        let slant = |local: Vec3<f64>| {
            let gradient = local * shape.inv_scale;
            gradient.dot(self.ray.direction).abs() / length(gradient)
        };
        self.path.position * (slant(own.local) / slant(local)).max(1.0)
    }

    /// `error` of the end t of a chord that begins on the surface, or what a turn of its ray makes of it where the chord is shorter than
    /// that: the width of the cone at its end says nothing of it. t is −2S'·d'/A, and S'·d' changes by the gradient times the turn.
    fn turned(&self, own: &Own<f64>, shape: &Shape<f64>, [a, t]: [f64; 2], error: f64) -> f64 {
        let turn = 2.0 * length(own.local * shape.inv_scale) * length(self.ray.direction) * self.path.direction / a;
        if t.abs() < 2.0 * turn { error.max(turn) } else { error }
    }

    /// Error of a root t at `local`, in object space.
    fn root_error(&self, sphere: usize, at: &Approach<f64>, t: f64, local: Vec3<f64>) -> f64 {
        self.reach(sphere, at, t, local) + ROOT * self.roundoff.shading * t.abs()
    }

    /// How far along the ray, in units of t, the surface at `local` may lie from where the middle of the cone meets it.
    ///
    /// The discriminant x changes by δ = 2w|g| with w the width and g the gradient, in the world, of half the squared distance from
    /// the centre, and by the square of w in object space. Half the chord is √x: it changes by √x − √(x − δ), which is w/|N·d| where
    /// δ is small, and by no more than √δ where the ray grazes.
    fn reach(&self, sphere: usize, at: &Approach<f64>, t: f64, local: Vec3<f64>) -> f64 {
        let shape = &self.world.shapes[sphere];
        let width = self.width(sphere, t);
        let steepest = largest(shape.inv_scale) * width;
        let rounding = LOCAL * self.roundoff.geometry * shape.radius * shape.radius;
        let delta = 2.0 * (width * length(local * shape.inv_scale) + rounding) + steepest * steepest;
        let x = at.discriminant.max(0.0);
        let half_chord = if x >= delta { delta / (x.sqrt() + (x - delta).sqrt()) } else { delta.sqrt() };
        half_chord / at.a.sqrt()
    }

    /// Errors of the point at t on `sphere`, at `local` in object space: in world units, without and with the rounding of the place
    /// in the world, and that of the unit normal there.
    pub(super) fn point(&self, sphere: usize, t: f64, local: Vec3<f64>) -> PointError {
        let shape = &self.world.shapes[sphere];
        let Roundoff { shading, geometry } = self.roundoff;
        let at = approach(self.ray, shape);
        let reach = self.reach(sphere, &at, t, local);
        let (slide, reach) = match self.path.own.as_ref().filter(|_| self.leaves(sphere)) {
            Some(own) => (self.slide(shape, local), self.turned(own, shape, [at.a, t], reach)),
            None => (0.0, reach),
        };
        let size = size(self.world, sphere);
        // Wherever it is, it lies on the surface.
        let along = (slide + reach * length(self.ray.direction)).min(2.0 * size);
        let place = length(shape.center + local * self.world.materials[sphere].scale) + length(shape.center);
        let normal = normal_error(shape, local, along, self.width(sphere, t), LOCAL * shading * shape.radius);
        PointError { position: along + geometry * (LOCAL * size + PLACE * place), normal: normal + ANGLE * shading }
    }
}

/// Errors of a point on a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointError {
    /// Of its place, in world units.
    pub position: f64,
    /// Of the unit normal: an angle, 2 where it may point anywhere.
    pub normal: f64,
}

/// Error of the unit normal at `local`, in object space, where the place is off by `along` along the surface and by `off` from it in
/// world units, and by `rounding` in object space.
///
/// The normal is along the gradient g = D·P with D the diagonal matrix of 1/s² and P the place relative to the centre: linear in
/// P. Along the surface D stretches by the greater eigenvalue λ of its part in the tangent plane; the surface curves away from
/// that plane by λ/(2|g|)·`along`², which D stretches by no more than its greatest entry. Along the normal n, D turns it by
/// |Dn − (nᵀDn)n|.
pub(super) fn normal_error<T: Real>(shape: &Shape<T>, local: Vec3<T>, along: T, off: T, rounding: T) -> T {
    let half = T::from_f64(0.5);
    // Both in units of 1/r².
    let gradient = local * shape.inv_scale;
    let length_of_gradient = length(gradient);
    let d = shape.inv_scale * shape.inv_scale;
    let normal = gradient * (T::ONE / length_of_gradient);
    let n = normal * normal;
    let trace = d.x * (n.y + n.z) + d.y * (n.z + n.x) + d.z * (n.x + n.y);
    let determinant = n.x * d.y * d.z + n.y * d.z * d.x + n.z * d.x * d.y;
    let root = max(trace * trace - T::from_f64(4.0) * determinant, T::ZERO).sqrt();
    let sideways = half * (trace + root) * along;
    let across = d * normal;
    let turned = length(across - normal * normal.dot(across));
    let error = (sideways
        + half * largest(d) * (sideways / length_of_gradient) * along
        + turned * off
        + largest(shape.inv_scale) * rounding)
        / length_of_gradient;
    // An error as long as the gradient can turn it anywhere.
    if error < half { error / (T::ONE - error) } else { T::from_f64(2.0) }
}

/// Greatest semi-axis of a sphere.
pub(super) fn size(world: &World<f64>, sphere: usize) -> f64 {
    largest(world.materials[sphere].scale) * world.shapes[sphere].radius
}

//! Rays against spheres; read it beside `shaders/intersect.wgsl` and `shaders/kernel_plain.wgsl`.
//!
//! The quadratic |c'|²τ² + 2(S'·c')τ + |S'|² − r² = 0 in its numerically sound form: the discriminant from the distance
//! of the ray to the centre, the roots as a stable pair (Haines, Günther, Akenine-Möller, "Precision Improvements for
//! Ray/Sphere Intersection", Ray Tracing Gems, chapter 7).

use std::cmp::Ordering;

use super::real::Real;
use super::scene::{Shape, World};
use super::shade::max;
use super::tangent::Tangents;
use super::vec3::Vec3;
use super::witness::Witness;
use crate::accel::REACH;

/// origin + t·direction; the direction need not be normalised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray<T> {
    pub origin: Vec3<T>,
    pub direction: Vec3<T>,
}

/// The sphere that a secondary ray leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Own<T> {
    /// Shape index of the sphere.
    pub shape: u32,
    /// Whether the ray starts on the inner wall.
    pub inside: bool,
    /// Start of the ray in the sphere's object space.
    pub local: Vec3<T>,
}

/// The nearest accepted intersection.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit<T> {
    pub t: T,
    pub sphere: usize,
    /// Whether it is the greater root: the sphere is seen from inside.
    pub inside: bool,
}

/// A ray's closest approach to a sphere's centre, in the sphere's object space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Approach<T> {
    /// S': origin minus centre.
    pub origin: Vec3<T>,
    /// c'.
    pub direction: Vec3<T>,
    /// c'·c'.
    pub a: T,
    /// −S'·c'.
    pub b: T,
    /// From the centre to the closest point of the line.
    pub perpendicular: Vec3<T>,
    /// radius² − |perpendicular|²: negative where the line misses.
    pub discriminant: T,
}

impl<T: Real> Approach<T> {
    /// The same with a discriminant whose sign is right.
    #[inline]
    pub(crate) fn decided(self, sign: Option<Ordering>) -> Self {
        let discriminant = match sign {
            None => return self,
            Some(Ordering::Less) => -T::ONE,
            Some(Ordering::Equal) => T::ZERO,
            // Where that is not positive the chord is shorter than the scalar can say.
            Some(Ordering::Greater) => max(self.discriminant, T::ZERO),
        };
        Self { discriminant, ..self }
    }
}

pub(crate) fn approach<T: Real>(ray: &Ray<T>, shape: &Shape<T>) -> Approach<T> {
    let origin = (ray.origin - shape.center) * shape.inv_scale;
    let direction = ray.direction * shape.inv_scale;
    let a = direction.dot(direction);
    let b = -origin.dot(direction);
    // An error of b/a moves the point along the ray, which changes its distance to second order only.
    let perpendicular = origin + direction * (b * (T::ONE / a));
    let discriminant = shape.radius * shape.radius - perpendicular.dot(perpendicular);
    Approach { origin, direction, a, b, perpendicular, discriminant }
}

/// Both roots, lesser first; none where the line misses.
pub(crate) fn roots<T: Real>(at: &Approach<T>, radius: T) -> Option<(T, T)> {
    // Ordered comparison: a NaN is never a hit.
    if !(at.discriminant >= T::ZERO) {
        return None;
    }
    let root = (at.a * at.discriminant).sqrt();
    let c = at.origin.dot(at.origin) - radius * radius;
    if at.b >= T::ZERO {
        let q = at.b + root;
        Some((c / q, q / at.a))
    } else {
        let q = at.b - root;
        Some((q / at.a, c / q))
    }
}

/// Where a ray that starts on the inner wall leaves its own sphere: C = 0, so τ = −2B/A and no quadratic is needed.
pub(crate) fn exit_of<T: Real>(own: &Own<T>, direction: Vec3<T>, shape: &Shape<T>) -> T {
    let direction = direction * shape.inv_scale;
    let projection = -own.local.dot(direction);
    (projection + projection) / direction.dot(direction)
}

/// Which roots count.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range<T> {
    /// A root counts beyond this.
    pub t_min: T,
    /// A root counts before this.
    pub t_max: T,
    /// Whether the greater root counts where the lesser is too near.
    pub greater: bool,
}

/// The least root of one sphere that counts, and whether it is the greater one.
#[inline]
pub(crate) fn accepted_root<T: Real, W: Witness<T>>(
    ray: &Ray<T>,
    shape: &Shape<T>,
    own: Option<&Own<T>>,
    range: &Range<T>,
    witness: &mut W,
) -> Option<(T, bool)> {
    let Range { t_min, t_max, .. } = *range;
    if let Some(own) = own.filter(|own| own.shape == shape.index) {
        // The outside of a convex surface is never met again.
        let t = exit_of(own, ray.direction, shape);
        witness.tested_own(ray, own, shape, t, range);
        return (own.inside && t > t_min && t < t_max).then_some((t, true));
    }
    let at = approach(ray, shape);
    let root = root_in(range, &at, shape.radius);
    witness.tested(ray, shape, &at, range, None, root);
    root
}

/// The least of both roots that counts, and whether it is the greater one.
#[inline]
pub(super) fn root_in<T: Real>(range: &Range<T>, at: &Approach<T>, radius: T) -> Option<(T, bool)> {
    least_of(roots(at, radius)?, range)
}

/// The same of these two.
#[inline]
pub(super) fn least_of<T: Real>((lesser, greater): (T, T), range: &Range<T>) -> Option<(T, bool)> {
    let Range { t_min, t_max, .. } = *range;
    if lesser > t_min {
        (lesser < t_max).then_some((lesser, false))
    } else {
        (range.greater && greater > t_min && greater < t_max).then_some((greater, true))
    }
}

/// A ray from the eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Primary<'a, T> {
    pub ray: Ray<T>,
    /// Column and row of its sample.
    pub sample: [u32; 2],
    /// The spheres that it can meet.
    pub seen: &'a [u32],
}

/// The least root of one sphere that counts along a primary ray. Whether the two meet is decided exactly.
#[inline]
pub(crate) fn primary_root<T: Real, W: Witness<T>>(
    ray: &Ray<T>,
    shape: &Shape<T>,
    range: &Range<T>,
    tangents: &Tangents,
    touches: impl FnOnce() -> Ordering,
    witness: &mut W,
) -> Option<(T, bool)> {
    let at = approach(ray, shape);
    let sign = tangents.decided(&at, shape, touches);
    let root = root_in(range, &at.decided(sign), shape.radius);
    witness.tested(ray, shape, &at, range, sign, root);
    root
}

/// The nearest of `nearest` and the intersections with `spheres` in `range`; of equal ones the lowest index.
pub(super) fn nearest_of<T: Real, W: Witness<T>>(
    world: &World<T>,
    ray: &Ray<T>,
    own: Option<&Own<T>>,
    range: &Range<T>,
    spheres: &[u32],
    mut nearest: Option<Hit<T>>,
    witness: &mut W,
) -> Option<Hit<T>> {
    for &sphere in spheres {
        let sphere = sphere as usize;
        nearest = nearer_of(nearest, sphere, accepted_root(ray, &world.shapes[sphere], own, range, witness));
    }
    nearest
}

/// The nearer of a hit and a root of one more sphere; of equal ones the lower index.
#[inline]
fn nearer_of<T: Real>(nearest: Option<Hit<T>>, sphere: usize, root: Option<(T, bool)>) -> Option<Hit<T>> {
    match root {
        Some((t, inside))
            if nearest.is_none_or(|nearest| t < nearest.t || (t == nearest.t && sphere < nearest.sphere)) =>
        {
            Some(Hit { t, sphere, inside })
        }
        _ => nearest,
    }
}

/// The nearest intersection of a primary ray.
pub(crate) fn nearest_seen<T: Real, W: Witness<T>>(
    world: &World<T>,
    primary: &Primary<T>,
    witness: &mut W,
) -> Option<Hit<T>> {
    let Primary { ray, sample, seen } = primary;
    witness.search(ray, false);
    let mut nearest = None;
    for &sphere in *seen {
        let sphere = sphere as usize;
        let touches = || world.exact.discriminant(*sample, sphere);
        let root = primary_root(ray, &world.shapes[sphere], &world.primary, &world.tangents, touches, witness);
        nearest = nearer_of(nearest, sphere, root);
    }
    nearest
}

/// The nearest intersection of a ray that leaves a surface.
pub(crate) fn nearest_secondary<T: Real, W: Witness<T>>(
    world: &World<T>,
    ray: &Ray<T>,
    own: &Own<T>,
    range: &Range<T>,
    witness: &mut W,
) -> Option<Hit<T>> {
    let own = Some(own);
    let grid = world.accel.grid.as_ref()?;
    witness.search(ray, false);
    let mut nearest = nearest_of(world, ray, own, range, grid.large(), None, witness);
    for step in grid.walk(ray.origin.to_f64(), ray.direction.to_f64()) {
        nearest = nearest_of(world, ray, own, range, grid.lists.of(step.cell), nearest, witness);
        if nearest.is_some_and(|hit| step.ends_the_walk(hit.t.to_f64())) {
            break;
        }
    }
    nearest
}

/// How a shadow ray, which ends at t = 1, crosses a sphere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing<T> {
    pub at: Approach<T>,
    /// Squared distances from the centre, in object space: where the ray begins to count, and of its end.
    pub start_squared: T,
    pub end_squared: T,
}

impl<T: Real> Crossing<T> {
    pub(crate) fn of(ray: &Ray<T>, shape: &Shape<T>, t_min: T) -> Self {
        let at = approach(ray, shape);
        let start = at.origin + at.direction * t_min;
        let end = at.origin + at.direction;
        Self { at, start_squared: start.dot(start), end_squared: end.dot(end) }
    }

    /// Whether a root that counts lies beyond `t_min` and before t = 1: from where both ends lie, without a square root.
    pub(crate) fn blocks(&self, radius: T, t_min: T) -> bool {
        let Self { at, start_squared, end_squared } = self;
        let radius_squared = radius * radius;
        let starts_outside = *start_squared > radius_squared;
        let crosses = if starts_outside { *end_squared < radius_squared } else { *end_squared > radius_squared };
        // An end on the very surface is not beyond it.
        let passes = starts_outside && *end_squared >= radius_squared && at.b > at.a * t_min && at.b < at.a;
        at.discriminant >= T::ZERO && (crosses || passes)
    }
}

/// Whether a ray from the surface of a sphere meets that sphere again beyond `t_min` and before t = 1.
fn own_blocks<T: Real>(own: &Own<T>, t: T, t_min: T) -> bool {
    own.inside && t > t_min && t < T::ONE
}

/// Whether any sphere stands between the ray's origin and the light with this index at t = 1.
pub(crate) fn any_hit<T: Real, W: Witness<T>>(
    world: &World<T>,
    ray: &Ray<T>,
    own: &Own<T>,
    light: usize,
    witness: &mut W,
) -> bool {
    let from_light = (-ray.direction).to_f64();
    let lights = &world.accel.lights;
    let distance = from_light.length() + lights.slack;
    let range = Range { t_min: world.shadow_t_min, t_max: T::ONE, greater: true };
    witness.search(ray, true);
    let mut is_blocked = false;
    for &sphere in lights.at(light, from_light) {
        let shape = &world.shapes[sphere as usize];
        if is_behind(ray, shape, distance) {
            break;
        }
        let is_last = if own.shape == shape.index {
            let t = exit_of(own, ray.direction, shape);
            witness.tested_own(ray, own, shape, t, &range);
            let blocks = own_blocks(own, t, range.t_min);
            is_blocked |= blocks;
            blocks
        } else {
            let crossing = Crossing::of(ray, shape, range.t_min);
            let blocks = crossing.blocks(shape.radius, range.t_min);
            is_blocked |= blocks;
            witness.crossed(ray, shape, &crossing, blocks, range.t_min)
        };
        if is_last {
            break;
        }
    }
    is_blocked
}

/// Whether a sphere, and so all that follow in a light's list, lies too far from the light, at t = 1, to stand before a point at this distance
/// from it.
fn is_behind<T: Real>(ray: &Ray<T>, shape: &Shape<T>, distance: f64) -> bool {
    let from_light = (shape.center - ray.origin - ray.direction).to_f64();
    let scale = shape.inv_scale.to_f64();
    let reach = distance + shape.radius.to_f64() / scale.min_element() * REACH;
    from_light.length_squared() > reach * reach
}

//! The generators of the classes that are about rays.

use glam::DVec3;

use super::truth::carried;
use crate::gpu::{Batch, ProbeRay, Surface};
use crate::random::Random;

/// Makes a batch of so many rays.
pub(super) type Generator = fn(&mut Random, usize) -> Batch;

/// Adds a ray with surfaces of its own, all numbers such that two `f32` carry them.
fn add(batch: &mut Batch, origin: DVec3, direction: DVec3, surfaces: &[(DVec3, DVec3)]) {
    let first = batch.surfaces.len() as u32;
    let surface = |&(center, scale): &(DVec3, DVec3)| Surface { center: carried(center), scale: carried(scale) };
    batch.surfaces.extend(surfaces.iter().map(surface));
    let (origin, direction) = (carried(origin), carried(direction));
    let end = first + surfaces.len() as u32;
    batch.rays.push(ProbeRay { origin, direction, first, end, primary: false, own: None });
}

fn each(count: usize, mut make: impl FnMut(&mut Batch, usize)) -> Batch {
    let mut batch = Batch::default();
    (0..count).for_each(|index| make(&mut batch, index));
    batch
}

/// Unit spheres at `distance`, rays around them.
fn at_distance(random: &mut Random, count: usize, distance: f64) -> Batch {
    each(count, |batch, _| {
        let center = random.in_box(2.0);
        let origin = center + random.unit() * distance;
        let target = center + random.in_ball() * 1.3;
        // Directions of a picture are of any length.
        let direction = (target - origin).normalize() * random.within(0.5, 2.0);
        add(batch, origin, direction, &[(center, DVec3::ONE)]);
    })
}

pub(super) fn ordinary(random: &mut Random, count: usize) -> Batch {
    at_distance(random, count, 5.0)
}

/// Unit spheres at `distance` from the world's origin, where the eye of every picture is, and rays around them.
fn from_eye(random: &mut Random, count: usize, distance: f64) -> Batch {
    each(count, |batch, _| {
        let center = random.unit() * distance;
        let target = center + random.in_ball() * 1.3;
        let direction = target.normalize() * random.within(0.5, 2.0);
        add(batch, DVec3::ZERO, direction, &[(center, DVec3::ONE)]);
    })
}

pub(super) fn ordinary_eye(random: &mut Random, count: usize) -> Batch {
    from_eye(random, count, 5.0)
}

pub(super) fn far_3_eye(random: &mut Random, count: usize) -> Batch {
    from_eye(random, count, 1e3)
}

pub(super) fn far_5_eye(random: &mut Random, count: usize) -> Batch {
    from_eye(random, count, 1e5)
}

pub(super) fn tangent_eye(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let direction = random.unit();
        let l = (1.0 - random.sign() * random.magnitude(-12.0, -2.0)).sqrt();
        let center = direction * (25.0 - l * l).sqrt() + random.perpendicular(direction) * l;
        add(batch, DVec3::ZERO, direction, &[(center, DVec3::ONE)]);
    })
}

pub(super) fn far_3(random: &mut Random, count: usize) -> Batch {
    at_distance(random, count, 1e3)
}

pub(super) fn far_5(random: &mut Random, count: usize) -> Batch {
    at_distance(random, count, 1e5)
}

pub(super) fn far_7(random: &mut Random, count: usize) -> Batch {
    at_distance(random, count, 1e7)
}

/// Spheres of a box that secondary rays see.
const BOX_SPHERES: usize = 32;

pub(super) fn secondary(random: &mut Random, count: usize) -> Batch {
    let mut batch = Batch::default();
    for _ in 0..BOX_SPHERES {
        let radius = carried(DVec3::splat(random.within(0.1, 2.0)));
        batch.surfaces.push(Surface { center: carried(random.in_box(10.0)), scale: radius });
    }
    for _ in 0..count {
        let own = (random.bits() % BOX_SPHERES as u64) as u32;
        let Surface { center, scale } = batch.surfaces[own as usize];
        let normal = random.unit();
        let direction = random.unit();
        let direction = if direction.dot(normal) < 0.0 { -direction } else { direction };
        batch.rays.push(ProbeRay {
            origin: carried(center + scale * normal),
            direction: carried(direction),
            first: 0,
            end: BOX_SPHERES as u32,
            primary: false,
            own: Some(own),
        });
    }
    batch
}

pub(super) fn earth(random: &mut Random, count: usize) -> Batch {
    const RADIUS: f64 = 6.4e6;
    each(count, |batch, _| {
        let down = random.unit();
        // The horizon is 5.6e-4 below the horizontal.
        let dip = random.within(0.0, 2e-3);
        let ahead = random.perpendicular(down);
        let direction = ahead * dip.cos() + down * dip.sin();
        add(batch, DVec3::ZERO, direction, &[(down * (RADIUS + 1.0), DVec3::splat(RADIUS))]);
    })
}

pub(super) fn near_surface(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let center = random.in_box(2.0);
        let height = random.sign() * random.magnitude(-7.0, -2.0);
        let origin = center + random.unit() * (1.0 + height);
        add(batch, origin, random.unit(), &[(center, DVec3::ONE)]);
    })
}

pub(super) fn tangent(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let origin = random.in_box(2.0);
        let direction = random.unit();
        let l = (1.0 - random.sign() * random.magnitude(-12.0, -2.0)).sqrt();
        let center = origin + direction * random.within(3.0, 7.0) + random.perpendicular(direction) * l;
        add(batch, origin, direction, &[(center, DVec3::ONE)]);
    })
}

/// An ellipsoid seen from a distance of five times its greatest axis.
fn seen(random: &mut Random, count: usize, scale: DVec3) -> Batch {
    each(count, |batch, _| {
        let center = random.in_box(2.0);
        let origin = center + random.unit() * (5.0 * scale.max_element());
        let direction = (center + scale * random.in_ball() * 1.2 - origin).normalize();
        add(batch, origin, direction, &[(center, scale)]);
    })
}

pub(super) fn disc(random: &mut Random, count: usize) -> Batch {
    seen(random, count, DVec3::new(1.0, 1.0, 1e-3))
}

pub(super) fn needle(random: &mut Random, count: usize) -> Batch {
    seen(random, count, DVec3::new(1e-2, 1.0, 100.0))
}

pub(super) fn needle_eye(random: &mut Random, count: usize) -> Batch {
    let scale = DVec3::new(1e-2, 1.0, 100.0);
    each(count, |batch, _| {
        let center = random.unit() * (5.0 * scale.max_element());
        let direction = (center + scale * random.in_ball() * 1.2).normalize();
        add(batch, DVec3::ZERO, direction, &[(center, scale)]);
    })
}

pub(super) fn disc_from_near(random: &mut Random, count: usize) -> Batch {
    let scale = DVec3::new(1.0, 1.0, 1e-4);
    each(count, |batch, _| {
        let center = random.in_box(2.0);
        let across = random.in_ball() * 0.7;
        let origin = center + DVec3::new(across.x, across.y, 2e-4);
        let direction = (center + scale * random.in_ball() * 1.2 - origin).normalize();
        add(batch, origin, direction, &[(center, scale)]);
    })
}

pub(super) fn translated(random: &mut Random, count: usize) -> Batch {
    let place = DVec3::new(1e6, -1e6, 1e6);
    let mut batch = Batch::default();
    for ray in at_distance(random, count, 5.0).rays {
        let center = ray.origin + ray.direction.normalize() * 5.0 + random.in_ball();
        add(&mut batch, ray.origin + place, ray.direction, &[(center + place, DVec3::ONE)]);
    }
    batch
}

/// Two spheres around one centre, either of them first.
fn concentric(random: &mut Random, count: usize, gap: f64) -> Batch {
    each(count, |batch, index| {
        let center = random.in_box(2.0);
        let origin = center + random.unit() * 5.0;
        let direction = (center + random.in_ball() - origin).normalize();
        let (inner, outer) = ((center, DVec3::ONE), (center, DVec3::splat(1.0 + gap)));
        add(batch, origin, direction, &if index % 2 == 0 { [inner, outer] } else { [outer, inner] });
    })
}

pub(super) fn concentric_0(random: &mut Random, count: usize) -> Batch {
    concentric(random, count, 0.0)
}

pub(super) fn concentric_ulp(random: &mut Random, count: usize) -> Batch {
    concentric(random, count, super::metrics::U)
}

pub(super) fn concentric_6(random: &mut Random, count: usize) -> Batch {
    concentric(random, count, 1e-6)
}

pub(super) fn concentric_5(random: &mut Random, count: usize) -> Batch {
    concentric(random, count, 1e-5)
}

/// The ordinary world times 2 to a power, which keeps every digit.
fn sized(random: &mut Random, count: usize, power: i32) -> Batch {
    let mut batch = at_distance(random, count, 5.0);
    let k = 2_f64.powi(power);
    for ray in &mut batch.rays {
        (ray.origin, ray.direction) = (ray.origin * k, ray.direction * k);
    }
    for surface in &mut batch.surfaces {
        (surface.center, surface.scale) = (surface.center * k, surface.scale * k);
    }
    batch
}

pub(super) fn size_1e20(random: &mut Random, count: usize) -> Batch {
    sized(random, count, 66)
}

pub(super) fn size_1em30(random: &mut Random, count: usize) -> Batch {
    sized(random, count, -100)
}

pub(super) fn size_1em38(random: &mut Random, count: usize) -> Batch {
    sized(random, count, -126)
}

pub(super) fn from_inside(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let center = random.in_box(2.0);
        let origin = center + random.in_ball() * 0.9;
        add(batch, origin, random.unit(), &[(center, DVec3::ONE)]);
    })
}

pub(super) fn cut(random: &mut Random, count: usize) -> Batch {
    let mut batch = each(count, |batch, _| {
        let direction = DVec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), -1.0);
        let center = direction + random.in_ball() * 0.95;
        add(batch, DVec3::ZERO, direction, &[(center, DVec3::ONE)]);
    });
    batch.rays.iter_mut().for_each(|ray| ray.primary = true);
    batch
}

pub(super) fn touching(random: &mut Random, count: usize) -> Batch {
    let mut batch = each(count, |batch, _| {
        // Whole numbers of few bits: t = 1 is exact in every precision.
        let near = (1 + random.bits() % 64) as f64 / 8.0;
        let radius = (1 + random.bits() % 64) as f64 / 16.0;
        let direction = DVec3::new(0.0, 0.0, -near);
        add(batch, DVec3::ZERO, direction, &[(DVec3::new(0.0, 0.0, -near - radius), DVec3::splat(radius))]);
    });
    batch.rays.iter_mut().for_each(|ray| ray.primary = true);
    batch
}

/// Rays along the axis between two facing mirrors, close enough to it to be caught for some bounces.
pub(super) fn between_mirrors(random: &mut Random, count: usize) -> Batch {
    let mut batch = Batch::default();
    // Oblique: along an axis of the world rounding would spare the small components.
    let axis = DVec3::new(0.6, 0.48, 0.64);
    for side in [-1.0, 1.0] {
        batch.surfaces.push(Surface { center: carried(axis * (side * 1.5)), scale: DVec3::ONE });
    }
    for _ in 0..count {
        let start = random.in_ball() * 1e-9;
        let direction = (axis * random.sign() + random.in_ball() * 1e-9).normalize();
        let (origin, direction) = (carried(start), carried(direction));
        batch.rays.push(ProbeRay { origin, direction, first: 0, end: 2, primary: false, own: None });
    }
    batch
}

/// Rays that go into a body of glass at the origin, or start in it, with a screen of glass around; the screen is met in the end.
fn through(random: &mut Random, count: usize, scale: DVec3, born_inside: bool, eta: f64, bounces: u32) -> Batch {
    let glass = |batch: &mut Batch, random: &mut Random| {
        let target = random.in_ball() * scale;
        let origin = if born_inside { random.in_ball() * 0.9 * scale } else { random.unit() * 5.0 };
        let direction = (target - origin).normalize() * random.within(0.5, 2.0);
        let center = random.in_box(2.0);
        let bodies = [(center, scale), (center + random.in_box(0.5), DVec3::splat(20.0))];
        add(batch, center + origin, direction, &bodies);
    };
    Batch { bounces, eta, ..each(count, |batch, _| glass(batch, random)) }
}

/// In and out of balls.
pub(super) fn glass_balls(random: &mut Random, count: usize) -> Batch {
    through(random, count, DVec3::ONE, false, 1.5, 2)
}

/// In and out of balls that are all but air, where Snell's law is nearly the identity.
pub(super) fn thin_air(random: &mut Random, count: usize) -> Batch {
    through(random, count, DVec3::ONE, false, 1.0 + 1.0 / f64::from(1 << 20), 2)
}

/// In and out of ellipsoids.
pub(super) fn glass_ellipsoids(random: &mut Random, count: usize) -> Batch {
    through(random, count, DVec3::new(1.0, 0.75, 0.5), false, 1.5, 2)
}

/// Bubbles: those beyond the critical angle turn back at once and meet the screen, then leave it.
pub(super) fn bubbles(random: &mut Random, count: usize) -> Batch {
    through(random, count, DVec3::ONE, false, 0.75, 2)
}

/// Born in diamonds, reflected from wall to wall.
pub(super) fn diamonds(random: &mut Random, count: usize) -> Batch {
    through(random, count, DVec3::new(1.0, 0.75, 0.5), true, 2.5, 4)
}

/// What the light of a ray ought to do.
pub(super) type LitGenerator = fn(&mut Random, usize) -> (Batch, Vec<bool>);

/// A ray from 5 above `place`, where the unit normal is `normal`, and its light 10 away in `to_light`.
fn view(random: &mut Random, place: DVec3, normal: DVec3) -> (DVec3, DVec3) {
    let towards = (normal + random.perpendicular(normal) * random.within(0.0, 2.0)).normalize();
    (place + towards * 5.0, -towards)
}

pub(super) fn terminator(random: &mut Random, count: usize) -> (Batch, Vec<bool>) {
    let mut lit = Vec::with_capacity(count);
    let mut batch = Batch::default();
    for _ in 0..count {
        let center = random.in_box(2.0);
        let radius = random.magnitude(-2.0, 4.0);
        let normal = random.unit();
        let place = center + normal * radius;
        let (origin, direction) = view(random, DVec3::ZERO, normal);
        let cosine = random.sign() * random.magnitude(-5.0, 0.0);
        let to_light = normal * cosine + random.perpendicular(normal) * (1.0 - cosine * cosine).max(0.0).sqrt();
        add(&mut batch, place + origin * radius, direction, &[(center, DVec3::splat(radius))]);
        batch.lights.push(carried(place + to_light * (10.0 * radius)));
        lit.push(cosine > 0.0);
    }
    (batch, lit)
}

/// A small sphere at `gap` radii above a unit sphere, in the light of which the ray's hit lies or does not.
fn contact(random: &mut Random, count: usize, gap: f64) -> (Batch, Vec<bool>) {
    let mut lit = Vec::with_capacity(count);
    let mut batch = Batch::default();
    for _ in 0..count {
        let center = random.in_box(2.0);
        let normal = random.unit();
        let small = random.magnitude(-4.0, -1.0);
        let across = random.perpendicular(normal);
        let is_lit = random.bits() & 1 == 0;
        let offset = small * if is_lit { random.within(1.2, 3.0) } else { random.within(0.4, 0.8) };
        let place = center + normal * (1.0 - offset * offset).sqrt() + across * offset;
        let blocker = center + normal * (1.0 + gap + small);
        // Seen from beside the blocker, lit from straight above it.
        let towards = (across * 0.8 + normal * 0.6).normalize();
        let surfaces = [(center, DVec3::ONE), (blocker, DVec3::splat(small))];
        add(&mut batch, place + towards * 5.0, -towards, &surfaces);
        batch.lights.push(carried(place + normal * 10.0));
        lit.push(is_lit);
    }
    (batch, lit)
}

pub(super) fn contact_0(random: &mut Random, count: usize) -> (Batch, Vec<bool>) {
    contact(random, count, 0.0)
}

pub(super) fn contact_7(random: &mut Random, count: usize) -> (Batch, Vec<bool>) {
    contact(random, count, 1e-7)
}

pub(super) fn interpenetrating(random: &mut Random, count: usize) -> (Batch, Vec<bool>) {
    contact(random, count, -1e-7)
}

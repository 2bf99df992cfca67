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

/// The semi-axes of a ball of ordinary size; no digits are spared.
pub(super) fn ball(random: &mut Random) -> DVec3 {
    DVec3::splat(random.within(0.3, 3.0))
}

/// The semi-axes of an ellipsoid of ordinary size and shape.
pub(super) fn egg(random: &mut Random) -> DVec3 {
    shaped(random, DVec3::new(1.0, 0.7, 0.5))
}

/// Semi-axes near these proportions, of ordinary size.
fn shaped(random: &mut Random, proportions: DVec3) -> DVec3 {
    let mut near = || random.within(0.8, 1.25);
    proportions * DVec3::new(near(), near(), near()) * random.within(0.3, 3.0)
}

/// A direction of a picture, which may have any length.
fn of_any_length(random: &mut Random, direction: DVec3) -> DVec3 {
    direction.normalize() * random.magnitude(-3.0, 3.0)
}

/// Makes the semi-axes of a body.
pub(super) type Axes = fn(&mut Random) -> DVec3;

/// Bodies at `distance` least semi-axes, rays around them.
pub(super) fn at_distance(random: &mut Random, count: usize, distance: f64, axes: Axes) -> Batch {
    each(count, |batch, _| {
        let scale = axes(random);
        let center = random.in_box(2.0);
        let origin = center + random.unit() * (distance * scale.min_element());
        let target = center + scale * random.in_ball() * 1.3;
        add(batch, origin, of_any_length(random, target - origin), &[(center, scale)]);
    })
}

/// Bodies at `distance` least semi-axes from the world's origin, where the eye of every picture is, and rays around them.
pub(super) fn from_eye(random: &mut Random, count: usize, distance: f64, axes: Axes) -> Batch {
    each(count, |batch, _| {
        let scale = axes(random);
        let center = random.unit() * (distance * scale.min_element());
        let target = center + scale * random.in_ball() * 1.3;
        add(batch, DVec3::ZERO, of_any_length(random, target), &[(center, scale)]);
    })
}

/// How far the line of a ray near a tangent passes from the centre, in radii.
fn near_tangent(random: &mut Random) -> f64 {
    (1.0 - random.sign() * random.magnitude(-12.0, -2.0)).sqrt()
}

pub(super) fn tangent_eye(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let scale = ball(random);
        let direction = random.unit();
        let l = near_tangent(random);
        let center = scale * (direction * (25.0 - l * l).sqrt() + random.perpendicular(direction) * l);
        add(batch, DVec3::ZERO, direction, &[(center, scale)]);
    })
}

pub(super) fn tangent(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        // Where the body is the unit sphere.
        let (scale, direction) = (egg(random), random.unit());
        let l = near_tangent(random);
        let center = direction * random.within(3.0, 7.0) + random.perpendicular(direction) * l;
        let origin = random.in_box(2.0);
        add(batch, origin, scale * direction, &[(origin + scale * center, scale)]);
    })
}

/// Bodies of a box that secondary rays see, and rays that share a box.
const BOX_BODIES: u32 = 32;
const BOX_RAYS: usize = 1000;

pub(super) fn secondary(random: &mut Random, count: usize) -> Batch {
    let mut batch = Batch::default();
    for index in 0..count {
        let first = (index / BOX_RAYS) as u32 * BOX_BODIES;
        if index.is_multiple_of(BOX_RAYS) {
            for body in 0..BOX_BODIES {
                let scale = DVec3::splat(random.within(0.1, 2.0));
                let scale = if body % 2 == 0 { scale } else { scale * egg(random) / 3.0 };
                batch.surfaces.push(Surface { center: carried(random.in_box(10.0)), scale: carried(scale) });
            }
        }
        let others = &batch.surfaces[first as usize..];
        let (own, place, origin) = loop {
            let own = (random.bits() % u64::from(BOX_BODIES)) as usize;
            let place = random.unit();
            let origin = carried(others[own].center + others[own].scale * place);
            let height = |other: &Surface| (((origin - other.center) / other.scale).length() - 1.0).abs();
            // Origins near surfaces are another class.
            if others.iter().enumerate().all(|(index, other)| index == own || height(other) > 1e-2) {
                break (own, place, origin);
            }
        };
        let scale = others[own].scale;
        let direction = random.unit();
        let direction = if direction.dot(place / scale) < 0.0 { -direction } else { direction };
        batch.rays.push(ProbeRay {
            origin,
            direction: carried(direction),
            first,
            end: first + BOX_BODIES,
            primary: false,
            own: Some(first + own as u32),
        });
    }
    batch
}

/// The Earth as it is, flattened at its poles, with the eye one metre above it.
pub(super) fn earth(random: &mut Random, count: usize) -> Batch {
    const SCALE: DVec3 = DVec3::new(6_378_137.0, 6_378_137.0, 6_356_752.314);
    each(count, |batch, _| {
        let place = random.unit();
        let up = (place / SCALE).normalize();
        // The horizon is 5.6e-4 below the horizontal.
        let dip = random.within(0.0, 2e-3);
        let direction = random.perpendicular(up) * dip.cos() - up * dip.sin();
        add(batch, DVec3::ZERO, of_any_length(random, direction), &[(-(place * SCALE + up), SCALE)]);
    })
}

pub(super) fn above(random: &mut Random, count: usize, axes: Axes) -> Batch {
    each(count, |batch, _| {
        let (scale, center) = (axes(random), random.in_box(2.0));
        let height = random.sign() * random.magnitude(-7.0, -2.0);
        let origin = center + scale * random.unit() * (1.0 + height);
        let direction = random.unit();
        add(batch, origin, of_any_length(random, direction), &[(center, scale)]);
    })
}

/// An ellipsoid seen from a distance of five times its greatest semi-axis.
pub(super) fn seen(random: &mut Random, count: usize, proportions: DVec3) -> Batch {
    each(count, |batch, _| {
        let (scale, center) = (shaped(random, proportions), random.in_box(2.0));
        let origin = center + random.unit() * (5.0 * scale.max_element());
        let direction = (center + scale * random.in_ball() * 1.2 - origin).normalize();
        add(batch, origin, direction, &[(center, scale)]);
    })
}

pub(super) fn needle(random: &mut Random, count: usize) -> Batch {
    seen(random, count, DVec3::new(1e-2, 1.0, 100.0))
}

pub(super) fn needle_eye(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let scale = shaped(random, DVec3::new(1e-2, 1.0, 100.0));
        let center = random.unit() * (5.0 * scale.max_element());
        let direction = (center + scale * random.in_ball() * 1.2).normalize();
        add(batch, DVec3::ZERO, direction, &[(center, scale)]);
    })
}

pub(super) fn disc_from_near(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let scale = shaped(random, DVec3::new(1.0, 1.0, 1e-4));
        let center = random.in_box(2.0);
        let across = random.in_ball() * 0.7;
        let origin = center + scale * DVec3::new(across.x, across.y, 2.0);
        let direction = (center + scale * random.in_ball() * 1.2 - origin).normalize();
        add(batch, origin, direction, &[(center, scale)]);
    })
}

pub(super) fn translated(random: &mut Random, count: usize) -> Batch {
    let place = DVec3::new(1e6, -1e6, 1e6);
    each(count, |batch, _| {
        let (scale, center) = (ball(random), place + random.in_box(2.0));
        let origin = center + random.unit() * (5.0 * scale.x);
        let direction = center + scale * random.in_ball() * 1.3 - origin;
        add(batch, origin, of_any_length(random, direction), &[(center, scale)]);
    })
}

/// Two bodies around one centre, either of them first.
pub(super) fn concentric(random: &mut Random, count: usize, gap: f64) -> Batch {
    each(count, |batch, index| {
        let scale = if index % 4 < 2 { ball(random) } else { egg(random) };
        let center = random.in_box(2.0);
        let origin = center + random.unit() * (5.0 * scale.max_element());
        let direction = (center + scale * random.in_ball() - origin).normalize();
        let (inner, outer) = ((center, scale), (center, scale * (1.0 + gap)));
        add(batch, origin, direction, &if index % 2 == 0 { [inner, outer] } else { [outer, inner] });
    })
}

/// Two balls that touch from inside, met where they touch: t is the same to the last bit in every precision.
pub(super) fn internally_tangent(random: &mut Random, count: usize) -> Batch {
    each(count, |batch, _| {
        let mut whole = |most: u64| (1 + random.bits() % most) as f64 / 8.0;
        let (distance, radii) = (whole(64), [whole(64), whole(64)]);
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][(random.bits() % 3) as usize] * random.sign();
        let center = DVec3::new(whole_in(random), whole_in(random), whole_in(random));
        let surface = |radius: f64| (center + axis * (distance + radius), DVec3::splat(radius));
        add(batch, center, axis, &radii.map(surface));
    })
}

/// A number of few bits.
fn whole_in(random: &mut Random) -> f64 {
    (random.bits() % 64) as f64 / 4.0 - 8.0
}

/// The ordinary world times 2 to a power, which keeps every digit.
pub(super) fn sized(random: &mut Random, count: usize, power: i32) -> Batch {
    let mut batch = at_distance(random, count, 7.0, egg);
    let k = 2_f64.powi(power);
    for ray in &mut batch.rays {
        (ray.origin, ray.direction) = (ray.origin * k, ray.direction * k);
    }
    for surface in &mut batch.surfaces {
        (surface.center, surface.scale) = (surface.center * k, surface.scale * k);
    }
    batch
}

pub(super) fn inside(random: &mut Random, count: usize, axes: Axes) -> Batch {
    each(count, |batch, _| {
        let (scale, center) = (axes(random), random.in_box(2.0));
        let origin = center + scale * random.in_ball() * 0.9;
        let direction = random.unit();
        add(batch, origin, of_any_length(random, direction), &[(center, scale)]);
    })
}

pub(super) fn cut(random: &mut Random, count: usize) -> Batch {
    let mut batch = each(count, |batch, _| {
        let direction = DVec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), -1.0);
        let scale = ball(random);
        add(batch, DVec3::ZERO, direction, &[(direction + scale * random.in_ball() * 0.95, scale)]);
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

/// Segments from 0 to 1 that end near a body, before or behind it, begin near one, or pass by one; and such that leave a body.
pub(super) fn segments(random: &mut Random, count: usize, axes: Axes) -> Batch {
    each(count, |batch, index| {
        let origin = random.in_box(2.0);
        let direction = random.unit() * random.magnitude(-1.0, 1.0);
        let scale = axes(random);
        // Where a ray in this direction meets the body, seen from its centre.
        let line = (direction / scale).normalize();
        let aside = random.within(0.0, 0.95);
        let across = random.perpendicular(line) * aside;
        let half_chord = line * (1.0 - aside * aside).sqrt();
        let gap = random.sign() * random.magnitude(-4.0, -1.0);
        let center = match index % 4 {
            0 => origin + direction * (1.0 + gap) - scale * (across - half_chord),
            1 => origin + direction * gap - scale * (across + half_chord),
            2 => {
                origin + direction * random.within(-0.5, 1.5)
                    - scale * random.perpendicular(line) * near_tangent(random)
            }
            _ => origin + direction * random.within(-0.5, 1.5) - scale * random.in_ball() * 1.5,
        };
        if index % 8 < 4 {
            add(batch, origin, direction, &[(center, scale)]);
            return;
        }
        let own = axes(random);
        let place = random.unit();
        let place = if place.dot(direction / own) < 0.0 { -place } else { place };
        add(batch, origin, direction, &[(center, scale), (origin - own * place, own)]);
        if let Some(ray) = batch.rays.last_mut() {
            ray.own = Some(ray.end - 1);
        }
    })
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

/// Index of refraction of crown glass, with digits that f32 holds.
pub(super) const GLASS: f64 = 1.517_578_125;

/// Rays that go into a body of glass at the origin, or start in it, with a screen of glass around; the screen is met in the end.
pub(super) fn through(
    random: &mut Random,
    count: usize,
    axes: Axes,
    born_inside: bool,
    eta: f64,
    bounces: u32,
) -> Batch {
    let glass = |batch: &mut Batch, random: &mut Random| {
        let scale = axes(random);
        let target = random.in_ball() * scale;
        let origin =
            if born_inside { random.in_ball() * 0.9 * scale } else { random.unit() * 5.0 * scale.max_element() };
        let direction = of_any_length(random, target - origin);
        let center = random.in_box(2.0);
        let greatest = scale.max_element();
        let screen = (center + random.in_box(0.5 * greatest), DVec3::splat(random.within(18.0, 22.0) * greatest));
        add(batch, center + origin, direction, &[(center, scale), screen]);
    };
    Batch { bounces, eta, ..each(count, |batch, _| glass(batch, random)) }
}

/// Out of a ball or an ellipsoid near the critical angle.
pub(super) fn critical(random: &mut Random, count: usize) -> Batch {
    let out = |batch: &mut Batch, index: usize| {
        let scale = if index.is_multiple_of(2) { ball(random) } else { egg(random) };
        let place = random.unit();
        let normal = (place / scale).normalize();
        let sine = (1.0 - random.sign() * random.magnitude(-12.0, -2.0)).sqrt() / GLASS;
        let direction = normal * (1.0 - sine * sine).sqrt() + random.perpendicular(normal) * sine;
        let (center, place) = (random.in_box(2.0), scale * place);
        let origin = center + place - direction * (scale.min_element() * random.within(0.1, 0.5));
        let screen = (center, DVec3::splat(random.within(18.0, 22.0)));
        add(batch, origin, of_any_length(random, direction), &[(center, scale), screen]);
    };
    Batch { bounces: 1, eta: GLASS, ..each(count, out) }
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

/// Lights near the mirror image of the ray.
pub(super) fn highlights(random: &mut Random, count: usize) -> (Batch, Vec<bool>) {
    let mut batch = Batch { exponent: 50.0, ..Batch::default() };
    for index in 0..count {
        let scale = if index.is_multiple_of(2) { ball(random) } else { egg(random) };
        let (center, place) = (random.in_box(2.0), random.unit());
        let normal = (place / scale).normalize();
        let (origin, direction) = view(random, DVec3::ZERO, normal);
        let image = direction - normal * (2.0 * direction.dot(normal));
        let to_light = image + random.in_ball() * random.magnitude(-4.0, 0.0);
        let to_light = if to_light.dot(normal) > 0.0 { to_light } else { image };
        let place = center + scale * place;
        add(&mut batch, place + origin, direction, &[(center, scale)]);
        batch.lights.push(carried(place + to_light * random.magnitude(0.0, 2.0)));
    }
    (batch, Vec::new())
}

/// A small ball at `gap` radii above a larger one, in the light of which the ray's hit lies or does not.
pub(super) fn contact(random: &mut Random, count: usize, gap: f64) -> (Batch, Vec<bool>) {
    let mut lit = Vec::with_capacity(count);
    let mut batch = Batch::default();
    for _ in 0..count {
        let (center, scale) = (random.in_box(2.0), ball(random));
        let radius = scale.x;
        let normal = random.unit();
        let small = random.magnitude(-4.0, -1.0);
        let across = random.perpendicular(normal);
        let is_lit = random.bits() & 1 == 0;
        let offset = small * if is_lit { random.within(1.2, 3.0) } else { random.within(0.4, 0.8) };
        let place = center + (normal * (1.0 - offset * offset).sqrt() + across * offset) * radius;
        let blocker = center + normal * ((1.0 + gap + small) * radius);
        // Seen from beside the blocker, lit from straight above it.
        let towards = (across * 0.8 + normal * 0.6).normalize();
        let surfaces = [(center, scale), (blocker, DVec3::splat(small * radius))];
        add(&mut batch, place + towards * (5.0 * radius), -towards, &surfaces);
        batch.lights.push(carried(place + normal * (10.0 * radius)));
        lit.push(is_lit);
    }
    (batch, lit)
}

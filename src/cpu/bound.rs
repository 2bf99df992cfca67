//! How far rounding may have moved what a renderer calculates, carried along by that renderer itself; read it beside
//! `shaders/bound_cone.wgsl`.
//!
//! A ray is known as a cone: its origin to `position`, in world units, its direction to `direction`, as an angle. At every
//! decision the cone has to lie on one side; where it does not, the pixel is marked. So is one whose colour is not known well
//! enough to name its level. What is not marked is what exact arithmetic gives.
//!
//! Bounds are to first order, with the second order where surfaces are grazed or strongly bent; `src/roundings.rs` has how many
//! roundings add up.

use std::cmp::Ordering;

use super::decision::Decision;
use super::intersect::{Approach, Crossing, Hit, Own, Range, Ray};
use super::margin::normal_error;
use super::real::Real;
use super::refract::Snell;
use super::render::Levels;
use super::scene::{PointLight, Shape, World};
use super::shade::{LightTerms, Surface, max, min, specular_power};
use super::vec3::{Vec3, largest, length};
use super::witness::Witness;
use crate::brightness::Scalar;
use crate::roundings::{
    ALONG, ANGLE, AXES, LENGTH, LOCAL, LOST, NEAR, NOTHING, PLACE, POWER, ROOT, ROOT_AT_EDGE, SQUARE, TERM,
};
use crate::settings::Specular;

/// An ellipsoid whose semi-axes differ by no more than this factor is nearly a sphere: a simple bound of its normal, which grows by the
/// square of the factor from bounce to bounce, does.
const ROUND: f64 = 4.0;

/// What is known of a ray: the cone around it.
#[derive(Debug, Clone, Copy)]
struct Cone<T> {
    /// Error of the origin, in world units.
    position: T,
    /// Error of the direction, as an angle.
    direction: T,
}

/// The bound of one sample, while it is traced in `T`.
///
/// That of a `PROOF` is the reference's own: errors of colours are left out, rays from the eye touch spheres where exact arithmetic says
/// so, what is in doubt all but on a tie is taken for one, and the scene's numbers are the decimals of its file.
#[derive(Debug, Clone)]
pub(crate) struct Bound<T, const PROOF: bool> {
    /// Unit roundoff.
    u: T,
    /// Roundings of a place on its way into object space, as a part of its distance, and as a part of the radius with those of its square.
    place: T,
    local: T,
    /// What of the centre as an input is not counted with these.
    center: T,
    /// Of all places: what rounding takes when the eye moves to the origin.
    moved: T,
    cone: Cone<T>,
    /// Of the refraction rays that wait.
    waiting: Vec<(Cone<T>, T)>,
    /// The width of the cone at t is `base` + |t|·`slope`, in world units;
    base: T,
    slope: T,
    /// and in a proof no greater than this at any sphere.
    wide: T,
    /// A ball around all spheres, for that.
    middle: Vec3<T>,
    extent: T,
    /// Of the search in hand: the least distance at which any ray of the cone may meet a sphere, and the least of another one;
    first: T,
    second: T,
    /// with the sphere of the first;
    first_shape: Option<Shape<T>>,
    /// the greatest squared error of such a distance, or in a proof the error itself, and that of the own sphere's.
    error: T,
    exit: T,
    /// What makes the second unsure.
    cause: Decision,
    /// Of the shadow ray in hand.
    is_blocked: bool,
    may_be_blocked: bool,
    /// Error of the unit normal of the surface in hand.
    normal: T,
    /// Of the light in hand: the error of N·L, and that of the direction to it.
    light: [T; 2],
    shows_light: bool,
    /// Whether the colour has its first product of constants.
    is_begun: bool,
    /// Weight of the ray in hand.
    throughput: T,
    /// How far the colour may be off, and the sizes of all its terms but a first product of constants: of the channels the greatest.
    color: T,
    sizes: T,
    /// The first decision that the cone does not leave sure.
    pub unsure: Option<Decision>,
}

impl<T: Real, const PROOF: bool> Bound<T, PROOF> {
    /// Of rays in `world`, none of which has begun.
    pub(crate) fn new(world: &World<T>) -> Self {
        let (zero, u) = (T::ZERO, T::from_f64(T::UNIT));
        // The host rounds decimals, and moves the eye to the origin.
        let of_host = T::UNIT.min(Scalar::Double.unit());
        Self {
            u,
            place: T::from_f64(if world.ellipsoids { PLACE + AXES } else { PLACE }) * u + T::from_f64(of_host),
            local: T::from_f64(if world.ellipsoids { LOCAL + AXES + SQUARE } else { LOCAL + SQUARE }) * u,
            center: if world.ellipsoids { u } else { zero },
            moved: T::from_f64(world.moved * (of_host / Scalar::Double.unit())),
            cone: Cone { position: zero, direction: zero },
            waiting: Vec::new(),
            base: zero,
            slope: zero,
            wide: zero,
            middle: world.middle,
            extent: world.extent,
            first: T::FAR,
            second: T::FAR,
            first_shape: None,
            error: zero,
            exit: zero,
            cause: Decision::Tie,
            is_blocked: false,
            may_be_blocked: false,
            normal: zero,
            light: [zero; 2],
            shows_light: true,
            is_begun: false,
            throughput: T::ONE,
            color: zero,
            sizes: zero,
            unsure: None,
        }
    }

    /// Begins with a primary ray whose origin is known to `position` and whose direction to `direction`.
    #[inline]
    pub(crate) fn begin(&mut self, [position, direction]: [T; 2]) {
        self.cone = Cone { position, direction };
        self.waiting.clear();
        self.is_begun = false;
        self.throughput = T::ONE;
        self.color = T::ZERO;
        self.sizes = T::ZERO;
        self.unsure = None;
    }

    #[inline]
    fn roundings(&self, count: f64) -> T {
        T::from_f64(count) * self.u
    }

    #[inline]
    fn mark(&mut self, decision: Decision) {
        self.unsure.get_or_insert(decision);
    }

    /// Half the width of the cone at `t`, in the object space of `shape`, with the rounding on the way there.
    #[inline]
    pub(super) fn width(&self, shape: &Shape<T>, t: T) -> T {
        largest(shape.inv_scale) * (self.base + t.abs() * self.slope + self.center * size(shape.center))
            + self.local * shape.radius
    }

    /// How far the discriminant may be off where the line is about a radius from the centre.
    #[inline]
    pub(super) fn reach(&self, shape: &Shape<T>, at: &Approach<T>) -> T {
        let width = if PROOF {
            largest(shape.inv_scale) * self.wide + self.local * shape.radius
        } else {
            self.width(shape, at.b / at.a)
        };
        two::<T>() * width * (shape.radius + width)
    }

    /// Likewise, to the side where the ray passes: long axes count less there.
    #[inline]
    fn reach_aside(&self, shape: &Shape<T>, at: &Approach<T>) -> T {
        let t = at.b / at.a;
        let width = self.width(shape, t);
        let gradient = at.perpendicular * shape.inv_scale;
        let world = self.base + t.abs() * self.slope + self.center * size(shape.center);
        let rounding = self.place * (t.abs() * at.a.sqrt()) + self.local * shape.radius;
        two::<T>() * (length(gradient) * world + length(at.perpendicular) * rounding + width * width)
    }

    /// Whether it is in doubt that the line meets the sphere.
    #[inline]
    pub(super) fn is_edge(&self, shape: &Shape<T>, at: &Approach<T>, reach: T) -> bool {
        // NaN is in doubt.
        !(at.discriminant.abs() > reach) && !(at.discriminant.abs() > self.reach_aside(shape, at))
    }

    /// A sphere is met from `t` on; where that is in doubt, it counts as two.
    #[inline]
    fn push(&mut self, t: T, is_doubt: bool, cause: Decision, shape: &Shape<T>) {
        if t == self.first && self.first_shape.is_some_and(|first| is_same(&first, shape)) {
            return;
        }
        if is_doubt {
            self.cause = cause;
            self.second = min(self.second, t);
        }
        if t < self.first {
            (self.second, self.first) = (min(self.second, self.first), t);
            self.first_shape = Some(*shape);
        } else {
            self.second = min(self.second, t);
        }
    }

    /// Hits so near to one at `t` tie with it.
    #[inline]
    pub(super) fn tie(&self, t: T) -> T {
        let error = if PROOF { self.error } else { self.error.sqrt() };
        T::from_f64(2.0 * ROOT_AT_EDGE) * error + self.exit + self.roundings(ROOT) * t.abs()
    }

    /// Error of the distance at which a ray leaves its own sphere.
    pub(super) fn exit_error(&self, ray: &Ray<T>, shape: &Shape<T>) -> T {
        let length = length(ray.direction * shape.inv_scale);
        let stretch = largest(shape.inv_scale);
        let place = stretch * self.base + self.local * shape.radius;
        two::<T>() * (place + T::from_f64(3.0) * shape.radius * (stretch * self.slope / length)) / length
    }

    /// What is known of the surface of a sphere, or of an ellipsoid that is nearly one, in a proof: in object space, where lengths are
    /// known beforehand or have simple bounds.
    #[inline]
    fn round_surface(&mut self, world: &World<T>, hit: &Hit<T>, at: &Approach<T>) {
        let shape = &world.shapes[hit.sphere];
        let (stretch, greatest) = (largest(shape.inv_scale), largest(world.materials[hit.sphere].scale));
        let radius = shape.radius;
        let way = size(at.origin) + radius;
        let world_width = self.base + hit.t.abs() * self.slope + self.center * size(shape.center);
        let stretched = stretch * world_width + self.place * way + self.local * radius;
        let reach = two::<T>() * stretched * (radius + stretched);
        let rest = at.discriminant - reach;
        let aside = if rest > T::ZERO {
            T::from_f64(0.5) * reach / rest.sqrt()
        } else {
            T::from_f64(ROOT_AT_EDGE) * reach.sqrt() + stretched
        };
        let along = aside + self.roundings(ALONG) * (way + radius);
        // The radius is at least 1, and so the gradient no shorter than the least stretch.
        let turned = if world.ellipsoids { along * stretch / least(shape.inv_scale) } else { along };
        self.normal = turned + self.roundings(ANGLE);
        let place = size(shape.center) + greatest * radius;
        self.cone.position = greatest * along + self.roundings(ANGLE) * place + self.moved;
    }

    /// Whether N·L is so far from 0 that no more needs to be known, in a proof.
    #[inline]
    fn is_far_from_terminator(&self, light: &PointLight<T>, position: Vec3<T>, n_dot_l: T) -> bool {
        let place = self.roundings(ANGLE) * (size(light.position) + size(position)) + self.moved;
        // No more than the distance.
        let distance = largest(absolute(light.position - position));
        let rest = min(n_dot_l.abs(), T::from_f64(LOST)) - self.normal - self.roundings(32.0);
        two::<T>() * (self.cone.position + place) < distance * (rest - self.normal)
    }

    /// Adds a term of this size to the colour, with its error.
    fn add_term(&mut self, size: T, error: T) {
        let weight = self.throughput.abs();
        self.sizes += size * weight;
        self.color += error * weight + self.roundings(TERM) * (size * weight) + self.u * self.sizes;
    }

    /// How far this colour may be off in each channel.
    pub(crate) fn error_of(&self, color: Vec3<T>) -> T {
        self.color + self.roundings(TERM) * largest(absolute(color))
    }

    /// Whether all colours as near to this one as it is known have the same levels; `others` is the unit roundoff of the renderer that
    /// it is held against, as a part of this one's.
    pub(crate) fn has_sure_levels(&self, color: Vec3<T>, levels: &Levels<T>, others: T) -> bool {
        if self.sizes == T::ZERO {
            // A product of constants: the host has its levels.
            return true;
        }
        levels.are_equal(color, self.error_of(color) * (T::ONE + others), self.u)
    }
}

impl<T: Real, const PROOF: bool> Witness<T> for Bound<T, PROOF> {
    #[inline]
    fn search(&mut self, ray: &Ray<T>, light: bool) {
        let place = self.place;
        let length = if PROOF { size(ray.direction) } else { length(ray.direction) };
        let origin = size(ray.origin);
        if light {
            // Both ends of the way are known.
            self.base = self.cone.position + self.moved + place * (origin + length);
            self.slope = place * length;
        } else {
            self.base = self.cone.position + self.moved + place * origin;
            self.slope = length * (self.cone.direction + place);
        }
        if PROOF {
            // No sphere is farther from where the ray begins; a shadow ray ends at t = 1.
            let ahead = two::<T>() * self.extent + size(ray.origin - self.middle);
            let along = if light { self.slope } else { ahead * (self.cone.direction + place) };
            self.wide = self.base + along + self.center * (ahead + origin);
        }
        (self.first, self.second) = (T::FAR, T::FAR);
        (self.error, self.exit) = (T::ZERO, T::ZERO);
        self.first_shape = None;
        self.cause = Decision::Tie;
        self.is_blocked = false;
        self.may_be_blocked = false;
    }

    #[inline]
    fn tested(
        &mut self,
        _ray: &Ray<T>,
        shape: &Shape<T>,
        at: &Approach<T>,
        range: &Range<T>,
        sign: Option<Ordering>,
        root: Option<(T, bool)>,
    ) {
        let sign = sign.filter(|_| PROOF);
        if sign == Some(Ordering::Less) {
            return;
        }
        let reach = self.reach(shape, at);
        if at.discriminant < -reach {
            return;
        }
        let radius_squared = shape.radius * shape.radius;
        // The squared distance of the place where roots begin to count.
        let start = at.origin.dot(at.origin) - radius_squared - range.t_min * (at.b + at.b - range.t_min * at.a);
        let is_near = !(start.abs() > near(reach));
        let is_behind = at.b <= at.a * range.t_min;
        if !is_near && is_behind && (start > T::ZERO || !range.greater) {
            return;
        }
        let closest = at.b / at.a;
        if is_near {
            self.push(range.t_min, true, Decision::NearPlane, shape);
        } else if sign.is_none() && self.is_edge(shape, at, reach) {
            self.push(max(closest - shape.radius / at.a.sqrt(), range.t_min), true, Decision::Silhouette, shape);
        } else if (sign.is_some() || at.discriminant > T::ZERO) && (start > T::ZERO || range.greater) {
            let t = match root {
                Some((t, _)) if PROOF => t,
                _ => {
                    let half_chord = (max(at.discriminant, T::ZERO) / at.a).sqrt();
                    if start > T::ZERO { closest - half_chord } else { closest + half_chord }
                }
            };
            self.push(t, false, Decision::Tie, shape);
            let squared = reach / at.a;
            self.error = max(self.error, if PROOF { root_error(squared, (closest - t).abs()) } else { squared });
        }
    }

    #[inline]
    fn tested_own(&mut self, ray: &Ray<T>, own: &Own<T>, shape: &Shape<T>, t: T, range: &Range<T>) {
        if !own.inside {
            return;
        }
        let error = self.exit_error(ray, shape);
        let is_near = |end: T| !((t - end).abs() > error);
        if range.t_max == T::ONE {
            if is_near(range.t_min) || is_near(T::ONE) {
                self.may_be_blocked = true;
            } else if t > range.t_min && t < T::ONE {
                self.is_blocked = true;
            }
        } else if is_near(range.t_min) {
            self.push(range.t_min, true, Decision::Epsilon, shape);
        } else if t > range.t_min {
            self.push(t, false, Decision::Tie, shape);
            self.exit = error;
        }
    }

    #[inline]
    fn crossed(&mut self, _ray: &Ray<T>, shape: &Shape<T>, crossing: &Crossing<T>, blocks: bool, t_min: T) -> bool {
        let Crossing { at, start_squared, end_squared } = crossing;
        let reach = self.reach(shape, at);
        if at.discriminant < -reach {
            return false;
        }
        let is_near = |squared: T| !((squared - shape.radius * shape.radius).abs() > near(reach));
        let passes = at.b > at.a * t_min && at.b < at.a;
        if (passes && self.is_edge(shape, at, reach)) || is_near(*start_squared) || is_near(*end_squared) {
            self.may_be_blocked = true;
            return false;
        }
        self.is_blocked |= blocks;
        blocks
    }

    #[inline]
    fn nearest(
        &mut self,
        world: &World<T>,
        ray: &Ray<T>,
        _own: Option<&Own<T>>,
        _range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        // NaN is in doubt.
        let is_unsure = self.second < T::FAR && hit.is_none_or(|hit| !(self.second - hit.t > self.tie(hit.t)));
        if is_unsure {
            self.mark(self.cause);
        }
        // Lists of spheres take a ray for what it is but for so much.
        let width = match &hit {
            Some(hit) => self.base + hit.t.abs() * self.slope,
            None if PROOF => self.wide,
            None => {
                let along = (ray.origin - world.middle).dot(ray.direction) / length(ray.direction);
                self.base + max(world.extent - along, T::ZERO) * (self.cone.direction + self.place)
            }
        };
        if !(width <= world.allowance) {
            self.mark(Decision::Silhouette);
        }
        hit
    }

    #[inline]
    fn background(&mut self, world: &World<T>) {
        if !PROOF && self.is_begun {
            self.add_term(largest(absolute(world.background)), T::ZERO);
        }
    }

    fn surface(&mut self, world: &World<T>, ray: &Ray<T>, hit: &Hit<T>, at: &Approach<T>, surface: &Surface<T>) {
        let shape = &world.shapes[hit.sphere];
        if PROOF && (!world.ellipsoids || largest(shape.inv_scale) < T::from_f64(ROUND) * least(shape.inv_scale)) {
            self.round_surface(world, hit, at);
            return;
        }
        let material = &world.materials[hit.sphere];
        let local = surface.own.local;
        let t = hit.t.abs();
        // |D·local|, the gradient in the world of half the squared distance from the centre.
        let gradient = length(local * shape.inv_scale);
        let world_width = self.base + t * self.slope + self.center * size(shape.center);
        let rounding = self.place * (t * at.a.sqrt()) + self.local * shape.radius;
        let stretched = largest(shape.inv_scale) * world_width + rounding;
        let reach = two::<T>() * (gradient * world_width + shape.radius * rounding + stretched * stretched);
        let rest = at.discriminant - reach;
        let greatest = largest(material.scale);
        let aside = if rest > T::ZERO {
            // w/|N·d| with N·d = √(a·discriminant)/|g|, of the least discriminant.
            let slant = length(ray.direction) / (at.a * rest).sqrt();
            slant * (T::from_f64(0.5) * reach)
        } else if PROOF {
            // The ray meets the sphere: half the chord is good to the root of its square's error.
            greatest * (T::from_f64(ROOT_AT_EDGE) * reach.sqrt() + stretched)
        } else {
            self.mark(Decision::Silhouette);
            T::FAR
        };
        // How far the closest approach, and so the hit, is off along the ray is seen from the former: it is at right angles to the ray.
        let shifted = greatest
            * (at.perpendicular.dot(at.direction).abs() / at.a.sqrt() + self.roundings(LENGTH + ANGLE) * shape.radius);
        let turned = if world.ellipsoids {
            normal_error(shape, local, aside + shifted, world_width + shifted, T::ZERO)
        } else {
            // Along the ray a normal turns by no more than where the ray is aslant.
            let aslant = max(T::ONE - at.discriminant / (shape.radius * shape.radius), T::ZERO).sqrt();
            shape.inv_scale.x * (aside + aslant * shifted) / shape.radius
        };
        self.normal = turned + self.roundings(ANGLE);
        let place = size(shape.center) + greatest * shape.radius;
        self.cone.position = aside + shifted + self.roundings(ANGLE) * place + self.moved;
        if PROOF {
            return;
        }
        if self.is_begun {
            self.add_term(largest(absolute(world.ambient * material.color)) * material.ka.abs(), T::ZERO);
        }
        self.is_begun = true;
    }

    #[inline]
    fn lit(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, n_dot_l: T, is_lit: bool) -> bool {
        let material = &world.materials[surface.sphere];
        self.shows_light = material.kd != T::ZERO || material.ks != T::ZERO;
        if !self.shows_light {
            return is_lit;
        }
        if PROOF && self.is_far_from_terminator(light, surface.position, n_dot_l) {
            return is_lit;
        }
        let place = self.roundings(ANGLE) * (size(light.position) + size(surface.position)) + self.moved;
        let distance = length(light.position - surface.position);
        let direction = (self.cone.position + place) / distance + self.roundings(ANGLE);
        let angle = self.normal + direction;
        // cos changes by sin·dα + ½dα², and with the lengths of both unit vectors.
        let sine = max(T::ONE - n_dot_l * n_dot_l, T::ZERO).sqrt();
        let cosine = sine * angle + angle * angle + self.roundings(2.0 * LENGTH + ANGLE) * n_dot_l.abs();
        self.light = [cosine, direction];
        // NaN is in doubt.
        let is_unsure = !(angle < T::from_f64(LOST)) || !(n_dot_l.abs() > cosine);
        if is_unsure {
            self.mark(Decision::Terminator);
        }
        is_lit && !(is_unsure && is_tie::<T, PROOF>(n_dot_l))
    }

    #[inline]
    fn blocked(&mut self, world: &World<T>, _ray: &Ray<T>, _own: &Own<T>, is_blocked: bool) -> bool {
        let is_lost = !(self.cone.position <= world.light_allowance);
        if self.shows_light && (is_lost || (self.may_be_blocked && !self.is_blocked)) {
            self.mark(Decision::ShadowEdge);
        }
        is_blocked
    }

    fn shaded(&mut self, world: &World<T>, surface: &Surface<T>, light: &PointLight<T>, terms: &LightTerms<T>) {
        if PROOF {
            return;
        }
        let material = &world.materials[surface.sphere];
        let [cosine_error, light_error] = self.light;
        let diffuse = largest(absolute(light.intensity * material.color)) * material.kd.abs();
        self.add_term(diffuse, diffuse * cosine_error);

        let angle_error = match world.specular {
            // The mirrored vector turns with what is wrong in the length of the normal, twice as much.
            Specular::Phong => {
                two::<T>() * self.normal + light_error + self.cone.direction + self.roundings(4.0 * LENGTH + ANGLE)
            }
            // The sum of two unit vectors turns by what they turn and by what is wrong in their lengths, over its own.
            Specular::Blinn => {
                let sum = length(terms.to_light + surface.view);
                let parts = light_error + self.cone.direction + self.roundings(2.0 * LENGTH + ANGLE);
                self.normal + parts / sum + self.roundings(2.0 * LENGTH + ANGLE)
            }
        };
        let power = power_error(terms.d, material.n, angle_error, specular_power(terms.d, material.n), self.u);
        let intensity = largest(absolute(light.intensity));
        self.add_term(intensity * terms.specular.abs(), intensity * material.ks.abs() * power);
    }

    #[inline]
    fn reflected(&mut self, throughput: T) {
        let turn = self.normal + self.roundings(LENGTH + ANGLE);
        self.cone.direction += two::<T>() * turn;
        self.throughput = throughput;
    }

    fn refracted(&mut self, _world: &World<T>, _surface: &Surface<T>, snell: Snell<T>, throughput: T) -> Snell<T> {
        let Snell { ratio, cosine, square, bend } = snell;
        let sine_squared = max(T::ONE - cosine * cosine, T::ZERO);
        // The angle between ray and normal is off by so much, its cosine by sin·dα + ½dα².
        let angle = self.cone.direction + self.normal + self.roundings(ANGLE);
        let cosine_error = sine_squared.sqrt() * angle + angle * angle + self.roundings(2.0 * LENGTH + ANGLE) * cosine;
        let ratio_error = if ratio == T::ONE { T::ZERO } else { self.roundings(4.0) * ratio };
        // k = 1 − r²(1 − c²).
        let along = ratio * cosine;
        let square_error = two::<T>() * ratio * ratio * cosine * cosine_error
            + ratio * ratio * cosine_error * cosine_error
            + two::<T>() * ratio * sine_squared * ratio_error
            + self.roundings(2.0 * ANGLE) * max(along * along, (ratio * ratio - T::ONE).abs());
        let mut snell = snell;
        if !(square.abs() > square_error) {
            self.mark(Decision::CriticalAngle);
            if is_tie::<T, PROOF>(square) {
                snell.square = T::ZERO;
            }
        }
        let direction = if snell.is_total() {
            self.cone.direction + two::<T>() * (self.normal + self.roundings(LENGTH + ANGLE))
        } else {
            // The derivatives of the bend r·c − √k by c and by r, of the least k.
            let root = max(square - square_error, T::from_f64(if PROOF { 1e-200 } else { 1e-30 })).sqrt();
            ratio * self.cone.direction
                + bend.abs() * self.normal
                + ratio * (bend.abs() / root) * cosine_error
                + (two::<T>() + ratio * sine_squared / root) * ratio_error
                + self.roundings(2.0 * LENGTH + ANGLE) * (bend.abs() + ratio)
        };
        self.waiting.push((Cone { direction, ..self.cone }, throughput));
        snell
    }

    fn resumed(&mut self) {
        if let Some((cone, throughput)) = self.waiting.pop() {
            (self.cone, self.throughput) = (cone, throughput);
        }
    }
}

/// How near to a surface the end of a ray, squared, has to lie for its side to be in doubt: the width at the closest approach, which
/// `reach` is of, does for that of the end.
fn near<T: Real>(reach: T) -> T {
    T::from_f64(0.5 * NEAR) * reach
}

/// The least component.
fn least<T: Real>(v: Vec3<T>) -> T {
    min(v.x, min(v.y, v.z))
}

/// Whether a number that is known to differ from 0 by no more than its error is taken for 0: by who has the last word, where it is near
/// enough.
fn is_tie<T: Real, const PROOF: bool>(x: T) -> bool {
    PROOF && x.abs() < T::from_f64(T::TIE)
}

/// Error of half a chord whose square is off by `squared`: |√x − √y| ≤ |x − y|/√x.
fn root_error<T: Real>(squared: T, half_chord: T) -> T {
    if half_chord * half_chord > squared { squared / half_chord } else { squared.sqrt() }
}

/// Error of this power, cosⁿ, where 1 − cos is `d` and the angle is off by `angle`.
///
/// The chord of the angle is √2d and moves by no more than it does. The logarithm of the power moves by no more than
/// x = n·Δd/(1 − d − Δd), and the power by the factor eˣ, which is at most 1 + x + x² for x ≤ 1.
fn power_error<T: Real>(d: T, n: T, angle: T, power: T, u: T) -> T {
    let change = (two::<T>() * d).sqrt() * angle + T::from_f64(0.5) * angle * angle;
    let least = T::ONE - d - change;
    let greatest = T::ONE - d + change;
    if greatest <= T::ZERO || n <= T::ZERO {
        return T::ZERO;
    }
    let exponent = n * (-d).log1p();
    let x = n * change / least + T::from_f64(POWER) * u * (T::ONE - exponent);
    if !(least > T::ZERO) {
        // A power of at least 1 is no greater than its base.
        if n >= T::ONE { min(greatest, T::ONE) } else { T::ONE }
    } else if x <= T::ONE {
        power * (x + x * x)
    } else if exponent + x < T::from_f64(NOTHING) {
        T::from_f64(NOTHING).exp()
    } else {
        T::ONE
    }
}

fn is_same<T: Real>(a: &Shape<T>, b: &Shape<T>) -> bool {
    a.center == b.center && a.inv_scale == b.inv_scale && a.radius == b.radius
}

fn two<T: Real>() -> T {
    T::ONE + T::ONE
}

/// At least the length.
fn size<T: Real>(v: Vec3<T>) -> T {
    v.x.abs() + v.y.abs() + v.z.abs()
}

fn absolute<T: Real>(v: Vec3<T>) -> Vec3<T> {
    Vec3::new(v.x.abs(), v.y.abs(), v.z.abs())
}

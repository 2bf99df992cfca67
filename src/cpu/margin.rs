//! How near a pixel's decisions are to falling the other way, to first order.
//!
//! A renderer that rounds follows a ray that lies within a thin cone around the exact one. The cone's width is
//! carried along the path (position error, direction error, growing at grazing angles and on curved mirrors); at every
//! decision the reference asks whether the cone contains the other answer, and in the end which levels the colour can take.

use glam::DVec3;
use serde::Serialize;

use super::intersect::{Approach, Hit, Own, Range, Ray, approach, exit_root, roots};
use super::refract::Snell;
use super::render::Reference;
use super::scene::{PointLight, Shape, World};
use super::shade::Surface;
use super::trace::trace;
use super::vec3::Vec3;
use super::witness::Witness;
use crate::precision::Tier;

/// Rounding errors that a value gathers before it is compared, in units of u: the longest chain of operations between the
/// inputs and a decision (ray into object space, closest approach, discriminant) has about this many steps.
const STEPS: f64 = 8.0;

/// A decision that a ray within the cone takes differently.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// A sphere is just hit or just missed.
    Silhouette,
    /// Two surfaces are hit at nearly the same distance.
    Tie,
    /// A hit lies just before or behind the image plane.
    NearPlane,
    /// A hit lies just before or behind the least distance of a secondary ray.
    Epsilon,
    /// A blocker is just hit or just missed, or ends just at the light.
    ShadowEdge,
    /// A light stands just above or below the tangent plane.
    Terminator,
    /// A ray meets glass just within or beyond the critical angle.
    CriticalAngle,
    /// The colour lies just above or below a quantisation step.
    QuantisationStep,
}

impl Decision {
    /// The decision in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Silhouette => "silhouette",
            Self::Tie => "two surfaces at one distance",
            Self::NearPlane => "near plane",
            Self::Epsilon => "secondary epsilon",
            Self::ShadowEdge => "shadow edge",
            Self::Terminator => "terminator",
            Self::CriticalAngle => "critical angle",
            Self::QuantisationStep => "quantisation step",
        }
    }
}

/// Judges the pixels of a renderer by the precision of its arithmetic.
#[derive(Debug, Clone, Copy)]
pub struct Judge {
    /// Unit roundoff of shading, and of points on a sphere relative to its size.
    shading: f64,
    /// Unit roundoff of inputs, places in the world and intersections.
    geometry: f64,
}

impl Judge {
    /// For the kernel of `tier`.
    pub fn of(tier: Tier) -> Self {
        // `robust` intersects with pairs of f32 that carry at least 44 bits.
        let (shading, geometry) = match tier {
            Tier::Fast => (23, 23),
            Tier::Robust => (23, 44),
            Tier::Double => (52, 52),
        };
        Self { shading: 0.5_f64.powi(shading), geometry: 0.5_f64.powi(geometry) }
    }

    /// The decision that explains `level`, another renderer's 8-bit value of pixel (column `i`, row `j`) that differs from
    /// the reference's: the first on the paths of the pixel's samples that comes within its margin. `None`: the pixel is unexplained.
    pub fn explain(&self, reference: &Reference<f64>, i: u32, j: u32, level: [u8; 3]) -> Option<Decision> {
        let color = reference.color(i, j)?;
        let mut decision = None;
        let (mut errors, mut magnitudes, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for primary in reference.primaries(i, j) {
            let mut cone = Cone::new(self);
            let color = trace(&reference.world, &primary, &mut cone).to_f64();
            // Each ray of a tree adds to a sum that rounds.
            errors += cone.color + color.abs() * (STEPS.max(cone.rays) * self.shading);
            magnitudes += color.abs();
            count += 1.0;
            decision = decision.or(cone.decision);
        }
        // Each addition rounds a sum that is no greater than that of all magnitudes, twice: the differences to the first.
        let summation = if count > 1.0 { magnitudes * (2.0 * self.shading) } else { DVec3::ZERO };
        let error = errors / count + summation;
        let low = reference.quantize.levels(color - error);
        let high = reference.quantize.levels(color + error);
        let within_step = (0..3).all(|c| (low[c]..=high[c]).contains(&level[c]));
        decision.or(within_step.then_some(Decision::QuantisationStep))
    }
}

/// What the error cone around a ray carries along its path; all errors are absolute, to first order.
#[derive(Debug, Clone, Copy)]
struct Path {
    /// The sphere that the ray leaves.
    own: Option<usize>,
    /// Error of the ray's origin, in world units.
    position: f64,
    /// Error of the ray's direction, as a fraction of its length.
    direction: f64,
    /// Weight of what is gathered next.
    throughput: f64,
    bounces: u32,
}

/// The error cone around a traced ray, or around the tree of rays that a primary ray leads to.
#[derive(Debug)]
struct Cone {
    /// Unit roundoff of shading.
    u: f64,
    /// Unit roundoff of geometry.
    g: f64,
    path: Path,
    /// Of the refraction rays that wait.
    waiting: Vec<Path>,
    /// Error of the unit normal of the surface last hit.
    normal: f64,
    /// Error of the colour gathered so far.
    color: DVec3,
    /// N·L of the light in hand and its error.
    light: (f64, f64),
    /// Whether light changes the colour of the surface in hand.
    shows_light: bool,
    /// Rays so far whose colours are summed.
    rays: f64,
    decision: Option<Decision>,
}

impl Cone {
    fn new(judge: &Judge) -> Self {
        Self {
            u: judge.shading,
            g: judge.geometry,
            path: Path { own: None, position: 0.0, direction: judge.geometry, throughput: 1.0, bounces: 0 },
            waiting: Vec::new(),
            normal: 0.0,
            color: DVec3::ZERO,
            light: (0.0, 0.0),
            shows_light: true,
            rays: 1.0,
            decision: None,
        }
    }

    fn note(&mut self, decision: Decision) {
        self.decision.get_or_insert(decision);
    }

    /// Width of the cone at `t`, in world units, with the rounding of the way into object space.
    fn width(&self, world: &World<f64>, ray: &Ray<f64>, sphere: usize, t: f64) -> f64 {
        let along = t.abs() * length(ray.direction);
        let magnitude = length(ray.origin) + length(world.shapes[sphere].center) + along;
        // The start of a ray may be off along its own surface, but lies on it but for rounding.
        let start =
            if self.path.own == Some(sphere) { STEPS * self.u * size(world, sphere) } else { self.path.position };
        start + along * self.path.direction + STEPS * self.g * magnitude
    }

    /// Error of a root t: the width of the cone, stretched by the angle at which the ray meets the surface.
    fn root_error(&self, world: &World<f64>, ray: &Ray<f64>, sphere: usize, at: &Approach<f64>, t: f64) -> f64 {
        let shape = &world.shapes[sphere];
        let stretch = largest(shape.inv_scale) / at.a.sqrt() / cosine(at, shape);
        self.width(world, ray, sphere, t) * stretch + STEPS * self.u * t.abs()
    }

    /// Whether a ray of the cone answers differently whether the line meets `sphere`.
    fn at_silhouette(&self, world: &World<f64>, ray: &Ray<f64>, sphere: usize, at: &Approach<f64>) -> bool {
        let shape = &world.shapes[sphere];
        let width = self.width(world, ray, sphere, at.b / at.a) * largest(shape.inv_scale);
        let distance = at.perpendicular.dot(at.perpendicular).sqrt();
        (distance - shape.radius).abs() <= width
    }

    /// Looks for decisions of the search over (`t_min`, `t_end`): spheres just touched, roots just at an end.
    fn watch_roots(
        &mut self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: Option<&Own<f64>>,
        (t_min, t_end): (f64, f64),
        hit: Option<&Hit<f64>>,
        [touch, at_min, at_end]: [Decision; 3],
    ) {
        for (sphere, shape) in world.shapes.iter().enumerate() {
            // Of equal surfaces the lowest index wins on every device.
            let is_hit = hit.is_some_and(|hit| world.shapes[hit.sphere].is_same_surface(shape));
            if let Some(own) = own.filter(|own| own.shape == shape.index) {
                let t = exit_root(own, ray.direction, shape);
                let error = self.width(world, ray, sphere, t) / length(ray.direction);
                if own.inside && !is_hit && (t - t_end).abs() <= error {
                    self.note(at_end);
                }
                if own.inside && (t - t_min).abs() <= error {
                    self.note(at_min);
                }
                continue;
            }
            let at = approach(ray, shape);
            let closest = at.b / at.a;
            let reach = self.root_error(world, ray, sphere, &at, closest).min(t_end.abs());
            if self.at_silhouette(world, ray, sphere, &at) && closest > t_min - reach && closest < t_end + reach {
                self.note(touch);
            }
            let Some((lesser, greater)) = roots(&at, shape.radius) else {
                continue;
            };
            for t in [lesser, greater] {
                let error = self.root_error(world, ray, sphere, &at, t);
                if (t - t_min).abs() <= error {
                    self.note(at_min);
                }
                let hit_error = if is_hit { f64::NEG_INFINITY } else { error };
                if (t - t_end).abs() <= hit_error {
                    self.note(at_end);
                }
            }
        }
    }
}

impl Witness<f64> for Cone {
    fn nearest(
        &mut self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: Option<&Own<f64>>,
        range: &Range<f64>,
        hit: Option<&Hit<f64>>,
    ) {
        let t_end = hit.map_or(f64::MAX, |hit| hit.t);
        let at_min = if self.path.bounces == 0 { Decision::NearPlane } else { Decision::Epsilon };
        self.watch_roots(world, ray, own, (range.t_min, t_end), hit, [Decision::Silhouette, at_min, Decision::Tie]);
    }

    fn surface(&mut self, world: &World<f64>, ray: &Ray<f64>, hit: &Hit<f64>, surface: &Surface<f64>) {
        let shape = &world.shapes[hit.sphere];
        let at = approach(ray, shape);
        let mut position = self.root_error(world, ray, hit.sphere, &at, hit.t) * length(ray.direction)
            + STEPS * (self.g * length(surface.position) + self.u * size(world, hit.sphere));
        if self.path.own == Some(hit.sphere) {
            // The chord starts elsewhere on the surface and is as slanted there as here.
            position += self.path.position * largest(shape.inv_scale) / at.a.sqrt() * length(ray.direction)
                / cosine(&at, shape);
        }
        self.path.position = position;
        self.path.own = Some(hit.sphere);
        self.normal = normal_error(shape, surface.own.local, self.path.position) + STEPS * self.u;
    }

    fn lit(&mut self, world: &World<f64>, surface: &Surface<f64>, light: &PointLight<f64>, n_dot_l: f64) {
        let distance = length(light.position - surface.position);
        let error = self.normal
            + (self.path.position + self.g * length(light.position)) / distance.max(f64::MIN_POSITIVE)
            + STEPS * self.u;
        let material = &world.materials[surface.sphere];
        self.shows_light = material.kd != 0.0 || material.ks != 0.0;
        self.light = (n_dot_l, error);
        if self.shows_light && n_dot_l.abs() <= error {
            self.note(Decision::Terminator);
        }
    }

    fn shadow(&mut self, world: &World<f64>, ray: &Ray<f64>, own: &Own<f64>) {
        if !self.shows_light {
            return;
        }
        let shadow = [Decision::ShadowEdge; 3];
        let direction = self.path.direction;
        self.path.direction = self.light.1;
        self.watch_roots(world, ray, Some(own), (world.shadow_t_min, 1.0), None, shadow);
        self.path.direction = direction;
    }

    fn shaded(&mut self, world: &World<f64>, surface: &Surface<f64>, light: &PointLight<f64>, specular: f64) {
        let material = &world.materials[surface.sphere];
        let (_, light_error) = self.light;
        // d(xⁿ) = n·xⁿ·dx/x with x the cosine of the half or the reflected angle.
        let power = specular / material.ks.abs().max(f64::MIN_POSITIVE);
        let cosine = if material.n > 0.0 { power.powf(1.0 / material.n) } else { 1.0 };
        let angle_error = 2.0 * self.normal + light_error + self.path.direction;
        // cos changes by sin·dα + ½dα².
        let cosine_error = (1.0 - cosine * cosine).max(0.0).sqrt() * angle_error + angle_error * angle_error;
        let specular_error = material.ks.abs() * power * (material.n * cosine_error / cosine.max(1e-300)).min(1.0)
            + STEPS * self.u * specular.abs();
        let diffuse_error = material.kd.abs() * light_error;
        let intensity = light.intensity.to_f64().abs();
        let color = material.color.to_f64().abs();
        self.color += (intensity * color * diffuse_error + intensity * specular_error) * self.path.throughput.abs();
    }

    fn reflected(&mut self, throughput: f64) {
        self.path.throughput = throughput;
        self.path.direction += 2.0 * self.normal + STEPS * self.u;
        self.path.bounces += 1;
        self.rays += 1.0;
    }

    fn refracted(&mut self, _world: &World<f64>, _surface: &Surface<f64>, snell: &Snell<f64>, throughput: f64) {
        let Snell { ratio, cosine, square, bend } = *snell;
        let sine_squared = (1.0 - cosine * cosine).max(0.0);
        // The angle between ray and normal is off by so much, its cosine by sin·dα + ½dα².
        let angle_error = self.path.direction + self.normal + STEPS * self.u;
        let cosine_error =
            sine_squared.sqrt() * angle_error + 0.5 * angle_error * angle_error + STEPS * self.u * cosine;
        let ratio_error = if ratio == 1.0 { 0.0 } else { 2.0 * self.u * ratio };
        // k = 1 − r²(1 − c²).
        let square_error = 2.0 * ratio * ratio * cosine * cosine_error
            + ratio * ratio * cosine_error * cosine_error
            + 2.0 * ratio * sine_squared * ratio_error
            + STEPS * self.u * (ratio * cosine * ratio * cosine).max((ratio * ratio - 1.0).abs());
        if square.abs() <= square_error {
            self.note(Decision::CriticalAngle);
        }
        let direction = if snell.is_total() {
            self.path.direction + 2.0 * self.normal + STEPS * self.u
        } else {
            // √k, and where it vanishes what its error leaves of it: the derivatives of the bend r·c − √k by c and by r.
            let root = square.max(square_error).sqrt().max(f64::MIN_POSITIVE);
            ratio * self.path.direction
                + bend.abs() * self.normal
                + ratio * (bend.abs() / root) * cosine_error
                + (2.0 + ratio * sine_squared / root) * ratio_error
                + STEPS * self.u * bend.abs()
        };
        self.waiting.push(Path { direction, throughput, bounces: self.path.bounces + 1, ..self.path });
    }

    fn resumed(&mut self) {
        self.path = self.waiting.pop().unwrap_or(self.path);
        self.rays += 1.0;
    }
}

/// Error of the unit normal at `local`, in object space, where the place is off by `position` along the surface.
///
/// The normal is along the gradient D·P with D the diagonal matrix of 1/s² and P the place relative to the centre: linear in
/// P. Along the surface D stretches by the greater eigenvalue λ of its part in the tangent plane; the surface curves away from
/// that plane by λ/(2|D·P|)·`position`², which D stretches by no more than its greatest entry.
fn normal_error(shape: &Shape<f64>, local: Vec3<f64>, position: f64) -> f64 {
    // Both in units of 1/r².
    let gradient = local * shape.inv_scale;
    let length = length(gradient);
    let d = shape.inv_scale * shape.inv_scale;
    let n = gradient * (1.0 / length);
    let n = n * n;
    let trace = d.x * (n.y + n.z) + d.y * (n.z + n.x) + d.z * (n.x + n.y);
    let determinant = n.x * d.y * d.z + n.y * d.z * d.x + n.z * d.x * d.y;
    let stretch = 0.5 * (trace + (trace * trace - 4.0 * determinant).max(0.0).sqrt());
    let sideways = stretch * position;
    let error = (sideways + 0.5 * largest(d) * (sideways / length) * position) / length;
    // An error as long as the gradient can turn it anywhere.
    if error < 0.5 { error / (1.0 - error) } else { 2.0 }
}

/// Cosine of the angle at which a ray meets a sphere's surface, in object space.
fn cosine(at: &Approach<f64>, shape: &Shape<f64>) -> f64 {
    (at.discriminant.max(0.0).sqrt() / shape.radius).max(f64::MIN_POSITIVE)
}

/// Greatest semi-axis of a sphere.
fn size(world: &World<f64>, sphere: usize) -> f64 {
    largest(world.materials[sphere].scale) * world.shapes[sphere].radius
}

fn length(v: Vec3<f64>) -> f64 {
    v.dot(v).sqrt()
}

fn largest(v: Vec3<f64>) -> f64 {
    v.x.max(v.y).max(v.z)
}

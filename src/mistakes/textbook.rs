//! The scene rendered as a textbook has it, by rules that may be wrong ones. With the right ones the picture is the reference's.

use glam::DVec3;

use super::rules::{
    AmbientCount, Behind, Clamp, Fading, Mirror, Near, NegativeCosine, Normal, Rules, Shadow, SpecularFactor, ToLight,
    ToViewer, Winner,
};
use super::world::{Body, World};
use crate::camera::NEAR_T_MIN;
use crate::scene::Sphere;
use crate::settings::Specular;

/// A scene under rules.
#[derive(Debug, Clone, Copy)]
pub(super) struct Textbook<'a> {
    pub world: &'a World,
    pub rules: &'a Rules,
    /// Where the image plane lies along a primary ray, which is not normalised.
    pub plane: f64,
    /// Against the direction of view.
    pub back: DVec3,
    /// Distance of the image plane.
    pub near: f64,
    /// A unit of length of the file.
    pub unit: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// The sphere that a ray leaves.
#[derive(Debug, Clone, Copy)]
struct Own {
    surface: u32,
    inside: bool,
    /// Where, in object space.
    local: DVec3,
}

#[derive(Debug, Clone, Copy)]
struct Hit {
    t: f64,
    body: usize,
    /// Whether it is the greater root.
    inside: bool,
}

/// A lit point.
struct Surface<'a> {
    position: DVec3,
    /// Of unit length, or what is taken for it.
    normal: DVec3,
    viewer: DVec3,
    own: Own,
    material: &'a Sphere,
}

/// Which roots count.
#[derive(Debug, Clone, Copy)]
struct Range {
    above: f64,
    below: f64,
    greater: bool,
}

/// Both roots of a ray with a surface, and where its line is nearest to the centre, in object space.
fn roots(ray: &Ray, body: &Body) -> Option<(f64, f64)> {
    let shape = &body.shape;
    let (origin, direction) = ((ray.origin - shape.center) * shape.inv_scale, ray.direction * shape.inv_scale);
    let (a, b) = (direction.length_squared(), -origin.dot(direction));
    let nearest = origin + direction * (b / a);
    let discriminant = shape.radius * shape.radius - nearest.length_squared();
    if !(discriminant >= 0.0) {
        return None;
    }
    let root = (a * discriminant).sqrt();
    let c = origin.length_squared() - shape.radius * shape.radius;
    let q = if b >= 0.0 { b + root } else { b - root };
    Some(if b >= 0.0 { (c / q, q / a) } else { (q / a, c / q) })
}

/// The second root of a ray that starts on the surface: the first is 0.
fn exit(ray: &Ray, own: &Own, body: &Body) -> f64 {
    let direction = ray.direction * body.shape.inv_scale;
    -2.0 * own.local.dot(direction) / direction.length_squared()
}

impl Textbook<'_> {
    /// The unclamped colour along a ray from the eye.
    pub(super) fn color(&self, ray: &Ray) -> DVec3 {
        let above = match self.rules.near {
            Near::Beyond => NEAR_T_MIN * self.plane,
            Near::AtLeast => (1.0 - 1e-9) * self.plane,
            Near::Ignored => 0.0,
            Near::OneUnitAway => self.unit / ray.direction.length(),
        };
        let range = Range { above, below: f64::INFINITY, greater: self.rules.far_root };
        self.trace(ray, None, &range, 0, true)
    }

    /// The sphere that a ray from the eye meets.
    pub(super) fn seen(&self, ray: &Ray) -> Option<usize> {
        let range = Range { above: NEAR_T_MIN * self.plane, below: f64::INFINITY, greater: true };
        self.nearest(ray, None, &range).map(|hit| hit.body)
    }

    fn trace(&self, ray: &Ray, own: Option<&Own>, range: &Range, depth: u32, shows_background: bool) -> DVec3 {
        let Self { world, rules, .. } = self;
        let Some(hit) = self.nearest(ray, own, range) else {
            let is_mirrored = depth > 0 && !shows_background;
            let shows = if is_mirrored { rules.back_in_mirrors } else { shows_background };
            return if shows { world.background } else { DVec3::ZERO };
        };
        let surface = self.surface(ray, &hit);
        let mut color = self.local_color(&surface, depth);
        let (Sphere { kr, kt, ks, color: own_color, .. }, limit) = (*surface.material, rules.depth);
        if rules.clamp == Clamp::EveryColor {
            color = color.clamp(DVec3::ZERO, DVec3::ONE);
        }
        if depth < limit && kr != 0.0 {
            let direction = 2.0 * surface.normal.dot(surface.viewer) * surface.normal - surface.viewer;
            let ray = Ray { origin: surface.position, direction };
            let range = Range { above: rules.reflection_epsilon, below: f64::INFINITY, greater: true };
            let mut reflected = self.trace(&ray, Some(&surface.own), &range, depth + 1, false);
            if rules.clamp != Clamp::None {
                reflected = reflected.clamp(DVec3::ZERO, DVec3::ONE);
            }
            color = match rules.mirror {
                Mirror::Added => color + kr * reflected,
                Mirror::Unweighted => color + reflected,
                Mirror::Blended => color * (1.0 - kr) + kr * reflected,
                Mirror::Colored => color + kr * own_color * reflected,
                Mirror::ByKs => color + ks * reflected,
            };
        }
        if depth < limit && kt != 0.0 {
            let (ray, own) = refracted(ray, &surface);
            let range = Range { above: 0.0, below: f64::INFINITY, greater: true };
            color += kt * self.trace(&ray, Some(&own), &range, depth + 1, shows_background);
        }
        color
    }

    fn nearest(&self, ray: &Ray, own: Option<&Own>, range: &Range) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        let is_primary = own.is_none();
        let test = |body: usize| {
            if let Some((t, inside)) = self.accepted(ray, own, range, body) {
                let is_better = nearest.is_none_or(|hit| match self.rules.winner {
                    Winner::Nearest => t < hit.t || (t == hit.t && body < hit.body),
                    Winner::FirstInFile => body < hit.body,
                    Winner::LastInFile => body > hit.body,
                });
                if is_better && !(is_primary && self.is_dropped(body)) {
                    nearest = Some(Hit { t, body, inside });
                }
            }
            let by_distance = self.rules.winner == Winner::Nearest;
            nearest.filter(|_| by_distance).map_or(range.below, |hit| hit.t)
        };
        self.world.tree.walk(ray.origin, ray.direction, 0.0, range.below, test);
        nearest
    }

    /// Whether a sphere is not drawn since the image plane cuts it.
    fn is_dropped(&self, body: usize) -> bool {
        if self.rules.cut_spheres {
            return false;
        }
        let shape = &self.world.bodies[body].shape;
        let reach = (self.back * shape.scale * shape.radius).length();
        self.near - shape.center.dot(-self.back) > -reach
    }

    /// The least root of a sphere that counts, and whether it is the greater one.
    fn accepted(&self, ray: &Ray, own: Option<&Own>, range: &Range, body: usize) -> Option<(f64, bool)> {
        let body = &self.world.bodies[body];
        if let Some(own) = own.filter(|own| own.surface == body.surface) {
            let t = exit(ray, own, body);
            let may = own.inside || self.rules.own_from_outside;
            return (may && t > range.above && t < range.below).then_some((t, true));
        }
        let (lesser, greater) = roots(ray, body)?;
        if lesser > range.above {
            (lesser < range.below).then_some((lesser, false))
        } else {
            (range.greater && greater > range.above && greater < range.below).then_some((greater, true))
        }
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        let body = &self.world.bodies[hit.body];
        let shape = &body.shape;
        let (origin, direction) = ((ray.origin - shape.center) * shape.inv_scale, ray.direction * shape.inv_scale);
        let a = direction.length_squared();
        let nearest = origin - direction * (origin.dot(direction) / a);
        let half_chord = direction * ((shape.radius * shape.radius - nearest.length_squared()).max(0.0) / a).sqrt();
        let local = if hit.inside { nearest + half_chord } else { nearest - half_chord };
        // The file's (P − p)/s.
        let on_unit_sphere = local / shape.radius;
        let outward = match self.rules.normal {
            Normal::InverseTranspose => (local * shape.inv_scale).normalize(),
            Normal::FromCenter => (local * shape.scale).normalize(),
            Normal::ObjectSpace => local.normalize(),
            Normal::RawInverseTranspose => on_unit_sphere / (shape.scale * shape.radius) * self.unit,
            Normal::RawFromCenter => local * shape.scale / self.unit,
            Normal::RawObjectSpace => on_unit_sphere,
        };
        let position = shape.center + local * shape.scale;
        let viewer = match self.rules.to_viewer {
            ToViewer::AgainstRay => -ray.direction.normalize(),
            ToViewer::Raw => -ray.direction,
            ToViewer::AlongZ => self.back,
            ToViewer::ToEye => -position.normalize(),
        };
        Surface {
            position,
            normal: if hit.inside && self.rules.flipped_inside { -outward } else { outward },
            viewer,
            own: Own { surface: body.surface, inside: hit.inside, local },
            material: &body.material,
        }
    }

    /// The colour of a point without what it reflects.
    fn local_color(&self, surface: &Surface, depth: u32) -> DVec3 {
        let Self { world, rules, .. } = self;
        let material = surface.material;
        let (mut lit, mut unblocked, mut is_blocked) = (DVec3::ZERO, 0, false);
        for (index, light) in world.lights.iter().enumerate() {
            if depth == 0 && index < 32 && rules.darkened >> index & 1 == 1 {
                continue;
            }
            let way = light.position - surface.position;
            let has_shadows = rules.shadow != Shadow::None && (depth == 0 || rules.shadows_in_mirrors);
            let (diffuse, specular) = self.terms(surface, way, light.position);
            if diffuse == 0.0 && specular == 0.0 && rules.ambient != AmbientCount::PerUnblockedLight {
                continue;
            }
            let blocked = has_shadows && self.is_blocked(surface, way);
            is_blocked |= blocked;
            unblocked += u32::from(!blocked);
            let (takes_diffuse, takes_specular) = match rules.shadow {
                Shadow::DiffuseOnly => (blocked, false),
                Shadow::SpecularOnly => (false, blocked),
                _ => (blocked, blocked),
            };
            let distance = way.length() / self.unit;
            let intensity = match rules.fading {
                Fading::None => light.intensity,
                Fading::Distance => light.intensity / distance,
                Fading::DistanceSquared => light.intensity / (distance * distance),
            };
            if !takes_diffuse {
                lit += rules.diffuse * diffuse * intensity * material.color;
            }
            if !takes_specular {
                let tint =
                    if rules.specular_factor == SpecularFactor::ObjectColor { material.color } else { DVec3::ONE };
                let light = if rules.specular_takes_light { intensity } else { DVec3::ONE };
                lit += rules.highlights * specular * light * tint;
            }
        }
        if is_blocked && matches!(rules.shadow, Shadow::AllLights | Shadow::Everything) {
            lit = DVec3::ZERO;
        }
        let times = match rules.ambient {
            AmbientCount::Times(times) => times,
            AmbientCount::PerLight => world.lights.len() as f64,
            AmbientCount::PerUnblockedLight => f64::from(unblocked),
        };
        if is_blocked && rules.shadow == Shadow::Everything {
            return lit;
        }
        let ka = if rules.ambient_takes_ka { material.ka } else { 1.0 };
        let tint = if rules.ambient_takes_color { material.color } else { DVec3::ONE };
        lit + times * ka * world.ambient * tint
    }

    /// The diffuse and the specular term of a light, without its intensity and the object's colour.
    fn terms(&self, surface: &Surface, way: DVec3, light: DVec3) -> (f64, f64) {
        let (rules, material, normal) = (self.rules, surface.material, surface.normal);
        let unit = match rules.to_light {
            ToLight::FromOrigin => light.normalize(),
            _ => way.normalize(),
        };
        let raw = way / self.unit;
        let (for_diffuse, for_specular) = match rules.to_light {
            ToLight::Unit | ToLight::FromOrigin => (unit, unit),
            ToLight::Raw => (raw, raw),
            ToLight::RawInDiffuse => (raw, unit),
            ToLight::RawInSpecular => (unit, raw),
        };
        let n_dot_l = match rules.behind {
            Behind::TwoSided | Behind::TwoSidedInR => normal.dot(for_diffuse).abs(),
            _ => normal.dot(for_diffuse),
        };
        // NaN, of a light at distance 0, is not above 0 either.
        let is_lit = n_dot_l > 0.0;
        if !is_lit && (rules.behind == Behind::Dark || n_dot_l.is_nan()) {
            return (0.0, 0.0);
        }
        let cosine = match rules.specular {
            Specular::Phong => {
                let along = normal.dot(for_specular);
                let along = if rules.behind == Behind::TwoSidedInR { along.abs() } else { along };
                (2.0 * along * normal - for_specular).dot(surface.viewer)
            }
            Specular::Blinn => normal.dot((for_specular + surface.viewer).normalize()),
        };
        let cosine = match rules.negative_cosine {
            NegativeCosine::Clamped => cosine.max(0.0),
            NegativeCosine::Kept => cosine,
            NegativeCosine::Absolute => cosine.abs(),
        };
        let exponent = material.n * rules.exponent.0 + rules.exponent.1;
        let power = if exponent <= 0.0 { 1.0 } else { cosine.powf(exponent) };
        let factor = match rules.specular_factor {
            SpecularFactor::One | SpecularFactor::ObjectColor => 1.0,
            SpecularFactor::NDotL => n_dot_l.max(0.0),
            SpecularFactor::Kd => material.kd,
        };
        let diffuse = if rules.behind == Behind::Subtracts { n_dot_l } else { n_dot_l.max(0.0) };
        (material.kd * diffuse, material.ks * power * factor)
    }

    /// Whether something stands between a point and a light.
    fn is_blocked(&self, surface: &Surface, way: DVec3) -> bool {
        let rules = self.rules;
        let ray = Ray { origin: surface.position, direction: way };
        let (from, to) = rules.shadow_range;
        let from = rules.shadow_distance.map_or(from, |distance| distance * self.unit / way.length());
        let counts = |t: f64| {
            let is_there = rules.cut_part_blocks || (ray.origin + ray.direction * t).dot(-self.back) > self.near;
            t > from && t < to && is_there
        };
        let mut is_blocked = false;
        self.world.tree.walk(ray.origin, ray.direction, from, to, |index| {
            let body = &self.world.bodies[index];
            is_blocked |= if body.surface == surface.own.surface {
                let may = surface.own.inside || rules.own_from_outside;
                rules.own_blocks && may && rules.far_root_blocks && counts(exit(&ray, &surface.own, body))
            } else {
                let of = |(lesser, greater)| counts(lesser) || (rules.far_root_blocks && counts(greater));
                roots(&ray, body).is_some_and(of)
            };
            if is_blocked { f64::NEG_INFINITY } else { to }
        });
        is_blocked
    }
}

/// The ray through glass, by Snell's law; the mirrored one where all light is reflected.
fn refracted(ray: &Ray, surface: &Surface) -> (Ray, Own) {
    let (own, normal) = (&surface.own, surface.normal);
    let eta = surface.material.eta;
    let ratio = if own.inside { eta } else { 1.0 / eta };
    let along = ratio * normal.dot(surface.viewer).max(0.0);
    let excess = (ratio - 1.0) * (ratio + 1.0);
    let square = along * along - excess;
    if !(square > 0.0) {
        let direction = 2.0 * normal.dot(surface.viewer) * normal - surface.viewer;
        return (Ray { origin: surface.position, direction }, *own);
    }
    let bend = excess / (along + square.sqrt());
    let direction = ray.direction * ratio + normal * (bend * ray.direction.length());
    (Ray { origin: surface.position, direction }, Own { inside: !own.inside, ..*own })
}

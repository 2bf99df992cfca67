//! The scene in the scalar of the reference.

use std::sync::Arc;

use rayon::prelude::*;

use super::intersect::Range;
use super::per_sphere::PerSphere;
use super::real::Real;
use super::tangent::Tangents;
use super::vec3::Vec3;
use crate::accel::Acceleration;
use crate::camera::Camera;
use crate::effects::{Effect, EffectSet, Effects};
use crate::exact::ExactScene;
use crate::geometry::{Ellipsoid, ellipsoids};
use crate::scene::{Light, Sphere};
use crate::settings::Specular;
use crate::viewed::ViewedScene;

/// One sphere: what the intersection reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape<T> {
    /// Centre in world space.
    pub center: Vec3<T>,
    /// World to object space.
    pub inv_scale: Vec3<T>,
    /// Radius in object space.
    pub radius: T,
    /// Lowest index of a sphere with this very surface.
    pub index: u32,
}

impl Shape<f64> {
    /// Bits that are equal exactly where two shapes are the same surface.
    pub(crate) fn bits(&self) -> [u64; 7] {
        let (c, i) = (self.center + Vec3::ZERO, self.inv_scale); // + 0 turns −0 into 0
        [c.x, c.y, c.z, i.x, i.y, i.z, self.radius].map(f64::to_bits)
    }
}

/// One sphere: what only shading reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Material<T> {
    /// Object to world space.
    pub scale: Vec3<T>,
    pub color: Vec3<T>,
    pub ka: T,
    pub kd: T,
    pub ks: T,
    pub kr: T,
    pub n: T,
}

/// One sphere: what only refraction reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glass<T> {
    pub kt: T,
    /// Index of refraction of the inside relative to the outside, and one over it.
    pub eta: T,
    pub inv_eta: T,
}

/// One point light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointLight<T> {
    pub position: Vec3<T>,
    pub intensity: Vec3<T>,
}

/// Everything that tracing reads, rounded once to `T`.
#[derive(Debug, Clone)]
pub(crate) struct World<T> {
    pub shapes: PerSphere<Shape<T>>,
    pub materials: PerSphere<Material<T>>,
    /// Empty where nothing refracts.
    pub glasses: PerSphere<Glass<T>>,
    pub lights: Vec<PointLight<T>>,
    pub ambient: Vec3<T>,
    pub background: Vec3<T>,
    /// The roots that count along a primary ray.
    pub primary: Range<T>,
    /// A blocker counts beyond this part of the way to the light.
    pub shadow_t_min: T,
    /// The roots that count along a reflection ray.
    pub reflection: Range<T>,
    /// The roots that count along a refraction ray.
    pub refraction: Range<T>,
    pub shadows: bool,
    /// Whether there are refraction rays.
    pub refracts: bool,
    pub specular: Specular,
    pub max_depth: u32,
    /// How far a ray may lie beside where `accel` takes it.
    pub allowance: T,
    pub light_allowance: T,
    /// Whether object space differs from the world by more than a translation.
    pub ellipsoids: bool,
    /// How far rounding may have moved a place when the eye moved to the origin.
    pub moved: f64,
    /// A ball around all spheres.
    pub middle: Vec3<T>,
    pub extent: T,
    /// Which spheres a ray can meet.
    pub accel: Arc<Acceleration>,
    /// Which primary rays may just touch a sphere,
    pub tangents: Tangents,
    /// and whether they do.
    pub exact: Arc<ExactScene>,
}

impl<T: Real> World<T> {
    pub(crate) fn new(viewed: &ViewedScene, effects: &Effects, accel: Acceleration) -> Self {
        let (scene, settings) = (viewed.scene(), viewed.settings());
        let on = |effect| effects.set.has(effect);
        let lit = on(Effect::Diffuse) || on(Effect::Specular);
        let ellipsoids = ellipsoids(scene, on(Effect::Ellipsoids));
        let indices = if effects.set.has_secondary_rays() {
            viewed.shape_indices(on(Effect::Ellipsoids)).unwrap_or_default()
        } else {
            Vec::new()
        };
        let shape = |(i, e): (usize, &Ellipsoid)| Shape {
            center: Vec3::from_f64(e.center),
            inv_scale: Vec3::from_f64(e.inv_scale),
            radius: T::from_f64(e.radius),
            index: indices.get(i).copied().unwrap_or(i as u32),
        };
        let range = |t_min, greater| Range { t_min: T::from_f64(t_min), t_max: T::FAR, greater };
        Self {
            shapes: ellipsoids.iter().enumerate().map(shape).collect(),
            materials: scene.spheres.iter().zip(&ellipsoids).map(|(s, e)| Material::new(s, e, effects.set)).collect(),
            glasses: scene.spheres.iter().filter(|_| on(Effect::Refraction)).map(Glass::new).collect(),
            // Where nothing is lit, no light is asked for.
            lights: scene.lights.iter().filter(|_| lit).map(PointLight::new).collect(),
            ambient: Vec3::from_f64(scene.ambient),
            background: Vec3::from_f64(scene.background),
            primary: if on(Effect::Shells) { range(Camera::new(viewed).t_min(), true) } else { range(0.0, false) },
            shadow_t_min: T::from_f64(settings.secondary.shadow),
            reflection: range(settings.secondary.reflection, true),
            refraction: range(0.0, true),
            shadows: on(Effect::Shadows),
            refracts: on(Effect::Refraction),
            specular: settings.specular,
            max_depth: effects.depth,
            allowance: T::from_f64(accel.allowance),
            light_allowance: T::from_f64(accel.light_allowance),
            ellipsoids: on(Effect::Ellipsoids),
            middle: Vec3::from_f64(accel.middle),
            extent: T::from_f64(accel.extent),
            moved: viewed.moved_by(),
            accel: Arc::new(accel),
            tangents: Tangents::of(ellipsoids.par_iter().copied(), viewed, T::ROUNDING.tests),
            exact: Arc::new(ExactScene::new(viewed, on(Effect::Ellipsoids))),
        }
    }
}

impl<T: Real> Material<T> {
    fn new(sphere: &Sphere, ellipsoid: &Ellipsoid, effects: EffectSet) -> Self {
        let term = |effect, coefficient| T::from_f64(if effects.has(effect) { coefficient } else { 0.0 });
        Self {
            scale: Vec3::from_f64(ellipsoid.scale),
            color: Vec3::from_f64(sphere.color),
            ka: term(Effect::Ambient, sphere.ka),
            kd: term(Effect::Diffuse, sphere.kd),
            ks: term(Effect::Specular, sphere.ks),
            kr: term(Effect::Reflections, sphere.kr),
            n: T::from_f64(sphere.n),
        }
    }
}

impl<T: Real> Glass<T> {
    fn new(sphere: &Sphere) -> Self {
        let eta = T::from_f64(sphere.eta);
        Self { kt: T::from_f64(sphere.kt), eta, inv_eta: T::ONE / eta }
    }
}

impl<T: Real> PointLight<T> {
    fn new(light: &Light) -> Self {
        Self { position: Vec3::from_f64(light.position), intensity: Vec3::from_f64(light.intensity) }
    }
}

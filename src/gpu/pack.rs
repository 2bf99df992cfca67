//! From the scene to the bytes of the buffers; every number is rounded once, to the nearest `f32`.

use glam::DVec3;

use super::layout::{Light, Material, Params, Shape};
use crate::camera::{Camera, NEAR_T_MIN};
use crate::effects::{Effect, Effects};
use crate::geometry::{ellipsoids, shape_indices};
use crate::scene::Scene;
use crate::settings::{Secondary, Settings};
use crate::tiles::TILE;

/// The contents of the buffers that do not change from dispatch to dispatch.
#[derive(Debug)]
pub(super) struct Packed {
    /// Parameters, `first_tile` still 0.
    pub params: Params,
    /// One per sphere.
    pub shapes: Vec<Shape>,
    /// One per sphere.
    pub materials: Vec<Material>,
    /// One per light.
    pub lights: Vec<Light>,
    /// x of each column on the image plane, on to the end of the last tile.
    pub columns: Vec<f32>,
    /// y of each row on the image plane, on to the end of the last tile.
    pub rows: Vec<f32>,
}

impl Packed {
    /// Packs `scene` for a pipeline that simulates `effects`.
    pub(super) fn new(scene: &Scene, settings: &Settings, effects: &Effects) -> Self {
        let on = |effect| effects.set.has(effect);
        let camera = Camera::new(scene, settings.sampling);
        let ellipsoids = ellipsoids(scene, on(Effect::Ellipsoids));
        let indices = shape_indices(&ellipsoids);

        let mut shapes = Vec::with_capacity(scene.spheres.len());
        let mut materials = Vec::with_capacity(scene.spheres.len());
        for ((sphere, ellipsoid), index) in scene.spheres.iter().zip(&ellipsoids).zip(indices) {
            // Without the effect the kernel leaves out the way into object space: what is exact there, a power of two,
            // goes into the radius.
            let (inv_scale, scale, radius) = if on(Effect::Ellipsoids) {
                (ellipsoid.inv_scale, ellipsoid.scale, ellipsoid.radius)
            } else {
                (DVec3::ONE, DVec3::ONE, ellipsoid.radius * ellipsoid.scale.x)
            };
            shapes.push(Shape {
                center: single(ellipsoid.center),
                radius: radius as f32,
                inv_scale: single(inv_scale),
                index,
            });
            materials.push(Material {
                color: single(sphere.color),
                ka: sphere.ka as f32,
                scale: single(scale),
                kd: sphere.kd as f32,
                ks: sphere.ks as f32,
                kr: sphere.kr as f32,
                n: sphere.n as f32,
                padding: 0,
            });
        }
        let light = |light: &crate::scene::Light| Light {
            position: single(light.position),
            padding0: 0,
            intensity: single(light.intensity),
            padding1: 0,
        };
        Self {
            params: Params {
                background: single(scene.background),
                near: camera.near() as f32,
                ambient: single(scene.ambient),
                primary_t_min: if on(Effect::Shells) { NEAR_T_MIN as f32 } else { 0.0 },
                secondary_t_min: match settings.secondary {
                    Secondary::Epsilon(epsilon) => epsilon as f32,
                    Secondary::SkipSelf => 0.0,
                },
                quantize_bias: settings.quantize.bias() as f32,
                first_tile: 0,
                sphere_count: scene.spheres.len() as u32,
                light_count: scene.lights.len() as u32,
                max_depth: effects.depth,
                padding: [0; 2],
            },
            shapes,
            materials,
            lights: scene.lights.iter().map(light).collect(),
            columns: (0..scene.width.next_multiple_of(TILE)).map(|i| camera.x(i) as f32).collect(),
            rows: (0..scene.height.next_multiple_of(TILE)).map(|j| camera.y(j) as f32).collect(),
        }
    }
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

//! What the textbook renderer reads of a scene.

use std::collections::HashMap;

use glam::DVec3;

use super::tree::Tree;
use crate::effects::{Effect, Effects};
use crate::geometry::{Ellipsoid, ellipsoids};
use crate::scene::{Light, Sphere};
use crate::viewed::ViewedScene;

/// A sphere with its surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    pub shape: Ellipsoid,
    /// Lowest index of a sphere with this very surface.
    pub surface: u32,
    pub material: Sphere,
    pub is_there: bool,
}

/// A scene, in the units of kernels.
#[derive(Debug, Clone)]
pub(super) struct World {
    pub bodies: Vec<Body>,
    pub lights: Vec<Light>,
    pub background: DVec3,
    pub ambient: DVec3,
    pub tree: Tree,
}

impl World {
    /// Of `viewed`, with what `effects` simulate.
    pub(super) fn new(viewed: &ViewedScene, effects: &Effects) -> Self {
        let scene = viewed.scene();
        let on = |effect| effects.set.has(effect);
        let true_axes = on(Effect::Ellipsoids);
        let term = |effect, coefficient| if on(effect) { coefficient } else { 0.0 };
        let body = |(sphere, shape): (&Sphere, Ellipsoid)| Body {
            shape,
            surface: 0,
            is_there: true,
            material: Sphere {
                ka: term(Effect::Ambient, sphere.ka),
                kd: term(Effect::Diffuse, sphere.kd),
                ks: term(Effect::Specular, sphere.ks),
                kr: term(Effect::Reflections, sphere.kr),
                kt: term(Effect::Refraction, sphere.kt),
                ..*sphere
            },
        };
        let bodies: Vec<Body> = scene.spheres.iter().zip(ellipsoids(scene, true_axes)).map(body).collect();
        let tree = Tree::over(&[]);
        let (lights, background, ambient) = (scene.lights.clone(), scene.background, scene.ambient);
        let mut world = Self { bodies, lights, background, ambient, tree };
        world.rebuild();
        world
    }

    /// Puts a sphere elsewhere or gives it other semi-axes.
    pub(super) fn reshape(&mut self, index: usize, center: DVec3, scale: DVec3) {
        let body = &mut self.bodies[index];
        body.shape = Ellipsoid::with_axes(center, scale);
        (body.material.center, body.material.scale) = (center, scale);
        self.rebuild();
    }

    /// Leaves out a sphere; the others keep their indices.
    pub(super) fn remove(&mut self, index: usize) {
        self.bodies[index].is_there = false;
        self.rebuild();
    }

    /// Builds the tree and finds equal surfaces, after they have changed.
    pub(super) fn rebuild(&mut self) {
        let mut first = HashMap::new();
        for (index, body) in self.bodies.iter_mut().enumerate() {
            body.surface = *first.entry(body.shape.bits()).or_insert(index as u32);
        }
        self.tree = Tree::over(&self.bodies);
    }
}

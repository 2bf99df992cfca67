//! From the units of kernels, with the eye at the origin, back to those of the scene's file.

use glam::DVec3;

use super::record::{TestRecord, Verdict};
use crate::camera::Camera;
use crate::cpu::intersect::Approach;
use crate::cpu::scene::Shape;
use crate::cpu::vec3::Vec3;
use crate::viewed::ViewedScene;

/// How a scene was moved and scaled for the kernels: all factors are powers of two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Units {
    /// What lengths were multiplied by.
    factor: f64,
    eye: DVec3,
    /// What directions of primary rays were multiplied by, beyond lengths.
    stretch: f64,
}

/// The units of a ray: how many times longer its direction is than in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayUnits {
    units: Units,
    scale: f64,
}

impl Units {
    pub(super) fn of(viewed: &ViewedScene) -> Self {
        let (_, settings) = viewed.in_file();
        Self { factor: viewed.factor(), eye: settings.view.eye, stretch: Camera::new(viewed).stretch() }
    }

    /// Of a ray to the image plane at t = 1.
    pub(super) fn primary(self) -> RayUnits {
        RayUnits { units: self, scale: self.factor * self.stretch }
    }

    /// Of a ray to a light at t = 1.
    pub(super) fn shadow(self) -> RayUnits {
        RayUnits { units: self, scale: self.factor }
    }

    /// Of a ray whose direction has unit length.
    pub(super) fn unit(self) -> RayUnits {
        RayUnits { units: self, scale: 1.0 }
    }

    pub(super) fn position(self, position: Vec3<f64>) -> [f64; 3] {
        (self.eye + position.to_f64() / self.factor).to_array()
    }
}

impl RayUnits {
    pub(super) fn direction(&self, direction: Vec3<f64>) -> [f64; 3] {
        (direction.to_f64() / self.scale).to_array()
    }

    pub(super) fn t(&self, t: f64) -> f64 {
        t * (self.scale / self.units.factor)
    }

    /// The numbers of a test, by the specification's equation.
    pub(super) fn test(&self, at: &Approach<f64>, shape: &Shape<f64>) -> TestRecord {
        let square = shape.radius * shape.radius;
        let per_t = self.units.factor / self.scale;
        let a = at.a / square * per_t * per_t;
        TestRecord {
            sphere: shape.index as usize,
            a,
            b: -at.b / square * per_t,
            c: (at.origin.dot(at.origin) - square) / square,
            discriminant: a * (at.discriminant / square),
            roots: None,
            verdict: Verdict::Missed,
        }
    }
}

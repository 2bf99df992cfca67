//! Rows of pixels from the reference, in parallel.

use glam::DVec3;
use rayon::prelude::*;

use super::intersect::Ray;
use super::real::Real;
use super::scene::World;
use super::trace::trace;
use super::vec3::Vec3;
use crate::camera::Camera;
use crate::effects::Effects;
use crate::scene::Scene;
use crate::settings::{Quantize, Settings};

/// The CPU reference: the whole specification, in the scalar `T`.
#[derive(Debug, Clone)]
pub struct Reference<T> {
    pub(super) world: World<T>,
    camera: Camera,
    pub(super) quantize: Quantize,
}

impl<T: Real> Reference<T> {
    /// Prepares `scene` with `effects`, rounding its numbers once to `T`.
    pub fn new(scene: &Scene, settings: &Settings, effects: &Effects) -> Self {
        Self {
            world: World::new(scene, settings, effects),
            camera: Camera::new(scene, settings.sampling),
            quantize: settings.quantize,
        }
    }

    pub(super) fn primary_ray(&self, i: u32, j: u32) -> Ray<T> {
        let direction = DVec3::new(self.camera.x(i), self.camera.y(j), -self.camera.near());
        Ray { origin: Vec3::ZERO, direction: Vec3::from_f64(direction) }
    }

    /// The unclamped colour of pixel (column `i`, row `j`).
    pub fn color(&self, i: u32, j: u32) -> DVec3 {
        trace(&self.world, self.primary_ray(i, j), &mut ()).to_f64()
    }

    /// The 8-bit RGB rows `first` to `first + count`, and how many of their pixels are not finite.
    pub fn rows(&self, first: u32, count: u32) -> (Vec<u8>, u64) {
        let width = self.camera.width() as usize;
        let mut rgb = vec![0; width * count as usize * 3];
        // A few hundred pixels a task balance the load and keep the cost of a task invisible.
        const CHUNK: usize = 256;
        let not_finite = rgb
            .par_chunks_mut(CHUNK * 3)
            .enumerate()
            .map(|(chunk, pixels)| {
                let mut not_finite = 0;
                for (k, pixel) in pixels.chunks_exact_mut(3).enumerate() {
                    let index = chunk * CHUNK + k;
                    let color = self.color((index % width) as u32, first + (index / width) as u32);
                    not_finite += u64::from(!color.is_finite());
                    pixel.copy_from_slice(&self.quantize.levels(color));
                }
                not_finite
            })
            .sum();
        (rgb, not_finite)
    }
}

//! What a pixel shows, in words: the sphere that its ray meets first.

use glam::DVec3;

use super::intersect::{Range, Ray, accepted_root};
use super::scene::Shape;
use super::vec3::Vec3;
use crate::camera::{Camera, NEAR_T_MIN};
use crate::geometry::Ellipsoid;
use crate::scene::Scene;
use crate::settings::Settings;

/// The first hit of a pixel's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Index of the sphere.
    pub sphere: usize,
    /// Parameter of the ray; 1 is the image plane.
    pub t: f64,
    /// Where, in the world.
    pub position: DVec3,
    /// Whether it is the inner wall.
    pub inside: bool,
}

/// What pixel (column `x`, row `y`) shows: that of its samples which is next to the middle. Tries every sphere once, which is
/// less work for a single ray than any list.
pub fn seen_through(scene: &Scene, settings: &Settings, x: u32, y: u32) -> Option<Seen> {
    if x >= scene.width || y >= scene.height {
        return None;
    }
    let camera = Camera::new(scene, settings);
    let middle = settings.samples / 2;
    let direction = camera.column(x * settings.samples + middle) + camera.row(y * settings.samples + middle);
    let ray = Ray::<f64> { origin: Vec3::ZERO, direction: Vec3::from_f64(direction) };
    let eye = settings.view.eye;
    let mut range = Range { t_min: NEAR_T_MIN, t_max: f64::INFINITY, greater: true };
    let mut nearest = None;
    for (sphere, ellipsoid) in scene.spheres.iter().enumerate() {
        let Ellipsoid { center, inv_scale, radius, .. } = Ellipsoid::with_axes(ellipsoid.center - eye, ellipsoid.scale);
        let (center, inv_scale) = (Vec3::from_f64(center), Vec3::from_f64(inv_scale));
        let shape = Shape { center, inv_scale, radius, index: sphere as u32 };
        if let Some((t, inside)) = accepted_root(&ray, &shape, None, &range) {
            range.t_max = t;
            nearest = Some(Seen { sphere, t, position: eye + direction * t, inside });
        }
    }
    nearest
}

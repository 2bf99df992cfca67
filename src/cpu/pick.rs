//! What a pixel shows: the sphere that its ray meets first.

use std::cell::LazyCell;

use glam::DVec3;

use super::intersect::{Range, Ray, primary_root};
use super::real::Real as _;
use super::scene::Shape;
use super::tangent::Tangents;
use super::vec3::Vec3;
use crate::camera::Camera;
use crate::exact::{ExactCamera, TangentMargin};
use crate::geometry::Ellipsoid;
use crate::viewed::ViewedScene;

/// The first hit of a pixel's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimaryHit {
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
pub fn picked(viewed: &ViewedScene, x: u32, y: u32) -> Option<PrimaryHit> {
    let (scene, (file_scene, file_settings)) = (viewed.scene(), viewed.in_file());
    if x >= scene.width || y >= scene.height {
        return None;
    }
    let camera = Camera::new(viewed);
    let (side, [column, row]) = (camera.pattern().side(), camera.pattern().middle());
    let sample = [x * side + column, y * side + row];
    let sum = camera.column(sample[0]) + camera.row(sample[1]);
    let (origin, direction) = if camera.is_parallel() { (sum, camera.direction()) } else { (DVec3::ZERO, sum) };
    let ray = Ray::<f64> { origin: Vec3::from_f64(origin), direction: Vec3::from_f64(direction) };
    // Few rays come so near to a tangent.
    let exact = LazyCell::new(|| ExactCamera::new(viewed));
    let mut range = Range { t_min: camera.t_min(), t_max: f64::INFINITY, greater: true };
    let margin = TangentMargin::new(viewed, f64::ROUNDING.tests);
    let mut nearest = None;
    for (sphere, (ellipsoid, in_file)) in scene.spheres.iter().zip(&file_scene.spheres).enumerate() {
        let ellipsoid = Ellipsoid::new(ellipsoid);
        let tangents = Tangents::of_one(margin, ellipsoid);
        let touches = || exact.discriminant(sample, in_file.center, in_file.scale);
        let Ellipsoid { center, inv_scale, radius, .. } = ellipsoid;
        let (center, inv_scale) = (Vec3::from_f64(center), Vec3::from_f64(inv_scale));
        let shape = Shape { center, inv_scale, radius, index: sphere as u32 };
        if let Some((t, inside)) = primary_root(&ray, &shape, &range, &tangents, touches, &mut ()) {
            range.t_max = t;
            nearest = Some((sphere, inside));
        }
    }
    let (sphere, inside) = nearest?;
    // Back from the units of kernels.
    let position = file_settings.view.eye + (origin + direction * range.t_max) * viewed.factor().recip();
    Some(PrimaryHit { sphere, t: range.t_max * camera.stretch(), position, inside })
}

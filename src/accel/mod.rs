//! Which spheres a ray can meet at all, so that its cost hardly grows with their number.
//!
//! Rays from the eye share their origin and those to a point light their end: short lists, one for each tile of the picture
//! and one for each small cone of directions from a light, take the place of a tree. Only reflections walk a grid. Every
//! list has whatever a test, rounding included, can take for a hit, so a picture is byte for byte that of all spheres.

mod bounds;
mod grid;
mod light_buffer;
mod lists;
mod screen;

use glam::DVec3;

use crate::camera::Camera;
use crate::effects::{Effect, EffectSet};
use crate::scene::Scene;
use bounds::Enclosure;

pub use bounds::Rounding;
pub use grid::Grid;
pub use light_buffer::{Face, LightBuffer, REACH};
pub use lists::Lists;
pub use screen::{Cover, ScreenLists};

/// The lists of one scene.
#[derive(Debug, Clone, Default)]
pub struct Acceleration {
    /// For rays from the eye.
    pub screen: ScreenLists,
    /// For rays to lights; empty where nothing casts shadows.
    pub lights: LightBuffer,
    /// For reflections, where there are any.
    pub grid: Option<Grid>,
}

impl Acceleration {
    /// The lists that the effects of `scene` call for, for a renderer that rounds like this.
    pub fn new(scene: &Scene, camera: &Camera, effects: EffectSet, rounding: Rounding) -> Self {
        let enclosure = Enclosure::new(scene, effects.has(Effect::Ellipsoids), rounding);
        let lights: Vec<DVec3> = scene.lights.iter().map(|light| light.position).collect();
        let lit = effects.has(Effect::Shadows);
        let entries = light_entries(scene.spheres.len() as u64, lights.len() as u64);
        Self {
            screen: ScreenLists::new(&enclosure, camera),
            lights: LightBuffer::new(&enclosure, if lit { &lights } else { &[] }, entries, rounding),
            grid: (effects.has(Effect::Reflections) || effects.has(Effect::Refraction))
                .then(|| Grid::new(&enclosure, rounding)),
        }
    }
}

/// Entries of the lists of all lights together, roughly, unless the cells become larger than the spheres: 64 MiB.
const MAX_LIGHT_ENTRIES: u64 = 1 << 24;

/// How many entries the lists of one light may have, roughly. Finer cells mean shorter lists; with many spheres, the building
/// of the lists and the memory that they take count for more.
fn light_entries(spheres: u64, lights: u64) -> u64 {
    let per_sphere = if spheres < 50_000 { 12 } else { 6 };
    (per_sphere * spheres + 256).min(MAX_LIGHT_ENTRIES / lights.max(1))
}

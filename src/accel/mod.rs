//! Which spheres a ray can meet at all, so that its cost hardly grows with their number.
//!
//! Rays from the eye share their origin and those to a point light their end: short lists, one for each tile of the picture
//! and one for each small cone of directions from a light, take the place of a tree. Only reflections walk a grid. Every
//! list has whatever a test, rounding included, can take for a hit, so a picture is byte for byte that of all spheres.

mod bounds;
mod density;
mod grid;
mod light_buffer;
mod lists;
mod screen;

use glam::DVec3;

use crate::camera::Camera;
use crate::effects::{Effect, EffectSet};
use crate::viewed::ViewedScene;
use bounds::Enclosure;

pub use bounds::Rounding;
pub use density::Density;
pub use grid::{Grid, MAX_LARGE, WALK_SLACK};
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
    /// The lists that the effects of `viewed` call for, for a renderer that rounds like this.
    pub fn new(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding) -> Self {
        Self::with_density(viewed, effects, rounding, &Density::DEFAULT)
    }

    /// Likewise, as fine as `density` says.
    pub fn with_density(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding, density: &Density) -> Self {
        let (scene, camera) = (viewed.scene(), Camera::new(viewed));
        let enclosure = Enclosure::new(scene, effects.has(Effect::Ellipsoids), rounding);
        let lights: Vec<DVec3> = scene.lights.iter().map(|light| light.position).collect();
        let lit = effects.has(Effect::Shadows);
        let spheres = scene.spheres.len();
        let entries = density.entries_of_a_light(spheres, lights.len());
        Self {
            screen: ScreenLists::new(&enclosure, &camera, density.longest_tile),
            lights: LightBuffer::new(&enclosure, if lit { &lights } else { &[] }, entries, rounding),
            grid: Self::grid_in(&enclosure, effects, rounding, density),
        }
    }

    /// The grid alone.
    pub fn grid_of(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding, density: &Density) -> Option<Grid> {
        let enclosure = Enclosure::new(viewed.scene(), effects.has(Effect::Ellipsoids), rounding);
        Self::grid_in(&enclosure, effects, rounding, density)
    }

    fn grid_in(enclosure: &Enclosure, effects: EffectSet, rounding: Rounding, density: &Density) -> Option<Grid> {
        let leave_surfaces = effects.has(Effect::Reflections) || effects.has(Effect::Refraction);
        leave_surfaces.then(|| Grid::new(enclosure, density.cells_per_sphere(enclosure.len()), rounding))
    }
}

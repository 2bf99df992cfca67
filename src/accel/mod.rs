//! Which spheres a ray can meet at all, so that its cost hardly grows with their number.
//!
//! Rays from the eye share their origin and those to a point light their end: short lists, one for each tile of the picture
//! and one for each small cone of directions from a light, take the place of a tree. Only reflections walk a grid. Every
//! list has whatever a test, rounding included, can take for a hit, so a picture is byte for byte that of all spheres.

mod bounds;
mod density;
mod grid;
mod kept;
mod leaving;
mod light_buffer;
mod lists;
mod screen;

use glam::DVec3;

use crate::camera::Camera;
use crate::effects::{Effect, EffectSet};
use crate::viewed::ViewedScene;
use bounds::Enclosure;
use leaving::{Leaving, grid_in};

pub use bounds::Rounding;
pub use density::Density;
pub use grid::{Grid, MAX_LARGE, WALK_SLACK};
pub(crate) use kept::KeptLists;
pub use kept::ScreenRoom;
pub use light_buffer::{Face, LightBuffer, REACH};
pub use lists::Lists;
pub use screen::{Cover, ScreenLists};

/// Where the cones of rays that leave a surface have room in the lists: around each sphere for this part of the mean radius. They grow
/// with the way, those of rays to lights do not.
const GRID_ROOM: f64 = 0.2;
const LIGHT_ROOM: f64 = 0.05;

/// The lists of one scene.
#[derive(Debug, Clone, Default)]
pub struct Acceleration {
    /// For rays from the eye.
    pub screen: ScreenLists,
    /// For rays to lights; empty where nothing casts shadows.
    pub lights: LightBuffer,
    /// For reflections, where there are any.
    pub grid: Option<Grid>,
    /// How far a ray that leaves a surface may lie beside where the lists take it, in the units of kernels.
    pub allowance: f64,
    /// Likewise one to a light.
    pub light_allowance: f64,
    /// Middle of a ball around all spheres.
    pub middle: DVec3,
    /// Its radius.
    pub extent: f64,
    /// Where other eyes have the same lists of lights and the same grid.
    pub room: Option<ScreenRoom>,
}

impl Acceleration {
    /// The lists that the effects of `viewed` call for, for a renderer that rounds like this.
    pub fn new(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding) -> Self {
        Self::with_density(viewed, effects, rounding, &Density::DEFAULT)
    }

    /// Likewise, as fine as `density` says.
    pub fn with_density(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding, density: &Density) -> Self {
        let _span = tracing::info_span!("make lists").entered();
        let (scene, camera) = (viewed.scene(), Camera::new(viewed));
        let enclosure = Enclosure::new(viewed, effects.has(Effect::Ellipsoids), rounding);
        let lights: Vec<DVec3> = scene.lights.iter().map(|light| light.position).collect();
        let (middle, extent) = enclosure.ball();
        let make = |enclosure: &Enclosure| Leaving::new(enclosure, &lights, effects, rounding, density);
        let Leaving { lights, grid, allowance, light_allowance, room } = match viewed.kept() {
            Some(kept) => kept.lists.of(viewed, &enclosure, (effects, rounding, *density, viewed.factor()), make),
            None => make(&enclosure),
        };
        let screen = ScreenLists::new(&enclosure, &camera, density.longest_tile);
        let room = room.map(|room| ScreenRoom::of(&room, &screen.lists));
        Self { screen, lights, grid, allowance, light_allowance, middle, extent, room }
    }

    /// The grid alone.
    pub fn grid_of(viewed: &ViewedScene, effects: EffectSet, rounding: Rounding, density: &Density) -> Option<Grid> {
        let enclosure = Enclosure::new(viewed, effects.has(Effect::Ellipsoids), rounding);
        grid_in(&enclosure, effects, rounding, density)
    }
}

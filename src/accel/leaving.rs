//! Lists for rays that leave surfaces.

use glam::DVec3;

use super::bounds::{Enclosure, Rounding};
use super::density::Density;
use super::grid::{Grid, below};
use super::kept::Room;
use super::light_buffer::LightBuffer;
use super::{GRID_ROOM, LIGHT_ROOM};
use crate::effects::{Effect, EffectSet};

/// The lists of lights and the grid, with how far their rays may lie beside where they take them.
#[derive(Debug, Clone)]
pub(super) struct Leaving {
    pub(super) lights: LightBuffer,
    pub(super) grid: Option<Grid>,
    pub(super) allowance: f64,
    pub(super) light_allowance: f64,
    /// Where other eyes have the same: the room for the lists of their screens.
    pub(super) room: Option<Room>,
}

impl Leaving {
    pub(super) fn new(
        enclosure: &Enclosure,
        lights: &[DVec3],
        effects: EffectSet,
        rounding: Rounding,
        density: &Density,
    ) -> Self {
        let lit = effects.has(Effect::Shadows);
        let for_lights = enclosure.with_room(LIGHT_ROOM, rounding);
        let entries = density.entries_of_a_light(enclosure.len(), lights.len());
        Self {
            lights: LightBuffer::new(&for_lights, if lit { lights } else { &[] }, entries, rounding),
            grid: grid_in(enclosure, effects, rounding, density),
            allowance: enclosure.with_room(GRID_ROOM, rounding).allowance(),
            light_allowance: for_lights.allowance(),
            room: None,
        }
    }

    /// The same where everything is moved by `shift`. Around the lights nothing changes.
    pub(super) fn moved(&self, shift: DVec3) -> Self {
        let mut moved = self.clone();
        if let Some(grid) = &mut moved.grid {
            grid.low = DVec3::from_array((grid.low + shift).to_array().map(below));
        }
        moved
    }
}

/// The grid, where rays need one.
pub(super) fn grid_in(
    enclosure: &Enclosure,
    effects: EffectSet,
    rounding: Rounding,
    density: &Density,
) -> Option<Grid> {
    let leave_surfaces = effects.has(Effect::Reflections) || effects.has(Effect::Refraction);
    leave_surfaces.then(|| {
        Grid::new(&enclosure.with_room(GRID_ROOM, rounding), density.cells_per_sphere(enclosure.len()), rounding)
    })
}

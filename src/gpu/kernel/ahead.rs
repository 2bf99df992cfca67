//! What can be done for a picture before there is a device to do it on: opening one takes longer than reading most scenes.

use super::entry::TRACE_TILES;
use super::specialisation::Specialisation;
use super::spirv::ParsedModule;
use super::variant::{Kernel, Tables};
use crate::accel::Acceleration;
use crate::effects::Effects;
use crate::precision::{Request, Selection, Tier};
use crate::tuning::{Class, Tuning};
use crate::viewed::ViewedScene;

/// Software devices calculate in `f64` at little more than the price of `f32`, far below that of error-free transforms; hardware
/// has few `f64` units.
pub(crate) const SOFTWARE_LADDER: [Tier; 3] = [Tier::Fast, Tier::Double, Tier::Robust];

/// With more spheres, looking at the scene takes longer than a device takes to open.
const MAX_SPHERES: usize = 2000;

/// The kernels of a picture as they most likely will be, parsed, and the largest of them translated. Where they turn out to be others,
/// nothing is lost but the time of a thread that had nothing else to do.
#[derive(Debug)]
pub struct Ahead {
    specialisation: Specialisation,
    module: ParsedModule,
}

impl Ahead {
    /// For a software device with the tuning of its class. Where there are graphics cards, drivers take far longer than this saves.
    pub fn of(viewed: &ViewedScene, effects: &Effects, request: Request) -> Option<Self> {
        if viewed.scene().spheres.len() > MAX_SPHERES {
            return None;
        }
        let tuning = Tuning::of(Class::Software);
        let selection = Selection::of(viewed, effects, request, &SOFTWARE_LADDER);
        let kernel = Kernel::Tier(selection.tier);
        let grid = Acceleration::grid_of(viewed, effects.set, kernel.rounding(), &tuning.density);
        let specialisation = Specialisation {
            certified: selection.certified,
            ..Specialisation::new(viewed, effects, kernel, &tuning, Tables::Stored).with_grid(grid.as_ref(), &tuning)
        };
        let module = ParsedModule::new(&specialisation.module()).ok()?;
        let module = module.with_translation(TRACE_TILES, specialisation.constants()).ok()?;
        Some(Self { specialisation, module })
    }

    /// Which kernels these are.
    pub fn specialisation(&self) -> &Specialisation {
        &self.specialisation
    }

    /// The module of these kernels, if it is the one.
    pub(super) fn module(&self, specialisation: &Specialisation) -> Option<&ParsedModule> {
        (self.specialisation.variant() == specialisation.variant()).then_some(&self.module)
    }
}

//! Lists that one eye leaves to the next: those of lights and the grid depend on where the spheres are to each other, and on the eye by
//! rounding alone.

use std::sync::{Arc, Mutex};

use glam::DVec3;

use super::bounds::{Enclosure, Rounding};
use super::density::Density;
use super::leaving::Leaving;
use super::lists::Lists;
use crate::brightness::Scalar;
use crate::effects::EffectSet;
use crate::scene::Light;
use crate::threads::lock;
use crate::viewed::ViewedScene;

/// How many times greater than with the first eye coordinates may become for the same lists: what enlarges the spheres has room for
/// twice as great ones. The rest of it is for what rounding takes where all is moved once more: of the grid's corner, for `f32`, two
/// units in the last place, and of each other place one in `f64`.
const FARTHER: f64 = 1.5;
pub(super) const ROOM: f64 = 2.0;
/// With eyes that are so many times nearer, the lists would be longer than they need to be.
const NEARER: f64 = 0.25;
/// The first kernel of a certified picture, `double` beside it, and the reference have lists of their own.
const MOST: usize = 3;

/// The lists of one scene, for all eyes that have looked at it.
#[derive(Debug, Default)]
pub(crate) struct KeptLists(Mutex<Vec<Kept>>);

/// What lists are made for.
type Key = (EffectSet, Rounding, Density, f64);

#[derive(Debug)]
struct Kept {
    key: Key,
    /// Where they were, in the file's coordinates.
    lights: Vec<Light>,
    /// For which eye, in the units of kernels.
    eye: DVec3,
    sizes: Sizes,
    leaving: Leaving,
}

/// What rounding goes by.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    /// The greatest coordinate of a sphere, or of a light.
    magnitude: f64,
    reach: f64,
    /// How far rounding has moved places.
    moved: f64,
}

impl Sizes {
    fn of(enclosure: &Enclosure, viewed: &ViewedScene) -> Self {
        Self { magnitude: enclosure.magnitude, reach: enclosure.reach, moved: viewed.moved_by() }
    }

    /// Whether lists for these sizes have room for `other`.
    fn serve(&self, other: &Self) -> bool {
        let is_within = |mine: f64, other: f64| (mine * NEARER..=mine * FARTHER).contains(&other);
        is_within(self.magnitude, other.magnitude)
            && is_within(self.reach, other.reach)
            && other.moved <= moved_at_most(self.moved, self.magnitude)
    }
}

/// The most cells and entries that the screen of any eye has had so far, with some more.
pub(super) type Room = Arc<Mutex<[usize; 2]>>;

/// Room for the lists of a screen, so that a buffer has those which other eyes share in the same place for all.
#[derive(Debug, Clone)]
pub struct ScreenRoom {
    of: Room,
    sizes: [usize; 2],
}

impl ScreenRoom {
    /// Enough for `screen`.
    pub(super) fn of(room: &Room, screen: &Lists) -> Self {
        let mut sizes = lock(room);
        for (size, needed) in sizes.iter_mut().zip([screen.cells(), screen.entries.len()]) {
            if *size < needed {
                *size = needed + needed / 4;
            }
        }
        Self { of: Arc::clone(room), sizes: *sizes }
    }

    /// Cells and entries.
    pub fn sizes(&self) -> [usize; 2] {
        self.sizes
    }
}

/// The same lists behind as much room.
impl PartialEq for ScreenRoom {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.of, &other.of) && self.sizes == other.sizes
    }
}

/// How far rounding may move places for eyes that the same lists serve: those from which no sphere is much farther away.
pub(super) fn moved_at_most(moved: f64, magnitude: f64) -> f64 {
    moved + 8.0 * Scalar::Double.unit() * magnitude
}

impl KeptLists {
    /// The lists for `viewed`, which is a view of the same spheres as ever, perhaps with other lights; `make` makes them with room for other eyes.
    pub(super) fn of(
        &self,
        viewed: &ViewedScene,
        enclosure: &Enclosure,
        key: Key,
        make: impl FnOnce(&Enclosure) -> Leaving,
    ) -> Leaving {
        let eye = viewed.in_file().1.view.eye * viewed.factor();
        let sizes = Sizes::of(enclosure, viewed);
        let lights = &viewed.in_file().0.lights;
        let serves = |kept: &&Kept| kept.key == key && kept.lights == *lights && kept.sizes.serve(&sizes);
        if let Some(kept) = lock(&self.0).iter().find(serves) {
            return kept.leaving.moved(kept.eye - eye);
        }
        let leaving = Leaving { room: Some(Room::default()), ..make(&enclosure.for_other_eyes(viewed)) };
        let mut all = lock(&self.0);
        all.retain(|kept| kept.key != key);
        if all.len() == MOST {
            all.remove(0);
        }
        all.push(Kept { key, lights: lights.clone(), eye, sizes, leaving: leaving.clone() });
        leaving
    }
}

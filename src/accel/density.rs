//! How fine the lists are: shorter lists cost less to walk and more to build and to keep.

use serde::{Deserialize, Serialize};

/// From this many spheres on the lists are those of many.
const MANY: usize = 50_000;
/// Entries of the lists of all lights together, roughly, unless the cells become larger than the spheres: 64 MiB.
const MAX_LIGHT_ENTRIES: f64 = (1 << 24) as f64;

/// Cells and entries for each sphere, and spheres for each tile. With many spheres the building of the lists, and the memory that
/// they take, count for more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Density {
    /// Spheres in the list of a tile of the picture, on average, from which on tiles become smaller.
    pub longest_tile: f64,
    /// Entries for each sphere in the lists of a light, roughly.
    pub light_entries: f64,
    /// Likewise where there are many spheres.
    pub light_entries_of_many: f64,
    /// Cells of the grid for each sphere.
    pub grid_cells: f64,
    /// Likewise where there are many spheres.
    pub grid_cells_of_many: f64,
}

impl Density {
    /// What is best on the CPU, for the reference and for lavapipe alike.
    pub const DEFAULT: Self = Self {
        longest_tile: 12.0,
        light_entries: 12.0,
        light_entries_of_many: 3.0,
        grid_cells: 3.0,
        grid_cells_of_many: 1.5,
    };

    /// What takes little memory and is good enough.
    pub const LEAST: Self = Self { longest_tile: f64::INFINITY, ..Self::DEFAULT };

    /// How many entries the lists of one of so many lights may have, roughly.
    pub(super) fn entries_of_a_light(&self, spheres: usize, lights: usize) -> u64 {
        let per_sphere = if spheres < MANY { self.light_entries } else { self.light_entries_of_many };
        (per_sphere * spheres as f64 + 256.0).min(MAX_LIGHT_ENTRIES / lights.max(1) as f64) as u64
    }

    /// How many cells of the grid there are for each sphere.
    pub(super) fn cells_per_sphere(&self, spheres: usize) -> f64 {
        if spheres < MANY { self.grid_cells } else { self.grid_cells_of_many }
    }
}

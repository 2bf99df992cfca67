//! The numbers of a tuning one by one, for whoever checks or varies them.

use super::{NEVER, Tuning};

/// One number of a tuning, for whoever varies it.
#[derive(Debug)]
pub struct Knob {
    /// Its name in tables and files.
    pub name: &'static str,
    /// Least and greatest value.
    pub limits: [f64; 2],
    /// What `trueray bench --tune` tries.
    pub candidates: &'static [f64],
    /// Its value.
    pub get: fn(&Tuning) -> f64,
    /// Changes its value.
    pub set: fn(&mut Tuning, f64),
}

/// All numbers of a tuning.
pub static KNOBS: [Knob; 13] = [
    Knob {
        name: "workgroup",
        limits: [1.0, 256.0],
        candidates: &[8.0, 16.0, 32.0, 64.0, 128.0, 256.0],
        get: |tuning| f64::from(tuning.workgroup),
        set: |tuning, value| tuning.workgroup = value as u32,
    },
    Knob {
        name: "in_place_below",
        limits: [0.0, NEVER],
        candidates: &[0.0, 1e3, 1e4, 1e5],
        get: |tuning| tuning.in_place_below,
        set: |tuning, value| tuning.in_place_below = value,
    },
    Knob {
        name: "in_turn_from",
        limits: [0.0, NEVER],
        candidates: &[1e3, 1e4, 1e5, NEVER],
        get: |tuning| tuning.in_turn_from,
        set: |tuning, value| tuning.in_turn_from = value,
    },
    Knob {
        name: "paths",
        limits: [1.0, 256.0],
        candidates: &[16.0, 32.0, 64.0, 128.0],
        get: |tuning| f64::from(tuning.paths),
        set: |tuning, value| tuning.paths = value as u32,
    },
    Knob {
        name: "texture_tables",
        limits: [0.0, 1.0],
        candidates: &[0.0, 1.0],
        get: |tuning| f64::from(u8::from(tuning.texture_tables)),
        set: |tuning, value| tuning.texture_tables = value >= 0.5,
    },
    Knob {
        name: "longest_tile",
        limits: [0.0, NEVER],
        candidates: &[3.0, 6.0, 12.0, 24.0, NEVER],
        get: |tuning| tuning.density.longest_tile,
        set: |tuning, value| tuning.density.longest_tile = value,
    },
    Knob {
        name: "light_entries",
        limits: [0.0, 256.0],
        candidates: &[3.0, 6.0, 12.0, 24.0, 48.0],
        get: |tuning| tuning.density.light_entries,
        set: |tuning, value| tuning.density.light_entries = value,
    },
    Knob {
        name: "light_entries_of_many",
        limits: [0.0, 64.0],
        candidates: &[3.0, 6.0, 12.0],
        get: |tuning| tuning.density.light_entries_of_many,
        set: |tuning, value| tuning.density.light_entries_of_many = value,
    },
    Knob {
        name: "grid_cells",
        limits: [0.01, 64.0],
        candidates: &[0.5, 1.0, 3.0, 6.0, 12.0],
        get: |tuning| tuning.density.grid_cells,
        set: |tuning, value| tuning.density.grid_cells = value,
    },
    Knob {
        name: "grid_cells_of_many",
        limits: [0.01, 16.0],
        candidates: &[0.5, 1.0, 2.0],
        get: |tuning| tuning.density.grid_cells_of_many,
        set: |tuning, value| tuning.density.grid_cells_of_many = value,
    },
    Knob {
        name: "path_mib",
        limits: [1.0, 1024.0],
        candidates: &[16.0, 32.0, 64.0, 128.0],
        get: |tuning| f64::from(tuning.path_mib),
        set: |tuning, value| tuning.path_mib = value as u32,
    },
    Knob {
        name: "dispatch_ms",
        limits: [1.0, 200.0],
        candidates: &[10.0, 25.0, 50.0, 100.0, 200.0],
        get: |tuning| tuning.dispatch_ms,
        set: |tuning, value| tuning.dispatch_ms = value,
    },
    Knob {
        name: "first_dispatch_tests",
        limits: [1.0, 1e9],
        candidates: &[1e6, 4e6, 16e6, 64e6],
        get: |tuning| tuning.first_dispatch_tests,
        set: |tuning, value| tuning.first_dispatch_tests = value,
    },
];

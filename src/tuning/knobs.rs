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

macro_rules! knob {
    ($name:literal, $($field:ident).+, |$value:ident| $converted:expr, $limits:expr, $candidates:expr) => {
        Knob {
            name: $name,
            limits: $limits,
            candidates: &$candidates,
            get: |tuning| f64::from(tuning.$($field).+),
            set: |tuning, $value| tuning.$($field).+ = $converted,
        }
    };
}

/// All numbers of a tuning: name, place and type, limits, candidates.
#[rustfmt::skip]
pub static KNOBS: [Knob; 13] = [
    knob!("workgroup", workgroup, |value| value as u32, [1.0, 256.0], [8.0, 16.0, 32.0, 64.0, 128.0, 256.0]),
    knob!("in_place_below", in_place_below, |value| value, [0.0, NEVER], [0.0, 1e3, 1e4, 1e5]),
    knob!("in_turn_from", in_turn_from, |value| value, [0.0, NEVER], [1e3, 1e4, 1e5, NEVER]),
    knob!("paths", paths, |value| value as u32, [1.0, 256.0], [16.0, 32.0, 64.0, 128.0]),
    knob!("texture_tables", texture_tables, |value| value >= 0.5, [0.0, 1.0], [0.0, 1.0]),
    knob!("longest_tile", density.longest_tile, |value| value, [0.0, NEVER], [3.0, 6.0, 12.0, 24.0, NEVER]),
    knob!("light_entries", density.light_entries, |value| value, [0.0, 256.0], [3.0, 6.0, 12.0, 24.0, 48.0]),
    knob!("light_entries_of_many", density.light_entries_of_many, |value| value, [0.0, 64.0], [3.0, 6.0, 12.0]),
    knob!("grid_cells", density.grid_cells, |value| value, [0.01, 64.0], [0.5, 1.0, 3.0, 6.0, 12.0]),
    knob!("grid_cells_of_many", density.grid_cells_of_many, |value| value, [0.01, 16.0], [0.5, 1.0, 2.0]),
    knob!("path_mib", path_mib, |value| value as u32, [1.0, 1024.0], [16.0, 32.0, 64.0, 128.0]),
    knob!("dispatch_ms", dispatch_ms, |value| value, [1.0, 200.0], [10.0, 25.0, 50.0, 100.0, 200.0]),
    knob!("first_dispatch_tests", first_dispatch_tests, |value| value, [1.0, 1e9], [1e6, 4e6, 16e6, 64e6]),
];

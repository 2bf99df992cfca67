//! Pixels from the order of tiles to their places in rows, and what they say of themselves.

use glam::DVec3;
use rayon::prelude::*;

use super::rendered::Rendered;
use super::tiles::TILE_PIXELS;
use crate::area::Area;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::shared::{STATUS_CUT, STATUS_FLAGS, STATUS_NOT_FINITE, STATUS_UNSURE};
use crate::linear::Linear;
use crate::tiles::TILE;

/// How many pixels say what of themselves.
#[derive(Debug)]
pub(super) struct Statuses {
    /// The dispatch that they ought to be of.
    dispatch_bits: u8,
    rendered: Rendered,
    missing: u64,
}

/// Numbers of dispatches go round through these.
const DISPATCHES: u64 = 31;

/// Number `dispatch` as a status byte has it: never 0.
pub(super) fn dispatch_bits(dispatch: u64) -> u8 {
    ((dispatch % DISPATCHES) as u8 + 1) << STATUS_FLAGS.count_ones()
}

impl Statuses {
    /// Of no pixel of this dispatch.
    pub(super) fn of(dispatch_bits: u8) -> Self {
        Self { dispatch_bits, rendered: Rendered::default(), missing: 0 }
    }

    /// What the pixel in this column and row says.
    pub(super) fn add(&mut self, status: u8, pixel: [u32; 2]) {
        if status & !STATUS_FLAGS != self.dispatch_bits {
            self.missing += 1;
            return;
        }
        if status & STATUS_CUT != 0 {
            self.rendered.cut.push(pixel);
        } else if status & STATUS_UNSURE != 0 {
            self.rendered.unsure.push(pixel);
        } else {
            self.rendered.not_finite += u64::from(status & STATUS_NOT_FINITE != 0);
        }
    }

    fn plus(mut self, other: Self) -> Self {
        self.rendered.add(other.rendered);
        Self { missing: self.missing + other.missing, ..self }
    }

    /// Whether loops have ended before their time.
    pub(super) fn is_cut(&self) -> bool {
        !self.rendered.cut.is_empty()
    }

    /// What they say together; an error where the device has left out pixels.
    pub(super) fn checked(self, device: &Device) -> Result<Rendered, Error> {
        match self.missing {
            0 => Ok(self.rendered),
            missing => {
                Err(Error::Wrong(format!("{} has left out {missing} pixels of a dispatch without a word", device.info)))
            }
        }
    }
}

/// Copies colours of a dispatch in tile order to their places in `linear`, the rows of `area`. Each is four numbers, `f64` where they
/// are double: red, green, blue and coverage.
pub(super) fn place_means(words: &[u32], is_double: bool, tiles: &[[u32; 2]], area: Area, linear: &mut [Linear]) {
    let number = |words: &[u32]| match *words {
        [low, high] => f64::from_bits(u64::from(high) << 32 | u64::from(low)),
        [single] => f64::from(f32::from_bits(single)),
        _ => f64::NAN,
    };
    let per_number = if is_double { 2 } else { 1 };
    let mut means = words.chunks_exact(4 * per_number);
    for &[left, top] in tiles {
        for (place, mean) in (0..TILE_PIXELS as u32).zip(&mut means) {
            let [x, y] = [left + place % TILE, top + place / TILE];
            if area.has([x, y]) {
                let [r, g, b, coverage] = std::array::from_fn(|at| number(&mean[at * per_number..][..per_number]));
                linear[area.index([x, y])] = Linear { color: DVec3::new(r, g, b), coverage };
            }
        }
    }
}

/// Copies pixels of a dispatch in tile order to their places in `rgb`, the rows of `area`; returns what their statuses say.
pub(super) fn place_tiles(
    pixels: &[u32],
    dispatch_bits: u8,
    tiles: &[[u32; 2]],
    area: Area,
    rgb: &mut [u8],
) -> Statuses {
    let Area { left, top: first, .. } = area;
    let row_bytes = area.width as usize * 3;
    let mut by_row: Vec<_> = tiles.iter().zip(pixels.chunks(TILE_PIXELS)).collect();
    by_row.sort_by_key(|(tile, _)| tile[1]);
    // The rows in `band` of the tiles that begin in row `y`, of which the first `above` lie before it.
    let place_row = |y: u32, above: u32, band: &mut [u8]| {
        let start = by_row.partition_point(|(tile, _)| tile[1] < y);
        let mut statuses = Statuses::of(dispatch_bits);
        for (tile, pixels) in by_row[start..].iter().take_while(|(tile, _)| tile[1] == y) {
            // A tile may reach beyond the area on either side.
            let columns = tile[0].max(left)..(tile[0] + TILE).min(area.right());
            let before = (columns.start - tile[0]) as usize;
            let lines = pixels.chunks(TILE as usize).skip(above as usize);
            for (j, (row, pixels)) in (y + above..).zip(band.chunks_mut(row_bytes).zip(lines)) {
                let row = &mut row[(columns.start - left) as usize * 3..][..columns.len() * 3];
                let pixels = &pixels[before..];
                let mut any = 0;
                for (target, pixel) in row.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
                    let [r, g, b, status] = pixel.to_le_bytes();
                    *target = [r, g, b];
                    any |= status ^ dispatch_bits;
                }
                // Most pixels have nothing to say.
                if any != 0 {
                    for (i, pixel) in columns.clone().zip(pixels) {
                        statuses.add(pixel.to_le_bytes()[3], [i, j]);
                    }
                }
            }
        }
        statuses
    };
    let above = first % TILE;
    let first_rows = (first.next_multiple_of(TILE) - first) as usize;
    let (rows_of_first, rest) = rgb.split_at_mut(rgb.len().min(first_rows * row_bytes));
    let of_first = place_row(first - above, above, rows_of_first);
    let bands = rest.par_chunks_mut(row_bytes * TILE as usize).enumerate();
    let next = first.next_multiple_of(TILE);
    let of_rest = bands.map(|(index, band)| place_row(next + index as u32 * TILE, 0, band));
    of_first.plus(of_rest.reduce(|| Statuses::of(dispatch_bits), Statuses::plus))
}

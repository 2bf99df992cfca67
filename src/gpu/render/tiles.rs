//! Tiles as the kernel reads them: a word for the place of each.

use crate::gpu::shared;
use crate::tiles::TILE;

/// Pixels of a tile.
pub(super) const TILE_PIXELS: usize = shared::TILE_PIXELS as usize;

/// Bytes of the buffer for so many tiles: `Tiles` of `shaders/slots_tiles.wgsl`.
pub(super) fn tiles_size(dispatch_tiles: u32) -> u64 {
    16 + 4 * u64::from(dispatch_tiles)
}

/// How the place of a tile is divided between the bits of its word.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileWords {
    column_bits: u32,
}

impl TileWords {
    /// For a picture of this width: as many bits for the column as it takes, and the others for the row.
    pub(super) fn new(width: u32) -> Self {
        Self { column_bits: width.div_ceil(TILE).next_power_of_two().trailing_zeros() }
    }

    /// So many rows of pixels at the most may lie between the tiles of a dispatch, wherever they begin. Of a picture that has more
    /// of them, as many fill hundreds of gigabytes.
    pub(super) fn most_rows(self) -> u32 {
        ((1_u64 << (32 - self.column_bits)) - 1).saturating_mul(u64::from(TILE)).try_into().unwrap_or(u32::MAX)
    }

    /// `Tiles` of `shaders/slots_tiles.wgsl`, from the top-left pixels of the tiles.
    pub(super) fn packed(self, dispatch_bits: u32, tiles: &[[u32; 2]]) -> Vec<u8> {
        let first_row = tiles.iter().map(|[_, y]| y / TILE).min().unwrap_or_default();
        let words = tiles.iter().map(|[x, y]| (x / TILE) | (y / TILE - first_row) << self.column_bits);
        let words: Vec<u32> = [self.column_bits, first_row, dispatch_bits, 0].into_iter().chain(words).collect();
        bytemuck::cast_slice(&words).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::PATH_QUEUE_SIZE;
    use super::*;
    use crate::gpu::kernel::module::Module;
    use crate::gpu::kernel::variant::{Kernel, Schedule, Secondary, Storage, Tables, Variant};
    use crate::precision::Tier;

    #[test]
    fn structs_are_as_large_as_the_kernels_have_them() {
        let (storage, secondary, schedule) = (Storage::Tables(Tables::Stored), Secondary::Both, Schedule::AtOnce);
        let plain = Variant::of_ranges(Kernel::Tier(Tier::Fast));
        let variant = Variant { storage, secondary, schedule, dispatch_tiles: 8, ..plain };
        let module = Module::render(&variant).parse();
        let size_of = |name: &str| {
            let types = module.iter().flat_map(|module| module.types.iter());
            let mut sizes = types.filter(|(_, ty)| ty.name.as_deref() == Some(name)).map(|(_, ty)| match ty.inner {
                naga::TypeInner::Struct { span, .. } => u64::from(span),
                _ => 0,
            });
            sizes.next()
        };
        assert_eq!([size_of("Tiles"), size_of("PathQueue")], [Some(tiles_size(8)), Some(PATH_QUEUE_SIZE)]);
    }

    #[test]
    fn tiles_fill_a_uniform_buffer() {
        for (uniform, size) in [(shared::LEAST_UNIFORM, 1 << 14), (1 << 16, 1 << 16), (1 << 31, 1 << 16)] {
            assert_eq!(tiles_size(shared::dispatch_tiles(uniform)), size);
        }
    }

    /// As the kernel does it.
    fn unpacked(bytes: &[u8]) -> Vec<[u32; 2]> {
        let words: Vec<u32> =
            bytes.chunks(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
        let (bits, first_row) = (words[0], words[1]);
        let tile = |word: &u32| [(word - (word >> bits << bits)) * TILE, (first_row + (word >> bits)) * TILE];
        words[4..].iter().map(tile).collect()
    }

    #[test]
    fn tiles_of_every_picture_come_back() {
        const MOST: u32 = 1 << 24;
        for (width, height) in [(1, 1), (8, 8), (9, 9), (1920, 1080), (524_296, 8), (MOST, 1), (1, MOST), (MOST, MOST)]
        {
            let words = TileWords::new(width);
            let rows = words.most_rows().min(height);
            for first in [0, (height - rows) / TILE * TILE] {
                let last = [(width - 1) / TILE * TILE, (first + rows - 1) / TILE * TILE];
                let tiles = [[0, first], [last[0], first], [0, last[1]], last];
                assert_eq!(unpacked(&words.packed(8, &tiles)), tiles, "{width}x{height} from {first}");
            }
        }
    }

    #[test]
    fn rows_that_do_not_fit_together_fill_hundreds_of_gigabytes() {
        for width in [1 << 24, (1 << 23) + 1, 100_000, 1920, 1] {
            let rows = TileWords::new(width).most_rows();
            assert!(rows >= 1 << 24 || u64::from(rows) * u64::from(width) * 3 > 200 << 30, "{width}: {rows}");
        }
    }
}

//! In which order the tiles of a picture are rendered.

use crate::tiles::TILE;

/// Tiles in so many hands, one after the other. Drivers that calculate on the CPU give each of their threads one part of the
/// workgroups: so all have as much to do, and in one part of the picture.
pub(super) fn dealt(tiles: &[[u32; 2]], hands: usize) -> Vec<[u32; 2]> {
    (0..hands).flat_map(|hand| tiles.iter().skip(hand).step_by(hands)).copied().collect()
}

/// The place of a tile on a curve that stays in one part of the picture (Morton, 1966): mirrored rays that begin near each other
/// meet the same spheres.
pub(super) fn curve([x, y]: [u32; 2]) -> u64 {
    let spread = |at: u32| (0..u32::BITS).fold(0, |bits, bit| bits | u64::from(at >> bit & 1) << (2 * bit));
    spread(x / TILE) | spread(y / TILE) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_fills_one_square_after_the_other() {
        let mut tiles: Vec<_> = (0..64).map(|i| [i % 8 * TILE, i / 8 * TILE]).collect();
        tiles.sort_by_key(|&tile| curve(tile));
        for (edge, count) in [(2, 4), (4, 16)] {
            for square in tiles.chunks(count) {
                let corner = square[0].map(|at| at / (edge * TILE));
                assert!(square.iter().all(|tile| tile.map(|at| at / (edge * TILE)) == corner));
            }
        }
    }

    #[test]
    fn hands_have_all_tiles_and_as_many_each() {
        let tiles: Vec<_> = (0..10).map(|x| [x, 0]).collect();
        let places: Vec<_> = dealt(&tiles, 3).iter().map(|tile| tile[0]).collect();
        assert_eq!(places, [0, 3, 6, 9, 1, 4, 7, 2, 5, 8]);
        assert_eq!(dealt(&tiles, 1), tiles);
    }
}

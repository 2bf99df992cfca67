//! What a page shows, so that it is sent only what has changed.

use super::patch::{Patch, Rectangle};
use crate::tiles::TILE;

/// The picture of one page in full resolution, as far as the page has it.
#[derive(Debug)]
pub struct Canvas {
    size: (u32, u32),
    /// Rows of 3 bytes a pixel; empty until the first full rows come.
    rgb: Vec<u8>,
    /// Whether the page shows these rows of tiles as they are here.
    shown: Vec<bool>,
}

impl Canvas {
    /// For a picture of `size`, of which the page shows nothing.
    pub fn new(size: (u32, u32)) -> Self {
        Self { size, rgb: Vec::new(), shown: vec![false; size.1.div_ceil(TILE) as usize] }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The picture, where the page shows all of it in full resolution.
    pub fn complete(&self) -> Option<&[u8]> {
        self.shown.iter().all(|shown| *shown).then_some(self.rgb.as_slice())
    }

    /// The page shows something else in place of all of it.
    pub fn hide(&mut self) {
        self.shown.fill(false);
    }

    /// The page is to show a coarse picture in place of whatever it shows: each of its pixels for `step` × `step`.
    pub fn coarse(&mut self, step: u32, rgb: Vec<u8>) -> Patch {
        self.hide();
        let (width, height) = self.size;
        Patch { size: self.size, step, parts: vec![(Rectangle { x: 0, y: 0, width, height }, rgb)] }
    }

    /// The page is to show full rows from row `first` (a multiple of [`TILE`]) on; `None` where it does already.
    pub fn rows(&mut self, first: u32, rgb: &[u8]) -> Option<Patch> {
        let row_bytes = self.size.0 as usize * 3;
        if self.rgb.is_empty() {
            self.rgb = vec![0; row_bytes * self.size.1 as usize];
        }
        let mut parts: Vec<(Rectangle, Vec<u8>)> = Vec::new();
        for (index, new) in rgb.chunks(row_bytes * TILE as usize).enumerate() {
            let tile_row = (first / TILE) as usize + index;
            let old = &mut self.rgb[tile_row * TILE as usize * row_bytes..][..new.len()];
            let columns = if self.shown[tile_row] { changed(old, new, row_bytes) } else { Some((0, self.size.0)) };
            old.copy_from_slice(new);
            self.shown[tile_row] = true;
            let Some((left, right)) = columns else { continue };
            let (y, height) = (tile_row as u32 * TILE, (new.len() / row_bytes) as u32);
            let pixels = new.chunks(row_bytes).flat_map(|row| &row[left as usize * 3..right as usize * 3]).copied();
            match parts.last_mut() {
                Some((above, rgb)) if above.y + above.height == y && (above.x, above.width) == (left, right - left) => {
                    above.height += height;
                    rgb.extend(pixels);
                }
                _ => parts.push((Rectangle { x: left, y, width: right - left, height }, pixels.collect())),
            }
        }
        (!parts.is_empty()).then_some(Patch { size: self.size, step: 1, parts })
    }
}

/// First and one past the last column in which rows differ.
fn changed(old: &[u8], new: &[u8], row_bytes: usize) -> Option<(u32, u32)> {
    let mut columns: Option<(usize, usize)> = None;
    for (old, new) in old.chunks(row_bytes).zip(new.chunks(row_bytes)) {
        if old == new {
            continue;
        }
        let differs = |(a, b): (&[u8; 3], &[u8; 3])| a != b;
        let pixels = || old.as_chunks::<3>().0.iter().zip(new.as_chunks::<3>().0);
        if let (Some(first), Some(last)) = (pixels().position(differs), pixels().rposition(differs)) {
            let (left, right) = columns.unwrap_or((first, last + 1));
            columns = Some((left.min(first), right.max(last + 1)));
        }
    }
    columns.map(|(left, right)| (left as u32, right as u32))
}

//! Single pixels from the device: a list of them in place of tiles.

use std::time::Instant;

use super::place::Statuses;
use super::{GpuRenderer, MAX_DISPATCH_TILES, TILE_PIXELS, Work};
use crate::gpu::error::Error;
use crate::gpu::shader::Slots;

impl GpuRenderer<'_> {
    /// Renders lists of pixels from now on, and no rows; before the first picture only.
    pub fn take_lists(&mut self) {
        self.inputs.specialisation.slots = Slots::List;
    }

    /// A pixel is expected to take so long, in ms: the first dispatch is sized by that.
    pub fn expect(&mut self, pixel_ms: f64) {
        let tiles = self.gpu.tuned.tuning.dispatch_ms / (pixel_ms * TILE_PIXELS as f64).max(1e-9);
        self.tiles_per_dispatch = (tiles as u32).clamp(1, MAX_DISPATCH_TILES);
    }

    /// Renders the pixels in these columns and rows, after [`GpuRenderer::take_lists`]; each has the value that it has in the
    /// full picture. Returns how many are not finite.
    pub fn pixels(&mut self, pixels: &[[u32; 2]], colors: &mut [[u8; 3]]) -> Result<u64, Error> {
        colors.fill(self.background);
        let covered: Vec<usize> = (0..pixels.len()).filter(|&index| self.cover.has(pixels[index])).collect();
        let list: Vec<[u32; 2]> = covered.iter().map(|&index| pixels[index]).collect();
        self.listed += list.len() as u64;
        // Buffers for this list and no more: the device fills them with zeros first.
        let needed = list.len().div_ceil(TILE_PIXELS) as u64;
        if self.work.is_none() || needed > self.covered_tiles {
            self.covered_tiles = needed;
            self.work = None;
        }

        let mut not_finite = 0;
        let mut start = 0;
        while start < list.len() {
            let work = match self.work.take() {
                Some(work) => work,
                None => self.build()?,
            };
            let most = work.capacity.min(self.tiles_per_dispatch) as usize * TILE_PIXELS;
            let end = list.len().min(start + most);
            let took = self.dispatch(&work, &list[start..end])?;
            let statuses = self.read_list(&work, &covered[start..end], colors)?;
            if self.walks_at_once_instead(statuses, end - start) {
                continue;
            }
            not_finite += statuses.checked(self.gpu)?;
            self.add_rays(&work, end - start)?;
            self.work = Some(work);
            self.set_pace((end - start).div_ceil(TILE_PIXELS), took);
            start = end;
        }
        Ok(not_finite)
    }

    /// Puts the pixels of the last dispatch to their places in `colors`.
    fn read_list(&mut self, work: &Work, places: &[usize], colors: &mut [[u8; 3]]) -> Result<Statuses, Error> {
        let start = Instant::now();
        let statuses = work.pixels.read(self.gpu, places.len(), |values| {
            let mut statuses = Statuses::default();
            for (value, &place) in values.iter().zip(places) {
                let [r, g, b, status] = value.to_le_bytes();
                colors[place] = [r, g, b];
                statuses.add(status);
            }
            statuses
        })?;
        self.times.read_back += start.elapsed();
        Ok(statuses)
    }
}

//! Single pixels from the device: a list of them in place of tiles.

use std::time::Instant;

use super::GpuRenderer;
use super::output::Pixels;
use super::place::Statuses;
use super::rendered::Rendered;
use super::tiles::TILE_PIXELS;
use super::work::Work;
use crate::gpu::device::error::Error;
use crate::misuse::check_pixels;
use crate::stop;

impl GpuRenderer<'_, Pixels> {
    /// Renders the pixels in these columns and rows; each has the value that it has in the full picture.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where a pixel is not of the picture, or there is not one colour for each.
    pub fn pixels(&mut self, pixels: &[[u32; 2]], colors: &mut [[u8; 3]]) -> Result<Rendered, Error> {
        check_pixels(self.area(), pixels, colors.len())?;
        self.gpu.device.guarded(|| self.list(pixels, colors))
    }

    fn list(&mut self, pixels: &[[u32; 2]], colors: &mut [[u8; 3]]) -> Result<Rendered, Error> {
        colors.fill(self.background.0);
        let covered: Vec<usize> = (0..pixels.len()).filter(|&index| self.cover.has(pixels[index])).collect();
        let list: Vec<[u32; 2]> = covered.iter().map(|&index| pixels[index]).collect();
        // Buffers for this list and no more: the device fills them with zeros first.
        let needed = list.len().div_ceil(TILE_PIXELS) as u64;
        if self.work.is_none() || needed > self.covered_tiles {
            self.covered_tiles = needed;
            self.work = None;
        }

        let mut rendered = Rendered::default();
        let mut start = 0;
        while start < list.len() {
            if stop::is_asked() {
                return Err(Error::Stopped);
            }
            let work = match self.work.take() {
                Some(work) => work,
                None => self.build()?,
            };
            let most = work.capacity.min(self.tiles_per_dispatch) as usize * TILE_PIXELS;
            let end = list.len().min(start + most);
            let took = self.dispatch(&work, &list[start..end])?;
            let statuses = self.read_list(&work, &covered[start..end], pixels, colors)?;
            if self.walks_at_once_instead(&statuses) {
                continue;
            }
            rendered.add(statuses.checked(&self.gpu.device)?);
            self.add_counts(&work, end - start, |place| Some(list[start + place]))?;
            self.work = Some(work);
            self.set_pace((end - start).div_ceil(TILE_PIXELS), took);
            start = end;
        }
        self.pixels += pixels.len() as u64;
        Ok(rendered)
    }

    /// Puts the pixels of the last dispatch to their places in `colors`.
    fn read_list(
        &mut self,
        work: &Work,
        places: &[usize],
        pixels: &[[u32; 2]],
        colors: &mut [[u8; 3]],
    ) -> Result<Statuses, Error> {
        let _span = tracing::info_span!("read back").entered();
        let start = Instant::now();
        let dispatch_bits = self.dispatch_bits();
        let statuses = work.pixels.read(&self.gpu.device, places.len(), |values| {
            let mut statuses = Statuses::of(dispatch_bits);
            for (value, &place) in values.iter().zip(places) {
                let [r, g, b, status] = value.to_le_bytes();
                colors[place] = [r, g, b];
                statuses.add(status, pixels[place]);
            }
            statuses
        })?;
        self.times.read_back += start.elapsed();
        Ok(statuses)
    }
}

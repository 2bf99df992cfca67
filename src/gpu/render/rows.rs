//! Rows of a picture from the device, by the tiles that they lie in.

use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::GpuRenderer;
use super::order::{curve, dealt};
use super::output::Rows;
use super::place::{Statuses, place_means, place_tiles};
use super::rendered::Rendered;
use super::term::Term;
use super::tiles::TILE_PIXELS;
use super::work::Work;
use crate::area::Area;
use crate::gpu::device::error::Error;
use crate::linear::Linear;
use crate::misuse::{check_colors, check_rows};
use crate::stop;
use crate::tiles::TILE;

impl GpuRenderer<'_, Rows> {
    /// Renders rows `first` of its part of the picture on into `rgb`, whole rows of 3 bytes a pixel.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where these are no rows of it.
    pub fn rows(&mut self, first: u32, rgb: &mut [u8]) -> Result<Rendered, Error> {
        let area = self.area();
        let count = check_rows(area.size(), first, rgb.len())?;
        self.gpu.device.guarded(|| self.bands(area.top + first, count, rgb, &mut []))
    }

    /// Likewise, with the colours of the same pixels before they are quantised.
    ///
    /// # Errors
    ///
    /// Also [`Error::Misuse`] where there is not one colour for each pixel, or the renderer was not prepared for it.
    pub fn linear_rows(&mut self, first: u32, rgb: &mut [u8], linear: &mut [Linear]) -> Result<Rendered, Error> {
        let area = self.area();
        let count = check_rows(area.size(), first, rgb.len())?;
        check_colors(rgb.len() / 3, if self.is_linear() { linear.len() } else { 0 })?;
        self.gpu.device.guarded(|| self.bands(area.top + first, count, rgb, linear))
    }

    /// Calculates a term of rows `first` on, with its mean where a pixel has several samples.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where these are no rows of it, or the renderer was not prepared with [`terms`](super::Options::terms).
    pub fn terms(&mut self, term: Term, first: u32, values: &mut [Linear]) -> Result<Rendered, Error> {
        check_colors(values.len(), if self.has_terms() { values.len() } else { 0 })?;
        self.asked = term.words();
        let rendered = self.linear_rows(first, &mut vec![0; 3 * values.len()], values)?;
        if term != Term::Background {
            darken_background(values);
        }
        Ok(rendered)
    }

    /// What mirrored or refracted ray `number`, from 1 on in the order in which they are followed, adds to the pixels of rows `first` on.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where these are no rows of it, or the renderer was not prepared for [`one_ray`](super::Options::one_ray).
    pub fn ray(&mut self, number: u32, first: u32, values: &mut [Linear]) -> Result<Rendered, Error> {
        check_colors(values.len(), if self.inputs.specialisation.one_ray { values.len() } else { 0 })?;
        self.asked = [number, 0];
        let rendered = self.linear_rows(first, &mut vec![0; 3 * values.len()], values)?;
        darken_background(values);
        Ok(rendered)
    }

    /// How many shadow and reflection rays the pixels of so many rows from `first` on take, or how many tests shadow rays and all others:
    /// what the renderer was prepared to count, of all samples of a pixel together. Where no sphere is near, it is nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where these are no rows of it.
    pub fn counts(&mut self, first: u32, count: u32) -> Result<(Vec<[u64; 2]>, Rendered), Error> {
        let Area { top, width, .. } = self.area();
        let area = Area { top: top + first, height: count, ..self.area() };
        let pixels = width as usize * count as usize;
        self.counted = Some((area, vec![[0; 2]; pixels]));
        let rendered = self.rows(first, &mut vec![0; 3 * pixels]);
        let (_, counts) = self.counted.take().unwrap_or_default();
        rendered.map(|rendered| (counts, rendered))
    }

    /// `linear` is empty where it is not wanted.
    fn bands(&mut self, first: u32, count: u32, rgb: &mut [u8], linear: &mut [Linear]) -> Result<Rendered, Error> {
        let row_bytes = self.area().width as usize * 3;
        let most = self.tile_words.most_rows();
        let mut rendered = Rendered::default();
        let mut linear = linear.chunks_mut(row_bytes / 3 * most as usize);
        for (start, rgb) in (first..first + count).step_by(most as usize).zip(rgb.chunks_mut(row_bytes * most as usize))
        {
            rendered.add(self.band(start, rgb, linear.next().unwrap_or_default())?);
        }
        self.pixels += u64::from(self.area().width) * u64::from(count);
        Ok(rendered)
    }

    /// Renders rows whose tiles fit into words together.
    fn band(&mut self, first: u32, rgb: &mut [u8], linear: &mut [Linear]) -> Result<Rendered, Error> {
        let row_bytes = self.area().width as usize * 3;
        let count = (rgb.len() / row_bytes) as u32;
        let (background, linear_background) = self.background;
        linear.fill(linear_background);
        rgb.par_chunks_mut(row_bytes).for_each(|row| row.as_chunks_mut::<3>().0.fill(background));

        let area = Area { top: first, height: count, ..self.area() };
        let above = first % TILE;
        let mut tiles = self.cover.covered(first - above, above + count);
        tiles.sort_by_cached_key(|&tile| curve(tile));
        let mut rendered = Rendered::default();
        let mut rest = tiles.as_slice();
        while !rest.is_empty() {
            if stop::is_asked() {
                return Err(Error::Stopped);
            }
            let work = match self.work.take() {
                Some(work) => work,
                None => self.build()?,
            };
            let (now, later) = rest.split_at(rest.len().min(work.capacity.min(self.tiles_per_dispatch) as usize));
            let now = &dealt(now, self.hands);
            let took = self.dispatch(&work, now)?;
            let statuses = self.read_tiles(&work, now, area, rgb)?;
            if self.walks_at_once_instead(&statuses) {
                continue;
            }
            rendered.add(statuses.checked(&self.gpu.device)?);
            if !linear.is_empty() {
                self.read_means(&work, now, area, linear)?;
            }
            self.add_counts(&work, now.len() * TILE_PIXELS, |place| {
                let ([left, top], place) = (now[place / TILE_PIXELS], (place % TILE_PIXELS) as u32);
                // A tile may reach beyond the picture, or into pixels that are not asked for.
                Some([left + place % TILE, top + place / TILE]).filter(|&pixel| area.has(pixel))
            })?;
            self.work = Some(work);
            self.set_pace(now.len(), took);
            rest = later;
        }
        Ok(rendered)
    }

    /// Puts the colours of the pixels of `tiles` into `linear`, the rows of `area`.
    fn read_means(&mut self, work: &Work, tiles: &[[u32; 2]], area: Area, linear: &mut [Linear]) -> Result<(), Error> {
        let start = Instant::now();
        let is_double = self.inputs.specialisation.kernel.is_double();
        let words = tiles.len() * TILE_PIXELS * if is_double { 8 } else { 4 };
        work.means.read(&self.gpu.device, words, |words| place_means(words, is_double, tiles, area, linear))?;
        self.times.read_back += start.elapsed();
        Ok(())
    }

    /// Puts the pixels of `tiles` into `rgb`, the rows of `area`.
    fn read_tiles(&mut self, work: &Work, tiles: &[[u32; 2]], area: Area, rgb: &mut [u8]) -> Result<Statuses, Error> {
        let _span = tracing::info_span!("read back").entered();
        let start = Instant::now();
        let dispatch_bits = self.dispatch_bits();
        let place = |pixels: &[u32]| place_tiles(pixels, dispatch_bits, tiles, area, rgb);
        let statuses = work.pixels.read(&self.gpu.device, tiles.len() * TILE_PIXELS, place)?;
        self.times.read_back += start.elapsed();
        Ok(statuses)
    }
}

/// Where no sphere is near, nothing is dispatched, and a pixel has the background.
fn darken_background(values: &mut [Linear]) {
    values.iter_mut().filter(|value| value.coverage == 0.0).for_each(|value| value.color = DVec3::ZERO);
}

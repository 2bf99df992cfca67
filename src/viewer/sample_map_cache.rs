//! Moving pictures of which a part is sampled: which maps there are, and which of them a picture takes.

use std::sync::Arc;

use super::preview::{PreviewMode, PreviewOptions};
use super::sample_map::{SLOTS, SampleColors, SampleMap};
use crate::engine::{Backend, Filler, Options};
use crate::gpu;
use crate::sampling::{Density, Samples};

/// A picture of more pixels moves in a coarse way; and so many pixels may all maps of a page have together.
const MAX_PIXELS: u64 = 1 << 23;
/// A cheaper map is taken where the pictures take so many times too long.
const TOO_LONG: f64 = 1.25;
/// A denser map is taken where its pictures would take this part of the time.
const SHORT_ENOUGH: f64 = 0.7;

/// Where the samples of moving pictures are, and which of them each pixel shows.
#[derive(Debug)]
pub(super) struct PreviewMap {
    pub(super) density: Density,
    pub(super) samples: Samples,
    /// Number of each sample in reading order.
    order: Vec<u32>,
    /// What a page needs to know before the samples.
    offsets: SampleMap,
    /// Where the page keeps that.
    slot: u32,
}

impl PreviewMap {
    fn new(filler: &Filler, size: (u32, u32), density: Density, slot: u32) -> Result<Self, gpu::Error> {
        let samples = Samples::new(size, &density)?;
        let offsets = SampleMap::new(size, &filler.nearest_samples(&samples)?);
        let order = reading_order(&samples);
        Ok(Self { density, samples, order, offsets, slot })
    }

    fn is_for(&self, size: (u32, u32), density: Density) -> bool {
        self.samples.size() == size && self.density == density
    }

    /// The message with the colours of all samples, in the order of `samples`.
    pub(super) fn colors_message(&self, colors: &[[u8; 3]]) -> Vec<u8> {
        let mut sorted = vec![[0; 3]; colors.len()];
        for (color, &number) in colors.iter().zip(&self.order) {
            sorted[number as usize] = *color;
        }
        SampleColors { size: self.samples.size(), rgb: sorted.into_flattened() }.encode(self.slot)
    }
}

/// The number of each sample in reading order.
fn reading_order(samples: &Samples) -> Vec<u32> {
    let mut starts = vec![0; samples.size().1 as usize + 1];
    for [_, y] in samples.pixels() {
        starts[*y as usize + 1] += 1;
    }
    for y in 1..starts.len() {
        starts[y] += starts[y - 1];
    }
    // Tiles come from left to right, so that the samples of a row are met in their order.
    let number = |&[_, y]: &[u32; 2]| {
        let next = &mut starts[y as usize];
        *next += 1;
        *next - 1
    };
    samples.pixels().iter().map(number).collect()
}

/// A map, and whether the page knows it.
#[derive(Debug)]
struct Entry {
    map: Arc<PreviewMap>,
    told: bool,
    /// The higher, the later it was used.
    used: u64,
}

/// The maps of one page.
#[derive(Debug, Default)]
pub(super) struct SampleMapCache<'g> {
    filler: Option<Filler<'g>>,
    entries: Vec<Entry>,
    uses: u64,
    level: usize,
    /// Time of a sample, and of everything else of a picture, as measured.
    sample_ms: f64,
    rest_ms: f64,
    measured: bool,
}

impl<'g> SampleMapCache<'g> {
    /// The map whose pictures take no longer than `limit`, in ms, or about so; none where the page wants none, or the picture
    /// is too large or too thin. Before any was measured, `guess` is the time of a sample.
    pub(super) fn choose(
        &mut self,
        backend: Backend<'g>,
        preview: &PreviewOptions,
        size: (u32, u32),
        [limit, guess]: [f64; 2],
    ) -> Result<Option<Arc<PreviewMap>>, gpu::Error> {
        if !is_wanted(preview, size) {
            return Ok(None);
        }
        if !self.measured {
            self.sample_ms = guess;
        }
        self.choose_level(preview, size, limit);
        let map = self.make(backend, preview.density(self.level, size), size)?;
        // In a thin picture neighbours can be too far apart for a message.
        Ok(Some(map).filter(|map| map.offsets.fits))
    }

    /// What the page must hear before it gets a picture of this map.
    pub(super) fn untold(&mut self, map: &Arc<PreviewMap>) -> Option<Vec<u8>> {
        let entry = self.entries.iter_mut().find(|entry| Arc::ptr_eq(&entry.map, map))?;
        let told = std::mem::replace(&mut entry.told, true);
        (!told).then(|| map.offsets.encode(map.slot))
    }

    /// A map that may soon be wanted and is not there, the likeliest one first.
    pub(super) fn missing(&self, preview: &PreviewOptions, size: (u32, u32)) -> Option<Density> {
        if !is_wanted(preview, size) {
            return None;
        }
        let levels = preview.levels();
        let level = self.level.min(levels - 1);
        let mut likely: Vec<usize> = (0..levels).collect();
        likely.sort_by_key(|other| other.abs_diff(level));
        let densities = likely.into_iter().take(slots(size)).map(|level| preview.density(level, size));
        densities.into_iter().find(|density| !self.entries.iter().any(|entry| entry.map.is_for(size, *density)))
    }

    /// The map of this density, made unless it is there.
    pub(super) fn make(
        &mut self,
        backend: Backend<'g>,
        density: Density,
        size: (u32, u32),
    ) -> Result<Arc<PreviewMap>, gpu::Error> {
        self.uses += 1;
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.map.is_for(size, density)) {
            entry.used = self.uses;
            return Ok(Arc::clone(&entry.map));
        }
        // Maps of another size are of no use any more.
        self.entries.retain(|entry| entry.map.samples.size() == size);
        if self.entries.len() >= slots(size)
            && let Some(oldest) = (0..self.entries.len()).min_by_key(|&index| self.entries[index].used)
        {
            self.entries.swap_remove(oldest);
        }
        let is_free = |slot: &u32| !self.entries.iter().any(|entry| entry.map.slot == *slot);
        let slot = (0..SLOTS).find(is_free).unwrap_or_default();
        let filler = match self.filler.take() {
            Some(filler) => filler,
            None => Filler::fastest(backend)?,
        };
        let map = Arc::new(PreviewMap::new(&filler, size, density, slot)?);
        self.filler = Some(filler);
        self.entries.push(Entry { map: Arc::clone(&map), told: false, used: self.uses });
        Ok(map)
    }

    /// Stays where it is unless another level is clearly better, since changing takes time as well.
    fn choose_level(&mut self, preview: &PreviewOptions, size: (u32, u32), limit: f64) {
        let last = preview.levels() - 1;
        // What does not go with the samples cannot be saved.
        let limit = limit.max(self.rest_ms + 8.0);
        let forecast = |level: usize| self.rest_ms + self.sample_ms * preview.density(level, size).forecast(size);
        self.level = self.level.min(last);
        while self.level < last && forecast(self.level) > TOO_LONG * limit {
            self.level += 1;
        }
        while self.level > 0 && forecast(self.level - 1) < SHORT_ENOUGH * limit {
            self.level -= 1;
        }
    }

    /// What its engines can be told.
    pub(super) fn options(&self) -> Options {
        Options { pixel_ms: self.measured.then_some(self.sample_ms), ..Options::default() }
    }

    /// Learns from a picture of so many samples that took so long, rays alone and all in all, in ms.
    pub(super) fn learn(&mut self, samples: usize, rays: f64, all: f64) {
        let mean = |old: f64, new: f64| if self.measured { old.mul_add(0.7, new * 0.3) } else { new };
        self.sample_ms = mean(self.sample_ms, rays / samples.max(1) as f64);
        self.rest_ms = mean(self.rest_ms, (all - rays).max(0.0));
        self.measured = true;
    }
}

fn pixel_count(size: (u32, u32)) -> u64 {
    u64::from(size.0) * u64::from(size.1)
}

/// Whether moving pictures of this size are sampled in part.
fn is_wanted(preview: &PreviewOptions, size: (u32, u32)) -> bool {
    preview.mode != PreviewMode::Coarse && Samples::obstacle(size).is_none() && pixel_count(size) <= MAX_PIXELS
}

/// How many maps of this size are kept.
fn slots(size: (u32, u32)) -> usize {
    (MAX_PIXELS / pixel_count(size)).clamp(1, u64::from(SLOTS)) as usize
}

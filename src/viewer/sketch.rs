//! Moving pictures of which a part is sampled; at rest the rest follows.

use std::collections::VecDeque;
use std::sync::Arc;

use super::attention::{Attention, Economy};
use super::places::{Places, SampleColors};
use crate::engine::{Backend, Filler};
use crate::gpu;
use crate::sampling::{Density, Samples};

/// Maps that are kept: making one takes as long as some pictures.
const MAX_KEPT: usize = 6;
/// A cheaper map is taken where the pictures take so many times too long.
const TOO_LONG: f64 = 1.25;
/// A denser map is taken where its pictures would take this part of the time.
const SHORT_ENOUGH: f64 = 0.7;

/// Where the samples of moving pictures are, and which of them each pixel shows.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) density: Density,
    pub(super) samples: Samples,
    /// Number of each sample in reading order.
    order: Vec<u32>,
    /// What a page needs to know before the samples.
    pub(super) places: Places,
}

impl Plan {
    fn new(filler: &Filler, size: (u32, u32), density: Density) -> Result<Self, gpu::Error> {
        let samples = Samples::new(size, &density);
        let places = Places::new(size, &filler.nearest_samples(&samples)?);
        let mut by_place: Vec<u32> = (0..samples.pixels.len() as u32).collect();
        by_place.sort_unstable_by_key(|&index| {
            let [x, y] = samples.pixels[index as usize];
            (y, x)
        });
        let mut order = vec![0; by_place.len()];
        for (number, index) in by_place.into_iter().enumerate() {
            order[index as usize] = number as u32;
        }
        Ok(Self { density, samples, order, places })
    }

    /// The message with the colours of all samples, in the order of `samples`.
    pub(super) fn message(&self, colors: &[[u8; 3]]) -> SampleColors {
        let mut sorted = vec![[0; 3]; colors.len()];
        for (color, &number) in colors.iter().zip(&self.order) {
            sorted[number as usize] = *color;
        }
        SampleColors { size: self.samples.size, rgb: sorted.into_flattened() }
    }
}

/// The maps of one page.
#[derive(Debug, Default)]
pub(super) struct Sketcher<'g> {
    filler: Option<Filler<'g>>,
    kept: VecDeque<Arc<Plan>>,
    level: usize,
    /// The map that the page knows.
    pub(super) told: Option<Arc<Plan>>,
    /// Time of a sample, in ms, and of everything else of a picture, as measured.
    sample: f64,
    rest: f64,
    measured: bool,
}

impl<'g> Sketcher<'g> {
    /// The map whose pictures take no longer than `limit`, in ms, or about so; none where the page wants none, or the picture
    /// is too large or too thin.
    pub(super) fn plan(
        &mut self,
        backend: Backend<'g>,
        attention: &Attention,
        size: (u32, u32),
        limit: f64,
    ) -> Result<Option<Arc<Plan>>, gpu::Error> {
        if attention.economy == Economy::Coarse || Samples::obstacle(size).is_some() {
            return Ok(None);
        }
        self.choose_level(attention, size, limit);
        let density = attention.density(self.level, size);
        if let Some(index) = self.kept.iter().position(|plan| plan.density == density && plan.samples.size == size) {
            let plan = self.kept.remove(index);
            self.kept.extend(plan);
        } else {
            let filler = match self.filler.take() {
                Some(filler) => filler,
                None => Filler::new(backend)?,
            };
            let plan = Plan::new(&filler, size, density)?;
            self.filler = Some(filler);
            if self.kept.len() == MAX_KEPT {
                self.kept.pop_front();
            }
            self.kept.push_back(Arc::new(plan));
        }
        // In a thin picture neighbours can be too far apart for a message.
        Ok(self.kept.back().filter(|plan| plan.places.fits).cloned())
    }

    /// Whether the map for the next picture is there.
    pub(super) fn is_ready(&self, attention: &Attention, size: (u32, u32)) -> bool {
        let density = attention.density(self.level, size);
        attention.economy == Economy::Coarse
            || Samples::obstacle(size).is_some()
            || self.kept.iter().any(|plan| plan.density == density && plan.samples.size == size)
    }

    /// Stays where it is unless another level is clearly better, since changing takes time as well.
    fn choose_level(&mut self, attention: &Attention, size: (u32, u32), limit: f64) {
        let last = attention.levels() - 1;
        if !self.measured {
            self.level = last.min(2);
            return;
        }
        // What does not go with the samples cannot be saved.
        let limit = limit.max(self.rest + 8.0);
        let forecast = |level: usize| self.rest + self.sample * attention.density(level, size).forecast(size);
        self.level = self.level.min(last);
        while self.level < last && forecast(self.level) > TOO_LONG * limit {
            self.level += 1;
        }
        while self.level > 0 && forecast(self.level - 1) < SHORT_ENOUGH * limit {
            self.level -= 1;
        }
    }

    /// Learns from a picture of so many samples that took so long, rays alone and all in all, in ms.
    pub(super) fn learn(&mut self, samples: usize, rays: f64, all: f64) {
        let mean = |old: f64, new: f64| if self.measured { old.mul_add(0.7, new * 0.3) } else { new };
        self.sample = mean(self.sample, rays / samples.max(1) as f64);
        self.rest = mean(self.rest, (all - rays).max(0.0));
        self.measured = true;
    }
}

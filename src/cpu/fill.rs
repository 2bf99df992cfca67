//! Pixels without a sample filled from those that have one; read it beside `shaders/jump.wgsl` and `shaders/filled_*.wgsl`. All
//! numbers are integers, so that device and reference give the same bytes.

use rayon::prelude::*;

use crate::misuse::{Misuse, check_colors};
use crate::sampling::{Fill, NO_SAMPLE, Samples, UNIT_WEIGHT, flood_steps, packed};

/// The pixel at a packed place.
fn place(packed: u32) -> [i32; 2] {
    [(packed & 0xffff).cast_signed(), (packed >> 16).cast_signed()]
}

/// The pixel in this column and row, both below 2¹⁵.
fn pixel_at(x: usize, y: usize) -> [i32; 2] {
    [(x as u32).cast_signed(), (y as u32).cast_signed()]
}

/// Square of the distance of two pixels.
fn distance_squared(a: [i32; 2], b: [i32; 2]) -> u32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx).cast_unsigned() + (dy * dy).cast_unsigned()
}

/// The neighbours that a jump looks at, in this order.
const NEIGHBOURS: [[i32; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Where the nearest sample of each pixel lies, packed, pixels in reading order. Jump flooding may miss the nearest where several
/// are almost equally near; between samples as even as these, tests find no such pixel.
pub fn nearest_samples(samples: &Samples) -> Vec<u32> {
    let (width, height) = samples.size();
    let across = width as usize;
    let mut owners = vec![NO_SAMPLE; across * height as usize];
    for &[x, y] in samples.pixels() {
        owners[y as usize * across + x as usize] = packed([x, y]);
    }
    let mut next = owners.clone();
    for step in flood_steps(samples.reach()) {
        let flood = Flood { size: (width, height), step: step.cast_signed(), owners: &owners };
        next.par_chunks_mut(across).enumerate().for_each(|(y, row)| {
            for (x, owner) in row.iter_mut().enumerate() {
                *owner = flood.jump(pixel_at(x, y));
            }
        });
        std::mem::swap(&mut owners, &mut next);
    }
    owners
}

/// The nearest samples that are found by jumps: each pixel asks those around.
struct Flood<'a> {
    size: (u32, u32),
    /// How far a jump looks, in pixels.
    step: i32,
    /// The nearest samples so far.
    owners: &'a [u32],
}

impl Flood<'_> {
    /// The nearest of the samples that a pixel and those around have for their nearest; of equally near ones the one farther
    /// up, then farther left.
    fn jump(&self, pixel: [i32; 2]) -> u32 {
        let (width, height) = (self.size.0.cast_signed(), self.size.1.cast_signed());
        let index = |[x, y]: [i32; 2]| y as usize * width as usize + x as usize;
        let distance = |owner| if owner == NO_SAMPLE { u32::MAX } else { distance_squared(pixel, place(owner)) };
        let mut nearest = self.owners[index(pixel)];
        let mut least = distance(nearest);
        if least == 0 {
            return nearest;
        }
        for [dx, dy] in NEIGHBOURS {
            let [x, y] = [pixel[0] + dx * self.step, pixel[1] + dy * self.step];
            if x < 0 || y < 0 || x >= width || y >= height {
                continue;
            }
            let other = self.owners[index([x, y])];
            if other == nearest {
                continue;
            }
            let away = distance(other);
            if away < least || (away == least && other < nearest) {
                (nearest, least) = (other, away);
            }
        }
        nearest
    }
}

/// The whole picture from `colors`, one for each of `samples`, 3 bytes a pixel.
///
/// # Errors
///
/// [`Misuse::Colors`] where there is not one for each.
pub fn filled(samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, Misuse> {
    check_colors(samples.pixels().len(), colors.len())?;
    let across = samples.size().0 as usize;
    let owners = nearest_samples(samples);
    let mut known = vec![[0; 3]; owners.len()];
    for (&[x, y], color) in samples.pixels().iter().zip(colors) {
        known[y as usize * across + x as usize] = *color;
    }
    let sources = Sources { size: samples.size(), owners: &owners, known: &known };
    let mut rgb = vec![0; owners.len() * 3];
    rgb.par_chunks_mut(across * 3).enumerate().for_each(|(y, row)| {
        for (x, color) in row.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let pixel = pixel_at(x, y);
            *color = match fill {
                Fill::Nearest => sources.color_of(owners[y * across + x]),
                Fill::Smooth => sources.smooth(pixel),
            };
        }
    });
    Ok(rgb)
}

/// What pixels are filled from.
struct Sources<'a> {
    size: (u32, u32),
    /// The nearest sample of each pixel.
    owners: &'a [u32],
    /// Colours of the sampled pixels.
    known: &'a [[u8; 3]],
}

impl Sources<'_> {
    fn index(&self, [x, y]: [i32; 2]) -> usize {
        y as usize * self.size.0 as usize + x as usize
    }

    fn color_of(&self, owner: u32) -> [u8; 3] {
        self.known[self.index(place(owner))]
    }

    /// The mean of the nearest sample and those that the eight pixels around at its distance have for their nearest, each
    /// weighted with one over the square of its distance (D. Shepard, "A two-dimensional interpolation function for
    /// irregularly-spaced data", 1968).
    fn smooth(&self, pixel: [i32; 2]) -> [u8; 3] {
        let nearest = self.owners[self.index(pixel)];
        let at = place(nearest);
        if at == pixel {
            return self.color_of(nearest);
        }
        let around = (at[0] - pixel[0]).abs().max((at[1] - pixel[1]).abs()) + 1;
        let mut weights = 0;
        let mut sums = [0; 3];
        let mut add = |owner: u32| {
            let weight = (UNIT_WEIGHT / distance_squared(pixel, place(owner))).max(1);
            weights += weight;
            for (sum, level) in sums.iter_mut().zip(self.color_of(owner)) {
                *sum += weight * u32::from(level);
            }
        };
        add(nearest);
        let last = [self.size.0.cast_signed() - 1, self.size.1.cast_signed() - 1];
        for [dx, dy] in NEIGHBOURS {
            let [x, y] = [pixel[0] + dx * around, pixel[1] + dy * around];
            add(self.owners[self.index([x.clamp(0, last[0]), y.clamp(0, last[1])])]);
        }
        sums.map(|sum| ((sum + weights / 2) / weights) as u8)
    }
}

//! Pixels without a sample filled on the device from those that have one; `src/cpu/fill.rs` does the same.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::device::Gpu;
use super::error::Error;
use super::readable::Readable;
use super::shader::Module;
use super::shared::SMALL_GROUP;
use super::spirv::Parsed;
use super::stage::Access::{self, Read, ReadWrite, Uniform};
use super::stage::{Resource, Stage};
use super::upload::small_buffer;
use crate::misuse::check_colors;
use crate::sampling::{Fill, NO_SAMPLE, Samples, flood_steps, packed};

/// The kernels that fill pictures.
#[derive(Debug)]
pub struct Reconstructor<'a> {
    gpu: &'a Gpu,
    jump: Stage,
    fills: HashMap<Fill, Stage>,
}

impl<'a> Reconstructor<'a> {
    /// Compiles the kernel that finds nearest samples.
    pub fn new(gpu: &'a Gpu) -> Result<Self, Error> {
        let jump = gpu.guarded(|| stage(gpu, &Module::flood(), "jump", &[Uniform, Read, ReadWrite]))?;
        Ok(Self { gpu, jump, fills: HashMap::new() })
    }

    /// Where the nearest sample of each pixel lies, packed, pixels in reading order.
    pub fn nearest_samples(&self, samples: &Samples) -> Result<Vec<u32>, Error> {
        self.gpu.guarded(|| self.flood(samples)?.read(self.gpu, pixel_count(samples), <[u32]>::to_vec))
    }

    /// The whole picture from `colors`, one for each of `samples`, 3 bytes a pixel.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where there is not one for each.
    pub fn filled(&mut self, samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, Error> {
        check_colors(samples.pixels().len(), colors.len())?;
        self.gpu.guarded(|| self.filled_checked(samples, colors, fill))
    }

    fn filled_checked(&mut self, samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, Error> {
        let gpu = self.gpu;
        let owners = self.flood(samples)?;
        let kernel = match self.fills.entry(fill) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                entry.insert(stage(gpu, &Module::fill(fill), "fill", &[Uniform, Read, Read, ReadWrite])?)
            }
        };
        let mut known = vec![0_u32; pixel_count(samples)];
        for (pixel, &[r, g, b]) in samples.pixels().iter().zip(colors) {
            known[index(samples, *pixel)] = u32::from_le_bytes([r, g, b, 0]);
        }
        let picture = gpu.checked("filling a picture", || {
            let known = storage(gpu, &known);
            let picture = Readable::new(gpu, pixel_count(samples) as u64);
            let params = params(gpu, samples, 0);
            let bound = [&params, &owners.buffer, &known, &picture.buffer];
            run(gpu, kernel, samples, &[bind(gpu, kernel, &bound)]);
            picture
        })?;
        picture.read(gpu, pixel_count(samples), |pixels| {
            let mut rgb = Vec::with_capacity(pixels.len() * 3);
            for pixel in pixels {
                let [r, g, b, _] = pixel.to_le_bytes();
                rgb.extend([r, g, b]);
            }
            rgb
        })
    }

    /// The nearest samples, on the device.
    fn flood(&self, samples: &Samples) -> Result<Readable, Error> {
        let gpu = self.gpu;
        let bytes = pixel_count(samples) as u64 * 4;
        let limit = gpu.info.max_storage_binding.min(gpu.info.max_buffer);
        if bytes > limit {
            let message = format!("the nearest samples take {bytes} bytes, but {} binds {limit} at the most", gpu.info);
            return Err(Error::NoDevice(message));
        }
        let mut owners = vec![NO_SAMPLE; pixel_count(samples)];
        for pixel in samples.pixels() {
            owners[index(samples, *pixel)] = packed(*pixel);
        }
        gpu.checked("finding nearest samples", || {
            let first = storage(gpu, &owners);
            let mut ends = [Readable::new(gpu, owners.len() as u64), Readable::new(gpu, owners.len() as u64)];
            let mut groups = Vec::new();
            let mut from = &first;
            for (pass, step) in flood_steps(samples.reach()).into_iter().enumerate() {
                let to = &ends[pass % 2].buffer;
                groups.push(bind(gpu, &self.jump, &[&params(gpu, samples, step), from, to]));
                from = to;
            }
            run(gpu, &self.jump, samples, &groups);
            ends.swap(0, (groups.len() - 1) % 2);
            let [last, _] = ends;
            last
        })
    }
}

fn pixel_count(samples: &Samples) -> usize {
    samples.size().0 as usize * samples.size().1 as usize
}

fn index(samples: &Samples, [x, y]: [u32; 2]) -> usize {
    y as usize * samples.size().0 as usize + x as usize
}

/// What `Flood` of `shaders/flood.wgsl` reads.
fn params(gpu: &Gpu, samples: &Samples, step: u32) -> wgpu::Buffer {
    let contents = [samples.size().0, samples.size().1, step, 0];
    let contents = bytemuck::cast_slice(&contents);
    let usage = wgpu::BufferUsages::UNIFORM;
    small_buffer(gpu, contents, usage)
}

fn storage(gpu: &Gpu, values: &[u32]) -> wgpu::Buffer {
    small_buffer(gpu, bytemuck::cast_slice(values), wgpu::BufferUsages::STORAGE)
}

/// A kernel whose bindings are used like this, in their order.
fn stage(gpu: &Gpu, module: &Module, entry_point: &str, uses: &[Access]) -> Result<Stage, Error> {
    let bindings: Vec<_> = (0..).zip(uses.iter().copied()).collect();
    Stage::new(gpu, &Parsed::new(module).map_err(Error::Lost)?, entry_point, &[], &bindings)
}

/// Binds buffers in the order of their bindings.
fn bind(gpu: &Gpu, stage: &Stage, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
    let resources = buffers.iter().map(|&buffer| Resource::Buffer(buffer.clone()));
    stage.bind(gpu, &(0..).zip(resources).collect::<Vec<_>>())
}

/// Runs a kernel over all pixels, once for each group.
fn run(gpu: &Gpu, stage: &Stage, samples: &Samples, groups: &[wgpu::BindGroup]) {
    let (width, height) = samples.size();
    // A dispatch of its own for each, so that none is long; workgroups lie in rows.
    for group in groups {
        stage.dispatch(gpu, group, [width.div_ceil(SMALL_GROUP), height]);
    }
}

//! Pixels without a sample filled on the device from those that have one; `src/cpu/fill.rs` does the same.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::readable::Readable;
use crate::gpu::device::upload::small_buffer;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::compiler::Compiler;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::pipeline::{Pipeline, Resource};
use crate::gpu::kernel::spirv::ParsedModule;
use crate::gpu::shared::SMALL_GROUP;
use crate::misuse::check_colors;
use crate::sampling::{Fill, NO_SAMPLE, Samples, flood_steps, packed};

/// The kernels that fill pictures.
#[derive(Debug)]
pub struct Reconstructor<'a> {
    compiler: Compiler<'a>,
    jump: Pipeline,
    fills: HashMap<Fill, Pipeline>,
}

impl<'a> Reconstructor<'a> {
    /// Compiles the kernel that finds nearest samples.
    pub fn new(gpu: &'a Gpu) -> Result<Self, Error> {
        let compiler = gpu.compiler();
        let jump = compiler.device.guarded(|| pipeline(compiler, &Module::flood(), "jump"))?;
        Ok(Self { compiler, jump, fills: HashMap::new() })
    }

    /// Where the nearest sample of each pixel lies, packed, pixels in reading order.
    pub fn nearest_samples(&self, samples: &Samples) -> Result<Vec<u32>, Error> {
        self.compiler
            .device
            .guarded(|| self.flood(samples)?.read(self.compiler.device, pixel_count(samples), <[u32]>::to_vec))
    }

    /// The whole picture from `colors`, one for each of `samples`, 3 bytes a pixel.
    ///
    /// # Errors
    ///
    /// [`Error::Misuse`] where there is not one for each.
    pub fn filled(&mut self, samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, Error> {
        check_colors(samples.pixels().len(), colors.len())?;
        self.compiler.device.guarded(|| self.filled_checked(samples, colors, fill))
    }

    fn filled_checked(&mut self, samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, Error> {
        let device = self.compiler.device;
        let owners = self.flood(samples)?;
        let kernel = match self.fills.entry(fill) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(pipeline(self.compiler, &Module::fill(fill), "fill")?),
        };
        let mut known = vec![0_u32; pixel_count(samples)];
        for (pixel, &[r, g, b]) in samples.pixels().iter().zip(colors) {
            known[index(samples, *pixel)] = u32::from_le_bytes([r, g, b, 0]);
        }
        let picture = device.checked("filling a picture", || {
            let known = storage(device, &known);
            let picture = Readable::new(device, pixel_count(samples) as u64);
            let params = params(device, samples, 0);
            let bound =
                [("flood", &params), ("owners", &owners.buffer), ("known", &known), ("picture", &picture.buffer)];
            run(device, kernel, samples, &[bind(device, kernel, &bound)]);
            picture
        })?;
        picture.read(device, pixel_count(samples), |pixels| {
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
        let device = self.compiler.device;
        let bytes = pixel_count(samples) as u64 * 4;
        let limit = device.info.max_storage_binding.min(device.info.max_buffer);
        if bytes > limit {
            let limit = format!("they take {bytes} bytes, and it binds {limit} at the most");
            return Err(Error::too_large(&device.info, "the nearest samples", limit));
        }
        let mut owners = vec![NO_SAMPLE; pixel_count(samples)];
        for pixel in samples.pixels() {
            owners[index(samples, *pixel)] = packed(*pixel);
        }
        device.checked("finding nearest samples", || {
            let first = storage(device, &owners);
            let mut ends = [Readable::new(device, owners.len() as u64), Readable::new(device, owners.len() as u64)];
            let mut groups = Vec::new();
            let mut from = &first;
            for (pass, step) in flood_steps(samples.reach()).into_iter().enumerate() {
                let to = &ends[pass % 2].buffer;
                groups.push(bind(
                    device,
                    &self.jump,
                    &[("flood", &params(device, samples, step)), ("owners", from), ("next_owners", to)],
                ));
                from = to;
            }
            run(device, &self.jump, samples, &groups);
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
fn params(device: &Device, samples: &Samples, step: u32) -> wgpu::Buffer {
    let contents = [samples.size().0, samples.size().1, step, 0];
    let contents = bytemuck::cast_slice(&contents);
    let usage = wgpu::BufferUsages::UNIFORM;
    small_buffer(device, contents, usage)
}

fn storage(device: &Device, values: &[u32]) -> wgpu::Buffer {
    small_buffer(device, bytemuck::cast_slice(values), wgpu::BufferUsages::STORAGE)
}

fn pipeline(compiler: Compiler, module: &Module, entry_point: &str) -> Result<Pipeline, Error> {
    Pipeline::new(compiler, &ParsedModule::new(module).map_err(Error::Shader)?, entry_point, &[])
}

fn bind(device: &Device, pipeline: &Pipeline, buffers: &[(&str, &wgpu::Buffer)]) -> wgpu::BindGroup {
    let resources = buffers.iter().map(|&(name, buffer)| (name, Resource::Buffer(buffer.clone())));
    pipeline.bind(device, &resources.collect::<Vec<_>>())
}

/// Runs a kernel over all pixels, once for each group.
fn run(device: &Device, pipeline: &Pipeline, samples: &Samples, groups: &[wgpu::BindGroup]) {
    let (width, height) = samples.size();
    // A dispatch of its own for each, so that none is long; workgroups lie in rows.
    for group in groups {
        pipeline.dispatch(device, group, [width.div_ceil(SMALL_GROUP), height]);
    }
}

//! Rows of pixels from the device: tiles in dispatches that stay short, read back and put in place.

use std::time::{Duration, Instant};

use rayon::prelude::*;
use wgpu::util::DeviceExt;

use super::device::Gpu;
use super::error::Error;
use super::pack::Packed;
use super::pipeline::{MAX_FEW, Specialisation, compile};
use super::readable::Readable;
use super::timestamps::Timestamps;
use crate::camera::Camera;
use crate::effects::{Effect, Effects};
use crate::geometry::in_range;
use crate::precision::Tier;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::tiles::{Cover, TILE};

/// Pixels of a tile.
const TILE_PIXELS: usize = (TILE * TILE) as usize;
/// A dispatch should take about this long: long enough to hide its overhead, far below what loses a device.
const TARGET_DISPATCH: Duration = Duration::from_millis(25);
/// Intersection tests of the first dispatch, before any is measured: some milliseconds on the slowest device seen.
const FIRST_DISPATCH_TESTS: u64 = 4_000_000;
/// Tiles of a dispatch at the most, for the size of the pixel buffer: 16 MiB.
const MAX_DISPATCH_TILES: u32 = 65_536;

/// Times of the work on the device so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct DeviceTimes {
    /// From shader text to a kernel that has run once on one tile.
    pub compile: Duration,
    /// All dispatches, from submission to completion.
    pub render: Duration,
    /// All dispatches by the device's own clock; zero where it is not asked or has none.
    pub on_device: Duration,
    /// From the device's memory to rows.
    pub read_back: Duration,
    /// The longest dispatch.
    pub longest_dispatch: Duration,
    /// Number of dispatches.
    pub dispatches: u64,
    /// Tiles rendered.
    pub tiles: u64,
}

/// A scene on the device, ready to render rows.
#[derive(Debug)]
pub struct GpuRenderer<'a> {
    gpu: &'a Gpu,
    cover: Cover,
    width: u32,
    /// Samples of a pixel.
    samples: u64,
    /// Number of tiles of the whole picture; no band has more.
    picture_tiles: u64,
    background: [u8; 3],
    kernel: Option<Kernel>,
    kernel_inputs: Inputs,
    tiles_per_dispatch: u32,
    times: DeviceTimes,
    timestamps: Option<Timestamps>,
    /// Shadow and reflection rays so far, where they are counted.
    rays: [u64; 2],
}

/// Everything that is needed to build the kernel once a tile asks for it.
#[derive(Debug)]
struct Inputs {
    packed: Packed,
    specialisation: Specialisation,
}

/// The compiled pipeline with its buffers.
#[derive(Debug)]
struct Kernel {
    pipeline: wgpu::ComputePipeline,
    bind_group: wgpu::BindGroup,
    tiles: wgpu::Buffer,
    pixels: Readable,
    ray_counts: Readable,
    /// Tiles that the buffers hold.
    capacity: u32,
}

impl<'a> GpuRenderer<'a> {
    /// Prepares `scene` for `gpu`; the kernel is compiled when the first tile needs it.
    pub fn new(gpu: &'a Gpu, scene: &Scene, settings: &Settings, effects: &Effects, tier: Tier) -> Result<Self, Error> {
        let kernel = gpu.kernel(tier)?;
        let (scene, settings) = in_range(scene, settings);
        let (scene, settings) = (scene.as_ref(), &settings);
        let packed = Packed::new(scene, settings, effects, kernel);
        check_fits(gpu, &packed)?;
        let camera = Camera::new(scene, settings);
        let samples = u64::from(settings.samples * settings.samples);
        let tests_per_pixel = samples
            * (scene.spheres.len() as u64 + 1)
            * (1 + scene.lights.len() as u64 * u64::from(effects.set.has(Effect::Shadows)))
            * (1 + u64::from(effects.depth));
        // A tree of rays doubles with each bounce where rays can wait.
        let tests_per_pixel = tests_per_pixel.saturating_mul(1 << effects.waiting(scene).min(32));
        let first = FIRST_DISPATCH_TESTS / tests_per_pixel.saturating_mul(TILE_PIXELS as u64);
        Ok(Self {
            gpu,
            cover: Cover::new(scene, &camera, effects.set.has(Effect::Ellipsoids)),
            width: scene.width,
            samples,
            picture_tiles: u64::from(scene.width.div_ceil(TILE)) * u64::from(scene.height.div_ceil(TILE)),
            background: settings.quantize.levels(scene.background),
            kernel: None,
            kernel_inputs: Inputs { packed, specialisation: Specialisation::new(scene, settings, effects, kernel) },
            tiles_per_dispatch: first.clamp(1, u64::from(MAX_DISPATCH_TILES)) as u32,
            times: DeviceTimes::default(),
            timestamps: None,
            rays: [0; 2],
        })
    }

    /// Times of the work so far.
    pub fn times(&self) -> DeviceTimes {
        self.times
    }

    /// Counts rays from now on; before the first row only.
    pub fn count_rays(&mut self) {
        self.kernel_inputs.specialisation.count_rays = true;
    }

    /// Reads the device's own clock from now on; returns whether it has one.
    pub fn time_on_device(&mut self) -> bool {
        self.timestamps = Timestamps::new(self.gpu);
        self.timestamps.is_some()
    }

    /// Primary, shadow and reflection rays so far; `None` where they are not counted.
    pub fn rays(&self) -> Option<[u64; 3]> {
        let primary = self.times.tiles * TILE_PIXELS as u64 * self.samples;
        self.kernel_inputs.specialisation.count_rays.then_some([primary, self.rays[0], self.rays[1]])
    }

    /// Renders rows `first` on (a multiple of [`TILE`]) into `rgb`, whole rows of 3 bytes a pixel; returns how many pixels
    /// are not finite.
    pub fn rows(&mut self, first: u32, rgb: &mut [u8]) -> Result<u64, Error> {
        let row_bytes = self.width as usize * 3;
        let count = (rgb.len() / row_bytes) as u32;
        let background = self.background;
        rgb.par_chunks_mut(row_bytes).for_each(|row| row.as_chunks_mut::<3>().0.fill(background));

        let tiles = self.cover.tiles(first, count);
        let mut not_finite = 0;
        let mut rest = tiles.as_slice();
        while !rest.is_empty() {
            let kernel = match self.kernel.take() {
                Some(kernel) => kernel,
                None => self.build_kernel()?,
            };
            let limit = self.gpu.info.max_workgroups.min(kernel.capacity).min(self.tiles_per_dispatch);
            let (now, later) = rest.split_at(rest.len().min(limit as usize));
            let took = self.dispatch(&kernel, now)?;
            not_finite += self.read_back(&kernel, now, first, rgb)?;
            self.add_rays(&kernel, now.len())?;
            self.kernel = Some(kernel);
            self.set_pace(now.len(), took);
            rest = later;
        }
        Ok(not_finite)
    }

    /// Compiles the pipeline and runs it once, since drivers finish compiling at the first dispatch.
    fn build_kernel(&mut self) -> Result<Kernel, Error> {
        let start = Instant::now();
        let gpu = self.gpu;
        let Inputs { packed, specialisation } = &self.kernel_inputs;
        let pipeline = compile(gpu, specialisation)?;
        let capacity = self.picture_tiles.min(u64::from(MAX_DISPATCH_TILES.min(gpu.info.max_workgroups))) as u32;
        let kernel =
            gpu.checked("reserving buffers", || Kernel::new(gpu, pipeline, packed, capacity, specialisation))?;
        self.submit(&kernel, &[[0, 0]])?;
        self.times.compile = start.elapsed();
        Ok(kernel)
    }

    fn dispatch(&mut self, kernel: &Kernel, tiles: &[[u32; 2]]) -> Result<Duration, Error> {
        let start = Instant::now();
        self.submit(kernel, tiles)?;
        let took = start.elapsed();
        self.times.render += took;
        if let Some(timestamps) = &self.timestamps {
            self.times.on_device += timestamps.elapsed(self.gpu)?;
        }
        self.times.longest_dispatch = self.times.longest_dispatch.max(took);
        self.times.dispatches += 1;
        self.times.tiles += tiles.len() as u64;
        Ok(took)
    }

    /// Runs the kernel over `tiles` and waits for it.
    fn submit(&self, kernel: &Kernel, tiles: &[[u32; 2]]) -> Result<(), Error> {
        self.gpu.queue.write_buffer(&kernel.tiles, 0, bytemuck::cast_slice(tiles));
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: self.timestamps.as_ref().map(Timestamps::writes),
            });
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &kernel.bind_group, &[]);
            pass.dispatch_workgroups(tiles.len() as u32, 1, 1);
        }
        if let Some(timestamps) = &self.timestamps {
            timestamps.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()
    }

    /// Puts the pixels of `tiles` into `rgb`, whose first row is `first`.
    fn read_back(&mut self, kernel: &Kernel, tiles: &[[u32; 2]], first: u32, rgb: &mut [u8]) -> Result<u64, Error> {
        let start = Instant::now();
        let width = self.width;
        let place = |pixels: &[u32]| place_tiles(pixels, tiles, first, width, rgb);
        let not_finite = kernel.pixels.read(self.gpu, tiles.len() * TILE_PIXELS, place)?;
        self.times.read_back += start.elapsed();
        Ok(not_finite)
    }

    /// Adds up the ray counts of the last dispatch of so many tiles.
    fn add_rays(&mut self, kernel: &Kernel, tiles: usize) -> Result<(), Error> {
        if self.kernel_inputs.specialisation.count_rays {
            let sum = |counts: &[u32]| {
                counts.iter().fold([0, 0], |[s, r], count| [s + u64::from(count & 0xffff), r + u64::from(count >> 16)])
            };
            let [shadow, reflection] = kernel.ray_counts.read(self.gpu, tiles * TILE_PIXELS, sum)?;
            self.rays = [self.rays[0] + shadow, self.rays[1] + reflection];
        }
        Ok(())
    }

    /// Sizes the next dispatch by the last one's time, growing by a factor of 4 at most.
    fn set_pace(&mut self, tiles: usize, took: Duration) {
        let factor = (TARGET_DISPATCH.as_secs_f64() / took.as_secs_f64().max(1e-9)).min(4.0);
        self.tiles_per_dispatch = ((tiles as f64 * factor) as u32).clamp(1, MAX_DISPATCH_TILES);
    }
}

impl Kernel {
    fn new(
        gpu: &Gpu,
        pipeline: wgpu::ComputePipeline,
        packed: &Packed,
        capacity: u32,
        specialisation: &Specialisation,
    ) -> Self {
        let device = &gpu.device;
        let filled = |contents: &[u8], usage| {
            // A binding of size 0 is not allowed; the kernel never reads past the counts.
            let contents = if contents.is_empty() { &[0; 64] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let empty = |size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        // What loops read: few elements go into a uniform buffer of fixed size.
        let looped = |contents: &[u8], element_size: usize| {
            if specialisation.few.is_none() {
                return filled(contents, storage);
            }
            let mut padded = vec![0; MAX_FEW * element_size];
            padded[..contents.len()].copy_from_slice(contents);
            filled(&padded, wgpu::BufferUsages::UNIFORM)
        };
        let tiles = empty(u64::from(capacity) * 8, storage | wgpu::BufferUsages::COPY_DST);
        let values = u64::from(capacity) * TILE_PIXELS as u64;
        let pixels = Readable::new(gpu, values);
        let ray_counts = Readable::new(gpu, if specialisation.count_rays { values } else { 1 });
        let mut inputs = vec![
            (0, filled(&packed.params, wgpu::BufferUsages::UNIFORM)),
            (1, looped(&packed.shapes, packed.shape_size)),
            (2, filled(&packed.materials, storage)),
            (3, looped(&packed.lights, packed.light_size)),
            (4, filled(&packed.columns, storage)),
            (5, filled(&packed.rows, storage)),
        ];
        if specialisation.refraction.is_some() {
            inputs.push((11, filled(&packed.glasses, storage)));
        }
        if let Some(low) = &packed.low {
            inputs.extend([(9, looped(&low.shapes, packed.shape_size)), (10, looped(&low.lights, packed.light_size))]);
        }
        let own = [(6, &tiles), (7, &pixels.buffer), (8, &ray_counts.buffer)];
        let buffers = inputs.iter().map(|(binding, buffer)| (*binding, buffer)).chain(own);
        let entries: Vec<_> = buffers
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { pipeline, bind_group, tiles, pixels, ray_counts, capacity }
    }
}

/// Refuses a scene whose buffers are larger than the device's bindings.
fn check_fits(gpu: &Gpu, packed: &Packed) -> Result<(), Error> {
    let sizes = [
        ("spheres", packed.materials.len().max(packed.shapes.len())),
        ("lights", packed.lights.len()),
        ("columns", packed.columns.len()),
        ("rows", packed.rows.len()),
    ];
    let limit = gpu.info.max_storage_binding.min(gpu.info.max_buffer);
    match sizes.iter().find(|(_, size)| *size as u64 > limit) {
        None => Ok(()),
        Some((what, size)) => Err(Error::NoDevice(format!(
            "the {what} of this scene take {size} bytes, but {} binds {limit} at the most; `--device cpu` has no such limit",
            gpu.info
        ))),
    }
}

/// Copies pixels in tile order to their places in rows; returns how many are not finite.
fn place_tiles(pixels: &[u32], tiles: &[[u32; 2]], first: u32, width: u32, rgb: &mut [u8]) -> u64 {
    let row_bytes = width as usize * 3;
    let tile_row_bytes = row_bytes * TILE as usize;
    let place_row = |(tile_row, band): (usize, &mut [u8])| {
        let y = first + tile_row as u32 * TILE;
        let start = tiles.partition_point(|tile| tile[1] < y);
        let end = tiles.partition_point(|tile| tile[1] <= y);
        let mut not_finite = 0;
        for (tile, pixels) in tiles[start..end].iter().zip(pixels[start * TILE_PIXELS..].chunks(TILE_PIXELS)) {
            let across = TILE.min(width - tile[0]) as usize;
            for (row, pixels) in band.chunks_mut(row_bytes).zip(pixels.chunks(TILE as usize)) {
                let row = &mut row[tile[0] as usize * 3..][..across * 3];
                for (target, pixel) in row.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
                    let [r, g, b, status] = pixel.to_le_bytes();
                    *target = [r, g, b];
                    not_finite += u64::from(status != 0);
                }
            }
        }
        not_finite
    };
    rgb.par_chunks_mut(tile_row_bytes).enumerate().map(place_row).sum()
}

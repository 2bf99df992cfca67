//! Rows of pixels from the device: tiles in dispatches that stay short, read back and put in place.

mod list;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::device::Gpu;
use super::error::Error;
use super::pack::{Contents, Packed, list_contents};
use super::pipeline::{MAX_FEW, MAX_UNIFORM_LIGHTS, Specialisation, Stage, Stages};
use super::readable::Readable;
use super::shader::{Kernel, Slots, Storage};
use super::timestamps::Timestamps;
use super::upload::upload;
use crate::accel::{Acceleration, Cover, Rounding};
use crate::camera::Camera;
use crate::effects::{Effect, Effects};
use crate::geometry::in_range;
use crate::precision::Tier;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::tiles::TILE;

/// Pixels of a tile.
const TILE_PIXELS: usize = (TILE * TILE) as usize;
/// A dispatch should take about this long: long enough to hide its overhead, far below what loses a device.
const TARGET_DISPATCH: Duration = Duration::from_millis(25);
/// Intersection tests of the first dispatch, before any is measured: some milliseconds on the slowest device seen.
const FIRST_DISPATCH_TESTS: u64 = 4_000_000;
/// Tiles of a dispatch at the most, for the size of the pixel buffer: 16 MiB.
const MAX_DISPATCH_TILES: u32 = 65_536;

/// Memory for paths at the most.
const MAX_PATH_BYTES: u64 = 64 << 20;

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
    /// Tiles rendered, or as many pixels of lists.
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
    /// Number of tiles of the whole picture, or of as many pixels of a list; no band has more.
    picture_tiles: u64,
    background: [u8; 3],
    max_depth: u32,
    work: Option<Work>,
    inputs: Inputs,
    tiles_per_dispatch: u32,
    times: DeviceTimes,
    timestamps: Option<Timestamps>,
    /// Shadow and reflection rays so far, where they are counted.
    rays: [u64; 2],
    /// Pixels rendered of lists.
    listed: u64,
}

/// Everything that is needed to build the kernels once a tile asks for them.
#[derive(Debug)]
struct Inputs {
    /// By binding.
    buffers: Vec<(u32, wgpu::Buffer)>,
    specialisation: Specialisation,
}

/// The compiled kernels with their buffers.
#[derive(Debug)]
struct Work {
    stages: Arc<Stages>,
    see_group: wgpu::BindGroup,
    /// For what goes between two stages.
    between_group: wgpu::BindGroup,
    shade_group: wgpu::BindGroup,
    walk_group: Option<wgpu::BindGroup>,
    resolve_group: Option<wgpu::BindGroup>,
    tiles: wgpu::Buffer,
    stage: wgpu::Buffer,
    /// Workgroups of the next bounce.
    workgroups: wgpu::Buffer,
    pixels: Readable,
    ray_counts: Readable,
    /// Tiles that the buffers hold.
    capacity: u32,
}

/// Bytes before the hits in the shader's `Stage`.
const STAGE_HEAD: u64 = 32;

/// Invocations of a workgroup of the kernels that are not over tiles.
const GROUP: u64 = 64;

impl<'a> GpuRenderer<'a> {
    /// Prepares `scene` for `gpu`; the kernels are compiled when the first tile needs them.
    pub fn new(gpu: &'a Gpu, scene: &Scene, settings: &Settings, effects: &Effects, tier: Tier) -> Result<Self, Error> {
        let kernel = gpu.kernel(tier)?;
        Self::with_rounding(gpu, scene, settings, effects, kernel, kernel.rounding())
    }

    /// Likewise with a kernel of one's choice, and lists of spheres for one that rounds like this.
    pub fn with_rounding(
        gpu: &'a Gpu,
        scene: &Scene,
        settings: &Settings,
        effects: &Effects,
        kernel: Kernel,
        rounding: Rounding,
    ) -> Result<Self, Error> {
        let (scene, settings) = in_range(scene, settings);
        let (scene, settings) = (scene.as_ref(), &settings);
        let specialisation = Specialisation::new(scene, settings, effects, kernel);
        let camera = Camera::new(scene, settings);
        let accel = Acceleration::new(scene, &camera, specialisation.listed_effects(), rounding);
        let packed = Packed::new(scene, settings, effects, kernel, &accel);
        let lists = list_contents(&accel);
        check_fits(gpu, &packed, &lists)?;
        let cover = accel.screen.cover();
        // The lists on the host go before the spheres take memory on the device.
        let list_buffer = upload(gpu, &lists, wgpu::BufferUsages::STORAGE, lists.len())?;
        drop(lists);
        drop(accel);
        let buffers = scene_buffers(gpu, &packed, list_buffer, &specialisation)?;
        let samples = u64::from(settings.samples * settings.samples);
        let tests_per_pixel = samples
            * (scene.spheres.len().min(64) as u64 + 1)
            * (1 + scene.lights.len() as u64 * u64::from(effects.set.has(Effect::Shadows)))
            * (1 + u64::from(effects.depth));
        // A tree of rays doubles with each bounce where rays can wait.
        let tests_per_pixel = tests_per_pixel.saturating_mul(1 << effects.waiting(scene).min(32));
        let first = FIRST_DISPATCH_TESTS / tests_per_pixel.saturating_mul(TILE_PIXELS as u64);
        Ok(Self {
            gpu,
            cover,
            width: scene.width,
            samples,
            picture_tiles: u64::from(scene.width.div_ceil(TILE)) * u64::from(scene.height.div_ceil(TILE)),
            background: settings.quantize.levels(scene.background),
            max_depth: effects.depth,
            work: None,
            inputs: Inputs { buffers, specialisation },
            tiles_per_dispatch: first.clamp(1, u64::from(MAX_DISPATCH_TILES)) as u32,
            times: DeviceTimes::default(),
            timestamps: None,
            rays: [0; 2],
            listed: 0,
        })
    }

    /// Times of the work so far.
    pub fn times(&self) -> DeviceTimes {
        self.times
    }

    /// Counts rays from now on; before the first row only.
    pub fn count_rays(&mut self) {
        self.inputs.specialisation.count_rays = true;
    }

    /// Reads the device's own clock from now on; returns whether it has one.
    pub fn time_on_device(&mut self) -> bool {
        self.timestamps = Timestamps::new(self.gpu);
        self.timestamps.is_some()
    }

    /// Primary, shadow and reflection rays so far; `None` where they are not counted.
    pub fn rays(&self) -> Option<[u64; 3]> {
        let pixels = match self.inputs.specialisation.slots {
            Slots::Tiles => self.times.tiles * TILE_PIXELS as u64,
            Slots::List => self.listed,
        };
        let primary = pixels * self.samples;
        self.inputs.specialisation.count_rays.then_some([primary, self.rays[0], self.rays[1]])
    }

    /// Renders rows `first` on (a multiple of [`TILE`]) into `rgb`, whole rows of 3 bytes a pixel; returns how many pixels
    /// are not finite.
    pub fn rows(&mut self, first: u32, rgb: &mut [u8]) -> Result<u64, Error> {
        let row_bytes = self.width as usize * 3;
        let count = (rgb.len() / row_bytes) as u32;
        let background = self.background;
        rgb.par_chunks_mut(row_bytes).for_each(|row| row.as_chunks_mut::<3>().0.fill(background));

        let tiles = self.cover.covered(first, count);
        let mut not_finite = 0;
        let mut rest = tiles.as_slice();
        while !rest.is_empty() {
            let work = match self.work.take() {
                Some(work) => work,
                None => self.build()?,
            };
            let (now, later) = rest.split_at(rest.len().min(work.capacity.min(self.tiles_per_dispatch) as usize));
            let took = self.dispatch(&work, now)?;
            not_finite += self.read_back(&work, now, first, rgb)?;
            self.add_rays(&work, now.len() * TILE_PIXELS)?;
            self.work = Some(work);
            self.set_pace(now.len(), took);
            rest = later;
        }
        Ok(not_finite)
    }

    /// Compiles the kernels and runs them once, since drivers finish compiling at the first dispatch.
    fn build(&mut self) -> Result<Work, Error> {
        let start = Instant::now();
        let gpu = self.gpu;
        let Inputs { buffers, specialisation } = &self.inputs;
        let (stages, used_before) = gpu.stages(specialisation)?;
        let capacity = self.capacity();
        let work = gpu.checked("reserving buffers", || Work::new(gpu, stages, buffers, capacity, specialisation))?;
        if !used_before {
            self.submit(&work, &[[0, 0]])?;
        }
        self.times.compile = start.elapsed();
        Ok(work)
    }

    /// How many tiles a dispatch has at the most: as their buffers and the device's limits allow.
    fn capacity(&self) -> u32 {
        let info = &self.gpu.info;
        let specialisation = &self.inputs.specialisation;
        let path = 2 * specialisation.kernel.path_size() * u64::from(specialisation.has_paths());
        let tile_bytes = TILE_PIXELS as u64 * self.samples * path.max(4);
        let bytes = MAX_PATH_BYTES.min(info.max_storage_binding).min(info.max_buffer);
        // Paths take a workgroup for so many of them.
        let groups = u64::from(info.max_workgroups) * GROUP / (TILE_PIXELS as u64 * self.samples);
        let limit = u64::from(MAX_DISPATCH_TILES.min(info.max_workgroups)).min(groups).min(bytes / tile_bytes);
        self.picture_tiles.min(limit).max(1) as u32
    }

    /// The workgroups over so many tiles, or pixels of a list.
    fn workgroups(&self, places: usize) -> u32 {
        match self.inputs.specialisation.slots {
            Slots::Tiles => places as u32,
            Slots::List => places.div_ceil(TILE_PIXELS) as u32,
        }
    }

    fn dispatch(&mut self, work: &Work, tiles: &[[u32; 2]]) -> Result<Duration, Error> {
        let start = Instant::now();
        self.submit(work, tiles)?;
        let took = start.elapsed();
        self.times.render += took;
        if let Some(timestamps) = &self.timestamps {
            self.times.on_device += timestamps.elapsed(self.gpu)?;
        }
        self.times.longest_dispatch = self.times.longest_dispatch.max(took);
        self.times.dispatches += 1;
        self.times.tiles += u64::from(self.workgroups(tiles.len()));
        Ok(took)
    }

    /// Runs all stages over `tiles` and waits for them.
    fn submit(&self, work: &Work, tiles: &[[u32; 2]]) -> Result<(), Error> {
        self.gpu.queue.write_buffer(&work.tiles, 0, bytemuck::cast_slice(tiles));
        if self.inputs.specialisation.slots == Slots::List {
            let padding = list::padding(tiles.len());
            self.gpu.queue.write_buffer(&work.tiles, tiles.len() as u64 * 8, bytemuck::cast_slice(&padding));
        }
        // The first stage's paths go into the first half.
        let half = work.capacity * TILE_PIXELS as u32 * self.samples as u32;
        self.gpu.queue.write_buffer(&work.stage, 0, bytemuck::cast_slice(&[half, 0, 0, 0, 0, 0, 0]));
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: self.timestamps.as_ref().map(Timestamps::writes),
            });
            let mut run = |stage: &Stage, group: &wgpu::BindGroup, workgroups: Option<u32>| {
                pass.set_pipeline(&stage.pipeline);
                pass.set_bind_group(0, group, &[]);
                match workgroups {
                    Some(count) => pass.dispatch_workgroups(count, 1, 1),
                    None => pass.dispatch_workgroups_indirect(&work.workgroups, 0),
                }
            };
            let tiles = Some(self.workgroups(tiles.len()));
            let stages = &work.stages;
            run(&stages.see, &work.see_group, tiles);
            run(&stages.begin_shading, &work.between_group, Some(1));
            run(&stages.shade, &work.shade_group, None);
            if let (Some([begin_bounce, walk]), Some(walk_group)) = (&stages.bounce, &work.walk_group) {
                for _ in 0..self.max_depth {
                    run(begin_bounce, &work.between_group, Some(1));
                    run(walk, walk_group, None);
                    run(&stages.begin_shading, &work.between_group, Some(1));
                    run(&stages.shade, &work.shade_group, None);
                }
            }
            if let (Some(resolve), Some(group)) = (&stages.resolve, &work.resolve_group) {
                run(resolve, group, tiles);
            }
        }
        if let Some(timestamps) = &self.timestamps {
            timestamps.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()
    }

    /// Puts the pixels of `tiles` into `rgb`, whose first row is `first`.
    fn read_back(&mut self, work: &Work, tiles: &[[u32; 2]], first: u32, rgb: &mut [u8]) -> Result<u64, Error> {
        let start = Instant::now();
        let width = self.width;
        let place = |pixels: &[u32]| place_tiles(pixels, tiles, first, width, rgb);
        let not_finite = work.pixels.read(self.gpu, tiles.len() * TILE_PIXELS, place)?;
        self.times.read_back += start.elapsed();
        Ok(not_finite)
    }

    /// Adds up the ray counts of the last dispatch of so many pixels.
    fn add_rays(&mut self, work: &Work, pixels: usize) -> Result<(), Error> {
        if self.inputs.specialisation.count_rays {
            let sum = |counts: &[u32]| {
                counts.iter().fold([0, 0], |[s, r], count| [s + u64::from(count & 0xffff), r + u64::from(count >> 16)])
            };
            let values = pixels * self.samples as usize;
            let [shadow, reflection] = work.ray_counts.read(self.gpu, values, sum)?;
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

impl Work {
    fn new(
        gpu: &Gpu,
        stages: Arc<Stages>,
        buffers: &[(u32, wgpu::Buffer)],
        capacity: u32,
        specialisation: &Specialisation,
    ) -> Self {
        let device = &gpu.device;
        let empty = |size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let pixel_count = u64::from(capacity) * TILE_PIXELS as u64;
        let slots = pixel_count * u64::from(specialisation.samples * specialisation.samples);
        let pixels = Readable::new(gpu, pixel_count);
        let ray_counts = Readable::new(gpu, if specialisation.count_rays { slots } else { 1 });
        let path_size = specialisation.kernel.path_size();
        let paths = if specialisation.has_paths() { 2 * slots * path_size } else { path_size };
        let color_size = if specialisation.kernel.is_double() { 32 } else { 16 };
        let paths = empty(paths, storage);
        let places = match specialisation.slots {
            Slots::Tiles => u64::from(capacity),
            Slots::List => pixel_count,
        };
        let tiles = empty(places * 8, storage | wgpu::BufferUsages::COPY_DST);
        let stage = empty(STAGE_HEAD + 8 * slots, storage | wgpu::BufferUsages::COPY_DST);
        let workgroups = empty(12, storage | wgpu::BufferUsages::INDIRECT);
        let colors = stages.resolve.as_ref().map(|_| empty(slots * color_size, storage));
        let results = colors.as_ref().unwrap_or(&pixels.buffer);
        let mut all: Vec<_> = buffers.iter().map(|(binding, buffer)| (*binding, buffer)).collect();
        all.extend([(6, &tiles), (7, results), (8, &ray_counts.buffer), (12, &stage), (15, &pixels.buffer)]);
        all.extend([(11, &paths), (16, &workgroups)]);
        let see_group = stages.see.bind(gpu, &all);
        let between_group = stages.begin_shading.bind(gpu, &all);
        let shade_group = stages.shade.bind(gpu, &all);
        let walk_group = stages.bounce.as_ref().map(|[_, walk]| walk.bind(gpu, &all));
        let resolve_group = stages.resolve.as_ref().map(|resolve| resolve.bind(gpu, &all));
        Self {
            stages,
            see_group,
            between_group,
            shade_group,
            walk_group,
            resolve_group,
            tiles,
            stage,
            workgroups,
            pixels,
            ray_counts,
            capacity,
        }
    }
}

/// The buffers of the scene, by binding.
fn scene_buffers(
    gpu: &Gpu,
    packed: &Packed,
    lists: wgpu::Buffer,
    specialisation: &Specialisation,
) -> Result<Vec<(u32, wgpu::Buffer)>, Error> {
    let (storage, uniform) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::UNIFORM);
    // A binding of size 0 is not allowed; the kernel never reads past the counts.
    let filled = |contents: &Contents, usage| upload(gpu, contents, usage, contents.len().max(64));
    // Uniform buffers have a fixed number of elements.
    let fixed = |contents: &Contents, count: usize| upload(gpu, contents, uniform, count * contents.element_size());
    let shapes = |contents: &Contents| match specialisation.storage {
        Storage::Few(_) => fixed(contents, MAX_FEW),
        _ => filled(contents, storage),
    };
    let lights = |contents: &Contents| match specialisation.storage {
        Storage::Few(_) => fixed(contents, MAX_FEW),
        Storage::Many => fixed(contents, MAX_UNIFORM_LIGHTS),
        _ => filled(contents, storage),
    };
    let faces = |contents: &Contents| match specialisation.storage {
        Storage::ManyLights => filled(contents, storage),
        _ => fixed(contents, 6 * MAX_UNIFORM_LIGHTS),
    };
    let mut buffers = vec![
        (0, filled(&packed.params, uniform)?),
        (1, shapes(&packed.shapes)?),
        (2, filled(&packed.materials, storage)?),
        (3, lights(&packed.lights)?),
        (4, filled(&packed.window, storage)?),
        (13, lists),
        (14, faces(&packed.faces)?),
    ];
    if specialisation.refraction.is_some() {
        buffers.push((5, filled(&packed.glasses, storage)?));
    }
    if let Some([low_shapes, low_lights]) = &packed.low {
        buffers.extend([(9, shapes(low_shapes)?), (10, lights(low_lights)?)]);
    }
    Ok(buffers)
}

/// Refuses a scene whose buffers are larger than the device's bindings.
fn check_fits(gpu: &Gpu, packed: &Packed, lists: &Contents) -> Result<(), Error> {
    let sizes = [
        ("spheres", packed.materials.len().max(packed.shapes.len())),
        ("lights", packed.lights.len()),
        ("columns and rows", packed.window.len()),
        ("faces around the lights", packed.faces.len()),
        ("lists", lists.len()),
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

//! Pixels from the device: tiles or lists of them in dispatches that stay short, read back and put in place.

mod order;
mod output;
mod pixels;
mod place;
mod rendered;
mod rows;
mod term;
mod tiles;
mod work;

use std::marker::PhantomData;
use std::num::NonZero;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::accel::{Acceleration, Cover, Density, Rounding};
use crate::area::Area;
use crate::brightness::Scalar;
use crate::effects::{Effect, Effects};
use crate::exact::TangentMargin;
use crate::geometry::ellipsoid;
use crate::gpu::device::error::Error;
use crate::gpu::device::timestamps::Timestamps;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::picture::Bounce;
use crate::gpu::kernel::pipeline::Pipeline;
use crate::gpu::kernel::specialisation::Specialisation;
use crate::gpu::kernel::variant::{Kernel, Schedule, Secondary, Slots, Variant};
use crate::gpu::shared::{ONE_PATH, SEVERAL_PATHS, dispatch_tiles};
use crate::gpu::table::bind::{add_copies, add_lists, add_scene, are_too_large, check_fits, copies_fit};
use crate::gpu::table::pack::{Packed, list_contents};
use crate::gpu::table::pool::{Basis, TablePool, TableSet};
use crate::kept::Kept;
use crate::limits;
use crate::linear::Linear;
use crate::misuse::check_picture;
use crate::precision::Tier;
use crate::tiles::TILE;
use crate::tuning::Class;
use crate::viewed::ViewedScene;
pub use output::{Output, Pixels, Rows};
use place::{Statuses, dispatch_bits};
pub use rendered::Rendered;
pub use term::Term;
use tiles::{TILE_PIXELS, TileWords};
use work::{PATH_QUEUE_SIZE, RAY_COUNT_SIZE, Work};

/// How many workgroups a dispatch has.
#[derive(Debug, Clone, Copy)]
enum Workgroups {
    Known(u32),
    /// As many as the device has found, in the words from this one on.
    Found(u32),
}

/// Paths keep the index of a sample's result as a number, exact in `f32` up to this.
const MAX_PATHS: u64 = 1 << 24;

/// What is wanted of a renderer beside pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options {
    /// Asks of which pixels the kernel is unsure, which it says in kernels of its own.
    pub certified: bool,
    /// Asks for the colours of pixels, too, before they are quantised. Of a certified picture the kernel has to be `double` in `f64`, and
    /// is sure of a pixel where it is of the levels of its colour, those of 8 bits and those of 16.
    pub linear: bool,
    /// Asks for terms of first hits in place of colours, with effects that follow no ray any further.
    pub terms: bool,
    /// Asks for what single mirrored and refracted rays add, in place of colours.
    pub one_ray: bool,
    /// Counts shadow and reflection rays, which a device does in kernels of its own.
    pub count_rays: bool,
    /// Counts tests of a ray with a sphere instead, in kernels of its own as well.
    pub count_tests: bool,
    /// Reads the device's own clock, if it has one.
    pub device_clock: bool,
    /// About how long a pixel takes, in ms, where that is known: the first dispatch is sized by that.
    pub pixel_ms: Option<f64>,
}

impl Options {
    /// How the lists of spheres of such a renderer have it that `kernel` rounds.
    fn rounding(&self, kernel: Kernel) -> Rounding {
        if self.certified { kernel.rounding().certified() } else { kernel.rounding() }
    }
}

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
}

impl DeviceTimes {
    /// Of this work and of another.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            compile: self.compile + other.compile,
            render: self.render + other.render,
            on_device: self.on_device + other.on_device,
            read_back: self.read_back + other.read_back,
            longest_dispatch: self.longest_dispatch.max(other.longest_dispatch),
            dispatches: self.dispatches + other.dispatches,
        }
    }
}

/// A scene on the device, ready to render [`Rows`] of its picture or lists of its [`Pixels`].
///
/// Which of them is part of the type. Only one for lists renders lists:
///
/// ```compile_fail,E0599
/// fn first_pixel(mut renderer: trueray::gpu::GpuRenderer<trueray::gpu::Rows>) {
///     let _ = renderer.pixels(&[[0, 0]], &mut [[0; 3]]);
/// }
/// ```
///
/// And only one for rows renders rows:
///
/// ```compile_fail,E0599
/// fn first_rows(mut renderer: trueray::gpu::GpuRenderer<trueray::gpu::Pixels>) {
///     let _ = renderer.rows(0, &mut [0; 3]);
/// }
/// ```
#[derive(Debug)]
pub struct GpuRenderer<'a, O = Rows> {
    gpu: &'a Gpu,
    output: PhantomData<O>,
    cover: Cover,
    /// Width and height of the picture.
    size: (u32, u32),
    tile_words: TileWords,
    /// Samples of a pixel.
    samples: u64,
    /// Tiles of the whole picture that any sphere may cover, or of as many pixels of a list; no band has more.
    covered_tiles: u64,
    background: ([u8; 3], Linear),
    max_depth: u32,
    /// Which term of first hits stands in place of the colour, and its light, where the renderer is for terms; the number of the ray, where
    /// it is for single ones.
    asked: [u32; 2],
    /// Parts that the device's threads take of a dispatch.
    hands: usize,
    work: Option<Work>,
    inputs: BuildInputs,
    tiles_per_dispatch: u32,
    times: DeviceTimes,
    /// Dispatches so far, those of no pixel included.
    submitted: u64,
    timestamps: Option<Timestamps>,
    /// Pixels so far.
    pixels: u64,
    /// Shadow and reflection rays so far, where they are counted.
    rays: [u64; 2],
    /// How many rays or tests the pixels of these rows took, where each is asked.
    counted: Option<(Area, Vec<[u64; 2]>)>,
}

/// Everything that is needed to build the kernels once a tile asks for them.
#[derive(Debug)]
struct BuildInputs {
    tables: TableSet,
    specialisation: Specialisation,
}

impl<'a> GpuRenderer<'a> {
    /// Prepares rows of `viewed` for `gpu`; the kernels are compiled when the first tile needs them.
    pub fn new(gpu: &'a Gpu, viewed: &ViewedScene, effects: &Effects, tier: Tier) -> Result<Self, Error> {
        Self::with(gpu, viewed, effects, tier, &Options::default())
    }

    /// Likewise with a kernel of one's choice, and lists of spheres for one that rounds like this.
    pub fn with_rounding(
        gpu: &'a Gpu,
        viewed: &ViewedScene,
        effects: &Effects,
        kernel: Kernel,
        rounding: Rounding,
    ) -> Result<Self, Error> {
        let kernel = (kernel, rounding);
        let options = Options::default();
        Ok(gpu.device.guarded(|| Self::prepared(gpu, viewed, effects, kernel, &options, drop))?.0)
    }
}

/// Refuses numbers that the kernel cannot hold.
fn check_range(viewed: &ViewedScene, effects: &Effects, kernel: Kernel) -> Result<(), Error> {
    let scalar = if kernel.is_double() { Scalar::Double } else { Scalar::Single };
    let (width, height) = (viewed.scene().width, viewed.scene().height);
    let padded: u64 = [width, height].map(|size| u64::from(size.next_multiple_of(TILE))).iter().sum();
    let why = limits::problem_in(scalar, viewed, effects).or_else(|| {
        (padded * u64::from(viewed.settings().pattern.side()) > u64::from(u32::MAX))
            .then(|| "the picture has more columns and rows of samples than a kernel counts".to_owned())
    });
    why.map_or(Ok(()), |why| Err(Error::OutOfRange { kernel: kernel.name(), why }))
}

/// About as many intersection tests as a tile takes, before any is measured.
fn tests_of_tile(viewed: &ViewedScene, effects: &Effects) -> u64 {
    let scene = viewed.scene();
    let tests_per_pixel = u64::from(viewed.settings().pattern.count())
        * (scene.spheres.len().min(64) as u64 + 1)
        * (1 + scene.lights.len() as u64 * u64::from(effects.set.has(Effect::Shadows)))
        * (1 + u64::from(effects.depth));
    // A tree of rays doubles with each bounce where rays can wait.
    tests_per_pixel.saturating_mul(1 << effects.waiting(scene).min(32)).saturating_mul(TILE_PIXELS as u64)
}

/// The kernel of `tier`, and how it rounds; certified pictures ask more of the device.
fn kernel_of(gpu: &Gpu, tier: Tier, options: &Options) -> Result<(Kernel, Rounding), Error> {
    let kernel = gpu.kernel(tier)?;
    if options.certified {
        gpu.certifies(kernel)?;
    }
    Ok((kernel, options.rounding(kernel)))
}

impl<'a, O: Output> GpuRenderer<'a, O> {
    /// Prepares `viewed` for `gpu`, with more than the pixels where that is wanted.
    pub fn with(
        gpu: &'a Gpu,
        viewed: &ViewedScene,
        effects: &Effects,
        tier: Tier,
        options: &Options,
    ) -> Result<Self, Error> {
        let kernel = kernel_of(gpu, tier, options)?;
        Ok(gpu.device.guarded(|| Self::prepared(gpu, viewed, effects, kernel, options, drop))?.0)
    }

    /// Likewise; with the lists of spheres, for another renderer of the same scene that rounds no more than `tier`.
    pub fn with_lists(
        gpu: &'a Gpu,
        viewed: &ViewedScene,
        effects: &Effects,
        tier: Tier,
        options: &Options,
    ) -> Result<(Self, Acceleration), Error> {
        let kernel = kernel_of(gpu, tier, options)?;
        gpu.device.guarded(|| Self::prepared(gpu, viewed, effects, kernel, options, |accel| accel))
    }

    /// `keep` says what of the lists outlives their upload.
    fn prepared<K>(
        gpu: &'a Gpu,
        viewed: &ViewedScene,
        effects: &Effects,
        (kernel, rounding): (Kernel, Rounding),
        options: &Options,
        keep: impl FnOnce(Acceleration) -> K,
    ) -> Result<(Self, K), Error> {
        check_picture(viewed)?;
        check_range(viewed, effects, kernel)?;
        let (scene, settings) = (viewed.scene(), viewed.settings());
        let (tuning, tables) = (&gpu.tuned().tuning, gpu.tables());
        let specialisation = Specialisation {
            slots: O::SLOTS,
            certified: options.certified,
            linear: options.linear || options.terms || options.one_ray,
            one_ray: options.one_ray,
            count_rays: options.count_rays && !options.count_tests,
            count_tests: options.count_tests,
            dispatch_tiles: dispatch_tiles(gpu.device.info.max_uniform),
            ..Specialisation::new(viewed, effects, kernel, tuning, tables)
        };
        let fits = |accel: &Acceleration| !are_too_large(&gpu.device, tables, &list_contents(accel));
        let lists = |density| {
            let accel = Acceleration::with_density(viewed, specialisation.effects, rounding, density);
            // Room for other eyes must not keep a scene from fitting, nor must finer lists than are needed.
            if fits(&accel) { accel } else { Acceleration { room: None, ..accel } }
        };
        let mut accel = lists(&tuning.density);
        if tuning.density != Density::LEAST && !fits(&accel) {
            accel = lists(&Density::LEAST);
        }
        let mut specialisation = specialisation.with_grid(accel.grid.as_ref(), tuning);
        let true_axes = effects.set.has(Effect::Ellipsoids);
        let leaves_surfaces = effects.set.has_secondary_rays();
        let indices = leaves_surfaces.then(|| viewed.shape_indices(true_axes)).flatten();
        let tangent_margin = if kernel.tells_tangents() {
            let ellipsoids = scene.spheres.par_iter().map(|sphere| ellipsoid(sphere, true_axes));
            TangentMargin::new(viewed, kernel.rounding().tests).widest(ellipsoids)
        } else {
            0.0
        };
        specialisation.shared_surfaces = indices.is_some();
        let packing = tracing::info_span!("pack tables").entered();
        let packed = Packed::new(viewed, effects, kernel, &accel, indices, tangent_margin, options.certified);
        if specialisation.variant().copies() && !copies_fit(&gpu.device, tables, &packed, &accel) {
            specialisation.schedule = Schedule::AtOnce;
        }
        if options.one_ray {
            specialisation.schedule = Schedule::InPlace;
        }
        if options.terms {
            // No ray looks for what is beyond the grid.
            (specialisation.schedule, specialisation.secondary) = (Schedule::First, Secondary::Grid);
        }
        let list_tables = list_contents(&accel);
        check_fits(&gpu.device, tables, &packed, &list_tables)?;
        drop(packing);
        let cover = accel.screen.cover();
        let picture_tiles = u64::from(scene.width.div_ceil(TILE)) * u64::from(scene.height.div_ceil(TILE));
        let covered_tiles = picture_tiles.min(cover.most());
        // Lists that nobody wants any more go before the spheres take memory on the device.
        let uploading = tracing::info_span!("upload tables").entered();
        let pool = viewed.kept().and_then(Kept::tables::<TablePool>);
        let mut set = TableSet::new(&gpu.device, tables, pool);
        add_lists(&mut set, &gpu.device, &accel, &list_tables)?;
        add_copies(&mut set, &gpu.device, &packed, &accel, &specialisation)?;
        drop(list_tables);
        let kept = keep(accel);
        let basis = Basis::Materials {
            effects: effects.set,
            layout: [kernel.is_double(), options.certified],
            light: (scene.ambient.to_array(), settings.quantize),
            factor: viewed.factor(),
        };
        add_scene(&mut set, &gpu.device, &packed, &specialisation, basis)?;
        drop(uploading);
        let samples = u64::from(settings.pattern.count());
        let tiles = match options.pixel_ms {
            None => tuning.first_dispatch_tests as u64 / tests_of_tile(viewed, effects),
            Some(ms) => (tuning.dispatch_ms / (ms * TILE_PIXELS as f64).max(1e-9)) as u64,
        };
        let color = if kernel.is_double() { scene.background } else { scene.background.as_vec3().as_dvec3() };
        let background = Linear { color, coverage: 0.0 };
        let renderer = Self {
            gpu,
            output: PhantomData,
            cover,
            size: (scene.width, scene.height),
            tile_words: TileWords::new(scene.width),
            samples,
            covered_tiles,
            background: (settings.quantize.levels(scene.background), background),
            max_depth: effects.depth,
            asked: [0; 2],
            hands: match gpu.device.info.kind.class() {
                Class::Software => std::thread::available_parallelism().map_or(1, NonZero::get),
                Class::Integrated | Class::Discrete => 1,
            },
            work: None,
            inputs: BuildInputs { tables: set, specialisation },
            tiles_per_dispatch: tiles.clamp(1, u64::from(specialisation.dispatch_tiles)) as u32,
            times: DeviceTimes::default(),
            submitted: 0,
            timestamps: options.device_clock.then(|| Timestamps::new(&gpu.device)).flatten(),
            pixels: 0,
            rays: [0; 2],
            counted: None,
        };
        Ok((renderer, kept))
    }

    /// Which kernels render.
    pub fn variant(&self) -> Variant {
        self.inputs.specialisation.variant()
    }

    /// What they are specialised for.
    pub fn specialisation(&self) -> &Specialisation {
        &self.inputs.specialisation
    }

    /// Whether it tells pixels whose rays may touch a sphere or not.
    pub fn tells_tangents(&self) -> bool {
        self.inputs.specialisation.kernel.tells_tangents()
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The part of the picture that it renders.
    pub fn area(&self) -> Area {
        self.cover.area()
    }

    /// Whether it has colours of pixels before they are quantised.
    pub fn is_linear(&self) -> bool {
        self.inputs.specialisation.linear
    }

    /// Whether its colours are terms of first hits.
    pub fn has_terms(&self) -> bool {
        self.inputs.specialisation.schedule == Schedule::First
    }

    /// Times of the work so far.
    pub fn times(&self) -> DeviceTimes {
        self.times
    }

    /// Whether the device's own clock is read.
    pub fn has_clock(&self) -> bool {
        self.timestamps.is_some()
    }

    /// Why a picture is refused of which so many pixels are cut.
    pub fn too_few_turns(&self, pixels: usize) -> Error {
        Error::Cut { device: self.gpu.device.info.to_string(), pixels }
    }

    /// Primary, shadow and reflection rays of all pixels so far; `None` where they are not counted. Those that need no ray, since no
    /// sphere is near, count as if they had had theirs.
    pub fn rays(&self) -> Option<[u64; 3]> {
        let primary = self.pixels * self.samples;
        self.inputs.specialisation.count_rays.then_some([primary, self.rays[0], self.rays[1]])
    }

    /// Compiles the kernels and runs them once, since drivers finish compiling at the first dispatch.
    fn build(&mut self) -> Result<Work, Error> {
        let start = Instant::now();
        let gpu = self.gpu;
        let BuildInputs { tables, specialisation } = &self.inputs;
        let (pipelines, used_before) = gpu.pipelines(specialisation)?;
        let capacity = self.capacity();
        let has_bounces = self.max_depth > 0;
        let reserving = tracing::info_span!("reserve buffers").entered();
        let work = gpu.device.checked("reserving buffers", || {
            Work::new(gpu, pipelines, &tables.resources(), capacity, specialisation, has_bounces)
        })?;
        drop(reserving);
        if !used_before {
            let _span = tracing::info_span!("first dispatch").entered();
            self.submit(&work, &[[0, 0]])?;
        }
        self.times.compile = start.elapsed();
        Ok(work)
    }

    /// How many tiles a dispatch has at the most: as their buffers and the device's limits allow.
    fn capacity(&self) -> u32 {
        let info = &self.gpu.device.info;
        let specialisation = &self.inputs.specialisation;
        let path = 2 * specialisation.path_size() * u64::from(specialisation.keeps_paths());
        let color = if specialisation.keeps_colors() { specialisation.color_size() } else { 4 };
        let count = if specialisation.counts() { RAY_COUNT_SIZE } else { 0 };
        let slots = TILE_PIXELS as u64 * self.samples;
        let bytes =
            (u64::from(self.gpu.tuned().tuning.path_mib) << 20).min(info.max_storage_binding).min(info.max_buffer);
        // Paths take a workgroup for so many of them.
        let paths = (u64::from(info.max_workgroups) * u64::from(specialisation.workgroup)).min(MAX_PATHS);
        let limit = u64::from(specialisation.dispatch_tiles.min(info.max_workgroups))
            .min(paths / slots)
            .min(bytes / (slots * path.max(color).max(count)));
        self.covered_tiles.min(limit).max(1) as u32
    }

    /// Tiles, or pixels of a list, as the kernels read them.
    fn packed_places(&self, places: &[[u32; 2]]) -> Vec<u8> {
        match O::SLOTS {
            Slots::Tiles => self.tile_words.packed(self.dispatch_bits().into(), places),
            Slots::List => {
                let mut whole = vec![[self.dispatch_bits().into(), 0]];
                whole.extend(places);
                whole.resize(1 + places.len().next_multiple_of(TILE_PIXELS), [0, 0]);
                bytemuck::cast_slice(&whole).to_vec()
            }
        }
    }

    /// The number of the dispatch that runs, or of the last one.
    fn dispatch_bits(&self) -> u8 {
        dispatch_bits(self.submitted)
    }

    /// The workgroups over so many tiles, or pixels of a list.
    fn workgroups(places: usize) -> u32 {
        match O::SLOTS {
            Slots::Tiles => places as u32,
            Slots::List => places.div_ceil(TILE_PIXELS) as u32,
        }
    }

    fn dispatch(&mut self, work: &Work, tiles: &[[u32; 2]]) -> Result<Duration, Error> {
        let _span = tracing::info_span!("dispatch", places = tiles.len()).entered();
        let start = Instant::now();
        self.submit(work, tiles)?;
        let took = start.elapsed();
        self.times.render += took;
        if let Some(timestamps) = &self.timestamps {
            self.times.on_device += timestamps.elapsed(&self.gpu.device)?;
        }
        self.times.longest_dispatch = self.times.longest_dispatch.max(took);
        self.times.dispatches += 1;
        Ok(took)
    }

    /// Runs all kernels over `tiles` and waits for them.
    fn submit(&mut self, work: &Work, tiles: &[[u32; 2]]) -> Result<(), Error> {
        self.submitted += 1;
        self.gpu.device.queue.write_buffer(&work.tiles, 0, &self.packed_places(tiles));
        self.gpu.device.queue.write_buffer(&work.path_queue, 0, &[0; PATH_QUEUE_SIZE as usize]);
        if self.has_terms() || self.inputs.specialisation.one_ray {
            self.gpu.device.queue.write_buffer(&work.asked, 0, bytemuck::bytes_of(&self.asked));
        }
        let mut encoder = self.gpu.device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: self.timestamps.as_ref().map(Timestamps::writes),
            });
            let mut run = |pipeline: &Pipeline, group: &wgpu::BindGroup, workgroups: Workgroups| {
                pass.set_pipeline(&pipeline.raw);
                pass.set_bind_group(0, group, &[]);
                match workgroups {
                    Workgroups::Known(count) => pass.dispatch_workgroups(count, 1, 1),
                    Workgroups::Found(word) => pass.dispatch_workgroups_indirect(&work.workgroups, 4 * u64::from(word)),
                }
            };
            let tiles = Workgroups::Known(Self::workgroups(tiles.len()));
            let pipelines = &work.pipelines;
            run(&pipelines.trace, &work.trace_group, tiles);
            if let (Some(Bounce { begin, walk, shade }), Some(begin_group), Some(walk_groups)) =
                (&pipelines.bounce, &work.begin_group, &work.walk_groups)
            {
                for bounce in 0..self.max_depth {
                    let (has_next, from) = (usize::from(bounce + 1 < self.max_depth), bounce as usize % 2);
                    run(begin, begin_group, Workgroups::Known(1));
                    match (shade, &work.shade_groups) {
                        (Some(shade), Some(shade_groups)) => {
                            run(walk, &walk_groups[has_next][from], Workgroups::Found(SEVERAL_PATHS));
                            run(shade, &shade_groups[has_next][from], Workgroups::Found(ONE_PATH));
                        }
                        _ => run(walk, &walk_groups[has_next][from], Workgroups::Found(ONE_PATH)),
                    }
                }
            }
            if let (Some(resolve), Some(group)) = (&pipelines.resolve, &work.resolve_group) {
                run(resolve, group, tiles);
            }
        }
        if let Some(timestamps) = &self.timestamps {
            timestamps.resolve(&mut encoder);
        }
        self.gpu.device.submit(Some(encoder.finish()));
        self.gpu.device.wait()
    }

    /// Whether the dispatch has to be repeated, since bounces or paths that share an invocation, and so the turns of its loops, need
    /// more of them than it has: from then on each has its own.
    fn walks_at_once_instead(&mut self, statuses: &Statuses) -> bool {
        let specialisation = &mut self.inputs.specialisation;
        let repeats = specialisation.shares_turns() && statuses.is_cut();
        if repeats {
            specialisation.schedule = Schedule::AtOnce;
            self.work = None;
        }
        repeats
    }

    /// Adds up the counts of those of so many places of the last dispatch that `asked` has a pixel for.
    fn add_counts(
        &mut self,
        work: &Work,
        places: usize,
        asked: impl Fn(usize) -> Option<[u32; 2]>,
    ) -> Result<(), Error> {
        if !self.inputs.specialisation.counts() {
            return Ok(());
        }
        let (samples, rays, counted) = (self.samples as usize, &mut self.rays, &mut self.counted);
        let add = |counts: &[u32]| {
            for (place, counts) in counts.as_chunks::<2>().0.chunks(samples).enumerate() {
                let Some(pixel) = asked(place) else { continue };
                let sum = counts
                    .iter()
                    .fold([0, 0], |[s, o], &[shadow, other]| [s + u64::from(shadow), o + u64::from(other)]);
                *rays = [rays[0] + sum[0], rays[1] + sum[1]];
                if let Some((area, counted)) = counted {
                    counted[area.index(pixel)] = sum;
                }
            }
        };
        work.ray_counts.read(&self.gpu.device, 2 * places * samples, add)
    }

    /// Sizes the next dispatch by the last one's time, growing by a factor of 4 at most.
    fn set_pace(&mut self, tiles: usize, took: Duration) {
        let target = self.gpu.tuned().tuning.dispatch_ms * 1e-3;
        let factor = (target / took.as_secs_f64().max(1e-9)).min(4.0);
        self.tiles_per_dispatch = ((tiles as f64 * factor) as u32).clamp(1, self.inputs.specialisation.dispatch_tiles);
    }
}

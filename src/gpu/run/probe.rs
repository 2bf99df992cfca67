//! Rays in batches through the very code that renders: the same shader files with the entry points of `shaders/probe.wgsl`.

mod check;

use std::collections::HashMap;
use std::time::{Duration, Instant};

use glam::DVec3;

use crate::camera::NEAR_T_MIN;
use crate::effects::{Effect, EffectSet};
use crate::geometry::{Ellipsoid, range_factor, shape_indices};
use crate::gpu::device::error::Error;
use crate::gpu::device::readable::Readable;
use crate::gpu::device::upload::small_buffer;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::pipeline::{Pipeline, Resource};
use crate::gpu::kernel::specialisation::Specialisation;
use crate::gpu::kernel::spirv::ParsedModule;
use crate::gpu::kernel::variant::{Kernel, Schedule, Secondary, Slots, Storage};
use crate::gpu::shared;
use crate::gpu::table::layout::{ConeValues, Layout, ListValues, ParamValues, ShapeValues, double, single};
use crate::gpu::table::pack::{bytes, low_light, low_shape, shape_value};
use crate::scene::{Light, Sphere};

/// Rays of a dispatch at the most: some milliseconds on the slowest device seen.
const MAX_RAYS: usize = 1 << 16;
/// Invocations of a workgroup.
const GROUP: usize = shared::SMALL_GROUP as usize;
/// Numbers of an answer with the point of the hit.
const POINT_VALUES: usize = shared::POINT_VALUES as usize;

/// One ray and what it can meet.
#[derive(Debug, Clone, Copy)]
pub struct ProbeRay {
    /// Where t is 0.
    pub origin: DVec3,
    /// One unit of t; need not be normalised.
    pub direction: DVec3,
    /// First sphere of the batch that it can meet.
    pub first: u32,
    /// One past the last.
    pub end: u32,
    /// Whether roots count beyond the image plane at t = 1 only, and not from t > 0 on.
    pub primary: bool,
    /// The sphere whose outside it leaves.
    pub own: Option<u32>,
}

/// An ellipsoid with axes along those of the world.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Its centre.
    pub center: DVec3,
    /// Its semi-axes; a negative one means its absolute value.
    pub scale: DVec3,
}

/// Rays, the surfaces that they can meet and, where asked for, the light of each.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    /// The rays.
    pub rays: Vec<ProbeRay>,
    /// The surfaces; those of a ray lie beside each other, and near those of the next ray.
    pub surfaces: Vec<Surface>,
    /// The position of each ray's light; empty where none is asked for.
    pub lights: Vec<DVec3>,
    /// Reflections or refractions before the hit that [`Question::Bounce`] or [`Question::Refract`] asks for.
    pub bounces: u32,
    /// Index of refraction of all surfaces, for [`Question::Refract`].
    pub eta: f64,
    /// Specular exponent of all surfaces, for [`Question::Highlight`].
    pub exponent: f64,
}

impl Batch {
    /// The batch in the units in which a picture of this world is rendered; no t changes.
    pub fn in_range(mut self) -> Self {
        let surfaces = self.surfaces.iter().flat_map(|s| [s.center, s.scale]);
        let rays = self.rays.iter().map(|ray| ray.origin);
        let all = surfaces.chain(rays).chain(self.lights.iter().copied());
        let k = range_factor(all.map(|v| v.abs().max_element()).fold(0.0, f64::max));
        for surface in &mut self.surfaces {
            surface.center *= k;
            surface.scale *= k;
        }
        for ray in &mut self.rays {
            ray.origin *= k;
            ray.direction *= k;
        }
        for light in &mut self.lights {
            *light *= k;
        }
        self
    }
}

/// What the device says of the point of a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Where it is.
    pub place: DVec3,
    /// What the kernel carries of it besides.
    pub place_low: DVec3,
    /// The unit normal on the side of the ray.
    pub normal: DVec3,
    /// The unit direction of the mirrored ray.
    pub mirrored: DVec3,
}

/// What the device says of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Whether it meets a surface.
    pub found: bool,
    /// Whether that is the greater root: the surface is met from inside.
    pub inside: bool,
    /// Whether the device holds `value` for finite.
    pub finite: bool,
    /// Whether the hit point faces its light.
    pub facing: bool,
    /// Whether something stands between the hit point and its light, or between the origin and t = 1.
    pub blocked: bool,
    /// The surface, by its place in the batch.
    pub surface: u32,
    /// t, the cosine to the light, the specular term, or the power asked for.
    pub value: f64,
    /// The point of the hit, where it was asked for; anything where nothing is hit.
    pub point: Option<Point>,
    /// The two words as they are.
    pub words: [u32; 2],
}

/// What a batch asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Question {
    /// The nearest hit.
    Nearest,
    /// The nearest hit and its point.
    Point,
    /// Whether anything stands between the origin and t = 1.
    Blocked,
    /// The nearest hit, and whether its light reaches it.
    Lit,
    /// The nearest hit, and the specular term of its light: (N·H)ⁿ if `blinn`, else (R·V)ⁿ.
    Highlight {
        /// Which of the two.
        blinn: bool,
    },
    /// The hit after so many reflections as the batch says, and its point.
    Bounce,
    /// The hit after so many refractions as the batch says, and its point.
    Refract,
    /// cosⁿ; the origin's x is 1 − cos, its y is n.
    Power,
    /// The residuals of the error-free sum and product of the origin's x and y.
    Transforms,
}

impl Question {
    fn entry_point(self) -> &'static str {
        match self {
            Self::Nearest => "probe_nearest",
            Self::Point => "probe_point",
            Self::Blocked => "probe_blocked",
            Self::Lit => "probe_lit",
            Self::Highlight { .. } => "probe_highlight",
            Self::Bounce => "probe_bounce",
            Self::Refract => "probe_refract",
            Self::Power => "probe_power",
            Self::Transforms => "probe_transforms",
        }
    }

    /// Numbers of an answer.
    fn values(self) -> usize {
        match self {
            Self::Point | Self::Bounce | Self::Refract => POINT_VALUES,
            _ => 1,
        }
    }
}

/// Numbers for the kernel as they are, past the packing of pictures: for bit patterns that no scene has.
#[derive(Debug, Clone, Default)]
pub struct RawBatch {
    /// Origin and direction, and what is to pass for their low parts.
    pub rays: Vec<[[f64; 6]; 2]>,
    /// The shape of each ray, and what is to pass for its low parts.
    pub shapes: Vec<[ShapeValues; 2]>,
}

/// Bytes of one dispatch, by the shader's name for them.
type Inputs = Vec<(&'static str, Vec<u8>)>;

/// A kernel on a device that answers batches of rays.
#[derive(Debug)]
pub struct Prober<'a> {
    gpu: &'a Gpu,
    kernel: Kernel,
    module: ParsedModule,
    /// By question, and whether object space is more than a translation.
    pipelines: HashMap<(Question, bool), Pipeline>,
    busy: Duration,
}

impl<'a> Prober<'a> {
    /// Composes the module; [`Error::ArithmeticRefused`] where the device's arithmetic is not what the tier promises.
    pub fn new(gpu: &'a Gpu, kernel: Kernel) -> Result<Self, Error> {
        let kernel = match kernel {
            Kernel::Tier(tier) => gpu.kernel(tier)?,
            kernel => kernel,
        };
        let module = ParsedModule::new(&Module::probe(kernel)).map_err(Error::Shader)?;
        let module = if kernel == Kernel::NoBarrier { module.contractible() } else { module };
        Ok(Self { gpu, kernel, module, pipelines: HashMap::new(), busy: Duration::ZERO })
    }

    /// Its kernel.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Its device.
    pub fn gpu(&self) -> &'a Gpu {
        self.gpu
    }

    /// Time of all dispatches so far, from submission to completion.
    pub fn busy(&self) -> Duration {
        self.busy
    }

    /// Answers `question` for every ray of `batch`, in order; [`Error::Misuse`] where the parts of the batch do not fit together.
    pub fn ask(&mut self, question: Question, batch: &Batch) -> Result<Vec<Answer>, Error> {
        batch.check(question)?;
        self.gpu.device.guarded(|| self.ask_checked(question, batch))
    }

    fn ask_checked(&mut self, question: Question, batch: &Batch) -> Result<Vec<Answer>, Error> {
        // As in a picture: true spheres need no object space.
        let ellipsoids =
            batch.surfaces.iter().any(|surface| surface.scale.abs().max_element() != surface.scale.abs().min_element());
        self.prepare(question, ellipsoids)?;
        let mut answers = Vec::with_capacity(batch.rays.len());
        for (chunk, rays) in batch.rays.chunks(MAX_RAYS).enumerate() {
            let first = rays.iter().map(|ray| ray.first).min().unwrap_or(0);
            let end = rays.iter().map(|ray| ray.end).max().unwrap_or(0);
            let surfaces = &batch.surfaces[first as usize..end as usize];
            let lights = batch.lights.iter().skip(chunk * MAX_RAYS).take(rays.len());
            let lights: Vec<_> = lights.map(|&position| Light { position, intensity: DVec3::ONE }).collect();
            let bounces = matches!(question, Question::Bounce | Question::Refract).then_some(batch.bounces);
            let chunk = Chunk { rays, surfaces, first, lights, bounces, ellipsoids, batch };
            let inputs =
                if self.kernel.is_double() { chunk.pack::<double::Layout>() } else { chunk.pack::<single::Layout>() };
            self.dispatch((question, ellipsoids), &inputs, rays.len(), first, &mut answers)?;
        }
        Ok(answers)
    }

    /// The nearest hit of every ray with its shape; [`Error::Misuse`] where there is not one for each.
    pub fn ask_raw(&mut self, batch: &RawBatch) -> Result<Vec<Answer>, Error> {
        batch.check()?;
        self.gpu.device.guarded(|| self.ask_raw_checked(batch))
    }

    fn ask_raw_checked(&mut self, batch: &RawBatch) -> Result<Vec<Answer>, Error> {
        self.prepare(Question::Nearest, true)?;
        let mut answers = Vec::with_capacity(batch.rays.len());
        for (rays, shapes) in batch.rays.chunks(MAX_RAYS).zip(batch.shapes.chunks(MAX_RAYS)) {
            let inputs = if self.kernel.is_double() {
                pack_raw::<double::Layout>(rays, shapes)
            } else {
                pack_raw::<single::Layout>(rays, shapes)
            };
            self.dispatch((Question::Nearest, true), &inputs, rays.len(), 0, &mut answers)?;
        }
        Ok(answers)
    }

    fn prepare(&mut self, question: Question, ellipsoids: bool) -> Result<(), Error> {
        if self.pipelines.contains_key(&(question, ellipsoids)) {
            return Ok(());
        }
        let specialisation = Specialisation {
            kernel: self.kernel,
            effects: EffectSet::ALL.with(Effect::Ellipsoids, ellipsoids),
            shared_surfaces: true,
            refraction: None,
            blinn: question == Question::Highlight { blinn: true },
            storage: Storage::Ranges,
            lights: 0,
            secondary: Secondary::Large,
            sphere_count: 0,
            schedule: Schedule::InPlace,
            certified: false,
            linear: false,
            count_rays: false,
            count_tests: false,
            one_ray: false,
            workgroup: 64,
            samples: 1,
            side: 1,
            parallel: false,
            slots: Slots::Tiles,
            dispatch_tiles: 0,
        };
        let constants = specialisation.constants();
        let pipeline = Pipeline::new(self.gpu.compiler(), &self.module, question.entry_point(), &constants)?;
        self.pipelines.insert((question, ellipsoids), pipeline);
        Ok(())
    }

    fn dispatch(
        &mut self,
        asked: (Question, bool),
        inputs: &Inputs,
        count: usize,
        first: u32,
        answers: &mut Vec<Answer>,
    ) -> Result<(), Error> {
        let (question, _) = asked;
        let Some(pipeline) = self.pipelines.get(&asked) else { return Ok(()) };
        let device = &self.gpu.device;
        let padded = count.next_multiple_of(GROUP);
        let real = if self.kernel.is_double() { 8 } else { 4 };
        let params = if self.kernel.is_double() { params::<double::Layout>() } else { params::<single::Layout>() };
        let flags = Readable::new(device, padded as u64 * 2);
        let size = question.values();
        let values = Readable::new(device, (padded * size * real / 4) as u64);
        let group = device.checked("reserving buffers", || {
            let bound = |name, contents: &[u8], usage| {
                let contents = if contents.is_empty() { &[0; 256] } else { contents };
                (name, Resource::Buffer(small_buffer(device, contents, usage)))
            };
            let params = bound("given_params", &params, wgpu::BufferUsages::UNIFORM);
            let inputs = inputs.iter().map(|(name, contents)| bound(*name, contents, wgpu::BufferUsages::STORAGE));
            let outputs = [("probe_flags", &flags), ("probe_values", &values)];
            let outputs = outputs.map(|(name, output)| (name, Resource::Buffer(output.buffer.clone())));
            pipeline.bind(device, &inputs.chain([params]).chain(outputs).collect::<Vec<_>>())
        })?;
        let start = Instant::now();
        pipeline.dispatch(device, &group, [(padded / GROUP) as u32, 1]);
        device.wait()?;
        self.busy += start.elapsed();
        let flags = flags.read(device, count * 2, <[u32]>::to_vec)?;
        let values = values.read(device, count * size * real / 4, <[u32]>::to_vec)?;
        let value = |i: usize| match real {
            4 => f64::from(f32::from_bits(values[i])),
            _ => f64::from_bits(u64::from(values[2 * i]) | (u64::from(values[2 * i + 1]) << 32)),
        };
        let vector = |at: usize| DVec3::new(value(at), value(at + 1), value(at + 2));
        let point = |at: usize| Point {
            place: vector(at + 1),
            place_low: vector(at + 4),
            normal: vector(at + 7),
            mirrored: vector(at + 10),
        };
        answers.extend(flags.as_chunks::<2>().0.iter().enumerate().map(|(i, words)| Answer {
            found: words[0] & shared::PROBE_FOUND != 0,
            inside: words[0] & shared::PROBE_INSIDE != 0,
            finite: words[0] & shared::PROBE_FINITE != 0,
            facing: words[0] & shared::PROBE_FACING != 0,
            blocked: words[0] & shared::PROBE_BLOCKED != 0,
            surface: words[1].wrapping_add(first),
            value: value(i * size),
            point: (size == POINT_VALUES).then(|| point(i * size)),
            words: *words,
        }));
        Ok(())
    }
}

fn params<L: Layout>() -> Vec<u8> {
    bytes([L::params(&ParamValues {
        background: DVec3::ZERO,
        ambient: DVec3::ZERO,
        primary_t_min: NEAR_T_MIN,
        shadow_t_min: 0.0,
        reflection_t_min: 0.0,
        quantize_scale: 255.0,
        quantize_bias: 0.0,
        window_rows: 0,
        lists: ListValues::default(),
        window_low: 0,
        light_count: 0,
        max_depth: 0,
        tangent_margin: 0.0,
        cones: ConeValues::default(),
    })])
}

fn reals<L: Layout>(values: impl Iterator<Item = [f64; 6]>, count: usize) -> Vec<u8> {
    let padding = count.next_multiple_of(GROUP) - count;
    bytes(values.chain(std::iter::repeat_n([0.0; 6], padding)).flatten().map(L::real))
}

/// What of a batch one dispatch answers.
struct Chunk<'a> {
    rays: &'a [ProbeRay],
    /// Those that the rays can meet, from this one of the batch on.
    surfaces: &'a [Surface],
    first: u32,
    lights: Vec<Light>,
    bounces: Option<u32>,
    /// Whether object space is more than a translation.
    ellipsoids: bool,
    batch: &'a Batch,
}

impl Chunk<'_> {
    fn pack<L: Layout>(&self) -> Inputs {
        let Self { rays, first, .. } = *self;
        let sphere = |s: &Surface| Sphere {
            center: s.center,
            scale: s.scale,
            color: DVec3::ONE,
            ka: 0.0,
            kd: 1.0,
            ks: 1.0,
            kr: 0.0,
            n: self.batch.exponent,
            kt: 1.0,
            eta: self.batch.eta,
        };
        let spheres: Vec<_> = self.surfaces.iter().map(sphere).collect();
        let ellipsoids: Vec<_> = spheres.iter().map(Ellipsoid::new).collect();
        let indices = shape_indices(&spheres, true).unwrap_or_else(|| (0..spheres.len() as u32).collect());
        let shapes = ellipsoids.iter().zip(indices).map(|(e, index)| shape_value(e, index, self.ellipsoids));
        let shapes: Vec<_> = shapes.collect();
        let material =
            |(s, e): (&Sphere, &Ellipsoid)| L::material(s, if self.ellipsoids { e.scale } else { DVec3::ONE }, 0.0);
        let numbers = |ray: &ProbeRay| {
            let (o, d) = (ray.origin, ray.direction);
            [o.x, o.y, o.z, d.x, d.y, d.z]
        };
        let words = |ray: &ProbeRay| {
            let own = ray.own.map_or(0, |own| own - first + 1);
            [ray.first - first, ray.end - first, self.bounces.unwrap_or(u32::from(!ray.primary)), own]
        };
        // The kernel reads the light of every invocation, those past the last ray included.
        let padding = rays.len().next_multiple_of(GROUP) - rays.len();
        let mut lights = self.lights.clone();
        lights.extend(std::iter::repeat_n(Light { position: DVec3::ZERO, intensity: DVec3::ONE }, padding));
        let mut words: Vec<_> = rays.iter().map(words).collect();
        words.extend(std::iter::repeat_n([0; 4], padding));
        let numbers = rays.iter().map(numbers);
        vec![
            ("shapes", bytes(shapes.iter().map(L::shape))),
            ("shapes_low", bytes(shapes.iter().map(|s| L::shape(&low_shape::<L>(s))))),
            ("materials", bytes(spheres.iter().zip(&ellipsoids).map(material))),
            ("glasses", bytes(spheres.iter().map(L::glass))),
            ("lights", bytes(lights.iter().map(L::light))),
            ("lights_low", bytes(lights.iter().map(|light| L::light(&low_light::<L>(light))))),
            ("probe_reals", reals::<L>(numbers.clone(), rays.len())),
            ("probe_low", reals::<L>(numbers.map(|all| all.map(L::residual)), rays.len())),
            ("probe_words", bytes(words)),
        ]
    }
}

fn pack_raw<L: Layout>(rays: &[[[f64; 6]; 2]], shapes: &[[ShapeValues; 2]]) -> Inputs {
    let part = |part: usize| bytes(shapes.iter().map(|s| L::shape(&s[part])));
    let real = |part: usize| reals::<L>(rays.iter().map(|ray| ray[part]), rays.len());
    let mut words: Vec<_> = (0..rays.len() as u32).map(|i| [i, i + 1, 1, 0]).collect();
    words.resize(rays.len().next_multiple_of(GROUP), [0; 4]);
    vec![
        ("shapes", part(0)),
        ("shapes_low", part(1)),
        ("probe_reals", real(0)),
        ("probe_low", real(1)),
        ("probe_words", bytes(words)),
    ]
}

//! From effects to compiled kernels: the only place that sets the constants of `shaders/effects.wgsl`.

use std::num::NonZeroU32;

use super::device::Gpu;
use super::error::Error;
use super::shader::{Kernel, Module, Slots, Storage};
use crate::effects::{Effect, EffectSet, Effects};
use crate::scene::Scene;
use crate::settings::{Secondary, Settings, Specular};

/// Up to this many spheres and lights a pipeline is compiled for their very number: the array lengths in
/// `shaders/few.wgsl`.
pub(super) const MAX_FEW: usize = 16;
/// Up to this many lights and their faces lie in uniform buffers: the array lengths in `shaders/lights_uniform.wgsl`, a sixth
/// of that in `shaders/faces_uniform.wgsl`.
pub(super) const MAX_UNIFORM_LIGHTS: usize = 32;

/// What a pipeline is specialised for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Specialisation {
    /// The kernel.
    pub kernel: Kernel,
    /// The effects that it simulates.
    pub effects: EffectSet,
    /// Where something refracts, how many rays wait at the most.
    pub refraction: Option<NonZeroU32>,
    /// Whether shadow and reflection rays skip their own sphere.
    pub skip_self: bool,
    /// Whether the specular term is (N·H)ⁿ.
    pub blinn: bool,
    /// How spheres and lights reach it.
    pub storage: Storage,
    /// Side of the grid of samples in a pixel.
    pub samples: u32,
    /// Which pixels a dispatch renders.
    pub slots: Slots,
    /// Whether each pixel also says how many rays it took.
    pub count_rays: bool,
}

impl Specialisation {
    /// For `scene` with `effects` under `settings`.
    pub fn new(scene: &Scene, settings: &Settings, effects: &Effects, kernel: Kernel) -> Self {
        let (spheres, lights) = (scene.spheres.len(), scene.lights.len());
        let storage = if spheres.max(lights) <= MAX_FEW {
            Storage::Few([spheres as u32, lights as u32])
        } else if lights <= MAX_UNIFORM_LIGHTS {
            Storage::Many
        } else {
            Storage::ManyLights
        };
        Self {
            kernel,
            effects: effects.set,
            refraction: NonZeroU32::new(effects.waiting(scene)),
            skip_self: settings.secondary == Secondary::SkipSelf,
            blinn: settings.specular == Specular::Blinn,
            storage,
            samples: settings.samples,
            slots: Slots::Tiles,
            count_rays: false,
        }
    }

    /// The constants by name; booleans are 0 and 1.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        let on = |effect| f64::from(self.effects.has(effect));
        let mut constants = vec![
            ("AMBIENT", on(Effect::Ambient)),
            ("DIFFUSE", on(Effect::Diffuse)),
            ("SPECULAR", on(Effect::Specular)),
            ("SHADOWS", on(Effect::Shadows)),
            ("REFLECTIONS", on(Effect::Reflections)),
            ("SHELLS", on(Effect::Shells)),
            ("ELLIPSOIDS", on(Effect::Ellipsoids)),
            ("SKIP_SELF", f64::from(self.skip_self || self.refraction.is_some())),
            ("BLINN", f64::from(self.blinn)),
            ("SAMPLES", f64::from(self.samples)),
            ("COUNT_RAYS", f64::from(self.count_rays)),
        ];
        if self.refraction.is_some() {
            constants.push(("SKIP_SELF_ALWAYS", f64::from(self.skip_self)));
        }
        if let Storage::Few([spheres, lights]) = self.storage {
            constants.extend([("SPHERE_COUNT", f64::from(spheres)), ("LIGHT_COUNT", f64::from(lights))]);
        }
        constants
    }

    /// Whether samples go on as paths.
    pub(super) fn has_paths(&self) -> bool {
        self.refraction.is_none() && self.effects.has(Effect::Reflections)
    }

    /// The effects whose rays find their spheres in lists: primary rays always do.
    pub(super) fn listed_effects(&self) -> EffectSet {
        match self.storage {
            Storage::Few(_) => {
                let walks = [Effect::Shadows, Effect::Reflections, Effect::Refraction];
                walks.into_iter().fold(self.effects, |effects, effect| effects.with(effect, false))
            }
            _ => self.effects,
        }
    }

    /// The module that renders.
    pub fn module(&self) -> Module {
        Module::render_slots(self.kernel, self.storage, self.samples > 1, self.refraction, self.slots)
    }
}

/// The entry point that casts the primary rays of tiles.
pub const SEE_TILES: &str = "see_tiles";
/// The entry point that casts the primary rays of a list of pixels.
pub const SEE_SAMPLES: &str = "see_samples";
/// The entry point that shades hits.
pub const SHADE_HITS: &str = "shade_hits";
/// The entry point that casts the reflection rays of paths.
pub const WALK_PATHS: &str = "walk_paths";

/// How a binding is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Access {
    Uniform,
    Read,
    ReadWrite,
}

use Access::{Read, ReadWrite, Uniform};

/// A compiled kernel and the bindings that it reads.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    bindings: Vec<u32>,
}

impl Stage {
    /// Binds those of `buffers` that the kernel reads.
    pub(super) fn bind(&self, gpu: &Gpu, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let used = buffers.iter().filter(|(binding, _)| self.bindings.contains(binding));
        let entries: Vec<_> = used
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries };
        gpu.device.create_bind_group(&descriptor)
    }
}

/// The kernels of a picture.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) see: Stage,
    pub(super) begin_shading: Stage,
    pub(super) shade: Stage,
    /// What goes before a bounce of the paths, and the bounce; where there are reflections.
    pub(super) bounce: Option<[Stage; 2]>,
    /// From samples to pixels, where there are several a pixel.
    pub(super) resolve: Option<Stage>,
}

/// Compiles the kernels of a picture.
pub(super) fn compile(gpu: &Gpu, specialisation: &Specialisation) -> Result<Stages, Error> {
    let constants = specialisation.constants();
    let module = gpu.shader_module(&specialisation.module())?;
    let is_few = matches!(specialisation.storage, Storage::Few(_));
    let looped = if is_few { Uniform } else { Read };
    let lights = if specialisation.storage == Storage::ManyLights { Read } else { Uniform };
    // What every stage reads and writes.
    let mut common = vec![(0, Uniform), (1, looped), (2, Read), (7, ReadWrite), (8, ReadWrite), (12, ReadWrite)];
    if specialisation.kernel.carries_low() {
        common.push((9, looped));
    }
    if !is_few {
        common.push((13, Read));
    }
    let primary = [(4, Read), (6, Read)];
    // Paths to go on with, or glass.
    let mut shading = vec![(3, lights)];
    shading.push(if specialisation.refraction.is_some() { (5, Read) } else { (11, ReadWrite) });
    if specialisation.kernel.carries_low() {
        shading.push((10, lights));
    }
    if !is_few {
        shading.push((14, lights));
    }
    let between = gpu.shader_module(&Module::between_stages())?;
    let between = |entry_point| stage(gpu, &between, entry_point, &[], &[(12, ReadWrite), (16, ReadWrite)]);
    let see_entry = match specialisation.slots {
        Slots::Tiles => SEE_TILES,
        Slots::List => SEE_SAMPLES,
    };
    let see = stage(gpu, &module, see_entry, &constants, &[&common[..], &primary].concat())?;
    let begin_shading = between("begin_shading")?;
    let shade = stage(gpu, &module, SHADE_HITS, &constants, &[&common[..], &primary, &shading].concat())?;
    let bounce = if specialisation.has_paths() {
        let walk = stage(gpu, &module, WALK_PATHS, &constants, &[&common[..], &[(11, ReadWrite)]].concat())?;
        Some([between("begin_bounce")?, walk])
    } else {
        None
    };
    let resolve = if specialisation.samples > 1 {
        let module = gpu.shader_module(&Module::resolve(specialisation.kernel))?;
        let constants = [("SAMPLES", f64::from(specialisation.samples))];
        Some(stage(gpu, &module, "resolve", &constants, &[(0, Uniform), (7, Read), (15, ReadWrite)])?)
    } else {
        None
    };
    Ok(Stages { see, begin_shading, shade, bounce, resolve })
}

fn stage(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    constants: &[(&str, f64)],
    bindings: &[(u32, Access)],
) -> Result<Stage, Error> {
    let entry = |&(binding, access): &(u32, Access)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match access {
                Uniform => wgpu::BufferBindingType::Uniform,
                Read => wgpu::BufferBindingType::Storage { read_only: true },
                ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = bindings.iter().map(entry).collect();
    gpu.checked("compiling the kernels", || {
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = gpu.device.create_bind_group_layout(&descriptor);
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&pipeline_layout),
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                zero_initialize_workgroup_memory: false,
            },
            cache: None,
        });
        Stage { pipeline, layout, bindings: bindings.iter().map(|(binding, _)| *binding).collect() }
    })
}

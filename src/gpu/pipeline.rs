//! From effects to a compiled kernel: the only place that sets the constants of `shaders/effects.wgsl`.

use std::num::NonZeroU32;

use super::device::Gpu;
use super::error::Error;
use super::shader::{Kernel, Module};
use crate::effects::{Effect, EffectSet, Effects};
use crate::scene::Scene;
use crate::settings::{Secondary, Settings, Specular};

/// Up to this many spheres and lights a pipeline is compiled for their very number: the array lengths in
/// `shaders/few.wgsl`.
pub(super) const MAX_FEW: usize = 16;

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
    /// Numbers of spheres and lights, where they are few enough to be compiled in.
    pub few: Option<[u32; 2]>,
    /// Side of the grid of samples in a pixel.
    pub samples: u32,
    /// Whether each pixel also says how many rays it took.
    pub count_rays: bool,
}

impl Specialisation {
    /// For `scene` with `effects` under `settings`.
    pub fn new(scene: &Scene, settings: &Settings, effects: &Effects, kernel: Kernel) -> Self {
        let few = scene.spheres.len().max(scene.lights.len()) <= MAX_FEW;
        Self {
            kernel,
            effects: effects.set,
            refraction: NonZeroU32::new(effects.waiting(scene)),
            skip_self: settings.secondary == Secondary::SkipSelf,
            blinn: settings.specular == Specular::Blinn,
            few: few.then_some([scene.spheres.len() as u32, scene.lights.len() as u32]),
            samples: settings.samples,
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
        if let Some([spheres, lights]) = self.few {
            constants.extend([("SPHERE_COUNT", f64::from(spheres)), ("LIGHT_COUNT", f64::from(lights))]);
        }
        constants
    }
}

/// The entry point that renders tiles.
pub const ENTRY_POINT: &str = "render_tiles";

/// Compiles the render kernel.
pub(super) fn compile(gpu: &Gpu, specialisation: &Specialisation) -> Result<wgpu::ComputePipeline, Error> {
    let module = gpu.shader_module(&Module::render(
        specialisation.kernel,
        specialisation.few.is_some(),
        specialisation.refraction,
    ))?;
    gpu.checked("compiling the kernel", || {
        gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(ENTRY_POINT),
            layout: None,
            module: &module,
            entry_point: Some(ENTRY_POINT),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &specialisation.constants(),
                zero_initialize_workgroup_memory: false,
            },
            cache: None,
        })
    })
}

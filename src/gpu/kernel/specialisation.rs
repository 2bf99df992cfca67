//! From effects to constants of kernels: the only place that sets those of `shaders/effects.wgsl`.

use std::num::NonZeroU32;

use super::entry::{BEGIN_BOUNCE, RESOLVE};
use super::module::Module;
use super::variant::{Kernel, Schedule, Secondary, Slots, Storage, Tables, Variant};
use crate::accel::Grid;
use crate::effects::{Effect, EffectSet, Effects};
use crate::gpu::shared::{UNIFORM, dispatch_tiles};
use crate::settings::Specular;
use crate::tuning::Tuning;
use crate::viewed::ViewedScene;

/// What a pipeline is specialised for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Specialisation {
    /// The kernel.
    pub kernel: Kernel,
    /// The effects that it simulates.
    pub effects: EffectSet,
    /// Where something refracts, how many rays wait at the most.
    pub refraction: Option<NonZeroU32>,
    /// Whether spheres share surfaces, so that the own one is not told by the index of its sphere.
    pub shared_surfaces: bool,
    /// Whether the specular term is (N·H)ⁿ.
    pub blinn: bool,
    /// How spheres and lights reach it.
    pub storage: Storage,
    /// Number of lights.
    pub lights: u32,
    /// Where the spheres are that secondary rays look for.
    pub secondary: Secondary,
    /// How many there are, where all are outside the grid.
    pub sphere_count: u32,
    /// How the bounces of paths are scheduled, where nothing refracts.
    pub schedule: Schedule,
    /// Samples of a pixel, and how many columns of them it has.
    pub samples: u32,
    pub side: u32,
    /// Whether primary rays are parallel.
    pub parallel: bool,
    /// Which pixels a dispatch renders.
    pub slots: Slots,
    /// Whether pixels say where rounding could decide what they show.
    pub certified: bool,
    /// Whether each pixel also says its colour before that is quantised.
    pub linear: bool,
    /// Whether each pixel also says how many rays it took.
    pub count_rays: bool,
    /// Whether each pixel says how many tests of a ray with a sphere it took, and not how many rays.
    pub count_tests: bool,
    /// Whether pixels show what one mirrored or refracted ray adds.
    pub one_ray: bool,
    /// Invocations of a workgroup of the kernels that are not over tiles.
    pub workgroup: u32,
    /// Tiles of a dispatch at the most.
    pub dispatch_tiles: u32,
}

impl Specialisation {
    /// For `viewed` with `effects`, on a device with this tuning and these tables.
    pub fn new(viewed: &ViewedScene, effects: &Effects, kernel: Kernel, tuning: &Tuning, tables: Tables) -> Self {
        let (scene, settings) = (viewed.scene(), viewed.settings());
        Self {
            kernel,
            effects: effects.set,
            // In steps, so that scenes and depths share kernels.
            refraction: NonZeroU32::new(effects.waiting(scene)).and_then(NonZeroU32::checked_next_power_of_two),
            shared_surfaces: false,
            blinn: settings.specular == Specular::Blinn,
            storage: Storage::Tables(tables),
            lights: scene.lights.len() as u32,
            secondary: Secondary::Both,
            sphere_count: 0,
            schedule: Schedule::InPlace,
            samples: settings.pattern.count(),
            side: settings.pattern.side(),
            parallel: settings.view.is_parallel(),
            slots: Slots::Tiles,
            certified: false,
            linear: false,
            count_rays: false,
            count_tests: false,
            one_ray: false,
            workgroup: tuning.workgroup,
            dispatch_tiles: dispatch_tiles(UNIFORM),
        }
    }

    /// For the grid that rays which leave a surface look through, if there are any.
    pub(crate) fn with_grid(self, grid: Option<&Grid>, tuning: &Tuning) -> Self {
        // Without such rays nobody looks for any sphere.
        let Some(grid) = grid else { return Self { secondary: Secondary::Large, sphere_count: 1, ..self } };
        let secondary = match grid.large().len() {
            0 => Secondary::Grid,
            large if large == grid.lists.entries.len() => Secondary::Large,
            _ => Secondary::Both,
        };
        let entries = grid.lists.entries.len() as f64;
        let schedule = match NonZeroU32::new(tuning.paths) {
            // There are trees instead.
            _ if self.refraction.is_some() => Schedule::AtOnce,
            _ if !self.effects.has(Effect::Reflections) || entries < tuning.in_place_below => Schedule::InPlace,
            Some(paths) if secondary != Secondary::Large && entries >= tuning.in_turn_from => Schedule::InTurn(paths),
            _ => Schedule::AtOnce,
        };
        let sphere_count = if secondary == Secondary::Large { grid.large().len() as u32 } else { 0 };
        Self { secondary, sphere_count, schedule, ..self }
    }

    /// Whether each pixel says a number of rays or of tests.
    pub(crate) fn counts(&self) -> bool {
        self.count_rays || self.count_tests
    }

    /// What decides the text of its kernels.
    pub(crate) fn variant(&self) -> Variant {
        let Self { kernel, storage, secondary, refraction, slots, schedule, certified, dispatch_tiles, .. } = *self;
        Variant {
            kernel,
            storage,
            secondary,
            samples: self.keeps_colors(),
            refraction,
            slots,
            schedule,
            certified,
            dispatch_tiles,
        }
    }

    /// Whether the intersection reads second halves of shapes.
    pub(crate) fn reads_shape_ends(&self) -> bool {
        self.effects.has(Effect::Ellipsoids) || self.shared_surfaces
    }

    /// Vectors that keep a path: as `shaders/path_kept.wgsl` has them.
    pub(crate) fn path_vectors(&self) -> u64 {
        4 + u64::from(self.kernel.carries_low() || self.certified)
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
            ("BLINN", f64::from(self.blinn)),
            ("SAMPLES", f64::from(self.samples)),
            ("SIDE", f64::from(self.side)),
            ("PARALLEL", f64::from(self.parallel)),
            ("COUNT_RAYS", f64::from(self.count_rays)),
            ("COUNT_TESTS", f64::from(self.count_tests)),
            ("ONE_RAY", f64::from(self.one_ray)),
            ("TANGENTS", f64::from(self.kernel.tells_tangents())),
            ("CERTIFIED", f64::from(self.certified)),
            ("LINEAR", f64::from(self.linear)),
            ("GROUP", f64::from(self.workgroup)),
        ];
        if self.keeps_paths() {
            constants.push(("VECTORS", self.path_vectors() as f64));
            let paths = match self.schedule {
                Schedule::InTurn(paths) => paths.get(),
                _ => 1,
            };
            constants.push(("PATHS", f64::from(paths)));
        }
        if self.storage != Storage::Ranges {
            if self.secondary == Secondary::Large {
                constants.push(("SPHERE_COUNT", f64::from(self.sphere_count)));
            }
            constants.push(("LIGHT_COUNT", f64::from(self.lights)));
            constants.push(("MATERIAL", material_vectors(self.effects, self.certified) as f64));
            constants.push(("SHAPE_ENDS", f64::from(self.reads_shape_ends())));
        }
        constants
    }

    /// Those that the module of an entry point declares.
    pub fn constants_of(&self, entry_point: &str) -> Vec<(&'static str, f64)> {
        let mut constants = self.constants();
        match entry_point {
            BEGIN_BOUNCE => constants.retain(|(name, _)| ["GROUP", "PATHS"].contains(name)),
            RESOLVE => constants.retain(|(name, _)| ["SAMPLES", "LINEAR"].contains(name)),
            _ => {}
        }
        constants
    }

    /// Bytes that keep a path.
    pub(crate) fn path_size(&self) -> u64 {
        self.path_vectors() * if self.kernel.is_double() { 32 } else { 16 }
    }

    /// Bytes of the colour of a sample.
    pub(crate) fn color_size(&self) -> u64 {
        if self.kernel.is_double() { 32 } else { 16 }
    }

    /// Whether the colours of samples are kept, for another kernel to make pixels of them.
    pub(crate) fn keeps_colors(&self) -> bool {
        self.samples > 1 || self.linear
    }

    /// Whether paths are kept from bounce to bounce.
    pub(crate) fn keeps_paths(&self) -> bool {
        self.variant().keeps_paths()
    }

    /// Whether the loops of an invocation walk more than one bounce of one path.
    pub(crate) fn shares_turns(&self) -> bool {
        self.refraction.is_none() && self.effects.has(Effect::Reflections) && self.schedule != Schedule::AtOnce
    }

    /// The module that renders.
    pub fn module(&self) -> Module {
        Module::render(&self.variant())
    }
}

/// Vectors of a material, as `shaders/scene_tables.wgsl` has it: all three, or all but the way out of object space with the levels of
/// ambient light.
pub(crate) fn material_vectors(effects: EffectSet, certified: bool) -> usize {
    if certified || effects.has(Effect::Ellipsoids) { 3 } else { 2 }
}

//! From effects to compiled kernels: the only place that sets the constants of `shaders/effects.wgsl`.

use std::num::NonZeroU32;

use super::device::Gpu;
use super::error::Error;
use super::pack::material_vectors;
use super::shader::{Kernel, Module, Places, Slots, Storage, Textures, Variant, Walk};
use super::spirv::Parsed;
use super::stage::Access::{Read, ReadWrite, Table, Texels, Uniform};
use super::stage::{Access, Stage};
use crate::accel::Grid;
use crate::effects::{Effect, EffectSet, Effects};
use crate::scene::Scene;
use crate::settings::{Settings, Specular};
use crate::threads::at_once;
use crate::tuning::Tuning;

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
    pub places: Places,
    /// How many there are, where all are outside the grid.
    pub sphere_count: u32,
    /// How paths are walked, where nothing refracts.
    pub walk: Walk,
    /// Side of the grid of samples in a pixel.
    pub samples: u32,
    /// Which pixels a dispatch renders.
    pub slots: Slots,
    /// Whether each pixel also says how many rays it took.
    pub count_rays: bool,
    /// Invocations of a workgroup of the kernels that are not over tiles.
    pub workgroup: u32,
}

impl Specialisation {
    /// For `scene` with `effects` under `settings`, on a device with this tuning that reads these textures.
    pub fn new(
        scene: &Scene,
        settings: &Settings,
        effects: &Effects,
        kernel: Kernel,
        tuning: &Tuning,
        textures: Textures,
    ) -> Self {
        Self {
            kernel,
            effects: effects.set,
            // In steps, so that scenes and depths share kernels.
            refraction: NonZeroU32::new(effects.waiting(scene)).and_then(NonZeroU32::checked_next_power_of_two),
            shared_surfaces: false,
            blinn: settings.specular == Specular::Blinn,
            storage: Storage::Tables(textures),
            lights: scene.lights.len() as u32,
            places: Places::Both,
            sphere_count: 0,
            walk: Walk::InPlace,
            samples: settings.samples_per_side,
            slots: Slots::Tiles,
            count_rays: false,
            workgroup: tuning.workgroup,
        }
    }

    /// For the grid that rays which leave a surface look through, if there are any.
    pub(super) fn with_grid(self, grid: Option<&Grid>, tuning: &Tuning) -> Self {
        // Without such rays nobody looks for any sphere.
        let Some(grid) = grid else { return Self { places: Places::Large, sphere_count: 1, ..self } };
        let places = match grid.large().len() {
            0 => Places::Grid,
            large if large == grid.lists.entries.len() => Places::Large,
            _ => Places::Both,
        };
        let entries = grid.lists.entries.len() as f64;
        let walk = match NonZeroU32::new(tuning.paths) {
            // There are trees instead.
            _ if self.refraction.is_some() => Walk::AtOnce,
            _ if !self.effects.has(Effect::Reflections) || entries < tuning.in_place_below => Walk::InPlace,
            Some(paths) if places != Places::Large && entries >= tuning.in_turn_from => Walk::InTurn(paths),
            _ => Walk::AtOnce,
        };
        let sphere_count = if places == Places::Large { grid.large().len() as u32 } else { 0 };
        Self { places, sphere_count, walk, ..self }
    }

    /// What decides the text of its kernels.
    pub(super) fn variant(&self) -> Variant {
        let Self { kernel, storage, places, refraction, slots, walk, .. } = *self;
        Variant { kernel, storage, places, samples: self.samples > 1, refraction, slots, walk }
    }

    /// Whether the intersection reads second halves of shapes.
    pub(super) fn reads_shape_ends(&self) -> bool {
        self.effects.has(Effect::Ellipsoids) || self.shared_surfaces
    }

    /// Vectors that keep a path: as `shaders/paths.wgsl` has them.
    pub(super) fn path_vectors(&self) -> u64 {
        4 + u64::from(self.kernel.carries_low())
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
            ("COUNT_RAYS", f64::from(self.count_rays)),
            ("TANGENTS", f64::from(self.kernel.tells_tangents())),
            ("GROUP", f64::from(self.workgroup)),
        ];
        if self.keeps_paths() {
            constants.push(("VECTORS", self.path_vectors() as f64));
            if let Walk::InTurn(paths) = self.walk {
                constants.push(("PATHS", f64::from(paths.get())));
            }
        }
        if self.storage != Storage::Ranges {
            if self.places == Places::Large {
                constants.push(("SPHERE_COUNT", f64::from(self.sphere_count)));
            }
            constants.push(("LIGHT_COUNT", f64::from(self.lights)));
            constants.push(("MATERIAL", material_vectors(self.effects) as f64));
            constants.push(("SHAPE_ENDS", f64::from(self.reads_shape_ends())));
        }
        constants
    }

    /// Bytes that keep a path.
    pub(super) fn path_size(&self) -> u64 {
        self.path_vectors() * if self.kernel.is_double() { 32 } else { 16 }
    }

    /// Bytes of the colour of a sample.
    pub(super) fn color_size(&self) -> u64 {
        if self.kernel.is_double() { 32 } else { 16 }
    }

    /// Whether paths are kept from bounce to bounce.
    pub(super) fn keeps_paths(&self) -> bool {
        self.refraction.is_none() && self.walk != Walk::InPlace
    }

    /// Whether the loops of an invocation walk more than one bounce of one path.
    pub(super) fn shares_turns(&self) -> bool {
        self.refraction.is_none() && self.effects.has(Effect::Reflections) && self.walk != Walk::AtOnce
    }

    /// The module that renders.
    pub fn module(&self) -> Module {
        Module::render(&self.variant())
    }
}

/// The entry point that casts the primary rays of tiles.
pub const SEE_TILES: &str = "see_tiles";
/// The entry point that casts the primary rays of a list of pixels.
pub const SEE_SAMPLES: &str = "see_samples";
/// The entry point that casts the reflection rays of paths.
pub const WALK_PATHS: &str = "walk_paths";

/// The entry point that shades what they have met, where several share an invocation.
pub const SHADE_PATHS: &str = "shade_paths";

/// The kernels of a bounce of the paths.
#[derive(Debug)]
pub(super) struct Bounce {
    /// What goes before.
    pub(super) begin: Stage,
    pub(super) walk: Stage,
    /// Where walking leaves shading to another kernel.
    pub(super) shade: Option<Stage>,
}

/// The kernels of a picture.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) see: Stage,
    /// Where paths are kept.
    pub(super) bounce: Option<Bounce>,
    /// From samples to pixels, where there are several a pixel.
    pub(super) resolve: Option<Stage>,
}

/// Compiles the kernels of a picture.
pub(super) fn compile(gpu: &Gpu, specialisation: &Specialisation) -> Result<Stages, Error> {
    let constants = specialisation.constants();
    let parsed = |module: &Module| Parsed::new(module).map_err(Error::Lost);
    let own;
    let module = if let Some(module) = gpu.ahead.as_ref().and_then(|ahead| ahead.module(specialisation)) {
        module
    } else {
        own = parsed(&specialisation.module())?;
        &own
    };
    let Storage::Tables(textures) = specialisation.storage else {
        return Err(Error::Lost("only scenes in tables are rendered".into()));
    };
    let [words, pairs, vectors] = [1, 2, 4].map(|components| Table(textures, components));
    // What every stage reads and writes.
    let mut common = vec![(0, Uniform), (7, ReadWrite), (8, ReadWrite), (13, pairs), (17, pairs)];
    common.extend([1, 2, 3, 14, 20].map(|binding| (binding, vectors)));
    if specialisation.kernel.carries_low() {
        common.extend([9, 10, 21].map(|binding| (binding, vectors)));
    }
    if specialisation.refraction.is_some() {
        common.push((5, Read));
    }
    if specialisation.keeps_paths() {
        common.extend([(12, ReadWrite), (18, Texels(4)), (19, Uniform)]);
    }
    let (see_entry, places) = match specialisation.slots {
        Slots::Tiles => (SEE_TILES, Uniform),
        Slots::List => (SEE_SAMPLES, Read),
    };
    common.push((6, places));
    let primary = [(4, vectors)];
    let kernel = |entry_point, own: &[(u32, Access)]| {
        Stage::new(gpu, module, entry_point, &constants, &[&common[..], own].concat())
    };
    let between = || {
        let module = parsed(&Module::between_stages())?;
        let mut group = vec![("GROUP", f64::from(specialisation.workgroup))];
        group.extend(constants.iter().filter(|(name, _)| *name == "PATHS"));
        Stage::new(gpu, &module, "begin_bounce", &group, &[(12, ReadWrite), (16, ReadWrite)])
    };
    let resolve = || {
        if specialisation.samples == 1 {
            return Ok(None);
        }
        let module = parsed(&Module::resolve(specialisation.kernel))?;
        let constants = [("SAMPLES", f64::from(specialisation.samples))];
        Stage::new(gpu, &module, "resolve", &constants, &[(0, Uniform), (7, Read), (15, ReadWrite)]).map(Some)
    };
    let copies: &[(u32, Access)] =
        if specialisation.variant().copies() { &[(24, vectors), (25, vectors)] } else { &[] };
    // A driver compiles a kernel on the thread that asks for it: side by side. The largest one goes here, since allocating is
    // cheapest on the main thread.
    let see = || kernel(see_entry, &primary);
    if !specialisation.keeps_paths() {
        return Ok(Stages { see: see()?, bounce: None, resolve: resolve()? });
    }
    let bounce = || -> Result<Bounce, Error> {
        if let Walk::InTurn(_) = specialisation.walk {
            let shade = || gpu.guarded(|| kernel(SHADE_PATHS, &[(11, vectors), (22, words)]));
            let walk = || kernel(WALK_PATHS, &[&[(11, vectors), (23, Texels(1))][..], copies].concat());
            let (shade, (walk, begin)) = at_once(shade, || (walk(), between()));
            Ok(Bounce { begin: begin?, walk: walk?, shade: Some(shade?) })
        } else {
            Ok(Bounce { begin: between()?, walk: kernel(WALK_PATHS, &[(11, vectors)])?, shade: None })
        }
    };
    let (see, (bounce, resolve)) = at_once(|| gpu.guarded(see), || (bounce(), resolve()));
    Ok(Stages { see: see?, bounce: Some(bounce?), resolve: resolve? })
}

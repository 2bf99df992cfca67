//! The kernels of a picture, compiled side by side.

use super::compiler::Compiler;
use super::shader::{Module, Slots, Storage, Walk};
use super::specialisation::Specialisation;
use super::spirv::Parsed;
use super::stage::Access::{Kept, Read, ReadWrite, Table, Uniform};
use super::stage::{Access, Stage};
use crate::gpu::device::error::Error;
use crate::threads::at_once;

/// The entry point that casts the primary rays of tiles.
pub const SEE_TILES: &str = "see_tiles";
/// The entry point that casts the primary rays of a list of pixels.
pub const SEE_SAMPLES: &str = "see_samples";
/// The entry point that casts the reflection rays of paths.
pub const WALK_PATHS: &str = "walk_paths";

/// The entry point that shades what they have met, where several share an invocation.
pub const SHADE_PATHS: &str = "shade_paths";
/// The entry point that goes before each bounce of paths.
pub const BEGIN_BOUNCE: &str = "begin_bounce";
/// The entry point that makes pixels of samples.
pub const RESOLVE: &str = "resolve";

/// The kernels of a bounce of the paths.
#[derive(Debug)]
pub(crate) struct Bounce {
    /// What goes before.
    pub(crate) begin: Stage,
    pub(crate) walk: Stage,
    /// Where walking leaves shading to another kernel.
    pub(crate) shade: Option<Stage>,
}

/// The kernels of a picture.
#[derive(Debug)]
pub(crate) struct Stages {
    pub(crate) see: Stage,
    /// Where paths are kept.
    pub(crate) bounce: Option<Bounce>,
    /// From samples to pixels, where there are several a pixel.
    pub(crate) resolve: Option<Stage>,
}

/// Compiles the kernels of a picture, whose module may have been parsed `ahead`.
pub(crate) fn compile(
    compiler: Compiler,
    ahead: Option<&Parsed>,
    specialisation: &Specialisation,
) -> Result<Stages, Error> {
    let constants = specialisation.constants();
    let parsed = |module: &Module| Parsed::new(module).map_err(Error::Shader);
    let own;
    let module = if let Some(module) = ahead {
        module
    } else {
        own = parsed(&specialisation.module())?;
        &own
    };
    let [words, pairs, vectors] = [1, 2, 4].map(|components| match specialisation.storage {
        Storage::Tables(tables) => Table(tables, components),
        Storage::Ranges => Read,
    });
    let [kept_words, kept_vectors] = [1, 4].map(|components| match specialisation.storage {
        Storage::Tables(tables) => Kept(tables, components),
        Storage::Ranges => ReadWrite,
    });
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
        common.extend([(12, ReadWrite), (18, kept_vectors), (19, Uniform)]);
    }
    let (see_entry, places) = match specialisation.slots {
        Slots::Tiles => (SEE_TILES, Uniform),
        Slots::List => (SEE_SAMPLES, Read),
    };
    common.push((6, places));
    let primary = [(4, vectors)];
    let kernel = |entry_point, own: &[(u32, Access)]| {
        Stage::new(compiler, module, entry_point, &constants, &[&common[..], own].concat())
    };
    let between = || {
        let module = parsed(&Module::between_stages())?;
        Stage::new(compiler, &module, BEGIN_BOUNCE, &constants, &[(12, ReadWrite), (16, ReadWrite)])
    };
    let resolve = || {
        if specialisation.samples == 1 {
            return Ok(None);
        }
        let module = parsed(&Module::resolve(specialisation.kernel))?;
        Stage::new(compiler, &module, RESOLVE, &constants, &[(0, Uniform), (7, Read), (15, ReadWrite)]).map(Some)
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
            let shade = || compiler.device.guarded(|| kernel(SHADE_PATHS, &[(11, vectors), (22, words)]));
            let walk = || kernel(WALK_PATHS, &[&[(11, vectors), (23, kept_words)][..], copies].concat());
            let (shade, (walk, begin)) = at_once(shade, || (walk(), between()));
            Ok(Bounce { begin: begin?, walk: walk?, shade: Some(shade?) })
        } else {
            Ok(Bounce { begin: between()?, walk: kernel(WALK_PATHS, &[(11, vectors)])?, shade: None })
        }
    };
    let (see, (bounce, resolve)) = at_once(|| compiler.device.guarded(see), || (bounce(), resolve()));
    Ok(Stages { see: see?, bounce: Some(bounce?), resolve: resolve? })
}

//! The kernels of a picture, compiled side by side.

use super::compiler::Compiler;
use super::shader::{Module, Slots, Walk};
use super::specialisation::Specialisation;
use super::spirv::Parsed;
use super::stage::Stage;
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
pub(super) const BEGIN_BOUNCE: &str = "begin_bounce";
/// The entry point that makes pixels of samples.
pub(super) const RESOLVE: &str = "resolve";

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
    let kernel = |entry_point| Stage::new(compiler, module, entry_point, &constants);
    let other = |entry_point| {
        let module = parsed(&specialisation.module_of(entry_point))?;
        Stage::new(compiler, &module, entry_point, &specialisation.constants_of(entry_point))
    };
    let between = || other(BEGIN_BOUNCE);
    let resolve = || match specialisation.samples {
        1 => Ok(None),
        _ => other(RESOLVE).map(Some),
    };
    // A driver compiles a kernel on the thread that asks for it: side by side. The largest one goes here, since allocating is
    // cheapest on the main thread.
    let see = || match specialisation.slots {
        Slots::Tiles => kernel(SEE_TILES),
        Slots::List => kernel(SEE_SAMPLES),
    };
    if !specialisation.keeps_paths() {
        return Ok(Stages { see: see()?, bounce: None, resolve: resolve()? });
    }
    let bounce = || -> Result<Bounce, Error> {
        if let Walk::InTurn(_) = specialisation.walk {
            let shade = || compiler.device.guarded(|| kernel(SHADE_PATHS));
            let walk = || kernel(WALK_PATHS);
            let (shade, (walk, begin)) = at_once(shade, || (walk(), between()));
            Ok(Bounce { begin: begin?, walk: walk?, shade: Some(shade?) })
        } else {
            Ok(Bounce { begin: between()?, walk: kernel(WALK_PATHS)?, shade: None })
        }
    };
    let (see, (bounce, resolve)) = at_once(|| compiler.device.guarded(see), || (bounce(), resolve()));
    Ok(Stages { see: see?, bounce: Some(bounce?), resolve: resolve? })
}

//! The kernels of a picture, compiled side by side.

use super::compiler::Compiler;
use super::entry::{BEGIN_BOUNCE, RESOLVE, SEE_SAMPLES, SEE_TILES, SHADE_PATHS, WALK_PATHS};
use super::module::Module;
use super::specialisation::Specialisation;
use super::spirv::Parsed;
use super::stage::Stage;
use super::variant::{Slots, Walk};
use crate::gpu::device::error::Error;
use crate::threads::at_once;

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

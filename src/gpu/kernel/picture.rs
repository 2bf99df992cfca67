//! The kernels of a picture, compiled side by side.

use super::compiler::Compiler;
use super::entry::{BEGIN_BOUNCE, RESOLVE, SHADE_PATHS, TRACE_SAMPLES, TRACE_TILES, WALK_PATHS};
use super::module::Module;
use super::pipeline::Pipeline;
use super::specialisation::Specialisation;
use super::spirv::ParsedModule;
use super::variant::{Schedule, Slots};
use crate::gpu::device::error::Error;
use crate::threads::at_once;

/// The kernels of a bounce of the paths.
#[derive(Debug)]
pub(crate) struct Bounce {
    /// What goes before.
    pub(crate) begin: Pipeline,
    pub(crate) walk: Pipeline,
    /// Where walking leaves shading to another kernel.
    pub(crate) shade: Option<Pipeline>,
}

/// The kernels of a picture.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) trace: Pipeline,
    /// Where paths are kept.
    pub(crate) bounce: Option<Bounce>,
    /// From samples to pixels, where their colours are kept.
    pub(crate) resolve: Option<Pipeline>,
}

/// Compiles the kernels of a picture, whose module may have been parsed `ahead`.
pub(crate) fn compile(
    compiler: Compiler,
    ahead: Option<&ParsedModule>,
    specialisation: &Specialisation,
) -> Result<Pipelines, Error> {
    let constants = specialisation.constants();
    let parsed = |module: &Module| ParsedModule::new(module).map_err(Error::Shader);
    let own;
    let module = if let Some(module) = ahead {
        module
    } else {
        own = parsed(&specialisation.module())?;
        &own
    };
    let kernel = |entry_point| Pipeline::new(compiler, module, entry_point, &constants);
    let other = |entry_point| {
        let module = parsed(&specialisation.module_of(entry_point))?;
        Pipeline::new(compiler, &module, entry_point, &specialisation.constants_of(entry_point))
    };
    let between = || other(BEGIN_BOUNCE);
    let resolve = || if specialisation.keeps_colors() { other(RESOLVE).map(Some) } else { Ok(None) };
    // A driver compiles a kernel on the thread that asks for it: side by side. The largest one goes here, since allocating is
    // cheapest on the main thread.
    let trace = || match specialisation.slots {
        Slots::Tiles => kernel(TRACE_TILES),
        Slots::List => kernel(TRACE_SAMPLES),
    };
    if !specialisation.keeps_paths() {
        return Ok(Pipelines { trace: trace()?, bounce: None, resolve: resolve()? });
    }
    let bounce = || -> Result<Bounce, Error> {
        if let Schedule::InTurn(_) = specialisation.schedule {
            let shade = || compiler.device.guarded(|| kernel(SHADE_PATHS));
            let walk = || kernel(WALK_PATHS);
            let (shade, (walk, begin)) = at_once(shade, || (walk(), between()));
            Ok(Bounce { begin: begin?, walk: walk?, shade: Some(shade?) })
        } else {
            Ok(Bounce { begin: between()?, walk: kernel(WALK_PATHS)?, shade: None })
        }
    };
    let (trace, (bounce, resolve)) = at_once(|| compiler.device.guarded(trace), || (bounce(), resolve()));
    Ok(Pipelines { trace: trace?, bounce: Some(bounce?), resolve: resolve? })
}

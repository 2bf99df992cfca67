//! What the device reads of a packed scene, for the test that locks the layout.

use super::compute::Job;
use crate::accel::Acceleration;
use crate::effects::{EffectSet, Effects};
use crate::gpu::device::error::Error;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::variant::Kernel;
use crate::gpu::table::pack::Packed;
use crate::misuse::{Misuse, check_picture};
use crate::viewed::ViewedScene;

/// Values before the spheres, of each sphere, of each light, and after the lights.
const COUNTS: [usize; 4] = [41, 20, 6, 6];

/// Packs `viewed` and lets the device write back every field in the order of `shaders/echo.wgsl`: numbers as the bits of
/// their nearest `f32`.
///
/// # Errors
///
/// [`Misuse::Picture`] where the scene is not one of two spheres with all effects, the only one that the kernel reads.
pub fn echo_layout(gpu: &Gpu, viewed: &ViewedScene, effects: &Effects, kernel: Kernel) -> Result<Vec<u32>, Error> {
    check_picture(viewed)?;
    let scene = viewed.scene();
    if scene.spheres.len() != 2 || effects.set != EffectSet::ALL {
        return Err(Misuse::Picture("only two spheres with all effects are echoed".into()).into());
    }
    let accel = Acceleration::new(viewed, effects.set, kernel.rounding().certified());
    let packed = Packed::new(viewed, effects, kernel, &accel, None, 0.25, true);
    let [head, sphere, light, tail] = COUNTS;
    let job = Job {
        what: "echoing the layout",
        module: &Module::echo(kernel, gpu.tables()),
        entry_point: "echo_layout",
        inputs: &[
            ("given_params", &packed.params.bytes()),
            ("shapes", &packed.shapes[0].bytes()),
            ("shape_ends", &packed.shapes[1].bytes()),
            ("materials", &packed.materials.bytes()),
            ("lights", &packed.lights.bytes()),
            ("window", &packed.window.bytes()),
        ],
        output: "results",
        output_len: head + sphere * scene.spheres.len() + light * scene.lights.len() + tail,
        groups: 1,
    };
    job.run(gpu.compiler())
}

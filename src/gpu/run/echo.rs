//! What the device reads of a packed scene, for the test that locks the layout.

use super::compute::Job;
use crate::accel::Acceleration;
use crate::camera::Camera;
use crate::effects::{EffectSet, Effects};
use crate::gpu::device::error::Error;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::shader::{Kernel, Module};
use crate::gpu::kernel::stage::Access;
use crate::gpu::table::pack::Packed;
use crate::misuse::{Misuse, check_picture};
use crate::scene::Scene;
use crate::settings::Settings;

/// Values before the spheres, of each sphere, of each light, and after the lights.
const COUNTS: [usize; 4] = [31, 19, 6, 6];

/// Packs `scene` and lets the device write back every field in the order of `shaders/echo.wgsl`: numbers as the bits of
/// their nearest `f32`.
///
/// # Errors
///
/// [`Misuse::Picture`] where the scene is not one of two spheres with all effects, the only one that the kernel reads.
pub fn echo_layout(
    gpu: &Gpu,
    scene: &Scene,
    settings: &Settings,
    effects: &Effects,
    kernel: Kernel,
) -> Result<Vec<u32>, Error> {
    check_picture(scene, settings)?;
    if scene.spheres.len() != 2 || effects.set != EffectSet::ALL {
        return Err(Misuse::Picture("only two spheres with all effects are echoed".into()).into());
    }
    let accel = Acceleration::new(scene, &Camera::new(scene, settings), effects.set, kernel.rounding());
    let packed = Packed::new(scene, settings, effects, kernel, &accel, None, 0.25);
    let [head, sphere, light, tail] = COUNTS;
    let table = Access::Table(gpu.tables(), 4);
    let job = Job {
        what: "echoing the layout",
        module: &Module::echo(kernel, gpu.tables()),
        entry_point: "echo_layout",
        inputs: &[
            (0, Access::Uniform, &packed.params.bytes()),
            (1, table, &packed.shapes[0].bytes()),
            (20, table, &packed.shapes[1].bytes()),
            (2, table, &packed.materials.bytes()),
            (3, table, &packed.lights.bytes()),
            (4, table, &packed.window.bytes()),
        ],
        output: 21,
        output_len: head + sphere * scene.spheres.len() + light * scene.lights.len() + tail,
        groups: 1,
    };
    job.run(gpu.compiler())
}

//! One small kernel, run once: bytes in, `u32` values out.

use super::device::Gpu;
use super::error::Error;
use super::pack::Contents;
use super::readable::Readable;
use super::shader::Module;
use super::spirv::Parsed;
use super::stage::{Access, Resource, Stage};
use super::upload::{small_buffer, texels};

/// A kernel with its buffers.
pub(super) struct Job<'a> {
    /// What is done, for messages.
    pub(super) what: &'a str,
    pub(super) module: &'a Module,
    pub(super) entry_point: &'a str,
    /// Binding, use and contents of each input that the kernel reads; tables have four `u32` a texel.
    pub(super) inputs: &'a [(u32, Access, &'a [u8])],
    /// Binding of the output, an `array<u32>`.
    pub(super) output: u32,
    /// Values in the output.
    pub(super) output_len: usize,
    /// Number of workgroups.
    pub(super) groups: u32,
}

impl Job<'_> {
    /// Runs the kernel and returns its output.
    pub(super) fn run(&self, gpu: &Gpu) -> Result<Vec<u32>, Error> {
        gpu.guarded(|| self.run_once(gpu))
    }

    fn run_once(&self, gpu: &Gpu) -> Result<Vec<u32>, Error> {
        let module = Parsed::new(self.module).map_err(Error::Lost)?;
        let inputs = self.inputs.iter().map(|&(binding, access, _)| (binding, access));
        let bindings: Vec<_> = inputs.chain([(self.output, Access::ReadWrite)]).collect();
        let stage = Stage::new(gpu, &module, self.entry_point, &[], &bindings)?;
        let results = gpu.checked(self.what, || {
            let results = Readable::new(gpu, self.output_len as u64);
            let mut resources = vec![(self.output, Resource::Buffer(results.buffer.clone()))];
            for &(binding, access, contents) in self.inputs {
                let buffer = |usage| Resource::Buffer(small_buffer(gpu, contents, usage));
                let resource = match access {
                    Access::Uniform => buffer(wgpu::BufferUsages::UNIFORM),
                    Access::Read | Access::ReadWrite => buffer(wgpu::BufferUsages::STORAGE),
                    Access::Table(..) | Access::Texels(_) => {
                        Resource::Texels(texels(gpu, &Contents::packed(contents), 4)?)
                    }
                };
                resources.push((binding, resource));
            }
            stage.dispatch(gpu, &stage.bind(gpu, &resources), [self.groups, 1]);
            Ok::<_, Error>(results)
        })??;
        results.read(gpu, self.output_len, <[u32]>::to_vec)
    }
}

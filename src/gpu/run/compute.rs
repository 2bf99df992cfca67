//! One small kernel, run once: bytes in, `u32` values out.

use crate::gpu::device::contents::Contents;
use crate::gpu::device::error::Error;
use crate::gpu::device::readable::Readable;
use crate::gpu::device::upload::small_buffer;
use crate::gpu::kernel::compiler::Compiler;
use crate::gpu::kernel::shader::Module;
use crate::gpu::kernel::spirv::Parsed;
use crate::gpu::kernel::stage::{Access, Resource, Stage};
use crate::gpu::table::bind::table;

/// A kernel with its buffers.
pub(super) struct Job<'a> {
    /// What is done, for messages.
    pub(super) what: &'a str,
    pub(super) module: &'a Module,
    pub(super) entry_point: &'a str,
    /// Binding, use and contents of each input that the kernel reads.
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
    pub(super) fn run(&self, compiler: Compiler) -> Result<Vec<u32>, Error> {
        compiler.device.guarded(|| self.run_once(compiler))
    }

    fn run_once(&self, compiler: Compiler) -> Result<Vec<u32>, Error> {
        let module = Parsed::new(self.module).map_err(Error::Shader)?;
        let inputs = self.inputs.iter().map(|&(binding, access, _)| (binding, access));
        let bindings: Vec<_> = inputs.chain([(self.output, Access::ReadWrite)]).collect();
        let stage = Stage::new(compiler, &module, self.entry_point, &[], &bindings)?;
        let device = compiler.device;
        let results = device.checked(self.what, || {
            let results = Readable::new(device, self.output_len as u64);
            let mut resources = vec![(self.output, Resource::Buffer(results.buffer.clone()))];
            for &(binding, access, contents) in self.inputs {
                let buffer = |usage| Resource::Buffer(small_buffer(device, contents, usage));
                let resource = match access {
                    Access::Uniform => buffer(wgpu::BufferUsages::UNIFORM),
                    Access::Read | Access::ReadWrite => buffer(wgpu::BufferUsages::STORAGE),
                    Access::Table(tables, components) | Access::Kept(tables, components) => {
                        table(device, tables, &Contents::packed(contents), components)?
                    }
                };
                resources.push((binding, resource));
            }
            stage.dispatch(device, &stage.bind(device, &resources), [self.groups, 1]);
            Ok::<_, Error>(results)
        })??;
        results.read(device, self.output_len, <[u32]>::to_vec)
    }
}

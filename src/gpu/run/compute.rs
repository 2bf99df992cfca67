//! One small kernel, run once: bytes in, `u32` values out.

use crate::gpu::device::contents::Contents;
use crate::gpu::device::error::Error;
use crate::gpu::device::readable::Readable;
use crate::gpu::device::upload::{small_buffer, texels};
use crate::gpu::kernel::compiler::Compiler;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::pipeline::{Pipeline, Resource};
use crate::gpu::kernel::spirv::ParsedModule;

/// A kernel with its buffers.
pub(super) struct Job<'a> {
    /// What is done, for messages.
    pub(super) what: &'a str,
    pub(super) module: &'a Module,
    pub(super) entry_point: &'a str,
    /// Contents of each variable that the kernel reads; tables have four `u32` a texel.
    pub(super) inputs: &'a [(&'a str, &'a [u8])],
    /// The output, an `array<u32>`.
    pub(super) output: &'a str,
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
        let module = ParsedModule::new(self.module).map_err(Error::Shader)?;
        let pipeline = Pipeline::new(compiler, &module, self.entry_point, &[])?;
        let device = compiler.device;
        let results = device.checked(self.what, || {
            let results = Readable::new(device, self.output_len as u64);
            let mut resources = vec![(self.output, Resource::Buffer(results.buffer.clone()))];
            for binding in &pipeline.bindings {
                // There is one more than the inputs: the output.
                let input = self.inputs.iter().find(|(name, _)| *name == binding.name);
                let Some(&(name, contents)) = input else { continue };
                let buffer = |usage| Ok(Resource::Buffer(small_buffer(device, contents, usage)));
                let texels = |usage| texels(device, &Contents::packed(contents), 4, usage).map(Resource::Texels);
                let resource = match binding.ty {
                    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, .. } => {
                        buffer(wgpu::BufferUsages::UNIFORM)
                    }
                    wgpu::BindingType::Buffer { .. } => buffer(wgpu::BufferUsages::STORAGE),
                    wgpu::BindingType::StorageTexture { .. } => texels(wgpu::TextureUsages::STORAGE_BINDING),
                    _ => texels(wgpu::TextureUsages::TEXTURE_BINDING),
                };
                resources.push((name, resource?));
            }
            pipeline.dispatch(device, &pipeline.bind(device, &resources), [self.groups, 1]);
            Ok::<_, Error>(results)
        })??;
        results.read(device, self.output_len, <[u32]>::to_vec)
    }
}

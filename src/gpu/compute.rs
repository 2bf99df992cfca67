//! One small kernel, run once: bytes in, `u32` values out.

use wgpu::util::DeviceExt;

use super::device::Gpu;
use super::error::Error;
use super::pack::Contents;
use super::pipeline::Resource;
use super::readable::Readable;
use super::shader::Module;
use super::upload::texels;

/// How a kernel reads an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Space {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Storage,
    /// A texture of four `u32` a texel.
    Texels,
}

/// A kernel with its buffers; the module has one entry point.
pub(super) struct Job<'a> {
    /// What is done, for messages.
    pub(super) what: &'a str,
    pub(super) module: &'a Module,
    /// Binding, address space and contents of each input that the kernel reads.
    pub(super) inputs: &'a [(u32, Space, &'a [u8])],
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
        let module = gpu.shader_module(self.module)?;
        let results = gpu.checked(self.what, || {
            let device = &gpu.device;
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(self.what),
                layout: None,
                module: &module,
                entry_point: None,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            let results = Readable::new(gpu, self.output_len as u64);
            let mut resources = vec![(self.output, Resource::Buffer(results.buffer.clone()))];
            for &(binding, space, contents) in self.inputs {
                let buffer = |usage| {
                    let descriptor = wgpu::util::BufferInitDescriptor { label: None, contents, usage };
                    Resource::Buffer(device.create_buffer_init(&descriptor))
                };
                let resource = match space {
                    Space::Uniform => buffer(wgpu::BufferUsages::UNIFORM),
                    Space::Storage => buffer(wgpu::BufferUsages::STORAGE),
                    Space::Texels => Resource::Texels(texels(gpu, &Contents::packed(contents), 4)),
                };
                resources.push((binding, resource));
            }
            let entries: Vec<_> = resources
                .iter()
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.as_binding() })
                .collect();
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &bind_group, &[]);
                pass.dispatch_workgroups(self.groups, 1, 1);
            }
            gpu.queue.submit([encoder.finish()]);
            results
        })?;
        results.read(gpu, self.output_len, <[u32]>::to_vec)
    }
}

//! A compiled kernel: the only place that makes pipelines, for pictures and for everything else.

use super::bindings::Binding;
use super::cache::KernelCache;
use super::compiler::Compiler;
use super::spirv::ParsedModule;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;

/// Tables that a kernel reads and writes at the most, whatever it is specialised for.
pub const MAX_TABLES: u32 = 13;

/// What a binding is bound to.
#[derive(Debug, Clone)]
pub(crate) enum Resource {
    Buffer(wgpu::Buffer),
    Texels(wgpu::TextureView),
}

/// Resources by the names of the variables that they are bound to.
pub(crate) type Resources = Vec<(&'static str, Resource)>;

impl Resource {
    fn as_binding(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Texels(view) => wgpu::BindingResource::TextureView(view),
        }
    }
}

/// A compiled kernel and the bindings that it reads and writes.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) raw: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    pub(crate) bindings: Vec<Binding>,
}

impl Pipeline {
    /// Compiles this entry point of `module` with these constants.
    pub(crate) fn new(
        compiler: Compiler,
        module: &ParsedModule,
        entry_point: &str,
        constants: &[(&str, f64)],
    ) -> Result<Self, Error> {
        let device = compiler.device;
        let (module, bindings) = compiler.module(module, entry_point, constants)?;
        let count = |is: fn(&Binding) -> bool| bindings.iter().filter(|binding| is(binding)).count();
        debug_assert!(count(Binding::is_texture) <= MAX_TABLES as usize);
        let most = device.raw.limits().max_storage_buffers_per_shader_stage;
        let buffers = count(Binding::is_storage_buffer);
        if buffers > most as usize {
            let limit = format!("max_storage_buffers_per_shader_stage is {most}, and it uses {buffers}");
            return Err(Error::too_large(&device.info, entry_point, limit));
        }
        let entry = |binding: &Binding| wgpu::BindGroupLayoutEntry {
            binding: binding.number,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: binding.ty,
            count: None,
        };
        let entries: Vec<_> = bindings.iter().map(entry).collect();
        let _span = tracing::info_span!("compile kernel", kernel = %entry_point).entered();
        device.checked("compiling the kernels", || {
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
            let layout = device.raw.create_bind_group_layout(&descriptor);
            let pipeline_layout = device.raw.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let raw = device.raw.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: compiler.cache.map(KernelCache::handle),
            });
            Self { raw, layout, bindings }
        })
    }

    /// Binds those of `resources` that the kernel uses, by the names of its variables.
    pub(crate) fn bind(&self, device: &Device, resources: &[(&str, Resource)]) -> wgpu::BindGroup {
        let entry = |binding: &Binding| {
            let (_, resource) = resources.iter().find(|(name, _)| *name == binding.name)?;
            Some(wgpu::BindGroupEntry { binding: binding.number, resource: resource.as_binding() })
        };
        let entries: Vec<_> = self.bindings.iter().filter_map(entry).collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries };
        device.raw.create_bind_group(&descriptor)
    }

    /// Runs the kernel with what is bound, in so many workgroups side by side and above each other: a submission of its own.
    pub(crate) fn dispatch(&self, device: &Device, group: &wgpu::BindGroup, [across, down]: [u32; 2]) {
        let mut encoder = device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.raw);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(across, down, 1);
        }
        device.submit(Some(encoder.finish()));
    }
}

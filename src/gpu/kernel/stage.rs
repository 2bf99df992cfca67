//! A compiled kernel: the only place that makes pipelines, for pictures and for everything else.

use super::cache::KernelCache;
use super::compiler::Compiler;
use super::shader::Tables;
use super::spirv::Parsed;
use crate::gpu::device::calls::Call;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::upload::texel_format;

/// Tables that a kernel reads and writes at the most, whatever it is specialised for.
pub(crate) const MAX_TABLES: u32 = 13;
/// Buffers besides.
pub(crate) const MAX_BUFFERS: u32 = 4;

/// How a binding is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    Uniform,
    Read,
    ReadWrite,
    /// A table that is read; as a texture it has so many `u32` a texel.
    Table(Tables, u32),
    /// Likewise, and it is written.
    Kept(Tables, u32),
}

impl Access {
    fn binding_type(self) -> wgpu::BindingType {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let view_dimension = wgpu::TextureViewDimension::D2;
        let storage_texture = |access, components| wgpu::BindingType::StorageTexture {
            access,
            format: texel_format(components),
            view_dimension,
        };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform),
            Self::Read | Self::Table(Tables::Buffers, _) => {
                buffer(wgpu::BufferBindingType::Storage { read_only: true })
            }
            Self::ReadWrite | Self::Kept(Tables::Buffers, _) => {
                buffer(wgpu::BufferBindingType::Storage { read_only: false })
            }
            Self::Table(Tables::Sampled, _) => wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Uint,
                view_dimension,
                multisampled: false,
            },
            Self::Table(Tables::Stored, components) => {
                storage_texture(wgpu::StorageTextureAccess::ReadOnly, components)
            }
            Self::Kept(_, components) => storage_texture(wgpu::StorageTextureAccess::WriteOnly, components),
        }
    }

    fn is_table(self) -> bool {
        matches!(self, Self::Table(..) | Self::Kept(..))
    }

    fn is_storage_buffer(self) -> bool {
        matches!(self.binding_type(), wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { .. }, .. })
    }
}

/// What a binding is bound to.
#[derive(Debug, Clone)]
pub(crate) enum Resource {
    Buffer(wgpu::Buffer),
    Texels(wgpu::TextureView),
}

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
pub(crate) struct Stage {
    pub(crate) pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    bindings: Vec<u32>,
}

impl Stage {
    /// Compiles this entry point of `module` with these constants; `bindings` are all that it uses.
    pub(crate) fn new(
        compiler: Compiler,
        module: &Parsed,
        entry_point: &str,
        constants: &[(&str, f64)],
        bindings: &[(u32, Access)],
    ) -> Result<Self, Error> {
        let device = compiler.device;
        let entry = |&(binding, access): &(u32, Access)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: access.binding_type(),
            count: None,
        };
        debug_assert!(bindings.iter().filter(|(_, access)| access.is_table()).count() <= MAX_TABLES as usize);
        let most = device.raw.limits().max_storage_buffers_per_shader_stage;
        let buffers = bindings.iter().filter(|(_, access)| access.is_storage_buffer()).count();
        if buffers > most as usize {
            let limit = format!("max_storage_buffers_per_shader_stage is {most}, and it uses {buffers}");
            return Err(Error::too_large(&device.info, entry_point, limit));
        }
        let entries: Vec<_> = bindings.iter().map(entry).collect();
        let mut bindings: Vec<_> = bindings.iter().map(|(binding, _)| *binding).collect();
        bindings.sort_unstable();
        let module = compiler.module(module, entry_point, constants, &bindings)?;
        device.checked("compiling the kernels", || {
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
            let layout = device.raw.create_bind_group_layout(&descriptor);
            let pipeline_layout = device.raw.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let _call = Call::begin();
            let pipeline = device.raw.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: compiler.cache.map(KernelCache::handle),
            });
            Self { pipeline, layout, bindings }
        })
    }

    /// Binds those of `resources` that the kernel uses.
    pub(crate) fn bind(&self, device: &Device, resources: &[(u32, Resource)]) -> wgpu::BindGroup {
        let used = resources.iter().filter(|(binding, _)| self.bindings.contains(binding));
        let entries: Vec<_> = used
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.as_binding() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries };
        device.raw.create_bind_group(&descriptor)
    }

    /// Runs the kernel with what is bound, in so many workgroups side by side and above each other: a submission of its own.
    pub(crate) fn dispatch(&self, device: &Device, group: &wgpu::BindGroup, [across, down]: [u32; 2]) {
        let mut encoder = device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(across, down, 1);
        }
        device.submit(Some(encoder.finish()));
    }
}

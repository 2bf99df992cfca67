//! What a kernel reads and writes, as its module says: the host knows it by name.

use crate::gpu::device::upload::texel_format;

/// A variable of a kernel that something is bound to.
#[derive(Debug)]
pub(crate) struct Binding {
    pub(crate) name: String,
    pub(super) number: u32,
    pub(crate) ty: wgpu::BindingType,
}

impl Binding {
    /// Those of a module, in the order of their numbers.
    pub(super) fn all(module: &naga::Module) -> Result<Vec<Self>, String> {
        let bound = module.global_variables.iter().filter_map(|(_, variable)| Some((variable, variable.binding?)));
        let binding = |(variable, at): (&naga::GlobalVariable, naga::ResourceBinding)| {
            let name = variable.name.clone().unwrap_or_default();
            let ty = binding_type(variable.space, &module.types[variable.ty].inner);
            let ty = ty.ok_or_else(|| format!("nothing is bound to a variable such as {name}"))?;
            Ok(Self { name, number: at.binding, ty })
        };
        let mut all = bound.map(binding).collect::<Result<Vec<_>, String>>()?;
        all.sort_by_key(|binding| binding.number);
        Ok(all)
    }

    pub(super) fn is_storage_buffer(&self) -> bool {
        matches!(self.ty, wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { .. }, .. })
    }

    pub(super) fn is_texture(&self) -> bool {
        matches!(self.ty, wgpu::BindingType::Texture { .. } | wgpu::BindingType::StorageTexture { .. })
    }
}

fn binding_type(space: naga::AddressSpace, ty: &naga::TypeInner) -> Option<wgpu::BindingType> {
    let buffer = |ty| Some(wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None });
    let view_dimension = wgpu::TextureViewDimension::D2;
    match (space, ty) {
        (naga::AddressSpace::Uniform, _) => buffer(wgpu::BufferBindingType::Uniform),
        (naga::AddressSpace::Storage { access }, _) => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !access.contains(naga::StorageAccess::STORE) })
        }
        (_, naga::TypeInner::Image { class: naga::ImageClass::Sampled { .. }, .. }) => {
            Some(wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Uint,
                view_dimension,
                multisampled: false,
            })
        }
        (_, naga::TypeInner::Image { class: naga::ImageClass::Storage { format, access }, .. }) => {
            let access = if access.contains(naga::StorageAccess::STORE) {
                wgpu::StorageTextureAccess::WriteOnly
            } else {
                wgpu::StorageTextureAccess::ReadOnly
            };
            let components = match format {
                naga::StorageFormat::R32Uint => 1,
                naga::StorageFormat::Rg32Uint => 2,
                naga::StorageFormat::Rgba32Uint => 4,
                _ => return None,
            };
            Some(wgpu::BindingType::StorageTexture { access, format: texel_format(components), view_dimension })
        }
        _ => None,
    }
}

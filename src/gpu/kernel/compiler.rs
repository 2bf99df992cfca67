//! What compiles kernels for a device.

use std::borrow::Cow;

use super::bindings::Binding;
use super::cache::KernelCache;
use super::correct::corrected;
use super::inexact::made_inexact;
use super::spirv::ParsedModule;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;

/// A device, with the kernels of earlier runs where it has them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Compiler<'a> {
    pub(crate) device: &'a Device,
    pub(super) cache: Option<&'a KernelCache>,
}

impl Compiler<'_> {
    /// The module of one kernel, and what it reads and writes.
    pub(super) fn module(
        self,
        module: &ParsedModule,
        entry_point: &str,
        constants: &[(&str, f64)],
    ) -> Result<(wgpu::ShaderModule, Vec<Binding>), Error> {
        let _span = tracing::info_span!("translate kernel", kernel = %entry_point).entered();
        let (bindings, mut words) = if let Some(ahead) = module.translation(entry_point, constants)
            && self.device.takes_spirv
        {
            (Binding::all(&ahead.module).map_err(Error::Shader)?, ahead.words.clone())
        } else {
            let specialised = module.specialised(entry_point, constants).map_err(Error::Shader)?;
            let bindings = Binding::all(&specialised).map_err(Error::Shader)?;
            if !self.device.takes_spirv {
                return Ok((self.translated(specialised)?, bindings));
            }
            (bindings, module.spirv(&specialised, entry_point).map_err(Error::Shader)?)
        };
        if self.device.inexact.is_any() {
            words = corrected(words, |bits| self.device.inexact.has(bits)).map_err(Error::Shader)?;
        }
        if self.device.units_off > 0 {
            words = made_inexact(words, self.device.units_off).map_err(Error::Shader)?;
        }
        let module = self.device.checked("reading the shader", || {
            #[allow(
                unsafe_code,
                reason = "naga has validated the module; in its SPIR-V, which has some decorations more, functions stand in the \
                          place of their calls and products and sums in that of dot and cross products: tests hold that it is \
                          well formed. It checks no index, for the reasons that ParsedModule::spirv gives"
            )]
            unsafe {
                self.device.raw.create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
                    entry_points: Cow::Owned(vec![wgpu::PassthroughShaderEntryPoint {
                        name: entry_point.into(),
                        // Read for Metal alone.
                        workgroup_size: (1, 1, 1),
                    }]),
                    spirv: Some(words.into()),
                    ..Default::default()
                })
            }
        })?;
        Ok((module, bindings))
    }

    /// The module as wgpu translates it, which leaves to the driver what it fuses.
    fn translated(self, module: naga::Module) -> Result<wgpu::ShaderModule, Error> {
        let source = wgpu::ShaderSource::Naga(Cow::Owned(module));
        let descriptor = wgpu::ShaderModuleDescriptor { label: None, source };
        self.device.checked("reading the shader", || self.device.raw.create_shader_module(descriptor))
    }
}

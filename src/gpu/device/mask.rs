//! A device that is taken to offer less than it does, or to calculate worse, to see what the program makes of it.

/// What is masked; the default is nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Mask {
    /// No `f64` in shaders.
    pub no_f64: bool,
    /// No 64-bit integers in shaders.
    pub no_int64: bool,
    /// It takes no SPIR-V, only modules that wgpu translates.
    pub no_spirv: bool,
    /// No buffer that both host and device see.
    pub no_shared_memory: bool,
    /// Storage buffers of a kernel at the most.
    pub storage_buffers: Option<u32>,
    /// Storage textures of a kernel at the most.
    pub storage_textures: Option<u32>,
    /// Sampled textures of a kernel at the most.
    pub sampled_textures: Option<u32>,
    /// Bytes of a uniform at the most.
    pub uniform_bytes: Option<u64>,
    /// Invocations of a workgroup at the most.
    pub invocations: Option<u32>,
    /// So many units in the last place its quotients and square roots are too small, where it takes SPIR-V.
    pub units_off: u32,
}

/// What an adapter offers.
#[derive(Debug, Clone)]
pub(super) struct Offer {
    pub(super) features: wgpu::Features,
    pub(super) limits: wgpu::Limits,
}

impl Offer {
    pub(super) fn of(adapter: &wgpu::Adapter) -> Self {
        Self { features: adapter.features(), limits: adapter.limits() }
    }

    pub(super) fn masked(mut self, mask: &Mask) -> Self {
        let features = [
            (mask.no_f64, wgpu::Features::SHADER_F64),
            (mask.no_int64, wgpu::Features::SHADER_INT64),
            (mask.no_spirv, wgpu::Features::PASSTHROUGH_SHADERS),
            (mask.no_shared_memory, wgpu::Features::MAPPABLE_PRIMARY_BUFFERS),
        ];
        features.into_iter().filter(|(masked, _)| *masked).for_each(|(_, feature)| self.features.remove(feature));
        let limits = &mut self.limits;
        for (masked, limit) in [
            (mask.storage_buffers, &mut limits.max_storage_buffers_per_shader_stage),
            (mask.storage_textures, &mut limits.max_storage_textures_per_shader_stage),
            (mask.sampled_textures, &mut limits.max_sampled_textures_per_shader_stage),
            (mask.invocations, &mut limits.max_compute_invocations_per_workgroup),
            (mask.invocations, &mut limits.max_compute_workgroup_size_x),
        ] {
            *limit = masked.map_or(*limit, |most| most.min(*limit));
        }
        let uniform = &mut limits.max_uniform_buffer_binding_size;
        *uniform = mask.uniform_bytes.map_or(*uniform, |most| most.min(*uniform));
        self
    }
}

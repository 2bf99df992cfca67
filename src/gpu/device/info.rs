//! What is known of a device before it is opened.

use std::fmt;

use serde::Serialize;

use crate::tuning::Tuning;

/// One Vulkan device as a user sees it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DeviceInfo {
    /// Place in the list; stable as long as drivers and hardware are.
    pub index: usize,
    /// The device's name.
    pub name: String,
    /// Discrete, integrated, virtual or software.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// The driver with its version.
    pub driver: String,
    /// PCI id such as `0000:01:00.0`; empty for devices without one.
    pub pci: String,
    /// Whether shaders can calculate in `f64`, and read it from textures as pairs of integers.
    pub f64: bool,
    /// Greatest size of one storage buffer binding, in bytes.
    pub max_storage_binding: u64,
    /// Greatest size of one buffer, in bytes.
    pub max_buffer: u64,
    /// Greatest number of workgroups of a dispatch in one direction.
    pub max_workgroups: u32,
    /// Greatest number of invocations of a workgroup.
    pub max_invocations: u32,
    /// Greatest number of storage textures that a kernel reads and writes.
    pub max_storage_textures: u32,
}

impl DeviceInfo {
    pub(super) fn new(index: usize, adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        Self {
            index,
            name: info.name,
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete",
                wgpu::DeviceType::IntegratedGpu => "integrated",
                wgpu::DeviceType::VirtualGpu => "virtual",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            pci: info.device_pci_bus_id,
            f64: adapter.features().contains(wgpu::Features::SHADER_F64 | wgpu::Features::SHADER_INT64),
            max_storage_binding: limits.max_storage_buffer_binding_size,
            max_buffer: limits.max_buffer_size,
            max_workgroups: limits.max_compute_workgroups_per_dimension,
            max_invocations: limits.max_compute_invocations_per_workgroup,
            max_storage_textures: limits.max_storage_textures_per_shader_stage,
        }
    }

    /// Why the device cannot do with `tuning`; `None` where it can.
    pub fn problem_with(&self, tuning: &Tuning) -> Option<String> {
        let too_large = || {
            let (wanted, most) = (tuning.workgroup, self.max_invocations);
            (wanted > most).then(|| format!("workgroup is {wanted}, and the device has at most {most}"))
        };
        tuning.problem().or_else(too_large)
    }

    pub(super) fn matches(&self, text: &str) -> bool {
        let text = text.to_lowercase();
        self.pci.to_lowercase() == text || [&self.name, &self.driver].iter().any(|s| s.to_lowercase().contains(&text))
    }

    /// Better devices first: real before virtual before software; the power preference swaps the first two.
    pub(super) fn rank(&self, low_power: bool) -> u8 {
        match (self.kind, low_power) {
            ("discrete", false) | ("integrated", true) => 0,
            ("integrated", false) | ("discrete", true) => 1,
            ("virtual", _) => 2,
            ("software", _) => 4,
            _ => 3,
        }
    }
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.kind, self.driver)
    }
}

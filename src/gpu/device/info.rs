//! What is known of a device before it is opened.

use super::mask::Offer;
use super::vulkan::VulkanInfo;
use std::fmt;

use serde::Serialize;

use crate::tuning::{Class, Tuning};

/// What sort of device it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU as a virtual machine shows it.
    Virtual,
    /// A driver that calculates on the CPU, such as lavapipe.
    Software,
    /// One that says nothing of itself.
    Other,
}

impl DeviceKind {
    fn of(kind: wgpu::DeviceType) -> Self {
        match kind {
            wgpu::DeviceType::DiscreteGpu => Self::Discrete,
            wgpu::DeviceType::IntegratedGpu => Self::Integrated,
            wgpu::DeviceType::VirtualGpu => Self::Virtual,
            wgpu::DeviceType::Cpu => Self::Software,
            wgpu::DeviceType::Other => Self::Other,
        }
    }

    /// The class whose numbers it wants. What says nothing of itself is taken for the slower kind of hardware.
    pub fn class(self) -> Class {
        match self {
            Self::Software => Class::Software,
            Self::Discrete | Self::Virtual => Class::Discrete,
            Self::Integrated | Self::Other => Class::Integrated,
        }
    }
}

impl fmt::Display for DeviceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Virtual => "virtual",
            Self::Software => "software",
            Self::Other => "other",
        })
    }
}

/// One Vulkan device as a user sees it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DeviceInfo {
    /// Place in the list; stable as long as drivers and hardware are.
    pub index: usize,
    /// The device's name.
    pub name: String,
    /// What sort of device it is.
    #[serde(rename = "type")]
    pub kind: DeviceKind,
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
    /// Greatest size of one uniform binding, in bytes.
    pub max_uniform: u64,
    /// Greatest number of storage buffers that a kernel reads and writes.
    pub max_storage_buffers: u32,
    /// Greatest number of storage textures that a kernel reads and writes.
    pub max_storage_textures: u32,
    /// What Vulkan says of it.
    pub vulkan: VulkanInfo,
}

impl DeviceInfo {
    pub(super) fn new(
        index: usize,
        info: wgpu::AdapterInfo,
        vulkan: VulkanInfo,
        Offer { features, limits }: &Offer,
    ) -> Self {
        Self {
            index,
            name: info.name,
            kind: DeviceKind::of(info.device_type),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            pci: info.device_pci_bus_id,
            f64: features.contains(wgpu::Features::SHADER_F64 | wgpu::Features::SHADER_INT64),
            max_storage_binding: limits.max_storage_buffer_binding_size,
            max_buffer: limits.max_buffer_size,
            max_workgroups: limits.max_compute_workgroups_per_dimension,
            max_invocations: limits.max_compute_invocations_per_workgroup,
            max_uniform: limits.max_uniform_buffer_binding_size,
            max_storage_buffers: limits.max_storage_buffers_per_shader_stage,
            max_storage_textures: limits.max_storage_textures_per_shader_stage,
            vulkan,
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
            (DeviceKind::Discrete, false) | (DeviceKind::Integrated, true) => 0,
            (DeviceKind::Integrated, false) | (DeviceKind::Discrete, true) => 1,
            (DeviceKind::Virtual, _) => 2,
            (DeviceKind::Other, _) => 3,
            (DeviceKind::Software, _) => 4,
        }
    }
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.kind, self.driver)
    }
}

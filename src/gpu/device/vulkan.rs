//! What Vulkan says of a device and its driver: what a report of a fault has to tell.

use std::ffi::CStr;
use std::fmt;

use ash::vk;
use serde::Serialize;

/// A device in Vulkan's own words and numbers.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct VulkanInfo {
    /// The version of Vulkan that the device has, as `1.3.0`.
    pub api_version: String,
    /// The driver's version, a number that each vendor packs in a way of its own.
    pub driver_version: u32,
    /// PCI id of the vendor, or Khronos's, as `0x10005`.
    pub vendor_id: String,
    /// The vendor's number for the device, as `0x2330`.
    pub device_id: String,
    /// What the driver says of itself; absent before Vulkan 1.2, as are the next three.
    pub driver: Option<Driver>,
    /// What the device and its driver are told by across processes.
    pub ids: Option<Ids>,
    /// What shaders may demand of rounding.
    pub float_controls: Option<FloatControls>,
    /// Invocations that run in step.
    pub subgroup_size: Option<u32>,
    /// Limits that compute shaders meet.
    pub limits: Limits,
    /// Sizes of the memory heaps, in bytes.
    pub memory_heaps: Vec<u64>,
    /// Scalars beyond 32-bit ones that shaders calculate with.
    pub scalars: Vec<&'static str>,
}

/// `VkPhysicalDeviceDriverProperties`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Driver {
    /// Its name among `VkDriverId`, such as `MESA_LLVMPIPE`; a number where it is newer than this program.
    pub id: String,
    /// Its number there.
    pub id_number: i32,
    /// Its name.
    pub name: String,
    /// What else it says, mostly its version.
    pub info: String,
    /// The version of the conformance tests that it has passed; `0.0.0.0` where it claims none.
    pub conformance_version: String,
}

/// `VkPhysicalDeviceIDProperties`, in hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Ids {
    /// Of the device.
    pub device_uuid: String,
    /// Of the driver.
    pub driver_uuid: String,
    /// Of the device on Windows.
    pub device_luid: Option<String>,
}

/// `VkPhysicalDeviceFloatControlsProperties`: for each demand the widths in bits, 16, 32 and 64, that it can be made of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FloatControls {
    /// Of which widths denormals can be chosen apart.
    pub denorm_behavior_independence: String,
    /// Of which widths rounding can be chosen apart.
    pub rounding_mode_independence: String,
    /// Signed zeros, infinities and NaN stay.
    pub signed_zero_inf_nan_preserve: Vec<u8>,
    /// Denormals stay.
    pub denorm_preserve: Vec<u8>,
    /// Denormals become zero.
    pub denorm_flush_to_zero: Vec<u8>,
    /// Rounding to the nearest.
    pub rounding_mode_rte: Vec<u8>,
    /// Rounding towards zero.
    pub rounding_mode_rtz: Vec<u8>,
}

/// Those of `VkPhysicalDeviceLimits` that compute shaders meet, under its names.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Limits {
    /// Bytes that a workgroup shares.
    pub max_compute_shared_memory_size: u32,
    /// Workgroups of a dispatch.
    pub max_compute_work_group_count: [u32; 3],
    /// Invocations of a workgroup.
    pub max_compute_work_group_invocations: u32,
    /// Likewise in each direction.
    pub max_compute_work_group_size: [u32; 3],
    /// Bytes of a storage buffer.
    pub max_storage_buffer_range: u32,
    /// Bytes of a uniform buffer.
    pub max_uniform_buffer_range: u32,
    /// Bytes of push constants.
    pub max_push_constants_size: u32,
    /// Width and height of an image.
    pub max_image_dimension_2d: u32,
    /// Storage buffers of a shader.
    pub max_per_stage_descriptor_storage_buffers: u32,
    /// Storage images of a shader.
    pub max_per_stage_descriptor_storage_images: u32,
    /// Sampled images of a shader.
    pub max_per_stage_descriptor_sampled_images: u32,
    /// Allocations of memory that there may be at once.
    pub max_memory_allocation_count: u32,
    /// Whether all queues take timestamps.
    pub timestamp_compute_and_graphics: bool,
}

impl VulkanInfo {
    /// Of a device that wgpu has found; nothing where it is none of Vulkan's.
    #[allow(unsafe_code, reason = "the adapter outlives what is asked of it, and nothing of it is destroyed")]
    pub(super) fn of(adapter: &wgpu::Adapter) -> Self {
        let Some(adapter) = (unsafe { adapter.as_hal::<wgpu::hal::api::Vulkan>() }) else { return Self::default() };
        let shared = adapter.shared_instance();
        Self::ask(shared.raw_instance(), shared.instance_api_version(), adapter.raw_physical_device())
    }

    #[allow(
        unsafe_code,
        reason = "a device of this instance is asked for its properties, where both have the function"
    )]
    fn ask(instance: &ash::Instance, version: u32, device: vk::PhysicalDevice) -> Self {
        let basic = unsafe { instance.get_physical_device_properties(device) };
        let memory = unsafe { instance.get_physical_device_memory_properties(device) };
        let features = unsafe { instance.get_physical_device_features(device) };
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut ids = vk::PhysicalDeviceIDProperties::default();
        let mut floats = vk::PhysicalDeviceFloatControlsProperties::default();
        let mut subgroups = vk::PhysicalDeviceSubgroupProperties::default();
        let tells = version.min(basic.api_version) >= vk::API_VERSION_1_2;
        if tells {
            let mut all = vk::PhysicalDeviceProperties2::default()
                .push_next(&mut driver)
                .push_next(&mut ids)
                .push_next(&mut floats)
                .push_next(&mut subgroups);
            unsafe { instance.get_physical_device_properties2(device, &mut all) };
        }
        let scalars =
            [(features.shader_float64, "f64"), (features.shader_int64, "i64"), (features.shader_int16, "i16")];
        Self {
            api_version: version_of(basic.api_version),
            driver_version: basic.driver_version,
            vendor_id: format!("{:#06x}", basic.vendor_id),
            device_id: format!("{:#06x}", basic.device_id),
            driver: tells.then(|| Driver::new(&driver)),
            ids: tells.then(|| Ids::new(&ids)),
            float_controls: tells.then(|| FloatControls::new(&floats)),
            subgroup_size: tells.then_some(subgroups.subgroup_size),
            limits: Limits::new(&basic.limits),
            memory_heaps: memory.memory_heaps_as_slice().iter().map(|heap| heap.size).collect(),
            scalars: scalars.iter().filter(|(has, _)| *has == vk::TRUE).map(|(_, name)| *name).collect(),
        }
    }
}

impl fmt::Display for VulkanInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { api_version, vendor_id, device_id, driver, .. } = self;
        write!(f, "{api_version}, ")?;
        if let Some(Driver { id, conformance_version, .. }) = driver {
            write!(f, "conformance {conformance_version}, driver {id}, ")?;
        }
        write!(f, "vendor {vendor_id}, device {device_id}")
    }
}

fn version_of(version: u32) -> String {
    let [major, minor, patch] =
        [vk::api_version_major, vk::api_version_minor, vk::api_version_patch].map(|of| of(version));
    format!("{major}.{minor}.{patch}")
}

/// Text from the driver; what it has not ended is not read.
fn text(bytes: Result<&CStr, impl Sized>) -> String {
    bytes.map_or_else(|_| "?".to_owned(), |text| text.to_string_lossy().trim().to_owned())
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Driver {
    fn new(driver: &vk::PhysicalDeviceDriverProperties) -> Self {
        let vk::ConformanceVersion { major, minor, subminor, patch } = driver.conformance_version;
        Self {
            id: format!("{:?}", driver.driver_id),
            id_number: driver.driver_id.as_raw(),
            name: text(driver.driver_name_as_c_str()),
            info: text(driver.driver_info_as_c_str()),
            conformance_version: format!("{major}.{minor}.{subminor}.{patch}"),
        }
    }
}

impl Ids {
    fn new(ids: &vk::PhysicalDeviceIDProperties) -> Self {
        Self {
            device_uuid: hexadecimal(&ids.device_uuid),
            driver_uuid: hexadecimal(&ids.driver_uuid),
            device_luid: (ids.device_luid_valid == vk::TRUE).then(|| hexadecimal(&ids.device_luid)),
        }
    }
}

impl FloatControls {
    fn new(floats: &vk::PhysicalDeviceFloatControlsProperties) -> Self {
        let widths = |has: [vk::Bool32; 3]| {
            [16, 32, 64].into_iter().zip(has).filter(|(_, has)| *has == vk::TRUE).map(|(width, _)| width).collect()
        };
        let independence = |which| match which {
            vk::ShaderFloatControlsIndependence::TYPE_32_ONLY => "32-bit only".to_owned(),
            vk::ShaderFloatControlsIndependence::ALL => "all".to_owned(),
            vk::ShaderFloatControlsIndependence::NONE => "none".to_owned(),
            other => other.as_raw().to_string(),
        };
        Self {
            denorm_behavior_independence: independence(floats.denorm_behavior_independence),
            rounding_mode_independence: independence(floats.rounding_mode_independence),
            signed_zero_inf_nan_preserve: widths([
                floats.shader_signed_zero_inf_nan_preserve_float16,
                floats.shader_signed_zero_inf_nan_preserve_float32,
                floats.shader_signed_zero_inf_nan_preserve_float64,
            ]),
            denorm_preserve: widths([
                floats.shader_denorm_preserve_float16,
                floats.shader_denorm_preserve_float32,
                floats.shader_denorm_preserve_float64,
            ]),
            denorm_flush_to_zero: widths([
                floats.shader_denorm_flush_to_zero_float16,
                floats.shader_denorm_flush_to_zero_float32,
                floats.shader_denorm_flush_to_zero_float64,
            ]),
            rounding_mode_rte: widths([
                floats.shader_rounding_mode_rte_float16,
                floats.shader_rounding_mode_rte_float32,
                floats.shader_rounding_mode_rte_float64,
            ]),
            rounding_mode_rtz: widths([
                floats.shader_rounding_mode_rtz_float16,
                floats.shader_rounding_mode_rtz_float32,
                floats.shader_rounding_mode_rtz_float64,
            ]),
        }
    }
}

impl Limits {
    fn new(limits: &vk::PhysicalDeviceLimits) -> Self {
        Self {
            max_compute_shared_memory_size: limits.max_compute_shared_memory_size,
            max_compute_work_group_count: limits.max_compute_work_group_count,
            max_compute_work_group_invocations: limits.max_compute_work_group_invocations,
            max_compute_work_group_size: limits.max_compute_work_group_size,
            max_storage_buffer_range: limits.max_storage_buffer_range,
            max_uniform_buffer_range: limits.max_uniform_buffer_range,
            max_push_constants_size: limits.max_push_constants_size,
            max_image_dimension_2d: limits.max_image_dimension2_d,
            max_per_stage_descriptor_storage_buffers: limits.max_per_stage_descriptor_storage_buffers,
            max_per_stage_descriptor_storage_images: limits.max_per_stage_descriptor_storage_images,
            max_per_stage_descriptor_sampled_images: limits.max_per_stage_descriptor_sampled_images,
            max_memory_allocation_count: limits.max_memory_allocation_count,
            timestamp_compute_and_graphics: limits.timestamp_compute_and_graphics == vk::TRUE,
        }
    }
}

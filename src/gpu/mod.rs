//! The GPU path: a WGSL compute shader on any Vulkan device.
//!
//! Floors, each of which knows those before it alone: `device` knows no kernel, `kernel` none of the tables that it reads, `table`
//! no renderer; [`Gpu`] holds a device with its kernels, and on it stand `render` and `run`.

mod device;
mod facade;
mod kernel;
mod render;
mod run;
mod shared;
mod table;
mod tuned;

pub use device::choose::{Choice, list};
pub use device::diagnosis::{Hidden, hidden};
pub use device::error::Error;
pub use device::info::{DeviceInfo, DeviceKind};
pub use device::mask::Mask;
pub use device::open::Device;
pub use device::vulkan::VulkanInfo;
pub use device::{calls, drivers};
pub use facade::{Gpu, USUAL_KERNELS};
pub use kernel::ahead::Ahead;
pub use kernel::cache as kernel_cache;
pub use kernel::entry::{SHADE_PATHS, TRACE_SAMPLES, TRACE_TILES, WALK_PATHS};
pub use kernel::module::Module;
pub use kernel::pipeline::MAX_TABLES;
pub use kernel::specialisation::Specialisation;
pub use kernel::spirv::ParsedModule;
pub use kernel::variant::{Kernel, Schedule, Secondary, Slots, Storage, Tables, Variant};
pub use render::{DeviceTimes, GpuRenderer, Options, Output, Pixels, Rendered, Rows, Term};
pub use run::echo::echo_layout;
pub use run::fill::Reconstructor;
pub use run::probe::{Answer, Batch, Point, ProbeRay, Prober, Question, RawBatch, Surface};
pub use run::quotients::Quotients;
pub use run::selftest::SelfTest;
pub use shared::LEAST_BUFFERS;
pub use table::layout;
pub use tuned::DeviceTuning;

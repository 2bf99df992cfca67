//! The GPU path: a WGSL compute shader on any Vulkan device.

mod device;
mod error;
pub mod layout;
mod pack;
mod pipeline;
mod probe;
mod readable;
mod render;
mod shader;

pub use device::{Choice, DeviceInfo, Gpu, list};
pub use error::Error;
pub use pipeline::{ENTRY_POINT, Specialisation};
pub use probe::{Answer, Batch, ProbeRay, Prober, Question, RawBatch, Surface};
pub use render::{DeviceTimes, GpuRenderer};
pub use shader::{Kernel, Module};

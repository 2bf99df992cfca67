//! The GPU path: a WGSL compute shader on any Vulkan device.

mod ahead;
mod compute;
mod device;
pub mod drivers;
mod echo;
mod error;
mod inline;
pub mod kernel_cache;
pub mod layout;
mod pack;
mod pipeline;
mod probe;
mod products;
mod readable;
mod reconstruct;
mod render;
mod selftest;
mod shader;
mod spirv;
mod stage;
mod tables;
mod timestamps;
mod tuned;
mod upload;

pub use ahead::Ahead;
pub use device::{Choice, DeviceInfo, Gpu, list};
pub use echo::echo_layout;
pub use error::Error;
pub use pipeline::{SEE_SAMPLES, SEE_TILES, SHADE_PATHS, Specialisation, WALK_PATHS};
pub use probe::{Answer, Batch, Point, ProbeRay, Prober, Question, RawBatch, Surface};
pub use reconstruct::Reconstructor;
pub use render::{DeviceTimes, GpuRenderer, Options, Output, Pixels, Rendered, Rows};
pub use selftest::SelfTest;
pub use shader::{Kernel, Module, Places, Slots, Storage, Textures, Variant, Walk};
pub use spirv::Parsed;
pub use tuned::DeviceTuning;

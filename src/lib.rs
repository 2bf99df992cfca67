//! Ray tracer for scenes of spheres and ellipsoids: a WGSL compute shader on any Vulkan device, checked against a CPU
//! reference.
//!
//! The data walk: scene text → [`scene::Scene`] → [`effects::Effects`] → lists of spheres ([`accel`]) → packed tables →
//! composed WGSL and constants → SPIR-V of each kernel → stages of dispatches → rows of pixels → file. `cpu` and `gpu` never
//! see each other; both read [`scene`], [`effects`], [`camera`], [`geometry`], [`accel`] and [`sampling`].

pub mod accel;
mod atomic;
pub mod bench;
pub mod brightness;
mod cache;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod cpu;
pub mod doubts;
pub mod effects;
pub mod engine;
pub mod exact;
pub mod export;
pub mod film;
pub mod geometry;
pub mod gpu;
mod hash;
pub mod limits;
pub mod misuse;
mod panics;
pub mod precision;
mod random;
mod report;
pub mod sampling;
pub mod scene;
pub mod settings;
pub mod stress;
pub mod study;
mod threads;
pub mod tiles;
pub mod tuning;
pub mod verify;
pub mod view;
#[cfg(feature = "view")]
pub mod viewer;
mod words;

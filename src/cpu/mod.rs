//! The CPU reference: the specification in `f64`, written to be read beside the shaders.

mod dd;
mod fill;
mod intersect;
mod margin;
pub mod oracle;
mod real;
mod refract;
mod render;
mod scene;
mod seen;
mod shade;
mod trace;
mod trace_refraction;
mod vec3;
mod witness;

pub use dd::Dd;
pub use fill::{filled, nearest_samples};
pub use margin::{Decision, Judge};
pub use real::Real;
pub use render::{Reference, Tally};
pub use seen::{Seen, seen_through};
pub(crate) use vec3::Vec3;

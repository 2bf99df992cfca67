//! The CPU reference: the specification in `f64`, written to be read beside the shaders.

mod intersect;
mod margin;
mod real;
mod render;
mod scene;
mod shade;
mod trace;
mod vec3;
mod witness;

pub use margin::{Decision, Judge};
pub use real::Real;
pub use render::{Reference, Tally};

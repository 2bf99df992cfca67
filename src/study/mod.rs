//! What accuracy and effects cost in time, measured on the user's scene and device.

mod effect_cost;
mod sample;

pub use effect_cost::{EffectCost, Variant, effect_cost};
pub use sample::Sample;

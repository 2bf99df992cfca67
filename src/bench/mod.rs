//! How fast: families of scenes of growing size, rendered in turn by the device and by the CPU reference.

mod families;
mod fit;
mod measure;
mod plots;
mod report;
mod stages;
mod table;
mod tune;

pub use families::{Axis, FAMILIES, Family};
pub use fit::growth_exponent;
pub use measure::{Bench, FamilyResult, Growth, Measured, Plan, Renderer, SceneResult, Subject, bench, watched};
pub use report::html;
pub use stages::{STAGES, Stage};
pub use table::{csv, csv_columns, heads};
pub use tune::{KnobResult, Trial, TunePlan, TuneResult, tune};

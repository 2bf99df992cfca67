//! How fast: families of scenes of growing size, rendered in turn by the device and by the CPU reference.

mod baseline;
mod families;
mod fit;
mod measure;
mod phases;
mod plots;
mod report;
mod table;
mod tune;

pub use baseline::{Change, Comparison, Former};
pub use families::{Axis, FAMILIES, Family};
pub use fit::growth_exponent;
pub use measure::{Bench, BenchPlan, FamilyResult, Growth, Measured, RenderSetup, Renderer, SceneResult, bench};
pub use phases::{PHASES, Phase};
pub use report::html;
pub use table::{csv, csv_columns, heads};
pub use tune::{KnobResult, Trial, TunePlan, TuneResult, tune};

//! What accuracy and effects cost in time, measured on the user's scene and device.

mod contestant;
mod distance;
mod effect_cost;
mod hard_cases;
mod measure;
mod plots;
mod report;
mod sampling;
mod sampling_report;
mod table;

pub use crate::report::{Skipped, Timings};
pub use contestant::Contestant;
pub use distance::Distance;
pub use effect_cost::{EffectCost, Variant, effect_cost};
pub use hard_cases::{HardCases, hard_cases};
pub use measure::{Event, Point, Series, Study, StudyInput, StudyPlan, Truth, study};
pub use report::html;
pub use sampling::{Manner, PartialPoint, PartialSeries};
pub use table::{COLUMNS, csv};

//! What accuracy and effects cost in time, measured on the user's scene and device.

mod contestant;
mod effect_cost;
mod error;
mod hard_cases;
mod measure;
mod plots;
mod report;
mod sampling;
mod sampling_report;
mod table;

pub use crate::report::{Skipped, Timings};
pub use contestant::Contestant;
pub use effect_cost::{EffectCost, Variant, effect_cost};
pub use error::{Distance, Error};
pub use hard_cases::{HardCases, hard_cases};
pub use measure::{Event, Point, Series, Study, StudyInput, StudyPlan, Truth, study, watched};
pub use report::html;
pub use sampling::{Manner, PartialPoint, PartialSeries};
pub use table::{COLUMNS, csv};

//! The tuning of a device: what is kept for it, or what its class begins with.

use super::device::info::DeviceInfo;
use crate::tuning::{Class, Source, StoredTuning, Tuning, load};

/// A device's tuning and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceTuning {
    /// The numbers.
    pub tuning: Tuning,
    /// Where they come from.
    pub source: Source,
    /// Why a file that is there is not used.
    pub warning: Option<String>,
    /// Why it is not known whether there is one.
    closed: Option<String>,
    class: Class,
}

impl DeviceTuning {
    /// The tuning for `info`.
    pub fn of(info: &DeviceInfo) -> Self {
        let class = info.kind.class();
        let of_class =
            |warning| Self { tuning: Tuning::of(class), source: Source::Class, warning, closed: None, class };
        match load(&info.name, &info.driver) {
            StoredTuning::Nothing => of_class(None),
            StoredTuning::Unusable(why) => of_class(Some(why)),
            StoredTuning::Closed(why) => Self { closed: Some(why), ..of_class(None) },
            StoredTuning::Tuning(tuning, path) => match info.problem_with(&tuning) {
                None => Self { tuning, source: Source::File(path), warning: None, closed: None, class },
                Some(problem) => of_class(Some(format!("the tuning in {} is ignored: {problem}", path.display()))),
            },
        }
    }

    /// In words: the class, or the file and how it differs from the class.
    pub fn summary(&self) -> String {
        let class = self.class.name();
        let difference = self.tuning.difference(&Tuning::of(self.class));
        match (&self.source, difference.is_empty()) {
            (Source::Class, _) => match &self.closed {
                None => format!("that of {class} devices"),
                Some(why) => format!("that of {class} devices ({why})"),
            },
            (Source::File(path), true) => format!("that of {class} devices, confirmed in {}", path.display()),
            (Source::File(path), false) => format!("{difference}; from {}", path.display()),
        }
    }
}

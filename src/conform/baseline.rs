//! Known flaws of a driver: they must still be flaws, and no others may be.

use std::collections::BTreeSet;

use super::record::{Check, Former, Key, Run};

/// The known flaws of one device.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Baseline(BTreeSet<Key>);

/// What a check means beside the known flaws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It is as it should be.
    Fine,
    /// A flaw that is known.
    Expected,
    /// One that is not.
    New,
    /// A known flaw that is none any more.
    Fixed,
}

impl Standing {
    /// Whether a run fails by it.
    pub fn fails(self) -> bool {
        matches!(self, Self::New | Self::Fixed)
    }
}

impl Baseline {
    /// The flaws of a former run on `device`: where it had only one device, of that one, whatever it is called.
    ///
    /// # Errors
    ///
    /// Where it had several and none, or more than one, of this name.
    pub fn of(former: &Former, device: &str) -> Result<Self, String> {
        let runs = &former.report.runs;
        let named: Vec<_> = runs.iter().filter(|run| run.device == device).collect();
        let run = match (&runs[..], &named[..]) {
            ([run], _) => run,
            (_, [run]) => *run,
            _ => return Err(format!("it has {} devices, {} of them called {device}", runs.len(), named.len())),
        };
        Ok(Self(run.checks.iter().filter(|check| check.verdict.is_flaw()).map(|check| check.key.clone()).collect()))
    }

    /// What `check` means.
    pub fn standing(&self, check: &Check) -> Standing {
        match (check.verdict.is_flaw(), self.0.contains(&check.key)) {
            (false, false) => Standing::Fine,
            (true, true) => Standing::Expected,
            (true, false) => Standing::New,
            (false, true) => Standing::Fixed,
        }
    }

    /// Known flaws of what `is_meant` that `run` has not looked at.
    pub fn unseen(&self, run: &Run, is_meant: impl Fn(&Key) -> bool) -> Vec<Key> {
        let seen: BTreeSet<_> = run.checks.iter().map(|check| &check.key).collect();
        self.0.iter().filter(|key| is_meant(key) && !seen.contains(key)).cloned().collect()
    }
}

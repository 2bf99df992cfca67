//! What a run has found, as `--json` writes it and as it is read again.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::gpu::DeviceInfo;

/// What is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The picture of a built-in scene.
    Picture,
    /// What a tier promises of a class of hard cases.
    Promise,
}

/// What a check is told by, in every run of every program.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Key {
    /// What is checked.
    pub kind: Kind,
    /// The scene, or the class.
    pub name: String,
    /// The convention, or the case within the class; empty where it is alone.
    pub case: String,
    /// The tier, or `certified`.
    pub tier: String,
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, case, tier, .. } = self;
        let case = if case.is_empty() { String::new() } else { format!(", {case}") };
        write!(f, "{name}{case}, {tier}")
    }
}

/// How a check came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// A picture: every byte is the reference's.
    Same,
    /// Rounding explains each pixel that differs.
    Explained,
    /// It does not.
    Unexplained,
    /// It does not, or nothing is promised: the tier does not cover such a scene.
    NotCovered,
    /// A promise holds.
    Pass,
    /// It is broken.
    Fail,
    /// Too few rays hit anything for all of it to be seen.
    TooFew,
    /// Nothing is promised: reported only.
    Reported,
    /// The device lacks what the kernel needs, or has no room.
    Refused,
    /// The device or its driver failed.
    Error,
}

impl Verdict {
    /// Whether something is wrong with the device or its driver.
    pub fn is_flaw(self) -> bool {
        matches!(self, Self::Unexplained | Self::Fail | Self::Error)
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Explained => "explained",
            Self::Unexplained => "UNEXPLAINED",
            Self::NotCovered => "not covered",
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::TooFew => "too few",
            Self::Reported => "reported",
            Self::Refused => "refused",
            Self::Error => "ERROR",
        }
    }
}

/// One check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What it is told by.
    #[serde(flatten)]
    pub key: Key,
    /// How it came out.
    pub verdict: Verdict,
    /// Why, where that is not plain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub why: Vec<String>,
    /// Wall-clock time, in ms.
    pub ms: f64,
    /// Of a picture that was rendered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<PictureFacts>,
    /// Of rays that were traced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<RayFacts>,
}

/// What is told of a picture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureFacts {
    /// Of the numbers of the scene, as in a certificate.
    pub scene_sha256: String,
    /// Of the picture as P6 file.
    pub sha256: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels that are not the reference's.
    pub differing: u64,
    /// How many of them each decision explains.
    pub explained: BTreeMap<String, u64>,
    /// How many of them nothing explains.
    pub unexplained: u64,
    /// Pixels that are not finite.
    pub not_finite: u64,
}

/// What is told of rays; errors as in `trueray stress --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RayFacts {
    /// Rays, numbers or pixels.
    pub count: u64,
    /// Wrong rays.
    pub wrong: u64,
    /// 99.9th percentile of the error of t.
    pub p999: Option<f64>,
    /// Greatest weighted error of t.
    pub worst_t: Option<f64>,
}

/// All checks of one device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The device's name.
    pub device: String,
    /// Its driver with its version.
    pub driver: String,
    /// All else that is known of it, as in `trueray devices --json`.
    #[serde(default)]
    pub device_info: Value,
    /// The checks, in their order.
    pub checks: Vec<Check>,
    /// How the device was lost, where it was; the rest is missing then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost: Option<String>,
}

impl Run {
    /// Of a device, without any check.
    pub fn new(info: &DeviceInfo) -> Self {
        Self {
            device: info.name.clone(),
            driver: info.driver.clone(),
            device_info: serde_json::to_value(info).unwrap_or_default(),
            checks: Vec::new(),
            lost: None,
        }
    }

    /// The device with its driver.
    pub fn name(&self) -> String {
        format!("{} ({})", self.device, self.driver)
    }

    /// How many checks have this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|check| check.verdict == verdict).count()
    }
}

/// What `--json` writes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Rays of each case.
    pub count: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The rest is missing.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
    /// One for each device.
    pub runs: Vec<Run>,
}

/// A report that was written before, by this program or another version of it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Former {
    /// Name and version of what wrote it.
    #[serde(default)]
    pub program: String,
    /// Its commit, where it was known.
    #[serde(default)]
    pub commit: Option<String>,
    /// What it has found.
    #[serde(flatten)]
    pub report: Report,
}

impl Former {
    /// Reads a report.
    ///
    /// # Errors
    ///
    /// Where the text is none, or one of a run that did not end.
    pub fn read(text: &str) -> Result<Self, String> {
        let former: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is no report that `trueray conform --json` has written: {error}"))?;
        if former.report.interrupted || former.report.runs.iter().any(|run| run.lost.is_some()) {
            return Err("the run that it is of did not come to its end".into());
        }
        Ok(former)
    }
}

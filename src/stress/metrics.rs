//! What is counted of a class, and the limits that a tier promises to keep.

use std::fmt;

use serde::Serialize;

/// 2⁻²³, the unit of relative errors.
pub(super) const U: f64 = 1.0 / (1_u64 << 23) as f64;

/// Counts and errors of one case on one kernel. Absent: the case has no such thing.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Metrics {
    /// Rays, or numbers, or pixels.
    pub count: u64,
    /// Hits where there is none.
    pub false_hits: u64,
    /// Misses where there is a hit.
    pub false_misses: u64,
    /// The hit of another root or of another sphere.
    pub wrong_roots: u64,
    /// Those of the three that are at least the tier's band away from being right: whose path comes no nearer to a tangent, |1 − l²|,
    /// or to the critical angle, the square of the refracted ray's cosine.
    pub wrong_beyond_band: u64,
    /// Hits of another sphere than the nearest.
    pub inversions: u64,
    /// The greatest such distance of a wrong ray.
    pub misclassified: f64,
    /// Median error of t in units of 2⁻²³: relative to t, or where a path turns to t and the greatest semi-axis that it ends at.
    pub p50: Option<f64>,
    /// 99.9th percentile of it.
    pub p999: Option<f64>,
    /// Greatest.
    pub max: Option<f64>,
    /// Greatest error of t times the cosines between rays and normals on the way, where surfaces are spheres, since errors grow like
    /// one over them, and where a path turns times how steadily the normal follows the place there. This and the next three are in units of 2⁻²³.
    pub worst_t: Option<f64>,
    /// Greatest error of the hit point in greatest semi-axes, weighted likewise.
    pub worst_place: Option<f64>,
    /// Greatest error of the unit normal, weighted likewise, and with how steadily it follows the place.
    pub worst_normal: Option<f64>,
    /// Greatest error of the mirrored direction, weighted like that of the normal.
    pub worst_mirrored: Option<f64>,
    /// Hits or results that are not finite, and pixels with the status of one.
    pub not_finite: u64,
    /// Lit points in the dark.
    pub acne: Option<u64>,
    /// Dark points in the light.
    pub leaks: Option<u64>,
    /// Greatest absolute error of N·L, weighted likewise.
    pub light_error: Option<f64>,
    /// Greatest absolute error of the specular power or term.
    pub power_error: Option<f64>,
    /// Bits or pixels that differ where none may.
    pub differing: Option<u64>,
    /// What no number says.
    pub note: String,
}

impl Metrics {
    /// All wrong rays.
    pub fn wrong(&self) -> u64 {
        self.false_hits + self.false_misses + self.wrong_roots
    }

    /// `count` for each million.
    pub fn per_million(&self, count: u64) -> f64 {
        count as f64 * 1e6 / self.count.max(1) as f64
    }

    /// Sets the percentiles from relative errors in units of 2⁻²³.
    pub fn set_errors(&mut self, mut errors: Vec<f32>) {
        errors.sort_by(f32::total_cmp);
        let Some(last) = errors.len().checked_sub(1) else { return };
        let at = |q: f64| Some(f64::from(errors[(q * last as f64).ceil() as usize]));
        (self.p50, self.p999, self.max) = (at(0.5), at(0.999), at(1.0));
    }

    /// `None` where nothing of the kind was seen: no ray of the case hits anything.
    fn value(&self, quantity: Quantity) -> Option<f64> {
        Some(match quantity {
            Quantity::Wrong => self.per_million(self.wrong()),
            Quantity::WrongBeyondBand => self.per_million(self.wrong_beyond_band),
            Quantity::Inversions => self.per_million(self.inversions),
            Quantity::Misclassified => self.misclassified,
            Quantity::P999 => self.p999?,
            Quantity::WorstT => self.worst_t?,
            Quantity::WorstPlace => self.worst_place?,
            Quantity::WorstNormal => self.worst_normal?,
            Quantity::WorstMirrored => self.worst_mirrored?,
            Quantity::LightError => self.light_error?,
            Quantity::NotFinite => self.not_finite as f64,
            Quantity::Acne => self.per_million(self.acne?),
            Quantity::Leaks => self.per_million(self.leaks?),
            Quantity::PowerError => self.power_error?,
            Quantity::Differing => self.differing? as f64,
        })
    }
}

/// What a limit limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Wrong rays a million.
    Wrong,
    /// Wrong rays a million beyond the tier's band around the tangent and the critical angle.
    WrongBeyondBand,
    /// Order inversions a million.
    Inversions,
    /// How far a wrong ray is from being right, at the most.
    Misclassified,
    /// 99.9th percentile of the relative error, in units of 2⁻²³.
    P999,
    /// Greatest weighted error of t, in units of 2⁻²³.
    WorstT,
    /// Greatest weighted error of the hit point.
    WorstPlace,
    /// Greatest weighted error of the normal.
    WorstNormal,
    /// Greatest weighted error of the mirrored direction.
    WorstMirrored,
    /// Greatest weighted error of N·L.
    LightError,
    /// Results that are not finite.
    NotFinite,
    /// Acne a million.
    Acne,
    /// Leaks a million.
    Leaks,
    /// Error of the specular power.
    PowerError,
    /// Differing bits or pixels.
    Differing,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Wrong => "wrong ppm",
            Self::WrongBeyondBand => "wrong ppm beyond the band",
            Self::Inversions => "inversions ppm",
            Self::Misclassified => "misclassified |1-l²|",
            Self::P999 => "p99.9 of t",
            Self::WorstT => "worst t",
            Self::WorstPlace => "worst hit point",
            Self::WorstNormal => "worst normal",
            Self::WorstMirrored => "worst mirrored direction",
            Self::LightError => "worst N·L",
            Self::NotFinite => "not finite",
            Self::Acne => "acne ppm",
            Self::Leaks => "leaks ppm",
            Self::PowerError => "power error",
            Self::Differing => "differing",
        })
    }
}

/// A part of a promise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// What is limited.
    pub quantity: Quantity,
    /// The greatest value that keeps the promise.
    pub at_most: f64,
}

/// What a tier promises of a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// These limits.
    Limits(Vec<Limit>),
    /// Nothing: the host sees that the tier does not cover such a scene.
    NotCovered,
    /// Nothing: reported only.
    Reported,
    /// The case does not concern the tier.
    NotApplicable,
}

/// How a kernel did on a case.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "is", content = "why", rename_all = "kebab-case")]
pub enum Verdict {
    /// The promise holds.
    Pass,
    /// It is broken.
    Fail(Vec<String>),
    /// What there was holds, but too few rays hit anything for all of it to be seen.
    TooFew(String),
    /// There is none: the tier does not cover such scenes.
    NotCovered,
    /// There is none.
    Reported,
    /// The device lacks what the kernel needs.
    Refused(String),
}

impl Verdict {
    /// Whether `metrics` keep to `target`.
    pub fn of(metrics: &Metrics, target: &Target) -> Self {
        match target {
            Target::NotCovered => Self::NotCovered,
            Target::Reported | Target::NotApplicable => Self::Reported,
            Target::Limits(limits) => {
                let mut broken = Vec::new();
                let mut unseen = Vec::new();
                for &Limit { quantity, at_most } in limits {
                    match metrics.value(quantity) {
                        // A NaN breaks every limit.
                        Some(value) if !(value <= at_most) => {
                            broken.push(format!("{quantity} {value:.3e} > {at_most:.1e}"));
                        }
                        Some(_) => {}
                        None => unseen.push(quantity.to_string()),
                    }
                }
                match (broken.is_empty(), unseen.is_empty()) {
                    (false, _) => Self::Fail(broken),
                    (true, false) => Self::TooFew(format!("too few rays for {}", unseen.join(", "))),
                    (true, true) => Self::Pass,
                }
            }
        }
    }

    /// In a word.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail(_) => "FAIL",
            Self::TooFew(_) => "too few",
            Self::NotCovered => "not covered",
            Self::Reported => "reported",
            Self::Refused(_) => "refused",
        }
    }
}

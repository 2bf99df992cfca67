//! Repeated timings of one thing, and what can be trusted of them.

use serde::Serialize;

/// Runs that differ by more than this part of their median deserve a word of caution.
const WIDE: f64 = 0.5;

/// Times of several runs, in ms.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Timings {
    runs: Vec<f64>,
}

impl Timings {
    /// Adds one run.
    pub fn push(&mut self, ms: f64) {
        self.runs.push(ms);
    }

    /// All runs, in the order in which they were made.
    pub fn runs(&self) -> &[f64] {
        &self.runs
    }

    /// The same as text, separated by blanks.
    pub(crate) fn listed(&self) -> String {
        self.runs.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    }

    fn sorted(&self) -> Vec<f64> {
        let mut sorted = self.runs.clone();
        sorted.sort_by(f64::total_cmp);
        sorted
    }

    /// The value below which the fraction `q` of the runs lies, linear between runs; NaN without runs.
    fn quantile(&self, q: f64) -> f64 {
        let sorted = self.sorted();
        let Some(last) = sorted.len().checked_sub(1) else {
            return f64::NAN;
        };
        let place = q * last as f64;
        let (low, fraction) = (place as usize, place.fract());
        sorted[low] + fraction * (sorted[(low + 1).min(last)] - sorted[low])
    }

    /// The median; NaN without runs.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// The least run; NaN without runs.
    pub fn min(&self) -> f64 {
        self.quantile(0.0)
    }

    /// The greatest run; NaN without runs.
    pub fn max(&self) -> f64 {
        self.quantile(1.0)
    }

    /// From the least to the greatest run, as a part of the median; NaN without runs.
    pub fn spread(&self) -> f64 {
        (self.max() - self.min()) / self.median()
    }

    /// How many runs lie outside Tukey's fences, 1.5 times the interquartile range beyond the quartiles (J. W. Tukey,
    /// Exploratory Data Analysis, 1977): something else was running.
    pub fn outliers(&self) -> usize {
        let (low, high) = (self.quantile(0.25), self.quantile(0.75));
        let reach = 1.5 * (high - low);
        self.runs.iter().filter(|&&run| run < low - reach || run > high + reach).count()
    }

    /// What can be trusted of the runs, in a word for the last column of a table; empty where all is well.
    pub(crate) fn caution(&self) -> String {
        match self.outliers() {
            0 if self.spread() > WIDE => "wide spread".into(),
            0 => String::new(),
            1 => "1 outlier".into(),
            count => format!("{count} outliers"),
        }
    }
}

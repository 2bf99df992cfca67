//! The measurements of an earlier run beside those of this one: is anything slower?

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::measure::{Bench, Renderer};
use crate::random::Random;
use crate::report::number::short;
use crate::report::{Skipped, Timings};

/// Resamples of the bootstrap, and the seed of their random numbers.
const RESAMPLES: usize = 2000;
const SEED: u64 = 95;
/// The part of them that the interval leaves out at each end.
const TAIL: f64 = 0.025;

/// What a run wrote with `--json`.
#[derive(Debug, Clone, Deserialize)]
pub struct Former {
    bench: FormerBench,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerBench {
    device: Option<FormerDevice>,
    settings: serde_json::Value,
    families: Vec<FormerFamily>,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerDevice {
    name: String,
    driver: String,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerFamily {
    name: String,
    scenes: Vec<FormerScene>,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerScene {
    size: usize,
    width: u32,
    height: u32,
    tier: Option<String>,
    measured: Vec<FormerTimes>,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerTimes {
    renderer: String,
    picture: FormerRuns,
}

#[derive(Debug, Clone, Deserialize)]
struct FormerRuns {
    runs: Vec<f64>,
}

/// All that both runs have measured.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// What else differs between the runs and may explain a change, in words.
    pub notes: Vec<String>,
    /// A row for each scene and renderer.
    pub rows: Vec<Change>,
    /// What the earlier run has measured and this one has skipped, with the reasons: as a rule it takes too long now.
    pub skipped: Vec<Skipped>,
}

/// The times of one scene on one renderer, before and now.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// Family and size.
    pub scene: String,
    /// Who rendered.
    pub renderer: Renderer,
    /// Medians, in ms.
    pub before_ms: f64,
    /// Likewise.
    pub now_ms: f64,
    /// The median now over that before.
    pub ratio: f64,
    /// In which that ratio lies with a confidence of 95 %: the percentile bootstrap (B. Efron, R. J. Tibshirani, An Introduction to
    /// the Bootstrap, 1993) over the runs of both. It knows of the noise within both runs, and of nothing that differs between them.
    pub interval: [f64; 2],
}

impl Change {
    fn new(scene: String, renderer: Renderer, before: &Timings, now: &Timings) -> Self {
        let (before_ms, now_ms) = (before.median(), now.median());
        Self { scene, renderer, before_ms, now_ms, ratio: now_ms / before_ms, interval: interval(before, now) }
    }

    /// Whether it is slower by more than this part for sure.
    pub fn is_slower(&self, part: f64) -> bool {
        self.interval[0] > 1.0 + part
    }

    /// In a word, where `part` is what counts as slower or faster.
    fn verdict(&self, part: f64) -> &'static str {
        let [low, high] = self.interval;
        if self.is_slower(part) {
            "slower"
        } else if high < 1.0 / (1.0 + part) {
            "faster"
        } else if self.ratio > 1.0 + part && low > 1.0 {
            "perhaps slower: more --runs would tell"
        } else {
            "as before"
        }
    }
}

/// The interval of the ratio of medians.
fn interval(before: &Timings, now: &Timings) -> [f64; 2] {
    let random = &mut Random::new(SEED, 0);
    let mut resampled = |timings: &Timings| {
        let runs = timings.runs();
        let mut again = Timings::default();
        for _ in runs {
            again.push(runs[random.bits() as usize % runs.len()]);
        }
        again.median()
    };
    let mut ratios: Vec<f64> = (0..RESAMPLES).map(|_| resampled(now) / resampled(before)).collect();
    ratios.sort_by(f64::total_cmp);
    let at = |part: f64| ratios[(part * (RESAMPLES - 1) as f64).round() as usize];
    [at(TAIL), at(1.0 - TAIL)]
}

impl Comparison {
    /// `bench` beside an earlier run.
    ///
    /// # Errors
    ///
    /// Where no scene was measured by both under the same conditions; why, in words.
    pub fn new(former: &Former, bench: &Bench) -> Result<Self, String> {
        let former = &former.bench;
        let now = serde_json::to_value(bench.settings).map_err(|error| error.to_string())?;
        if former.settings != now {
            return Err("it was measured with other conventions, samples or depth".into());
        }
        let mut notes = Vec::new();
        if let (Some(before), Some(now)) = (&former.device, &bench.device) {
            let mut note = |what, before: &str, now: &str| {
                if before != now {
                    notes.push(format!("another {what} then, {before}; now {now}"));
                }
            };
            note("device", &before.name, &now.name);
            note("driver", &before.driver, &now.driver);
        }
        let (mut rows, mut skipped) = (Vec::new(), Vec::new());
        for family in &bench.families {
            let before = former.families.iter().find(|other| other.name == family.name);
            for scene in &family.scenes {
                let name = format!("{}-{}", family.name, scene.size);
                let same = |other: &&FormerScene| other.size == scene.size;
                let Some(before) = before.and_then(|family| family.scenes.iter().find(same)) else { continue };
                if (before.width, before.height, &before.tier) != (scene.width, scene.height, &scene.tier) {
                    let tier = before.tier.as_deref().unwrap_or("the reference");
                    notes
                        .push(format!("{name} is not compared: it was {} × {} at {tier}", before.width, before.height));
                    continue;
                }
                let had = |name: &str| before.measured.iter().any(|times| times.renderer == name);
                let now_skipped = scene.skipped.iter().filter(|skipped| had(&skipped.name));
                skipped.extend(now_skipped.map(|Skipped { name: renderer, reason }| Skipped {
                    name: format!("{name} on {renderer}"),
                    reason: reason.clone(),
                }));
                for measured in &scene.measured {
                    let of_renderer = |other: &&FormerTimes| other.renderer == measured.renderer.name();
                    let Some(before) = before.measured.iter().find(of_renderer) else { continue };
                    let mut timings = Timings::default();
                    before.picture.runs.iter().filter(|ms| **ms > 0.0).for_each(|&ms| timings.push(ms));
                    if timings.runs().is_empty() || measured.picture.runs().is_empty() {
                        continue;
                    }
                    rows.push(Change::new(name.clone(), measured.renderer, &timings, &measured.picture));
                }
            }
        }
        let left_out = former.families.iter().flat_map(|family| family.scenes.iter().map(move |scene| (family, scene)));
        let left_out = left_out.filter(|(family, scene)| {
            let own = bench.families.iter().find(|own| own.name == family.name);
            !own.is_some_and(|own| own.scenes.iter().any(|own| own.size == scene.size))
        });
        let left_out: Vec<_> = left_out.map(|(family, scene)| format!("{}-{}", family.name, scene.size)).collect();
        if !left_out.is_empty() {
            notes.push(format!("measured then and not now: {}", left_out.join(", ")));
        }
        if rows.is_empty() && skipped.is_empty() {
            return Err("it has none of the scenes that were measured, at their size and tier".into());
        }
        Ok(Self { notes, rows, skipped })
    }

    /// Whether anything is slower by more than this part for sure, or too slow to be measured again.
    pub fn is_slower(&self, part: f64) -> bool {
        !self.skipped.is_empty() || self.rows.iter().any(|row| row.is_slower(part))
    }

    /// As a table for the terminal, where `part` is what counts as slower or faster.
    pub fn report(&self, part: f64) -> String {
        let mut text = format!(
            "{:<20} {:<7} {:>9} {:>9} {:>7} {:>15}\n",
            "medians in ms", "", "before", "now", "ratio", "95 % interval"
        );
        for row in &self.rows {
            let Change { scene, renderer, before_ms, now_ms, ratio, interval: [low, high] } = row;
            let _ = writeln!(
                text,
                "{scene:<20} {:<7} {:>9} {:>9} {ratio:>7.3} {:>15}  {}",
                renderer.name(),
                short(*before_ms),
                short(*now_ms),
                format!("{low:.3} … {high:.3}"),
                row.verdict(part)
            );
        }
        for Skipped { name, reason } in &self.skipped {
            let _ = writeln!(text, "{name}: measured then, skipped now: {reason}");
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }
}

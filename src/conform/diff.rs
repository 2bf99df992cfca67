//! Two runs beside each other: two devices, two drivers, two versions of this program.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::COLUMNS;
use super::record::{Check, Key, Kind, Run, Verdict};
use super::table::row;

/// How two checks of the same thing relate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Relation {
    /// Pictures that differ, and one or both of them more than rounding explains; or a picture on one side and an error on the other.
    Unexplained,
    /// A promise that one side keeps and the other breaks.
    Broken,
    /// Pictures of scenes that differ, though they have one name.
    OtherScene,
    /// One side has no picture, or has not looked.
    OneSide,
    /// Pictures that differ where the tier does not cover the scene, and promises no side of which is broken.
    NotPromised,
    /// Pictures that differ, each of them explained.
    Explained,
    /// The same bytes, or the same verdict.
    Same,
}

impl Relation {
    /// Whether it is more than rounding explains.
    pub fn is_difference(self) -> bool {
        matches!(self, Self::Unexplained | Self::Broken)
    }

    fn word(self) -> &'static str {
        match self {
            Self::Unexplained => "UNEXPLAINED",
            Self::Broken => "BROKEN",
            Self::OtherScene => "other scene",
            Self::OneSide => "one side",
            Self::NotPromised => "not promised",
            Self::Explained => "explained",
            Self::Same => "same bytes",
        }
    }
}

/// What one run says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Side {
    /// How it came out.
    pub verdict: Verdict,
    /// The picture's hash.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// Wrong rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong: Option<u64>,
    /// Greatest weighted error of t, in units of 2⁻²³.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_t: Option<f64>,
}

impl Side {
    fn of(check: &Check) -> Self {
        Self {
            verdict: check.verdict,
            sha256: check.picture.as_ref().map(|facts| facts.sha256.clone()),
            wrong: check.rays.as_ref().map(|rays| rays.wrong),
            worst_t: check.rays.as_ref().and_then(|rays| rays.worst_t),
        }
    }
}

/// One check in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// What it is told by.
    #[serde(flatten)]
    pub key: Key,
    /// How the two relate.
    pub relation: Relation,
    /// What the first run says; absent where it has not looked.
    pub a: Option<Side>,
    /// What the second one says.
    pub b: Option<Side>,
}

/// Every check of either run, in the order of the first one.
pub fn diff(a: &Run, b: &Run) -> Vec<Pair> {
    let of_b: BTreeMap<_, _> = b.checks.iter().map(|check| (&check.key, check)).collect();
    let of_a: BTreeMap<_, _> = a.checks.iter().map(|check| (&check.key, check)).collect();
    let both = a.checks.iter().map(|check| (Some(check), of_b.get(&check.key).copied()));
    let rest = b.checks.iter().filter(|check| !of_a.contains_key(&check.key)).map(|check| (None, Some(check)));
    let pairs = both.chain(rest).filter_map(|(a, b)| {
        let key = a.or(b)?.key.clone();
        Some(Pair { key, relation: relation(a, b), a: a.map(Side::of), b: b.map(Side::of) })
    });
    pairs.collect()
}

fn relation(a: Option<&Check>, b: Option<&Check>) -> Relation {
    let (Some(a), Some(b)) = (a, b) else { return Relation::OneSide };
    let has = |verdict| a.verdict == verdict || b.verdict == verdict;
    let is_flaw = a.verdict.is_flaw() || b.verdict.is_flaw();
    if a.key.kind == Kind::Promise {
        return match (a.verdict == b.verdict, is_flaw) {
            (true, _) => Relation::Same,
            (_, true) => Relation::Broken,
            _ if has(Verdict::Refused) => Relation::OneSide,
            _ => Relation::NotPromised,
        };
    }
    if has(Verdict::Refused) && a.verdict != b.verdict {
        return Relation::OneSide;
    }
    match (&a.picture, &b.picture) {
        (Some(one), Some(other)) if one.scene_sha256 != other.scene_sha256 => Relation::OtherScene,
        (Some(one), Some(other)) if one.sha256 == other.sha256 => Relation::Same,
        (Some(_), Some(_)) if !is_flaw && has(Verdict::NotCovered) => Relation::NotPromised,
        (Some(_), Some(_)) if !is_flaw => Relation::Explained,
        (None, None) if a.verdict == b.verdict => Relation::Same,
        _ if is_flaw => Relation::Unexplained,
        _ => Relation::OneSide,
    }
}

/// The table for people: a line a scene and convention, a line a case of a class; and what it comes to.
pub fn diff_table(pairs: &[Pair]) -> String {
    let mut lines: Vec<(&Key, Vec<&Pair>)> = Vec::new();
    for pair in pairs {
        let is_of = |key: &Key| (key.kind, &key.name, &key.case) == (pair.key.kind, &pair.key.name, &pair.key.case);
        match lines.iter_mut().find(|(key, _)| is_of(key)) {
            Some((_, of_line)) => of_line.push(pair),
            None => lines.push((&pair.key, vec![pair])),
        }
    }
    let mut text = row(["scene or class", "rules"], &COLUMNS.map(str::to_owned));
    for (key, of_line) in lines {
        let cell = |tier: &str| of_line.iter().find(|pair| pair.key.tier == tier).map_or("-".into(), |pair| cell(pair));
        let cells = COLUMNS.map(cell);
        text += &match key.kind {
            Kind::Picture => row([&key.name, &key.case], &cells),
            Kind::Promise => row([&format!("{} {}", key.name, key.case), ""], &cells),
        };
    }
    for kind in [Kind::Picture, Kind::Promise] {
        let mut counts: BTreeMap<Relation, usize> = BTreeMap::new();
        pairs
            .iter()
            .filter(|pair| pair.key.kind == kind)
            .for_each(|pair| *counts.entry(pair.relation).or_default() += 1);
        let (what, same) = match kind {
            Kind::Picture => ("pictures", "same bytes"),
            Kind::Promise => ("promises", "same verdict"),
        };
        let word = |relation: Relation| if relation == Relation::Same { same } else { relation.word() };
        let parts: Vec<_> =
            counts.iter().rev().map(|(&relation, count)| format!("{count} {}", word(relation))).collect();
        let _ = writeln!(text, "{what}: {}", if parts.is_empty() { "none".into() } else { parts.join(", ") });
    }
    text
}

fn cell(pair: &Pair) -> String {
    let side = |side: &Option<Side>| side.as_ref().map_or("-", |side| side.verdict.word());
    let (a, b) = (side(&pair.a), side(&pair.b));
    match (pair.key.kind, pair.relation) {
        (Kind::Promise, Relation::Same) => a.into(),
        (Kind::Promise, _) | (_, Relation::OneSide) => format!("{a} | {b}"),
        (_, relation) => relation.word().into(),
    }
}

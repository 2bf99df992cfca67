//! The table for people: a line a scene and convention, a line a class, and below it what failed.

use std::fmt::Write as _;

use super::COLUMNS;
use super::baseline::{Baseline, Standing};
use super::record::{Check, Key, Kind, Run, Verdict};
use crate::words::{count, visible};

/// Width of the columns of a line's name and of its convention.
const NAMES: (usize, usize) = (30, 9);
/// Width of a tier's column.
const CELL: usize = 16;

/// The head of the table.
pub fn head() -> String {
    row(["scene or class", "rules"], &COLUMNS.map(str::to_owned))
}

pub(super) fn row(names: [&str; 2], cells: &[String; 4]) -> String {
    let [name, case] = names.map(visible);
    let mut text = format!("{name:<0$}{case:<1$}", NAMES.0, NAMES.1);
    for cell in cells {
        let _ = write!(text, "{cell:<CELL$}");
    }
    text.trim_end().to_owned() + "\n"
}

/// The line of some checks of one scene in one convention, or of one class, with what failed below it.
pub fn line(checks: &[Check], baseline: &Baseline) -> String {
    let Some(Check { key: first, .. }) = checks.first() else { return String::new() };
    let cell = |tier: &str| {
        let of_tier = checks.iter().filter(|check| check.key.tier == tier);
        of_tier
            .min_by_key(|check| urgency(check, baseline))
            .map_or_else(|| "-".to_owned(), |check| cell(check, baseline))
    };
    let rules = if first.kind == Kind::Picture { first.case.as_str() } else { "" };
    let mut text = row([&first.name, rules], &COLUMNS.map(cell));
    for check in checks {
        let standing = baseline.standing(check);
        if standing != Standing::Fine {
            let _ = writeln!(text, "    {}: {}", check.key, told(check, standing));
        }
    }
    text
}

/// What is shown where a cell stands for several checks: the least.
fn urgency(check: &Check, baseline: &Baseline) -> u8 {
    match (baseline.standing(check), check.verdict) {
        (Standing::New, _) => 0,
        (Standing::Fixed, _) => 1,
        (Standing::Expected, _) => 2,
        (_, Verdict::Refused) => 3,
        (_, Verdict::TooFew) => 4,
        (_, Verdict::Pass) => 5,
        _ => 6,
    }
}

fn cell(check: &Check, baseline: &Baseline) -> String {
    let word = check.verdict.word();
    match (baseline.standing(check), &check.picture) {
        (Standing::Expected, _) => "known flaw".into(),
        (Standing::Fixed, _) => format!("{word}, FIXED"),
        (_, Some(facts)) if check.verdict == Verdict::Explained => format!("{} {word}", facts.differing),
        (_, Some(facts)) if check.verdict == Verdict::Unexplained => format!("{} {word}", facts.unexplained),
        _ => word.into(),
    }
}

/// What failed, in a line.
pub(super) fn told(check: &Check, standing: Standing) -> String {
    let why = check.why.join("; ");
    match standing {
        Standing::Fine | Standing::New => why,
        Standing::Expected => format!("known flaw: {why}"),
        Standing::Fixed => {
            format!("a known flaw that is none any more ({}): the baseline is out of date", check.verdict.word())
        }
    }
}

/// What all of it comes to; `unseen` are known flaws that the run has not looked at.
pub fn summary(run: &Run, baseline: &Baseline, unseen: &[Key]) -> String {
    let of = |kind| run.checks.iter().filter(move |check| check.key.kind == kind).count() as u64;
    let some = |verdicts: &[Verdict]| {
        let counts =
            verdicts.iter().map(|&verdict| (run.count(verdict), verdict.word())).filter(|(count, _)| *count > 0);
        counts.map(|(count, word)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
    };
    let standings = |wanted| run.checks.iter().filter(|check| baseline.standing(check) == wanted).count() as u64;
    let mut text = format!("{}\n", run.name());
    let (pictures, promises) = (of(Kind::Picture), of(Kind::Promise));
    let _ = writeln!(text, "  {} and {}", count(pictures, "picture"), count(promises, "promise"));
    let _ = writeln!(
        text,
        "  {}",
        some(&[
            Verdict::Same,
            Verdict::Explained,
            Verdict::Pass,
            Verdict::Reported,
            Verdict::NotCovered,
            Verdict::TooFew
        ])
    );
    for verdict in [Verdict::Unexplained, Verdict::Fail, Verdict::Error, Verdict::Refused] {
        let found: Vec<_> = run.checks.iter().filter(|check| check.verdict == verdict).collect();
        if let Some(first) = found.first() {
            let why = first.why.first().map_or("", String::as_str);
            let _ = writeln!(text, "  {} {}, first {}: {why}", found.len(), verdict.word(), first.key);
        }
    }
    for key in unseen {
        let _ = writeln!(text, "  {key}: a known flaw that this run has not looked at: the baseline is out of date");
    }
    if let Some(why) = &run.lost {
        let _ = writeln!(text, "  the device was lost, and the rest is missing: {why}");
    }
    let (new, known, fixed) = (standings(Standing::New), standings(Standing::Expected), standings(Standing::Fixed));
    let _ = writeln!(text, "  {}, {} known, {} fixed", count(new, "new flaw"), known, fixed);
    text
}

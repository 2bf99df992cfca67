//! `JUnit` XML, which servers of continuous integration read: a suite for each device and tier of pictures, and of promises.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Property, Report as Xml, TestCase, TestCaseStatus, TestSuite};

use super::COLUMNS;
use super::baseline::{Baseline, Standing};
use super::record::{Check, Key, Kind, Run, Verdict};
use super::table::told;

/// The report of `runs`, each with its known flaws and those of them that it has not looked at. `properties` are names and values that
/// each suite gets.
///
/// # Errors
///
/// What the library that writes XML says.
pub fn junit(runs: &[(&Run, &Baseline, &[Key])], properties: &[(String, String)]) -> Result<String, String> {
    let mut xml = Xml::new("trueray conform");
    let mut total = Duration::ZERO;
    for (run, baseline, unseen) in runs {
        for kind in [Kind::Picture, Kind::Promise] {
            // What is of no tier, a failure of the device, has a suite of its own.
            for tier in COLUMNS.iter().copied().chain(["all"]) {
                let is_of = |key: &Key| key.kind == kind && key.tier == tier;
                let checks = run.checks.iter().filter(|check| is_of(&check.key));
                let mut cases: Vec<_> = checks.map(|check| case(check, baseline.standing(check))).collect();
                cases.extend(unseen.iter().filter(|key| is_of(key)).map(case_of_unseen));
                if cases.is_empty() {
                    continue;
                }
                let what = if kind == Kind::Picture { "pictures" } else { "promises" };
                let mut suite = TestSuite::new(format!("{what}, {tier}, on {}", run.name()));
                suite.add_properties(properties.iter().map(|(name, value)| Property::new(name, value)));
                suite.add_property(Property::new("device", &run.device));
                suite.add_property(Property::new("driver", &run.driver));
                let time: Duration = cases.iter().filter_map(|case| case.time).sum();
                suite.set_time(time).add_test_cases(cases);
                xml.add_test_suite(suite);
                total += time;
            }
        }
    }
    xml.set_time(total);
    xml.to_string().map_err(|error| error.to_string())
}

fn named(key: &Key, status: TestCaseStatus) -> TestCase {
    let Key { kind, name, case, tier } = key;
    let title = if case.is_empty() { name.clone() } else { format!("{name}, {case}") };
    let what = if *kind == Kind::Picture { "picture" } else { "promise" };
    let mut test = TestCase::new(title, status);
    test.set_classname(format!("trueray.{what}.{tier}"));
    test
}

fn case(check: &Check, standing: Standing) -> TestCase {
    let text = told(check, standing);
    let skipped = |message: String| {
        let mut status = TestCaseStatus::skipped();
        status.set_message(message);
        status
    };
    let failure = |kind, category: &str| {
        let mut status = TestCaseStatus::non_success(kind);
        let first = check.why.first().map_or(text.as_str(), String::as_str);
        let message = if standing == Standing::Fixed { text.as_str() } else { first };
        status.set_type(category).set_message(message).set_description(text.as_str());
        status
    };
    let status = match (standing, check.verdict) {
        (Standing::Fixed, _) => failure(NonSuccessKind::Failure, "fixed"),
        (Standing::Expected, _) => skipped(text.clone()),
        (_, Verdict::Error) => failure(NonSuccessKind::Error, "error"),
        (_, verdict) if verdict.is_flaw() => failure(NonSuccessKind::Failure, verdict.word()),
        (_, Verdict::Refused | Verdict::NotCovered | Verdict::TooFew) => {
            skipped(format!("{}: {text}", check.verdict.word()).trim_end_matches(": ").to_owned())
        }
        _ => TestCaseStatus::success(),
    };
    let mut test = named(&check.key, status);
    test.set_time(Duration::try_from_secs_f64(check.ms / 1e3).unwrap_or_default());
    if let Some(facts) = &check.picture {
        test.set_system_out(format!("SHA-256 {}, {} pixels differ", facts.sha256, facts.differing));
    }
    test
}

/// A known flaw that was not looked at.
fn case_of_unseen(key: &Key) -> TestCase {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_type("not run").set_message("a known flaw that this run has not looked at: the baseline is out of date");
    named(key, status)
}

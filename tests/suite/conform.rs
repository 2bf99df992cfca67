//! Is a driver right? Runs of few scenes, known flaws, `JUnit` files, and two runs beside each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use trueray::conform::{
    Baseline, BuiltIn, Check, Former, Key, Kind, PictureFacts, Plan, RayFacts, Relation, Report, Run, SCENES, Standing,
    Verdict, diff, diff_table, junit, line, run, summary,
};
use trueray::stress::classes;

use crate::support::{gpu, root};
use crate::verify::Driver;

/// A check by hand.
fn check(kind: Kind, name: &str, tier: &str, verdict: Verdict) -> Check {
    let picture = kind == Kind::Picture && !matches!(verdict, Verdict::Refused | Verdict::Error);
    let facts = || PictureFacts {
        scene_sha256: "scene".into(),
        sha256: format!("{verdict:?}"),
        width: 2,
        height: 1,
        differing: u64::from(verdict != Verdict::Same),
        explained: BTreeMap::new(),
        unexplained: u64::from(verdict == Verdict::Unexplained),
        not_finite: 0,
    };
    // A number that JSON does not have is none when it is read again.
    let rays = || RayFacts { count: 9, wrong: 1, p999: None, worst_t: Some(0.1) };
    Check {
        key: Key { kind, name: name.into(), case: "a <case> & \"more\"".into(), tier: tier.into() },
        verdict,
        why: if verdict.is_flaw() { vec!["worst t 9 > 1 \u{1} ]]>".into(), "second".into()] } else { Vec::new() },
        ms: 1500.0,
        picture: picture.then(facts),
        rays: (kind == Kind::Promise).then(rays),
    }
}

fn run_of(checks: Vec<Check>) -> Run {
    let (device, driver) = ("card".to_owned(), "driver 1".to_owned());
    Run { device, driver, device_info: serde_json::Value::Null, checks, lost: None }
}

fn report(runs: Vec<Run>) -> Report {
    Report { count: 64, seed: 1, interrupted: false, runs }
}

fn read_again(report: &Report) -> Result<Former, String> {
    Former::read(&serde_json::to_string(report).unwrap())
}

/// Every verdict once or twice.
fn all_verdicts() -> Run {
    use Verdict::{Error, Explained, Fail, NotCovered, Pass, Refused, Reported, Same, TooFew, Unexplained};
    let pictures = [Same, Explained, Unexplained, NotCovered, Refused, Error].into_iter();
    let promises = [Pass, Fail, TooFew, Reported, NotCovered, Refused].into_iter();
    let pictures = pictures.map(|verdict| check(Kind::Picture, &format!("{verdict:?}"), "fast", verdict));
    let promises = promises.map(|verdict| check(Kind::Promise, &format!("{verdict:?}"), "robust", verdict));
    run_of(pictures.chain(promises).collect())
}

#[test]
fn built_in_scenes_are_some_forty_and_have_no_errors() {
    let names: BTreeSet<_> = SCENES.iter().map(|scene| scene.name).collect();
    assert!(names.len() == SCENES.len() && (40..=50).contains(&names.len()), "{}", names.len());
    for scene in SCENES {
        assert!(scene.scene().is_some(), "{}", scene.name);
        assert_eq!(fs::read_to_string(root().join(format!("scenes/{}.txt", scene.name))).unwrap(), scene.text);
    }
    for folder in ["basic", "effects", "hard", "refraction"] {
        assert!(names.iter().any(|name| name.starts_with(folder)), "{folder}");
    }
}

/// Three scenes and a class on the device: nothing is wrong, certified pictures are the reference's, and what is written is read again.
#[test]
fn a_right_driver_has_no_flaw() {
    let Some(gpu) = gpu("a_right_driver_has_no_flaw") else { return };
    let scenes = ["basic/one-row", "effects/everything", "hard/needles"];
    let plan = Plan {
        scenes: scenes.iter().filter_map(|name| BuiltIn::named(name)).collect(),
        classes: classes().into_iter().filter(|class| class.name == "ordinary").collect(),
        count: 2000,
        seed: 1,
    };
    let mut seen: Vec<Check> = Vec::new();
    let mut parts = Vec::new();
    let run = run(&gpu, &plan, |checks, part| {
        seen.extend_from_slice(checks);
        parts.push(part);
    });
    assert_eq!((seen.len(), parts.len(), parts.last()), (run.checks.len(), 3 * 2 + 1, Some(&1.0)));
    assert_eq!(seen, run.checks);
    let flaws: Vec<_> = run.checks.iter().filter(|check| check.verdict.is_flaw()).collect();
    assert!(flaws.is_empty() && run.lost.is_none(), "{flaws:#?}");
    let pictures = |tier: &str| {
        run.checks.iter().filter(|check| check.key.kind == Kind::Picture && check.key.tier == tier).collect::<Vec<_>>()
    };
    assert!(["fast", "robust", "double", "certified"].iter().all(|tier| pictures(tier).len() == 6));
    assert!(pictures("certified").iter().all(|check| check.verdict == Verdict::Same), "{run:#?}");
    // `fast` does not promise needles of 1 : 10,000, and rounding shows.
    let needles = |tier| pictures(tier).into_iter().filter(|check| check.key.name == "hard/needles");
    assert!(needles("fast").any(|check| check.verdict != Verdict::Same), "{run:#?}");
    assert!(run.checks.iter().any(|check| check.key.kind == Kind::Promise && check.rays.is_some()));
    let report = report(vec![run]);
    assert_eq!(read_again(&report).unwrap().report, report);
}

#[test]
fn known_flaws_must_still_be_flaws_and_no_others_may_be() {
    let former = all_verdicts();
    let baseline = Baseline::of(&read_again(&report(vec![former.clone()])).unwrap(), "another name").unwrap();
    let standings = |run: &Run| -> BTreeSet<String> {
        let fails = run.checks.iter().filter(|check| baseline.standing(check).fails());
        fails.map(|check| format!("{:?} {}", baseline.standing(check), check.key.name)).collect()
    };
    assert_eq!(standings(&former), BTreeSet::new());
    assert_eq!(baseline.unseen(&former, |_| true), []);
    let mut now = former.clone();
    let at = |run: &Run, name: &str| run.checks.iter().position(|check| check.key.name == name).unwrap();
    let (fixed, new, gone) = (at(&now, "Unexplained"), at(&now, "Pass"), at(&now, "Error"));
    (now.checks[fixed].verdict, now.checks[new].verdict) = (Verdict::Explained, Verdict::Fail);
    let gone = now.checks.remove(gone).key;
    assert_eq!(standings(&now), BTreeSet::from(["Fixed Unexplained".to_owned(), "New Pass".to_owned()]));
    assert_eq!(baseline.unseen(&now, |_| true), std::slice::from_ref(&gone));
    assert_eq!(baseline.unseen(&now, |key| key.kind == Kind::Promise), []);
    // What people read says all of it.
    let text = summary(&now, &baseline, &[gone]);
    for part in ["1 new flaw, 1 known, 1 fixed", "Error, a <case> & \"more\", fast: a known flaw that this run has not"]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let known = at(&now, "Fail");
    assert!(line(&now.checks[known..=known], &baseline).contains("known flaw"));
    assert!(line(&now.checks[fixed..=fixed], &baseline).contains("FIXED"));
    assert!(line(&former.checks[2..3], &Baseline::default()).contains("1 UNEXPLAINED"));
    assert!(line(&former.checks[2..3], &Baseline::default()).contains("worst t 9 > 1"));
    assert_eq!(Baseline::default().standing(&former.checks[2]), Standing::New);
}

#[test]
fn a_baseline_is_of_one_device_and_of_a_run_that_ended() {
    let (one, mut other) = (all_verdicts(), all_verdicts());
    other.device = "board".into();
    other.checks.clear();
    let both = read_again(&report(vec![one.clone(), other.clone()])).unwrap();
    assert_eq!(Baseline::of(&both, "board"), Ok(Baseline::default()));
    assert_ne!(Baseline::of(&both, "card"), Ok(Baseline::default()));
    assert_eq!(Baseline::of(&both, "third").unwrap_err(), "it has 2 devices, 0 of them called third");
    let lost = Run { lost: Some("gone".into()), ..one.clone() };
    for unfinished in [report(vec![lost]), Report { interrupted: true, ..report(vec![one]) }] {
        assert!(read_again(&unfinished).unwrap_err().contains("did not come to its end"));
    }
    assert!(Former::read("{}").unwrap_err().contains("no report"));
}

/// A parser of XML reads what was counted, and the texts with what XML does not have left out or escaped.
#[test]
fn junit_is_xml_that_counts_right() {
    let run = all_verdicts();
    let baseline = Baseline::of(&read_again(&report(vec![run.clone()])).unwrap(), "card").unwrap();
    let gone = check(Kind::Promise, "gone", "double", Verdict::Fail).key;
    let properties = [("commit".to_owned(), "c0ffee".to_owned())];
    let none = Baseline::default();
    let counts = |baseline: &Baseline, unseen: &[Key]| {
        let text = junit(&[(&run, baseline, unseen)], &properties).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        let all = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
        let suites: Vec<_> = document.descendants().filter(|node| node.has_tag_name("testsuite")).collect();
        for suite in &suites {
            let cases = suite.children().filter(|node| node.has_tag_name("testcase")).count();
            assert_eq!(suite.attribute("tests"), Some(cases.to_string().as_str()), "{text}");
            assert!(suite.descendants().any(|node| node.attribute("value") == Some("c0ffee")), "{text}");
            assert!(suite.attribute("time").unwrap().parse::<f64>().unwrap() >= 0.0, "{text}");
        }
        let root = document.root_element();
        let number = |name: &str| root.attribute(name).unwrap().parse::<usize>().unwrap();
        assert_eq!(
            (number("tests"), number("failures"), number("errors")),
            (all("testcase"), all("failure"), all("error"))
        );
        (suites.len(), all("testcase"), all("failure"), all("error"), all("skipped"), text)
    };
    let (suites, cases, failures, errors, skipped, text) = counts(&none, &[]);
    assert_eq!((suites, cases, failures, errors, skipped), (2, 12, 2, 1, 5));
    assert!(text.contains("worst t 9 &gt; 1") && !text.contains('\u{1}'), "{text}");
    // Known flaws are no failures, but those that were not looked at are.
    let (suites, cases, failures, errors, skipped, _) = counts(&baseline, &[gone]);
    assert_eq!((suites, cases, failures, errors, skipped), (3, 13, 1, 0, 8));
}

#[test]
fn two_runs_differ_where_rounding_does_not_explain_it() {
    use Verdict::{Error, Explained, Fail, NotCovered, Pass, Refused, Same, TooFew, Unexplained};
    let relation = |kind, a, b| {
        let [a, b] = [a, b].map(|verdict| run_of(vec![check(kind, "it", "fast", verdict)]));
        let pairs = diff(&a, &b);
        assert_eq!(pairs.len(), 1);
        assert!(diff_table(&pairs).contains("it"));
        pairs[0].relation
    };
    for (a, b, expected) in [
        (Same, Same, Relation::Same),
        (Unexplained, Unexplained, Relation::Same),
        (Error, Error, Relation::Same),
        (Same, Explained, Relation::Explained),
        (Explained, Unexplained, Relation::Unexplained),
        (Error, Same, Relation::Unexplained),
        (NotCovered, Explained, Relation::NotPromised),
        (NotCovered, Unexplained, Relation::Unexplained),
        (Refused, Same, Relation::OneSide),
    ] {
        assert_eq!(relation(Kind::Picture, a, b), expected, "{a:?}, {b:?}");
        assert_eq!(relation(Kind::Picture, b, a), expected, "{b:?}, {a:?}");
    }
    for (a, b, expected) in [
        (Pass, Pass, Relation::Same),
        (Fail, Fail, Relation::Same),
        (Pass, Fail, Relation::Broken),
        (Pass, TooFew, Relation::NotPromised),
        (Refused, Pass, Relation::OneSide),
    ] {
        assert_eq!(relation(Kind::Promise, a, b), expected, "{a:?}, {b:?}");
    }
    let (one, mut other) = (all_verdicts(), all_verdicts());
    other.checks[0].picture.as_mut().unwrap().scene_sha256 = "changed".into();
    let last = other.checks.pop().unwrap();
    other.checks.push(check(Kind::Promise, "new", "fast", Pass));
    let pairs = diff(&one, &other);
    assert_eq!((pairs.len(), pairs[0].relation), (13, Relation::OtherScene));
    assert!(
        pairs
            .iter()
            .filter(|pair| pair.relation == Relation::OneSide)
            .map(|pair| &pair.key.name)
            .eq([&last.key.name, "new"])
    );
    assert!(pairs.iter().all(|pair| !pair.relation.is_difference()));
}

fn trueray(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    command
}

#[track_caller]
fn assert_exit(output: &Output, code: i32, said: &str) {
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.code() == Some(code) && text.contains(said), "{code}, {said}: {:?}\n{text}", output.status);
}

#[test]
fn the_program_checks_compares_and_keeps_to_its_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let run = |arguments: &str| trueray(path, arguments).output().unwrap();
    assert_exit(&run("conform --list --only hard,power"), 0, "hard/needles");
    assert_exit(&run("conform --only soft"), 2, "there is no scene or class 'soft'");
    assert_exit(&run("conform --device cpu"), 2, "conform checks Vulkan devices");
    assert_exit(&run("conform --write scenes --only basic/one-row"), 0, "one-row.txt");
    assert_eq!(
        fs::read_to_string(path.join("scenes/basic/one-row.txt")).unwrap(),
        BuiltIn::named("basic/one-row").unwrap().text
    );
    let without = trueray(path, "conform --only power").env("VK_DRIVER_FILES", "/none").output().unwrap();
    assert_exit(&without, 4, "no Vulkan device");

    let Some(_gpu) = gpu("the_program_checks_compares_and_keeps_to_its_exit_codes") else { return };
    let few = "conform --count 64 --only basic/one-row,bit-patterns";
    assert_exit(&run(&format!("{few} --json a.json --junit a.xml")), 0, "0 new flaws, 0 known, 0 fixed");
    let mut json: serde_json::Value = serde_json::from_slice(&fs::read(path.join("a.json")).unwrap()).unwrap();
    assert!(["program", "build", "system", "cpu"].iter().all(|field| json[field].is_string()), "{json}");
    assert!(json["runs"][0]["device_info"]["vulkan"]["api_version"].is_string(), "{json}");
    let xml = fs::read_to_string(path.join("a.xml")).unwrap();
    assert!(roxmltree::Document::parse(&xml).unwrap().descendants().any(|node| node.has_tag_name("testcase")), "{xml}");
    // A known flaw that is none, and one that is out of sight.
    let first = &mut json["runs"][0]["checks"][0];
    first["verdict"] = "unexplained".into();
    fs::write(path.join("known.json"), json.to_string()).unwrap();
    assert_exit(&run(&format!("{few} --baseline known.json")), 1, "a known flaw that is none any more");
    assert_exit(&run("conform --count 64 --only bit-patterns --baseline known.json"), 0, "0 fixed");
    assert_exit(&run(&format!("{few} --baseline known.json --json known.json")), 6, "would overwrite");
    assert_exit(&run("conform --baseline scenes/basic/one-row.txt"), 2, "no report");
    assert_exit(&run("conform --diff a.json a.json"), 0, "same bytes");
    assert_exit(&run("conform --diff a.json known.json --json diff.json"), 0, "same bytes");
    let first = &mut json["runs"][0]["checks"][0];
    first["picture"]["sha256"] = "another".into();
    fs::write(path.join("wrong.json"), json.to_string()).unwrap();
    assert_exit(&run("conform --diff a.json wrong.json"), 1, "UNEXPLAINED");
    assert_exit(&run("conform --diff a.json"), 2, "compares two runs");
}

/// A driver that drops a copy without a word shows wrong pictures; one that is lost ends the run, and what was found is written.
#[test]
fn a_faulty_driver_is_found_out() {
    let Some(driver) = Driver::new("a_faulty_driver_is_found_out") else { return };
    let arguments = "conform --only effects/everything --json all.json --junit all.xml";
    let run = |fault: &str| {
        let output = driver.command(arguments, fault).output().unwrap();
        let read = |file: &str| fs::read_to_string(driver.work().join(file)).unwrap();
        let (json, xml): (serde_json::Value, _) = (serde_json::from_str(&read("all.json")).unwrap(), read("all.xml"));
        let document = roxmltree::Document::parse(&xml).unwrap();
        let count = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
        (output, json, count("failure"), count("error"))
    };
    let (output, _, failures, errors) = run("vkCmdCopyBufferToImage:2:drop");
    assert_exit(&output, 1, "unexplained");
    assert!(failures > 0 && errors == 0, "{failures}, {errors}");
    let (output, json, _, errors) = run("vkQueueSubmit:9:-4");
    assert_exit(&output, 5, "the device was lost");
    assert!(errors == 1 && json["runs"][0]["lost"].is_string(), "{json}");
}

/// Two devices on one scene; here they are one.
#[test]
fn a_scene_is_compared_on_two_devices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("scene.txt"), BuiltIn::named("effects/diffuse").unwrap().text).unwrap();
    let run = |arguments: &str| trueray(path, &format!("compare {arguments}")).output().unwrap();
    assert_exit(&run("--device gpu --device gpu a.ppm b.ppm"), 2, "--scene SCENE");
    assert_exit(&run("--device gpu --device cpu --device gpu --scene scene.txt"), 2, "two devices at most");
    let Some(_gpu) = gpu("a_scene_is_compared_on_two_devices") else { return };
    assert_exit(&run("--scene scene.txt --device cpu --device gpu"), 2, "--device cpu is the reference");
    let output = run("--scene scene.txt --device gpu --device 0 --precision fast --json --heatmap heat.png");
    assert_exit(&output, 0, "");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&json["verdict"], &json["pixels"]), (&"same".into(), &(160 * 120).into()), "{json}");
    assert!(["a", "b"].iter().all(|side| json[side]["explanation"]["unexplained"] == 0), "{json}");
    assert!(path.join("heat.png").exists());
    assert_exit(
        &run("--scene scene.txt --device gpu --device 0 --max-level 0"),
        0,
        "B beside the reference of scene.txt",
    );
}

/// The example of a workflow asks for what there is.
#[test]
fn the_workflow_is_understood() {
    let workflow = fs::read_to_string(root().join("examples/conform.yml")).unwrap();
    let commands: Vec<_> = workflow.lines().filter_map(|line| line.trim().strip_prefix("trueray ")).collect();
    assert!(commands.len() >= 2, "{workflow}");
    for command in commands.iter().filter_map(|command| command.split('>').next()) {
        assert_exit(&trueray(root(), &format!("{command} --help")).output().unwrap(), 0, "");
    }
}

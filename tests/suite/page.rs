//! The page's script against the messages of the server: it reads no field that is not there, and asks for nothing unknown.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json, to_value};
use trueray::effects::Effect;
use trueray::sampling::{Density, Fovea};
use trueray::viewer::{EffectTimes, PageMessage, PageRequest, SampledPart, SceneError};

use crate::view::{SCENE, Work};

fn text(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// A message of each kind, none of whose fields is absent, under the name that the scripts give it.
fn messages() -> BTreeMap<&'static str, Value> {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    let mut state = page.finish();
    page.send(r#"{"do":"pick","x":45,"y":35}"#);
    let pixel = page.until(|words| words["is"] == "pixel");
    let fovea = Some(Fovea { center: [1.0, 2.0], radius: 3.0, falloff: 4.0 });
    let sampled = SampledPart { pixels: 7, density: Density { fovea, far: 0.5 } };
    state["sampled"] = to_value(sampled).unwrap();
    state["error"] = to_value(SceneError { line: 9, text: "LAMP".into() }).unwrap();
    state["problem"] = "the depth is 1000 at the most".into();
    let cost = EffectTimes { effect: Effect::Shadows, with_ms: 2.0, without_ms: 1.0 };
    let told = |message: &PageMessage| to_value(message).unwrap();
    BTreeMap::from([
        ("row", state["effects"][0].clone()),
        ("before", state.clone()),
        ("state", state),
        ("table", pixel["table"].clone()),
        ("pixel", pixel),
        ("report", told(&PageMessage::Costs { effects: &[cost] })),
        ("cost", to_value(cost).unwrap()),
        ("measured", to_value(cost).unwrap()),
        ("lost", told(&PageMessage::Lost { why: "" })),
        ("failed", told(&PageMessage::Failed { why: "" })),
    ])
}

/// Paths such as `state.scene.file` that begin with `root`; what follows a number, text or list is JavaScript's own.
fn paths<'t>(script: &'t str, root: &str) -> Vec<Vec<&'t str>> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '$';
    let starts = script.match_indices(root).filter(|&(at, _)| {
        let before = script[..at].chars().next_back();
        !before
            .is_some_and(|c| is_word(c) || c == '-' || c == '\'' || (c == '.' && !script[..at].ends_with("trueray.")))
    });
    let path = |(at, _): (usize, &str)| {
        let mut rest = &script[at + root.len()..];
        let mut path = Vec::new();
        while let Some(tail) = rest.strip_prefix('.').or_else(|| rest.strip_prefix("?.")) {
            let end = tail.find(|c| !is_word(c)).unwrap_or(tail.len());
            path.push(&tail[..end]);
            rest = &tail[end..];
        }
        path
    };
    starts.map(path).filter(|path| path.first().is_some_and(|name| !name.is_empty())).collect()
}

#[test]
fn the_page_reads_only_what_it_is_told() {
    let messages = messages();
    let scripts = ["src/viewer/page.html", "tests/browser/page.test.js", "tests/browser/speed.js"].map(text);
    let mut read = Vec::new();
    for (root, message) in &messages {
        for path in scripts.iter().flat_map(|script| paths(script, root)) {
            let mut value = message;
            for name in &path {
                let Some(fields) = value.as_object() else { break };
                value = fields.get(*name).unwrap_or_else(|| panic!("no message has {root}.{}", path.join(".")));
            }
            read.push(format!("{root}.{}", path[0]));
        }
    }
    // And it is told nothing that it does not read.
    for (root, message) in messages.iter().filter(|(root, _)| !["before", "measured", "row"].contains(root)) {
        for field in message.as_object().unwrap().keys().filter(|field| !["is", "number"].contains(&field.as_str())) {
            let of_a_cost = *root == "cost" && read.contains(&format!("measured.{field}"));
            assert!(of_a_cost || read.contains(&format!("{root}.{field}")), "nobody reads {root}.{field}");
        }
    }
}

#[test]
fn the_page_asks_for_nothing_unknown() {
    let page = text("src/viewer/page.html");
    let requests: Vec<&str> = page.split("({ do: ").skip(1).map(|rest| rest.split_once(" })").unwrap().0).collect();
    assert!(requests.len() > 15, "{requests:?}");
    for request in requests {
        let mut fields = request.split(", ").map(|field| field.split_once(':').map_or(field, |(name, _)| name).trim());
        let name = fields.next().unwrap();
        // The two movements of a drag come from a list.
        let names = if name == "way" { vec!["orbit", "turn"] } else { vec![name.trim_matches('\'')] };
        for (name, field) in names.into_iter().flat_map(|name| fields.clone().map(move |field| (name, field))) {
            let error = serde_json::from_value::<PageRequest>(json!({ "do": name, field: null })).err();
            let error = error.map(|error| error.to_string()).unwrap_or_default();
            assert!(!error.contains("unknown"), "{name}, {field}: {error}");
        }
    }
}

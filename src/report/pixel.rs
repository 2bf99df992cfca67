//! The record of a pixel as a table for people.

use std::fmt::Write as _;

use crate::cpu::{
    HitRecord, LightRecord, Margin, PixelRecord, RayKind, RayRecord, SampleRecord, ShadowRecord, TestRecord, Verdict,
};
use crate::scene::{Names, Scene};
use crate::settings::Specular;
use crate::words::{count, number};

/// Tests of a ray that are listed at the most; those that hit come first.
const LISTED: usize = 12;

/// What a table takes from the scene and its settings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Labels<'a> {
    pub(crate) spheres: &'a Names,
    pub(crate) lights: &'a Names,
    /// Whose cosine the specular term is a power of.
    pub(crate) specular: Specular,
}

impl<'a> Labels<'a> {
    /// Of `scene`.
    pub(crate) fn of(scene: &'a Scene, specular: Specular) -> Self {
        Self { spheres: &scene.sphere_names, lights: &scene.light_names, specular }
    }

    fn sphere(&self, index: usize) -> String {
        label(self.spheres, "sphere", index)
    }

    fn light(&self, index: usize) -> String {
        label(self.lights, "light", index)
    }
}

/// `sphere 'moon' (3)`; without a label `sphere 3`.
fn label(names: &Names, noun: &str, index: usize) -> String {
    let words = names.in_words(noun, index);
    if names.get(index).is_empty() { words } else { format!("{words} ({index})") }
}

/// `1, 0.5, -2`.
pub(crate) fn numbers(values: &[f64]) -> String {
    // Without the sign of 0.
    values.iter().map(|&value| number(value + 0.0)).collect::<Vec<_>>().join(", ")
}

/// All rays of a pixel, then its colour and what decides it.
pub(crate) fn pixel_table(record: &PixelRecord, labels: Labels) -> String {
    let mut text = String::new();
    for (index, sample) in record.samples.iter().enumerate() {
        if record.samples.len() > 1 {
            let [column, row] = sample.sample;
            let _ = writeln!(text, "sample {index}          sample column {column}, sample row {row}");
        }
        push_sample(&mut text, sample, labels);
    }
    if record.samples.len() > 1 {
        row(&mut text, "colour", &format!("{}: the mean of the samples", numbers(&record.color)));
    }
    let [red, green, blue] = record.levels;
    row(&mut text, "levels", &format!("{red}, {green}, {blue}: {} without their fractions", numbers(&record.scaled)));
    if record.more_bits {
        let (by, open) =
            if record.most_bits { ("237 bits", " and double-double leave") } else { ("double-double", " leaves") };
        row(&mut text, "decided by", &format!("{by}: f64{open} a decision open"));
        if record.undecided {
            row(&mut text, "open", "one is a tie, which goes by rule, or too many bounces away for 237 bits");
        }
    }
    text += "decisions         nearest first, by the change that turns them\n";
    for margin in &record.decisions {
        let _ = writeln!(text, "  {}", decision(margin, labels));
    }
    if record.decisions.is_empty() {
        text += "  none: the background is a constant of the scene\n";
    }
    text
}

fn row(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "{name:<17} {value}");
}

fn push_sample(text: &mut String, sample: &SampleRecord, labels: Labels) {
    for (index, ray) in sample.rays.iter().enumerate() {
        push_ray(text, index, ray, labels);
    }
    let parts = if sample.rays.len() > 1 {
        format!(": the sum of {}", count(sample.rays.len() as u64, "ray"))
    } else {
        String::new()
    };
    row(text, "colour", &format!("{}{parts}", numbers(&sample.color)));
}

fn push_ray(text: &mut String, index: usize, ray: &RayRecord, labels: Labels) {
    let kind = match ray.kind {
        RayKind::Primary => "primary",
        RayKind::Reflection => "reflected",
        RayKind::Refraction => "refracted",
        RayKind::TotalReflection => "refracted, reflected in total",
    };
    let from = ray.parent.map(|parent| format!(" where ray {parent} ends")).unwrap_or_default();
    row(text, &format!("ray {index}"), &format!("{kind}{from}, weight {}", number(ray.weight)));
    row(text, "  origin", &numbers(&ray.origin));
    row(text, "  direction", &numbers(&ray.direction));
    row(text, "  tests", &tests_head(ray.test_count, ray.t_min, "beyond"));
    push_tests(text, &ray.tests, labels);
    match &ray.hit {
        Some(hit) => push_hit(text, ray, hit, labels),
        None if ray.background.is_some() => row(text, "  hit", "nothing: the background"),
        None => row(text, "  hit", "nothing: black, since it was mirrored"),
    }
    let weighted = if ray.weight == 1.0 { String::new() } else { format!(", weighted {}", numbers(&ray.contribution)) };
    row(text, "  colour", &format!("{}{weighted}", numbers(&ray.color)));
    for (index, margin) in ray.decisions.iter().enumerate() {
        row(text, if index == 0 { "  margins" } else { "" }, &decision(margin, labels));
    }
}

fn tests_head(tests: u64, t_min: f64, beyond: &str) -> String {
    format!("{}; roots count {beyond} t {}", count(tests, "test"), number(t_min))
}

/// A line a test, in columns.
fn push_tests(text: &mut String, tests: &[TestRecord], labels: Labels) {
    let misses = |test: &&TestRecord| test.verdict == Verdict::Missed;
    let listed = tests.iter().filter(|test| !misses(test)).chain(tests.iter().filter(misses)).take(LISTED);
    let head = ["sphere", "A", "B", "C", "discriminant", "lesser root", "greater root", "verdict"].map(str::to_owned);
    let lines: Vec<[String; 8]> = std::iter::once(head).chain(listed.map(|test| test_line(test, labels))).collect();
    if lines.len() == 1 {
        return;
    }
    let widths: [usize; 8] =
        std::array::from_fn(|column| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0));
    for line in &lines {
        let cells = line.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}"));
        let _ = writeln!(text, "    {}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    if tests.len() > LISTED {
        let _ = writeln!(text, "    and {} more", tests.len() - LISTED);
    }
}

fn test_line(test: &TestRecord, labels: Labels) -> [String; 8] {
    let TestRecord { sphere, a, b, c, discriminant, roots, verdict } = *test;
    let [lesser, greater] = roots.map_or_else(|| ["-".into(), "-".into()], |roots| roots.map(number));
    let words = match verdict {
        Verdict::LesserTaken => "taken: the least root that counts",
        Verdict::GreaterTaken => "taken: the greater root, since the lesser is too near",
        Verdict::Missed => "missed",
        Verdict::TooNear => "no root is far enough",
        Verdict::Behind => "behind the hit",
        Verdict::Tied => "at the same t, and a lower index wins",
        Verdict::Left => "left from outside, never met again",
        Verdict::Blocks => "blocks",
        Verdict::Passed => "does not block: no root between the ends",
    };
    [labels.sphere(sphere), number(a), number(b), number(c), number(discriminant), lesser, greater, words.into()]
}

fn push_hit(text: &mut String, ray: &RayRecord, hit: &HitRecord, labels: Labels) {
    let side = if hit.inside { "from inside" } else { "from outside" };
    row(text, "  hit", &format!("{} {side} at t {}", labels.sphere(hit.sphere), number(hit.t)));
    row(text, "  position", &numbers(&hit.position));
    row(text, "  normal", &numbers(&hit.normal));
    row(text, "  view", &numbers(&hit.view));
    row(text, "  ambient", &numbers(&hit.ambient));
    for light in &hit.lights {
        push_light(text, light, labels);
    }
    if let Some(snell) = &hit.refraction {
        let total = if snell.total { "all light is reflected" } else { "refracted" };
        let [ratio, cosine, square] = [snell.ratio, snell.cosine, snell.square].map(number);
        row(text, "  refraction", &format!("ratio {ratio}, cosine {cosine}, squared cosine behind {square}: {total}"));
    }
    debug_assert!(ray.background.is_none());
}

fn push_light(text: &mut String, light: &LightRecord, labels: Labels) {
    let state = match &light.shadow {
        Some(ShadowRecord { blocked: true, .. }) => "blocked",
        _ if light.lit => "lights",
        _ => "behind the surface",
    };
    row(text, "  light", &format!("{}: N·L {}, {state}", labels.light(light.light), number(light.n_dot_l)));
    if let Some(shadow) = &light.shadow {
        row(text, "    shadow ray", &format!("from {}", numbers(&shadow.origin)));
        row(text, "", &format!("to the light {}", numbers(&shadow.direction)));
        row(text, "    tests", &count(shadow.test_count, "test"));
        push_tests(text, &shadow.tests, labels);
        if let Some(blocker) = &shadow.blocker {
            let (sphere, t) = (labels.sphere(blocker.sphere), number(blocker.t));
            row(text, "    blocked by", &format!("{sphere} at t {t}, {}", numbers(&blocker.position)));
        }
    }
    if let Some(cosine) = light.specular_cosine {
        row(text, "    diffuse", &numbers(&light.diffuse));
        let name = match labels.specular {
            Specular::Phong => "R·V",
            Specular::Blinn => "N·H",
        };
        row(text, "    specular", &format!("{}, of {name} {}", numbers(&light.specular), number(cosine)));
    }
}

fn decision(margin: &Margin, labels: Labels) -> String {
    let mut words = format!("{:<28} {:<22} ", margin.decision.name(), number(margin.margin));
    let places = [
        margin.sample.map(|sample| format!("sample {sample}")),
        margin.ray.map(|ray| format!("ray {ray}")),
        margin.sphere.map(|sphere| labels.sphere(sphere)),
        margin.light.map(|light| labels.light(light)),
    ];
    words += &places.into_iter().flatten().collect::<Vec<_>>().join(", ");
    words.trim_end().to_owned()
}

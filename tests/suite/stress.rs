//! The hard cases at reduced counts: promises hold, and what lacks their care breaks them.

use trueray::gpu::Kernel;
use trueray::precision::Tier;
use trueray::stress::{Class, Row, Verdict, classes, run, table};

use crate::support::{gpu, say_skipped};

const COUNT: usize = 20_000;
const SEED: u64 = 1;

fn broken(rows: &[Row]) -> Vec<Row> {
    rows.iter().filter(|row| row.is_broken()).cloned().collect()
}

fn named(names: &[&str]) -> Vec<Class> {
    classes().into_iter().filter(|class| names.contains(&class.name)).collect()
}

#[test]
fn classes_are_numbered_as_in_the_catalogue() {
    let numbers: Vec<_> = classes().iter().map(|class| class.id).collect();
    assert_eq!(numbers, (1..=23).collect::<Vec<_>>());
}

#[test]
fn every_tier_keeps_its_promises() {
    let Some(gpu) = gpu("every_tier_keeps_its_promises") else { return };
    let rows = run(&gpu, &Tier::ALL.map(Kernel::Tier), &classes(), COUNT, SEED, |_| {}).unwrap();
    for row in &rows {
        if let Verdict::Refused(why) = &row.verdict {
            say_skipped(&format!("{} at {}", row.class, row.kernel), why);
        }
    }
    let broken = broken(&rows);
    assert!(broken.is_empty(), "\n{}", table(&broken));
}

#[test]
fn the_schoolbook_formula_breaks_promises() {
    let Some(gpu) = gpu("the_schoolbook_formula_breaks_promises") else { return };
    let rows = run(&gpu, &[Kernel::Schoolbook], &named(&["ordinary", "far", "tangent", "thin"]), COUNT, SEED, |_| {});
    let rows = rows.unwrap();
    for class in ["ordinary", "far", "tangent", "thin"] {
        assert!(rows.iter().any(|row| row.class == class && row.is_broken()), "{class}:\n{}", table(&rows));
    }
    // From 1e7 radii almost half of all rays are wrong.
    let far = rows.iter().find(|row| row.case == "any origin 1e7").unwrap();
    assert!(far.metrics.per_million(far.metrics.wrong()) > 2e5, "\n{}", table(&rows));
}

/// Where the driver keeps error-free transforms by itself there is nothing to show.
#[test]
fn without_barriers_promises_break() {
    let Some(gpu) = gpu("without_barriers_promises_break") else { return };
    let rows = run(&gpu, &[Kernel::NoBarrier], &named(&["transforms"]), COUNT, SEED, |_| {}).unwrap();
    if rows.iter().all(|row| row.metrics.differing == Some(0)) {
        say_skipped("without_barriers_promises_break", "the device keeps error-free transforms as they are");
        return;
    }
    let rows =
        run(&gpu, &[Kernel::NoBarrier], &named(&["far", "earth", "near-surface", "tangent"]), COUNT, SEED, |_| {});
    let rows = rows.unwrap();
    for class in ["far", "earth", "near-surface", "tangent"] {
        assert!(rows.iter().any(|row| row.class == class && row.is_broken()), "{class}:\n{}", table(&rows));
    }
}

#[test]
fn the_same_seed_gives_the_same_numbers() {
    let Some(gpu) = gpu("the_same_seed_gives_the_same_numbers") else { return };
    let metrics = |seed| {
        let rows =
            run(&gpu, &[Kernel::Tier(Tier::Fast)], &named(&["secondary", "contact"]), 2000, seed, |_| {}).unwrap();
        rows.into_iter().map(|row| row.metrics).collect::<Vec<_>>()
    };
    assert_eq!(metrics(3), metrics(3));
    assert_ne!(metrics(3), metrics(4));
}

/// A few rays by hand through the batch path.
#[test]
fn batches_find_the_nearest_hit() {
    use glam::DVec3;
    use trueray::gpu::{Batch, ProbeRay, Prober, Question, Surface};

    let Some(gpu) = gpu("batches_find_the_nearest_hit") else { return };
    let at = |z| Surface { center: DVec3::new(0.0, 0.0, z), scale: DVec3::ONE };
    let ray = |z, first, end| ProbeRay {
        origin: DVec3::new(0.0, 0.0, z),
        direction: DVec3::NEG_Z,
        first,
        end,
        primary: false,
        own: None,
    };
    let batch = Batch {
        rays: vec![ray(0.0, 0, 3), ray(0.0, 0, 1), ray(-5.0, 1, 2), ray(-5.0, 2, 2), ray(-7.0, 0, 2)],
        surfaces: vec![at(-9.0), at(-5.0), at(-20.0)],
        ..Batch::default()
    };
    for tier in Tier::ALL {
        let Ok(mut prober) = Prober::new(&gpu, Kernel::Tier(tier)) else { continue };
        let answers = prober.ask(Question::Nearest, &batch).unwrap();
        let found: Vec<_> = answers.iter().map(|a| a.found.then_some((a.value, a.surface, a.inside))).collect();
        let expected =
            [Some((4.0, 1, false)), Some((8.0, 0, false)), Some((1.0, 1, true)), None, Some((1.0, 0, false))];
        assert_eq!(found, expected, "{tier}");
        let blocked: Vec<_> =
            prober.ask(Question::Blocked, &batch).unwrap().iter().map(|answer| answer.blocked).collect();
        assert_eq!(blocked, [false; 5], "{tier}");
    }
}

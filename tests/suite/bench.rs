//! How fast: the built-in scenes, the fit, and what `trueray bench` writes.

use std::process::{Command, Output, Stdio};

use glam::DVec3;
use trueray::bench::{
    Axis, Bench, BenchPlan, FAMILIES, Family, PHASES, RenderSetup, Renderer, bench, csv, csv_columns, growth_exponent,
    html,
};
use trueray::cpu::Reference;
use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::gpu::Gpu;
use trueray::precision::{self, Selection, Tier};
use trueray::scene::{Scene, parse};
use trueray::settings::Settings;

use crate::support::gpu;

fn family(name: &str) -> &'static Family {
    Family::named(name).unwrap()
}

/// FNV-1a.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn scenes_are_the_same_for_ever() {
    let fingerprints = [
        ("classic", 5, 0x3bfb_c371_22dc_12d4),
        ("spheres", 1000, 0x3608_80c5_9f0c_5ad0),
        ("ellipsoids", 1000, 0x90e3_65f3_4767_297b),
        ("mirrors", 1000, 0xf34a_8d8e_a458_a5c8),
        ("lights", 16, 0x4a71_287d_772a_c716),
        ("clustered", 1000, 0x8b95_0a2d_a8ed_5bea),
        ("huge", 1000, 0x5f13_67bd_4108_b833),
        ("dome", 16, 0x3be4_bc7c_2136_21b5),
        ("glass", 1000, 0xb2ba_b9a9_2575_b802),
    ];
    let found = fingerprints.map(|(name, size, _)| (name, size, hash(&family(name).scene(size).to_string())));
    assert_eq!(found, fingerprints);
    assert_eq!(FAMILIES.len(), fingerprints.len());
}

#[test]
fn scenes_are_files_without_a_warning() {
    for family in &FAMILIES {
        for &size in family.sizes.iter().filter(|size| **size <= 1000) {
            let scene = family.scene(size);
            let parsed = parse(family.name, scene.to_string().as_bytes());
            assert_eq!((parsed.errors, parsed.warnings), (0, 0), "{}", parsed.report(false));
            assert_eq!(parsed.scene.unwrap(), scene);
            assert_eq!(scene.spheres.len(), family.spheres(size));
            assert!(scene.spheres.iter().all(|s| s.center.z + s.scale.z < -1.0), "{} {size}", family.name);
            let counted = match family.axis {
                Axis::Spheres => scene.spheres.len(),
                Axis::Lights => scene.lights.len(),
            };
            assert_eq!(counted, size);
        }
        assert!(family.sizes.is_sorted());
    }
}

/// The part of the pixels that show a sphere.
fn coverage(mut scene: Scene) -> f64 {
    (scene.width, scene.height, scene.background) = (192, 108, DVec3::ONE);
    let settings = Settings::exact();
    // Black bodies in their true shapes.
    let shapes = EffectSet::NONE.with(Effect::Ellipsoids, true);
    let nothing = Effects::requested(&scene.viewed(&settings), &Request::Exactly(shapes));
    let mut rgb = vec![0; 192 * 108 * 3];
    Reference::<f64>::new(&scene.viewed(&settings), &nothing).rows(0, &mut rgb).unwrap();
    let covered = rgb.chunks_exact(3).filter(|pixel| **pixel == [0, 0, 0]).count();
    covered as f64 / (192 * 108) as f64
}

#[test]
fn random_spheres_cover_about_sixty_percent() {
    for name in ["spheres", "ellipsoids", "mirrors"] {
        let parts = [100, 1000].map(|size| coverage(family(name).scene(size)));
        assert!(parts.iter().all(|part| (0.55..0.67).contains(part)), "{name}: {parts:?}");
    }
}

#[test]
fn random_spheres_have_the_promised_statistics() {
    let scene = family("spheres").scene(10_000);
    let mirrors = scene.spheres.iter().filter(|s| s.kr == 0.3).count();
    assert_eq!((mirrors, scene.lights.len()), (5000, 3));
    assert_eq!((scene.width, scene.height), (1920, 1080));
    let mut inverse_cubes = 0.0;
    for sphere in &scene.spheres {
        let depth = -sphere.center.z;
        assert!((15.0..=30.0).contains(&depth));
        assert!(sphere.center.x.abs() <= depth * 16.0 / 9.0 + 1e-4 && sphere.center.y.abs() <= depth + 1e-4);
        inverse_cubes += depth.powi(-3);
    }
    // Uniform in a frustum: the mean of 1/z³ is 3 ln(30/15)/(30³ − 15³).
    let expected = 3.0 * 2.0_f64.ln() / (27_000.0 - 3375.0);
    assert!((inverse_cubes / 10_000.0 / expected - 1.0).abs() < 0.03, "{inverse_cubes}");
    let radii: Vec<_> = scene.spheres.iter().map(|s| s.scale.x).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    assert!(radii.iter().all(|radius| (0.68..1.32).contains(&(radius / mean))));
}

#[test]
fn families_differ_in_what_they_say() {
    let spheres = family("spheres").scene(1000);
    let ellipsoids = family("ellipsoids").scene(1000);
    let mirrors = family("mirrors").scene(1000);
    for ((a, b), c) in spheres.spheres.iter().zip(&ellipsoids.spheres).zip(&mirrors.spheres) {
        assert_eq!((a.center, a.color), (b.center, b.color));
        assert_eq!((a.center, a.scale, c.kr), (c.center, c.scale, 0.8));
        assert!(a.scale == DVec3::splat(a.scale.x) && b.scale != DVec3::splat(b.scale.x));
    }
    let huge = family("huge").scene(1000);
    assert_eq!(huge.spheres.iter().filter(|s| s.scale.x == 5.0).count(), 1);
    assert_eq!(huge.spheres.iter().zip(&spheres.spheres).filter(|(a, b)| a != b).count(), 1);
    let lights = [1, 64].map(|size| family("lights").scene(size));
    assert_eq!(lights[0].spheres, lights[1].spheres);
    // In a cluster every twentieth sphere has a neighbour nearer than any of the room's spheres have on the average.
    let clustered = family("clustered").scene(1000);
    let around = |scene: &Scene, k: usize| {
        let own: Vec<_> = scene.spheres.iter().skip(k).step_by(20).map(|s| s.center).collect();
        let middle = own.iter().sum::<DVec3>() / own.len() as f64;
        own.iter().map(|center| center.distance(middle)).sum::<f64>() / own.len() as f64
    };
    let mean = |scene: &Scene| (0..20).map(|k| around(scene, k)).sum::<f64>() / 20.0;
    assert!(mean(&clustered) < mean(&spheres) / 5.0, "{} {}", mean(&clustered), mean(&spheres));
}

#[test]
fn exponents_of_known_laws() {
    for exponent in [0.0, 0.5, 1.0, 2.0] {
        let points = [10.0, 100.0, 1000.0].map(|n: f64| (n, 3.0 * n.powf(exponent)));
        assert!((growth_exponent(&points).unwrap() - exponent).abs() < 1e-12);
    }
    // Least squares: the middle point, twice as high, changes the height and not the slope.
    let bent = growth_exponent(&[(1.0, 1.0), (10.0, 20.0), (100.0, 100.0)]).unwrap();
    assert!((bent - 1.0).abs() < 1e-12);
    for points in [&[][..], &[(10.0, 1.0)], &[(10.0, 1.0), (10.0, 2.0)], &[(10.0, 1.0), (100.0, 0.0)]] {
        assert_eq!(growth_exponent(points), None);
    }
}

fn measure(gpu: Option<&Gpu>, families: &[&str], seconds: f64) -> Bench {
    let settings = Settings::classic();
    let setup = RenderSetup {
        gpu,
        settings: &settings,
        resolution: Some((32, 18)),
        effects: &Effects::of,
        selection: &|viewed, effects| Selection::of(viewed, effects, precision::Request::Auto, &Tier::ALL),
    };
    let families = families.iter().map(|name| family(name)).collect();
    let plan = BenchPlan { families, max_spheres: 100, runs: 2, seconds, cpu: true };
    let mut scenes = 0;
    let result = bench(&setup, &plan, |_, _, _| scenes += 1).unwrap();
    assert_eq!(scenes, result.families.iter().map(|family| family.scenes.len()).sum::<usize>());
    result
}

#[test]
fn every_scene_and_phase_is_measured_on_both() {
    let Some(gpu) = gpu("every_scene_and_phase_is_measured_on_both") else { return };
    let result = measure(Some(&gpu), &["spheres"], 600.0);
    let family = &result.families[0];
    assert_eq!(family.scenes.iter().map(|scene| scene.size).collect::<Vec<_>>(), [10, 100]);
    assert_eq!(family.growth.len(), 2);
    for scene in &family.scenes {
        let renderers: Vec<_> = scene.measured.iter().map(|measured| measured.renderer).collect();
        assert_eq!(renderers, [Renderer::Device, Renderer::Cpu]);
        assert!(scene.skipped.is_empty() && scene.tier.is_some());
        assert!(scene.differing.unwrap() < 32 * 18 / 10);
        for measured in &scene.measured {
            assert_eq!(measured.picture.runs().len(), 2);
            assert_eq!(measured.phases.len(), PHASES.len());
            assert!(measured.phases.iter().all(|phase| phase.times.runs().len() == 2));
            assert!(measured.rays.primary > 0 && measured.rays.shadow > 0 && measured.rays.reflection > 0);
            assert!(measured.rays_per_second > 0.0);
        }
    }
}

#[test]
fn what_takes_too_long_is_skipped_and_said_to_be() {
    let result = measure(None, &["spheres"], 0.0);
    let scenes = &result.families[0].scenes;
    // The first size is tried, the next one forecast.
    assert!(
        scenes[0].skipped[0].reason.contains("2 runs would exceed the budget of 0 s"),
        "{}",
        scenes[0].skipped[0].reason
    );
    assert!(scenes[1].skipped[0].reason.contains("2 runs would take about"), "{}", scenes[1].skipped[0].reason);
    assert!(scenes.iter().all(|scene| scene.measured.is_empty()) && result.families[0].growth.is_empty());
    assert!(
        csv(&result).contains("2 runs would take about")
            && html(&result, "trueray").contains("2 runs would take about")
    );
}

#[test]
fn files_are_well_formed() {
    let result = measure(None, &["classic", "spheres"], 600.0);
    let table = csv(&result);
    let lines: Vec<_> = table.lines().collect();
    assert_eq!(lines[0], csv_columns().join(","));
    assert_eq!(lines.len(), 1 + 3);
    for line in &lines {
        assert_eq!(line.matches(',').count() + 1, csv_columns().len(), "{line}"); // nothing here needs quotes
    }
    let json: serde_json::Value = serde_json::to_value(&result).unwrap();
    assert_eq!(json["families"][1]["scenes"][1]["measured"][0]["phases"][0]["name"], "prepare");
    let page = html(&result, "trueray bench 'a <b>'");
    // One scene makes no plot.
    assert_eq!((page.matches("<svg").count(), page.matches("</svg>").count()), (2, 2));
    assert!(page.contains("a &lt;b&gt;") && page.contains("size^"));
    for foreign in ["http:", "https:", "//", "src=", "href=", "url(", "@import", "<script", "NaN"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

fn run(arguments: &str, folder: &std::path::Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn the_program_measures_lists_and_writes() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str, code: i32| {
        let output = run(arguments, folder.path());
        assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (list, _) = run("bench --list", 0);
    assert!(FAMILIES.iter().all(|family| list.contains(family.name) && list.contains(family.summary)));

    let small = "--device cpu --res 32x18 --max-spheres 100 --runs 1";
    let (table, _) = run(&format!("bench --families spheres {small} --report r.html --json r.json"), 0);
    assert!(table.contains("spheres-100") && table.contains("time grows as size^"), "{table}");
    assert!(
        std::fs::read_to_string(folder.path().join("r.html")).unwrap().contains("trueray bench --families spheres")
    );
    let json = std::fs::read_to_string(folder.path().join("r.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["bench"]["families"][0]["scenes"][0]["spheres"], 10);
    let (records, _) = run(&format!("bench --families classic {small} --csv -"), 0);
    assert!(records.starts_with("family,size,axis,"));

    run("bench --families spheres,huge --max-spheres 10 --res 40x30 --write scenes", 0);
    for name in ["spheres-10.txt", "huge-10.txt"] {
        let text = std::fs::read(folder.path().join("scenes").join(name)).unwrap();
        let scene = parse(name, &text).scene.unwrap();
        assert_eq!((scene.spheres.len(), scene.width, scene.height), (10, 40, 30));
    }

    let (_, why) = run("bench --families rings", 2);
    assert!(why.contains("there are classic, spheres"), "{why}");

    // Beside an earlier run: as fast as it is, and beside one that took a millionth of the time: runs this short may take a
    // hundred times as long as others.
    let baseline = std::fs::read_to_string(folder.path().join("r.json")).unwrap();
    let mut former: serde_json::Value = serde_json::from_str(&baseline).unwrap();
    for scene in former["bench"]["families"][0]["scenes"].as_array_mut().unwrap() {
        let runs = scene["measured"][0]["picture"]["runs"].as_array_mut().unwrap();
        for run in runs {
            *run = (run.as_f64().unwrap() / 1e6).into();
        }
    }
    std::fs::write(folder.path().join("fast.json"), former.to_string()).unwrap();
    let (table, _) = run(&format!("bench --families spheres {small} --baseline r.json --fail-slower 10000%"), 0);
    assert!(table.contains("95 % interval") && table.contains("as before"), "{table}");
    let (table, _) = run(&format!("bench --families spheres {small} --baseline fast.json"), 0);
    assert!(table.contains("  slower"), "{table}");
    run(&format!("bench --families spheres {small} --baseline fast.json --fail-slower 5 --json both.json"), 1);
    let both = std::fs::read_to_string(folder.path().join("both.json")).unwrap();
    let both: serde_json::Value = serde_json::from_str(&both).unwrap();
    assert!(both["comparison"]["rows"][1]["ratio"].as_f64().unwrap() > 5.0);
    // What is not measured any more is no success.
    let hurried = format!("bench --families spheres {small} --seconds 0 --baseline r.json --fail-slower 10000");
    let (table, _) = run(&hurried, 1);
    assert!(table.contains("spheres-10 on CPU: measured then, skipped now"), "{table}");
    let (table, _) =
        run("bench --families spheres --device cpu --res 32x18 --runs 1 --max-spheres 10 --baseline r.json", 0);
    assert!(table.contains("measured then and not now: spheres-100"), "{table}");
    for (arguments, why) in [
        ("--families classic --baseline r.json", "none of the scenes"),
        ("--families spheres --max-depth 1 --baseline r.json", "other conventions, samples or depth"),
        ("--families spheres --baseline scenes/huge-10.txt", "not what `trueray bench --json` writes"),
        ("--families spheres --baseline none.json", "none.json"),
        ("--families spheres --baseline r.json --fail-slower fast", "percent"),
        ("--families spheres --fail-slower 5", "--baseline"),
    ] {
        let (_, said) = run(&format!("bench {small} {arguments}"), 2);
        assert!(said.contains(why), "{arguments}: {said}");
    }
    run(&format!("bench --families spheres {small} --baseline r.json --json r.json"), 6);

    run("bench --runs 0", 2);
    run("bench --report nowhere/r.html", 6);
    run("bench --families classic --write r.html", 6);
}

//! What accuracy costs: statistics, the study's data and its report.

use std::process::{Command, Output, Stdio};

use trueray::effects::{Effect, Effects};
use trueray::gpu::Gpu;
use trueray::pattern::Pattern;
use trueray::precision::{Request, Selection, Tier};
use trueray::sampling::Fill;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::study::{
    COLUMNS, Contestant, Distance, Manner, Study, StudyInput, StudyPlan, Timings, csv, hard_cases, html, study,
};

use crate::support::{gpu, scene_of};

fn sample(runs: &[f64]) -> Timings {
    let mut sample = Timings::default();
    for run in runs {
        sample.push(*run);
    }
    sample
}

#[test]
fn statistics_of_known_numbers() {
    let odd = sample(&[5.0, 1.0, 3.0]);
    assert_eq!((odd.median(), odd.min(), odd.max(), odd.outliers()), (3.0, 1.0, 5.0, 0));
    assert_eq!(odd.runs(), [5.0, 1.0, 3.0]);
    assert_eq!(sample(&[4.0, 1.0, 2.0, 3.0]).median(), 2.5);
    assert_eq!(sample(&[4.0, 1.0, 2.0]).spread(), 1.5);
    assert_eq!(sample(&[7.0]).median(), 7.0);
    assert!(sample(&[]).median().is_nan());
    // Quartiles 2 and 4, fences at −1 and 7.
    assert_eq!(sample(&[1.0, 2.0, 3.0, 4.0, 7.0]).outliers(), 0);
    assert_eq!(sample(&[1.0, 2.0, 3.0, 4.0, 7.1]).outliers(), 1);
    assert_eq!(sample(&[-1.1, 2.0, 3.0, 4.0, 4.0]).outliers(), 1);
}

#[test]
fn distance_of_known_pictures() {
    let a = [10, 20, 30, 0, 0, 0];
    let distance = Distance::between(&a, &[13, 20, 26, 0, 0, 0]);
    assert_eq!((distance.differing, distance.max_level, distance.rms_linear), (1, 4, None));
    assert!((distance.mean_level - 7.0 / 6.0).abs() < 1e-12);
    assert!((distance.rms_level - (25.0_f64 / 6.0).sqrt()).abs() < 1e-12);
    let same = Distance::between(&a, &a);
    assert_eq!((same.differing, same.max_level, same.mean_level, same.rms_level), (0, 0, 0.0, 0.0));
}

fn tiny() -> Scene {
    let mut scene = scene_of(
        "SPHERE a -0.6 0 -4 1 1 1 1 0.5 0.2 0.1 0.6 0.3 0.5 20\nSPHERE b 1 0.2 -3.5 0.6 0.6 0.6 0.2 0.5 1 0.1 0.6 0.3 0.5 20\n\
         LIGHT l 3 4 1 1 1 1\nAMBIENT 1 1 1\nBACK 0.1 0.2 0.3",
    );
    (scene.width, scene.height) = (24, 24);
    scene
}

fn measure(scene: &Scene, gpu: Option<&Gpu>, settings: &Settings) -> Study {
    let viewed = scene.viewed(settings);
    let selection = Selection::of(&viewed, &Effects::of(&viewed), Request::Auto, &Tier::ALL);
    let input =
        StudyInput { name: "tiny, <scene>", scene, settings, effects: &Effects::of, gpu, selection: &selection };
    study(
        &input,
        &StudyPlan {
            runs: 1,
            seconds: 0.0,
            depths: Vec::new(),
            patterns: vec![Pattern::ONE, Pattern::Grid { side: 2 }],
        },
        |_| (),
    )
    .unwrap()
}

#[test]
fn a_study_has_every_point_and_its_errors_shrink() {
    let Some(gpu) = gpu("a_study_has_every_point_and_its_errors_shrink") else { return };
    let study = measure(&tiny(), Some(&gpu), &Settings::exact());
    let expected: Vec<_> = Contestant::ALL.into_iter().map(Contestant::name).collect();
    let names: Vec<_> = study.precision.points.iter().map(|point| point.contestant.name()).collect();
    assert_eq!(names, expected);
    assert_eq!(study.skipped.len(), Contestant::ALL.len() - expected.len());

    let varied = expected.len() - 2; // without certified and CPU f32
    let certified = study.precision.points.iter().find(|point| point.contestant == Contestant::Certified).unwrap();
    assert_eq!(certified.error.differing, 0);
    assert_eq!(study.depth.points.len(), varied * 4);
    assert_eq!(study.samples.points.len(), varied * 2);
    for series in [&study.precision, &study.depth, &study.samples] {
        for point in &series.points {
            assert_eq!((point.wall.runs().len(), point.not_finite, point.unexplained), (1, 0, 0));
            assert!(point.wall.median() > 0.0);
            let on_cpu = point.contestant.name().starts_with("CPU");
            assert_eq!(point.error.rms_linear.is_some(), on_cpu);
        }
    }
    for series in [&study.depth, &study.samples] {
        let errors: Vec<_> = series
            .points
            .iter()
            .filter(|point| point.contestant == Contestant::CpuDouble)
            .map(|point| {
                assert_eq!(point.error.differing, 0);
                point.from_truth.unwrap().rms_linear.unwrap()
            })
            .collect();
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    }
    assert_eq!(study.effect_cost.variants.len(), 2 + Effect::ALL.len());
    let report = study.report();
    assert!(report.contains("Reflection depth") && report.contains("What each effect costs"), "{report}");
}

/// The full picture is first; many samples err less than few; the fovea is always exact; every time is there.
#[test]
fn a_study_says_what_samples_of_a_part_of_the_pixels_cost() {
    let Some(gpu) = gpu("a_study_says_what_samples_of_a_part_of_the_pixels_cost") else { return };
    let mut scene = tiny();
    (scene.width, scene.height) = (120, 90);
    for device in [None, Some(&*gpu)] {
        let series = measure(&scene, device, &Settings::classic()).partial;
        assert_eq!(series.points.len(), 1 + 2 * 4 * 2);
        assert_eq!((series.points[0].manner, series.points[0].pixels), (Manner::Full, 120 * 90));
        for point in &series.points {
            assert_eq!((point.wall.runs().len(), point.rays.runs().len()), (series.runs, series.runs));
            assert!(point.wall.median() >= point.rays.median() && point.rays.median() > 0.0);
            let is_exact = point.manner == Manner::Full;
            assert_eq!((point.error.differing == 0, point.outside.differing == 0), (is_exact, is_exact));
            assert_eq!(point.inside.differing == 0, point.manner != Manner::Sparse);
        }
        for (manner, fill) in [Manner::Sparse, Manner::Foveated].into_iter().flat_map(|m| Fill::ALL.map(|f| (m, f))) {
            let line = series.points.iter().filter(|point| point.manner == manner && point.fill == fill);
            let line: Vec<_> = line.map(|point| (point.pixels, point.error.rms_level)).collect();
            assert!(line.windows(2).all(|pair| pair[1].0 < pair[0].0), "{line:?}");
            assert!(line[line.len() - 1].1 > line[0].1, "{line:?}");
        }
    }
}

#[test]
fn a_study_without_a_device_says_what_it_skips() {
    let study = measure(&tiny(), None, &Settings::classic());
    let skipped: Vec<_> = study.skipped.iter().map(|skipped| skipped.name.as_str()).collect();
    assert_eq!(skipped, ["fast", "robust", "double", "certified"]);
    assert!(study.report().contains("not measured: fast: no Vulkan device is used"));
    assert!(html(&[study], None, "trueray").contains("no Vulkan device is used"));
}

#[test]
fn hard_cases_have_a_panel_each_and_a_point_for_each_kernel() {
    let Some(gpu) = gpu("hard_cases_have_a_panel_each_and_a_point_for_each_kernel") else { return };
    let cases = hard_cases(&gpu, 64, 1, 1).unwrap();
    let kernels = cases.costs.len();
    assert_eq!(kernels + cases.skipped.len(), 5);
    let panels = cases.rows.iter().filter(|row| row.kernel == "schoolbook").count();
    assert_eq!(cases.rows.len(), panels * kernels);
    let page = html(&[], Some(&cases), "trueray");
    assert_eq!(page.matches("<svg").count(), panels);
    assert!(page.contains("Hard cases") && page.contains("7 thin, disc 1:1:1e-3"));
    assert!(!page.contains("NaN") && !html(&[], None, "trueray").contains("Hard cases"));
    let report = cases.report();
    for cost in &cases.costs {
        assert!(cost.ns.median() > 0.0 && report.contains(cost.kernel), "{report}");
    }
}

/// Fields of one CSV record; no field of these tests has a line break.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

#[test]
fn files_are_complete_and_depend_on_the_measurements_only() {
    let study = measure(&tiny(), None, &Settings::exact());
    let studies = [study.clone(), study];

    let table = csv(&studies);
    let lines: Vec<_> = table.lines().collect();
    assert_eq!(fields(lines[0]), COLUMNS);
    let rows = studies.iter().map(|study| {
        let series = [&study.precision, &study.depth, &study.samples];
        series.iter().map(|series| series.points.len()).sum::<usize>()
            + study.effect_cost.variants.len()
            + study.partial.points.len()
    });
    assert_eq!(lines.len(), 1 + rows.sum::<usize>());
    for line in &lines[1..] {
        let fields = fields(line);
        assert_eq!(fields.len(), COLUMNS.len(), "{line}");
        assert_eq!(fields[0], "tiny, <scene>");
        let median: f64 =
            fields[COLUMNS.iter().position(|column| *column == "wall_median_ms").unwrap()].parse().unwrap();
        assert!(median >= 0.0);
    }

    let page = html(&studies, None, "trueray study 'a <b>'");
    assert_eq!(page.matches("<svg").count(), 8 * studies.len());
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(page.contains("tiny, &lt;scene&gt;") && page.contains("a &lt;b&gt;"));
    for foreign in ["http:", "https:", "//", "src=", "href=", "url(", "@import", "<script", "NaN", "inf"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    assert_eq!(page, html(&studies.clone(), None, "trueray study 'a <b>'"));
    assert_eq!(table, csv(&studies.clone()));
}

fn run(arguments: &str, folder: &std::path::Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(arguments.split_whitespace()).current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn the_program_writes_its_files_and_says_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 8 8\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\n\
                 AMBIENT 1 1 1\nBACK 0 0 1\nOUTPUT out.ppm\n";
    std::fs::write(folder.join("scene.txt"), scene).unwrap();
    let fast = "study scene.txt --device cpu --runs 1 --spp-list 1,4 --depths 0";

    let output = run(&format!("{fast} --report r.html --csv r.csv --json r.json"), folder);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("Samples per pixel"));
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(folder.join("r.json")).unwrap()).unwrap();
    let study = &json["studies"][0];
    assert_eq!(study["scene"], "scene.txt");
    assert_eq!(study["samples"]["points"][1]["samples"], 4);
    assert_eq!(study["precision"]["points"][0]["contestant"], "CPU f32");
    assert!(json["command"].as_str().unwrap().starts_with("trueray study scene.txt"));
    assert!(std::fs::read_to_string(folder.join("r.html")).unwrap().contains("--spp-list 1,4"));
    assert!(std::fs::read_to_string(folder.join("r.csv")).unwrap().lines().count() > 10);
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 4, "no temporary file is left");

    assert!(json.get("hard_cases").is_none(), "the CPU has none of the kernels");

    // With a `-` standard output has that file and nothing else.
    let output = run(&format!("{fast} --json -"), folder);
    serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();

    if gpu("the_program_writes_its_files_and_says_what_is_wrong").is_some() {
        let on_device = "study scene.txt --device gpu --runs 1 --spp-list 1 --depths 0 --json - --report r.html";
        for (count, panels) in [(64, true), (0, false)] {
            let output = run(&format!("{on_device} --hard-cases {count}"), folder);
            let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(json["hard_cases"]["rays"] == 64, panels);
            let page = std::fs::read_to_string(folder.join("r.html")).unwrap();
            assert_eq!(page.contains("<h2>Hard cases</h2>"), panels);
        }
    }

    for (arguments, code, message) in [
        ("study", 2, "SCENE"),
        ("study scene.txt --hard-cases 9", 2, "--hard-cases"),
        ("study scene.txt --spp-list 1,3", 2, "square number"),
        ("study scene.txt --runs 0", 2, "--runs"),
        ("render scene.txt --spp 2", 2, "square number"),
        ("render scene.txt --spp 289", 2, "square number"),
        ("study missing.txt --device cpu", 3, "missing.txt"),
        ("study scene.txt --device nobody-has-this", 4, "nobody-has-this"),
        ("study scene.txt --device cpu --report nowhere/r.html", 6, "there is no folder nowhere"),
        ("study scene.txt --device cpu --csv .", 6, "that is a folder"),
    ] {
        let output = run(arguments, folder);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {stderr}");
        assert!(stderr.contains(message), "{arguments}: {stderr}");
    }
}

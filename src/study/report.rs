//! The report: one HTML file that needs nothing else.

use glam::DVec3;
use maud::{Markup, html};

use super::contestant::Contestant;
use super::hard_cases::HardCases;
use super::measure::{Point, Series, Study};
use super::plots;
use crate::report::number::{ppm, short, time};
use crate::report::page;
use crate::settings::{SampleOffset, Settings};
use crate::view::View;
use crate::words::count;

/// The page with all `studies` and the hard cases, where they were measured; `command` is what made them.
pub fn html(studies: &[Study], hard_cases: Option<&HardCases>, command: &str) -> String {
    let content = html! {
        @for study in studies { (section(study)) }
        @if let Some(cases) = hard_cases { (cases.section()) }
    };
    page("What accuracy costs", "Render time against error", command, &content, &method())
}

fn section(study: &Study) -> Markup {
    let [precision, depth, samples] = study.titled().map(|(_, series)| series);
    html! {
        h2 { (study.scene) }
        (facts(study))
        ul { @for finding in findings(study) { li { (finding) } } }

        h3 { "Precision" }
        p {
            "Each point is one way to render the same picture. Further left is faster, further down is nearer to the CPU \
             reference, which calculates in " code { "f64" } " and has no error here by definition. What lies both right of \
             and above another point is not worth its time on this scene."
        }
        figure {
            (plots::pareto(study))
            figcaption {
                "Dots: median of " (precision.runs) " runs; bars: fastest to slowest run. Shaded: not one pixel differs, and \
                 heights mean nothing; they keep the marks apart. “px” counts the pixels that differ."
            }
        }
        (table(precision))

        h3 { "Reflection depth" }
        p {
            "A mirror seen in a mirror takes one bounce more. Each bounce costs time and changes the picture less than the \
             one before."
            @if study.effects.has(crate::effects::Effect::Reflections) { } @else { " This scene has no reflections that can be seen." }
        }
        div.pair {
            @for plot in plots::over(depth, "greatest number of bounces", |point| point.depth) { figure { (plot) } }
        }
        p.small { (truth(depth)) }
        (table(depth))

        h3 { "Samples per pixel" }
        p {
            "One sample decides a whole pixel, so edges become stairs. More samples on a regular grid, averaged, cost about \
             as many times more."
        }
        div.pair {
            @for plot in plots::over(samples, "samples per pixel", |point| point.samples) { figure { (plot) } }
        }
        p.small {
            (truth(samples))
            @if study.settings.sampling != SampleOffset::Center {
                " With this convention samples start at the pixel's corner, so the picture also moves by up to half a pixel \
                 as samples are added, and the error contains that shift; " code { "--convention exact" } " has none."
            }
        }
        (table(samples))

        (study.partial.section())

        h3 { "Effects" }
        p {
            "A kernel is compiled with just the effects that the scene calls for (auto). Forcing one on costs time for \
             nothing; forcing one off that is needed changes the picture. Measured with " (study.effects_on()) "."
        }
        figure {
            (plots::effects(study))
            figcaption { "Bars: median; whiskers: fastest to slowest run; ×: times the median of auto." }
        }
        @if study.device.is_none() {
            p.small { "The CPU reference leaves out rays, but no code: most effects cost the same compiled in or not." }
        }
    }
}

/// A vector as the command line has it.
fn coordinates(v: DVec3) -> String {
    let DVec3 { x, y, z } = v;
    format!("{x},{y},{z}")
}

/// A choice as the command line has it.
fn word(choice: &impl serde::Serialize) -> String {
    serde_json::to_value(choice).ok().and_then(|word| word.as_str().map(str::to_owned)).unwrap_or_default()
}

fn facts(study: &Study) -> Markup {
    let Settings { view, sampling, quantize, secondary, specular, max_depth, pattern } = study.settings;
    html! {
        dl {
            dt { "Picture" }
            dd { (study.width) " × " (study.height) ", " (count(study.spheres as u64, "sphere")) ", " (count(study.lights as u64, "light")) }
            dt { "Device" }
            @if view != View::FILE {
                dt { "Camera" }
                dd { "eye at " (coordinates(view.eye)) ", looking along " (coordinates(-view.axes()[2])) }
            }
            @match &study.device {
                Some(info) => dd { (info.name) " (" (info.kind) "), driver " (info.driver) },
                None => dd { "none, CPU alone" },
            }
            dt { "CPU" }
            dd { (study.cpu_threads) " threads" }
            dt { "Settings" }
            dd {
                (word(&sampling)) " sampling, quantize " (word(&quantize)) ", secondary epsilon "
                (secondary.shadow) " for shadows and " (secondary.reflection) " for reflections, "
                (word(&specular)) ", depth " (max_depth) ", " (pattern.count()) " spp"
            }
            dt { "Tier for it" }
            dd { (study.selection.tier) ": " (study.selection.reason) }
            @for skipped in &study.skipped {
                dt { "Not measured" }
                dd { (skipped.name) ": " (skipped.reason) }
            }
        }
    }
}

/// What the precision series shows, in sentences.
fn findings(study: &Study) -> Vec<String> {
    let points = &study.precision.points;
    let pixels = u64::from(study.width) * u64::from(study.height);
    let of = |contestant| points.iter().find(|point| point.contestant == contestant);
    let mut findings = Vec::new();
    let devices: Vec<_> = points.iter().filter(|p| matches!(p.contestant, Contestant::Device(_))).collect();
    let base = devices.first().copied().or_else(|| of(Contestant::CpuSingle));
    for point in points.iter().filter(|point| point.contestant != Contestant::CpuDouble) {
        let ratio = base.filter(|base| base.contestant != point.contestant).map_or_else(String::new, |base| {
            format!(" ({} times {})", short(point.wall.median() / base.wall.median()), base.contestant.name())
        });
        let error = match point.error.differing {
            0 => "every pixel is that of the reference".to_owned(),
            count => format!(
                "{count} of {pixels} pixels differ ({} in a million), by {} level{} at the most",
                short(ppm(count, pixels)),
                point.error.max_level,
                if point.error.max_level == 1 { "" } else { "s" }
            ),
        };
        let unexplained = match point.unexplained {
            0 => "",
            1 => "; one of them is not explained by rounding",
            _ => "; some of them are not explained by rounding",
        };
        findings.push(format!(
            "{}: {}{ratio}; {error}{unexplained}.",
            point.contestant.name(),
            time(point.wall.median())
        ));
    }
    if let Some(point) = of(Contestant::CpuDouble) {
        findings.push(format!("CPU f64, the reference itself: {}.", time(point.wall.median())));
    }
    let all = [&study.precision, &study.depth, &study.samples].into_iter().flat_map(|series| &series.points);
    let (outliers, runs) =
        all.fold((0, 0), |(outliers, runs), point| (outliers + point.wall.outliers(), runs + point.wall.runs().len()));
    if outliers > 0 {
        findings.push(format!(
            "Caution: outliers (beyond Tukey's fences) among the {runs} runs: {outliers}. Something else may have used the machine: \
             where two tables have other times for the same picture, measure again."
        ));
    }
    findings
}

fn truth(series: &Series) -> String {
    series.truth.map_or_else(String::new, |truth| {
        format!(
            "Error: root of the mean squared difference of the linear colours, before they are clamped and quantised, between \
             CPU f64 and its own picture with depth {} and {} samples per pixel, where 1 is full intensity. The tiers' own \
             errors are in the table.",
            truth.depth, truth.samples
        )
    })
}

fn table(series: &Series) -> Markup {
    let clock = series.points.iter().any(|point| point.on_device.is_some());
    let varied = series.truth.is_some();
    let cell = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), short);
    let row = |point: &Point| {
        let distance = point.from_truth.unwrap_or(point.error);
        html! {
            tr {
                td class=(plots::class(point.contestant)) { (point.contestant.name()) }
                td { (point.depth) }
                td { (point.samples) }
                td { (time(point.wall.median())) }
                td { (short(point.wall.min())) " … " (short(point.wall.max())) }
                @if clock { td { (cell(point.on_device.as_ref().map(crate::report::Timings::median))) } }
                td { (point.error.differing) }
                td { (point.unexplained) }
                @if varied { td { (distance.differing) } }
                td { (distance.max_level) }
                td { (short(distance.mean_level)) }
                td { (short(distance.rms_level)) }
                td { (cell(distance.rms_linear)) }
                td.words { (point.wall.caution()) @if point.not_finite > 0 { " " (point.not_finite) " pixels not finite" } }
            }
        }
    };
    html! {
        div.wide {
            table {
                thead {
                    tr {
                        th { }
                        th { "depth" }
                        th { "spp" }
                        th { "median" }
                        th { "min … max" br; "ms" }
                        @if clock { th { "on device" br; "ms" } }
                        th { "pixels off" br; "reference" }
                        th { "un-" br; "explained" }
                        @if varied { th { "pixels off" br; "truth" } }
                        th { "max" br; "levels" }
                        th { "mean" br; "levels" }
                        th { "RMS" br; "levels" }
                        th { "RMS" br; "linear" }
                        th { }
                    }
                }
                tbody { @for point in &series.points { (row(point)) } }
            }
        }
    }
}

fn method() -> Markup {
    html! {
        ul {
            li {
                "Every way to render was run once to warm up (that run compiles the kernel and is not counted), then all of a \
                 series in turn, A B C A B C, so that a slow moment of the machine meets all alike."
            }
            li {
                "Times are wall-clock times from the prepared scene to rows of pixels in memory. “On device” is the device's \
                 own clock around its dispatches, without transfers and without waiting; – where it has none."
            }
            li { "Outliers lie more than 1.5 interquartile ranges beyond the quartiles (Tukey's fences); a spread is wide where the fastest and the slowest run differ by more than half the median." }
            li {
                "“Pixels off reference” compares with the CPU reference in f64 at the same depth and samples; it is " em { "unexplained" }
                " where the reference finds no decision (silhouette, shadow edge, quantisation step …) near enough for rounding to \
                 turn it. “Truth” is the reference with more bounces or samples; where a table has that column, levels and \
                 linear errors are against it, otherwise against the reference."
            }
            li { "Levels are 8-bit steps, 0 to 255. A linear error is known on the CPU only: the device returns 8-bit levels." }
        }
    }
}

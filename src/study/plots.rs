//! The plots of the report.

use maud::{Markup, html};

use super::contestant::Contestant;
use super::measure::{Point, Series, Study};
use crate::precision::Tier;
use crate::report::Timings;
use crate::report::lines::{FRAME, Line, Ranged, plot};
use crate::report::number::{ppm, short, time};
use crate::report::svg::{Axis, Frame, Rect, drawing, place_labels, px, x_axis, y_axis};

/// The colour class of a contestant.
pub(super) fn class(contestant: Contestant) -> &'static str {
    match contestant {
        Contestant::Device(Tier::Fast) => "c-fast",
        Contestant::Device(Tier::Robust) => "c-robust",
        Contestant::Device(Tier::Double) => "c-double",
        Contestant::Certified => "c-certified",
        Contestant::CpuSingle => "c-single",
        Contestant::CpuDouble => "c-cpu",
    }
}

fn extent(samples: &[&Timings]) -> Vec<f64> {
    samples.iter().flat_map(|sample| [sample.min(), sample.median(), sample.max()]).collect()
}

/// Error against time: one point for each contestant, its spread as a bar. Pixels that all agree have no place on a
/// logarithmic axis; they have a lane of their own below it.
pub(super) fn pareto(study: &Study) -> Markup {
    let points = &study.precision.points;
    let pixels = u64::from(study.width) * u64::from(study.height);
    let (exact, inexact): (Vec<&Point>, Vec<&Point>) = points.iter().partition(|point| point.error.differing == 0);
    let lane = if exact.is_empty() { 0.0 } else { exact.len() as f64 * 24.0 + 16.0 };
    let above = if inexact.is_empty() { 0.0 } else { 230.0 };
    let frame = Frame { left: 76.0, right: 740.0, top: 44.0, bottom: 44.0 + above + lane };
    let times: Vec<_> = points.iter().map(|point| &point.wall).collect();
    let x = Axis::logarithmic(extent(&times).into_iter(), frame.left + 12.0, frame.right);
    let edge = frame.top + above;
    let y = Axis::logarithmic(
        inexact.iter().map(|point| ppm(point.error.differing, pixels)),
        edge - if exact.is_empty() { 0.0 } else { 12.0 },
        frame.top,
    );
    let mut places: Vec<(&Point, f64)> =
        inexact.iter().map(|point| (*point, y.place(ppm(point.error.differing, pixels)))).collect();
    let mut by_time = exact.clone();
    by_time.sort_by(|a, b| a.wall.median().total_cmp(&b.wall.median()));
    places.extend(by_time.into_iter().enumerate().map(|(index, point)| (point, edge + 20.0 + index as f64 * 24.0)));
    let note = |point: &Point| {
        let count = point.error.differing;
        let count = if count > 0 { format!(", {count} px") } else { String::new() };
        format!("{}{count}", time(point.wall.median()))
    };
    let mark = |(point, height): &(&Point, f64)| {
        Rect([x.place(point.wall.min()) - 7.0, height - 7.0, x.place(point.wall.max()) + 7.0, height + 7.0])
    };
    let marks: Vec<_> = places.iter().map(mark).collect();
    // Letters are about 7 px wide.
    let width = |point: &Point| (point.contestant.name().len() + note(point).chars().count() + 1) as f64 * 7.0;
    let widths: Vec<_> = places.iter().map(|(point, _)| width(point)).collect();
    let labels = place_labels(&marks, &widths, Rect([frame.left + 2.0, frame.top, 756.0, frame.bottom]));
    let content = html! {
        @if !exact.is_empty() {
            rect.lane x=(px(frame.left)) y=(px(edge)) width=(px(frame.right - frame.left)) height=(px(lane)) {}
            text.tick x=(px(frame.left - 8.0)) y=(px(edge + lane / 2.0 + 4.0)) text-anchor="end" { "0" }
        }
        (x_axis(&frame, &x.ticks(), "time of a picture in ms (logarithmic); left is faster"))
        (y_axis(&frame, &if inexact.is_empty() { Vec::new() } else { y.ticks() },
            "pixels in a million that differ from the CPU f64 reference; lower is better"))
        @for ((point, height), (left, base)) in places.iter().zip(&labels) {
            g class=(class(point.contestant)) {
                line.bar x1=(px(x.place(point.wall.min()))) x2=(px(x.place(point.wall.max()))) y1=(px(*height)) y2=(px(*height)) {}
                circle.dot cx=(px(x.place(point.wall.median()))) cy=(px(*height)) r="6" {}
                text.name x=(px(*left)) y=(px(*base)) { (point.contestant.name()) tspan.note dx="6" { (note(point)) } }
            }
        }
    };
    drawing(760.0, frame.bottom + 52.0, "Error against time for every tier and the CPU", &content)
}

/// Places of so many steps at equal distances.
fn steps(count: usize) -> impl Fn(usize) -> f64 {
    const INNER: f64 = 26.0;
    let distance = (FRAME.right - FRAME.left - 2.0 * INNER) / (count.max(2) - 1) as f64;
    move |step| FRAME.left + INNER + step as f64 * distance
}

/// Time and error over the values that `series` varies, which `step` reads off a point.
pub(super) fn over(series: &Series, what: &str, step: impl Fn(&Point) -> u32) -> [Markup; 2] {
    let mut values: Vec<u32> = series.points.iter().map(&step).collect();
    values.sort_unstable();
    values.dedup();
    let at = steps(values.len());
    let ticks: Vec<_> = values.iter().enumerate().map(|(step, value)| (at(step), value.to_string())).collect();
    let place = |point: &Point| at(values.iter().position(|value| *value == step(point)).unwrap_or(0));
    let mut of_contestants = Contestant::ALL.to_vec();
    of_contestants.retain(|contestant| series.points.iter().any(|point| point.contestant == *contestant));
    let line = |contestant: &Contestant, read: &dyn Fn(&Point) -> Option<Ranged>| {
        let own = series.points.iter().filter(|point| point.contestant == *contestant);
        let mut points: Vec<_> = own.filter_map(|point| Some((place(point), read(point)?))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Line { class: class(*contestant), name: contestant.name(), points }
    };
    let times: Vec<_> = of_contestants
        .iter()
        .map(|contestant| line(contestant, &|point| Some((point.wall.median(), [point.wall.min(), point.wall.max()]))))
        .collect();
    let error = |point: &Point| point.from_truth.and_then(|distance| distance.rms_linear);
    let positive = series.points.iter().filter_map(error).all(|value| value > 0.0);
    let errors = vec![line(&Contestant::CpuDouble, &|point| error(point).map(|value| (value, [value, value])))];
    let logarithmic_error = positive && errors.iter().any(|line| !line.points.is_empty());
    let error_title = if logarithmic_error { "RMS colour error (logarithmic)" } else { "RMS colour error" };
    [
        plot(&format!("Time against {what}"), (&ticks, what), ("time in ms (logarithmic)", true), &times),
        plot(&format!("Error against {what}"), (&ticks, what), (error_title, logarithmic_error), &errors),
    ]
}

/// Bars of the render time with each effect compiled in or left out.
pub(super) fn effects(study: &Study) -> Markup {
    let variants = &study.effect_cost.variants;
    let row = 30.0;
    let frame = Frame { left: 190.0, right: 590.0, top: 34.0, bottom: 38.0 + row * variants.len() as f64 };
    let samples: Vec<_> = variants.iter().map(|variant| &variant.render).collect();
    let x = Axis::from_zero(extent(&samples).into_iter(), frame.left, frame.right);
    let content = html! {
        (x_axis(&frame, &x.ticks(), "render time in ms"))
        @for (index, variant) in variants.iter().enumerate() {
            @let y = frame.top + 10.0 + row * index as f64;
            @let end = x.place(variant.render.median());
            g class=(if index == 0 { "c-base" } else if variant.same_picture { "c-same" } else { "c-changed" }) {
                rect.fill x=(px(frame.left)) y=(px(y)) width=(px(end - frame.left)) height="16" {}
                line.bar x1=(px(x.place(variant.render.min()))) x2=(px(x.place(variant.render.max()))) y1=(px(y + 8.0)) y2=(px(y + 8.0)) {}
                text.name x=(px(frame.left - 10.0)) y=(px(y + 12.5)) text-anchor="end" { (variant.name) }
                text.note x=(px(x.place(variant.render.max()).max(end) + 10.0)) y=(px(y + 12.5)) {
                    "× " (short(variant.ratio)) @if !variant.same_picture { ", another picture" }
                }
            }
        }
        line.axis x1=(px(frame.left)) x2=(px(frame.left)) y1=(px(frame.top)) y2=(px(frame.bottom)) {}
    };
    drawing(760.0, frame.bottom + 52.0, "Render time by effects", &content)
}

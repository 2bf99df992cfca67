//! The plots of the report: time and rays per second over the size, both logarithmic.

use maud::{Markup, html};

use super::measure::{FamilyResult, Measured, Renderer};
use crate::report::svg::{Axis, Frame, drawing, px, spread, x_axis, y_axis};

/// The colour class of a renderer.
pub(super) fn class(renderer: Renderer) -> &'static str {
    match renderer {
        Renderer::Device => "c-fast",
        Renderer::Cpu => "c-cpu",
    }
}

/// Size, value, and the least and greatest of it.
type Point = (f64, f64, [f64; 2]);

/// One line for each renderer that was measured.
fn over_size(family: &FamilyResult, y_title: &str, read: impl Fn(&Measured) -> (f64, [f64; 2])) -> Markup {
    let points = |renderer: Renderer| -> Vec<Point> {
        let own = |scene: &super::SceneResult| {
            let measured = scene.measured.iter().find(|measured| measured.renderer == renderer)?;
            let (value, ends) = read(measured);
            Some((scene.size as f64, value, ends))
        };
        family.scenes.iter().filter_map(own).collect()
    };
    let mut lines: Vec<_> = [Renderer::Device, Renderer::Cpu].map(|renderer| (renderer, points(renderer))).into();
    lines.retain(|(_, points)| !points.is_empty());
    let frame = Frame { left: 76.0, right: 400.0, top: 44.0, bottom: 264.0 };
    let all = || lines.iter().flat_map(|(_, points)| points);
    let x = Axis::logarithmic(all().map(|point| point.0), frame.left, frame.right);
    let values = all().flat_map(|(_, value, [low, high])| [*value, *low, *high]);
    let y = Axis::logarithmic(values, frame.bottom, frame.top);
    let ends: Vec<_> = lines.iter().filter_map(|(_, points)| points.last().map(|point| y.place(point.1))).collect();
    let labels = spread(&ends, 17.0, frame.top, frame.bottom);
    let content = html! {
        (x_axis(&frame, &x.ticks(), &format!("{} (logarithmic)", family.axis.name())))
        (y_axis(&frame, &y.ticks(), y_title))
        @for (((renderer, points), end), label) in lines.iter().zip(&ends).zip(&labels) {
            g class=(class(*renderer)) {
                @let path: Vec<_> = points.iter().map(|(size, value, _)| format!("{:.1},{:.1}", x.place(*size), y.place(*value))).collect();
                polyline.line points=(path.join(" ")) {}
                @for (size, value, [low, high]) in points {
                    line.bar x1=(px(x.place(*size))) x2=(px(x.place(*size))) y1=(px(y.place(*low))) y2=(px(y.place(*high))) {}
                    circle.dot cx=(px(x.place(*size))) cy=(px(y.place(*value))) r="4" {}
                }
                @if let Some((size, _, _)) = points.last() {
                    line.leader x1=(px(x.place(*size) + 7.0)) x2=(px(frame.right + 4.0)) y1=(px(*end)) y2=(px(*label)) {}
                }
                text.name x=(px(frame.right + 8.0)) y=(px(label + 4.5)) { (renderer.name()) }
            }
        }
    };
    drawing(480.0, frame.bottom + 52.0, &format!("{}: {y_title}", family.name), &content)
}

/// Time of a picture over the size.
pub(super) fn times(family: &FamilyResult) -> Markup {
    over_size(family, "time of a picture in ms (logarithmic)", |measured| {
        let picture = &measured.picture;
        (picture.median(), [picture.min(), picture.max()])
    })
}

/// Rays per second over the size.
pub(super) fn rays(family: &FamilyResult) -> Markup {
    over_size(family, "million rays per second (logarithmic)", |measured| {
        let value = measured.rays_per_second / 1e6;
        (value, [value, value])
    })
}

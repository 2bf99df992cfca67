//! Plots of lines over one quantity, each with its name beside its end.

use maud::{Markup, html};

use super::svg::{Axis, Frame, drawing, px, spread, x_axis, y_axis};

/// The rectangle that the values lie in.
pub(crate) const FRAME: Frame = Frame { left: 76.0, right: 400.0, top: 44.0, bottom: 264.0 };

/// A value, and the least and greatest of it.
pub(crate) type Ranged = (f64, [f64; 2]);

/// One line.
pub(crate) struct Line<'a> {
    pub(crate) class: &'static str,
    pub(crate) name: &'a str,
    /// From left to right, each with its place along the horizontal axis.
    pub(crate) points: Vec<(f64, Ranged)>,
}

/// The plot of `lines` over an axis with these ticks and this title; the vertical axis may be logarithmic.
pub(crate) fn plot(
    label: &str,
    (ticks, x_title): (&[(f64, String)], &str),
    (y_title, logarithmic): (&str, bool),
    lines: &[Line],
) -> Markup {
    let points = lines.iter().flat_map(|line| &line.points);
    let values = points.flat_map(|(_, (value, [low, high]))| [*value, *low, *high]);
    let y = if logarithmic {
        Axis::logarithmic(values, FRAME.bottom, FRAME.top)
    } else {
        Axis::from_zero(values, FRAME.bottom, FRAME.top)
    };
    let ends: Vec<_> =
        lines.iter().filter_map(|line| line.points.last().map(|(_, (value, _))| y.place(*value))).collect();
    let labels = spread(&ends, 17.0, FRAME.top, FRAME.bottom);
    let content = html! {
        (x_axis(&FRAME, ticks, x_title))
        (y_axis(&FRAME, &y.ticks(), y_title))
        @for ((line, end), label) in lines.iter().zip(&ends).zip(&labels) {
            g class=(line.class) {
                @let path: Vec<_> = line.points.iter().map(|(x, (value, _))| format!("{x:.1},{:.1}", y.place(*value))).collect();
                polyline.line points=(path.join(" ")) {}
                @for (x, (value, [low, high])) in &line.points {
                    line.bar x1=(px(*x)) x2=(px(*x)) y1=(px(y.place(*low))) y2=(px(y.place(*high))) {}
                    circle.dot cx=(px(*x)) cy=(px(y.place(*value))) r="4" {}
                }
                @if let Some((x, _)) = line.points.last() {
                    line.leader x1=(px(x + 7.0)) x2=(px(FRAME.right + 4.0)) y1=(px(*end)) y2=(px(*label)) {}
                }
                text.name x=(px(FRAME.right + 8.0)) y=(px(label + 4.5)) { (line.name) }
            }
        }
    };
    drawing(480.0, FRAME.bottom + 52.0, label, &content)
}

//! The section on sampling a part of the pixels: plots and table, for people.

use std::fmt::Write as _;

use maud::{Markup, html};

use super::distance::Distance;
use super::sampling::{Manner, PartialPoint, PartialSeries};
use crate::report::number::{short, time};
use crate::report::svg::{Axis, Frame, drawing, px, spread, x_axis, y_axis};
use crate::sampling::Fill;

impl PartialPoint {
    /// What was sampled, in a few words.
    pub(super) fn name(&self) -> String {
        match self.manner {
            Manner::Full => "full".into(),
            manner => format!("{} 1/{:.0} {}", manner.name(), 1.0 / self.least, self.fill),
        }
    }
}

impl PartialSeries {
    /// A table for people.
    pub(super) fn report(&self) -> String {
        let mut text = format!(
            "{:<24} {:>8} {:>10} {:>10} {:>19} {:>9} {:>9} {:>9}\n",
            "", "sampled", "median", "rays", "min … max", "RMS", "inside", "outside"
        );
        for point in &self.points {
            let PartialPoint { wall, rays, error, inside, outside, .. } = point;
            let range = format!("{} … {} ms", short(wall.min()), short(wall.max()));
            let _ = writeln!(
                text,
                "{:<24} {:>6.1} % {:>10} {:>10} {range:>19} {:>9} {:>9} {:>9}  {}",
                point.name(),
                self.percent(point),
                time(wall.median()),
                time(rays.median()),
                short(error.rms_level),
                short(inside.rms_level),
                short(outside.rms_level),
                wall.caution()
            );
        }
        text
    }

    /// Sampled pixels in percent.
    fn percent(&self, point: &PartialPoint) -> f64 {
        point.pixels as f64 * 100.0 / self.points.first().map_or(1, |full| full.pixels) as f64
    }

    /// The section of the report.
    pub(super) fn section(&self) -> Markup {
        html! {
            h3 { "Samples of a part of the pixels" }
            p {
                "A moving picture may sample a part of its pixels and fill the others: " em { "sparse" } " everywhere alike, " em { "foveated" }
                " all of them around the middle and ever fewer away from it. Sampled pixels have no error; what is filled has. A \
                 line goes from 1 pixel of 2 to 1 of 64, far from the fovea or everywhere."
            }
            @if self.points.is_empty() {
                p.small { "Not measured: the picture is too large to be filled." }
            } @else {
                div.pair {
                    figure { (self.plot("inside the fovea", |point| point.inside)) }
                    figure { (self.plot("outside the fovea", |point| point.outside)) }
                }
                p.small {
                    "Error: root of the mean squared difference of the 8-bit levels from the full picture of the same renderer. Time: \
                     rays and filling, median of " (self.runs) " runs; the upright line is the full picture. Shaded: no pixel \
                     differs. The fovea has a radius of " (short(self.fovea.radius)) " pixels. The live view finds nearest samples \
                     once for many pictures, so that it pays for little more than the rays."
                }
                (self.table())
            }
        }
    }

    fn table(&self) -> Markup {
        html! {
            div.wide {
                table {
                    thead {
                        tr {
                            th { } th { "sampled" br; "%" } th { "median" } th { "rays" } th { "min … max" br; "ms" }
                            th { "pixels" br; "off" } th { "RMS" br; "levels" } th { "RMS" br; "inside" } th { "RMS" br; "outside" } th { }
                        }
                    }
                    tbody {
                        @for point in &self.points {
                            tr {
                                td class=(class(point)) { (point.name()) }
                                td { (short(self.percent(point))) }
                                td { (time(point.wall.median())) }
                                td { (time(point.rays.median())) }
                                td { (short(point.wall.min())) " … " (short(point.wall.max())) }
                                td { (point.error.differing) }
                                td { (short(point.error.rms_level)) }
                                td { (short(point.inside.rms_level)) }
                                td { (short(point.outside.rms_level)) }
                                td.words { (point.wall.caution()) }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Error against time, a line for each manner and fill. No error has no place on a logarithmic axis: there is a lane for it.
    fn plot(&self, place: &str, read: impl Fn(&PartialPoint) -> Distance) -> Markup {
        let frame = Frame { left: 76.0, right: 370.0, top: 44.0, bottom: 284.0 };
        let edge = frame.bottom - 26.0;
        let error = |point: &PartialPoint| read(point).rms_level;
        let x = Axis::logarithmic(self.points.iter().map(|point| point.wall.median()), frame.left + 8.0, frame.right);
        let y = Axis::logarithmic(self.points.iter().map(error), edge - 8.0, frame.top);
        let height = |point: &PartialPoint| if error(point) > 0.0 { y.place(error(point)) } else { edge + 13.0 };
        let lines: Vec<Vec<&PartialPoint>> = [Manner::Sparse, Manner::Foveated]
            .into_iter()
            .flat_map(|manner| Fill::ALL.map(|fill| (manner, fill)))
            .map(|(manner, fill)| self.points.iter().filter(|p| p.manner == manner && p.fill == fill).collect())
            .collect();
        let ends: Vec<f64> = lines.iter().filter_map(|line| line.first()).map(|point| height(point)).collect();
        let labels = spread(&ends, 17.0, frame.top, frame.bottom);
        let full = self.points.first().map_or(frame.left, |full| x.place(full.wall.median()));
        let has_errors = self.points.iter().any(|point| error(point) > 0.0);
        let content = html! {
            rect.lane x=(px(frame.left)) y=(px(edge)) width=(px(frame.right - frame.left)) height="26" {}
            text.tick x=(px(frame.left - 8.0)) y=(px(edge + 17.0)) text-anchor="end" { "0" }
            (x_axis(&frame, &x.ticks(), "time in ms (logarithmic)"))
            (y_axis(&frame, &if has_errors { y.ticks() } else { Vec::new() }, &format!("RMS levels {place} (logarithmic)")))
            line.leader x1=(px(full)) x2=(px(full)) y1=(px(frame.top)) y2=(px(frame.bottom)) {}
            @for ((line, end), label) in lines.iter().zip(&ends).zip(&labels) {
                @if let Some(first) = line.first() {
                    g class=(class(first)) {
                        @let path: Vec<_> = line.iter().map(|p| format!("{:.1},{:.1}", x.place(p.wall.median()), height(p))).collect();
                        polyline.line points=(path.join(" ")) {}
                        @for point in line {
                            circle class=(if point.fill == Fill::Smooth { "hollow" } else { "dot" })
                                cx=(px(x.place(point.wall.median()))) cy=(px(height(point))) r="4" {}
                        }
                        line.leader x1=(px(x.place(first.wall.median()) + 7.0)) x2=(px(frame.right + 4.0)) y1=(px(*end)) y2=(px(*label)) {}
                        text.name x=(px(frame.right + 8.0)) y=(px(label + 4.5)) { (first.manner.name()) " " (first.fill) }
                    }
                }
            }
        };
        drawing(530.0, frame.bottom + 52.0, &format!("Error {place} against time"), &content)
    }
}

/// The colour class of a point.
fn class(point: &PartialPoint) -> &'static str {
    match (point.manner, point.fill) {
        (Manner::Full, _) => "c-cpu",
        (Manner::Sparse, Fill::Nearest) => "c-fast",
        (Manner::Sparse, Fill::Smooth) => "c-no-barrier",
        (Manner::Foveated, Fill::Nearest) => "c-robust",
        (Manner::Foveated, Fill::Smooth) => "c-double",
    }
}

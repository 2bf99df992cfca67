//! The plots of the report: time and rays per second over the size, both logarithmic.

use maud::Markup;

use super::measure::{FamilyResult, Measured, Renderer, SceneResult};
use crate::report::lines::{FRAME, Line, Ranged, plot};
use crate::report::svg::Axis;

/// The colour class of a renderer.
pub(super) fn class(renderer: Renderer) -> &'static str {
    match renderer {
        Renderer::Device => "c-fast",
        Renderer::Cpu => "c-cpu",
    }
}

/// One line for each renderer that was measured.
fn over_size(family: &FamilyResult, y_title: &str, read: impl Fn(&Measured) -> Ranged) -> Markup {
    let sizes = family.scenes.iter().filter(|scene| !scene.measured.is_empty()).map(|scene| scene.size as f64);
    let x = Axis::logarithmic(sizes, FRAME.left, FRAME.right);
    let points = |renderer: Renderer| {
        let own = |scene: &SceneResult| {
            let measured = scene.measured.iter().find(|measured| measured.renderer == renderer)?;
            Some((x.place(scene.size as f64), read(measured)))
        };
        family.scenes.iter().filter_map(own).collect()
    };
    let line = |renderer: Renderer| Line { class: class(renderer), name: renderer.name(), points: points(renderer) };
    let mut lines: Vec<_> = [Renderer::Device, Renderer::Cpu].map(line).into();
    lines.retain(|line| !line.points.is_empty());
    let x_title = format!("{} (logarithmic)", family.axis.name());
    plot(&format!("{}: {y_title}", family.name), (&x.ticks(), &x_title), (y_title, true), &lines)
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

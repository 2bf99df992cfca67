//! The report: one HTML file that needs nothing else.

use maud::{Markup, html};

use super::measure::{Bench, FamilyResult, Measured, SceneResult};
use super::phases::PHASES;
use super::plots;
use crate::engine::Rays;
use crate::report::number::{short, time};
use crate::report::page;
use crate::words::count;

/// The page with all measurements; `command` is what made them.
pub fn html(bench: &Bench, command: &str) -> String {
    let content = html! {
        (facts(bench))
        @for family in &bench.families { (section(family)) }
    };
    page("How fast", "Time of a picture over the size of its scene", command, &content, &method(bench))
}

fn facts(bench: &Bench) -> Markup {
    html! {
        dl {
            dt { "Device" }
            dd { (bench.device_name()) }
            dt { "CPU" }
            dd { "the reference in " code { "f64" } ", " (bench.cpu_threads) " threads" }
            dt { "Picture" }
            dd { "greatest depth " (bench.settings.max_depth) ", " (count(bench.settings.pattern.count(), "sample")) " a pixel" }
            dt { "Runs" }
            dd { (bench.runs) " of each scene and renderer, at most " (time(bench.seconds * 1e3)) " together" }
        }
    }
}

fn section(family: &FamilyResult) -> Markup {
    let measured = family.scenes.iter().any(|scene| !scene.measured.is_empty());
    html! {
        h2 { (family.name) }
        p { "Scenes: " (family.summary) "." }
        ul {
            @for growth in &family.growth { li { (growth.report()) "." } }
        }
        @if measured && family.scenes.len() > 1 {
            div.pair {
                figure { (plots::times(family)) }
                figure { (plots::rays(family)) }
            }
        }
        (table(family))
    }
}

fn table(family: &FamilyResult) -> Markup {
    let columns = PHASES.len() + 7;
    html! {
        div.wide {
            table {
                thead {
                    tr {
                        th { (family.axis.name()) }
                        th { "renderer" }
                        th { "picture" br; "median" }
                        th { "min … max" br; "ms" }
                        @for (name, _) in PHASES { th { (name) br; "ms" } }
                        th { "rays" }
                        th { "million" br; "rays/s" }
                        th { "pixels that" br; "differ" }
                        th { }
                    }
                }
                tbody {
                    @for scene in &family.scenes {
                        @for measured in &scene.measured { (row(scene, measured)) }
                        @for skipped in &scene.skipped {
                            tr {
                                td { (scene.size) }
                                td { (skipped.name) }
                                td.words colspan=(columns - 1) { "skipped: " (skipped.reason) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn row(scene: &SceneResult, measured: &Measured) -> Markup {
    let Measured { renderer, picture, phases, rays, rays_per_second } = measured;
    let Rays { primary, shadow, reflection } = rays;
    let tier = scene.tier.as_ref().filter(|_| *renderer == super::Renderer::Device);
    html! {
        tr {
            td { (scene.size) }
            td class=(plots::class(*renderer)) { (renderer.name()) @if let Some(tier) = tier { ", " (tier) } }
            td { (time(picture.median())) }
            td { (short(picture.min())) " … " (short(picture.max())) }
            @for phase in phases { td { (short(phase.times.median())) } }
            td { (primary + shadow + reflection) }
            td { (short(rays_per_second / 1e6)) }
            td { (scene.differing.map_or_else(|| "–".to_owned(), |count| count.to_string())) }
            td.words { (picture.caution()) }
        }
    }
}

fn method(bench: &Bench) -> Markup {
    html! {
        ul {
            li {
                "The scenes are built in and the same on every machine; " code { "trueray bench --write FOLDER" }
                " writes them as scene files."
            }
            li {
                "Each renderer warmed up, the device also to count its rays, then came " (bench.runs) " pictures that count, device \
                 and CPU in turn, so that a slow moment of the machine meets both alike. Every picture starts from the scene."
            }
            li {
                "The time of a picture is wall-clock time from the scene to rows of pixels in memory, without compiling, which \
                 further pictures do not repeat. Phases are medians, each by itself, so they need not add up."
            }
            li {
                "A renderer is skipped where its runs would exceed the time budget: by the time of its first picture, or, \
                 without one, as its times have grown so far."
            }
            li {
                "Growth is the least-squares slope of log time over log size. Rays per second are all rays over the median of \
                 the phase " em { "render" } "; a device needs no eye rays where no sphere can be, the reference traces them all."
            }
            li { "Outliers lie more than 1.5 interquartile ranges beyond the quartiles (Tukey's fences); a spread is wide where the fastest and the slowest run differ by more than half the median." }
        }
    }
}

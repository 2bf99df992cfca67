//! What reports of measurements share: series of times, numbers for people, plots and CSV records.

pub(crate) mod csv;
pub(crate) mod lines;
pub(crate) mod number;
mod pixel;
pub(crate) mod svg;
mod timings;

pub(crate) use pixel::{Labels, numbers, pixel_table};
pub use timings::Timings;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;

/// A contestant or a scene that was not measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// Its name.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// A report: one HTML file that needs nothing else. `about` and then `command`, which made it, stand below the title.
pub(crate) fn page(title: &str, about: &str, command: &str, content: &Markup, method: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("report.css"))) }
            }
            body {
                h1 { (title) }
                p.sub { (about) ", measured by " code { (command) } }
                p.sub { (crate::origin::origin().to_string()) }
                (content)
                h2 { "How this was measured" }
                (method)
            }
        }
    };
    page.into_string()
}

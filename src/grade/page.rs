//! The overview: a row a picture, each with a link to its own page beside it.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::{Extra, FULL, RULE, Row, Student};
use crate::report::page;
use crate::words::visible;

/// Where the pages of single pictures go: for `r.html` into `r_files`.
#[derive(Debug, Clone)]
pub struct Pages {
    folder: PathBuf,
}

impl Pages {
    /// Those of the overview in this file.
    pub fn of(overview: &Path) -> Self {
        let mut name = overview.file_stem().unwrap_or_default().to_owned();
        name.push("_files");
        Self { folder: overview.with_file_name(name) }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file's name for the picture of this number, safe for any file system.
    pub fn file_name(number: usize, row: &Row) -> String {
        let plain = |text: &str| -> String {
            let safe = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
            text.chars().take(60).map(safe).collect()
        };
        let whose = row.student.as_ref().map(|student| plain(student) + "-").unwrap_or_default();
        format!("{number:03}-{whose}{}.html", plain(&row.scene))
    }

    /// The link from the overview to a page.
    pub fn link(&self, file_name: &str) -> String {
        let folder = self.folder.file_name().unwrap_or_default().as_encoded_bytes();
        let quoted = folder.iter().map(|&byte| {
            let is_plain = byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
            if is_plain { char::from(byte).to_string() } else { format!("%{byte:02X}") }
        });
        quoted.chain(["/".into(), file_name.into()]).collect()
    }
}

/// The overview of all rows, which may be those of an interrupted run; `command` is what made it.
pub fn overview(rows: &[Row], students: &[Student], extras: &[Extra], interrupted: bool, command: &str) -> String {
    let full = rows.iter().filter(|row| row.score == FULL).count();
    let about = format!("{} pictures, {full} of them with the full score", rows.len());
    let content = html! {
        @if interrupted { p { b { "Interrupted: not all pictures were graded, and means are of those that were." } } }
        (pictures(rows))
        @if students.len() > 1 && rows.len() > students.len() { (means(students)) }
        @if !extras.is_empty() { (not_graded(extras)) }
    };
    let method = html! {
        p { "Score: " (RULE) }
        p { "Each picture is held beside the CPU reference of its scene; “> 2” counts the pixels that differ by more than 2 levels." }
    };
    page("Grades", &about, command, &content, &method)
}

fn pictures(rows: &[Row]) -> Markup {
    let has_students = rows.iter().any(|row| row.student.is_some());
    html! {
        table.stacked {
            thead { tr {
                @if has_students { th { "student" } }
                th { "scene" } th { "score" } th.words { "verdict" }
                th { "> 0" } th { "> 1" } th { "> 2" } th { "> 10" } th.words { "likely cause" }
            } }
            tbody { @for row in rows { (picture(row, has_students)) } }
        }
    }
}

fn picture(row: &Row, has_students: bool) -> Markup {
    let counts = row.differing.map(super::Differing::by_threshold);
    html! {
        tr {
            @if has_students { td data-label="student" { (visible(row.student.as_deref().unwrap_or_default())) } }
            td data-label="scene" {
                @match &row.page { Some(page) => a href=(page) { (visible(&row.scene)) }, None => (visible(&row.scene)) }
            }
            td data-label="score" { b { (row.score) } }
            td.words data-label="verdict" { (row.verdict.name()) }
            @for (at, threshold) in ["> 0", "> 1", "> 2", "> 10"].into_iter().enumerate() {
                td data-label=(threshold) { @match counts { Some(counts) => (counts[at].1), None => "–" } }
            }
            td.words.long data-label="likely cause" { (visible(&row.why())) }
        }
    }
}

fn means(students: &[Student]) -> Markup {
    html! {
        h2 { "Means" }
        table.stacked {
            thead { tr { th { "student" } th { "mean score" } } }
            tbody {
                @for Student { student, score } in students {
                    tr { td data-label="student" { (visible(student)) } td data-label="mean score" { (format!("{score:.1}")) } }
                }
            }
        }
    }
}

fn not_graded(extras: &[Extra]) -> Markup {
    html! {
        h2 { "Not graded" }
        ul { @for Extra { picture, reason } in extras { li { code { (visible(picture)) } ": " (visible(reason)) } } }
    }
}

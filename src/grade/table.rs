//! Rows for the terminal and as CSV.

use std::fmt::Write as _;

use super::Row;
use crate::report::csv::record;
use crate::words::visible;

/// The columns of the CSV, a stable interface.
pub const COLUMNS: [&str; 16] = [
    "student",
    "scene",
    "picture",
    "verdict",
    "score",
    "pixels",
    "over_0",
    "over_1",
    "over_2",
    "over_10",
    "max_level",
    "explained",
    "unexplained",
    "cause",
    "cause_share",
    "detail",
];

/// All rows as CSV; what is not known is empty.
pub fn csv(rows: &[Row]) -> String {
    let text = |value: Option<&String>| value.cloned().unwrap_or_default();
    let number = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
    let of_row = |row: &Row| {
        let over = |pick: fn(super::Differing) -> u64| number(row.differing.map(pick));
        let verdict = serde_json::json!(row.verdict);
        let cause = row.causes.first();
        let detail = cause.map(|cause| &cause.detail).or(row.detail.as_ref());
        record(&[
            text(row.student.as_ref()),
            row.scene.clone(),
            text(row.picture.as_ref()),
            verdict.as_str().unwrap_or_default().to_owned(),
            row.score.to_string(),
            row.pixels.to_string(),
            over(|differing| differing.over_0),
            over(|differing| differing.over_1),
            over(|differing| differing.over_2),
            over(|differing| differing.over_10),
            number(row.max_level.map(u64::from)),
            number(row.explained),
            number(row.unexplained),
            cause.map(|cause| cause.name.to_owned()).unwrap_or_default(),
            cause.map(|cause| format!("{:.4}", cause.share)).unwrap_or_default(),
            text(detail),
        ])
    };
    let head = record(&COLUMNS.map(str::to_owned));
    std::iter::once(head).chain(rows.iter().map(of_row)).collect()
}

/// All rows as a table for people.
pub fn table(rows: &[Row]) -> String {
    let name = |row: &Row| row.student.as_ref().map_or_else(|| row.scene.clone(), |who| format!("{who}/{}", row.scene));
    let names: Vec<String> = rows.iter().map(|row| visible(&name(row))).collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max("picture".len());
    let mut text = format!(
        "{:<width$}  {:<21}  {:>5}  {:>8}  {:>8}  {:>8}  {:>8}  cause\n",
        "picture", "verdict", "score", "> 0", "> 1", "> 2", "> 10"
    );
    for (row, name) in rows.iter().zip(&names) {
        let _ = write!(text, "{name:<width$}  {:<21}  {:>5}", row.verdict, row.score);
        let counts = row.differing.map(super::Differing::by_threshold);
        for at in 0..4 {
            let count = counts.map_or_else(|| "–".into(), |counts| counts[at].1.to_string());
            let _ = write!(text, "  {count:>8}");
        }
        let _ = writeln!(text, "  {}", row.why());
    }
    text
}

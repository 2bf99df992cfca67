//! The table for people.

use std::fmt::Write as _;

use super::{Row, Verdict};

/// The head of the table and a line for each row.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:>2} {:<15} {:<19} {:<10} {:>8} {:>7} {:>7} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}  {}\n",
        "#",
        "class",
        "case",
        "kernel",
        "count",
        "f.hits",
        "f.miss",
        "roots",
        "wrong ppm",
        "p50 u",
        "p99.9 u",
        "worst t",
        "point",
        "normal",
        "mirror",
        "|1-l²|",
        "not fin.",
        "verdict"
    );
    for row in rows {
        let m = &row.metrics;
        let error = |x: Option<f64>| match x {
            None => "-".to_owned(),
            Some(x) if x != 0.0 && !(1e-2..1e5).contains(&x) => format!("{x:.1e}"),
            Some(x) => format!("{x:.2}"),
        };
        let misclassified = if m.wrong() == 0 { "-".to_owned() } else { format!("{:.1e}", m.misclassified) };
        let mut remarks = Vec::new();
        let mut remark = |what: &str, value: Option<u64>| {
            if let Some(value) = value {
                remarks.push(format!("{what} {value}"));
            }
        };
        remark("acne", m.acne);
        remark("leaks", m.leaks);
        remark("differing", m.differing);
        remark("inversions", (m.inversions > 0).then_some(m.inversions));
        remarks.extend(m.light_error.map(|error| format!("N·L error {error:.1e} u")));
        remarks.extend(m.power_error.map(|error| format!("power error {error:.1e}")));
        remarks.extend((!m.note.is_empty()).then(|| m.note.clone()));
        match &row.verdict {
            Verdict::Fail(why) => remarks.extend(why.iter().cloned()),
            Verdict::Refused(why) | Verdict::TooFew(why) => remarks.push(why.clone()),
            _ => {}
        }
        let _ = writeln!(
            text,
            "{:>2} {:<15} {:<19} {:<10} {:>8} {:>7} {:>7} {:>7} {:>9.1} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}  {:<11} {}",
            row.id,
            row.class,
            row.case,
            row.kernel,
            m.count,
            m.false_hits,
            m.false_misses,
            m.wrong_roots,
            m.per_million(m.wrong()),
            error(m.p50),
            error(m.p999),
            error(m.worst_t),
            error(m.worst_place),
            error(m.worst_normal),
            error(m.worst_mirrored),
            misclassified,
            m.not_finite,
            row.verdict.word(),
            remarks.join("; ")
        );
    }
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

//! Numbers as people read them.

/// `x` with three significant digits, without an exponent where it is short enough.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return "–".into();
    }
    let decade = x.abs().log10().floor() as i32;
    if (-4..6).contains(&decade) {
        format!("{x:.*}", usize::try_from(2 - decade).unwrap_or(0))
    } else {
        format!("{x:.1e}")
    }
}

/// A time in ms with its unit.
pub(crate) fn time(ms: f64) -> String {
    if ms >= 1000.0 { format!("{} s", short(ms / 1000.0)) } else { format!("{} ms", short(ms)) }
}

/// `count` of `total` as a share, in parts per million.
pub(crate) fn ppm(count: u64, total: u64) -> f64 {
    count as f64 * 1e6 / total.max(1) as f64
}

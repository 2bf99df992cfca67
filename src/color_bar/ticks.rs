//! Round numbers within a range: whole multiples of 1, 2 or 5 times a power of ten.

use crate::words::number;

/// Numbers that differ after so many digits are too long to stand beside a bar.
const MOST_STEPS: f64 = 1e9;
/// Letters from which on a number has an exponent where that makes it shorter.
const LONG: usize = 7;

/// A number beside a bar.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Its place between the ends of the range, 0 to 1.
    pub(super) part: f64,
    pub(super) label: String,
}

/// No more than `most` numbers between the ends of a range, or the only one that there is.
///
/// # Errors
///
/// Where they are too long to tell the values apart.
pub(super) fn ticks((from, to): (f64, f64), most: u32) -> Result<Vec<Tick>, String> {
    if from == to {
        return Ok(vec![Tick { part: 0.5, label: number(from) }]);
    }
    let (low, high) = (from.min(to), from.max(to));
    let refused = || format!("no short numbers tell values from {} to {} apart", number(low), number(high));
    let least = (high - low) / f64::from(most.max(1));
    if !least.is_finite() || low.abs().max(high.abs()) > MOST_STEPS * least || least < 1e-290 {
        return Err(refused());
    }
    let decade = least.log10().floor() as i32;
    // The least step that leaves no more than `most` numbers.
    for (factor, exponent) in [(1, decade), (2, decade), (5, decade), (1, decade + 1), (2, decade + 1)] {
        let step = factor as f64 * 10_f64.powi(exponent);
        // Ends that are multiples but for rounding count.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        if last - first < f64::from(most) {
            let multiples = || first as i64..=last as i64;
            let values: Vec<_> = multiples().map(|k| k * factor).collect();
            let part = |k: i64| ((k as f64 * step - from) / (to - from)).clamp(0.0, 1.0);
            let labels = labels(&values, exponent);
            return Ok(multiples().zip(labels).map(|(k, label)| Tick { part: part(k), label }).collect());
        }
    }
    Err(refused())
}

/// Each of `values` times 10 to the power of `exponent`, all with as many decimals, or with exponents of their own.
fn labels(values: &[i64], exponent: i32) -> Vec<String> {
    let longest = |labels: &[String]| labels.iter().map(|label| label.trim_start_matches('-').len()).max().unwrap_or(0);
    let plain: Vec<_> = values.iter().map(|&value| decimal(value, exponent)).collect();
    if longest(&plain) < LONG {
        return plain;
    }
    let short: Vec<_> = values.iter().map(|&value| scientific(value, exponent)).collect();
    if longest(&short) < longest(&plain) { short } else { plain }
}

fn decimal(value: i64, exponent: i32) -> String {
    let sign = if value < 0 { "-" } else { "" };
    let decimals = usize::try_from(-exponent).unwrap_or(0);
    let zeros = if value == 0 { 0 } else { usize::try_from(exponent).unwrap_or(0) };
    let digits = format!("{:0>width$}{:0>zeros$}", value.unsigned_abs(), "", width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    if decimals == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
}

fn scientific(value: i64, exponent: i32) -> String {
    if value == 0 {
        return "0".into();
    }
    let sign = if value < 0 { "-" } else { "" };
    let digits = value.unsigned_abs().to_string();
    let power = exponent + (digits.len() as u32).cast_signed() - 1;
    let (first, rest) = digits.split_at(1);
    let rest = rest.trim_end_matches('0');
    if rest.is_empty() { format!("{sign}{first}e{power}") } else { format!("{sign}{first}.{rest}e{power}") }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by it")]
mod tests {
    use super::*;

    fn labels_of(range: (f64, f64), most: u32) -> String {
        let ticks = ticks(range, most).unwrap();
        for Tick { part, label } in &ticks {
            let value = range.0 + part * (range.1 - range.0);
            let size = range.0.abs().max(range.1.abs());
            assert!((value - label.parse::<f64>().unwrap()).abs() <= 1e-9 * size, "{label} stands at {value}");
        }
        ticks.into_iter().map(|tick| tick.label).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn numbers_are_round() {
        for (range, most, expected) in [
            ((0.0, 10.0), 6, "0 2 4 6 8 10"),
            ((0.0, 10.0), 5, "0 5 10"),
            ((0.0, 10.0), 11, "0 1 2 3 4 5 6 7 8 9 10"),
            ((-1.0, 1.0), 6, "-1.0 -0.5 0.0 0.5 1.0"),
            ((0.3, 0.7), 6, "0.3 0.4 0.5 0.6 0.7"),
            ((2.0, -2.0), 6, "-2 -1 0 1 2"),
            ((-0.013, 0.0), 4, "-0.010 -0.005 0.000"),
            ((3.0, 4.7), 2, "3 4"),
            ((1.1, 1.9), 6, "1.2 1.4 1.6 1.8"),
            ((0.0, 90_000.0), 6, "0 20000 40000 60000 80000"),
            ((0.0, 1_000_000.0), 6, "0 2e5 4e5 6e5 8e5 1e6"),
            ((0.0, 1.5e-7), 4, "0 5e-8 1e-7 1.5e-7"),
            ((1_000_000.0, 1_000_010.0), 6, "1000000 1000002 1000004 1000006 1000008 1000010"),
            ((-3e200, 3e200), 4, "-2e200 0 2e200"),
        ] {
            assert_eq!(labels_of(range, most), expected);
        }
    }

    #[test]
    fn what_no_short_number_tells_apart_is_refused() {
        for range in [(1e12, 1e12 + 1.0), (f64::MIN, f64::MAX), (0.0, 1e-300)] {
            assert!(ticks(range, 6).unwrap_err().contains("no short numbers"), "{range:?}");
        }
    }

    #[test]
    fn there_are_never_more_than_fit() {
        for most in 1..12 {
            for k in 0..200 {
                let low = f64::from(k) * 0.37 - 31.0;
                let count = ticks((low, low + 1.7_f64.powi(k / 5 - 20)), most).map_or(0, |ticks| ticks.len());
                assert!(count <= most as usize, "{low} {most}: {count}");
            }
        }
    }
}

//! Axes, points and labels of the plots, as inline SVG; lengths in px.

use maud::{Markup, html};

use super::number::short;

/// A coordinate for an attribute.
pub(crate) fn px(x: f64) -> String {
    format!("{x:.1}")
}

/// Where values lie along one direction of a plot.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    logarithmic: bool,
}

impl Axis {
    /// A logarithmic axis over the positive ones of `values`, rounded outwards, from `from` to `to`.
    pub(crate) fn logarithmic(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if high > 0.0 { (low, high) } else { (1.0, 10.0) };
        let (low, high) = (step_below(low / 1.1), step_above(high * 1.1));
        Self { low, high, from, to, logarithmic: true }
    }

    /// A linear axis from 0 over `values`.
    pub(crate) fn from_zero(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let high = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        Self { low: 0.0, high: if high > 0.0 { high * 1.05 } else { 1.0 }, from, to, logarithmic: false }
    }

    /// Where `value` lies, kept within the axis.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let part = if self.logarithmic {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from + part.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Places and labels of the ticks.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let mut values = Vec::new();
        if self.logarithmic {
            let mut value = self.low;
            while value <= self.high * 1.001 {
                values.push(value);
                value = step_above(value * 1.01);
            }
            if values.len() > 7 {
                values.retain(|value| is_decade(*value));
            }
            let decades = values.len();
            values.retain(|value| decades <= 7 || (value.log10().round() as i32).rem_euclid(2) == 0);
        } else {
            let step = step_above(self.high / 6.0);
            values.extend((0..=10).map(|k| f64::from(k) * step).filter(|value| *value <= self.high));
        }
        values.into_iter().map(|value| (self.place(value), tick(value))).collect()
    }
}

/// A tick's label, without zeros at its end.
fn tick(value: f64) -> String {
    let text = short(value);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn decade(value: f64) -> f64 {
    10_f64.powi((value * (1.0 + 1e-9)).log10().floor() as i32)
}

fn is_decade(value: f64) -> bool {
    (value / decade(value) - 1.0).abs() < 1e-6
}

/// The least of 1, 2, 5 times a power of ten that is no less than `value`.
fn step_above(value: f64) -> f64 {
    let unit = decade(value);
    [1.0, 2.0, 5.0, 10.0].map(|k| k * unit).into_iter().find(|step| *step >= value * (1.0 - 1e-9)).unwrap_or(value)
}

/// The greatest of 1, 2, 5 times a power of ten that is no greater than `value`.
fn step_below(value: f64) -> f64 {
    let unit = decade(value);
    [5.0, 2.0, 1.0].map(|k| k * unit).into_iter().find(|step| *step <= value * (1.0 + 1e-9)).unwrap_or(value)
}

/// The rectangle that the values of a plot lie in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

/// A drawing of this size whose meaning `label` says in words.
pub(crate) fn drawing(width: f64, height: f64, label: &str, content: &Markup) -> Markup {
    html! {
        svg viewBox=(format!("0 0 {width:.0} {height:.0}")) role="img" aria-label=(label) { (content) }
    }
}

/// Grid lines and labels of a horizontal axis below the frame, and its title.
pub(crate) fn x_axis(frame: &Frame, ticks: &[(f64, String)], title: &str) -> Markup {
    html! {
        @for (x, label) in ticks {
            line.grid x1=(px(*x)) x2=(px(*x)) y1=(px(frame.top)) y2=(px(frame.bottom)) {}
            text.tick x=(px(*x)) y=(px(frame.bottom + 18.0)) text-anchor="middle" { (label) }
        }
        line.axis x1=(px(frame.left)) x2=(px(frame.right)) y1=(px(frame.bottom)) y2=(px(frame.bottom)) {}
        text.title x=(px(f64::midpoint(frame.left, frame.right))) y=(px(frame.bottom + 40.0)) text-anchor="middle" { (title) }
    }
}

/// Grid lines and labels of a vertical axis left of the frame; its title stands above the frame.
pub(crate) fn y_axis(frame: &Frame, ticks: &[(f64, String)], title: &str) -> Markup {
    html! {
        @for (y, label) in ticks {
            line.grid x1=(px(frame.left)) x2=(px(frame.right)) y1=(px(*y)) y2=(px(*y)) {}
            text.tick x=(px(frame.left - 8.0)) y=(px(y + 4.0)) text-anchor="end" { (label) }
        }
        line.axis x1=(px(frame.left)) x2=(px(frame.left)) y1=(px(frame.top)) y2=(px(frame.bottom)) {}
        text.title x=(px(frame.left - 52.0)) y=(px(frame.top - 16.0)) { (title) }
    }
}

/// Moves places apart until neighbours have at least `gap` between them, keeping their order and staying within
/// `low`…`high` where they fit.
pub(crate) fn spread(places: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]).then(a.cmp(b)));
    let mut moved = places.to_vec();
    let mut least = low;
    for &index in &order {
        moved[index] = moved[index].max(least);
        least = moved[index] + gap;
    }
    let mut greatest = high;
    for &index in order.iter().rev() {
        moved[index] = moved[index].min(greatest);
        greatest = moved[index] - gap;
    }
    moved
}

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect(pub(crate) [f64; 4]);

impl Rect {
    fn overlaps(&self, other: &Self) -> bool {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        a < g && e < c && b < h && f < d
    }

    fn is_within(&self, other: &Self) -> bool {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        a >= e && b >= f && c <= g && d <= h
    }
}

/// Where the labels of `marks` go, `widths` wide, each as left end and base line: beside, above or below the mark, wherever
/// it meets no mark and no label before it and stays within `bounds`.
pub(crate) fn place_labels(marks: &[Rect], widths: &[f64], bounds: Rect) -> Vec<(f64, f64)> {
    const HEIGHT: f64 = 17.0;
    let mut taken = marks.to_vec();
    let mut places = Vec::new();
    for (Rect([left, top, right, bottom]), width) in marks.iter().zip(widths) {
        let middle = f64::midpoint(*top, *bottom) - HEIGHT / 2.0;
        let start = f64::midpoint(*left, *right) - width / 2.0;
        let mut candidates = vec![(right + 5.0, middle), (left - 5.0 - width, middle)];
        for step in 0..8 {
            let far = f64::from(step) * (HEIGHT + 2.0);
            for x in [start, *right - width + 20.0, *left - 20.0] {
                candidates.extend([(x, top - HEIGHT - 1.0 - far), (x, bottom + 1.0 + far)]);
            }
        }
        let label = |(x, y): (f64, f64)| Rect([x, y, x + width, y + HEIGHT]);
        let free = |place: &(f64, f64)| {
            label(*place).is_within(&bounds) && !taken.iter().any(|other| label(*place).overlaps(other))
        };
        let (x, y) = candidates.iter().copied().find(free).unwrap_or(candidates[0]);
        taken.push(label((x, y)));
        places.push((x, y + 13.0));
    }
    places
}

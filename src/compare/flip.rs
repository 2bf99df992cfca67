//! FLIP, the difference that somebody sees who flips between two pictures: P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson,
//! K. Åström and M. D. Fairchild, FLIP: A Difference Evaluator for Alternating Images, Proceedings of the ACM on Computer Graphics and
//! Interactive Techniques 3 (2020), 15. Formulas and constants are the paper's where nothing else is said. Calculated in `f64`.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

use crate::film::Picture;

/// Pixels in a degree of the field of view: the paper's observer, 0.7 m before a screen 0.7 m wide with 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Contrast sensitivity in opponent colours, the paper's Table 1: sums of a·√(π/b)·exp(−π²x²/b), x in degrees. Achromatic;
const ACHROMATIC: (f64, f64) = (1.0, 0.0047);
/// red and green;
const RED_GREEN: (f64, f64) = (1.0, 0.0053);
/// blue and yellow.
const BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Exponent of colour differences, `q_c`.
const COLOR_EXPONENT: f64 = 0.7;
/// Differences up to this part of the greatest, `p_c`,
const SMALL: f64 = 0.4;
/// take this part of the range, `p_t`.
const SMALL_TAKES: f64 = 0.95;

/// Width of the eye's detectors of edges and points, w, in degrees: their standard deviation is half of it.
const FEATURE_WIDTH: f64 = 0.082;
/// Exponent of feature differences, `q_f`.
const FEATURE_EXPONENT: f64 = 0.5;

/// Chromaticities x and y of sRGB's primaries (IEC 61966-2-1),
const PRIMARIES: [DVec2; 3] = [DVec2::new(0.64, 0.33), DVec2::new(0.3, 0.6), DVec2::new(0.15, 0.06)];
/// and of its white, D65, with the digits of CIE 15.
const WHITE: DVec2 = DVec2::new(0.31271, 0.32902);

/// Rows that are calculated together.
const BAND: usize = 64;

/// The mean FLIP of two pictures of one size, 0 (the same) to 1, seen at [`PIXELS_PER_DEGREE`].
pub(super) fn mean_flip(a: &Picture, b: &Picture) -> f64 {
    let eye = Eye::new();
    let height = a.height() as usize;
    let bands = (0..height.div_ceil(BAND)).into_par_iter().map(|band| {
        let top = band * BAND;
        eye.band([a, b], top, (top + BAND).min(height))
    });
    // Summed in the order of rows, so that the last digit does not depend on threads.
    let sum: f64 = bands.collect::<Vec<_>>().iter().sum();
    sum / a.pixel_count() as f64
}

/// Filters and colours, which are the same for all pixels.
struct Eye {
    colors: Colors,
    achromatic: Vec<f64>,
    red_green: Vec<f64>,
    /// Each with its part of the sum.
    blue_yellow: [(Vec<f64>, f64); 2],
    /// A Gaussian, and its first and second derivative.
    smooth: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
    /// The greatest colour difference, that of green and blue.
    greatest: f64,
}

/// What an eye sees of rows of a picture.
struct Seen {
    /// L*a*b* with the Hunt effect.
    colors: Vec<DVec3>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Eye {
    fn new() -> Self {
        let colors = Colors::new();
        // Three standard deviations of the widest, for all.
        let widest = (BLUE_YELLOW[0].1 / (2.0 * PI * PI)).sqrt();
        let radius = (3.0 * widest * PIXELS_PER_DEGREE).ceil() as i32;
        let contrast = |(_, b): (f64, f64)| sampled(radius, |x| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp());
        // Of the kernel on the plane, all of whose weights together are 1.
        let weight = |(a, b): (f64, f64)| a * (PI / b).sqrt() * contrast((a, b)).iter().sum::<f64>().powi(2);
        let all: f64 = BLUE_YELLOW.iter().map(|&term| weight(term)).sum();

        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * deviation).ceil() as i32;
        let gaussian = |x: f64| (-0.5 * (x / deviation).powi(2)).exp();
        let greatest = difference(colors.lab(DVec3::Y), colors.lab(DVec3::Z));
        Self {
            colors,
            achromatic: balanced(contrast(ACHROMATIC)),
            red_green: balanced(contrast(RED_GREEN)),
            blue_yellow: BLUE_YELLOW.map(|term| (balanced(contrast(term)), weight(term) / all)),
            smooth: balanced(sampled(radius, gaussian)),
            edge: balanced(sampled(radius, |x| -x * gaussian(x))),
            point: balanced(sampled(radius, |x| ((x / deviation).powi(2) - 1.0) * gaussian(x))),
            greatest,
        }
    }

    /// The sum over the pixels of the rows from `top` to before `bottom`.
    fn band(&self, pictures: [&Picture; 2], top: usize, bottom: usize) -> f64 {
        let [a, b] = pictures;
        let rows = self.around(a, top, bottom);
        let width = a.width() as usize;
        let samples = rows.start * width..rows.end * width;
        if a.pixels()[samples.clone()] == b.pixels()[samples] {
            return 0.0;
        }
        let [a, b] = pictures.map(|picture| self.seen(picture, top, bottom));
        (0..a.colors.len()).map(|at| self.flip(&a, &b, at)).sum()
    }

    /// The rows that those from `top` to before `bottom` depend on.
    fn around(&self, picture: &Picture, top: usize, bottom: usize) -> std::ops::Range<usize> {
        let reach = self.achromatic.len().max(self.smooth.len()) / 2;
        top.saturating_sub(reach)..(bottom + reach).min(picture.height() as usize)
    }

    fn flip(&self, a: &Seen, b: &Seen, at: usize) -> f64 {
        let small = SMALL * self.greatest;
        let color = difference(a.colors[at], b.colors[at]);
        let color = if color < small {
            SMALL_TAKES / small * color
        } else {
            SMALL_TAKES + (color - small) / (self.greatest - small) * (1.0 - SMALL_TAKES)
        };
        let feature = (a.edges[at] - b.edges[at]).abs().max((a.points[at] - b.points[at]).abs());
        color.powf(1.0 - (FRAC_1_SQRT_2 * feature).powf(FEATURE_EXPONENT))
    }

    fn seen(&self, picture: &Picture, top: usize, bottom: usize) -> Seen {
        let width = picture.width() as usize;
        let around = self.around(picture, top, bottom);
        // Along the rows first: what is filtered in one way down the columns stands together.
        let (mut achromatic, mut red_green) = (Vec::new(), Vec::new());
        let mut blue_yellow = [Vec::new(), Vec::new()];
        let (mut smooth, mut edge, mut point) = (Vec::new(), Vec::new(), Vec::new());
        for row in around.clone() {
            let pixels = picture.pixels()[row * width..(row + 1) * width].iter();
            let opponent: Vec<DVec3> = pixels.map(|&pixel| self.colors.opponent(pixel)).collect();
            let plane = |channel: usize| opponent.iter().map(move |color| color[channel]).collect::<Vec<f64>>();
            let light: Vec<f64> = opponent.iter().map(|color| (color.x + 16.0) / 116.0).collect();
            achromatic.push(across(&plane(0), &self.achromatic));
            red_green.push(across(&plane(1), &self.red_green));
            for (rows, (kernel, _)) in blue_yellow.iter_mut().zip(&self.blue_yellow) {
                rows.push(across(&plane(2), kernel));
            }
            smooth.push(across(&light, &self.smooth));
            edge.push(across(&light, &self.edge));
            point.push(across(&light, &self.point));
        }
        let mut seen = Seen { colors: Vec::new(), edges: Vec::new(), points: Vec::new() };
        for row in top - around.start..bottom - around.start {
            let achromatic = down(&achromatic, row, &self.achromatic);
            let red_green = down(&red_green, row, &self.red_green);
            let [(wide, much), (narrow, little)] = &self.blue_yellow;
            let [wide, narrow] = [down(&blue_yellow[0], row, wide), down(&blue_yellow[1], row, narrow)];
            seen.colors.extend((0..width).map(|x| {
                let blue_yellow = much * wide[x] + little * narrow[x];
                self.colors.lab(self.colors.linear(DVec3::new(achromatic[x], red_green[x], blue_yellow)))
            }));
            let length = |along: &[Vec<f64>], kernel: &[f64]| {
                let (along, across) = (down(along, row, &self.smooth), down(&smooth, row, kernel));
                along.into_iter().zip(across).map(|(x, y)| x.hypot(y)).collect::<Vec<_>>()
            };
            seen.edges.extend(length(&edge, &self.edge));
            seen.points.extend(length(&point, &self.point));
        }
        seen
    }
}

/// A kernel's weights, from −`radius` to `radius`.
fn sampled(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// The kernel with positive weights that together are 1, and negative ones that are −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| kernel.iter().filter(|&&weight| weight * sign > 0.0).sum::<f64>().abs();
    let (above, below) = (sum(1.0), sum(-1.0));
    let scaled = |weight: f64| match weight {
        _ if weight > 0.0 => weight / above,
        _ if weight < 0.0 => weight / below,
        _ => 0.0,
    };
    kernel.into_iter().map(scaled).collect()
}

/// A row, beyond whose ends their pixels go on, filtered.
fn across(row: &[f64], kernel: &[f64]) -> Vec<f64> {
    let radius = kernel.len() / 2;
    let padded = [&vec![row[0]; radius][..], row, &vec![row[row.len() - 1]; radius]].concat();
    let mut filtered = vec![0.0; row.len()];
    for (at, weight) in kernel.iter().enumerate() {
        filtered.iter_mut().zip(&padded[at..]).for_each(|(sum, value)| *sum += weight * value);
    }
    filtered
}

/// The row at `at`, filtered down the columns; beyond the first and the last row these go on.
fn down(rows: &[Vec<f64>], at: usize, kernel: &[f64]) -> Vec<f64> {
    let mut filtered = vec![0.0; rows[at].len()];
    for (offset, weight) in kernel.iter().enumerate() {
        let row = &rows[(at + offset).saturating_sub(kernel.len() / 2).min(rows.len() - 1)];
        filtered.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
    }
    filtered
}

/// The distance `HyAB` of two colours in L*a*b*, to the power of [`COLOR_EXPONENT`].
fn difference(a: DVec3, b: DVec3) -> f64 {
    let DVec3 { x, y, z } = a - b;
    (x.abs() + y.hypot(z)).powf(COLOR_EXPONENT)
}

/// The way between colour spaces.
struct Colors {
    /// Linear colours of sRGB's levels.
    of_level: Vec<f64>,
    /// From linear colours to X, Y and Z in parts of the white's.
    to_xyz: DMat3,
    to_linear: DMat3,
}

impl Colors {
    fn new() -> Self {
        // IEC 61966-2-1.
        let decoded = |c: f64| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        let xyz = |at: DVec2| DVec3::new(at.x / at.y, 1.0, (1.0 - at.x - at.y) / at.y);
        let [red, green, blue] = PRIMARIES.map(xyz);
        let (primaries, white) = (DMat3::from_cols(red, green, blue), xyz(WHITE));
        // All three together are the white.
        let to_xyz =
            DMat3::from_diagonal(white.recip()) * primaries * DMat3::from_diagonal(primaries.inverse() * white);
        Self {
            of_level: (0..=255).map(|level| decoded(f64::from(level) / 255.0)).collect(),
            to_xyz,
            to_linear: to_xyz.inverse(),
        }
    }

    /// `YyCxCz`, linear opponent colours.
    fn opponent(&self, pixel: [u8; 3]) -> DVec3 {
        let DVec3 { x, y, z } = self.to_xyz * DVec3::from_array(pixel.map(|level| self.of_level[usize::from(level)]));
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }

    /// From `YyCxCz` to linear colours that a screen can show.
    fn linear(&self, opponent: DVec3) -> DVec3 {
        let y = (opponent.x + 16.0) / 116.0;
        let xyz = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
        (self.to_linear * xyz).clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// L*a*b* (CIE 15) of a linear colour; a* and b* are less in the dark, as Hunt has found.
    fn lab(&self, linear: DVec3) -> DVec3 {
        let step = 6.0_f64 / 29.0;
        let root = |t: f64| if t > step.powi(3) { t.cbrt() } else { t / (3.0 * step * step) + 4.0 / 29.0 };
        let DVec3 { x, y, z } = (self.to_xyz * linear).map(root);
        let lightness = 116.0 * y - 16.0;
        DVec3::new(lightness, 500.0 * (x - y) * 0.01 * lightness, 200.0 * (y - z) * 0.01 * lightness)
    }
}

//! The least value of a function of three variables.

use glam::DVec3;

/// Most evaluations of the function.
const MOST: usize = 120;

/// A minimum near `start`, with first steps of this length (Nelder, Mead, "A simplex method for function minimization", 1965).
pub(super) fn minimum(start: DVec3, step: f64, f: impl Fn(DVec3) -> f64) -> DVec3 {
    let mut corners =
        [start, start + DVec3::X * step, start + DVec3::Y * step, start + DVec3::Z * step].map(|x| (f(x), x));
    let mut evaluations = corners.len();
    while evaluations < MOST {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [best, _, second, worst] = corners;
        if best.0 == 0.0 || (worst.1 - best.1).length() < step * 1e-6 {
            break;
        }
        let middle = (corners[0].1 + corners[1].1 + corners[2].1) / 3.0;
        let mut along = |factor: f64| {
            evaluations += 1;
            let x = middle + (middle - worst.1) * factor;
            (f(x), x)
        };
        let reflected = along(1.0);
        if reflected.0 < best.0 {
            let expanded = along(2.0);
            corners[3] = if expanded.0 < reflected.0 { expanded } else { reflected };
        } else if reflected.0 < second.0 {
            corners[3] = reflected;
        } else {
            let contracted = along(if reflected.0 < worst.0 { 0.5 } else { -0.5 });
            if contracted.0 < worst.0.min(reflected.0) {
                corners[3] = contracted;
            } else {
                for corner in &mut corners[1..] {
                    let x = (corner.1 + best.1) / 2.0;
                    *corner = (f(x), x);
                }
                evaluations += 3;
            }
        }
    }
    corners.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(start, |corner| corner.1)
}

//! How time grows with size.

/// The exponent e of the power law t ∝ nᵉ through points (n, t): the least-squares slope of log t over log n; `None` with
/// fewer than two different sizes, or where a size or time is not positive.
pub fn growth_exponent(points: &[(f64, f64)]) -> Option<f64> {
    if points.iter().any(|&(n, t)| !(n > 0.0 && t > 0.0 && n.is_finite() && t.is_finite())) {
        return None;
    }
    let logs: Vec<_> = points.iter().map(|&(n, t)| (n.ln(), t.ln())).collect();
    let count = logs.len().max(1) as f64;
    let mean = |read: fn(&(f64, f64)) -> f64| logs.iter().map(read).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let spread: f64 = logs.iter().map(|point| (point.0 - x).powi(2)).sum();
    let common: f64 = logs.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    (spread > 1e-12).then(|| common / spread)
}

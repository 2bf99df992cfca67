//! Where on the picture a sphere can be: what none covers is background and needs no ray.

use glam::DVec3;

use crate::area::Area;
use crate::camera::Camera;
use crate::geometry::Ellipsoid;

/// Edge of a tile in pixels; the workgroup of the render kernel has this size in both directions.
pub const TILE: u32 = 8;

/// Where one sphere can be on the picture.
#[derive(Debug, Clone)]
pub(crate) struct Bounds {
    /// First and last column.
    pub(crate) columns: [u32; 2],
    /// First and last row.
    pub(crate) rows: [u32; 2],
    /// Its outline, where the sphere is large enough for the corners of the rectangle to matter.
    outline: Option<Box<Outline>>,
}

/// What a camera makes of spheres.
#[derive(Debug)]
pub(crate) struct Projector {
    axes: [DVec3; 3],
    near: f64,
    is_parallel: bool,
    across: Pixels,
    down: Pixels,
    area: Area,
}

impl Projector {
    pub(crate) fn new(camera: &Camera) -> Self {
        let (across, down) = (Pixels::across(camera), Pixels::down(camera));
        let (axes, near, is_parallel) = (camera.axes(), camera.near(), camera.is_parallel());
        Self { axes, near, is_parallel, across, down, area: camera.area() }
    }

    /// Width and height of the picture.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.across.count, self.down.count)
    }

    /// The part of the picture that is rendered.
    pub(crate) fn area(&self) -> Area {
        self.area
    }

    /// Columns and rows that the part of the ellipsoid beyond the image plane can cover.
    pub(crate) fn bounds(&self, center: DVec3, semi_axes: DVec3) -> Option<Bounds> {
        let seen = self.axes.map(|axis| axis.dot(center));
        let ([across, down], whole) = if self.is_parallel {
            (self.spans(seen, semi_axes)?, false)
        } else {
            match ball_slopes(seen, semi_axes, self.near) {
                Some(slopes) => (slopes, true),
                None => self.slopes(seen, semi_axes)?,
            }
        };
        let columns = self.across.between(across)?;
        let rows = self.down.between(down)?;
        let is_large = rows[1] - rows[0] > 3 * TILE && columns[1] - columns[0] > 3 * TILE;
        let ellipsoid = || Ellipsoid::with_axes(center, semi_axes);
        let outline = (is_large && whole).then(|| Box::new(Outline::new(&ellipsoid(), self.axes, across)));
        Some(Bounds { columns, rows, outline })
    }

    /// The slopes of an ellipsoid at `seen` in the picture's axes, and whether all of it is beyond the image plane; none where
    /// nothing of it is.
    fn slopes(&self, [x, y, z]: [f64; 3], semi_axes: DVec3) -> Option<([[f64; 2]; 2], bool)> {
        let [half_x, half_y, half_z] = self.axes.map(|axis| axis * semi_axes);
        let depth = half_z.length();
        let across = slopes([x, z], [half_x, half_z], depth, self.near)?;
        let down = slopes([y, z], [half_y, half_z], depth, self.near)?;
        Some(([across, down], z + depth < -self.near))
    }

    /// The same for parallel rays: places, which stand for slopes there.
    fn spans(&self, [x, y, z]: [f64; 3], semi_axes: DVec3) -> Option<[[f64; 2]; 2]> {
        let [half_x, half_y, depth] = self.axes.map(|axis| (axis * semi_axes).length());
        let is_seen = !(z - depth > -self.near);
        is_seen.then_some([[x - half_x, x + half_x], [y - half_y, y + half_y]])
    }
}

impl Bounds {
    /// Whether all its rows see it in the same columns.
    pub(crate) fn is_rectangle(&self) -> bool {
        self.outline.is_none()
    }

    /// The columns in which the rows from `first` up to `end` can see it.
    pub(crate) fn columns_in(&self, [first, end]: [u32; 2], projector: &Projector) -> [u32; 2] {
        let Some(outline) = &self.outline else {
            return self.columns;
        };
        let rows = &projector.down;
        let slopes = outline.across(rows.samples([first, end - 1]).map(|row| rows.slope(row)));
        match slopes.and_then(|slopes| projector.across.between(slopes)) {
            // Never beyond the rectangle, which rounding could make it, and never empty, which only rounding leaves it.
            Some([left, right]) if left <= self.columns[1] && right >= self.columns[0] => {
                [left.max(self.columns[0]), right.min(self.columns[1])]
            }
            _ => self.columns,
        }
    }
}

/// The ellipse that an ellipsoid wholly beyond the image plane covers, in slopes x/−z and y/−z in the picture's axes:
/// directions d = (x, y, −1) with (S'·d')² ≥ |d'|²(|S'|² − r²), primes in object space.
#[derive(Debug, Clone, Copy)]
struct Outline {
    /// S'.
    center: DVec3,
    /// d' is x times the first, y times the second, plus the third.
    axes: [DVec3; 3],
    /// r² and |S'|² − r².
    radius_squared: f64,
    rest: f64,
    /// The least and the greatest x, and the y of each.
    extremes: [[f64; 2]; 2],
}

impl Outline {
    /// Of `ellipsoid`, whose slopes lie `within`, in the picture's `axes`.
    fn new(ellipsoid: &Ellipsoid, axes: [DVec3; 3], within: [f64; 2]) -> Self {
        let center = ellipsoid.center * ellipsoid.inv_scale;
        let [right, up, back] = axes.map(|axis| axis * ellipsoid.inv_scale);
        let radius_squared = ellipsoid.radius * ellipsoid.radius;
        let rest = center.length_squared() - radius_squared;
        let outline = Self { center, axes: [right, up, -back], radius_squared, rest, extremes: [[0.0; 2]; 2] };
        let y_at = |x: f64| {
            let [b, a] = outline.products(right * x - back, up);
            -b / a
        };
        Self { extremes: within.map(|x| [x, y_at(x)]), ..outline }
    }

    /// The bilinear form (S'·a')(S'·d') − (a'·d')(|S'|² − r²) of an axis a' with d' and with itself.
    fn products(&self, direction: DVec3, axis: DVec3) -> [f64; 2] {
        let along = self.center.dot(axis);
        [direction, axis].map(|d| along * self.center.dot(d) - self.rest * axis.dot(d))
    }

    /// The x at which the outline has this y; none beyond it.
    fn at(&self, y: f64) -> Option<[f64; 2]> {
        let [right, up, forward] = self.axes;
        let row = up * y + forward;
        let [b, a] = self.products(row, right);
        // The plane of the row meets the ellipsoid where its distance from the centre is at most r.
        let normal = right.cross(row);
        let distance = self.center.dot(normal);
        let discriminant = self.rest * (self.radius_squared * normal.length_squared() - distance * distance);
        (discriminant >= 0.0).then(|| [-1.0, 1.0].map(|sign| (-b + sign * discriminant.sqrt()) / a))
    }

    /// Least and greatest x between two y: the outline is convex, so they are at the ends or the extremes.
    fn across(&self, ys: [f64; 2]) -> Option<[f64; 2]> {
        let (low, high) = (ys[0].min(ys[1]), ys[0].max(ys[1]));
        let inside = self.extremes.iter().filter(|[_, y]| (low..=high).contains(y)).map(|&[x, _]| x);
        let xs = ys.iter().filter_map(|&y| self.at(y)).flatten().chain(inside);
        xs.map(|x| [x, x]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    }
}

/// The pixels of a picture in one direction.
#[derive(Debug)]
struct Pixels {
    count: u32,
    /// Where a pixel's first and last sample are.
    samples: [f64; 2],
    /// Distance of the image plane, and 1 for parallel rays; the edge on it where pixels begin; and pixels per unit of length, negative where
    /// they go down.
    near: f64,
    edge: f64,
    per_unit: f64,
}

impl Pixels {
    fn across(camera: &Camera) -> Self {
        Self::new(camera.width(), camera.samples_across(), camera, camera.x_at(0.0), camera.window_size()[0])
    }

    fn down(camera: &Camera) -> Self {
        Self::new(camera.height(), camera.samples_down(), camera, camera.y_at(0.0), -camera.window_size()[1])
    }

    fn new(count: u32, samples: [f64; 2], camera: &Camera, edge: f64, size: f64) -> Self {
        let per_unit = f64::from(count) / size;
        // Where that is beyond the range of f64, all bounds are left open.
        let per_unit = if per_unit.is_finite() { per_unit } else { f64::NAN };
        let near = if camera.is_parallel() { 1.0 } else { camera.near() };
        Self { count, samples, near, edge, per_unit }
    }

    /// Where in pixels from the edge the rays with this slope meet the image plane.
    fn place(&self, slope: f64) -> f64 {
        (slope * self.near - self.edge) * self.per_unit
    }

    /// The inverse.
    fn slope(&self, place: f64) -> f64 {
        (place / self.per_unit + self.edge) / self.near
    }

    /// More than rounding has taken from places between `a` and `b`. What it takes from rays is in the size of the spheres:
    /// `ERROR_STEPS` in `src/accel/bounds.rs`.
    fn margin(&self, [a, b]: [f64; 2]) -> f64 {
        (f64::from(self.count) + a.abs().max(b.abs())) / 65536.0
    }

    /// Where samples of the first of these pixels begin and those of the last end.
    fn samples(&self, pixels: [u32; 2]) -> [f64; 2] {
        let [first, last] = pixels.map(f64::from);
        let margin = self.margin([first, last]);
        [first + self.samples[0] - margin, last + self.samples[1] + margin]
    }

    /// The pixels that have a sample between two slopes; none where no pixel has.
    fn between(&self, slopes: [f64; 2]) -> Option<[u32; 2]> {
        let places = slopes.map(|slope| self.place(slope));
        let [a, b] = places;
        let margin = self.margin(places);
        let (low, high) = (a.min(b) - margin - self.samples[1], a.max(b) + margin - self.samples[0]);
        let last = self.count - 1;
        if low > f64::from(last) || high < 0.0 {
            return None;
        }
        // NaN comes from products beyond the range of f64: then the bound is left open. Conversions cut off fractions, take NaN for 0
        // and what is out of range for the end of it.
        let high = if high.is_nan() { last } else { (high as u32).min(last) };
        let whole = low as u32;
        let low = whole + u32::from(f64::from(whole) < low);
        (low <= high).then_some([low, high])
    }
}

/// Across and down, the least and the greatest x/(−z) of a ball that lies wholly beyond z = −near; none of anything else. What [`slopes`]
/// has for it, with fewer operations.
fn ball_slopes([x, y, z]: [f64; 3], semi_axes: DVec3, near: f64) -> Option<[[f64; 2]; 2]> {
    let radius = semi_axes.x;
    // |(x, z)|² − r² is x² and this.
    let rest = (z - radius) * (z + radius);
    if semi_axes != DVec3::splat(radius) || !(z + radius < -near && rest > 0.0) {
        return None;
    }
    let per_rest = 1.0 / rest;
    Some([x, y].map(|x| {
        let (middle, half) = (-x * z * per_rest, radius * (x * x + rest).sqrt() * per_rest);
        [middle - half, middle + half]
    }))
}

/// Least and greatest x/(−z) where an ellipsoid around (x, z) lies beyond z = −near; none where it does not.
///
/// `half_x` and `half_z` are the axes x and z times the semi-axes: their products are the entries of the matrix D for which
/// a plane with normal n at the distance n·c of the centre is tangent where nᵀDn = (n·c)². `depth` is |`half_z`|.
fn slopes([x, z]: [f64; 2], [half_x, half_z]: [DVec3; 2], depth: f64, near: f64) -> Option<[f64; 2]> {
    if z - depth > -near {
        return None;
    }
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    let mut include = |slope: f64| ends = [ends[0].min(slope), ends[1].max(slope)];
    let (mixed, deep) = (half_x.dot(half_z), half_z.length_squared());
    let area = half_x.cross(half_z).length_squared();
    // Tangents from the eye: lines x + m z = 0 at the distance of the ellipse's support. The discriminant is a difference of
    // sums of squares, so that no other products cancel.
    let a = z * z - deep;
    let discriminant = (half_z * x - half_x * z).length_squared() - area;
    if z + depth < -near && a > 0.0 && discriminant >= 0.0 {
        // Wholly beyond the image plane, and so are the points that the tangents touch.
        let (middle, half) = ((mixed - x * z) / a, discriminant.sqrt() / a);
        return Some([middle - half, middle + half]);
    }
    if a != 0.0 && discriminant >= 0.0 {
        for sign in [-1.0, 1.0] {
            let m = (mixed - x * z + sign * discriminant.sqrt()) / a;
            let support = half_x + half_z * m;
            let touch = z - half_z.dot(support) * (x + m * z) / support.length_squared();
            if touch <= -near {
                include(m);
            }
        }
    }
    // The cut with the image plane.
    let height = (-near - z) / depth;
    if height.abs() <= 1.0 {
        let middle = x + mixed / depth * height;
        let half = area.sqrt() / depth * (1.0 - height * height).sqrt();
        include((middle - half) / near);
        include((middle + half) / near);
    }
    if ends[0] > ends[1] {
        // Only rounding leaves neither tangent nor cut: leave both ends open.
        return Some([f64::NAN, f64::NAN]);
    }
    Some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// What is left out for balls changes nothing.
    #[test]
    fn slopes_of_balls_are_those_of_ellipsoids() {
        let mut random = Random::new(9, 1);
        let mut balls = 0;
        for _ in 0..20_000 {
            let (center, radius) = (random.in_box(8.0) + DVec3::NEG_Z * 6.0, random.magnitude(-3.0, 1.0));
            let semi_axes = DVec3::splat(radius);
            let halves = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * radius);
            let general = [center.x, center.y].into_iter().zip(halves);
            let general = general.map(|(x, half)| slopes([x, center.z], [half, halves[2]], radius, 1.0));
            let Some(found) = ball_slopes(center.to_array(), semi_axes, 1.0) else { continue };
            balls += 1;
            for (found, expected) in found.into_iter().zip(general) {
                let expected = expected.expect("it is seen");
                // The nearer to the plane of the eye, the longer are both.
                let room = 1e-9 * (1.0 + expected[0].abs().max(expected[1].abs()));
                let is_same = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= room);
                assert!(is_same, "{center} {radius}: {found:?}, not {expected:?}");
            }
        }
        assert!(balls > 5000, "{balls}");
        assert_eq!(ball_slopes([0.0, 0.0, -9.0], DVec3::new(1.0, 1.0, 1.1), 1.0), None);
        assert_eq!(ball_slopes([0.0, 0.0, -1.5], DVec3::ONE, 1.0), None, "a part of it is before the plane");
    }
}

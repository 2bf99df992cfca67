//! Where on the picture a sphere can be: what none covers is background and needs no ray.

use glam::DVec3;

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

impl Bounds {
    /// Columns and rows that the part of the ellipsoid beyond the image plane can cover.
    pub(crate) fn new(center: DVec3, semi_axes: DVec3, camera: &Camera) -> Option<Self> {
        let axes = camera.axes();
        let [x, y, z] = axes.map(|axis| axis.dot(center));
        let [half_x, half_y, half_z] = axes.map(|axis| axis * semi_axes);
        let near = camera.near();
        let depth = half_z.length();
        if camera.is_parallel() {
            let (half_x, half_y) = (half_x.length(), half_y.length());
            let is_seen = !(z - depth > -near);
            let columns = Pixels::across(camera).between([x - half_x, x + half_x].map(|x| camera.column_of(x)));
            let rows = Pixels::down(camera).between([y - half_y, y + half_y].map(|y| camera.row_of(y)));
            return is_seen.then_some(Self { columns: columns?, rows: rows?, outline: None });
        }
        let across = slopes([x, z], [half_x, half_z], depth, near)?;
        let down = slopes([y, z], [half_y, half_z], depth, near)?;
        let columns = columns_between(across, camera)?;
        let rows = Pixels::down(camera).between(down.map(|slope| camera.row_of(slope * near)))?;
        let is_large = rows[1] - rows[0] > 3 * TILE && columns[1] - columns[0] > 3 * TILE;
        let whole = z + depth < -near;
        let ellipsoid = || Ellipsoid::with_axes(center, semi_axes);
        let outline = (is_large && whole).then(|| Box::new(Outline::new(&ellipsoid(), axes, across)));
        Some(Self { columns, rows, outline })
    }

    /// The columns in which the rows from `first` up to `end` can see it.
    pub(crate) fn columns_in(&self, [first, end]: [u32; 2], camera: &Camera) -> [u32; 2] {
        let Some(outline) = &self.outline else {
            return self.columns;
        };
        let rows = Pixels::down(camera).samples([first, end - 1]);
        let slopes = outline.across(rows.map(|row| camera.y_at(row) / camera.near()));
        match slopes.and_then(|slopes| columns_between(slopes, camera)) {
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

/// The columns of pixels that have samples between two slopes x/−z.
fn columns_between(slopes: [f64; 2], camera: &Camera) -> Option<[u32; 2]> {
    Pixels::across(camera).between(slopes.map(|slope| camera.column_of(slope * camera.near())))
}

/// The pixels of a picture in one direction.
struct Pixels {
    count: u32,
    /// Where a pixel's first and last sample are.
    samples: [f64; 2],
}

impl Pixels {
    fn across(camera: &Camera) -> Self {
        Self { count: camera.width(), samples: camera.samples_across() }
    }

    fn down(camera: &Camera) -> Self {
        Self { count: camera.height(), samples: camera.samples_down() }
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

    /// The pixels that have a sample between two places; none where no pixel has.
    fn between(&self, places: [f64; 2]) -> Option<[u32; 2]> {
        let [a, b] = places;
        let margin = self.margin(places);
        let (low, high) = (a.min(b) - margin - self.samples[1], a.max(b) + margin - self.samples[0]);
        // NaN comes from products beyond the range of f64: then the bound is left open.
        let low = if low.is_nan() { 0.0 } else { low.max(0.0).ceil() };
        let high = if high.is_nan() { f64::INFINITY } else { high.floor() }.min(f64::from(self.count - 1));
        (low <= high).then_some([low as u32, high as u32])
    }
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

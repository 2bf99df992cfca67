//! Whether rays from the eye meet spheres, in exact arithmetic on the numbers of the scene.
//!
//! A number stands for the shortest decimal that reads as it: what the file has, up to 15 digits. So a sphere that the file lets
//! a ray touch is touched, whatever its decimals are in binary.

use std::cmp::Ordering;

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::cpu::{Ray, Vec3, Wide};
use crate::decimal::Decimal;
use crate::geometry::Ellipsoid;
use crate::pattern::Ticks;
use crate::scene::Sphere;
use crate::viewed::ViewedScene;

/// How far rounding can move the discriminant r² − |perpendicular|² of a ray from the eye, in object space.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TangentMargin {
    /// Unit roundoff.
    unit: f64,
    /// Distance of the eye from the origin of the scene file, in the units of kernels.
    eye: f64,
    /// The greatest coordinate on the window, as rays have it.
    window: f64,
    /// The least length of a ray's direction.
    shortest: f64,
    /// The greatest coordinate of where rays begin, where these are parallel.
    start: f64,
}

impl TangentMargin {
    /// For rays from the eye of `viewed` in arithmetic with this unit roundoff.
    pub fn new(viewed: &ViewedScene, unit: f64) -> Self {
        let (eye, camera) = (viewed.eye_distance(), Camera::new(viewed));
        let shortest = camera.near() * camera.stretch();
        if camera.is_parallel() {
            return Self { unit, eye, window: shortest, shortest, start: camera.greatest() };
        }
        Self { unit, eye, window: camera.greatest() * camera.stretch(), shortest, start: 0.0 }
    }

    /// Of a ray that passes at `perpendicular` from the centre of a sphere, which is at `distance` from the eye, all in its object
    /// space; where world vectors become at most `stretch` times as long there and the ray's direction becomes `length`.
    ///
    /// A direction is good to 16 u of the window's greatest coordinate (edge, difference, quotient, product, sum, and the turn
    /// into the world); S' to 4 u of itself and, since centre and eye are rounded, 2 u of the eye's distance; and the steps to the
    /// closest point, where an error along the ray does not count, to 4 u more. The square of the distance moves by twice what
    /// the distance does; the radius and the last operations add less than 40 u. Where rays begin on the window, that place is good to
    /// 16 u of the greatest coordinate there, and S' takes two roundings of it more.
    pub fn of(&self, perpendicular: f64, distance: f64, stretch: f64, length: f64) -> f64 {
        let moved = self.moved(distance, stretch, length);
        moved * (2.0 * perpendicular + moved) + 40.0 * self.unit
    }

    fn moved(&self, distance: f64, stretch: f64, length: f64) -> f64 {
        let distance = distance + 2.0 * self.eye * stretch;
        self.unit * distance * (8.0 + 32.0 * self.window * stretch / length) + self.unit * 40.0 * self.start * stretch
    }

    /// The greatest margin of a ray that may touch one of these, whose radii are in [1, 2).
    pub fn widest(&self, ellipsoids: impl ParallelIterator<Item = Ellipsoid>) -> f64 {
        ellipsoids.map(|ellipsoid| self.greatest(ellipsoid)).reduce(|| 0.0, f64::max)
    }

    /// That of a ray that may touch this one.
    pub(crate) fn greatest(&self, e: Ellipsoid) -> f64 {
        let [most, least] = [e.inv_scale.max_element(), e.inv_scale.min_element()];
        let distance = (e.center * e.inv_scale).length() + 2.0 * self.start * most;
        // Where |perpendicular|² − r² is within the margin, |perpendicular| is below 2.1 and 2.5 times what it moves.
        let moved = self.moved(distance, most, least * self.shortest);
        16.0 * (moved + moved * moved) + 40.0 * self.unit
    }
}

/// The rays from the eye.
#[derive(Debug, Clone, Default)]
pub struct ExactCamera {
    eye: [Decimal; 3],
    /// The picture's axes in the world.
    axes: [[Decimal; 3]; 3],
    across: Edges,
    down: Edges,
    near: Decimal,
    /// Whether rays begin on the window, and all have the same direction.
    is_parallel: bool,
}

/// Where the samples of a row or of a column lie.
#[derive(Debug, Clone, Default)]
struct Edges {
    /// The edge where they begin.
    first: Decimal,
    /// What the other edge adds.
    size: Decimal,
    /// Steps between them.
    count: Decimal,
    /// How many of these each sample lies from the first.
    ticks: Ticks,
}

impl Edges {
    fn new(ends: [f64; 2], pixels: u32, ticks: Ticks) -> Self {
        let [first, last] = ends.map(Decimal::shortest);
        let count = Decimal::from(i64::from(pixels) * i64::from(ticks.steps()));
        Self { size: &last - &first, first, count, ticks }
    }

    /// The place of the sample with this index, times the count of steps.
    fn place(&self, index: u32) -> Decimal {
        let Self { first, size, count, ticks } = self;
        &(first * count) + &(size * &Decimal::from(ticks.steps_to(index)))
    }
}

impl ExactCamera {
    /// Of the scene as the file has it.
    pub fn new(viewed: &ViewedScene) -> Self {
        let (scene, settings) = viewed.in_file();
        let window = scene.window;
        let [across, down] = settings.pattern.ticks(settings.sampling.offset());
        Self {
            eye: vector(settings.view.eye),
            axes: settings.view.axes().map(vector),
            across: Edges::new([window.left, window.right], scene.width, across),
            down: Edges::new([window.top, window.bottom], scene.height, down),
            near: Decimal::shortest(window.near),
            is_parallel: settings.view.is_parallel(),
        }
    }

    /// What all is multiplied by: the counts of steps in both directions.
    fn count(&self) -> Decimal {
        &self.across.count * &self.down.count
    }

    /// The point of the window at the eye's depth, seen from the eye, of the sample in this column and row of samples, and from there the
    /// way to the image plane along the view; times the count.
    fn window(&self, [column, row]: [u32; 2]) -> [[Decimal; 3]; 2] {
        let Self { across, down, near, .. } = self;
        let x = &across.place(column) * &down.count;
        let y = &down.place(row) * &across.count;
        let z = near * &self.count();
        let [right, up, back] = &self.axes;
        let point = std::array::from_fn(|axis| &(&right[axis] * &x) + &(&up[axis] * &y));
        [point, std::array::from_fn(|axis| &Decimal::default() - &(&back[axis] * &z))]
    }

    /// Where the ray of a sample begins, seen from the eye, and the way along it to the image plane; times the count.
    fn ray(&self, sample: [u32; 2]) -> [[Decimal; 3]; 2] {
        let [point, ahead] = self.window(sample);
        if self.is_parallel {
            return [point, ahead];
        }
        [std::array::from_fn(|_| Decimal::default()), std::array::from_fn(|axis| &point[axis] + &ahead[axis])]
    }

    /// Likewise in a `T`, with 2ᵏ for what a length of the file is to have, and 2ᵐ for the way to the image plane.
    fn rounded_ray<T: Wide>(&self, sample: [u32; 2], [k, m]: [i32; 2]) -> Ray<T> {
        let count: T = self.count().rounded(0);
        let [origin, direction] = self.ray(sample);
        let vector = |axes: [Decimal; 3], k: i32| {
            let [x, y, z] = axes.map(|x| x.rounded::<T>(k) / count);
            Vec3::new(x, y, z)
        };
        Ray { origin: vector(origin, k), direction: vector(direction, m) }
    }

    /// The sign of B² − AC for the ray of a sample and the ellipsoid around `center` with these semi-axes: less where the line
    /// misses it, equal where it touches it.
    pub fn discriminant(&self, sample: [u32; 2], center: DVec3, semi_axes: DVec3) -> Ordering {
        let (center, [a, b, c]) = (vector(center), &vector(semi_axes));
        let ([start, direction], count) = (self.ray(sample), self.count());
        // In object space, where the ellipsoid is the unit sphere: B² − AC = A − |S' × c'|². Vectors are there times the product
        // of the semi-axes, which spares quotients.
        let others = [b * c, c * a, a * b];
        let d: [Decimal; 3] = std::array::from_fn(|axis| &direction[axis] * &others[axis]);
        let s: [Decimal; 3] = std::array::from_fn(|axis| {
            let from_center = &(&(&self.eye[axis] - &center[axis]) * &count) + &start[axis];
            &from_center * &others[axis]
        });
        let moment = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| &(&s[i] * &d[j]) - &(&s[j] * &d[i]));
        let squared = |v: &[Decimal; 3]| v.iter().fold(Decimal::default(), |sum, x| &sum + &(x * x));
        let product = &(a * &others[0]) * &count;
        (&(&squared(&d) * &(&product * &product)) - &squared(&moment)).sign()
    }
}

/// A scene's places before anything is rounded, and the rays from its eye.
#[derive(Debug, Clone, Default)]
pub struct ExactScene {
    camera: ExactCamera,
    spheres: Vec<[DVec3; 2]>,
    lights: Vec<DVec3>,
    /// The power of two that a length in the units of kernels has more than in the file, and that of directions beside it.
    factor: i32,
    stretch: i32,
}

impl ExactScene {
    /// Of the scene as the file has it; without `true_axes` each sphere is its bounding sphere.
    pub fn new(viewed: &ViewedScene, true_axes: bool) -> Self {
        let sphere = |sphere: &Sphere| {
            let scale = sphere.scale.abs();
            [sphere.center, if true_axes { scale } else { DVec3::splat(scale.max_element()) }]
        };
        let (scene, _) = viewed.in_file();
        Self {
            camera: ExactCamera::new(viewed),
            spheres: scene.spheres.iter().map(sphere).collect(),
            lights: scene.lights.iter().map(|light| light.position).collect(),
            factor: exponent(viewed.factor()),
            stretch: exponent(Camera::new(viewed).stretch()),
        }
    }

    /// The ray of a sample in the units of kernels, in a `T`.
    pub(crate) fn ray<T: Wide>(&self, sample: [u32; 2]) -> Ray<T> {
        self.camera.rounded_ray(sample, [self.factor, self.factor + self.stretch])
    }

    /// A place of the file with the eye at the origin, in the units of kernels, in a `T`.
    fn seen<T: Wide>(&self, place: DVec3) -> Vec3<T> {
        let [x, y, z] = vector(place);
        let [ex, ey, ez] = &self.camera.eye;
        Vec3::new((&x - ex).rounded(self.factor), (&y - ey).rounded(self.factor), (&z - ez).rounded(self.factor))
    }

    /// Centre and semi-axes of a sphere, likewise.
    pub(crate) fn sphere<T: Wide>(&self, sphere: usize) -> [Vec3<T>; 2] {
        let [center, semi_axes] = self.spheres[sphere];
        let [a, b, c] = vector(semi_axes).map(|x| x.rounded(self.factor));
        [self.seen(center), Vec3::new(a, b, c)]
    }

    /// Where a light is, likewise.
    pub(crate) fn light<T: Wide>(&self, light: usize) -> Vec3<T> {
        self.seen(self.lights[light])
    }

    /// A length of the file in the units of kernels, likewise.
    pub(crate) fn length<T: Wide>(&self, x: f64) -> T {
        Decimal::shortest(x * power_of_two(-self.factor)).rounded(self.factor)
    }

    /// A part of a primary ray, with 1 on the image plane: in units of its direction.
    pub(crate) fn part<T: Wide>(&self, x: f64) -> T {
        Decimal::shortest(x).rounded(-self.stretch)
    }

    /// The sign of B² − AC for the ray of a sample, by its column and row, and the sphere with this index.
    pub fn discriminant(&self, sample: [u32; 2], sphere: usize) -> Ordering {
        let [center, semi_axes] = self.spheres[sphere];
        self.camera.discriminant(sample, center, semi_axes)
    }
}

/// The binary logarithm of a power of two.
fn exponent(x: f64) -> i32 {
    x.log2().round() as i32
}

fn power_of_two(k: i32) -> f64 {
    f64::from(k).exp2()
}

fn vector(v: DVec3) -> [Decimal; 3] {
    v.to_array().map(Decimal::shortest)
}

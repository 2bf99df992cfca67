//! The eye at the origin, its axes and its window: the one place that turns a pixel into a ray, for CPU and GPU alike.

use glam::DVec3;

use crate::area::Area;
use crate::geometry::reciprocal_power_of_two;
use crate::pattern::{Pattern, Ticks};
use crate::scene::Window;
use crate::view::View;
use crate::viewed::ViewedScene;

/// A primary ray counts hits beyond this τ, where 1 is the image plane: what lies before it, or just touches it, is cut away.
pub const NEAR_T_MIN: f64 = 1.0 + 1e-6;

/// Windows whose greatest coordinate lies within this range are as far away as a ray's direction is long.
const COMMON_WINDOW: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// Positions of all sample columns and rows on the image plane. In a perspective picture the ray of the sample in column i and row j is
/// τ·(`column(i)` + `row(j)`), not normalised: `x(i)` to the right, `y(j)` upwards and `near` along the view, each times a
/// power of two, [`Camera::stretch`], which keeps squares of directions within the range of `f32` for windows of any size. So
/// τ·`stretch` = 1 lies on the image plane; it is 1 for usual windows.
///
/// In an orthographic one it is `column(i)` + `row(j)` + τ·[`direction`](Camera::direction): from the window's point at the eye's depth
/// along the view, times the same power of two, so that the image plane is where it was.
///
/// In a grid of k × k samples each pixel is cut into k × k equal cells, and each cell has one sample where the
/// convention places it: with centre sampling in the middle of the cell, at offsets (s + ½)/k from the pixel's left and
/// top, with corner sampling at the cell's corner, at offsets s/k, for s in 0..k. Sample column i lies in pixel column
/// ⌊i/k⌋, and k = 1 is one sample a pixel at the convention's own offset. The samples of corner conventions have their mean
/// (k − 1)/2k of a pixel away from the corner, so their picture moves by up to half a pixel as k grows; that of centre
/// sampling does not move. N samples that are no grid have N columns and N rows of cells, and otherwise it is the same:
/// [`Pattern::ticks`].
#[derive(Debug, Clone)]
pub struct Camera {
    window: Window,
    view: View,
    width: u32,
    height: u32,
    area: Area,
    pattern: Pattern,
    /// Where the samples of a pixel lie, across and down.
    ticks: [Ticks; 2],
    /// The greatest coordinate of a sample's place on the image plane, and of its corners.
    greatest: f64,
    stretch: f64,
}

impl Camera {
    /// The camera of `viewed`.
    pub fn new(viewed: &ViewedScene) -> Self {
        let (scene, settings) = (viewed.scene(), viewed.settings());
        let camera = Self {
            window: scene.window,
            view: settings.view,
            width: scene.width,
            height: scene.height,
            area: viewed.area(),
            pattern: settings.pattern,
            ticks: settings.pattern.ticks(settings.sampling.offset()),
            greatest: scene.window.greatest(),
            stretch: 1.0,
        };
        let greatest = camera.beyond_edges().into_iter().map(f64::abs).fold(camera.greatest, f64::max);
        let longest = if camera.view.is_parallel() { camera.near() } else { greatest };
        let stretch = if COMMON_WINDOW.contains(&longest) { 1.0 } else { reciprocal_power_of_two(longest) };
        Self { greatest, stretch, ..camera }
    }

    /// What sample column `i` gives to the direction of its rays, or to where they begin, in the axes of the world.
    pub fn column(&self, i: u32) -> DVec3 {
        let [right, _, _] = self.view.axes();
        if self.is_parallel() { right * self.x(i) } else { right * (self.x(i) * self.stretch) }
    }

    /// What sample row `j` gives to the direction of its rays, or to where they begin, in the axes of the world.
    pub fn row(&self, j: u32) -> DVec3 {
        let [_, up, back] = self.view.axes();
        if self.is_parallel() {
            up * self.y(j)
        } else {
            up * (self.y(j) * self.stretch) - back * (self.near() * self.stretch)
        }
    }

    /// Whether rays begin on the window, and all have the same direction.
    pub fn is_parallel(&self) -> bool {
        self.view.is_parallel()
    }

    /// The way along the view to the image plane, as long as directions are.
    pub fn direction(&self) -> DVec3 {
        let [_, _, back] = self.view.axes();
        -back * (self.near() * self.stretch)
    }

    /// How far the place where a ray begins may be off, where column, row and their sum are rounded to `unit`; before, they are calculated in
    /// `f64`.
    pub fn position_error(&self, unit: f64) -> f64 {
        if self.is_parallel() { (3.5 * unit + 20.0 * 0.5 * f64::EPSILON) * self.greatest() } else { 0.0 }
    }

    /// How far the direction of a ray may be off, as an angle, likewise.
    pub fn direction_error(&self, unit: f64) -> f64 {
        if self.is_parallel() {
            return 2.0 * unit + 20.0 * 0.5 * f64::EPSILON;
        }
        // Column and row are at right angles.
        2.5 * unit + 20.0 * 0.5 * f64::EPSILON * self.greatest() / self.near()
    }

    /// The picture's axes in the world: to the right, upwards, and against the direction of view.
    pub fn axes(&self) -> [DVec3; 3] {
        self.view.axes()
    }

    /// x on the image plane of sample column `i` (0 = left).
    pub fn x(&self, i: u32) -> f64 {
        self.x_at(self.ticks[0].place(i))
    }

    /// y on the image plane of sample row `j` (0 = top).
    pub fn y(&self, j: u32) -> f64 {
        self.y_at(self.ticks[1].place(j))
    }

    /// x on the image plane at `i` pixel widths from the left edge.
    pub fn x_at(&self, i: f64) -> f64 {
        self.window.left + (self.window.right - self.window.left) * i / f64::from(self.width)
    }

    /// y on the image plane at `j` pixel heights from the top edge.
    pub fn y_at(&self, j: f64) -> f64 {
        self.window.top - (self.window.top - self.window.bottom) * j / f64::from(self.height)
    }

    /// From the left to the right edge of the window, and from the bottom to the top; either may be negative.
    pub fn window_size(&self) -> [f64; 2] {
        [self.window.right - self.window.left, self.window.top - self.window.bottom]
    }

    /// Where a pixel's first and last sample are, in pixel widths from its left edge.
    pub fn samples_across(&self) -> [f64; 2] {
        self.ticks[0].range()
    }

    /// Likewise in pixel heights from its top edge.
    pub fn samples_down(&self) -> [f64; 2] {
        self.ticks[1].range()
    }

    /// Coordinates of the outermost samples that a filter places beyond the edges of the window.
    fn beyond_edges(&self) -> Vec<f64> {
        let outside = |[first, last]: [f64; 2], size: u32| {
            let size = f64::from(size);
            [first, size - 1.0 + last].into_iter().filter(move |place| !(0.0..=size).contains(place))
        };
        let across = outside(self.samples_across(), self.width).map(|i| self.x_at(i));
        let down = outside(self.samples_down(), self.height).map(|j| self.y_at(j));
        across.chain(down).collect()
    }

    /// How many times longer the directions of rays are than the way to the image plane: a power of two.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// A primary ray counts hits beyond this τ: [`NEAR_T_MIN`] times the way to the image plane.
    pub fn t_min(&self) -> f64 {
        NEAR_T_MIN / self.stretch
    }

    /// How the samples of a pixel are placed.
    pub fn pattern(&self) -> Pattern {
        self.pattern
    }

    /// The greatest coordinate of a point on the window, and of samples beyond its edges.
    pub fn greatest(&self) -> f64 {
        self.greatest
    }

    /// Distance of the image plane.
    pub fn near(&self) -> f64 {
        self.window.near
    }

    /// The part of the picture that is rendered.
    pub fn area(&self) -> Area {
        self.area
    }

    /// Picture width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Picture height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }
}

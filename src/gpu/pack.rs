//! From the scene to the bytes of the buffers.

use bytemuck::Pod;
use glam::DVec3;

use super::layout::{Layout, ListValues, ParamValues, ShapeValues, double, single};
use super::shader::Kernel;
use crate::accel::{Acceleration, Lists};
use crate::camera::{Camera, NEAR_T_MIN};
use crate::effects::{Effect, Effects};
use crate::geometry::{Ellipsoid, ellipsoids, shape_indices};
use crate::scene::{Light, Scene};
use crate::settings::{Secondary, Settings};
use crate::tiles::TILE;

/// The contents of the buffers, and the size of one element of those that loops read.
#[derive(Debug, Default)]
pub(super) struct Packed {
    pub(super) params: Vec<u8>,
    /// One per sphere.
    pub(super) shapes: Vec<u8>,
    /// One per sphere.
    pub(super) materials: Vec<u8>,
    /// One per light.
    pub(super) lights: Vec<u8>,
    /// x of each sample column on the image plane, on to the end of the last tile, and then what rounding took from each.
    pub(super) columns: Vec<u8>,
    /// y of each sample row on the image plane, likewise.
    pub(super) rows: Vec<u8>,
    /// The lists of spheres: all offsets, then all entries.
    pub(super) lists: Vec<u32>,
    /// Six faces a light with lists.
    pub(super) faces: Vec<u8>,
    /// What rounding took from spheres and lights, for the tier that carries it.
    pub(super) low: Option<Low>,
    pub(super) shape_size: usize,
    pub(super) light_size: usize,
    pub(super) face_size: usize,
}

/// What rounding took from each number, in the same layout.
#[derive(Debug, Default)]
pub(super) struct Low {
    pub(super) shapes: Vec<u8>,
    pub(super) lights: Vec<u8>,
}

impl Packed {
    /// Packs `scene` for a pipeline that simulates `effects` with `kernel`.
    pub(super) fn new(
        scene: &Scene,
        settings: &Settings,
        effects: &Effects,
        kernel: Kernel,
        accel: &Acceleration,
    ) -> Self {
        if kernel.is_double() {
            pack::<double::Layout>(scene, settings, effects, false, accel)
        } else {
            pack::<single::Layout>(scene, settings, effects, kernel.carries_low(), accel)
        }
    }
}

fn pack<L: Layout>(
    scene: &Scene,
    settings: &Settings,
    effects: &Effects,
    with_low: bool,
    accel: &Acceleration,
) -> Packed {
    let (lists, bases) = joined_lists(accel);
    let grid_offsets = if accel.grid.is_some() { bases[bases.len() - 1] } else { 0 };
    let on = |effect| effects.set.has(effect);
    let camera = Camera::new(scene, settings);
    let ellipsoids = ellipsoids(scene, on(Effect::Ellipsoids));
    let indices = match settings.secondary {
        Secondary::SkipSelf => shape_indices(&ellipsoids),
        Secondary::Epsilon { .. } => (0..ellipsoids.len() as u32).collect(),
    };
    let shapes = shape_values(&ellipsoids, indices, on(Effect::Ellipsoids));
    let columns: Vec<f64> = (0..scene.width.next_multiple_of(TILE) * settings.samples).map(|i| camera.x(i)).collect();
    let rows: Vec<f64> = (0..scene.height.next_multiple_of(TILE) * settings.samples).map(|j| camera.y(j)).collect();

    let params = ParamValues {
        background: scene.background,
        near: camera.near(),
        ambient: scene.ambient,
        primary_t_min: if on(Effect::Shells) { NEAR_T_MIN } else { 0.0 },
        shadow_t_min: settings.secondary.shadow_t_min(),
        reflection_t_min: settings.secondary.reflection_t_min(),
        quantize_bias: settings.quantize.bias(),
        lists: list_values(accel, grid_offsets),
        sphere_count: scene.spheres.len() as u32,
        light_count: scene.lights.len() as u32,
        max_depth: effects.depth,
    };
    // Without the effect the kernel leaves out the way into object space.
    let scale = |ellipsoid: &Ellipsoid| if on(Effect::Ellipsoids) { ellipsoid.scale } else { DVec3::ONE };
    let reals = |values: &[f64]| {
        let low = values.iter().filter(|_| with_low).map(|&x| L::residual(x));
        bytes(values.iter().copied().chain(low).map(L::real))
    };
    let low = || Low {
        shapes: bytes(shapes.iter().map(|s| L::shape(&low_shape::<L>(s)))),
        lights: bytes(scene.lights.iter().map(|l| L::light(&low_light::<L>(l)))),
    };
    Packed {
        params: bytes([L::params(&params)]),
        shapes: bytes(shapes.iter().map(L::shape)),
        materials: bytes(scene.spheres.iter().zip(&ellipsoids).map(|(s, e)| L::material(s, scale(e)))),
        lights: bytes(scene.lights.iter().map(L::light)),
        columns: reals(&columns),
        rows: reals(&rows),
        lists,
        faces: bytes(
            accel
                .lights
                .faces
                .iter()
                .zip(&bases[1..])
                .flat_map(|(faces, &base)| faces.iter().map(move |f| L::face(f, base))),
        ),
        low: with_low.then(low),
        shape_size: size_of::<L::Shape>(),
        light_size: size_of::<L::Light>(),
        face_size: size_of::<L::Face>(),
    }
}

/// All lists in one buffer, tiles first, and where the offsets of each light and of the grid begin there.
fn joined_lists(accel: &Acceleration) -> (Vec<u32>, Vec<u32>) {
    let all: Vec<&Lists> = std::iter::once(&accel.screen.lists)
        .chain(&accel.lights.lists)
        .chain(accel.grid.iter().map(|g| &g.lists))
        .collect();
    let mut entries_base = all.iter().map(|lists| lists.offsets.len()).sum::<usize>();
    let mut joined = Vec::with_capacity(entries_base + all.iter().map(|lists| lists.entries.len()).sum::<usize>());
    let mut bases = Vec::new();
    for lists in &all {
        bases.push(joined.len() as u32);
        joined.extend(lists.offsets.iter().map(|offset| offset + entries_base as u32));
        entries_base += lists.entries.len();
    }
    all.iter().for_each(|lists| joined.extend_from_slice(&lists.entries));
    (joined, bases)
}

/// Where the shader finds the lists.
fn list_values(accel: &Acceleration, grid_offsets: u32) -> ListValues {
    let screen = ListValues {
        // From pixels to tiles with lists.
        screen_shift: TILE.trailing_zeros() + accel.screen.shift,
        screen_across: accel.screen.across,
        light_slack: accel.lights.slack,
        grid_offsets,
        ..ListValues::default()
    };
    match &accel.grid {
        None => screen,
        Some(grid) => ListValues { grid_low: grid.low, grid_per_unit: grid.per_unit, grid_cells: grid.cells, ..screen },
    }
}

/// What rounding to the layout's scalar takes from `v`.
fn residual<L: Layout>(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(L::residual))
}

/// What rounding takes from a shape.
pub(super) fn low_shape<L: Layout>(shape: &ShapeValues) -> ShapeValues {
    ShapeValues {
        center: residual::<L>(shape.center),
        radius: L::residual(shape.radius),
        inv_scale: residual::<L>(shape.inv_scale),
        index: shape.index,
    }
}

/// What rounding takes from a light's position.
pub(super) fn low_light<L: Layout>(light: &Light) -> Light {
    Light { position: residual::<L>(light.position), ..*light }
}

/// What the intersection reads of each sphere; without the way into object space, what is exact there, a power of two, goes
/// into the radius.
pub(super) fn shape_values(ellipsoids: &[Ellipsoid], indices: Vec<u32>, object_space: bool) -> Vec<ShapeValues> {
    let value = |(ellipsoid, index): (&Ellipsoid, u32)| {
        let (inv_scale, radius) = if object_space {
            (ellipsoid.inv_scale, ellipsoid.radius)
        } else {
            (DVec3::ONE, ellipsoid.radius * ellipsoid.scale.x)
        };
        ShapeValues { center: ellipsoid.center, radius, inv_scale, index }
    };
    ellipsoids.iter().zip(indices).map(value).collect()
}

pub(super) fn bytes<T: Pod>(values: impl IntoIterator<Item = T>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for value in values {
        bytes.extend_from_slice(bytemuck::bytes_of(&value));
    }
    bytes
}

//! From the scene to the bytes of its tables.

use std::sync::Arc;

use bytemuck::Pod;
use glam::DVec3;

use super::layout::{ConeValues, Layout, ListValues, ParamValues, ShapeValues, double, single};
use crate::accel::{Acceleration, Lists, ScreenRoom};
use crate::camera::Camera;
use crate::effects::{Effect, Effects};
use crate::geometry::{Ellipsoid, ellipsoid};
use crate::gpu::device::contents::Contents;
use crate::gpu::kernel::specialisation::material_vectors;
use crate::gpu::kernel::variant::Kernel;
use crate::scene::Light;
use crate::tiles::TILE;
use crate::viewed::ViewedScene;

/// The contents of the tables but the lists.
pub(crate) struct Packed<'a> {
    pub(crate) params: Contents<'a>,
    /// The first halves of the shapes and the second, one of each per sphere.
    pub(crate) shapes: [Contents<'a>; 2],
    /// One per sphere, without what only object space needs where there is none.
    pub(crate) materials: Contents<'a>,
    /// One per sphere; empty where nothing refracts.
    pub(crate) glasses: Contents<'a>,
    /// One per light.
    pub(crate) lights: Contents<'a>,
    /// What each sample column and then each sample row gives to its rays, on to the end of the last tile, and then what
    /// rounding took from each.
    pub(crate) window: Contents<'a>,
    /// Six faces a light with lists.
    pub(crate) faces: Contents<'a>,
    /// What rounding took from shapes, again in halves, and lights, for the tiers that carry it.
    pub(crate) low: Option<([Contents<'a>; 2], Contents<'a>)>,
}

impl<'a> Packed<'a> {
    /// Packs `viewed` for a pipeline that simulates `effects` with `kernel`; `indices` are those of its surfaces, where spheres
    /// share some.
    pub(crate) fn new(
        viewed: &'a ViewedScene,
        effects: &Effects,
        kernel: Kernel,
        accel: &Acceleration,
        indices: Option<Vec<u32>>,
        tangent_margin: f64,
        certified: bool,
    ) -> Self {
        if kernel.is_double() {
            pack::<double::Layout>(viewed, effects, false, accel, indices, tangent_margin, certified)
        } else {
            pack::<single::Layout>(viewed, effects, kernel.carries_low(), accel, indices, tangent_margin, certified)
        }
    }
}

fn pack<'a, L: Layout + 'a>(
    viewed: &'a ViewedScene,
    effects: &Effects,
    with_low: bool,
    accel: &Acceleration,
    indices: Option<Vec<u32>>,
    tangent_margin: f64,
    certified: bool,
) -> Packed<'a> {
    let on = |effect| effects.set.has(effect);
    let (scene, settings, camera) = (viewed.scene(), viewed.settings(), Camera::new(viewed));
    let true_axes = on(Effect::Ellipsoids);
    let indices = Arc::new(indices);
    let shape = move |i: usize| {
        let index = indices.as_ref().as_ref().map_or(i as u32, |indices| indices[i]);
        shape_value(&ellipsoid(&scene.spheres[i], true_axes), index, true_axes)
    };
    let [columns, rows] = [scene.width, scene.height].map(|size| size.next_multiple_of(TILE) * settings.pattern.side());
    // Where rays are parallel their direction is the last.
    let places = columns + rows + u32::from(camera.is_parallel());
    let rays = camera.clone();
    let place = move |i: u32| match i.checked_sub(columns) {
        None => rays.column(i),
        Some(row) if row < rows => rays.row(row),
        Some(_) => rays.direction(),
    };
    let window = move |i: usize| match (i as u32).checked_sub(places) {
        None => place(i as u32),
        Some(i) => residual::<L>(place(i)),
    };
    let bases = list_bases(accel);
    let levels = move |color| {
        let [red, green, blue] = settings.quantize.levels(color).map(f64::from);
        red + 256.0 * (green + 256.0 * blue)
    };
    let params = ParamValues {
        background: scene.background,
        ambient: scene.ambient,
        primary_t_min: if on(Effect::Shells) { camera.t_min() } else { 0.0 },
        shadow_t_min: settings.secondary.shadow,
        reflection_t_min: settings.secondary.reflection,
        quantize_scale: settings.quantize.scale(),
        quantize_bias: settings.quantize.bias(),
        window_rows: columns,
        lists: list_values(accel, &bases),
        window_low: places,
        light_count: scene.lights.len() as u32,
        max_depth: effects.depth,
        tangent_margin,
        cones: ConeValues {
            direction_error: camera.direction_error(L::UNIT),
            middle: accel.middle,
            extent: accel.extent,
            allowance: accel.allowance,
            light_allowance: accel.light_allowance,
            background_levels: levels(scene.background),
            moved: viewed.moved_by(),
            position_error: camera.position_error(L::UNIT),
        },
    };
    let has_ambient = on(Effect::Ambient);
    let material = move |i: usize| {
        let sphere = &scene.spheres[i];
        // Without the effect the kernel leaves out the way into object space.
        let scale = if true_axes { ellipsoid(sphere, true_axes).scale } else { DVec3::ONE };
        let ambient = if has_ambient { sphere.ka } else { 0.0 };
        L::material(sphere, scale, levels(scene.ambient * sphere.color * ambient))
    };
    let faces = accel.lights.faces.iter().zip(bases.iter().skip(1));
    let faces: Vec<_> = faces.flat_map(|(faces, &[base, _])| faces.map(|face| (face, base))).collect();
    let (spheres, lights) = (scene.spheres.len(), &scene.lights);
    let halves = |low: bool| {
        [0, 1].map(|half| {
            let shape = shape.clone();
            Contents::new(spheres, move |i| {
                let shape = shape(i);
                L::halves(L::shape(&if low { low_shape::<L>(&shape) } else { shape }))[half]
            })
        })
    };
    let material_size = size_of::<L::Material>() / 3 * material_vectors(effects.set, certified);
    Packed {
        params: Contents::new(1, move |_| L::params(&params)),
        shapes: halves(false),
        materials: Contents::part(spheres, 0..material_size, material),
        glasses: Contents::new(if on(Effect::Refraction) { spheres } else { 0 }, |i| L::glass(&scene.spheres[i])),
        lights: Contents::new(lights.len(), |i| L::light(&lights[i])),
        window: Contents::new((places as usize) << u32::from(with_low), move |i| {
            window(i).extend(0.0).to_array().map(L::real)
        }),
        faces: Contents::new(faces.len(), move |i| L::face(&faces[i].0, faces[i].1 as u32)),
        low: with_low.then(|| {
            let lights = Contents::new(lights.len(), |i| L::light(&low_light::<L>(&lights[i])));
            (halves(true), lights)
        }),
    }
}

/// All lists in the order of the buffer: tiles, lights, grid; each with the cells and the entries that it has room for.
fn all_lists(accel: &Acceleration) -> impl Iterator<Item = (&Lists, [usize; 2])> {
    let own = |lists: &Lists| [lists.cells(), lists.entries.len()];
    let screen = &accel.screen.lists;
    let room = accel.room.as_ref().map_or(own(screen), ScreenRoom::sizes);
    let others = accel.lights.lists.iter().chain(accel.grid.iter().map(|grid| &grid.lists));
    std::iter::once((screen, room)).chain(others.map(move |lists| (lists, own(lists))))
}

/// Where in the cells of all lists, and in their entries, those of each begin. What no `u32` holds is refused before it is packed, like
/// all that no texture holds.
fn list_bases(accel: &Acceleration) -> Vec<[usize; 2]> {
    let next = |[cells, entries]: &mut [usize; 2], (_, room): (&Lists, [usize; 2])| {
        let base = [*cells, *entries];
        (*cells, *entries) = (*cells + room[0], *entries + room[1]);
        Some(base)
    };
    all_lists(accel).scan([0, 0], next).collect()
}

/// Where the list of each cell begins in the entries of all lists and where it ends; and these entries.
pub(crate) fn list_contents(accel: &Acceleration) -> [Contents<'_>; 2] {
    let cells = all_lists(accel).zip(list_bases(accel)).flat_map(|((lists, [room, _]), [_, base])| {
        let offsets = &lists.offsets;
        let place = move |index: usize| (offsets[index] as usize + base) as u32;
        let own = Contents::new(lists.cells(), move |index: usize| [place(index), place(index + 1)]);
        [own, Contents::new(room - lists.cells(), |_| [0_u32; 2])]
    });
    let entries = all_lists(accel).flat_map(|(lists, [_, room])| {
        [Contents::packed(&lists.entries[..]), Contents::new(room - lists.entries.len(), |_| 0_u32)]
    });
    [Contents::joined(cells.collect()), Contents::joined(entries.collect())]
}

/// Where the shader finds the lists, which begin at these places.
fn list_values(accel: &Acceleration, bases: &[[usize; 2]]) -> ListValues {
    let screen = ListValues {
        screen_shift: accel.screen.shift,
        screen_across: accel.screen.across,
        light_slack: accel.lights.slack,
        ..ListValues::default()
    };
    match &accel.grid {
        None => screen,
        // The lists of the grid are the last.
        Some(grid) => ListValues {
            grid_low: grid.low,
            grid_per_unit: grid.per_unit,
            grid_cells: grid.cells,
            grid_first: bases.last().map_or(0, |base| base[0] as u32),
            grid_entries: bases.last().map_or(0, |base| base[1] as u32),
            ..screen
        },
    }
}

/// What rounding to the layout's scalar takes from `v`.
fn residual<L: Layout>(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(L::residual))
}

/// What rounding takes from a shape.
pub(crate) fn low_shape<L: Layout>(shape: &ShapeValues) -> ShapeValues {
    ShapeValues {
        center: residual::<L>(shape.center),
        radius: L::residual(shape.radius),
        inv_scale: residual::<L>(shape.inv_scale),
        index: shape.index,
    }
}

/// What rounding takes from a light's position.
pub(crate) fn low_light<L: Layout>(light: &Light) -> Light {
    Light { position: residual::<L>(light.position), ..*light }
}

/// What the intersection reads of a sphere; without the way into object space, what is exact there, a power of two, goes into
/// the radius.
pub(crate) fn shape_value(ellipsoid: &Ellipsoid, index: u32, object_space: bool) -> ShapeValues {
    let (inv_scale, radius) = if object_space {
        (ellipsoid.inv_scale, ellipsoid.radius)
    } else {
        (DVec3::ONE, ellipsoid.radius * ellipsoid.scale.x)
    };
    ShapeValues { center: ellipsoid.center, radius, inv_scale, index }
}

pub(crate) fn bytes<T: Pod>(values: impl IntoIterator<Item = T>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for value in values {
        bytes.extend_from_slice(bytemuck::bytes_of(&value));
    }
    bytes
}

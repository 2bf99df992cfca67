//! The buffers and textures of a scene, and whether a device holds them.

use super::device::Gpu;
use super::error::Error;
use super::pack::{Contents, Packed};
use super::pipeline::Specialisation;
use super::stage::Resource;
use super::upload::{max_texels, upload, upload_texels};
use crate::accel::Acceleration;

/// The textures of the lists, by binding.
pub(super) fn list_resources(gpu: &Gpu, [cells, entries]: &[Contents; 2]) -> Result<Vec<(u32, Resource)>, Error> {
    Ok(vec![
        (13, Resource::Texels(upload_texels(gpu, cells, 2)?)),
        (17, Resource::Texels(upload_texels(gpu, entries, 2)?)),
    ])
}

/// Whether the device has room for the shapes in the order of the grid's lists.
pub(super) fn copies_fit(gpu: &Gpu, packed: &Packed, accel: &Acceleration) -> bool {
    let entries = accel.grid.as_ref().map_or(0, |grid| grid.lists.entries.len());
    (entries * packed.shapes[0].element_size()) as u64 <= max_texels(gpu, 16)
}

/// The textures of the shapes in the order of the grid's lists, by binding, where kernels read them so.
pub(super) fn copy_resources(
    gpu: &Gpu,
    packed: &Packed,
    accel: &Acceleration,
    specialisation: &Specialisation,
) -> Result<Vec<(u32, Resource)>, Error> {
    let Some(grid) = accel.grid.as_ref().filter(|_| specialisation.variant().copies()) else { return Ok(Vec::new()) };
    let texels = |half: &Contents, entries: &[u32]| {
        // Packed once: to pack the spheres in any order takes far longer than to copy them so.
        let all = half.bytes();
        upload_texels(gpu, &Contents::gathered(&all, half.element_size(), entries), 4).map(Resource::Texels)
    };
    let [first, second] = &packed.shapes;
    let entries = &grid.lists.entries;
    let ends = if specialisation.reads_shape_ends() { &entries[..] } else { &[] };
    let none = Contents::none();
    let second = if ends.is_empty() { &none } else { second };
    Ok(vec![(24, texels(first, entries)?), (25, texels(second, ends)?)])
}

/// The buffers and textures of the scene, by binding, beside those of the lists.
pub(super) fn scene_resources(
    gpu: &Gpu,
    packed: &Packed,
    specialisation: &Specialisation,
) -> Result<Vec<(u32, Resource)>, Error> {
    let (storage, uniform) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::UNIFORM);
    // A binding of size 0 is not allowed.
    let filled =
        |contents: &Contents, usage| upload(gpu, contents, usage, contents.len().max(64)).map(Resource::Buffer);
    let texels = |contents: &Contents| upload_texels(gpu, contents, 4).map(Resource::Texels);
    let none = Contents::none();
    let second_half = |half| texels(if specialisation.reads_shape_ends() { half } else { &none });
    let mut resources = vec![
        (0, filled(&packed.params, uniform)?),
        (1, texels(&packed.shapes[0])?),
        (20, second_half(&packed.shapes[1])?),
        (2, texels(&packed.materials)?),
        (3, texels(&packed.lights)?),
        (4, texels(&packed.window)?),
        (14, texels(&packed.faces)?),
    ];
    if specialisation.refraction.is_some() {
        resources.push((5, filled(&packed.glasses, storage)?));
    }
    if let Some(([first, second], lights)) = &packed.low {
        resources.extend([(9, texels(first)?), (21, second_half(second)?), (10, texels(lights)?)]);
    }
    Ok(resources)
}

/// What the tables of a scene take, each with what the device holds of its kind.
type Sizes = Vec<(&'static str, usize, u64)>;

fn list_sizes(gpu: &Gpu, [cells, entries]: &[Contents; 2]) -> Sizes {
    vec![("cells with lists", cells.len(), max_texels(gpu, 8)), ("lists", entries.len(), max_texels(gpu, 8))]
}

/// Whether the device has no room for these lists.
pub(super) fn are_too_large(gpu: &Gpu, lists: &[Contents; 2]) -> bool {
    too_large(&list_sizes(gpu, lists)).is_some()
}

/// The first that is too large.
fn too_large(sizes: &Sizes) -> Option<&(&'static str, usize, u64)> {
    sizes.iter().find(|(_, size, limit)| *size as u64 > *limit)
}

/// Refuses a scene whose tables are larger than the device's bindings and textures.
pub(super) fn check_fits(gpu: &Gpu, packed: &Packed, lists: &[Contents; 2]) -> Result<(), Error> {
    let buffer = gpu.info.max_storage_binding.min(gpu.info.max_buffer);
    let texels = max_texels(gpu, 16);
    let mut sizes = list_sizes(gpu, lists);
    sizes.extend([
        // Paths keep the index of a sphere as a number, exact in `f32` up to 2²⁴.
        ("spheres", packed.materials.len(), texels.min((packed.materials.element_size() as u64) << 24)),
        ("lights", packed.lights.len(), texels),
        ("glass", packed.glasses.len(), buffer),
        ("columns and rows", packed.window.len(), texels),
        ("faces around the lights", packed.faces.len(), texels),
    ]);
    match too_large(&sizes) {
        None => Ok(()),
        Some((what, size, limit)) => Err(Error::NoDevice(format!(
            "the {what} of this scene take {size} bytes, but {} holds {limit} at the most; `--device cpu` has no such limit",
            gpu.info
        ))),
    }
}

//! The buffers and textures of a scene, and whether a device holds them.

use super::pack::Packed;
use crate::accel::Acceleration;
use crate::gpu::device::contents::Contents;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::upload::{max_texels, upload, upload_texels};
use crate::gpu::kernel::shader::Textures;
use crate::gpu::kernel::specialisation::Specialisation;
use crate::gpu::kernel::stage::{Resource, Resources, table_usage};

/// The textures of the lists, by name.
pub(crate) fn list_resources(
    device: &Device,
    textures: Textures,
    [cells, entries]: &[Contents; 2],
) -> Result<Resources, Error> {
    let texels = |contents| upload_texels(device, contents, 2, table_usage(textures)).map(Resource::Texels);
    Ok(vec![("cells", texels(cells)?), ("entries", texels(entries)?)])
}

/// Whether the device has room for the shapes in the order of the grid's lists.
pub(crate) fn copies_fit(device: &Device, packed: &Packed, accel: &Acceleration) -> bool {
    let entries = accel.grid.as_ref().map_or(0, |grid| grid.lists.entries.len());
    (entries * packed.shapes[0].element_size()) as u64 <= max_texels(device, 16)
}

/// The textures of the shapes in the order of the grid's lists, by name, where kernels read them so.
pub(crate) fn copy_resources(
    device: &Device,
    textures: Textures,
    packed: &Packed,
    accel: &Acceleration,
    specialisation: &Specialisation,
) -> Result<Resources, Error> {
    let Some(grid) = accel.grid.as_ref().filter(|_| specialisation.variant().copies()) else { return Ok(Vec::new()) };
    let texels = |half: &Contents, entries: &[u32]| {
        // Packed once: to pack the spheres in any order takes far longer than to copy them so.
        let all = half.bytes();
        let contents = Contents::gathered(&all, half.element_size(), entries);
        upload_texels(device, &contents, 4, table_usage(textures)).map(Resource::Texels)
    };
    let [first, second] = &packed.shapes;
    let entries = &grid.lists.entries;
    let ends = if specialisation.reads_shape_ends() { &entries[..] } else { &[] };
    let none = Contents::none();
    let second = if ends.is_empty() { &none } else { second };
    Ok(vec![("grid_shapes", texels(first, entries)?), ("grid_shape_ends", texels(second, ends)?)])
}

/// The buffers and textures of the scene, by name, beside those of the lists.
pub(crate) fn scene_resources(
    device: &Device,
    textures: Textures,
    packed: &Packed,
    specialisation: &Specialisation,
) -> Result<Resources, Error> {
    let (storage, uniform) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::UNIFORM);
    // A binding of size 0 is not allowed.
    let filled =
        |contents: &Contents, usage| upload(device, contents, usage, contents.len().max(64)).map(Resource::Buffer);
    let texels = |contents: &Contents| upload_texels(device, contents, 4, table_usage(textures)).map(Resource::Texels);
    let none = Contents::none();
    let second_half = |half| texels(if specialisation.reads_shape_ends() { half } else { &none });
    let mut resources = vec![
        ("given_params", filled(&packed.params, uniform)?),
        ("shapes", texels(&packed.shapes[0])?),
        ("shape_ends", second_half(&packed.shapes[1])?),
        ("materials", texels(&packed.materials)?),
        ("lights", texels(&packed.lights)?),
        ("window", texels(&packed.window)?),
        ("faces", texels(&packed.faces)?),
    ];
    if specialisation.refraction.is_some() {
        resources.push(("glasses", filled(&packed.glasses, storage)?));
    }
    if let Some(([first, second], lights)) = &packed.low {
        resources.extend([
            ("shapes_low", texels(first)?),
            ("shape_ends_low", second_half(second)?),
            ("lights_low", texels(lights)?),
        ]);
    }
    Ok(resources)
}

/// What the tables of a scene take, each with what the device holds of its kind.
type Sizes = Vec<(&'static str, usize, u64)>;

fn list_sizes(device: &Device, [cells, entries]: &[Contents; 2]) -> Sizes {
    vec![("cells with lists", cells.len(), max_texels(device, 8)), ("lists", entries.len(), max_texels(device, 8))]
}

/// Whether the device has no room for these lists.
pub(crate) fn are_too_large(device: &Device, lists: &[Contents; 2]) -> bool {
    too_large(&list_sizes(device, lists)).is_some()
}

/// The first that is too large.
fn too_large(sizes: &Sizes) -> Option<&(&'static str, usize, u64)> {
    sizes.iter().find(|(_, size, limit)| *size as u64 > *limit)
}

/// Refuses a scene whose tables are larger than the device's bindings and textures.
pub(crate) fn check_fits(device: &Device, packed: &Packed, lists: &[Contents; 2]) -> Result<(), Error> {
    let buffer = device.info.max_storage_binding.min(device.info.max_buffer);
    let texels = max_texels(device, 16);
    let mut sizes = list_sizes(device, lists);
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
        Some((what, size, limit)) => Err(Error::too_large(
            &device.info,
            "this scene",
            format!("the {what} take {size} bytes, and it holds {limit} at the most; `--device cpu` has no such limit"),
        )),
    }
}

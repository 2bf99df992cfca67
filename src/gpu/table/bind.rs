//! The buffers and textures of a scene, and whether a device holds them.

use super::pack::Packed;
use super::pool::{Basis, TableSet, storage_buffer, texture_usage};
use crate::accel::Acceleration;
use crate::gpu::device::contents::Contents;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::upload::{empty_texels, max_texels, upload};
use crate::gpu::kernel::pipeline::Resource;
use crate::gpu::kernel::specialisation::Specialisation;
use crate::gpu::kernel::variant::Tables;

/// A table for so many bytes that kernels keep and read.
pub(crate) fn empty_table(device: &Device, tables: Tables, size: u64, components: u32) -> Resource {
    match texture_usage(tables) {
        None => {
            let usage = wgpu::BufferUsages::STORAGE;
            let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            Resource::Buffer(device.raw.create_buffer(&descriptor))
        }
        Some(usage) => Resource::Texels(empty_texels(device, size, components, usage)),
    }
}

/// Greatest size of a table, in bytes.
fn max_table(device: &Device, tables: Tables, components: u64) -> u64 {
    match tables {
        Tables::Buffers => max_buffer(device),
        Tables::Stored | Tables::Sampled => max_texels(device, 4 * components),
    }
}

fn max_buffer(device: &Device) -> u64 {
    device.info.max_storage_binding.min(device.info.max_buffer)
}

/// Adds the lists.
pub(crate) fn add_lists(
    set: &mut TableSet,
    device: &Device,
    accel: &Acceleration,
    [cells, entries]: &[Contents; 2],
) -> Result<(), Error> {
    // Those of the screen are the first.
    let screen = &accel.screen.lists;
    let [changed_cells, changed_entries] =
        [screen.cells() * cells.element_size(), screen.entries.len() * entries.element_size()];
    let basis = || accel.room.clone().map(Basis::Lists);
    set.add_changed(device, "cells", (cells, 2), basis(), changed_cells)?;
    set.add_changed(device, "entries", (entries, 2), basis(), changed_entries)
}

/// Whether the device has room for the shapes in the order of the grid's lists.
pub(crate) fn copies_fit(device: &Device, tables: Tables, packed: &Packed, accel: &Acceleration) -> bool {
    let entries = accel.grid.as_ref().map_or(0, |grid| grid.lists.entries.len());
    (entries * packed.shapes[0].element_size()) as u64 <= max_table(device, tables, 4)
}

/// Adds the shapes in the order of the grid's lists, where kernels read them so.
pub(crate) fn add_copies(
    set: &mut TableSet,
    device: &Device,
    packed: &Packed,
    accel: &Acceleration,
    specialisation: &Specialisation,
) -> Result<(), Error> {
    let Some(grid) = accel.grid.as_ref().filter(|_| specialisation.variant().copies()) else { return Ok(()) };
    let mut add = |name, half: &Contents, entries: &[u32]| {
        // Packed once: to pack the spheres in any order takes far longer than to copy them so.
        let all = half.bytes();
        let contents = Contents::gathered(&all, half.element_size(), entries);
        set.add(device, name, &contents, 4)
    };
    let [first, second] = &packed.shapes;
    let entries = &grid.lists.entries;
    let ends = if specialisation.reads_shape_ends() { &entries[..] } else { &[] };
    let none = Contents::none();
    let second = if ends.is_empty() { &none } else { second };
    add("grid_shapes", first, entries)?;
    add("grid_shape_ends", second, ends)
}

/// Adds the buffers and textures of the scene beside those of the lists; `basis` is that of the materials.
pub(crate) fn add_scene(
    set: &mut TableSet,
    device: &Device,
    packed: &Packed,
    specialisation: &Specialisation,
    basis: Basis,
) -> Result<(), Error> {
    let params = upload(device, &packed.params, wgpu::BufferUsages::UNIFORM, packed.params.len())?;
    set.add_own("given_params", Resource::Buffer(params));
    let none = Contents::none();
    let second_half = |half| if specialisation.reads_shape_ends() { half } else { &none };
    set.add(device, "shapes", &packed.shapes[0], 4)?;
    set.add(device, "shape_ends", second_half(&packed.shapes[1]), 4)?;
    set.add_changed(device, "materials", (&packed.materials, 4), Some(basis), 0)?;
    set.add(device, "lights", &packed.lights, 4)?;
    set.add(device, "window", &packed.window, 4)?;
    set.add(device, "faces", &packed.faces, 4)?;
    if specialisation.refraction.is_some() {
        set.add_own("glasses", storage_buffer(device, &packed.glasses)?);
    }
    if let Some(([first, second], lights)) = &packed.low {
        set.add(device, "shapes_low", first, 4)?;
        set.add(device, "shape_ends_low", second_half(second), 4)?;
        set.add(device, "lights_low", lights, 4)?;
    }
    Ok(())
}

/// What the tables of a scene take, each with what the device holds of its kind.
type Sizes = Vec<(&'static str, usize, u64)>;

fn list_sizes(device: &Device, tables: Tables, [cells, entries]: &[Contents; 2]) -> Sizes {
    let most = max_table(device, tables, 2);
    vec![("cells with lists", cells.len(), most), ("lists", entries.len(), most)]
}

/// Whether the device has no room for these lists.
pub(crate) fn are_too_large(device: &Device, tables: Tables, lists: &[Contents; 2]) -> bool {
    too_large(&list_sizes(device, tables, lists)).is_some()
}

/// The first that is too large.
fn too_large(sizes: &Sizes) -> Option<&(&'static str, usize, u64)> {
    sizes.iter().find(|(_, size, limit)| *size as u64 > *limit)
}

/// Refuses a scene whose tables are larger than the device's bindings and textures.
pub(crate) fn check_fits(device: &Device, tables: Tables, packed: &Packed, lists: &[Contents; 2]) -> Result<(), Error> {
    let most = max_table(device, tables, 4);
    let mut sizes = list_sizes(device, tables, lists);
    sizes.extend([
        // Paths keep the index of a sphere as a number, exact in `f32` up to 2²⁴.
        ("spheres", packed.materials.len(), most.min((packed.materials.element_size() as u64) << 24)),
        ("lights", packed.lights.len(), most),
        ("glass", packed.glasses.len(), max_buffer(device)),
        ("columns and rows", packed.window.len(), most),
        ("faces around the lights", packed.faces.len(), most),
    ]);
    match too_large(&sizes) {
        None => Ok(()),
        Some((what, size, limit)) => Err(Error::too_large(
            &device.info,
            "this scene",
            format!("the {what} take {size} bytes, and it holds {limit} at the most"),
        )),
    }
}

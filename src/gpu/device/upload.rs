//! From packed elements to buffers and textures of the device, in parallel and without a copy of the whole on the host.

use rayon::prelude::*;

use super::contents::Contents;
use super::error::Error;
use super::open::Device;
use crate::gpu::shared::ROW_BITS;

/// Bytes that a task packs at a time: whole elements of every size.
const PIECE: usize = 192 << 9;
/// Bytes that are packed before they go on their way to the device, on which two times as many are at the most.
const BAND: usize = 160 * PIECE;

/// A buffer with `contents` and zeros up to `size`, which is no less.
pub(crate) fn upload(
    device: &Device,
    contents: &Contents,
    usage: wgpu::BufferUsages,
    size: usize,
) -> Result<wgpu::Buffer, Error> {
    device.checked("filling buffers", || {
        let size = size.next_multiple_of(4) as u64;
        let create = |usage, mapped_at_creation| {
            device.raw.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation })
        };
        if device.mappable && contents.len() > 0 {
            let buffer = create(usage | wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_DST, true);
            if let Ok(mut view) = buffer.get_mapped_range_mut(..contents.len() as u64) {
                write(contents, 0, view.slice(..));
            }
            buffer.unmap();
            return Ok(buffer);
        }
        let buffer = create(usage | wgpu::BufferUsages::COPY_DST, false);
        fill_buffer(device, &buffer, contents, contents.len())?;
        Ok(buffer)
    })?
}

/// Writes so many bytes of `contents`.
pub(crate) fn fill_buffer(
    device: &Device,
    buffer: &wgpu::Buffer,
    contents: &Contents,
    len: usize,
) -> Result<(), Error> {
    for start in (0..len).step_by(BAND) {
        let len = BAND.min(len - start) as u64;
        let view = wgpu::BufferSize::new(len).and_then(|len| device.queue.write_buffer_with(buffer, start as u64, len));
        if let Some(mut view) = view {
            write(contents, start, view.slice(..));
        }
        // Only then is the memory on the way free for the next band.
        device.submit(None);
        device.wait()?;
    }
    Ok(())
}

/// A small buffer with `contents`.
pub(crate) fn small_buffer(device: &Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = contents.len().next_multiple_of(4).max(4);
    let mut whole = contents.to_vec();
    whole.resize(size, 0);
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let buffer = device.raw.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: size as u64,
        usage,
        mapped_at_creation: false,
    });
    device.queue.write_buffer(&buffer, 0, &whole);
    buffer
}

/// Texels in a row of a texture that stands for a buffer.
const ROW: u32 = 1 << ROW_BITS;

/// Greatest size of `contents` as such a texture, in bytes.
pub(crate) fn max_texels(device: &Device, texel_size: u64) -> u64 {
    u64::from(ROW) * texel_size * u64::from(device.raw.limits().max_texture_dimension_2d)
}

/// Texels of one, two or four `u32`.
pub(crate) fn texel_format(components: u32) -> wgpu::TextureFormat {
    match components {
        1 => wgpu::TextureFormat::R32Uint,
        2 => wgpu::TextureFormat::Rg32Uint,
        _ => wgpu::TextureFormat::Rgba32Uint,
    }
}

/// A texture for so many bytes that kernels keep and read, in texels of one, two or four `u32`.
pub(crate) fn empty_texels(
    device: &Device,
    bytes: u64,
    components: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let usage = usage | wgpu::TextureUsages::STORAGE_BINDING;
    let rows = bytes.div_ceil(u64::from(ROW * components * 4)) as u32;
    texture(device, rows, texel_format(components), usage).create_view(&wgpu::TextureViewDescriptor::default())
}

fn texture(device: &Device, rows: u32, format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    device.raw.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: ROW, height: rows, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A texture with `contents` in reading order, in texels of one, two or four `u32`.
pub(crate) fn upload_texels(
    device: &Device,
    contents: &Contents,
    components: u32,
    usage: wgpu::TextureUsages,
) -> Result<wgpu::TextureView, Error> {
    device.checked("filling textures", || texels(device, contents, components, usage))?
}

/// Likewise; what the device reports is the caller's.
pub(crate) fn texels(
    device: &Device,
    contents: &Contents,
    components: u32,
    usage: wgpu::TextureUsages,
) -> Result<wgpu::TextureView, Error> {
    let rows = contents.len().div_ceil(row_bytes(components)).max(1) as u32;
    let texture = texture(device, rows, texel_format(components), usage | wgpu::TextureUsages::COPY_DST);
    fill_texels(device, &texture, contents, components, contents.len())?;
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

/// Bytes of a row of texels.
fn row_bytes(components: u32) -> usize {
    (ROW * components * 4) as usize
}

/// Writes so many bytes of `contents`, or those of whole rows.
pub(crate) fn fill_texels(
    device: &Device,
    texture: &wgpu::Texture,
    contents: &Contents,
    components: u32,
    len: usize,
) -> Result<(), Error> {
    let row = row_bytes(components);
    let end = len.next_multiple_of(row).min(contents.len());
    // Whole rows of whole elements of every size.
    let band = BAND.next_multiple_of(3 * row);
    let extent = |rows: usize| wgpu::Extent3d { width: ROW, height: rows as u32, depth_or_array_layers: 1 };
    let mut on_the_way = None;
    for start in (0..end).step_by(band) {
        let len = band.min(end - start);
        let rows = len.div_ceil(row);
        let staging = device.raw.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (rows * row) as u64,
            // Without MAP_WRITE there would be one more buffer on the way to it.
            usage: wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        if let Ok(mut view) = staging.get_mapped_range_mut(..len as u64) {
            write(contents, start, view.slice(..));
        }
        staging.unmap();
        let mut encoder = device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let source = wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None },
        };
        let origin = wgpu::Origin3d { y: (start / row) as u32, ..wgpu::Origin3d::ZERO };
        let target = wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() };
        encoder.copy_buffer_to_texture(source, target, extent(rows));
        let submission = device.submit(Some(encoder.finish()));
        // One band is packed while the one before is copied; only then is the memory on the way free for the next.
        if let Some(before) = on_the_way.replace(submission) {
            device.wait_until(Some(&before))?;
        }
    }
    Ok(())
}

/// Packs what lies from byte `start` on.
fn write(contents: &Contents, start: usize, target: wgpu::WriteOnly<[u8]>) {
    let fill = |buffer: &mut Vec<u8>, start: usize, mut target: wgpu::WriteOnly<[u8]>| {
        buffer.resize(target.len(), 0);
        contents.write(start, buffer);
        target.copy_from_slice(buffer);
    };
    let (pieces, rest) = target.into_chunks::<PIECE>();
    let rest_start = start + pieces.len() * PIECE;
    let pieces: Vec<wgpu::WriteOnly<[u8; PIECE]>> = pieces.into_iter().collect();
    let piece = |buffer: &mut Vec<u8>, (index, target): (usize, wgpu::WriteOnly<[u8; PIECE]>)| {
        fill(buffer, start + index * PIECE, target.into());
    };
    pieces.into_par_iter().enumerate().for_each_init(Vec::new, piece);
    fill(&mut Vec::new(), rest_start, rest);
}

//! From packed elements to buffers of the device, in parallel and without a copy of the whole on the host.

use rayon::prelude::*;

use super::device::Gpu;
use super::error::Error;
use super::pack::Contents;

/// Bytes that a task packs at a time: whole elements of every size.
const PIECE: usize = 192 << 9;
/// Bytes on their way to a device with memory of its own.
const BAND: usize = 160 * PIECE;

/// A buffer with `contents` and zeros up to `size`, which is no less.
pub(super) fn upload(
    gpu: &Gpu,
    contents: &Contents,
    usage: wgpu::BufferUsages,
    size: usize,
) -> Result<wgpu::Buffer, Error> {
    gpu.checked("filling buffers", || {
        let size = size.next_multiple_of(4) as u64;
        let create = |usage, mapped_at_creation| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation })
        };
        if gpu.mappable && contents.len() > 0 {
            let buffer = create(usage | wgpu::BufferUsages::MAP_WRITE, true);
            if let Ok(mut view) = buffer.get_mapped_range_mut(..contents.len() as u64) {
                write(contents, 0, view.slice(..));
            }
            buffer.unmap();
            return buffer;
        }
        let buffer = create(usage | wgpu::BufferUsages::COPY_DST, false);
        for start in (0..contents.len()).step_by(BAND) {
            let len = BAND.min(contents.len() - start) as u64;
            let view =
                wgpu::BufferSize::new(len).and_then(|len| gpu.queue.write_buffer_with(&buffer, start as u64, len));
            if let Some(mut view) = view {
                write(contents, start, view.slice(..));
            }
            // Only then is the memory on the way free for the next band.
            gpu.queue.submit([]);
            let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        }
        buffer
    })
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

//! A storage buffer of `u32` values that the host reads.

use super::error::Error;
use super::open::Device;

/// The buffer, and where it is copied for reading unless it can be mapped where it is.
#[derive(Debug)]
pub(crate) struct Readable {
    pub(crate) buffer: wgpu::Buffer,
    staging: Option<wgpu::Buffer>,
}

impl Readable {
    /// Reserves space for `len` values.
    pub(crate) fn new(device: &Device, len: u64) -> Self {
        let buffer = |usage| {
            let descriptor = wgpu::BufferDescriptor { label: None, size: len * 4, usage, mapped_at_creation: false };
            device.raw.create_buffer(&descriptor)
        };
        let read = wgpu::BufferUsages::MAP_READ;
        let storage = wgpu::BufferUsages::STORAGE;
        if device.mappable {
            Self { buffer: buffer(storage | read), staging: None }
        } else {
            Self {
                buffer: buffer(storage | wgpu::BufferUsages::COPY_SRC),
                staging: Some(buffer(read | wgpu::BufferUsages::COPY_DST)),
            }
        }
    }

    /// Hands the first `len` values to `use_values`, once the device is done with them.
    pub(crate) fn read<R>(
        &self,
        device: &Device,
        len: usize,
        use_values: impl FnOnce(&[u32]) -> R,
    ) -> Result<R, Error> {
        let size = len as u64 * 4;
        if let Some(staging) = &self.staging {
            let mut encoder = device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(&self.buffer, 0, staging, 0, size);
            device.submit(Some(encoder.finish()));
        }
        let host = self.staging.as_ref().unwrap_or(&self.buffer);
        let slice = host.slice(..size);
        let (sender, receiver) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // The receiver outlives the wait below; if it is gone, so is the interest in the result.
            let _ = sender.send(result);
        });
        device.wait()?;
        let lost = |why: String| Error::Lost(format!("reading back from {}: {why}", device.info));
        receiver.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let result = {
            let view = slice.get_mapped_range().map_err(|e| lost(e.to_string()))?;
            use_values(bytemuck::cast_slice(&view))
        };
        host.unmap();
        Ok(result)
    }
}

//! The device's own clock around a dispatch.

use std::time::Duration;

use super::error::Error;
use super::open::Device;

/// Two timestamps, at the begin and the end of a compute pass, and where the host reads them.
#[derive(Debug)]
pub(crate) struct Timestamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    host: wgpu::Buffer,
    /// Length of a tick, in ns.
    period: f64,
}

/// Bytes of two timestamps.
const SIZE: u64 = 16;

impl Timestamps {
    /// For a device with timestamp queries; `None` without.
    pub(crate) fn new(device: &Device) -> Option<Self> {
        if !device.raw.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |usage| {
            let descriptor = wgpu::BufferDescriptor { label: None, size: SIZE, usage, mapped_at_creation: false };
            device.raw.create_buffer(&descriptor)
        };
        let queries = device.raw.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let host = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        Some(Self { queries, resolved, host, period: f64::from(device.queue.get_timestamp_period()) })
    }

    /// What a compute pass writes.
    pub(crate) fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Lets the device hand over what the pass wrote.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.host, 0, SIZE);
    }

    /// From the begin to the end of the last pass, once the device is done with it.
    pub(crate) fn elapsed(&self, device: &Device) -> Result<Duration, Error> {
        let slice = self.host.slice(..);
        // The result also comes as an error of the range below.
        slice.map_async(wgpu::MapMode::Read, |_| ());
        device.wait()?;
        let lost = |why: String| Error::Lost(format!("reading timestamps from {}: {why}", device.info));
        let ticks = {
            let view = slice.get_mapped_range().map_err(|e| lost(e.to_string()))?;
            let ticks: &[u64] = bytemuck::cast_slice(&view);
            ticks[1].saturating_sub(ticks[0])
        };
        self.host.unmap();
        Ok(Duration::from_nanos((ticks as f64 * self.period) as u64))
    }
}

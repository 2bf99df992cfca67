//! The compiled kernels of a picture with the buffers that they share.

use std::sync::Arc;

use super::tiles::{TILE_PIXELS, tiles_size};
use crate::gpu::device::readable::Readable;
use crate::gpu::device::upload::small_buffer;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::picture::Pipelines;
use crate::gpu::kernel::pipeline::{Pipeline, Resource};
use crate::gpu::kernel::specialisation::Specialisation;
use crate::gpu::kernel::variant::{Schedule, Slots};
use crate::gpu::shared::WORKGROUP_WORDS;
use crate::gpu::table::bind::empty_table;

/// Bytes of the shader's `PathQueue`.
pub(super) const PATH_QUEUE_SIZE: u64 = 8;

/// Bytes of a slot's ray counts in `shaders/counters.wgsl`.
pub(super) const RAY_COUNT_SIZE: u64 = 8;

/// The compiled kernels with their buffers.
#[derive(Debug)]
pub(super) struct Work {
    pub(super) pipelines: Arc<Pipelines>,
    pub(super) trace_group: wgpu::BindGroup,
    /// For what goes before a bounce.
    pub(super) begin_group: Option<wgpu::BindGroup>,
    /// For a bounce, by whether another one follows, and from which of the two tables of paths to the other.
    pub(super) walk_groups: Option<[[wgpu::BindGroup; 2]; 2]>,
    /// Likewise for its shading.
    pub(super) shade_groups: Option<[[wgpu::BindGroup; 2]; 2]>,
    pub(super) resolve_group: Option<wgpu::BindGroup>,
    pub(super) tiles: wgpu::Buffer,
    pub(super) path_queue: wgpu::Buffer,
    /// Which term is asked for, where the kernel has terms in place of colours.
    pub(super) asked: wgpu::Buffer,
    /// Workgroups of the next bounce: of the kernel with a path an invocation, and of the one with several.
    pub(super) workgroups: wgpu::Buffer,
    pub(super) pixels: Readable,
    pub(super) ray_counts: Readable,
    /// Colours and coverage of pixels, where they are wanted: four numbers each.
    pub(super) means: Readable,
    /// Tiles that the buffers hold.
    pub(super) capacity: u32,
}

impl Work {
    pub(super) fn new(
        gpu: &Gpu,
        pipelines: Arc<Pipelines>,
        resources: &[(&'static str, Resource)],
        capacity: u32,
        specialisation: &Specialisation,
        has_bounces: bool,
    ) -> Self {
        let (device, tables) = (&gpu.device, gpu.tables());
        let empty = |size, usage| {
            device.raw.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let (storage, copied) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::COPY_DST);
        let pixel_count = u64::from(capacity) * TILE_PIXELS as u64;
        let slots = pixel_count * u64::from(specialisation.samples);
        let pixels = Readable::new(device, pixel_count);
        let ray_counts = Readable::new(device, if specialisation.counts() { slots * RAY_COUNT_SIZE / 4 } else { 2 });
        let number = specialisation.color_size() / 4;
        let means = Readable::new(device, if specialisation.linear { pixel_count * number } else { number });
        let paths = specialisation.path_size() * if specialisation.keeps_paths() { slots } else { 1 };
        let paths = [0, 1].map(|_| empty_table(device, tables, paths, 4));
        let in_turn = matches!(specialisation.schedule, Schedule::InTurn(_));
        let hits = empty_table(device, tables, if in_turn { 4 * slots } else { 4 }, 1);
        let tiles = match specialisation.slots {
            Slots::Tiles => empty(tiles_size(specialisation.dispatch_tiles), wgpu::BufferUsages::UNIFORM | copied),
            Slots::List => empty((1 + pixel_count) * 8, storage | copied),
        };
        let path_queue = empty(PATH_QUEUE_SIZE, storage | copied);
        let asked = empty(8, wgpu::BufferUsages::UNIFORM | copied);
        let workgroups = empty(4 * u64::from(WORKGROUP_WORDS), storage | wgpu::BufferUsages::INDIRECT);
        let colors = pipelines.resolve.as_ref().map(|_| empty(slots * specialisation.color_size(), storage));
        let mut all = resources.to_vec();
        let mut bind = |name, buffer: &wgpu::Buffer| all.push((name, Resource::Buffer(buffer.clone())));
        bind("tiles", &tiles);
        bind("list", &tiles);
        bind("ray_counts", &ray_counts.buffer);
        bind("means", &means.buffer);
        bind("path_queue", &path_queue);
        bind("asked", &asked);
        bind("pixels", &pixels.buffer);
        bind("workgroups", &workgroups);
        if let Some(colors) = &colors {
            bind("colors", colors);
        }
        let has_next =
            [0_u32, 1].map(|has_next| small_buffer(device, bytemuck::bytes_of(&has_next), wgpu::BufferUsages::UNIFORM));
        let turn = |pipeline: &Pipeline, from: usize, goes_on: usize| {
            let [from, to] = [from, 1 - from].map(|half| paths[half].clone());
            let has_next = Resource::Buffer(has_next[goes_on].clone());
            let hits = hits.clone();
            let turn = [
                ("paths", from),
                ("next_paths", to),
                ("has_next", has_next),
                ("hits", hits.clone()),
                ("kept_hits", hits),
            ];
            pipeline.bind(device, &[&all[..], &turn].concat())
        };
        let trace_group = turn(&pipelines.trace, 1, usize::from(has_bounces));
        let begin_group = pipelines.bounce.as_ref().map(|bounce| bounce.begin.bind(device, &all));
        let all_turns = |pipeline| [0, 1].map(|goes_on| [0, 1].map(|from| turn(pipeline, from, goes_on)));
        let walk_groups = pipelines.bounce.as_ref().map(|bounce| all_turns(&bounce.walk));
        let shade = pipelines.bounce.as_ref().and_then(|bounce| bounce.shade.as_ref());
        let shade_groups = shade.map(all_turns);
        let resolve_group = pipelines.resolve.as_ref().map(|resolve| resolve.bind(device, &all));
        Self {
            pipelines,
            trace_group,
            begin_group,
            walk_groups,
            shade_groups,
            resolve_group,
            tiles,
            path_queue,
            asked,
            workgroups,
            pixels,
            ray_counts,
            means,
            capacity,
        }
    }
}

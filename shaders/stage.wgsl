// From one stage to the next: what was gathered is now to be done.

// As in stages.wgsl, without what only that needs.
struct Stage {
    first: u32,
    next_first: u32,
    path_count: u32,
    next_path_count: u32,
    hit_count: u32,
    next_hit_count: u32,
    bounce: u32,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;
// Workgroups of the next dispatch.
@group(0) @binding(16) var<storage, read_write> workgroups: array<u32, 3>;

// As in effects.wgsl.
override GROUP: u32 = 64u;

fn dispatch_over(count: u32) {
    workgroups[0] = (count + GROUP - 1u) / GROUP;
    workgroups[1] = 1u;
    workgroups[2] = 1u;
}

// Rays have been cast; hits are next.
@compute @workgroup_size(1)
fn begin_shading() {
    stage.hit_count = stage.next_hit_count;
    stage.next_hit_count = 0u;
    dispatch_over(stage.hit_count);
}

// Hits have been shaded; their paths are next.
@compute @workgroup_size(1)
fn begin_bounce() {
    let first = stage.next_first;
    stage.next_first = stage.first;
    stage.first = first;
    stage.path_count = stage.next_path_count;
    stage.next_path_count = 0u;
    stage.bounce += 1u;
    dispatch_over(stage.path_count);
}

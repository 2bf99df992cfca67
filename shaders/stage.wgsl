// From one bounce to the next: what was gathered is now to be done.

// As in stages.wgsl.
struct Stage {
    path_count: u32,
    next_path_count: u32,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;
// Workgroups of the next dispatch.
@group(0) @binding(16) var<storage, read_write> workgroups: array<u32, 3>;

// As in effects.wgsl.
override GROUP: u32 = 64u;

@compute @workgroup_size(1)
fn begin_bounce() {
    stage.path_count = stage.next_path_count;
    stage.next_path_count = 0u;
    workgroups[0] = (stage.path_count + GROUP - 1u) / GROUP;
    workgroups[1] = 1u;
    workgroups[2] = 1u;
}

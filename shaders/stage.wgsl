// Between two bounces: what was next is now.

struct Stage {
    first: u32,
    next_first: u32,
    count: u32,
    next_count: u32,
    bounce: u32,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;
// Workgroups of the next dispatch.
@group(0) @binding(16) var<storage, read_write> workgroups: array<u32, 3>;

@compute @workgroup_size(1)
fn advance() {
    let first = stage.next_first;
    stage.next_first = stage.first;
    stage.first = first;
    stage.count = stage.next_count;
    stage.next_count = 0u;
    stage.bounce += 1u;
    workgroups[0] = (stage.count + 63u) / 64u;
    workgroups[1] = 1u;
    workgroups[2] = 1u;
}

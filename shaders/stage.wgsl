// From one bounce to the next: what was gathered is now to be done.

// As in stages.wgsl.
struct Stage {
    path_count: u32,
    next_path_count: u32,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;
// Workgroups of the next dispatches: of the kernel over paths, and of the one in which an invocation has PATHS of them.
@group(0) @binding(16) var<storage, read_write> workgroups: array<u32, 6>;

// As in effects.wgsl.
override GROUP: u32 = 64u;
// As in walk_in_turn.wgsl; 1 where an invocation has one path.
override PATHS: u32 = 1u;

@compute @workgroup_size(1)
fn begin_bounce() {
    stage.path_count = stage.next_path_count;
    stage.next_path_count = 0u;
    workgroups[0] = (stage.path_count + GROUP - 1u) / GROUP;
    workgroups[3] = (stage.path_count + GROUP * PATHS - 1u) / (GROUP * PATHS);
    for (var at = 0u; at < 6u; at += 3u) {
        workgroups[at + 1u] = 1u;
        workgroups[at + 2u] = 1u;
    }
}

// From one bounce to the next: what was gathered is now to be done.
// needs: effects, queue
// host: ONE_PATH, SEVERAL_PATHS, WORKGROUP_WORDS

// Workgroups of the next dispatches: of the kernel over paths, and of the one in which an invocation has PATHS of them.
@group(0) @binding(16) var<storage, read_write> workgroups: array<u32, WORKGROUP_WORDS>;

@compute @workgroup_size(1)
fn begin_bounce() {
    path_queue.path_count = atomicLoad(&path_queue.next_path_count);
    atomicStore(&path_queue.next_path_count, 0u);
    workgroups[ONE_PATH] = (path_queue.path_count + GROUP - 1u) / GROUP;
    workgroups[SEVERAL_PATHS] = (path_queue.path_count + GROUP * PATHS - 1u) / (GROUP * PATHS);
    for (var at = 0u; at < WORKGROUP_WORDS; at += 3u) {
        workgroups[at + 1u] = 1u;
        workgroups[at + 2u] = 1u;
    }
}

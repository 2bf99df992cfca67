// How many paths there are; begin_bounce of bounce.wgsl goes from one bounce to the next.

struct PathQueue {
    // Paths of this bounce, and so far of the next.
    path_count: u32,
    next_path_count: atomic<u32>,
}

@group(0) @binding(12) var<storage, read_write> path_queue: PathQueue;

// Paths of an invocation of walk_in_turn.wgsl; 1 where each has its own.
override PATHS: u32 = 1u;

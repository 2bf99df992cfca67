// One bounce of each path, in two kernels: what its ray meets, and its shading.
//
// The lanes of a vector wait for the one with the longest walk, which among many spheres takes more than twice as long as the
// others. So an invocation walks several paths, one after another, and begins the next while its neighbours are still on their
// way.
// needs: bound, counters, distance, effects, grid, intersect, path, queue, ray, real, scene, secondary, tables, types
// host: MAX_LARGE

// For each path the sphere that its ray meets, which is below 2^24, and these bits.
const HIT_FOUND: u32 = 1u << 31u;
const HIT_INSIDE: u32 = 1u << 30u;
const HIT_CUT: u32 = 1u << 29u;
const HIT_UNSURE: u32 = 1u << 28u;

// Turns between two looks whether a lane is free for its next path.
const TURNS: u32 = 16u;
// What these, the look itself and the large spheres, two a turn, add to the turns of all loops, of which software devices end an invocation's after 65,535: see is_cut. Where that is not enough for all of its
// paths, the host has each walked by an invocation of its own.
const TURNS_OF_LOOK: u32 = 32u;
const MAX_TURNS: u32 = 60000u;
const_assert TURNS + 1u + MAX_LARGE / 2u <= TURNS_OF_LOOK;

@compute @workgroup_size(GROUP)
fn walk_paths(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    params = given_params;
    let first = group.x * GROUP * PATHS;
    let end = min(path_queue.path_count, first + GROUP * PATHS);
    let range = reflection_range();
    // The path that is walked, if it is below `end`, and the next one.
    var current = end;
    var next = first + index;
    var ray: Ray;
    var exit: Exit;
    var nearest = no_hit();
    var walk: Walk;
    walk.goes_on = false;
    // Whose tests are counted.
    var slot = 0u;
    var turns = 0u;
    loop {
        let is_over = turns >= MAX_TURNS;
        if is_over | !walk.goes_on {
            if current < end {
                if COUNT_TESTS {
                    add_counts(slot);
                    other_tests = 0u;
                }
                let bits = select(0u, HIT_FOUND, nearest.found) | select(0u, HIT_INSIDE, nearest.inside);
                let word = nearest.sphere | bits | select(0u, HIT_CUT, walk.goes_on);
                if CERTIFIED {
                    end_search(ray, nearest, false);
                    keep_hit(current, word | select(0u, HIT_UNSURE, is_unsure));
                    is_unsure = false;
                } else {
                    keep_hit(current, word);
                }
            }
            let path = path_of(min(next, end - 1u));
            if COUNT_TESTS {
                slot = path.slot;
            }
            ray = path.ray;
            exit = exit_of(path.own, ray);
            begin_secondary(ray, path.own, exit, range);
            nearest = nearest_outside(ray, exit, range);
            walk = begin_walk(ray);
            walk.goes_on = next < end;
            current = next;
            next += GROUP;
        }
        var turn = 0u;
        loop {
            if walk.goes_on {
                take_turn(&walk, &nearest, ray, exit, range);
            }
            turn++;
            if !walk.goes_on | (turn == TURNS) {
                break;
            }
        }
        turns += TURNS_OF_LOOK;
        if current >= end {
            break;
        }
    }
}

@compute @workgroup_size(GROUP)
fn shade_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    load_lights();
    let count = path_queue.path_count;
    let is_path = id.x < count;
    let index = min(id.x, count - 1u);
    let path = path_of(index);
    let word = hit_at(index);
    is_cut |= (word & HIT_CUT) != 0u;
    if CERTIFIED {
        begin_search(path.ray);
        is_unsure |= (word & HIT_UNSURE) != 0u;
    }
    let hit = Hit(is_path & ((word & HIT_FOUND) != 0u), distance_of(FAR), word & 0xffffffu, (word & HIT_INSIDE) != 0u);
    shade(path.ray, hit, is_path, path.slot, path.color, path.throughput);
}

// A walk through the grid from cell to cell (Amanatides, Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987), in turns:
// each tests a sphere, takes a step, or both, so that lanes with long and with short lists do not wait for each other.
// needs: counters, distance, entry, intersect, ray, real, search, tables, types
// host: WALK_SLACK

struct Walk {
    // In cells.
    origin: vec3<f32>,
    // t for each cell's width.
    inverse: vec3<f32>,
    // t at which the ray leaves the grid; below 0 where it misses it.
    leave: f32,
    // 1 or -1 along each axis, and what that adds to the index of the cell.
    step: vec3<f32>,
    strides: vec3<i32>,
    // Where the ray leaves the cell along each axis.
    wall: vec3<f32>,
    cell: i32,
    // What is left of the list of the cell.
    list: vec2<u32>,
    goes_on: bool,
}

fn begin_walk(ray: Ray) -> Walk {
    let size = vec3<f32>(params.grid_cells);
    let origin = offset_from(ray.origin, params.grid_low) * params.grid_per_unit;
    let direction = vec3<f32>(direction_of(ray)) * params.grid_per_unit;
    // A direction along a plane never leaves it.
    let inverse = select(vec3<f32>(1.0) / direction, vec3<f32>(1e30), abs(direction) < vec3<f32>(1e-30));
    let ends_low = -origin * inverse;
    let ends_high = (size - origin) * inverse;
    let enters = min(ends_low, ends_high);
    let leaves = max(ends_low, ends_high);
    let enter = max(max(enters.x, enters.y), max(enters.z, 0.0));
    let last = min(leaves.x, min(leaves.y, leaves.z));
    let is_inside = enter <= last;
    let place = clamp(floor(origin + direction * enter), vec3<f32>(), size - 1.0);
    let is_ahead = inverse >= vec3<f32>();
    let step = select(vec3<f32>(-1.0), vec3<f32>(1.0), is_ahead);
    let strides = vec3<i32>(vec3<u32>(1u, params.grid_cells.x, params.grid_cells.x * params.grid_cells.y));
    let cell = i32(params.grid_first) + dot(vec3<i32>(place), strides);
    return Walk(
        origin,
        // A ray that misses the grid has left it, and finds all its walls at 0: from far off they are anywhere.
        select(vec3<f32>(), inverse, is_inside),
        select(-1.0, last, is_inside),
        step,
        select(-strides, strides, is_ahead),
        place + max(step, vec3<f32>()),
        cell,
        select(vec2<u32>(), cell_at(u32(cell)), vec2<bool>(is_inside)),
        true,
    );
}

// One turn: the nearer of a hit and the intersection with a sphere, if there is one left in the cell.
fn take_turn(walk: ptr<function, Walk>, nearest: ptr<function, Hit>, ray: Ray, own_exit: Exit, range: Range) {
    // What this turn finds counts from the next one on, which costs a step and lets the two overlap.
    let known = *nearest;
    // From the place of the wall, since a sum would drift.
    let next = ((*walk).wall - (*walk).origin) * (*walk).inverse;
    // Whatever the comparisons say, of NaN even, one axis is taken, so that the walk ends.
    let is_x = (next.x <= next.y) & (next.x <= next.z);
    let is_y = !is_x & (next.y <= next.z);
    let exit = select(select(next.z, next.y, is_y), next.x, is_x);
    let is_done = known.found & (nearest_real(known.t) * WALK_SLACK < real(exit));
    // `leave` is of the last walls, by the very same operations.
    let goes_on = !is_done & (exit < (*walk).leave);
    let strides = (*walk).strides;
    let cell = (*walk).cell + select(select(strides.z, strides.y, is_y), strides.x, is_x);
    // Where the walk is over, the cell may be none of the grid.
    let list = cell_at(select(params.grid_first, u32(cell), goes_on));
    let wall = (*walk).wall + select(vec3<f32>(), (*walk).step, vec3<bool>(is_x, is_y, !is_x & !is_y));
    if (*walk).list.x < (*walk).list.y {
        let sphere = entry_at((*walk).list.x);
        *nearest = nearer_of(known, ray, body_in_grid((*walk).list.x, sphere), sphere, own_exit, range);
        (*walk).list.x++;
    }
    if (*walk).list.x >= (*walk).list.y {
        (*walk).goes_on = goes_on;
        (*walk).wall = wall;
        (*walk).cell = cell;
        (*walk).list = select(vec2<u32>(), list, vec2<bool>(goes_on));
    }
}

// The nearer of a hit and the intersections with the spheres in the grid.
fn nearest_in_grid(before: Hit, ray: Ray, exit: Exit, range: Range) -> Hit {
    var nearest = before;
    var walk = begin_walk(ray);
    loop {
        take_turn(&walk, &nearest, ray, exit, range);
        if !walk.goes_on {
            break;
        }
    }
    // Not by the condition of the loop alone, which compilers may take for granted behind it.
    is_cut |= walk.goes_on | (walk.list.x < walk.list.y);
    return nearest;
}

// The nearer of a hit and the intersections with the spheres in the grid: a walk from cell to cell (Amanatides, Woo, "A Fast Voxel
// Traversal Algorithm for Ray Tracing", 1987). Each turn of its only loop tests a sphere, takes a step, or both, so that lanes with
// long and with short lists do not wait for each other.
fn nearest_in_grid(before: Hit, ray: Ray, own: Own, range: Range) -> Hit {
    // In cells.
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
    // A ray that misses the grid has left it.
    let leave = select(-1.0, last, is_inside);
    let place = clamp(floor(origin + direction * enter), vec3<f32>(), size - 1.0);
    let is_ahead = inverse >= vec3<f32>();
    let step = select(vec3<f32>(-1.0), vec3<f32>(1.0), is_ahead);
    let strides = vec3<i32>(vec3<u32>(1u, params.grid_cells.x, params.grid_cells.x * params.grid_cells.y));
    let strides_ahead = select(-strides, strides, is_ahead);
    // Where the ray leaves the cell along each axis.
    var wall = place + max(step, vec3<f32>());
    var cell = i32(params.grid_first) + dot(vec3<i32>(place), strides);
    var list = select(vec2<u32>(), cell_at(u32(cell)), vec2<bool>(is_inside));
    var nearest = before;
    loop {
        let known = nearest;
        if list.x < list.y {
            let sphere = entry_at(list.x);
            nearest = nearer_of(nearest, ray, body_of(sphere), sphere, own, range);
            list.x++;
        }
        if list.x >= list.y {
            // From the place of the wall, since a sum would drift.
            let next = (wall - origin) * inverse;
            // Whatever the comparisons say, of NaN even, one axis is taken, so that the walk ends.
            let is_x = (next.x <= next.y) & (next.x <= next.z);
            let is_y = !is_x & (next.y <= next.z);
            let exit = select(select(next.z, next.y, is_y), next.x, is_x);
            // The hits in later cells are good to far less than this part.
            let is_done = known.found & (nearest_real(known.t) * real(1.0009765625) < real(exit));
            // `leave` is of the last walls, by the very same operations.
            if is_done | !(exit < leave) {
                break;
            }
            wall += select(vec3<f32>(), step, vec3<bool>(is_x, is_y, !is_x & !is_y));
            cell += select(select(strides_ahead.z, strides_ahead.y, is_y), strides_ahead.x, is_x);
            list = cell_at(u32(cell));
        }
    }
    return nearest;
}

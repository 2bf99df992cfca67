// The nearest hit and any hit among those spheres that a ray can meet; read it beside src/accel and src/cpu/intersect.rs.

// One side of the cube of directions around a light: as in src/accel/light_buffer.rs.
struct Face {
    // Least u and v of any sphere.
    @align(16) low: vec2r,
    // Cells per unit of u and v.
    per_unit: real,
    // Where in `lists` the offsets of the face's cells begin.
    first: u32,
    // Number of cells along u and v.
    cells: vec2<u32>,
}

// Lists of spheres: the offsets of all lists, then the entries. Offsets count from the beginning of the buffer.
@group(0) @binding(13) var<storage, read> lists: array<u32>;
// Radii that a sphere reaches towards a light, rounding included: REACH in src/accel/light_buffer.rs.
const REACH: real = real(1.01);

// The nearer of a hit and the intersection with one more sphere; of equal ones the lower index.
fn nearer_of(nearest: Hit, ray: Ray, sphere: u32, own: Own, range: Range) -> Hit {
    let root = accepted_root(ray, sphere, own, range);
    let is_tie = !is_nearer(nearest.t, root.t) && sphere < nearest.sphere;
    if root.counts && (is_nearer(root.t, nearest.t) || is_tie) {
        return Hit(true, root.t, sphere, root.inside);
    }
    return nearest;
}

// Loops below break at the end of their body: compilers for software devices run the body once more, in vain, where the
// condition stands at the beginning, and take a continuing block for the beginning.

// The nearer of a hit and the intersections with one list of spheres, whose place in `lists` is at this offset.
fn nearest_in(offset: u32, before: Hit, ray: Ray, own: Own, range: Range) -> Hit {
    var nearest = before;
    var at = lists[offset];
    let end = lists[offset + 1u];
    if at < end {
        loop {
            nearest = nearer_of(nearest, ray, lists[at], own, range);
            at++;
            if at == end {
                break;
            }
        }
    }
    return nearest;
}

// The nearest intersection of a primary ray through the tile of this pixel.
fn nearest_seen(ray: Ray, pixel: vec2<u32>) -> Hit {
    let own = Own(NO_SHAPE, false, vec3r());
    let range = primary_range();
    let tile = pixel >> vec2(params.screen_shift);
    let offset = tile.y * params.screen_across + tile.x;
    return nearest_in(offset, no_hit(), ray, own, range);
}

// The nearest intersection of a ray that leaves a surface: a walk through a grid (Amanatides, Woo, "A Fast Voxel Traversal Algorithm for
// Ray Tracing", 1987).
fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    let cells = vec3<i32>(params.grid_cells);
    var nearest = no_hit();
    // The last list has the spheres that are too large for the cells.
    let large = params.grid_offsets + params.grid_cells.x * params.grid_cells.y * params.grid_cells.z;
    nearest = nearest_in(large, nearest, ray, own, range);

    // In cells.
    let origin = offset_from(ray.origin, params.grid_low) * params.grid_per_unit;
    let direction = vec3<f32>(direction_of(ray)) * params.grid_per_unit;
    // A direction along a plane never leaves it.
    let inverse = select(vec3<f32>(1.0) / direction, vec3<f32>(1e30), abs(direction) < vec3<f32>(1e-30));
    let ends_low = -origin * inverse;
    let ends_high = (vec3<f32>(cells) - origin) * inverse;
    let enters = min(ends_low, ends_high);
    let leaves = max(ends_low, ends_high);
    let enter = max(max(enters.x, enters.y), max(enters.z, 0.0));
    var inside = enter <= min(leaves.x, min(leaves.y, leaves.z));
    var cell = vec3<i32>(clamp(floor(origin + direction * enter), vec3<f32>(), vec3<f32>(cells - 1)));
    let step = select(vec3<i32>(-1), vec3<i32>(1), inverse >= vec3<f32>());
    let strides = vec3<i32>(1, cells.x, cells.x * cells.y);
    if !inside {
        return nearest;
    }
    loop {
        nearest = nearest_in(params.grid_offsets + u32(dot(cell, strides)), nearest, ray, own, range);
        // From the place of the wall, since a sum would drift.
        let next = (vec3<f32>(cell + max(step, vec3<i32>())) - origin) * inverse;
        // Whatever the comparisons say, of NaN even, one axis is taken, so that the walk ends.
        let is_x = next.x <= next.y && next.x <= next.z;
        let is_y = !is_x && next.y <= next.z;
        let axis = vec3<bool>(is_x, is_y, !is_x && !is_y);
        let exit = select(select(next.z, next.y, is_y), next.x, is_x);
        cell += select(vec3<i32>(), step, axis);
        // The hits in later cells are good to far less than this part.
        let is_done = nearest.found && nearest_real(nearest.t) * real(1.0009765625) < real(exit);
        inside = !is_done && all(cell >= vec3<i32>()) && all(cell < cells);
        if !inside {
            break;
        }
    }
    return nearest;
}

// First and one past the last entry of the list for a direction from a light; both 0 where no sphere is.
fn light_list(light: u32, direction: vec3r) -> vec2<u32> {
    let size = abs(direction);
    let is_x = size.x >= size.y && size.x >= size.z;
    let is_y = !is_x && size.y >= size.z;
    // The greatest component and the two that follow it, cyclically.
    let turned = select(select(direction.zxy, direction.yzx, is_y), direction, is_x);
    let axis = select(select(2u, 1u, is_y), 0u, is_x);
    let face = faces[light * 6u + axis * 2u + select(0u, 1u, turned.x < real(0.0))];
    let place = (turned.yz * (real(1.0) / abs(turned.x)) - face.low) * face.per_unit;
    let cell = vec2<u32>(place);
    if place.x >= real(0.0) && place.y >= real(0.0) && cell.x < face.cells.x && cell.y < face.cells.y {
        let offset = face.first + cell.y * face.cells.x + cell.x;
        return vec2<u32>(lists[offset], lists[offset + 1u]);
    }
    return vec2<u32>();
}

// Whether a sphere, and so all that follow in a light's list, lies too far from the light, at t = 1, to stand before a point at
// this distance from it.
fn is_behind(ray: Ray, sphere: u32, light: u32, distance: real) -> bool {
    let from_light = shapes[sphere].center_radius.xyz - lights[light].position;
    var reach = shapes[sphere].center_radius.w;
    if ELLIPSOIDS {
        let inv_scale = shapes[sphere].inv_scale;
        reach /= min(inv_scale.x, min(inv_scale.y, inv_scale.z));
    }
    reach = reach * REACH + distance;
    return dot(from_light, from_light) > reach * reach;
}

// Whether any sphere stands between the ray's origin and the light with this index, at t = 1.
fn any_hit(ray: Ray, own: Own, light: u32) -> bool {
    let from_light = -direction_of(ray);
    let list = light_list(light, from_light);
    let distance = sqrt(dot(from_light, from_light)) + params.light_slack;
    var blocked = false;
    var at = list.x;
    if at < list.y {
        loop {
            let sphere = lists[at];
            let is_last = is_behind(ray, sphere, light, distance);
            blocked = !is_last && blocks(ray, sphere, own);
            at++;
            if is_last || blocked || at == list.y {
                break;
            }
        }
    }
    return blocked;
}

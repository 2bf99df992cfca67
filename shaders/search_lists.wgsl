// The nearest hit and any hit among those spheres that a ray can meet; read it beside src/accel and src/cpu/intersect.rs.
// needs: body, bound, counters, distance, effects, intersect, kernel, ray, real, tables, types
// host: REACH

// The nearer of a hit and the intersection with one more sphere; of equal ones the lower index.
fn nearer_of(nearest: Hit, ray: Ray, body: Body, sphere: u32, exit: Exit, range: Range) -> Hit {
    note_tested(ray, body, exit, range);
    if COUNT_TESTS {
        other_tests++;
    }
    return nearer_root(nearest, accepted_root(ray, body, exit, range), sphere);
}

fn nearer_root(nearest: Hit, root: Root, sphere: u32) -> Hit {
    let is_tie = !is_nearer(nearest.t, root.t) & (sphere < nearest.sphere);
    return nearer_hit(nearest, Hit(true, root.t, sphere, root.inside), root.counts & (is_nearer(root.t, nearest.t) | is_tie));
}

// Loops below break at the end of their body: compilers for software devices run the body once more, in vain, where the
// condition stands at the beginning, and take a continuing block for the beginning.

// The nearest intersection of a primary ray through the tile of this pixel.
fn nearest_seen(ray: Ray, pixel: vec2<u32>) -> Hit {
    let range = primary_range();
    let tile = pixel >> vec2(params.screen_shift);
    let list = cell_at(tile.y * params.screen_across + tile.x);
    begin_search(ray);
    var nearest = no_hit();
    var at = list.x;
    if at < list.y {
        loop {
            let sphere = entry_at(at);
            let body = body_of(sphere);
            let root = other_root(ray, body, range);
            note_seen(ray, body, range, root, nearest);
            nearest = nearer_root(nearest, root, sphere);
            if COUNT_TESTS {
                other_tests++;
            }
            if TANGENTS & !CERTIFIED {
                is_unsure |= may_touch(ray, body);
            }
            at++;
            if at == list.y {
                break;
            }
        }
    }
    // Not by the condition of the loop, which compilers may take for granted behind it.
    is_cut |= at < list.y;
    end_search(ray, nearest, true);
    return nearest;
}

// The nearer of a hit and the intersections with the spheres that are too large for the cells of the grid.
fn nearest_large(before: Hit, ray: Ray, exit: Exit, range: Range) -> Hit {
    // The last cell has them.
    let cells = params.grid_cells;
    let list = cell_at(params.grid_first + cells.x * cells.y * cells.z);
    var nearest = before;
    var at = list.x;
    if at < list.y {
        // Two in each turn, of which there may not be enough for deep trees; where their number is odd the last one twice, which
        // changes nothing.
        loop {
            let first = entry_at(at);
            nearest = nearer_of(nearest, ray, body_of(first), first, exit, range);
            let second = entry_at(min(at + 1u, list.y - 1u));
            nearest = nearer_of(nearest, ray, body_of(second), second, exit, range);
            at += 2u;
            if at >= list.y {
                break;
            }
        }
    }
    is_cut |= at < list.y;
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
    let face = face_of(light * 6u + axis * 2u + select(0u, 1u, turned.x < real(0.0)));
    let place = (turned.yz * (real(1.0) / abs(turned.x)) - face.low) * face.per_unit;
    let cell = vec2<u32>(place);
    var list = vec2<u32>();
    if place.x >= real(0.0) && place.y >= real(0.0) && cell.x < face.cells.x && cell.y < face.cells.y {
        list = cell_at(face.first + cell.y * face.cells.x + cell.x);
    }
    return list;
}

// Whether a sphere, and so all that follow in a light's list, lies too far from the light, at t = 1, to stand before a point at
// this distance from it.
fn is_behind(body: Body, light: vec3r, distance: real) -> bool {
    let from_light = body.shape.center_radius.xyz - light;
    var reach = body.shape.center_radius.w;
    if ELLIPSOIDS {
        let inv_scale = body.shape.inv_scale;
        reach /= min(inv_scale.x, min(inv_scale.y, inv_scale.z));
    }
    reach = reach * REACH + distance;
    return dot(from_light, from_light) > reach * reach;
}

// Whether any sphere stands between the ray's origin and the light with this index, at t = 1.
fn any_hit(ray: Ray, own: Own, light: Light, index: u32) -> bool {
    let exit = exit_of(own, ray);
    let from_light = -direction_of(ray);
    let list = light_list(index, from_light);
    let distance = sqrt(dot(from_light, from_light)) + params.light_slack;
    let t_min = params.shadow_t_min;
    begin_shadow(ray, own, exit, t_min);
    var blocked = false;
    var is_last = false;
    var at = list.x;
    if at < list.y {
        loop {
            let body = body_of(entry_at(at));
            at++;
            // By what the turns before have found: this one need not wait for its own test, which can but find more of the same.
            let is_over = is_last | blocked | (at == list.y);
            is_last |= is_behind(body, light.position, distance);
            blocked |= blocks(ray, body, exit, t_min);
            note_crossed(ray, body, exit, t_min);
            if COUNT_TESTS {
                shadow_tests++;
            }
            if is_over {
                break;
            }
        }
    }
    is_cut |= !is_last & !blocked & (at < list.y);
    end_shadow();
    return blocked;
}

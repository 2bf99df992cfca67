// The nearest intersection of a ray that leaves a surface, where no sphere is in the grid: among all, which are few.
// needs: body, bound, counters, intersect, ray, search

// Their number, where there are any.
override SPHERE_COUNT: u32;

fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    let exit = exit_of(own, ray);
    begin_secondary(ray, own, exit, range);
    var nearest = no_hit();
    var sphere = 0u;
    // Two in each turn: see nearest_large.
    loop {
        nearest = nearer_of(nearest, ray, body_of(sphere), sphere, exit, range);
        let second = min(sphere + 1u, SPHERE_COUNT - 1u);
        nearest = nearer_of(nearest, ray, body_of(second), second, exit, range);
        sphere += 2u;
        if sphere >= SPHERE_COUNT {
            break;
        }
    }
    is_cut |= sphere < SPHERE_COUNT;
    end_search(ray, nearest, false);
    return nearest;
}

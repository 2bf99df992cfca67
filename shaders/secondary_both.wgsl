// The nearest intersection of a ray that leaves a surface, where some spheres are in the grid and some too large for it.
// needs: bound, grid, intersect, ray, search

// Among those outside the grid.
fn nearest_outside(ray: Ray, exit: Exit, range: Range) -> Hit {
    return nearest_large(no_hit(), ray, exit, range);
}

fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    let exit = exit_of(own, ray);
    begin_secondary(ray, own, exit, range);
    let nearest = nearest_in_grid(nearest_outside(ray, exit, range), ray, exit, range);
    end_search(ray, nearest, false);
    return nearest;
}

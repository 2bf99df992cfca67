// The nearest intersection of a ray that leaves a surface, where all spheres are in the grid.

fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    return nearest_in_grid(no_hit(), ray, own, range);
}

// The nearest intersection of a ray that leaves a surface, where no sphere is in the grid.

fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    return nearest_large(no_hit(), ray, own, range);
}

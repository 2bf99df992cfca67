// The sphere of an entry of the grid's lists: copies lie beside each other, since among many spheres memory is what a
// walk waits for.
// needs: body, real, scene, tables, types

fn body_in_grid(entry: u32, sphere: u32) -> Body {
    let at = entry - params.grid_entries;
    let first = grid_shape_at(at);
    var second = ShapeEnd(vec3r(), sphere);
    if SHAPE_ENDS {
        second = grid_shape_end_at(at);
    }
    return Body(Shape(first, second.inv_scale, second.index));
}

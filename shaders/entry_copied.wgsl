// The sphere of an entry of the grid's lists: copies lie beside each other, since among many spheres memory is what a
// walk waits for.
// needs: body, real, scene, tables, texels, types, vectors

// The first halves of the shapes, and the second, entry by entry.
@group(0) @binding(24) var grid_shapes: Table;
@group(0) @binding(25) var grid_shape_ends: Table;

fn body_in_grid(entry: u32, sphere: u32) -> Body {
    let at = entry - params.grid_entries;
    var shape = Shape(vector_at(grid_shapes, at), vec3r(), sphere);
    if SHAPE_ENDS {
        shape.inv_scale = vector_at(grid_shape_ends, at).xyz;
        shape.index = bits_at(grid_shape_ends, at);
    }
    return Body(shape);
}

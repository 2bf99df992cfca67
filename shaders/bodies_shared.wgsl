// Spheres in the lists of the grid: where all others are.

fn body_in_grid(entry: u32, sphere: u32) -> Body {
    return body_of(sphere);
}

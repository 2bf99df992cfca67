// The sphere of an entry of the grid's lists: where all others are.
// needs: body

fn body_in_grid(entry: u32, sphere: u32) -> Body {
    return body_of(sphere);
}

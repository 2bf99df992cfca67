// By the nearest sample: a Voronoi diagram.
// needs: fill, flood

fn filled(pixel: vec2<i32>) -> u32 {
    return color_of(owners[index(pixel)]);
}

// By the mean of the nearest sample and those that the eight pixels around at its distance have for their nearest, each weighted
// with one over the square of its distance (D. Shepard, "A two-dimensional interpolation function for irregularly-spaced
// data", 1968).
// needs: fill, flood
// host: UNIT_WEIGHT

struct Mean {
    sums: vec3<u32>,
    weights: u32,
}

fn with_sample(mean: Mean, pixel: vec2<i32>, owner: u32) -> Mean {
    let weight = max(UNIT_WEIGHT / distance_squared(pixel, place(owner)), 1u);
    let color = color_of(owner);
    let levels = vec3(color & 0xffu, (color >> 8u) & 0xffu, (color >> 16u) & 0xffu);
    return Mean(mean.sums + levels * weight, mean.weights + weight);
}

fn with_neighbour(mean: Mean, pixel: vec2<i32>, dx: i32, dy: i32, around: i32) -> Mean {
    let last = vec2(flood.width - 1, flood.height - 1);
    let other = clamp(pixel + vec2(dx, dy) * around, vec2<i32>(), last);
    return with_sample(mean, pixel, owners[index(other)]);
}

fn filled(pixel: vec2<i32>) -> u32 {
    let nearest = owners[index(pixel)];
    let way = abs(place(nearest) - pixel);
    if way.x == 0 && way.y == 0 {
        return color_of(nearest);
    }
    let around = max(way.x, way.y) + 1;
    var mean = with_sample(Mean(vec3<u32>(), 0u), pixel, nearest);
    mean = with_neighbour(mean, pixel, -1, -1, around);
    mean = with_neighbour(mean, pixel, 0, -1, around);
    mean = with_neighbour(mean, pixel, 1, -1, around);
    mean = with_neighbour(mean, pixel, -1, 0, around);
    mean = with_neighbour(mean, pixel, 1, 0, around);
    mean = with_neighbour(mean, pixel, -1, 1, around);
    mean = with_neighbour(mean, pixel, 0, 1, around);
    mean = with_neighbour(mean, pixel, 1, 1, around);
    let levels = (mean.sums + mean.weights / 2u) / mean.weights;
    return levels.x | (levels.y << 8u) | (levels.z << 16u);
}

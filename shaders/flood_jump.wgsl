// One jump: each pixel asks those around.

@group(0) @binding(2) var<storage, read_write> next_owners: array<u32>;

// Of a sample and one more, that which is nearer to the pixel; of equally near ones the one farther up, then farther left.
fn nearer(pixel: vec2<i32>, known: u32, other: u32) -> u32 {
    if other == NO_SAMPLE || other == known {
        return known;
    }
    if known == NO_SAMPLE {
        return other;
    }
    let a = distance_squared(pixel, place(known));
    let b = distance_squared(pixel, place(other));
    return select(known, other, b < a || (b == a && other < known));
}

fn asked(pixel: vec2<i32>, known: u32, dx: i32, dy: i32) -> u32 {
    let other = pixel + vec2(dx, dy) * flood.step;
    if other.x >= 0 && other.y >= 0 && other.x < flood.width && other.y < flood.height {
        return nearer(pixel, known, owners[index(other)]);
    }
    return known;
}

@compute @workgroup_size(64)
fn jump(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<i32>(id.xy);
    if pixel.x >= flood.width {
        return;
    }
    var owner = owners[index(pixel)];
    owner = asked(pixel, owner, -1, -1);
    owner = asked(pixel, owner, 0, -1);
    owner = asked(pixel, owner, 1, -1);
    owner = asked(pixel, owner, -1, 0);
    owner = asked(pixel, owner, 1, 0);
    owner = asked(pixel, owner, -1, 1);
    owner = asked(pixel, owner, 0, 1);
    owner = asked(pixel, owner, 1, 1);
    next_owners[index(pixel)] = owner;
}

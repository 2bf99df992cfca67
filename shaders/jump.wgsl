// One jump: each pixel asks those around.
// needs: flood
// host: NO_SAMPLE, SMALL_GROUP

@group(0) @binding(2) var<storage, read_write> next_owners: array<u32>;

struct Nearest {
    owner: u32,
    // Square of its distance.
    least: u32,
}

fn distance_to(pixel: vec2<i32>, owner: u32) -> u32 {
    return select(distance_squared(pixel, place(owner)), 0xffffffffu, owner == NO_SAMPLE);
}

// The nearer of a sample and that of one pixel around; of equally near ones the one farther up, then farther left. Beyond the edge
// the pixel asks itself, which changes nothing; compilers for software devices like that better than a branch.
fn asked(known: Nearest, pixel: vec2<i32>, dx: i32, dy: i32) -> Nearest {
    let other = pixel + vec2(dx, dy) * flood.step;
    let is_inside = other.x >= 0 && other.y >= 0 && other.x < flood.width && other.y < flood.height;
    let owner = owners[select(index(pixel), index(other), is_inside)];
    let away = distance_to(pixel, owner);
    let is_nearer = away < known.least || (away == known.least && owner < known.owner);
    return Nearest(select(known.owner, owner, is_nearer), select(known.least, away, is_nearer));
}

@compute @workgroup_size(SMALL_GROUP)
fn jump(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<i32>(id.xy);
    if pixel.x >= flood.width {
        return;
    }
    let owner = owners[index(pixel)];
    var nearest = Nearest(owner, distance_to(pixel, owner));
    if nearest.least != 0u {
        nearest = asked(nearest, pixel, -1, -1);
        nearest = asked(nearest, pixel, 0, -1);
        nearest = asked(nearest, pixel, 1, -1);
        nearest = asked(nearest, pixel, -1, 0);
        nearest = asked(nearest, pixel, 1, 0);
        nearest = asked(nearest, pixel, -1, 1);
        nearest = asked(nearest, pixel, 0, 1);
        nearest = asked(nearest, pixel, 1, 1);
    }
    next_owners[index(pixel)] = nearest.owner;
}

// The nearest sample of each pixel by jump flooding; read it beside src/cpu/fill.rs. All numbers are integers, so that device
// and reference give the same bytes.

struct Flood {
    width: i32,
    height: i32,
    // How far a jump looks, in pixels.
    step: i32,
}

@group(0) @binding(0) var<uniform> flood: Flood;
// The nearest sample of each pixel so far: its row in the upper half, its column in the lower one.
@group(0) @binding(1) var<storage, read> owners: array<u32>;

fn place(packed: u32) -> vec2<i32> {
    return vec2(i32(packed & 0xffffu), i32(packed >> 16u));
}

// Square of the distance of two pixels.
fn distance_squared(a: vec2<i32>, b: vec2<i32>) -> u32 {
    let d = a - b;
    return u32(d.x * d.x) + u32(d.y * d.y);
}

fn index(pixel: vec2<i32>) -> i32 {
    return pixel.y * flood.width + pixel.x;
}

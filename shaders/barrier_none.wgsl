// In place of barrier_bits.wgsl: nothing keeps a compiler from rewriting error-free transforms. A study of what goes wrong then;
// no picture is made with it.

fn barrier(x: f32) -> f32 {
    return x;
}

fn barrier3(x: vec3<f32>) -> vec3<f32> {
    return x;
}

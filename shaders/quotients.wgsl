// Quotients and square roots of given numbers, for the host to measure how far they are off.
// needs: real
// host: SMALL_GROUP

// A dividend and a divisor, both positive.
@group(0) @binding(20) var<storage, read> operands: array<vec2<real>>;
// Their quotient, and the square root of the dividend.
@group(0) @binding(21) var<storage, read_write> results: array<vec2<real>>;

@compute @workgroup_size(SMALL_GROUP)
fn divide_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = operands[id.x];
    results[id.x] = vec2<real>(pair.x / pair.y, sqrt(pair.x));
}

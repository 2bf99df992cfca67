// Error-free transforms of given pairs, for the host to check bit for bit.
// needs: eft, types
// host: SMALL_GROUP

// Two operands each.
@group(0) @binding(20) var<storage, read> operands: array<vec2<f32>>;
// Bits of the sum, its error, the product and its error.
@group(0) @binding(21) var<storage, read_write> results: array<u32>;

@compute @workgroup_size(SMALL_GROUP)
fn transform_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let pair = operands[id.x];
    let sum = two_sum(pair.x, pair.y);
    let product = two_product(pair.x, pair.y);
    results[id.x * 4u] = bitcast<u32>(sum.hi);
    results[id.x * 4u + 1u] = bitcast<u32>(sum.lo);
    results[id.x * 4u + 2u] = bitcast<u32>(product.hi);
    results[id.x * 4u + 3u] = bitcast<u32>(product.lo);
}

// What no compiler sees through: numbers keep the bits that the operation before gave them.
// needs: types

// x, through bits that no compiler knows.
fn barrier(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ params.zero);
}

fn barrier3(x: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(x) ^ vec3<u32>(params.zero));
}

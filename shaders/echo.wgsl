// Every field that the host packs, read on the device and written back for the host to compare: the third lock on the layout.

@group(0) @binding(21) var<storage, read_write> results: array<u32>;

var<private> next: u32;

fn echo(x: real) {
    results[next] = bitcast<u32>(f32(x));
    next++;
}

fn echo3(v: vec3r) {
    echo(v.x);
    echo(v.y);
    echo(v.z);
}

fn echo_bits(x: u32) {
    results[next] = x;
    next++;
}

@compute @workgroup_size(1)
fn echo_layout() {
    echo3(params.background);
    echo(params.near);
    echo3(params.ambient);
    echo(params.primary_t_min);
    echo(params.shadow_t_min);
    echo(params.reflection_t_min);
    echo(params.quantize_bias);
    echo(params.near_low);
    echo(params.light_slack);
    echo3(vec3r(params.grid_low));
    echo_bits(params.screen_shift);
    echo3(vec3r(params.grid_per_unit));
    echo_bits(params.screen_across);
    for (var axis = 0u; axis < 3u; axis++) {
        echo_bits(params.grid_cells[axis]);
    }
    echo_bits(params.grid_offsets);
    echo_bits(params.sphere_count);
    echo_bits(params.light_count);
    echo_bits(params.max_depth);
    echo_bits(params.zero);
    echo_bits(params.first_row);
    for (var i = 0u; i < params.sphere_count; i++) {
        echo3(shapes[i].center_radius.xyz);
        echo(shapes[i].center_radius.w);
        echo3(shapes[i].inv_scale);
        echo_bits(shapes[i].index);
        echo3(materials[i].color);
        echo(materials[i].ka);
        echo3(materials[i].scale);
        echo(materials[i].kd);
        echo(materials[i].ks);
        echo(materials[i].kr);
        echo(materials[i].n);
    }
    for (var i = 0u; i < params.light_count; i++) {
        echo3(lights[i].position);
        echo3(lights[i].intensity);
    }
    echo(window[params.sphere_count]);
    echo(window[params.first_row + params.sphere_count]);
}

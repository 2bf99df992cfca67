// Every field that the host packs, read on the device and written back for the host to compare: the third lock on the layout.
// needs: real, scene, tables, types

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
    params = given_params;
    echo3(params.background);
    echo(params.primary_t_min);
    echo3(params.ambient);
    echo(params.shadow_t_min);
    echo(params.reflection_t_min);
    echo(params.quantize_bias);
    echo(params.light_slack);
    echo_bits(params.window_rows);
    echo3(vec3r(params.grid_low));
    echo_bits(params.screen_shift);
    echo3(vec3r(params.grid_per_unit));
    echo_bits(params.screen_across);
    for (var axis = 0u; axis < 3u; axis++) {
        echo_bits(params.grid_cells[axis]);
    }
    echo_bits(params.grid_first);
    echo_bits(params.window_low);
    echo_bits(params.light_count);
    echo_bits(params.max_depth);
    echo_bits(params.zero);
    echo_bits(params.grid_entries);
    echo(real(params.tangent_margin));
    echo(params.quantize_scale);
    echo(params.direction_error);
    echo3(params.middle);
    echo(params.extent);
    echo(params.allowance);
    echo(params.light_allowance);
    echo(params.background_levels);
    echo(params.moved);
    echo(params.position_error);
    for (var i = 0u; i < 2u; i++) {
        echo3(shape_of(i).center_radius.xyz);
        echo(shape_of(i).center_radius.w);
        echo3(shape_of(i).inv_scale);
        echo_bits(shape_of(i).index);
        echo3(material_of(i).color);
        echo(material_of(i).ka);
        echo(material_of(i).kd);
        echo(material_of(i).ks);
        echo(material_of(i).kr);
        echo(material_of(i).n);
        echo3(material_of(i).scale);
        echo(material_of(i).ambient_levels);
    }
    for (var i = 0u; i < params.light_count; i++) {
        echo3(light_at(i).position);
        echo3(light_at(i).intensity);
    }
    echo3(window_at(2u));
    echo3(window_at(params.window_rows + 2u));
}

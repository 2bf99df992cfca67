// Nothing is said of what rounding may have moved.
// needs: body, effects, intersect, ray, real, shade, types

fn begin_bound() {}

fn begin_search(ray: Ray) {}

fn begin_secondary(ray: Ray, own: Own, exit: Exit, range: Range) {}

fn note_seen(ray: Ray, body: Body, range: Range, root: Root, nearest: Hit) {}

fn note_tested(ray: Ray, body: Body, exit: Exit, range: Range) {}

fn end_search(ray: Ray, hit: Hit, is_primary: bool) {}

fn begin_shadow(ray: Ray, own: Own, exit: Exit, t_min: real) {}

fn note_crossed(ray: Ray, body: Body, exit: Exit, t_min: real) {}

fn end_shadow() {}

fn note_surface(ray: Ray, body: Body, scale: vec3r, local: vec3r, hit: Hit) {}

fn note_ambient(material: Material, is_seen: bool) {}

fn note_background() {}

fn note_light(surface: Surface, at: Incidence, material: Material, is_seen: bool) {}

fn note_lit(surface: Surface, at: Incidence, material: Material, is_lit: bool) {}

fn note_reflected(throughput: real) {}

fn has_sure_levels(color: vec3r) -> bool {
    return !CERTIFIED;
}

fn bound_levels(pixel: u32) -> u32 {
    return pixel;
}

fn kept_bound() -> vec4r {
    return vec4r();
}

fn go_on_with_bound(kept: vec4r, throughput: real) {}

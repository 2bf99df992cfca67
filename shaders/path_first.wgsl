// From the hit of a primary ray no further: a term of it, in place of the colour; src/gpu/render/term.rs says what each is.
// needs: counters, effects, film, intersect, ray, real, distance, search, shade, scene, types
// host: TERM_AMBIENT, TERM_BACKGROUND, TERM_DIFFUSE, TERM_INCIDENCE, TERM_NORMAL, TERM_POSITION, TERM_SPECULAR

// Which term, and the index of its light.
@group(0) @binding(19) var<uniform> asked: vec2<u32>;

// N.L and whether something stands before the light, or what the light adds.
fn term_of_light(surface: Surface, material: Material) -> vec3r {
    let at = incidence_of(asked.y, surface);
    let is_faced = at.n_dot_l > real(0.0);
    var is_blocked = false;
    if SHADOWS {
        is_blocked = is_faced & any_hit(at.ray, surface.own, at.light, asked.y);
    }
    var light = vec3r();
    if DIFFUSE {
        light = select(light, diffuse_light(at, material), asked.x == TERM_DIFFUSE);
    }
    if SPECULAR {
        light = select(light, specular_light(at, surface, material), asked.x == TERM_SPECULAR);
    }
    let incidence = vec3r(at.n_dot_l, select(real(0.0), real(1.0), is_blocked), real(0.0));
    return select(select(vec3r(), light, is_faced & !is_blocked), incidence, asked.x == TERM_INCIDENCE);
}

// No return but the last: what is called has to go into its caller.
fn term_of_hit(ray: Ray, hit: Hit) -> vec3r {
    let material = material_of(hit.sphere);
    let surface = surface_at(ray, hit, material);
    var term = vec3r(nearest_real(hit.t), real(hit.sphere), select(real(0.0), real(1.0), hit.inside));
    if asked.x == TERM_POSITION {
        term = high_of(surface.position);
    }
    if asked.x == TERM_NORMAL {
        term = surface.normal;
    }
    if asked.x == TERM_AMBIENT {
        term = vec3r();
        if AMBIENT {
            term = ambient_light(material);
        }
    }
    // Those of lights are the last.
    if asked.x >= TERM_INCIDENCE {
        term = term_of_light(surface, material);
    }
    return term;
}

fn follow(ray: Ray, hit: Hit, slot: u32) {
    var term = select(vec3r(), params.background, asked.x == TERM_BACKGROUND);
    if hit.found {
        term = vec3r();
        if asked.x != TERM_BACKGROUND {
            term = term_of_hit(ray, hit);
        }
    }
    finish(slot, term);
    add_counts(slot);
}

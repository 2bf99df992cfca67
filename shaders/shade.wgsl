// The exact Phong model at a hit; read it beside src/cpu/shade.rs.
// needs: body, bound, counters, effects, elementary, intersect, kernel, ray, real, scene, search, types

// The lit point of a hit.
struct Surface {
    position: Point,
    // Unit normal, on the side of the viewer.
    normal: vec3r,
    // Unit vector towards where the ray came from.
    view: vec3r,
    own: Own,
    sphere: u32,
}

fn unit(v: vec3r) -> vec3r {
    return v * (real(1.0) / sqrt(dot(v, v)));
}

fn surface_at(ray: Ray, hit: Hit, material: Material) -> Surface {
    let body = body_of(hit.sphere);
    let local = local_hit(ray, body, hit);
    var normal = high_of(local);
    if ELLIPSOIDS {
        normal *= body.shape.inv_scale;
    }
    normal = unit(normal);
    normal = select(normal, -normal, hit.inside);
    let own = Own(body.shape.index, hit.inside, high_of(local));
    note_surface(ray, body, material.scale, high_of(local), hit);
    return Surface(place_of(body, material.scale, local), normal, -unit(direction_of(ray)), own, hit.sphere);
}

// cos^n from d = 1 - cos: exp(n log1p(-d)) keeps what a power of the rounded cosine loses near 1.
fn specular_power(d: real, n: real) -> real {
    return select(select(real(0.0), exponential(n * log1m(d)), d < real(1.0)), real(1.0), n <= real(0.0));
}

// 1 - cos of the angle whose cosine the specular term is a power of.
fn specular_distance(surface: Surface, to_light: vec3r, n_dot_l: real) -> real {
    // 1 - cos of the angle between two unit vectors is half the square of their difference.
    var difference: vec3r;
    if BLINN {
        difference = unit(to_light + surface.view) - surface.normal;
    } else {
        difference = surface.normal * (n_dot_l + n_dot_l) - to_light - surface.view;
    }
    return real(0.5) * dot(difference, difference);
}

fn specular_term(surface: Surface, material: Material, to_light: vec3r, n_dot_l: real) -> real {
    return material.ks * specular_power(specular_distance(surface, to_light, n_dot_l), material.n);
}

// A light as a surface has it.
struct Incidence {
    light: Light,
    // To the light, for the shadow.
    ray: Ray,
    // One over its length.
    inv_distance: real,
    // Unit vector.
    to_light: vec3r,
    n_dot_l: real,
}

fn incidence_of(index: u32, surface: Surface) -> Incidence {
    let light = light_of(index);
    let ray = ray_to_light(surface.position, light, index);
    let inv_distance = real(1.0) / sqrt(ray.a);
    let to_light = direction_of(ray) * inv_distance;
    return Incidence(light, ray, inv_distance, to_light, dot(surface.normal, to_light));
}

fn ambient_light(material: Material) -> vec3r {
    return params.ambient * material.color * material.ka;
}

// Of a light that reaches the surface, which faces it.
fn diffuse_light(at: Incidence, material: Material) -> vec3r {
    return at.light.intensity * material.color * (material.kd * at.n_dot_l);
}

fn specular_light(at: Incidence, surface: Surface, material: Material) -> vec3r {
    return at.light.intensity * specular_term(surface, material, at.to_light, at.n_dot_l);
}

// A colour and, where it reaches the surface, the light with this index, which the surface faces.
fn with_light(color: vec3r, index: u32, surface: Surface, material: Material) -> vec3r {
    let at = incidence_of(index, surface);
    var lit = color;
    if DIFFUSE {
        lit += diffuse_light(at, material);
    }
    if SPECULAR {
        lit += specular_light(at, surface, material);
    }
    // After what does not depend on it, unlike src/cpu/shade.rs: processors calculate both at once.
    var is_lit = true;
    if SHADOWS {
        if COUNT_RAYS {
            shadow_rays++;
        }
        is_lit = !any_hit(at.ray, surface.own, at.light, index);
    }
    note_lit(surface, at, material, is_lit);
    return select(color, lit, is_lit);
}

// Lights that are asked for together, a bit each.
const LIGHTS_TOGETHER: u32 = 32u;

// Which of the lights from `first` on the surface faces.
fn faced_lights(first: u32, surface: Surface, material: Material, is_seen: bool) -> u32 {
    let count = min(light_count() - first, LIGHTS_TOGETHER);
    var faced = 0u;
    var bit = 0u;
    loop {
        let at = incidence_of(first + bit, surface);
        note_light(surface, at, material, is_seen);
        // Not lit from behind, and not by a light at distance 0, where N.L is NaN.
        faced |= select(0u, 1u << bit, is_seen & (at.n_dot_l > real(0.0)));
        bit++;
        if bit >= count {
            break;
        }
    }
    return faced;
}

// Colour of a surface point without its reflection; black where nothing is seen.
//
// Lanes go from one light that they face to the next, unlike src/cpu/shade.rs: a light from behind costs its N.L alone.
fn local_color(surface: Surface, material: Material, is_seen: bool) -> vec3r {
    note_ambient(material, is_seen);
    var color = vec3r();
    if AMBIENT {
        color = ambient_light(material);
    }
    if DIFFUSE || SPECULAR {
        var first = 0u;
        if first < light_count() {
            loop {
                var faced = faced_lights(first, surface, material, is_seen);
                if faced != 0u {
                    loop {
                        color = with_light(color, first + firstTrailingBit(faced), surface, material);
                        faced &= faced - 1u;
                        if faced == 0u {
                            break;
                        }
                    }
                }
                first += LIGHTS_TOGETHER;
                if light_count() <= LIGHTS_TOGETHER || first >= light_count() {
                    break;
                }
            }
            // Not by the condition of the loop, which compilers may take for granted behind it.
            is_cut |= first < light_count();
        }
    }
    return color;
}

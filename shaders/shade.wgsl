// The exact Phong model at a hit; read it beside src/cpu/shade.rs.

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

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let local = local_hit(ray, hit);
    var normal = local;
    if ELLIPSOIDS {
        normal *= shapes[hit.sphere].inv_scale;
    }
    normal = unit(normal);
    if hit.inside {
        normal = -normal;
    }
    let own = Own(shapes[hit.sphere].index, hit.inside, local);
    return Surface(place_of(hit.sphere, local), normal, -unit(direction_of(ray)), own, hit.sphere);
}

// cos^n from d = 1 - cos: exp(n log1p(-d)) keeps what a power of the rounded cosine loses near 1.
fn specular_power(d: real, n: real) -> real {
    if n <= real(0.0) {
        return real(1.0);
    }
    if d < real(1.0) {
        return exponential(n * log1m(d));
    }
    return real(0.0);
}

fn specular_term(surface: Surface, material: Material, to_light: vec3r, n_dot_l: real) -> real {
    // 1 - cos of the angle between two unit vectors is half the square of their difference.
    var difference: vec3r;
    if BLINN {
        difference = unit(to_light + surface.view) - surface.normal;
    } else {
        difference = surface.normal * (n_dot_l + n_dot_l) - to_light - surface.view;
    }
    return material.ks * specular_power(real(0.5) * dot(difference, difference), material.n);
}

// Colour of a surface point without its reflection.
fn local_color(surface: Surface) -> vec3r {
    let material = materials[surface.sphere];
    var color = vec3r();
    if AMBIENT {
        color = params.ambient * material.color * material.ka;
    }
    if DIFFUSE || SPECULAR {
        var index = 0u;
        if index == light_count() {
            return color;
        }
        loop {
            let shadow_ray = ray_to_light(surface.position, index);
            let to_light = direction_of(shadow_ray) * (real(1.0) / sqrt(shadow_ray.a));
            let n_dot_l = dot(surface.normal, to_light);
            // Not lit from behind, and not by a light at distance 0, where N.L is NaN.
            var is_lit = n_dot_l > real(0.0);
            if SHADOWS && is_lit {
                if COUNT_RAYS {
                    shadow_rays++;
                }
                is_lit = !any_hit(shadow_ray, surface.own, index);
            }
            if is_lit {
                if DIFFUSE {
                    color += lights[index].intensity * material.color * (material.kd * n_dot_l);
                }
                if SPECULAR {
                    color += lights[index].intensity * specular_term(surface, material, to_light, n_dot_l);
                }
            }
            index++;
            if index == light_count() {
                break;
            }
        }
    }
    return color;
}

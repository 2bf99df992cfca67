// The exact Phong model at a hit; read it beside src/cpu/shade.rs.

// The lit point of a hit.
struct Surface {
    position: vec3r,
    // Unit normal, on the side of the viewer.
    normal: vec3r,
    // Unit vector towards where the ray came from.
    view: vec3r,
    own: Own,
    sphere: u32,
}

fn unit(v: vec3r) -> vec3r {
    return v * (1.0 / sqrt(dot(v, v)));
}

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let shape = shapes[hit.sphere];
    // From the closest approach, half a chord back or forth: S' + t c' would lose what distance costs.
    let at = approach(ray, shape);
    let half_chord = at.direction * sqrt(max(at.discriminant, 0.0) / at.a);
    var local: vec3r;
    if hit.inside {
        local = at.perpendicular + half_chord;
    } else {
        local = at.perpendicular - half_chord;
    }
    var position = shape.center;
    var normal = local;
    if ELLIPSOIDS {
        position += local * materials[hit.sphere].scale;
        normal *= shape.inv_scale;
    } else {
        position += local;
    }
    normal = unit(normal);
    if hit.inside {
        normal = -normal;
    }
    return Surface(position, normal, -unit(ray.direction), Own(shape.index, hit.inside, local), hit.sphere);
}

// cos^n from d = 1 - cos: exp(n log1p(-d)) keeps what a power of the rounded cosine loses near 1.
fn specular_power(d: real, n: real) -> real {
    if n <= 0.0 {
        return 1.0;
    }
    if d < 1.0 {
        return exp(n * log1m(d));
    }
    return 0.0;
}

fn specular_term(surface: Surface, material: Material, to_light: vec3r, n_dot_l: real) -> real {
    // 1 - cos of the angle between two unit vectors is half the square of their difference.
    var difference: vec3r;
    if BLINN {
        difference = unit(to_light + surface.view) - surface.normal;
    } else {
        difference = surface.normal * (n_dot_l + n_dot_l) - to_light - surface.view;
    }
    return material.ks * specular_power(0.5 * dot(difference, difference), material.n);
}

// Colour of a surface point without its reflection.
fn local_color(surface: Surface) -> vec3r {
    let material = materials[surface.sphere];
    var color = vec3r();
    if AMBIENT {
        color = params.ambient * material.color * material.ka;
    }
    if DIFFUSE || SPECULAR {
        for (var index = 0u; index < light_count(); index++) {
            let light = lights[index];
            let shadow_ray = ray_from(surface.position, light.position - surface.position);
            let to_light = shadow_ray.direction * (1.0 / sqrt(shadow_ray.a));
            let n_dot_l = dot(surface.normal, to_light);
            // Not lit from behind, and not by a light at distance 0, where N.L is NaN.
            if !(n_dot_l > 0.0) {
                continue;
            }
            if SHADOWS {
                if COUNT_RAYS {
                    shadow_rays++;
                }
                if any_hit(shadow_ray, surface.own) {
                    continue;
                }
            }
            if DIFFUSE {
                color += light.intensity * material.color * (material.kd * n_dot_l);
            }
            if SPECULAR {
                color += light.intensity * specular_term(surface, material, to_light, n_dot_l);
            }
        }
    }
    return color;
}

// Spheres as kernels without low parts read them.
// needs: effects, ray, real, scene, types

struct Body {
    shape: Shape,
}

fn body_of(sphere: u32) -> Body {
    return Body(shape_of(sphere));
}

// The place of a point of the sphere's surface, given in object space.
fn place_of(body: Body, scale: vec3r, local: vec3r) -> Point {
    if ELLIPSOIDS {
        return body.shape.center_radius.xyz + local * scale;
    }
    return body.shape.center_radius.xyz + local;
}

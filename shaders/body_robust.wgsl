// Spheres with what rounding took from their numbers.
// needs: effects, eft, ray, real, scene, types

struct Body {
    shape: Shape,
    low: Shape,
}

fn body_of(sphere: u32) -> Body {
    return Body(shape_of(sphere), low_shape_of(sphere));
}

// The place of a point of the sphere's surface, given in object space.
fn place_of(body: Body, scale: vec3r, local: Point) -> Point {
    var offset = local;
    if ELLIPSOIDS {
        // Divided by inv_scale: `scale` does not carry what rounding took from it.
        let high = local.hi * scale;
        let product = two_product3(high, body.shape.inv_scale);
        let rest = ((local.hi - product.hi) - product.lo) + (local.lo - high * body.low.inv_scale);
        offset = fast_two_sum3(high, rest * scale);
    }
    return pair_sum3(Pair3(body.shape.center_radius.xyz, body.low.center_radius.xyz), offset);
}

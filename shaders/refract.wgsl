// Snell's law; read it beside src/cpu/refract.rs.
// needs: distance, intersect, ray, real, reflect, shade

// What only refraction reads of a sphere.
struct Glass {
    kt: real,
    // Index of refraction of the inside relative to the outside, and one over it.
    eta: real,
    inv_eta: real,
}

@group(0) @binding(5) var<storage, read> glasses: array<Glass>;

// How a surface bends the view ray, whose direction need not be normalised.
//
// With d the unit direction of the ray, n the normal on its side, c = -d.n, and r the index of refraction where the ray comes
// from over that where it goes, the refracted unit direction is r d + (r c - sqrt(k)) n with k = (r c)^2 - (r^2 - 1), the square
// of the refracted ray's cosine. r c - sqrt(k) is a difference of nearly equal numbers where r is near 1; it is
// (r^2 - 1)/(r c + sqrt(k)), and so 0 for r = 1, which leaves the direction as it is, to the last bit.
struct Snell {
    // r.
    ratio: real,
    // k; not above 0 where all light is reflected.
    square: real,
    // r c - sqrt(k): how much of the normal is added.
    bend: real,
}

// At the surface: entering where it is seen from outside, leaving where it is seen from inside.
fn snell_at(surface: Surface) -> Snell {
    let glass = glasses[surface.sphere];
    let ratio = select(glass.inv_eta, glass.eta, surface.own.inside);
    let cosine = max(dot(surface.normal, surface.view), real(0.0));
    let along = ratio * cosine;
    let excess = (ratio - real(1.0)) * (ratio + real(1.0));
    let square = along * along - excess;
    return Snell(ratio, square, excess / (along + sqrt(square)));
}

// A refraction ray and the wall that it leaves.
struct Refracted {
    ray: Ray,
    own: Own,
}

// The refracted ray, of the length of the one that meets the surface, or on total internal reflection the mirrored one, of
// unit length; with the wall that it leaves.
fn refraction_ray(ray: Ray, surface: Surface) -> Refracted {
    let snell = snell_at(surface);
    var refracted = Refracted(reflection_ray(surface), surface.own);
    // Ordered comparison: indices beyond the range of the scalar refract nothing.
    if snell.square > real(0.0) {
        let offset = surface.normal * (snell.bend * sqrt(ray.a));
        let own = Own(surface.own.shape, !surface.own.inside, surface.own.local);
        refracted = Refracted(bent_ray(ray, surface.position, snell.ratio, offset), own);
    }
    return refracted;
}

// Own spheres of refraction rays are met by their analytic other root in either convention.
fn refraction_range() -> Range {
    return Range(real(0.0), distance_of(FAR), true);
}

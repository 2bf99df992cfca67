// Spheres of any number in storage buffers.

@group(0) @binding(1) var<storage, read> shapes: array<Shape>;
// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<Shape>;

fn light_count() -> u32 {
    return params.light_count;
}

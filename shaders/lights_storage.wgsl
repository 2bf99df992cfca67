// Lights of any number, in storage buffers.

@group(0) @binding(3) var<storage, read> lights: array<Light>;
// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(10) var<storage, read> lights_low: array<Light>;

fn light_count() -> u32 {
    return arrayLength(&lights);
}

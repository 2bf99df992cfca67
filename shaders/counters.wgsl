// What is noted of a sample while it is calculated.
// needs: effects

// Samples of this dispatch, tile by tile, pixel by pixel, have a slot each.
// With COUNT_RAYS, the shadow rays and the reflection rays of each slot; with COUNT_TESTS, the tests of shadow rays and those of all
// others. No sample lives to have 2^32 of them.
@group(0) @binding(8) var<storage, read_write> ray_counts: array<vec2<u32>>;

// Whether the device has ended a loop before its time: some do after 65,535 turns, without a word.
var<private> is_cut: bool;

// Whether rounding could decide what the sample shows: with TANGENTS whether its primary ray touches a sphere, with CERTIFIED
// anything.
var<private> is_unsure: bool;

var<private> shadow_rays: u32;
var<private> reflection_rays: u32;
var<private> shadow_tests: u32;
var<private> other_tests: u32;

// Before anything is calculated for a slot.
fn begin(slot: u32) {
    is_cut = false;
    is_unsure = false;
    shadow_rays = 0u;
    reflection_rays = 0u;
    if COUNT_RAYS {
        ray_counts[slot] = vec2<u32>();
    }
    if COUNT_TESTS {
        shadow_tests = 0u;
        other_tests = 0u;
        ray_counts[slot] = vec2<u32>();
    }
}

fn add_counts(slot: u32) {
    if COUNT_RAYS {
        ray_counts[slot] += vec2<u32>(shadow_rays, reflection_rays);
    }
    if COUNT_TESTS {
        ray_counts[slot] += vec2<u32>(shadow_tests, other_tests);
    }
}

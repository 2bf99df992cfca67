// Where the result of a sample goes.

// Samples of this dispatch, tile by tile, pixel by pixel, have a slot each.
// With COUNT_RAYS, the shadow rays (low half) and reflection rays (high half) of each slot.
@group(0) @binding(8) var<storage, read_write> ray_counts: array<u32>;

// Whether the device has ended a loop before its time: some do after 65,535 turns, without a word.
var<private> is_cut: bool;

var<private> shadow_rays: u32;
var<private> reflection_rays: u32;

// Before anything is calculated for a slot.
fn begin(slot: u32) {
    is_cut = false;
    shadow_rays = 0u;
    reflection_rays = 0u;
    if COUNT_RAYS {
        ray_counts[slot] = 0u;
    }
}

fn add_counts(slot: u32) {
    if COUNT_RAYS {
        let before = ray_counts[slot];
        let shadow = min(shadow_rays + (before & 0xffffu), 0xffffu);
        let reflection = min(reflection_rays + (before >> 16u), 0xffffu);
        ray_counts[slot] = shadow | (reflection << 16u);
    }
}

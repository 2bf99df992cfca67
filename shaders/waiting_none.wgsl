// Nothing is kept of what rounding may have moved.
// needs: real, shade

fn keep_cone(index: u32, surface: Surface, weight: real) {}

fn go_on_with_cone(index: u32) {}

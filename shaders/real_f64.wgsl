// The scalar of the kernel: f64.

alias real = f64;
alias vec2r = vec2<f64>;
alias vec3r = vec3<f64>;
alias vec4r = vec4<f64>;

// Greater roots, infinity and NaN are never a hit.
const FAR: real = 3e38lf;

fn is_finite(x: real) -> bool {
    // An ordered comparison, which NaN fails.
    return abs(x) <= 1e308lf;
}

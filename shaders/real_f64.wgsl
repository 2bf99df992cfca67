// The scalar of the kernel: f64.

alias real = f64;
alias vec2r = vec2<f64>;
alias vec3r = vec3<f64>;
alias vec4r = vec4<f64>;

// Greater roots, infinity and NaN are never a hit.
const FAR: real = 3e38lf;

// Mirrors and glass with a coefficient beyond 1 or -1 amplify no further than this or its negative, or products would overflow;
// where nothing is negative, whatever is lit at all is white long before.
const MAX_THROUGHPUT: real = 1e280lf;

fn is_finite(x: real) -> bool {
    // An ordered comparison, which NaN fails.
    return abs(x) <= 1e308lf;
}

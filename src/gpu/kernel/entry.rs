//! The entry points of the kernels of a picture.

/// The entry point that casts the primary rays of tiles.
pub const TRACE_TILES: &str = "trace_tiles";
/// The entry point that casts the primary rays of a list of pixels.
pub const TRACE_SAMPLES: &str = "trace_samples";
/// The entry point that casts the reflection rays of paths.
pub const WALK_PATHS: &str = "walk_paths";
/// The entry point that shades what they have met, where several share an invocation.
pub const SHADE_PATHS: &str = "shade_paths";
/// The entry point that goes before each bounce of paths.
pub(super) const BEGIN_BOUNCE: &str = "begin_bounce";
/// The entry point that makes pixels of samples.
pub(super) const RESOLVE: &str = "resolve";

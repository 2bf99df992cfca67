//! The numbers that the host and the shaders share: each is written once, here or where the rest of the host has it, and declared to
//! the shaders whose heads ask for it.

use crate::accel::{MAX_LARGE, REACH, WALK_SLACK};
use crate::brightness::Scalar;
use crate::roundings::{
    ANGLE, AXES, LENGTH, LOCAL, LOST, NEAR, NOTHING, PLACE, PLACE_CARRIED, POWER, ROOT, ROOT_AT_EDGE, SQUARE, TERM,
};
use crate::sampling::{NO_SAMPLE, UNIT_WEIGHT};
use crate::tiles::TILE;

/// Pixels of a tile, and so invocations of a workgroup of the kernels over tiles.
pub(super) const TILE_PIXELS: u32 = TILE * TILE;
/// Bytes of a uniform that most devices bind, and that all do.
pub(super) const UNIFORM: u64 = 1 << 16;
pub(super) const LEAST_UNIFORM: u64 = 1 << 14;
/// Storage buffers that kernels read and write beside the tables of a scene, at the most.
pub const LEAST_BUFFERS: u32 = 4;

/// Tiles of a dispatch at the most on a device that binds so many bytes of a uniform: with their head, four words, they fill one.
pub(super) const fn dispatch_tiles(uniform: u64) -> u32 {
    let size = if uniform < UNIFORM { uniform } else { UNIFORM };
    (size / 16 - 1) as u32 * 4
}
/// Invocations of a workgroup of the kernels that are neither over tiles nor tuned.
pub(super) const SMALL_GROUP: u32 = 64;
/// The binary logarithm of the texels in a row of a texture that stands for a buffer.
pub(super) const ROW_BITS: u32 = 12;

/// Words of the counts of workgroups of a bounce, and where those of the kernel with one path an invocation and of the one with
/// several begin.
pub(super) const WORKGROUP_WORDS: u32 = 6;
pub(super) const ONE_PATH: u32 = 0;
pub(super) const SEVERAL_PATHS: u32 = 3;

/// The bits of a pixel's status byte: it is not finite; a loop has ended before its time; rounding could decide what it shows. Those
/// above are the number of the dispatch: whatever a dispatch has not written shows another one.
pub(super) const STATUS_NOT_FINITE: u8 = 1;
pub(super) const STATUS_CUT: u8 = 2;
pub(super) const STATUS_UNSURE: u8 = 4;
/// All of them.
pub(super) const STATUS_FLAGS: u8 = 7;

/// Above a status byte, in the number that a sample's colour is kept with: its primary ray hits something.
pub(super) const STATUS_HIT: u32 = 256;

/// Which term of what a primary ray hits stands in place of the colour; those of lights are the last.
pub(super) const TERM_HIT: u32 = 0;
pub(super) const TERM_POSITION: u32 = 1;
pub(super) const TERM_NORMAL: u32 = 2;
pub(super) const TERM_BACKGROUND: u32 = 3;
pub(super) const TERM_AMBIENT: u32 = 4;
pub(super) const TERM_INCIDENCE: u32 = 5;
pub(super) const TERM_DIFFUSE: u32 = 6;
pub(super) const TERM_SPECULAR: u32 = 7;

/// What an answer to a ray of a batch says, bit by bit.
pub(super) const PROBE_FOUND: u32 = 1;
pub(super) const PROBE_INSIDE: u32 = 2;
pub(super) const PROBE_FINITE: u32 = 4;
pub(super) const PROBE_FACING: u32 = 8;
pub(super) const PROBE_BLOCKED: u32 = 16;
/// Numbers of an answer with the point of the hit.
pub(super) const POINT_VALUES: u32 = 13;

/// What the shaders declare one of these numbers with, for a kernel of this scalar.
pub(super) fn declaration(name: &str, scalar: Scalar) -> Option<String> {
    let real = |value: f64| format!("real = real({value:?})");
    macro_rules! by_name {
        (whole: $($whole:ident)*; real: $($real:ident)*) => {
            match name {
                $(stringify!($whole) => format!("u32 = {}u", $whole),)*
                $(stringify!($real) => real($real),)*
                "ROUNDOFF" => real(scalar.unit()),
                "OTHERS" => real(Scalar::Double.unit() / scalar.unit()),
                // The kernels of f32 have difference_f32.wgsl.
                "PLACE" => real(match scalar {
                    Scalar::Single => PLACE_CARRIED,
                    // And the decimals are rounded.
                    Scalar::Double => PLACE + 1.0,
                }),
                "MAX_THROUGHPUT" => real(scalar.max_throughput()),
                _ => return None,
            }
        };
    }
    Some(by_name!(
        whole: TILE TILE_PIXELS SMALL_GROUP ROW_BITS WORKGROUP_WORDS ONE_PATH SEVERAL_PATHS STATUS_NOT_FINITE STATUS_CUT
            STATUS_UNSURE STATUS_FLAGS STATUS_HIT TERM_HIT TERM_POSITION TERM_NORMAL TERM_BACKGROUND TERM_AMBIENT TERM_INCIDENCE
            TERM_DIFFUSE TERM_SPECULAR PROBE_FOUND PROBE_INSIDE PROBE_FINITE PROBE_FACING PROBE_BLOCKED POINT_VALUES MAX_LARGE
            NO_SAMPLE UNIT_WEIGHT;
        real: REACH WALK_SLACK ANGLE AXES LENGTH LOCAL LOST NEAR NOTHING POWER ROOT ROOT_AT_EDGE SQUARE TERM
    ))
}

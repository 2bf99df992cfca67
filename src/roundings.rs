//! How many roundings add up in what a renderer calculates, as `shaders/bound_cone.wgsl` and `src/cpu/bound.rs` count them: in units of
//! the unit roundoff u, half a unit in the last place, which each operation and each input that is rounded adds.
//!
//! A quotient and a square root count for what Vulkan allows them, 2.5 units in the last place, where they do more than change the
//! length of a vector or move a place along its ray, which is bounded by what is seen of it.
//!
//! Each has a reserve of a fourth and more, for what is of higher order and for the rounding of the bound itself.

use std::collections::BTreeMap;

/// What a quotient and a square root may be off, in units in the last place. A device that is worse is refused: see
/// `src/gpu/run/quotients.rs`.
pub(crate) const QUOTIENT_UNITS: f64 = 2.5;
/// Of a place on its way into object space, to the side of the ray, as a part of its distance: the centre as an input, a difference, and
/// on the way to the closest approach a product and a sum.
pub(crate) const PLACE: f64 = 4.5;
/// The same where differences carry what rounding takes and the product is of parts that are exact: the centre alone.
pub(crate) const PLACE_CARRIED: f64 = 1.25;
/// The same as a part of the radius, with what carries no more.
pub(crate) const LOCAL: f64 = 4.0;
/// Beside these of an ellipsoid: its axes as inputs, and a product, for a place and for a direction.
pub(crate) const AXES: f64 = 4.5;
/// Of the place of the closest approach along the ray, where it is not measured: a scalar product, quotients and products.
pub(crate) const ALONG: f64 = 14.0;
/// Of a squared radius less a squared distance near it, as a part of twice the radius squared: an input counts twice, then two products,
/// sums of three, a difference.
pub(crate) const SQUARE: f64 = 5.0;
/// Of a root beyond what moves the place: products, sums and a quotient.
pub(crate) const ROOT: f64 = 24.0;
/// Of what turns a unit vector: a product for each component, and the difference or sum before it.
pub(crate) const ANGLE: f64 = 4.0;
/// Of a unit vector's length: half a sum of three products, a root, a quotient and a product; likewise of half a chord's.
pub(crate) const LENGTH: f64 = 13.0;
/// Of a term of the colour: four inputs and products of them, and those of the weight of its ray.
pub(crate) const TERM: f64 = 12.0;
/// Of eˣ and ln(1 − d), once for each unit of the exponent.
pub(crate) const POWER: f64 = 16.0;

/// A root is good to so many square roots of the discriminant's error, where that error leaves it in no doubt that the sphere is met.
pub(crate) const ROOT_AT_EDGE: f64 = 1.1;
/// A squared distance this near to a squared radius, in errors of the discriminant, leaves in doubt on which side the place is: within
/// less, half of a chord at the edge has room.
pub(crate) const NEAR: f64 = 20.0;
/// A power below e to this is as good as none.
pub(crate) const NOTHING: f64 = -20.0;
/// What 237 bits leave in doubt is taken for a tie where it lies within so much of one, in object space or as a part of what it is
/// compared with. Errors are about 1e-69, but for what many bounces between curved mirrors make of them.
pub(crate) const TIE: f64 = 1e-60;
/// An angle in doubt by more than this is not followed.
pub(crate) const LOST: f64 = 0.1;

macro_rules! counted {
    ($($name:ident)*) => {
        /// All of these by their names, for who wants to know what a bound counts with.
        pub(crate) fn counted() -> BTreeMap<String, f64> {
            [$((stringify!($name).to_lowercase(), $name)),*].into()
        }
    };
}

counted! { QUOTIENT_UNITS PLACE PLACE_CARRIED LOCAL AXES ALONG SQUARE ROOT ANGLE LENGTH TERM POWER ROOT_AT_EDGE NEAR NOTHING TIE LOST }

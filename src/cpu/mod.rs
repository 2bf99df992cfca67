//! The CPU reference: the specification in `f64`, written to be read beside the shaders.

mod bound;
mod cone;
mod constants;
mod dd;
mod decision;
mod fill;
mod inspect;
mod intersect;
mod judge;
mod margin;
mod octuple;
pub mod oracle;
mod paths;
mod per_sphere;
mod pick;
mod proof;
mod real;
mod refract;
mod render;
mod replay;
mod scene;
mod shade;
mod spread;
mod sums;
mod surfaces;
mod tangent;
mod ties;
mod trace;
mod trace_refraction;
mod vec3;
mod witness;

pub use dd::Dd;
pub use decision::Decision;
pub use fill::{filled, nearest_samples};
pub use inspect::{
    Blocker, HitRecord, Inspector, LightRecord, MOST_RAYS, Margin, PixelRecord, RayKind, RayRecord, SampleRecord,
    ShadowRecord, SnellRecord, TestRecord, Verdict,
};
pub(crate) use intersect::Ray;
pub use judge::{Finding, Judge, Trial};
pub use pick::{PrimaryHit, picked};
pub use real::Real;
pub(crate) use real::Wide;
#[doc(hidden)]
pub use render::Bounded;
pub(crate) use render::Shown;
pub use render::{Reference, Tally};
pub(crate) use vec3::Vec3;

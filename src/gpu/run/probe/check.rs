//! Whether the parts of a batch fit together: the kernels follow its indices unchecked.

use super::{Batch, Question, RawBatch};
use crate::misuse::Misuse;
use crate::settings::Settings;

/// An error with these words unless it holds.
fn require(holds: bool, words: impl Fn() -> String) -> Result<(), Misuse> {
    if holds { Ok(()) } else { Err(Misuse::Batch(words())) }
}

impl Batch {
    /// Whether it can be asked this.
    pub(super) fn check(&self, question: Question) -> Result<(), Misuse> {
        let (rays, surfaces) = (self.rays.len(), self.surfaces.len());
        for (index, ray) in self.rays.iter().enumerate() {
            let (first, end) = (ray.first, ray.end);
            require(first <= end && end as usize <= surfaces, || {
                format!("ray {index} meets surfaces {first} to {end} of {surfaces}")
            })?;
            require(ray.own.is_none_or(|own| (first..end).contains(&own)), || {
                format!("ray {index} leaves surface {:?}, which is none of {first} to {end}", ray.own)
            })?;
        }
        let is_lit = matches!(question, Question::Lit | Question::Highlight { .. });
        let lights = if is_lit { rays } else { 0 };
        require(self.lights.len() == lights || self.lights.len() == rays, || {
            format!("{} lights for {rays} rays", self.lights.len())
        })?;
        let follows = matches!(question, Question::Bounce | Question::Refract);
        require(!follows || self.bounces <= Settings::MAX_DEPTH, || {
            format!("{} bounces, but {} is the greatest depth", self.bounces, Settings::MAX_DEPTH)
        })
    }
}

impl RawBatch {
    /// Whether each ray has its shape.
    pub(super) fn check(&self) -> Result<(), Misuse> {
        let (rays, shapes) = (self.rays.len(), self.shapes.len());
        require(rays == shapes, || format!("{shapes} shapes for {rays} rays"))
    }
}

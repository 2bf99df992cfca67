//! `--certificate` of `trueray render`.

use std::path::Path;

use super::failure::Failure;
use super::files::save_report;
use crate::certificate::{Bits, Certificate, PictureHasher, SceneHash, Subject};
use crate::effects::Effects;
use crate::engine::{Stages, device_name};
use crate::gpu::Gpu;
use crate::linear::Linear;
use crate::precision::Selection;
use crate::scene::Scene;
use crate::settings::{Quantize, Settings};

/// The certificate of a picture that is being rendered, if one is wanted.
pub(super) struct CertificateFile<'a>(Option<Begun<'a>>);

struct Begun<'a> {
    path: &'a Path,
    scene: SceneHash,
    picture: PictureHasher,
    bits: Bits,
    quantize: Quantize,
}

impl<'a> CertificateFile<'a> {
    /// For a picture of `scene`, none of whose rows is there yet.
    pub(super) fn new(path: Option<&'a Path>, scene: &Scene, bits: Option<Bits>, quantize: Quantize) -> Self {
        let begun = |(path, bits): (&'a Path, Bits)| {
            let picture = PictureHasher::new(scene.width, scene.height, bits);
            Begun { path, scene: SceneHash::of(scene), picture, bits, quantize }
        };
        Self(path.zip(bits).map(begun))
    }

    /// Adds rows: 3 bytes a pixel, and their colours where levels have 16 bits.
    pub(super) fn add(&mut self, rgb: &[u8], linear: &[Linear]) {
        let Some(begun) = &mut self.0 else { return };
        match begun.bits {
            Bits::Eight => begun.picture.add(rgb),
            Bits::Sixteen => {
                for pixel in linear {
                    begun.picture.add_deep(begun.quantize.levels16(pixel.color));
                }
            }
        }
    }

    /// Writes it: all rows are there, and `stages` says by what they are right.
    pub(super) fn write(
        self,
        (settings, effects): (&Settings, &Effects),
        gpu: Option<&Gpu>,
        selection: &Selection,
        stages: Option<Stages>,
    ) -> Result<(), Failure> {
        let (Some(Begun { path, scene, picture, .. }), Some(stages)) = (self.0, stages) else { return Ok(()) };
        let subject = Subject::new(scene, settings, effects, picture.finish());
        let kernel = Some(selection.tier).filter(|_| stages.kernel > 0);
        save_report(path, &Certificate::new(subject, device_name(gpu), kernel, stages))
    }
}

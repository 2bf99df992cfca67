//! Layers as pictures for the eye: the scales that `src/cli/README.md` tells.

use super::{Aov, Layer};
use crate::compare::heatmap;
use crate::film::Picture;
use crate::settings::Quantize;

impl Layer {
    /// The layer as a picture. Colours are quantised as those of the picture itself; `expected` is the reference's picture, on which
    /// [`Aov::Error`] is drawn.
    pub fn picture(&self, quantize: Quantize, expected: Option<&Picture>) -> Picture {
        if let (Aov::Error, Some(expected)) = (self.aov, expected)
            && let Some(heat) = self.heat(expected)
        {
            return heat;
        }
        let rgb: Vec<[u8; 3]> = if self.channels() == 3 {
            let triples = self.values.as_chunks::<3>().0;
            let scale = self.triple_scale(quantize);
            triples.iter().map(|triple| scale(triple.map(f64::from))).collect()
        } else {
            let scale = self.scale();
            self.values.iter().map(|&value| scale(f64::from(value))).collect()
        };
        Picture::assemble(self.width, self.height, rgb.into_flattened())
    }

    /// The device's picture beside the reference's, as `compare` draws it.
    fn heat(&self, expected: &Picture) -> Option<Picture> {
        let level = |(&level, &error): (&u8, &f32)| (f32::from(level) + error) as u8;
        let shown = expected.rgb().iter().zip(&self.values).map(level).collect();
        heatmap(expected, &Picture::assemble(self.width, self.height, shown)).ok()
    }

    /// From a number to a colour.
    fn scale(&self) -> Box<dyn Fn(f64) -> [u8; 3]> {
        let finite = || self.values.iter().copied().filter(|value| value.is_finite()).map(f64::from);
        let (least, greatest) = (finite().fold(f64::INFINITY, f64::min), finite().fold(0.0, f64::max));
        match self.aov {
            // Nothing hit is infinitely far away.
            Aov::T => Box::new(move |t| grey(least / t)),
            Aov::Sphere => Box::new(of_index),
            Aov::NDotL => Box::new(|cosine| if cosine < 0.0 { [0, 0, level(-cosine)] } else { grey(cosine) }),
            Aov::Rays | Aov::Tests => Box::new(move |count| grey(count / greatest)),
            // From 1, black, to 10⁻⁸, white.
            Aov::Margin => Box::new(|margin| grey(-margin.log10() / 8.0)),
            Aov::Step => Box::new(|levels| grey(1.0 - 2.0 * levels)),
            _ => Box::new(grey),
        }
    }

    /// From three numbers to a colour.
    fn triple_scale(&self, quantize: Quantize) -> Box<dyn Fn([f64; 3]) -> [u8; 3]> {
        match self.aov {
            Aov::Normal => Box::new(|normal| match normal {
                [0.0, 0.0, 0.0] => [0; 3],
                normal => normal.map(|x| level(0.5 * x + 0.5)),
            }),
            Aov::Position => {
                let [low, high] = self.extent();
                Box::new(move |position| std::array::from_fn(|c| level((position[c] - low[c]) / (high[c] - low[c]))))
            }
            _ => Box::new(move |color| quantize.levels(color.into())),
        }
    }

    /// The least and the greatest of each coordinate.
    fn extent(&self) -> [[f64; 3]; 2] {
        let triples = || self.values.as_chunks::<3>().0.iter().map(|triple| triple.map(f64::from));
        let fold = |start: f64, of: fn(f64, f64) -> f64| {
            triples().fold([start; 3], |known, triple| std::array::from_fn(|c| of(known[c], triple[c])))
        };
        [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// 0..=1 to 0..=255; NaN is 0.
fn level(x: f64) -> u8 {
    (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8
}

fn grey(x: f64) -> [u8; 3] {
    [level(x); 3]
}

/// A colour for each index, neighbours far apart: hues in steps of the golden ratio. Nothing is black.
fn of_index(index: f64) -> [u8; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if index < 0.0 {
        return [0; 3];
    }
    let hue = (index * GOLDEN).fract() * 6.0;
    [0.0, 2.0, 4.0].map(|offset: f64| level(0.25 + 0.75 * (((hue + offset) % 6.0 - 3.0).abs().clamp(1.0, 2.0) - 1.0)))
}

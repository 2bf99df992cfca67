//! Scenes back to text.

use std::fmt;

use super::model::{Light, Scene, Sphere, Window};

/// The scene file: every number has as many digits as it takes to read it back unchanged.
impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Window { near, left, right, bottom, top } = self.window;
        writeln!(f, "NEAR {near:?}\nLEFT {left:?}\nRIGHT {right:?}\nBOTTOM {bottom:?}\nTOP {top:?}")?;
        writeln!(f, "RES {} {}", self.width, self.height)?;
        for (index, sphere) in self.spheres.iter().enumerate() {
            let Sphere { center: p, scale: s, color: c, ka, kd, ks, kr, n, kt, eta } = sphere;
            write!(f, "SPHERE {} ", label(self.sphere_names.get(index)))?;
            write!(f, "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} ", p.x, p.y, p.z, s.x, s.y, s.z, c.x, c.y, c.z)?;
            write!(f, "{ka:?} {kd:?} {ks:?} {kr:?} {n:?}")?;
            if (*kt, *eta) != (0.0, 1.0) {
                write!(f, " {kt:?} {eta:?}")?;
            }
            writeln!(f)?;
        }
        for (index, Light { position: p, intensity: i }) in self.lights.iter().enumerate() {
            let name = label(self.light_names.get(index));
            writeln!(f, "LIGHT {name} {:?} {:?} {:?} {:?} {:?} {:?}", p.x, p.y, p.z, i.x, i.y, i.z)?;
        }
        let (back, ambient) = (self.background, self.ambient);
        writeln!(f, "BACK {:?} {:?} {:?}", back.x, back.y, back.z)?;
        writeln!(f, "AMBIENT {:?} {:?} {:?}", ambient.x, ambient.y, ambient.z)?;
        self.output.iter().try_for_each(|output| writeln!(f, "OUTPUT {output}"))
    }
}

/// A label is one token; a scene that was not read from a file may lack it.
fn label(name: &str) -> &str {
    if name.is_empty() { "unnamed" } else { name }
}

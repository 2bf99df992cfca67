//! The cone of rays that a renderer which rounds may follow instead of the exact one: how wide it is along the path, which
//! decisions it does not leave sure, and how far the colour at its end may be off.

use super::decision::Decision;
use super::intersect::{Approach, Hit, Own, Range, Ray};
use super::judge::Trial;
use super::margin::{ANGLE, Crossing, LENGTH, Margins, Path, Roundoff};
use super::refract::Snell;
use super::scene::{PointLight, World};
use super::shade::{LightTerms, Surface, specular_power};
use super::spread::{Extent, Gamut, Spread};
use super::surfaces::Surfaces;
use super::vec3::{Vec3, length};
use super::witness::Witness;
use crate::settings::Specular;

/// A direction that is off by this much, as an angle, may lead anywhere: what it shows is bounded, not followed.
const LOST: f64 = 0.25;

/// An answer other than the one that the reference gives.
#[derive(Debug, Clone, Copy)]
struct Answer {
    hit: Option<Hit<f64>>,
    decision: Decision,
}

/// Traces the middle of the cone with some decisions taken otherwise.
#[derive(Debug)]
pub(super) struct Cone<'a> {
    roundoff: Roundoff,
    surfaces: &'a Surfaces,
    gamut: &'a Gamut,
    max_depth: u32,
    path: Path,
    /// Of the refraction rays that wait, with what they count for in the colour of the ray that they go on from.
    waiting: Vec<(Path, f64)>,
    /// Kr of the surface last hit.
    mirror: f64,
    /// Error of the unit normal of the surface last hit.
    normal: f64,
    /// Of the light in hand: the error of N·L, and that of the direction to it.
    light: [f64; 2],
    /// Whether light changes the colour of the surface in hand.
    shows_light: bool,
    spread: Spread,
    /// For each unsure decision from the first on which of its answers to take; 0 is the reference's own, as for all others.
    script: &'a [u32],
    /// Unsure decisions so far.
    unsure: usize,
    /// For each unsure decision beyond the script how many other answers there are.
    pub others: Vec<u32>,
    /// The first decision that was taken otherwise.
    pub flipped: Option<Decision>,
    /// The first that could be, and was not.
    pub open: Option<Decision>,
}

impl<'a> Cone<'a> {
    pub(super) fn new(trial: &'a Trial, script: &'a [u32]) -> Self {
        let Trial { reference, roundoff, surfaces, gamut } = trial;
        let (world, roundoff) = (&reference.world, *roundoff);
        Self {
            roundoff,
            surfaces,
            gamut,
            max_depth: world.max_depth,
            path: Path::primary(roundoff, &reference.camera),
            waiting: Vec::new(),
            mirror: 0.0,
            normal: 0.0,
            light: [0.0; 2],
            shows_light: true,
            spread: Spread::new(roundoff),
            script,
            unsure: 0,
            others: Vec::new(),
            flipped: None,
            open: None,
        }
    }

    /// What the colours of the cone spread over.
    pub(super) fn into_spread(self) -> Spread {
        self.spread
    }

    /// Whether the ray in hand may lead anywhere.
    fn is_lost(&self) -> bool {
        !(self.path.direction < LOST)
    }

    /// Which answer to an unsure decision with so many others to take; `decision` says of which kind each is.
    fn choose(&mut self, others: usize, decision: impl Fn(usize) -> Decision) -> usize {
        if others == 0 {
            return 0;
        }
        let choice = self.script.get(self.unsure).map(|&choice| choice as usize);
        self.unsure += 1;
        let Some(choice) = choice else {
            self.others.push(others as u32);
            self.open.get_or_insert(decision(0));
            return 0;
        };
        if choice > 0 {
            self.flipped.get_or_insert(decision(choice - 1));
        }
        choice
    }

    /// What else than `hit` a ray of the cone may meet first in `range`.
    fn other_hits(
        &self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: Option<&Own<f64>>,
        range: &Range<f64>,
        hit: Option<&Hit<f64>>,
    ) -> Vec<Answer> {
        let margins = Margins { world, ray, path: &self.path, roundoff: self.roundoff };
        let at_min = if self.path.bounces == 0 { Decision::NearPlane } else { Decision::Epsilon };
        let mut found = Vec::new();
        // Nothing behind what is surely met counts.
        let mut limit = f64::INFINITY;
        for sphere in self.surfaces.near(&margins, f64::INFINITY) {
            let shape = &world.shapes[sphere];
            let own = own.filter(|own| own.shape == shape.index);
            if own.is_some_and(|own| !own.inside) {
                continue;
            }
            let crossing = match own {
                Some(own) => Some(margins.exit(sphere, own)),
                None => margins.crossing(sphere),
            };
            let Some(Crossing { t: [lesser, greater], error: [lesser_error, greater_error], is_sure }) = crossing
            else {
                continue;
            };
            let t_min = range.t_min;
            // NaN is beyond and before everything.
            let is_lesser = own.is_none() && !(lesser + lesser_error <= t_min);
            let is_surely_lesser = own.is_none() && lesser - lesser_error > t_min;
            let is_greater = range.greater && !is_surely_lesser && !(greater + greater_error <= t_min);
            let is_surely_any = is_sure && (is_surely_lesser || (range.greater && greater - greater_error > t_min));
            let cause = if !is_sure {
                Some(Decision::Silhouette)
            } else if !is_surely_any || (is_lesser && is_greater) {
                Some(at_min)
            } else {
                None
            };
            let mut farthest = f64::NEG_INFINITY;
            for (is_possible, t, error, inside) in
                [(is_lesser, lesser, lesser_error, false), (is_greater, greater, greater_error, true)]
            {
                if is_possible {
                    found.push((Hit { t, sphere, inside }, t - error, cause));
                    farthest = farthest.max(t + error);
                }
            }
            if is_surely_any {
                limit = limit.min(farthest);
            }
        }
        let own_cause = hit.and_then(|hit| {
            let of_hit = found.iter().find(|(other, ..)| (other.sphere, other.inside) == (hit.sphere, hit.inside));
            of_hit.and_then(|&(_, _, cause)| cause)
        });
        let is_other =
            |other: &Hit<f64>| hit.is_none_or(|hit| (other.sphere, other.inside) != (hit.sphere, hit.inside));
        let mut answers: Vec<Answer> = found
            .iter()
            .filter(|(other, start, _)| is_other(other) && !(*start > limit))
            .map(|&(other, _, cause)| {
                let decision = cause.or(own_cause).unwrap_or(Decision::Tie);
                Answer { hit: Some(other), decision }
            })
            .collect();
        if hit.is_some() && limit == f64::INFINITY {
            answers.push(Answer { hit: None, decision: own_cause.unwrap_or(Decision::Silhouette) });
        }
        answers
    }

    /// Whether some rays of the cone are blocked on the way to a light and some are not, as far as the reference says which.
    fn is_shadow_unsure(
        &self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: &Own<f64>,
        path: &Path,
        is_blocked: bool,
    ) -> bool {
        let margins = Margins { world, ray, path, roundoff: self.roundoff };
        let mut may_block = false;
        for sphere in self.surfaces.near(&margins, 1.0) {
            let shape = &world.shapes[sphere];
            let own = Some(own).filter(|own| own.shape == shape.index);
            if own.is_some_and(|own| !own.inside) {
                continue;
            }
            let crossing = match own {
                Some(own) => Some(margins.exit(sphere, own)),
                None => margins.crossing(sphere),
            };
            let Some(Crossing { t, error, is_sure }) = crossing else { continue };
            let roots = if own.is_some() { 1..2 } else { 0..2 };
            for root in roots {
                let (t, error) = (t[root], error[root]);
                if is_sure && t - error > world.shadow_t_min && t + error < 1.0 {
                    return !is_blocked;
                }
                may_block |= !(t + error <= world.shadow_t_min || t - error >= 1.0);
            }
        }
        may_block || is_blocked
    }
}

impl Witness<f64> for Cone<'_> {
    fn nearest(
        &mut self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: Option<&Own<f64>>,
        range: &Range<f64>,
        hit: Option<Hit<f64>>,
    ) -> Option<Hit<f64>> {
        if self.is_lost() {
            self.spread.add_any(self.gamut.after(self.max_depth.saturating_sub(self.path.bounces)));
            return None;
        }
        let answers = self.other_hits(world, ray, own, range, hit.as_ref());
        match self.choose(answers.len(), |index| answers[index].decision) {
            0 => hit,
            choice => answers[choice - 1].hit,
        }
    }

    fn background(&mut self, world: &World<f64>) {
        if self.is_lost() {
            // It may as well not add it.
            return self.spread.add_any(Extent::up_to(-world.background.to_f64()));
        }
        self.spread.add_constant([world.background, Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 1.0)]);
    }

    fn surface(
        &mut self,
        world: &World<f64>,
        ray: &Ray<f64>,
        hit: &Hit<f64>,
        _at: &Approach<f64>,
        surface: &Surface<f64>,
    ) {
        let margins = Margins { world, ray, path: &self.path, roundoff: self.roundoff };
        let error = margins.point(hit.sphere, hit.t, surface.own.local);
        self.normal = error.normal;
        self.path = Path { position: error.position, own: Some(surface.own), ..self.path };
        let material = &world.materials[hit.sphere];
        self.mirror = material.kr;
        let ka = Vec3::new(material.ka, material.ka, material.ka);
        self.spread.add_constant([world.ambient, material.color, ka]);
    }

    fn lit(
        &mut self,
        world: &World<f64>,
        surface: &Surface<f64>,
        light: &PointLight<f64>,
        n_dot_l: f64,
        is_lit: bool,
    ) -> bool {
        let material = &world.materials[surface.sphere];
        self.shows_light = material.kd != 0.0 || material.ks != 0.0;
        if !self.shows_light {
            return is_lit;
        }
        let Roundoff { shading, geometry } = self.roundoff;
        let place = geometry * (length(light.position) + length(surface.position));
        let distance = length(light.position - surface.position);
        let direction = (self.path.position + place) / distance + ANGLE * shading;
        let angle = self.normal + direction;
        // cos changes by sin·dα + ½dα², and with the lengths of both unit vectors.
        let sine = (1.0 - n_dot_l * n_dot_l).max(0.0).sqrt();
        let cosine = sine * angle + 0.5 * angle * angle + 2.0 * LENGTH * shading * n_dot_l.abs();
        self.light = [cosine, direction];
        // NaN: a light at distance 0 is anywhere.
        if !(angle < LOST) {
            self.spread.add_any(Gamut::of_light(material, light));
            return false;
        }
        let is_unsure = n_dot_l.abs() <= cosine;
        is_lit ^ (self.choose(usize::from(is_unsure), |_| Decision::Terminator) == 1)
    }

    fn blocked(&mut self, world: &World<f64>, ray: &Ray<f64>, own: &Own<f64>, is_blocked: bool) -> bool {
        if !self.shows_light {
            return is_blocked;
        }
        let light = length(ray.origin + ray.direction);
        let end = self.roundoff.geometry * (light + length(ray.origin));
        let path = Path { end: Some(end), ..self.path };
        let is_unsure = self.is_shadow_unsure(world, ray, own, &path, is_blocked);
        is_blocked ^ (self.choose(usize::from(is_unsure), |_| Decision::ShadowEdge) == 1)
    }

    fn shaded(&mut self, world: &World<f64>, surface: &Surface<f64>, light: &PointLight<f64>, terms: &LightTerms<f64>) {
        let material = &world.materials[surface.sphere];
        let [cosine_error, light_error] = self.light;
        let n_dot_l = surface.normal.dot(terms.to_light);
        let diffuse = [(n_dot_l - cosine_error).clamp(0.0, 1.0), (n_dot_l + cosine_error).clamp(0.0, 1.0)];
        let intensity = light.intensity.to_f64();
        self.spread.add_term(intensity * material.color.to_f64() * material.kd, n_dot_l, diffuse);

        let shading = self.roundoff.shading;
        let angle_error = match world.specular {
            // The mirrored vector turns with what is wrong in the length of the normal, twice as much.
            Specular::Phong => 2.0 * self.normal + light_error + self.path.direction + 2.0 * LENGTH * shading,
            // The sum of two unit vectors turns by what they turn and by what is wrong in their lengths, over its own.
            Specular::Blinn => {
                let sum = length(terms.to_light + surface.view);
                self.normal + (light_error + self.path.direction + 2.0 * LENGTH * shading) / sum + ANGLE * shading
            }
        };
        // 1 − cos α = 2 sin²(½α).
        let angle = 2.0 * (0.5 * terms.d).clamp(0.0, 1.0).sqrt().asin();
        let power = |angle: f64| {
            let half_sine = (0.5 * angle.clamp(0.0, std::f64::consts::PI)).sin();
            specular_power(2.0 * half_sine * half_sine, material.n)
        };
        // Exponential and logarithm round what the exponent has made large.
        let rounded = |power: f64, sign: f64| {
            let steps = if power > 0.0 && material.n > 0.0 { LENGTH * (1.0 - power.ln()) } else { 0.0 };
            power * (1.0 + sign * steps * shading)
        };
        let range = [rounded(power(angle + angle_error), -1.0), rounded(power(angle - angle_error), 1.0)];
        self.spread.add_term(intensity * material.ks, specular_power(terms.d, material.n), range);
    }

    fn reflected(&mut self, throughput: f64) {
        let direction = self.path.direction + 2.0 * (self.normal + LENGTH * self.roundoff.shading);
        let ray = self.spread.follow(throughput, self.path.ray, self.mirror);
        self.path = Path { direction, throughput, bounces: self.path.bounces + 1, ray, ..self.path };
    }

    fn refracted(
        &mut self,
        world: &World<f64>,
        surface: &Surface<f64>,
        snell: Snell<f64>,
        throughput: f64,
    ) -> Snell<f64> {
        let Snell { ratio, cosine, square, bend } = snell;
        let u = self.roundoff.shading;
        let sine_squared = (1.0 - cosine * cosine).max(0.0);
        // The angle between ray and normal is off by so much, its cosine by sin·dα + ½dα².
        let angle_error = self.path.direction + self.normal + ANGLE * u;
        let cosine_error =
            sine_squared.sqrt() * angle_error + 0.5 * angle_error * angle_error + 2.0 * LENGTH * u * cosine;
        let ratio_error = if ratio == 1.0 { 0.0 } else { 2.0 * u * ratio };
        // k = 1 − r²(1 − c²).
        let square_error = 2.0 * ratio * ratio * cosine * cosine_error
            + ratio * ratio * cosine_error * cosine_error
            + 2.0 * ratio * sine_squared * ratio_error
            + ANGLE * u * (ratio * cosine * ratio * cosine).max((ratio * ratio - 1.0).abs());
        let is_unsure = square.abs() <= square_error;
        let is_other = self.choose(usize::from(is_unsure), |_| Decision::CriticalAngle) == 1;
        let snell = match (is_other, snell.is_total()) {
            (false, _) => snell,
            (true, false) => Snell { square: 0.0, ..snell },
            (true, true) => {
                Snell { square: f64::MIN_POSITIVE, bend: (ratio - 1.0) * (ratio + 1.0) / (ratio * cosine), ..snell }
            }
        };
        let is_total = snell.is_total();
        let direction = if is_total {
            self.path.direction + 2.0 * (self.normal + LENGTH * u)
        } else {
            // The bend r·c − √k changes by c and by r as its derivatives say, with √k halfway to the least that its error leaves of it.
            let [root, least, error] = [square, square - square_error, square_error].map(|k| k.max(0.0).sqrt());
            let root = (0.5 * (root + least)).max(0.5 * error).max(f64::MIN_POSITIVE);
            ratio * self.path.direction
                + bend.abs() * self.normal
                + ratio * (bend.abs() / root) * cosine_error
                + (2.0 + ratio * sine_squared / root) * ratio_error
                + 2.0 * LENGTH * u * bend.abs()
        };
        let own = Own { inside: surface.own.inside ^ !is_total, ..surface.own };
        let bounces = self.path.bounces + 1;
        let path = Path { direction, throughput, bounces, own: Some(own), ..self.path };
        self.waiting.push((path, world.glasses[surface.sphere].kt));
        snell
    }

    fn resumed(&mut self) {
        if let Some((path, coefficient)) = self.waiting.pop() {
            let ray = self.spread.follow(path.throughput, path.ray, coefficient);
            self.path = Path { ray, ..path };
        }
    }
}

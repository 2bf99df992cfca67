//! The catalogue of hard cases, with what each tier promises of them.

use glam::DVec3;

use super::metrics::{Limit, Quantity, Target, U};
use super::rays::{
    self, GLASS, Generator, LitGenerator, above, at_distance, ball, concentric, contact, egg, from_eye, inside, seen,
    segments, sized, through,
};
use crate::gpu::Batch;
use crate::settings::Specular;

/// What a case runs.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// The nearest hit of generated rays.
    Rays(Generator),
    /// The hit at the end of a path from mirror to mirror.
    Mirrored(Generator),
    /// The hit at the end of a path through glass.
    Refracted(Generator),
    /// Whether something stands between the ends of segments.
    Blocked(Generator),
    /// The nearest hit, and whether the light reaches it.
    Lit(LitGenerator),
    /// The specular term at the nearest hit.
    Highlight(LitGenerator, Specular),
    ZeroScale,
    NegativeScale,
    BitPatterns,
    Power,
    OddLights,
    Mirrors,
    /// Pixels that a kernel says to be sure of, in scenes of all kinds.
    Certified,
    FacingMirrors,
    Transforms,
}

/// One case of a class.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// What distinguishes it within its class; empty where it is alone.
    pub label: &'static str,
    pub kind: Kind,
    /// What fast, robust, double and its stand-in without f64 promise.
    pub targets: [Target; 4],
}

/// A class of hard cases.
#[derive(Debug, Clone)]
pub struct Class {
    /// Its number in the catalogue, from 1.
    pub id: u32,
    /// Its name on the command line.
    pub name: &'static str,
    /// A line for people.
    pub about: &'static str,
    /// What is counted.
    pub counted: &'static str,
    pub(super) cases: Vec<Case>,
}

fn limits(limits: &[(Quantity, f64)]) -> Target {
    let mut limits: Vec<_> = limits.iter().map(|&(quantity, at_most)| Limit { quantity, at_most }).collect();
    limits.push(Limit { quantity: Quantity::NotFinite, at_most: 0.0 });
    Target::Limits(limits)
}

/// No wrong ray beyond the kernel's band around the tangent.
fn exact(errors: Errors) -> Target {
    within(Quantity::WrongBeyondBand, 0.0, errors)
}

/// So much wrong at the most.
fn within(wrong: Quantity, at_most: f64, errors: Errors) -> Target {
    let [p999, t, place, normal, mirrored] = errors;
    limits(&[
        (wrong, at_most),
        (Quantity::P999, p999),
        (Quantity::WorstT, t),
        (Quantity::WorstPlace, place),
        (Quantity::WorstNormal, normal),
        (Quantity::WorstMirrored, mirrored),
    ])
}

/// Every point is lit that ought to be, and no other.
fn lit(error: f64) -> Target {
    use Quantity::{Acne, Leaks, LightError, Wrong};
    limits(&[(Wrong, 0.0), (Acne, 0.0), (Leaks, 0.0), (LightError, error)])
}

fn same(target: &Target) -> [Target; 4] {
    std::array::from_fn(|_| target.clone())
}

/// Limits of errors in units of 2⁻²³: the 99.9th percentile of that of t, and the greatest of t, of the hit point, of the normal and
/// of the mirrored direction.
type Errors = [f64; 5];

/// The classes, in the order of their numbers. Errors are limited to about four times the greatest that were measured with eight
/// seeds on a device that divides and takes square roots as IEEE 754 says, six times where seeds differ by a factor of two.
#[allow(clippy::too_many_lines, reason = "a table")]
#[rustfmt::skip]
pub fn classes() -> Vec<Class> {
    use Kind::{Blocked, Highlight, Lit, Mirrored, Rays, Refracted};
    use Quantity::{Differing, Inversions, Misclassified, PowerError, Wrong, WrongBeyondBand};
    let flag = || Target::NotCovered;
    let case = |label, kind, targets| Case { label, kind, targets };
    let special = |kind, targets| vec![Case { label: "", kind, targets }];
    let class = |id, name, about, counted, cases| Class { id, name, about, counted, cases };
    let none_differs = || same(&limits(&[(Differing, 0.0)]));
    vec![
        class(1, "ordinary", "bodies seen from five to seven semi-axes", "wrong, errors", vec![
            case("eye", Rays(|r, n| from_eye(r, n, 5.0, ball)), [
                exact([8.5, 9.4, 43.0, 24.0, 49.0]),
                exact([4.5, 5.1, 1.5e-6, 5.3, 23.0]),
                exact([2.5e-8, 1.8e-8, 1.0e-7, 4.7e-8, 9.7e-8]),
                exact([2.0, 2.0, 1.5e-6, 5.3, 23.0]),
            ]),
            case("any origin", Rays(|r, n| at_distance(r, n, 7.0, egg)), [
                exact([17.0, 11.0, 43.0, 36.0, 70.0]),
                exact([4.4, 5.3, 2.6e-6, 6.4, 24.0]),
                exact([3.8e-8, 2.0e-8, 7.7e-8, 7.1e-8, 1.4e-7]),
                exact([2.0, 2.0, 2.6e-6, 6.4, 24.0]),
            ]),
        ]),
        class(2, "secondary", "incoherent secondary rays among bodies of a box of 20", "wrong, errors", vec![
            case("", Rays(rays::secondary), [
                within(WrongBeyondBand, 1.0, [96.0, 180.0, 870.0, 570.0, 840.0]),
                exact([4.8, 5.2, 4.1e-5, 6.1, 21.0]),
                exact([1.8e-7, 3.0e-7, 2.1e-6, 5.5e-7, 1.1e-6]),
                exact([2.0, 2.0, 4.1e-5, 6.1, 21.0]),
            ]),
            case("once mirrored", Mirrored(|r, n| Batch { bounces: 1, ..rays::secondary(r, n) }), [
                within(Misclassified, 1.0e-4, [750.0, 150.0, 3300.0, 1800.0, 6600.0]),
                within(Misclassified, 1.0e-4, [36.0, 16.0, 920.0, 1100.0, 2000.0]),
                within(Misclassified, 1.0e-8, [6.2e-7, 3.9e-7, 1.6e-5, 1.6e-5, 3.2e-5]),
                within(Misclassified, 1.0e-4, [27.0, 16.0, 140.0, 350.0, 630.0]),
            ]),
        ]),
        class(3, "far", "tiny and far bodies", "wrong, errors", vec![
            case("eye 1e3", Rays(|r, n| from_eye(r, n, 1e3, ball)), [
                within(Wrong, 40.0, [7.8, 11.0, 8900.0, 4600.0, 9100.0]),
                exact([4.3, 5.0, 3.7e-4, 5.4, 23.0]),
                exact([2.4e-8, 1.8e-8, 1.9e-5, 9.7e-6, 2.0e-5]),
                exact([2.0, 2.0, 3.0e-4, 5.4, 23.0]),
            ]),
            case("eye 1e5", Rays(|r, n| from_eye(r, n, 1e5, egg)), [
                within(Wrong, 3800.0, [12.0, 9.7, 6.8e5, 5.2e5, 1.0e6]),
                exact([4.4, 5.1, 0.037, 4.8, 25.0]),
                exact([3.3e-8, 1.9e-8, 1.3e-3, 1.2e-3, 2.4e-3]),
                exact([2.0, 2.0, 0.037, 4.8, 25.0]),
            ]),
            case("any origin 1e3", Rays(|r, n| at_distance(r, n, 1e3, egg)), [
                within(Wrong, 80.0, [14.0, 11.0, 5700.0, 6000.0, 1.2e4]),
                exact([4.3, 5.4, 3.7e-4, 4.8, 22.0]),
                exact([3.7e-8, 2.0e-8, 1.1e-5, 1.4e-5, 2.7e-5]),
                exact([2.0, 2.0, 3.7e-4, 4.5, 22.0]),
            ]),
            case("any origin 1e5", Rays(|r, n| at_distance(r, n, 1e5, ball)), [
                within(Wrong, 200.0, [7.6, 9.8, 9.7e5, 5.0e5, 9.9e5]),
                exact([4.4, 5.3, 0.032, 5.6, 26.0]),
                exact([3.2e-8, 2.0e-8, 1.7e-3, 1.0e-3, 2.0e-3]),
                exact([2.0, 2.0, 0.032, 5.6, 26.0]),
            ]),
            case("any origin 1e7", Rays(|r, n| at_distance(r, n, 1e7, egg)), [
                flag(),
                exact([4.4, 5.1, 3.6, 8.1, 24.0]),
                exact([3.9e-8, 2.1e-8, 0.11, 0.13, 0.25]),
                exact([2.0, 2.0, 3.6, 8.1, 24.0]),
            ]),
        ]),
        class(4, "earth", "the flattened Earth from an eye at one metre, near the horizon", "wrong, errors", vec![
            case("", Rays(rays::earth), [
                flag(),
                exact([5.5, 0.014, 4.4e-7, 0.013, 0.024]),
                exact([0.12, 8.9e-5, 9.3e-9, 9.3e-9, 1.9e-8]),
                exact([3.5, 7.4e-3, 4.4e-7, 0.013, 0.015]),
            ]),
        ]),
        class(5, "near-surface", "origins 1e-7 to 1e-2 radii from the surface, in and out", "wrong, errors", vec![
            case("balls", Rays(|r, n| above(r, n, ball)), [
                flag(),
                exact([5.4, 6.7, 1.2e-6, 5.1, 26.0]),
                exact([0.026, 0.043, 2.9e-8, 1.1e-8, 4.3e-8]),
                exact([2.3, 3.2, 1.2e-6, 5.1, 26.0]),
            ]),
            case("ellipsoids", Rays(|r, n| above(r, n, egg)), [
                flag(),
                exact([5.5, 6.9, 1.3e-6, 6.9, 21.0]),
                exact([0.037, 0.067, 3.0e-8, 1.8e-8, 4.3e-8]),
                exact([2.9, 6.9, 9.9e-7, 6.9, 21.0]),
            ]),
        ]),
        class(6, "tangent", "1-l² from 1e-12 to 1e-2, either side", "largest misclassified |1-l²|, errors", vec![
            case("eye", Rays(rays::tangent_eye), [
                within(Misclassified, 1.1e-6, [2800.0, 2.0, 9.4, 9.4, 19.0]),
                within(Misclassified, 2.5e-7, [4.6, 0.45, 1.7e-6, 0.48, 0.81]),
                within(Misclassified, 1.0e-9, [1.7e-3, 3.6e-9, 1.8e-8, 1.8e-8, 3.5e-8]),
                within(Misclassified, 1.0e-9, [2.0, 0.19, 1.7e-6, 0.48, 0.81]),
            ]),
            case("any origin", Rays(rays::tangent), [
                within(Misclassified, 2.6e-6, [4700.0, 4.6, 19.0, 27.0, 52.0]),
                within(Misclassified, 2.5e-7, [4.3, 0.46, 2.9e-6, 0.53, 0.81]),
                within(Misclassified, 1.0e-9, [2.5e-3, 7.4e-9, 3.3e-8, 4.2e-8, 8.2e-8]),
                within(Misclassified, 1.0e-9, [2.0, 0.19, 2.9e-6, 0.53, 0.81]),
            ]),
        ]),
        class(7, "thin", "discs and needles", "wrong, errors", vec![
            case("disc 1:1:1e-3", Rays(|r, n| seen(r, n, DVec3::new(1.0, 1.0, 1e-3))), [
                within(WrongBeyondBand, 1.0, [8.9, 12.0, 48.0, 45.0, 86.0]),
                exact([4.4, 5.1, 1.3e-4, 5.8, 21.0]),
                exact([1.7e-8, 2.0e-8, 9.9e-8, 8.5e-8, 1.7e-7]),
                exact([2.0, 2.0, 1.3e-4, 5.8, 21.0]),
            ]),
            case("needle 1e-2:1:100", Rays(rays::needle_eye), [
                flag(),
                exact([4.4, 5.6, 5.9e-6, 7.2, 29.0]),
                exact([1.8e-8, 2.3e-8, 1.2e-7, 9.0e-6, 1.8e-5]),
                exact([2.0, 2.0, 4.8e-6, 4.8, 29.0]),
            ]),
            case("needle, any origin", Rays(rays::needle), [
                flag(),
                exact([4.4, 5.4, 5.4e-6, 6.4, 29.0]),
                exact([1.9e-8, 2.4e-8, 1.2e-7, 8.6e-6, 1.7e-5]),
                exact([2.0, 2.0, 5.4e-6, 6.4, 29.0]),
            ]),
            case("1:1:1e-4 from 2e-4", Rays(rays::disc_from_near), [
                within(WrongBeyondBand, 1.0, [28.0, 13.0, 14.0, 2.0, 6.1]),
                exact([4.7, 5.5, 0.0026, 2.0, 6.1]),
                exact([5.0e-8, 2.4e-8, 2.5e-8, 9.2e-9, 1.2e-8]),
                exact([2.0, 2.0, 0.0025, 2.0, 6.1]),
            ]),
        ]),
        class(8, "translated", "eye and sphere at 1e6 from the world's origin", "wrong, errors", vec![
            case("", Rays(rays::translated), [
                exact([7.5, 7.4, 5.3e6, 24.0, 51.0]),
                exact([4.5, 5.4, 0.52, 5.6, 23.0]),
                exact([2.4e-8, 1.8e-8, 9.9e-3, 4.9e-8, 1.1e-7]),
                exact([2.0, 2.0, 0.52, 5.6, 23.0]),
            ]),
        ]),
        class(9, "concentric", "surfaces with small gaps, and such that touch", "order inversions, errors", vec![
            case("gap 1e-5", Rays(|r, n| concentric(r, n, 1e-5)), [
                within(Inversions, 0.0, [8.9, 11.0, 44.0, 65.0, 87.0]),
                within(Inversions, 0.0, [4.3, 5.1, 4.0e-6, 5.3, 25.0]),
                within(Inversions, 0.0, [1.8e-8, 2.0e-8, 9.4e-8, 8.9e-8, 1.7e-7]),
                within(Inversions, 0.0, [2.0, 2.0, 3.2e-6, 5.3, 25.0]),
            ]),
            case("gap 1e-6", Rays(|r, n| concentric(r, n, 1e-6)), [
                flag(),
                within(Inversions, 1.4e4, [4.3, 5.4, 2.8e-6, 7.8, 25.0]),
                within(Inversions, 0.0, [1.8e-8, 2.1e-8, 9.0e-8, 8.4e-8, 1.7e-7]),
                within(Inversions, 0.0, [2.0, 2.0, 2.8e-6, 5.2, 25.0]),
            ]),
            case("gap 1 ulp", Rays(|r, n| concentric(r, n, U)), [
                flag(),
                flag(),
                within(Inversions, 0.0, [1.8e-8, 2.1e-8, 9.6e-8, 1.4e-7, 1.9e-7]),
                within(Inversions, 0.0, [2.0, 2.0, 3.1e-6, 5.1, 25.0]),
            ]),
            case("gap 0", Rays(|r, n| concentric(r, n, 0.0)), [
                within(Inversions, 0.0, [8.8, 12.0, 47.0, 51.0, 110.0]),
                within(Inversions, 0.0, [4.3, 5.5, 2.8e-6, 7.7, 26.0]),
                within(Inversions, 0.0, [1.8e-8, 2.4e-8, 8.3e-8, 1.5e-7, 2.8e-7]),
                within(Inversions, 0.0, [2.0, 2.0, 2.8e-6, 7.7, 26.0]),
            ]),
            case("touching", Rays(rays::internally_tangent), [
                Target::Reported,
                Target::Reported,
                within(Inversions, 0.0, [4.0e-9, 4.0e-9, 4.0e-9, 4.0e-9, 1.5e-8]),
                Target::Reported,
            ]),
        ]),
        class(10, "world-size", "the ordinary world, huge and tiny", "wrong, errors, not finite", vec![
            case("1e20", Rays(|r, n| sized(r, n, 66)), [
                exact([17.0, 12.0, 38.0, 38.0, 70.0]),
                exact([4.4, 5.1, 2.5e-6, 4.8, 23.0]),
                exact([3.9e-8, 2.0e-8, 7.0e-8, 7.4e-8, 1.6e-7]),
                exact([2.0, 2.0, 2.5e-6, 4.8, 23.0]),
            ]),
            case("1e-30", Rays(|r, n| sized(r, n, -100)), [
                exact([17.0, 13.0, 40.0, 37.0, 71.0]),
                exact([4.4, 5.3, 3.2e-6, 6.7, 23.0]),
                exact([4.1e-8, 2.2e-8, 8.1e-8, 7.3e-8, 1.5e-7]),
                exact([2.0, 2.0, 3.2e-6, 6.7, 23.0]),
            ]),
            case("1e-38", Rays(|r, n| sized(r, n, -126)), [
                exact([16.0, 12.0, 37.0, 38.0, 76.0]),
                exact([4.4, 5.1, 3.4e-6, 4.8, 25.0]),
                exact([3.6e-8, 2.5e-8, 7.5e-8, 8.0e-8, 1.7e-7]),
                exact([2.0, 2.0, 2.2e-6, 4.8, 25.0]),
            ]),
        ]),
        class(11, "inside", "eyes inside a body", "wrong, errors", vec![
            case("balls", Rays(|r, n| inside(r, n, ball)), [
                exact([20.0, 33.0, 17.0, 6.5, 26.0]),
                exact([5.2, 6.5, 1.0e-6, 5.3, 25.0]),
                exact([2.7e-8, 4.1e-8, 2.9e-8, 1.1e-8, 4.6e-8]),
                exact([2.0, 2.0, 1.0e-6, 5.3, 25.0]),
            ]),
            case("ellipsoids", Rays(|r, n| inside(r, n, egg)), [
                exact([21.0, 30.0, 16.0, 5.9, 24.0]),
                exact([5.2, 6.3, 1.3e-6, 4.8, 25.0]),
                exact([3.9e-8, 6.2e-8, 3.0e-8, 1.8e-8, 4.3e-8]),
                exact([2.0, 2.0, 1.0e-6, 4.8, 25.0]),
            ]),
            case("twice mirrored", Mirrored(|r, n| Batch { bounces: 2, ..inside(r, n, egg) }), [
                within(Misclassified, 1.0e-4, [56.0, 31.0, 97.0, 120.0, 210.0]),
                within(Misclassified, 1.0e-4, [47.0, 21.0, 69.0, 110.0, 190.0]),
                within(Misclassified, 1.0e-8, [1.1e-7, 5.8e-8, 1.8e-7, 2.6e-7, 4.7e-7]),
                within(Misclassified, 1.0e-4, [47.0, 21.0, 69.0, 72.0, 190.0]),
            ]),
        ]),
        class(12, "image-plane", "spheres cut or touched by the image plane", "wrong, errors", vec![
            case("cut", Rays(rays::cut), [
                exact([7.9, 7.8, 36.0, 17.0, 34.0]),
                exact([5.1, 6.4, 1.0e-6, 5.3, 25.0]),
                exact([1.4e-8, 1.5e-8, 6.3e-8, 3.8e-8, 7.5e-8]),
                exact([2.0, 2.0, 1.0e-6, 5.3, 25.0]),
            ]),
            case("touching", Rays(rays::touching), [
                within(Wrong, 0.0, [2.0, 2.0, 520.0, 2.0, 10.0]),
                within(Wrong, 0.0, [2.0, 2.0, 5.3e-23, 2.0, 10.0]),
                within(Wrong, 0.0, [4.0e-9, 4.0e-9, 9.6e-7, 4.0e-9, 1.9e-8]),
                within(Wrong, 0.0, [2.0, 2.0, 5.3e-23, 2.0, 10.0]),
            ]),
        ]),
        class(13, "zero-scale", "a scale of zero is an error that names its line", "differing", special(Kind::ZeroScale, none_differs())),
        class(14, "negative-scale", "a negative scale means its absolute value, bit for bit", "differing", special(Kind::NegativeScale, none_differs())),
        class(15, "bit-patterns", "infinities, denormals and what is no number, in every input", "not finite", special(Kind::BitPatterns, same(&limits(&[])))),
        class(16, "odd-lights", "lights on the surface, inside, behind, at the hit point", "not finite, differing", special(Kind::OddLights, none_differs())),
        class(17, "terminator", "light from 1e-5 to 1 above or below the horizon", "acne, leaks, N·L", vec![
            case("", Lit(rays::terminator), [
                lit(29.0),
                lit(8.4),
                lit(5.8e-8),
                lit(8.4),
            ]),
        ]),
        class(18, "contact", "small blockers in contact with what they shade", "acne, leaks, N·L", vec![
            case("gap 0", Lit(|r, n| contact(r, n, 0.0)), [
                lit(8.3),
                lit(6.2),
                lit(1.6e-8),
                lit(6.2),
            ]),
            case("gap 1e-7", Lit(|r, n| contact(r, n, 1e-7)), [
                lit(9.9),
                lit(6.7),
                lit(1.8e-8),
                lit(6.7),
            ]),
            case("gap -1e-7", Lit(|r, n| contact(r, n, -1e-7)), [
                lit(12.0),
                lit(6.5),
                lit(1.5e-8),
                lit(6.5),
            ]),
        ]),
        class(19, "power", "specular exponents from 0 to 1e5", "error of the power, not finite", special(Kind::Power, [2e-7, 2e-7, 5e-16, 2e-7].map(|error| limits(&[(PowerError, error)])))),
        class(20, "mirrors", "Kr = 1 and beyond, intensity beyond 1", "not finite, energy", special(Kind::Mirrors, none_differs())),
        class(21, "facing-mirrors", "where f32 and f64 paths part: conditioning, not a bug", "bounce", special(Kind::FacingMirrors, same(&Target::Reported))),
        class(22, "transforms", "error-free sums and products of 262,144 pairs on the device", "residuals lost", special(Kind::Transforms, [Target::NotApplicable, limits(&[(Differing, 0.0)]), Target::NotApplicable, limits(&[(Differing, 0.0)])])),
        class(23, "refraction", "paths through glass: in and out, beyond the critical angle, from wall to wall", "wrong, errors", vec![
            case("balls", Refracted(|r, n| through(r, n, ball, false, GLASS, 2)), [
                within(Misclassified, 1.0e-4, [6.1, 6.5, 9.2, 9.7, 23.0]),
                within(Misclassified, 1.0e-4, [5.9, 6.6, 5.1, 6.9, 23.0]),
                within(Misclassified, 1.0e-8, [1.2e-8, 1.4e-8, 2.2e-8, 2.3e-8, 4.1e-8]),
                within(Misclassified, 1.0e-4, [5.4, 6.2, 5.1, 6.9, 23.0]),
            ]),
            // Where Snell's law is nearly the identity.
            case("eta 1 + 2^-20", Refracted(|r, n| through(r, n, ball, false, 1.0 + 1.0 / f64::from(1 << 20), 2)), [
                within(Misclassified, 1.0e-4, [3.5, 4.1, 7.1, 5.4, 23.0]),
                within(Misclassified, 1.0e-4, [3.1, 3.7, 4.2, 5.7, 23.0]),
                within(Misclassified, 1.0e-8, [7.3e-9, 9.0e-9, 1.5e-8, 1.3e-8, 4.3e-8]),
                within(Misclassified, 1.0e-4, [2.0, 2.4, 4.2, 5.7, 23.0]),
            ]),
            case("ellipsoids", Refracted(|r, n| through(r, n, egg, false, GLASS, 2)), [
                within(Misclassified, 1.0e-4, [25.0, 6.3, 19.0, 19.0, 21.0]),
                within(Misclassified, 1.0e-4, [7.8, 6.2, 8.4, 8.7, 20.0]),
                within(Misclassified, 1.0e-8, [5.4e-8, 1.2e-8, 4.4e-8, 4.2e-8, 4.4e-8]),
                within(Misclassified, 1.0e-4, [7.7, 6.0, 8.4, 8.7, 20.0]),
            ]),
            // Those beyond the critical angle turn back at once and meet the screen, then leave it.
            case("bubbles", Refracted(|r, n| through(r, n, ball, false, 0.742_187_5, 2)), [
                within(Misclassified, 1.0e-4, [5.0, 6.5, 8.6, 8.9, 25.0]),
                within(Misclassified, 1.0e-4, [4.7, 4.6, 7.5, 7.4, 26.0]),
                within(Misclassified, 1.0e-8, [9.6e-9, 1.1e-8, 2.8e-8, 2.7e-8, 4.4e-8]),
                within(Misclassified, 1.0e-4, [4.0, 4.1, 7.5, 7.4, 26.0]),
            ]),
            // Born inside, reflected from wall to wall.
            case("diamonds", Refracted(|r, n| through(r, n, egg, true, 2.417_968_75, 4)), [
                within(Misclassified, 1.0e-4, [540.0, 180.0, 250.0, 460.0, 1300.0]),
                within(Misclassified, 1.0e-4, [280.0, 42.0, 110.0, 110.0, 190.0]),
                within(Misclassified, 1.0e-8, [1.1e-6, 3.5e-7, 5.7e-7, 5.7e-7, 7.9e-7]),
                within(Misclassified, 1.0e-4, [280.0, 34.0, 110.0, 110.0, 190.0]),
            ]),
            case("critical angle", Refracted(rays::critical), [
                within(Misclassified, 1.0e-4, [1100.0, 1.1, 14.0, 14.0, 15.0]),
                within(Misclassified, 1.0e-4, [1400.0, 0.89, 15.0, 15.0, 15.0]),
                within(Misclassified, 1.0e-8, [5.6e-4, 2.0e-9, 2.8e-8, 2.8e-8, 2.8e-8]),
                within(Misclassified, 1.0e-4, [1400.0, 0.89, 15.0, 15.0, 15.0]),
            ]),
        ]),
        class(24, "shadow-rays", "whether something stands between two points", "largest misclassified distance", vec![
            case("balls", Blocked(|r, n| segments(r, n, ball)), [
                limits(&[(Misclassified, 9.4e-7)]),
                limits(&[(Misclassified, 2.5e-7)]),
                limits(&[(Misclassified, 1.0e-9)]),
                limits(&[(Misclassified, 1.0e-9)]),
            ]),
            case("ellipsoids", Blocked(|r, n| segments(r, n, egg)), [
                limits(&[(Misclassified, 3.7e-6)]),
                limits(&[(Misclassified, 2.5e-7)]),
                limits(&[(Misclassified, 1.0e-9)]),
                limits(&[(Misclassified, 1.0e-9)]),
            ]),
        ]),
        class(25, "highlights", "the specular term, lights near the mirror image", "error of the term", vec![
            case("R·V", Highlight(rays::highlights, Specular::Phong), [
                limits(&[(Wrong, 0.0), (PowerError, 9.7e-5)]),
                limits(&[(Wrong, 0.0), (PowerError, 7.1e-6)]),
                limits(&[(Wrong, 0.0), (PowerError, 1.9e-13)]),
                limits(&[(Wrong, 0.0), (PowerError, 7.1e-6)]),
            ]),
            case("N·H", Highlight(rays::highlights, Specular::Blinn), [
                limits(&[(Wrong, 0.0), (PowerError, 6.8e-5)]),
                limits(&[(Wrong, 0.0), (PowerError, 3.7e-6)]),
                limits(&[(Wrong, 0.0), (PowerError, 1.1e-13)]),
                limits(&[(Wrong, 0.0), (PowerError, 3.7e-6)]),
            ]),
        ]),
        class(26, "certified", "pixels that a certified kernel is sure of, in scenes of all kinds", "not the reference's", vec![
            case("", Kind::Certified, [limits(&[(Differing, 0.0)]), Target::NotApplicable, limits(&[(Differing, 0.0)]), Target::NotApplicable]),
        ]),
    ]
}

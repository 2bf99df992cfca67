//! The catalogue of hard cases, with what each tier promises of them.

use super::metrics::{Limit, Quantity, Target};
use super::rays::{self, Generator, LitGenerator};

/// What a case runs.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// The nearest hit of generated rays.
    Rays(Generator),
    /// The same, and whether the light reaches the hit.
    Lit(LitGenerator),
    /// The hit at the end of a path through glass.
    Refraction(Generator),
    ZeroScale,
    NegativeScale,
    BitPatterns,
    Power,
    OddLights,
    Mirrors,
    FacingMirrors,
    Transforms,
}

/// One case of a class.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// What distinguishes it within its class; empty where it is alone.
    pub label: &'static str,
    pub kind: Kind,
    /// What fast, robust and double promise.
    pub targets: [Target; 3],
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

/// No wrong ray beyond the tier's band around the tangent, and a 99.9th percentile of the error.
fn exact(p999: f64) -> Target {
    limits(&[(Quantity::WrongBeyondBand, 0.0), (Quantity::P999, p999)])
}

/// No wrong ray beyond the band.
fn right() -> Target {
    limits(&[(Quantity::WrongBeyondBand, 0.0)])
}

fn wrong(ppm: f64) -> Target {
    limits(&[(Quantity::Wrong, ppm)])
}

fn same(target: Target) -> [Target; 3] {
    [target.clone(), target.clone(), target]
}

/// The classes, in the order of their numbers.
#[allow(clippy::too_many_lines, reason = "a table")]
pub fn classes() -> Vec<Class> {
    use Quantity::{Acne, Differing, Inversions, Leaks, Misclassified, P999, PowerError, Wrong, WrongBeyondBand};
    let flag = || Target::NotCovered;
    let rays = |label, generator: Generator, targets| Case { label, kind: Kind::Rays(generator), targets };
    let lit = |label, generator: LitGenerator| {
        let target = limits(&[(Wrong, 0.0), (Acne, 0.0), (Leaks, 0.0)]);
        Case { label, kind: Kind::Lit(generator), targets: same(target) }
    };
    let glass = |label, generator: Generator, targets| Case { label, kind: Kind::Refraction(generator), targets };
    // Without f64, `double` bends rays like `robust`.
    let path = |fast, careful| [fast, careful, careful].map(|p999| limits(&[(Wrong, 10.0), (P999, p999)]));
    let special = |kind, targets| Case { label: "", kind, targets };
    let class = |id, name, about, counted, cases| Class { id, name, about, counted, cases };
    let none_differs = || same(limits(&[(Differing, 0.0)]));
    let thin = || [limits(&[(WrongBeyondBand, 1.0), (P999, 13.0)]), exact(2.5), exact(0.7)];
    let no_inversion = || limits(&[(Inversions, 0.0)]);
    vec![
        class(
            1,
            "ordinary",
            "unit spheres seen from five radii",
            "wrong, p99.9",
            vec![
                rays("eye", rays::ordinary_eye, [exact(3.0), exact(2.0), exact(0.7)]),
                rays("any origin", rays::ordinary, [exact(3.0), exact(2.0), exact(0.7)]),
            ],
        ),
        class(
            2,
            "secondary",
            "incoherent secondary rays among spheres of a box of 20",
            "wrong, p99.9",
            vec![rays("", rays::secondary, [limits(&[(WrongBeyondBand, 1.0), (P999, 8.0)]), exact(2.0), exact(0.7)])],
        ),
        class(
            3,
            "far",
            "tiny and far spheres",
            "wrong",
            vec![
                rays("eye 1e3", rays::far_3_eye, [wrong(10.0), right(), right()]),
                rays("eye 1e5", rays::far_5_eye, [wrong(2000.0), right(), right()]),
                rays("any origin 1e3", rays::far_3, [wrong(10.0), right(), right()]),
                rays("any origin 1e5", rays::far_5, [wrong(2000.0), right(), right()]),
                rays("any origin 1e7", rays::far_7, [flag(), right(), right()]),
            ],
        ),
        class(
            4,
            "earth",
            "the Earth from an eye at one metre, near the horizon",
            "wrong, p99.9",
            vec![rays("", rays::earth, [flag(), exact(3.0), exact(0.7)])],
        ),
        class(
            5,
            "near-surface",
            "origins 1e-7 to 1e-2 radii from the surface, in and out",
            "wrong, p99.9",
            vec![rays("", rays::near_surface, [flag(), exact(3.0), exact(1.0)])],
        ),
        class(
            6,
            "tangent",
            "1-l² from 1e-12 to 1e-2, either side",
            "largest misclassified |1-l²|",
            vec![
                rays(
                    "eye",
                    rays::tangent_eye,
                    [
                        limits(&[(Misclassified, 4e-7)]),
                        limits(&[(Misclassified, 2.5e-7)]),
                        limits(&[(Misclassified, 1e-9)]),
                    ],
                ),
                rays(
                    "any origin",
                    rays::tangent,
                    [
                        limits(&[(Misclassified, 4e-7)]),
                        limits(&[(Misclassified, 2.5e-7)]),
                        limits(&[(Misclassified, 1e-9)]),
                    ],
                ),
            ],
        ),
        class(
            7,
            "thin",
            "discs and needles",
            "wrong, p99.9",
            vec![
                rays("disc 1:1:1e-3", rays::disc, thin()),
                // Seen from 5e4 least semi-axes, beyond what `fast` covers (precision.rs): some 2 to 7 ppm are wrong.
                rays("needle 1e-2:1:100", rays::needle_eye, [flag(), exact(2.5), exact(0.7)]),
                rays("needle, any origin", rays::needle, [flag(), exact(2.5), exact(0.7)]),
                rays("1:1:1e-4 from 2e-4", rays::disc_from_near, thin()),
            ],
        ),
        class(
            8,
            "translated",
            "eye and sphere at 1e6 from the world's origin",
            "wrong, p99.9",
            vec![rays("", rays::translated, [exact(5.0), exact(2.0), right()])],
        ),
        class(
            9,
            "concentric",
            "nested surfaces with small gaps",
            "order inversions",
            vec![
                rays("gap 1e-5", rays::concentric_5, same(no_inversion())),
                rays("gap 1e-6", rays::concentric_6, [flag(), limits(&[(Inversions, 1000.0)]), no_inversion()]),
                rays("gap 1 ulp", rays::concentric_ulp, [flag(), flag(), no_inversion()]),
                rays("gap 0", rays::concentric_0, same(no_inversion())),
            ],
        ),
        class(
            10,
            "world-size",
            "the ordinary world, huge and tiny",
            "wrong, not finite",
            vec![
                rays("1e20", rays::size_1e20, same(right())),
                rays("1e-30", rays::size_1em30, same(right())),
                rays("1e-38", rays::size_1em38, same(right())),
            ],
        ),
        class(11, "inside", "eyes inside a sphere", "wrong", vec![rays("", rays::from_inside, same(right()))]),
        class(
            12,
            "image-plane",
            "spheres cut or touched by the image plane",
            "wrong",
            vec![rays("cut", rays::cut, same(right())), rays("touching", rays::touching, same(wrong(0.0)))],
        ),
        class(
            13,
            "zero-scale",
            "a scale of zero is an error that names its line",
            "differing",
            vec![special(Kind::ZeroScale, none_differs())],
        ),
        class(
            14,
            "negative-scale",
            "a negative scale means its absolute value, bit for bit",
            "differing",
            vec![special(Kind::NegativeScale, none_differs())],
        ),
        class(
            15,
            "bit-patterns",
            "NaN, infinities and denormals in every input",
            "not finite",
            vec![special(Kind::BitPatterns, same(limits(&[])))],
        ),
        class(
            16,
            "odd-lights",
            "lights on the surface, inside, behind, at the hit point",
            "not finite, differing",
            vec![special(Kind::OddLights, none_differs())],
        ),
        class(
            17,
            "terminator",
            "light from 1e-5 to 1 above or below the horizon",
            "acne, leaks",
            vec![lit("", rays::terminator)],
        ),
        class(
            18,
            "contact",
            "small blockers in contact with what they shade",
            "acne, leaks",
            vec![
                lit("gap 0", rays::contact_0),
                lit("gap 1e-7", rays::contact_7),
                lit("gap -1e-7", rays::interpenetrating),
            ],
        ),
        class(
            19,
            "power",
            "specular exponents from 0 to 1e5",
            "error of the power, not finite",
            vec![special(Kind::Power, same(limits(&[(PowerError, 2e-7)])))],
        ),
        class(
            20,
            "mirrors",
            "Kr = 1 and beyond, intensity beyond 1",
            "not finite, energy",
            vec![special(Kind::Mirrors, none_differs())],
        ),
        class(
            21,
            "facing-mirrors",
            "where f32 and f64 paths part: conditioning, not a bug",
            "bounce",
            vec![special(Kind::FacingMirrors, same(Target::Reported))],
        ),
        class(
            22,
            "transforms",
            "error-free sums and products of 262,144 pairs on the device",
            "residuals lost",
            vec![special(
                Kind::Transforms,
                [Target::NotApplicable, limits(&[(Differing, 0.0)]), Target::NotApplicable],
            )],
        ),
        class(
            23,
            "refraction",
            "paths through glass: in and out, beyond the critical angle, from wall to wall",
            "wrong, p99.9",
            vec![
                glass("balls", rays::glass_balls, path(5.0, 5.0)),
                glass("eta 1 + 2^-20", rays::thin_air, path(3.0, 3.0)),
                glass("ellipsoids", rays::glass_ellipsoids, path(16.0, 6.0)),
                glass("bubbles", rays::bubbles, path(4.0, 4.0)),
                glass("diamonds", rays::diamonds, path(250.0, 200.0)),
            ],
        ),
    ]
}

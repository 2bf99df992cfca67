//! The known mistakes and other conventions: names, explanations, and how each changes a picture.
//!
//! Of causes that give the same picture the first in the table is named.

use super::rules::{
    AmbientCount, Behind, Clamp, Fading, Mirror, Near, NegativeCosine, Normal, Shadow, SpecularFactor, ToLight,
    ToViewer, Winner,
};
use super::variant::{Beyond, Border, Curve, Layout, Variant};
use crate::scene::Scene;
use crate::settings::{Convention, Specular};

/// A known mistake or other convention.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The name, in kebab case: a stable interface.
    pub name: &'static str,
    /// What it is, in one line.
    pub line: &'static str,
    pub(super) changes: Changes,
}

/// How a cause changes a picture.
#[derive(Clone, Copy)]
pub(super) enum Changes {
    /// In these ways, without looking at the pixels.
    Known(fn(&Right, &mut Ways)),
    /// In a way that has to be found from the pixels.
    Fitted,
}

impl std::fmt::Debug for Changes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Known(_) => "known",
            Self::Fitted => "fitted",
        })
    }
}

/// What is right: the scene, and the variant that follows every rule.
#[derive(Debug)]
pub(super) struct Right<'a> {
    pub scene: &'a Scene,
    pub variant: &'a Variant,
    /// With effects that are left out, by their names.
    pub left_out: &'a [(String, Variant)],
    /// The picture that is to be explained has another size.
    pub other_size: Option<[u32; 2]>,
    /// A unit of length of the file.
    pub unit: f64,
}

/// One way in which a cause may change a picture.
pub(super) struct Way {
    pub name: &'static str,
    pub detail: String,
    pub apply: Box<dyn Fn(&mut Variant) + Send + Sync>,
}

/// The ways of one cause.
pub(super) struct Ways {
    name: &'static str,
    ways: Vec<Way>,
}

impl Ways {
    fn add(&mut self, detail: impl Into<String>, apply: impl Fn(&mut Variant) + Send + Sync + 'static) {
        self.ways.push(Way { name: self.name, detail: detail.into(), apply: Box::new(apply) });
    }

    fn plain(&mut self, apply: impl Fn(&mut Variant) + Send + Sync + 'static) {
        self.add("", apply);
    }
}

/// All ways of all causes that need no fitting, in the order of the table.
pub(super) fn ways(right: &Right) -> Vec<Way> {
    let mut all = Vec::new();
    for Known { name, changes, .. } in CAUSES {
        if let Changes::Known(changes) = changes {
            let mut ways = Ways { name, ways: Vec::new() };
            changes(right, &mut ways);
            all.append(&mut ways.ways);
        }
    }
    all
}

/// The place of a cause in the table.
pub(super) fn rank(name: &str) -> usize {
    CAUSES.iter().position(|known| known.name == name).unwrap_or(CAUSES.len())
}

const fn known(name: &'static str, line: &'static str, changes: fn(&Right, &mut Ways)) -> Known {
    Known { name, line, changes: Changes::Known(changes) }
}

const fn fitted(name: &'static str, line: &'static str) -> Known {
    Known { name, line, changes: Changes::Fitted }
}

/// A cause that changes one rule in one way.
macro_rules! rule {
    ($name:literal, $line:literal, $($rule:ident).+ = $value:expr) => {
        known($name, $line, |_, ways| ways.plain(|v| v.rules.$($rule).+ = $value))
    };
}

/// Ways of two kinds: where a ray that leaves a sphere from outside never meets it again, and where it may.
fn with_and_without_own(ways: &mut Ways, detail: &str, apply: impl Fn(&mut Variant) + Send + Sync + Copy + 'static) {
    ways.add(detail, apply);
    ways.add(detail, move |v| {
        apply(v);
        v.rules.own_from_outside = true;
    });
}

/// A curve of colours, or of levels that are truncated or rounded after it.
fn with_curve(ways: &mut Ways, detail: &str, curve: Curve) {
    ways.add(detail, move |v| v.encoding.curve = curve);
    for (bias, how) in [(0.0, "truncated"), (0.5, "rounded")] {
        ways.add(format!("{detail} on levels, {how}").trim_start().to_owned(), move |v| {
            (v.encoding.curve, v.encoding.curve_on_levels) = (curve, Some(bias));
        });
    }
}

/// All known causes, the likelier first.
pub const CAUSES: &[Known] = &[
    known("effects-left-out", "the picture has effects that --effects leaves out of the reference", |right, ways| {
        for (names, whole) in right.left_out {
            let whole = whole.clone();
            ways.add(names, move |v| v.simulate(&whole));
        }
    }),
    // Levels.
    known(
        "other-convention",
        "the other convention as a whole: classic for exact, or exact for classic",
        |right, ways| {
            let rules = &right.variant.rules;
            for (convention, name) in [(Convention::Exact, "exact"), (Convention::Classic, "classic")] {
                let settings = convention.settings();
                let unit = right.unit;
                let is_used = rules.offset == settings.sampling.offset()
                    && right.variant.encoding.bias == settings.quantize.bias()
                    && right.variant.encoding.scale == settings.quantize.scale();
                if !is_used {
                    ways.add(format!("{name}: sample, levels and epsilon"), move |v| {
                        v.rules.offset = settings.sampling.offset();
                        v.rules.shadow_range.0 = settings.secondary.shadow;
                        v.rules.reflection_epsilon = settings.secondary.reflection * unit;
                        (v.encoding.scale, v.encoding.bias) = (settings.quantize.scale(), settings.quantize.bias());
                    });
                }
            }
        },
    ),
    known("levels-rounded", "255·c is rounded to the nearest level", |_, ways| {
        ways.plain(|v| (v.encoding.scale, v.encoding.bias) = (255.0, 0.5));
    }),
    known("levels-truncated", "255·c is truncated to a level", |_, ways| {
        ways.plain(|v| (v.encoding.scale, v.encoding.bias) = (255.0, 0.0));
    }),
    known("levels-times-255-9", "255.9·c is truncated to a level", |_, ways| {
        ways.plain(|v| (v.encoding.scale, v.encoding.bias) = (255.9, 0.0));
    }),
    known("levels-times-256", "256·c, or a little less, is truncated to a level, 255 at the most", |_, ways| {
        for scale in [256.0, 255.99, 255.999] {
            ways.add(format!("{scale}·c"), move |v| (v.encoding.scale, v.encoding.bias) = (scale, 0.0));
        }
    }),
    known("levels-times-254", "254·c, or 255·c of a smaller range, is a level", |_, ways| {
        ways.add("254, truncated", |v| (v.encoding.scale, v.encoding.bias) = (254.0, 0.0));
        ways.add("254, rounded", |v| (v.encoding.scale, v.encoding.bias) = (254.0, 0.5));
    }),
    known("levels-rounded-up", "255·c is rounded up to a level", |_, ways| {
        ways.plain(|v| (v.encoding.scale, v.encoding.bias) = (255.0, 1.0 - 1e-9));
    }),
    known(
        "levels-wrapped",
        "colours above 1 are not clamped: their levels begin again at 0 (modulo 256)",
        |_, ways| {
            ways.plain(|v| v.encoding.beyond = Beyond::Wrapped);
            ways.add("256·c, so that white is black", |v| {
                (v.encoding.scale, v.encoding.bias, v.encoding.beyond) = (256.0, 0.0, Beyond::Wrapped);
            });
        },
    ),
    known("over-one-black", "colours above 1 are not clamped but become 0", |_, ways| {
        ways.plain(|v| v.encoding.beyond = Beyond::Black);
    }),
    known("over-one-divided", "colours above 1 are divided by their greatest channel instead of clamped", |_, ways| {
        ways.plain(|v| v.encoding.beyond = Beyond::Divided);
    }),
    known("over-one-white", "a colour with one channel above 1 becomes white", |_, ways| {
        ways.plain(|v| v.encoding.beyond = Beyond::White);
    }),
    known("gamma-srgb", "colours are encoded with the curve of sRGB", |_, ways| with_curve(ways, "", Curve::Srgb)),
    known("gamma-2-2", "colours are encoded with gamma 2.2, or another power", |_, ways| {
        for gamma in [2.2, 2.0, 1.8, 2.4] {
            with_curve(ways, &format!("gamma {gamma}"), Curve::Gamma(gamma));
        }
    }),
    known("gamma-decoded", "colours are decoded with gamma: darker instead of brighter", |_, ways| {
        for gamma in [2.2, 2.0] {
            with_curve(ways, &format!("gamma 1/{gamma}"), Curve::Gamma(1.0 / gamma));
        }
    }),
    known("channels-swapped", "red, green and blue are written in another order", |_, ways| {
        let orders =
            [("BGR", [2, 1, 0]), ("GRB", [1, 0, 2]), ("RBG", [0, 2, 1]), ("GBR", [1, 2, 0]), ("BRG", [2, 0, 1])];
        for (name, channels) in orders {
            ways.add(format!("{name} for RGB"), move |v| v.encoding.channels = channels);
        }
    }),
    // Samples.
    known("sample-at-center", "samples lie at the pixels' centres", |_, ways| {
        ways.plain(|v| v.rules.offset = (0.5, 0.5));
    }),
    known("sample-at-corner", "samples lie at the pixels' top left corners", |_, ways| {
        ways.plain(|v| v.rules.offset = (0.0, 0.0));
    }),
    known("sample-at-bottom-left", "samples lie at the pixels' bottom left corners", |_, ways| {
        ways.plain(|v| v.rules.offset = (0.0, 1.0));
    }),
    known(
        "edge-to-edge",
        "columns and rows are divided by N − 1: the last ones lie on the window's edge",
        |_, ways| {
            ways.plain(|v| (v.rules.edge_to_edge, v.rules.offset) = (true, (0.0, 0.0)));
            ways.add("with samples where they are", |v| v.rules.edge_to_edge = true);
        },
    ),
    // Layout.
    known("flipped-vertically", "rows are written from bottom to top", |_, ways| {
        ways.plain(|v| v.layout.upside_down = true);
        ways.add("rendered so: row N − j", |v| {
            (v.layout.upside_down, v.layout.shift) = (true, [0, 1]);
        });
    }),
    known("flipped-horizontally", "columns are written from right to left", |_, ways| {
        ways.plain(|v| v.layout.mirrored = true);
        ways.add("rendered so: column N − i", |v| {
            (v.layout.mirrored, v.layout.shift) = (true, [1, 0]);
        });
    }),
    known("rotated-180", "rows from bottom to top and columns from right to left", |_, ways| {
        ways.plain(|v| (v.layout.upside_down, v.layout.mirrored) = (true, true));
    }),
    known("size-swapped", "width and height of RES are exchanged: the whole window in that size", |right, ways| {
        let [width, height] = right.variant.size;
        if right.other_size == Some([height, width]) {
            ways.plain(move |v| v.size = [height, width]);
        }
    }),
    known("transposed", "rows and columns are exchanged", |_, ways| {
        ways.add("about the main diagonal", |v| v.layout.transposed = true);
        ways.add("about the other diagonal", |v| {
            v.layout = Layout { transposed: true, mirrored: true, upside_down: true, ..v.layout };
        });
    }),
    known("rotated-90", "the picture is turned by a quarter", |_, ways| {
        ways.add("clockwise", |v| (v.layout.transposed, v.layout.mirrored) = (true, true));
        ways.add("anticlockwise", |v| (v.layout.transposed, v.layout.upside_down) = (true, true));
    }),
    known("written-by-columns", "pixels are written column after column into rows", |_, ways| {
        ways.plain(|v| v.layout.by_columns = true);
    }),
    known("sample-at-right", "samples lie at the pixels' right corners", |_, ways| {
        ways.add("top right", |v| v.rules.offset = (1.0, 0.0));
        ways.add("bottom right", |v| v.rules.offset = (1.0, 1.0));
    }),
    known("sample-at-edge-center", "samples lie at the middle of one of the pixels' edges", |_, ways| {
        for (name, offset) in [("left", (0.0, 0.5)), ("top", (0.5, 0.0)), ("right", (1.0, 0.5)), ("bottom", (0.5, 1.0))]
        {
            ways.add(name, move |v| v.rules.offset = offset);
        }
    }),
    known("shifted", "the picture is moved by a few pixels", |_, ways| {
        for distance in 1..=4_i64 {
            for (dx, dy) in (-distance..=distance).flat_map(|dx| (-distance..=distance).map(move |dy| (dx, dy))) {
                if dx.abs().max(dy.abs()) != distance {
                    continue;
                }
                for border in [Border::Black, Border::Repeated, Border::Wrapped, Border::Rendered] {
                    let detail = format!("{dx} to the right, {dy} down; beyond the edge {}", border.name());
                    ways.add(detail, move |v| (v.layout.shift, v.layout.border) = ([dx, dy], border));
                }
            }
        }
    }),
    known("size-off-by-one", "the picture has a row or column too many or too few", |right, ways| {
        let [width, height] = right.variant.size;
        let Some(shown) = right.other_size else { return };
        if shown[0].abs_diff(width) > 2 || shown[1].abs_diff(height) > 2 {
            return;
        }
        for shift in [[0, 0], [-1, 0], [0, -1], [-1, -1], [1, 0], [0, 1], [1, 1]] {
            for border in [Border::Rendered, Border::Black, Border::Repeated] {
                let detail = "rows or columns added or left out at the edge";
                ways.add(detail, move |v| (v.layout.shift, v.layout.border) = (shift, border));
            }
        }
        ways.add("rendered in that size", move |v| v.size = shown);
        ways.add("rendered in that size, edge to edge", move |v| (v.size, v.rules.edge_to_edge) = (shown, true));
    }),
    // Ambient, diffuse and specular light.
    rule!("ambient-missing", "the ambient term is missing", ambient = AmbientCount::Times(0.0)),
    rule!("ambient-per-light", "the ambient term is added once for each light", ambient = AmbientCount::PerLight),
    rule!("ambient-doubled", "the ambient term is added twice", ambient = AmbientCount::Times(2.0)),
    rule!(
        "ambient-per-unblocked-light",
        "the ambient term is added for each light that is not blocked: none in the shadow",
        ambient = AmbientCount::PerUnblockedLight
    ),
    rule!("ambient-without-ka", "the ambient term is not multiplied by Ka", ambient_takes_ka = false),
    rule!(
        "ambient-without-color",
        "the ambient term is not multiplied by the object's colour",
        ambient_takes_color = false
    ),
    rule!("diffuse-missing", "the diffuse term is missing", diffuse = 0.0),
    rule!("specular-missing", "the specular term is missing", highlights = 0.0),
    known("specular-blinn", "(N·H)ⁿ in place of (R·V)ⁿ", |_, ways| {
        ways.plain(|v| v.rules.specular = Specular::Blinn);
    }),
    known("specular-phong", "(R·V)ⁿ in place of (N·H)ⁿ", |_, ways| {
        ways.plain(|v| v.rules.specular = Specular::Phong);
    }),
    known("specular-not-clamped", "R·V is not clamped at 0: its even powers shine", |_, ways| {
        ways.add("negative powers kept", |v| v.rules.negative_cosine = NegativeCosine::Kept);
        ways.add("|R·V|", |v| v.rules.negative_cosine = NegativeCosine::Absolute);
    }),
    rule!(
        "specular-times-color",
        "the specular term is multiplied by the object's colour",
        specular_factor = SpecularFactor::ObjectColor
    ),
    rule!("specular-times-n-dot-l", "the specular term is multiplied by N·L", specular_factor = SpecularFactor::NDotL),
    rule!("specular-times-kd", "the specular term is multiplied by Kd", specular_factor = SpecularFactor::Kd),
    rule!(
        "specular-without-light",
        "the specular term does not have the light's intensity",
        specular_takes_light = false
    ),
    known("specular-behind", "lights below the surface still add a specular term", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.behind = Behind::SpecularStays);
    }),
    known("n-dot-l-not-clamped", "N·L is not clamped at 0: lights below the surface subtract", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.behind = Behind::Subtracts);
    }),
    known("two-sided-light", "|N·L|: lights below the surface shine as if above", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.behind = Behind::TwoSided);
        with_and_without_own(ways, "in R, too", |v| v.rules.behind = Behind::TwoSidedInR);
    }),
    known("exponent-wrong", "another specular exponent: off by one, halved, doubled, squared, ignored", |_, ways| {
        for (detail, exponent) in [
            ("n + 1", (1.0, 1.0)),
            ("n − 1", (1.0, -1.0)),
            ("n/2", (0.5, 0.0)),
            ("2n", (2.0, 0.0)),
            ("n/4", (0.25, 0.0)),
            ("4n", (4.0, 0.0)),
            ("1", (0.0, 1.0)),
            ("0", (0.0, 0.0)),
            ("3n", (3.0, 0.0)),
            ("n/3", (1.0 / 3.0, 0.0)),
            ("n/10", (0.1, 0.0)),
            ("10n", (10.0, 0.0)),
            ("128n", (128.0, 0.0)),
            ("n + 2", (1.0, 2.0)),
            ("n − 2", (1.0, -2.0)),
        ] {
            ways.add(format!("{detail} for n"), move |v| v.rules.exponent = exponent);
        }
    }),
    // Normals and vectors.
    known("normal-from-center", "the normal is P − p, not divided by s²", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.normal = Normal::FromCenter);
    }),
    known("normal-in-object-space", "the normal is (P − p)/s, divided by s only once", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.normal = Normal::ObjectSpace);
    }),
    known("normal-not-normalized", "the normal is not brought to unit length", |_, ways| {
        with_and_without_own(ways, "(P − p)/s²", |v| v.rules.normal = Normal::RawInverseTranspose);
        with_and_without_own(ways, "P − p", |v| v.rules.normal = Normal::RawFromCenter);
        with_and_without_own(ways, "(P − p)/s", |v| v.rules.normal = Normal::RawObjectSpace);
    }),
    known("normal-not-flipped", "the normal of an inner wall points outwards", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.flipped_inside = false);
    }),
    known("light-not-normalized", "the vector to the light is not brought to unit length", |_, ways| {
        ways.add("", |v| v.rules.to_light = ToLight::Raw);
        ways.add("in N·L alone", |v| v.rules.to_light = ToLight::RawInDiffuse);
        ways.add("in the specular term alone", |v| v.rules.to_light = ToLight::RawInSpecular);
    }),
    known("light-directional", "lights shine in one direction, that from the origin", |_, ways| {
        with_and_without_own(ways, "", |v| v.rules.to_light = ToLight::FromOrigin);
    }),
    known("light-fades", "lights fade with the distance", |_, ways| {
        ways.add("1/d", |v| v.rules.fading = Fading::Distance);
        ways.add("1/d²", |v| v.rules.fading = Fading::DistanceSquared);
    }),
    known("view-vector-wrong", "the vector to the viewer is not that against the ray, of unit length", |_, ways| {
        ways.add("to the eye, in mirrors too", |v| v.rules.to_viewer = ToViewer::ToEye);
        ways.add("along +Z", |v| v.rules.to_viewer = ToViewer::AlongZ);
        ways.add("not normalised", |v| v.rules.to_viewer = ToViewer::Raw);
    }),
    // Geometry.
    rule!("near-plane-inclusive", "a hit just on the image plane counts: τ ≥ 1 for τ > 1", near = Near::AtLeast),
    known("near-plane-missing", "hits before the image plane count", |_, ways| {
        ways.plain(|v| v.rules.near = Near::Ignored);
    }),
    rule!("cut-sphere-missing", "a sphere that the image plane cuts is not drawn at all", cut_spheres = false),
    rule!(
        "inner-wall-missing",
        "a ray whose first hit lies before the image plane misses the sphere",
        far_root = false
    ),
    rule!("near-plane-by-distance", "hits count beyond distance 1, for a normalised ray", near = Near::OneUnitAway),
    rule!("near-ignored", "the image plane lies at distance 1, not at NEAR", near_is_one = true),
    known(
        "nearest-not-chosen",
        "not the nearest sphere is seen, but the first or last of the file that the ray meets",
        |_, ways| {
            ways.add("the last", |v| v.rules.winner = Winner::LastInFile);
            ways.add("the first", |v| v.rules.winner = Winner::FirstInFile);
        },
    ),
    known("scale-as-radius", "ellipsoids are drawn as spheres", |right, ways| {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            if right.scene.spheres.len() > 1000 {
                return;
            }
            ways.add(format!("the semi-axis along {name} as radius"), move |v| {
                let world = std::sync::Arc::make_mut(&mut v.world);
                for index in 0..world.bodies.len() {
                    let sphere = world.bodies[index].material;
                    world.bodies[index].shape =
                        crate::geometry::Ellipsoid::with_axes(sphere.center, glam::DVec3::splat(sphere.scale[axis]));
                }
                world.rebuild();
            });
        }
    }),
    // Shadows.
    rule!("no-own-shadow", "a sphere never blocks the light of its own points", own_blocks = false),
    rule!("no-shadows", "nothing blocks light", shadow = Shadow::None),
    known("blockers-beyond-light", "spheres beyond a light block it, too", |_, ways| {
        ways.plain(|v| v.rules.shadow_range.1 = f64::INFINITY);
    }),
    known("blockers-behind-point", "spheres on the other side of the lit point block light, too", |_, ways| {
        ways.plain(|v| v.rules.shadow_range.0 = f64::NEG_INFINITY);
    }),
    rule!("shadow-near-wall-only", "the far wall of a sphere does not block light", far_root_blocks = false),
    rule!("cut-part-lets-light-pass", "what the image plane cuts away does not block light", cut_part_blocks = false),
    rule!("no-shadows-in-mirrors", "points that mirrors show have no shadows", shadows_in_mirrors = false),
    rule!("shadow-of-any-light", "one blocked light takes away all lights", shadow = Shadow::AllLights),
    rule!("shadow-without-ambient", "a blocked light takes away the ambient term, too", shadow = Shadow::Everything),
    rule!("shadow-keeps-specular", "a blocked light still adds its specular term", shadow = Shadow::DiffuseOnly),
    rule!("shadow-keeps-diffuse", "a blocked light still adds its diffuse term", shadow = Shadow::SpecularOnly),
    known("shadow-epsilon-large", "blockers near a point are missed", |_, ways| {
        for part in [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.9] {
            ways.add(format!("those within {part} of the way to the light"), move |v| v.rules.shadow_range.0 = part);
        }
        for distance in [0.001, 0.01, 0.05, 0.1, 0.2, 0.5, 1.0] {
            ways.add(format!("those within a distance of {distance}"), move |v| {
                v.rules.shadow_distance = Some(distance);
            });
        }
    }),
    known(
        "epsilon-small",
        "surfaces that touch the one that a shadow or reflection ray leaves are met",
        |right, ways| {
            let unit = right.unit;
            for epsilon in [0.0, 1e-9, 1e-6, 1e-5, 1e-4] {
                ways.add(format!("epsilon {epsilon:e}"), move |v| {
                    (v.rules.shadow_range.0, v.rules.reflection_epsilon) = (epsilon, epsilon * unit);
                });
                ways.add(format!("epsilon {epsilon:e} of shadow rays"), move |v| v.rules.shadow_range.0 = epsilon);
                ways.add(format!("epsilon {epsilon:e} of reflection rays"), move |v| {
                    v.rules.reflection_epsilon = epsilon * unit;
                });
            }
        },
    ),
    // Reflections.
    rule!("no-reflections", "nothing is reflected", depth = 0),
    known("reflection-depth", "another number of bounces", |right, ways| {
        let right = right.variant.rules.depth;
        let mut depths: Vec<u32> = (1..=10).filter(|&depth| depth != right).collect();
        depths.sort_by_key(|depth| depth.abs_diff(right));
        for depth in depths {
            ways.add(format!("{depth} for {right}"), move |v| v.rules.depth = depth);
        }
    }),
    rule!("back-in-mirrors", "a reflection ray that meets nothing shows BACK, not black", back_in_mirrors = true),
    known("colors-clamped-within", "colours are clamped on the way, not once at the end", |_, ways| {
        ways.add("what is reflected", |v| v.rules.clamp = Clamp::Reflected);
        ways.add("every colour", |v| v.rules.clamp = Clamp::EveryColor);
    }),
    rule!("kr-ignored", "reflected colours are not multiplied by Kr", mirror = Mirror::Unweighted),
    rule!("kr-blended", "(1 − Kr)·local + Kr·reflected", mirror = Mirror::Blended),
    rule!(
        "reflection-times-color",
        "reflected colours are multiplied by the object's colour",
        mirror = Mirror::Colored
    ),
    rule!("reflection-times-ks", "reflected colours are multiplied by Ks, not Kr", mirror = Mirror::ByKs),
    known("reflection-epsilon-large", "reflected surfaces near a mirror are missed", |right, ways| {
        let unit = right.unit;
        for distance in [0.01, 0.05, 0.1, 0.2, 0.5] {
            ways.add(format!("those within {distance}"), move |v| v.rules.reflection_epsilon = distance * unit);
        }
    }),
    known("near-plane-in-mirrors", "reflected hits count beyond distance 1 alone, as from the eye", |right, ways| {
        let unit = right.unit;
        ways.plain(move |v| v.rules.reflection_epsilon = unit);
    }),
    // The scene.
    known("background-missing", "the background is black", |_, ways| {
        ways.plain(|v| std::sync::Arc::make_mut(&mut v.world).background = glam::DVec3::ZERO);
    }),
    known("light-missing", "a light is missing", |right, ways| {
        for index in 0..right.scene.lights.len().min(32) {
            ways.add(right.scene.light_names.in_words("light", index), move |v| {
                std::sync::Arc::make_mut(&mut v.world).lights[index].intensity = glam::DVec3::ZERO;
            });
        }
    }),
    known("lights-but-one-missing", "all lights but one are missing", |right, ways| {
        let count = right.scene.lights.len();
        for index in (0..count.min(32)).filter(|_| count > 2) {
            ways.add(format!("all but {}", right.scene.light_names.in_words("light", index)), move |v| {
                let lights = std::sync::Arc::make_mut(&mut v.world).lights.iter_mut().enumerate();
                lights.filter(|(other, _)| *other != index).for_each(|(_, light)| light.intensity = glam::DVec3::ZERO);
            });
        }
    }),
    fitted("sphere-missing", "a sphere is missing"),
    fitted("light-intensity", "a light has another intensity"),
    fitted("ambient-intensity", "the ambient light has another intensity"),
    fitted("background-color", "the background has another colour"),
    fitted("sphere-color", "a sphere has another colour"),
    fitted("sphere-material", "a sphere has another Ka, Kd, Ks, Kr or n"),
    fitted("sphere-moved", "a sphere is elsewhere"),
    fitted("sphere-scaled", "a sphere has other semi-axes"),
    fitted("light-moved", "a light is elsewhere"),
    fitted(
        "shadow-acne",
        "specks: points lie in the shadow of their own surface, since the epsilon is too small for the arithmetic",
    ),
];

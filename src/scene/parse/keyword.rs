//! The statements of the format: their keywords, their fields, and which of them was probably meant.

use super::number::parse_number;
use crate::words::slips;

/// The fields of a `SPHERE` line after its name, `Kt` and `eta` included: the most that any statement has.
pub(super) const MAX_FIELDS: usize = 16;

/// The first word of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Keyword {
    Near,
    Left,
    Right,
    Bottom,
    Top,
    Res,
    Sphere,
    Light,
    Back,
    Ambient,
    Output,
}

/// What follows a keyword.
pub(in super::super) struct Form {
    /// Whether a name comes first.
    pub(super) named: bool,
    pub(in super::super) fields: &'static [Field],
    /// How many fields may be left out at the end, all or none.
    pub(super) optional: usize,
}

/// One number of a statement.
pub(in super::super) struct Field {
    /// As it is called in the documentation of the format.
    pub(in super::super) name: &'static str,
    pub(super) about: &'static str,
    pub(in super::super) rule: Rule,
}

/// Which numbers a field takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Rule {
    /// All finite ones.
    Any,
    /// Not 0.
    NonZero,
    /// Greater than 0.
    Positive,
    /// At least 0.
    NotNegative,
    /// A whole number of pixels, at least 1.
    Pixels,
    /// Usually 0 to 1.
    Color,
    /// Usually 0 to 1.
    Coefficient,
    /// Usually at least 0, and no level of 255.
    Intensity,
}

impl Rule {
    /// Whether a finite number is one of them.
    pub(in super::super) fn takes(self, number: f64) -> bool {
        match self {
            Self::NonZero => number != 0.0,
            Self::Positive => number > 0.0,
            Self::NotNegative => number >= 0.0,
            Self::Any | Self::Pixels | Self::Color | Self::Coefficient | Self::Intensity => true,
        }
    }

    /// What a number that is none of them should have been.
    pub(in super::super) fn expected(self) -> &'static str {
        match self {
            Self::NonZero => "expected a number other than 0",
            Self::Positive => "expected a number greater than 0",
            Self::NotNegative => "expected 0 or a number greater than 0",
            Self::Any | Self::Pixels | Self::Color | Self::Coefficient | Self::Intensity => "expected a finite number",
        }
    }
}

const fn field(name: &'static str, about: &'static str, rule: Rule) -> Field {
    Field { name, about, rule }
}

const NEAR: &[Field] = &[field("n", "the distance of the image plane", Rule::Positive)];
const LEFT: &[Field] = &[field("l", "x of the window's left edge", Rule::Any)];
const RIGHT: &[Field] = &[field("r", "x of the window's right edge", Rule::Any)];
const BOTTOM: &[Field] = &[field("b", "y of the window's bottom edge", Rule::Any)];
const TOP: &[Field] = &[field("t", "y of the window's top edge", Rule::Any)];
const RES: &[Field] =
    &[field("x", "the number of columns", Rule::Pixels), field("y", "the number of rows", Rule::Pixels)];
const SPHERE: &[Field; MAX_FIELDS] = &[
    field("px", "x of the centre", Rule::Any),
    field("py", "y of the centre", Rule::Any),
    field("pz", "z of the centre", Rule::Any),
    field("sx", "the scale along x", Rule::NonZero),
    field("sy", "the scale along y", Rule::NonZero),
    field("sz", "the scale along z", Rule::NonZero),
    field("r", "the red of the colour", Rule::Color),
    field("g", "the green of the colour", Rule::Color),
    field("b", "the blue of the colour", Rule::Color),
    field("Ka", "the ambient coefficient", Rule::Coefficient),
    field("Kd", "the diffuse coefficient", Rule::Coefficient),
    field("Ks", "the specular coefficient", Rule::Coefficient),
    field("Kr", "the reflection coefficient", Rule::Coefficient),
    field("n", "the specular exponent", Rule::NotNegative),
    field("Kt", "the transmission coefficient", Rule::Coefficient),
    field("eta", "the index of refraction", Rule::Positive),
];
const LIGHT: &[Field] = &[
    field("px", "x of the light", Rule::Any),
    field("py", "y of the light", Rule::Any),
    field("pz", "z of the light", Rule::Any),
    field("Ir", "the red of the intensity", Rule::Intensity),
    field("Ig", "the green of the intensity", Rule::Intensity),
    field("Ib", "the blue of the intensity", Rule::Intensity),
];
const BACK: &[Field] = &[
    field("r", "the red of the background", Rule::Color),
    field("g", "the green of the background", Rule::Color),
    field("b", "the blue of the background", Rule::Color),
];
const AMBIENT: &[Field] = &[
    field("Ir", "the red of the ambient intensity", Rule::Intensity),
    field("Ig", "the green of the ambient intensity", Rule::Intensity),
    field("Ib", "the blue of the ambient intensity", Rule::Intensity),
];

impl Form {
    const fn numbers(fields: &'static [Field]) -> Self {
        Self { named: false, fields, optional: 0 }
    }

    const fn named(fields: &'static [Field], optional: usize) -> Self {
        Self { named: true, fields, optional }
    }

    /// The fewest numbers that make the statement complete.
    pub(super) const fn least(&self) -> usize {
        self.fields.len() - self.optional
    }

    /// Whether so many numbers are as many as the statement takes.
    pub(super) const fn takes(&self, numbers: usize) -> bool {
        numbers == self.least() || numbers == self.fields.len()
    }
}

impl Keyword {
    /// In the order in which a file usually has them.
    pub(super) const ALL: [Self; 11] = [
        Self::Near,
        Self::Left,
        Self::Right,
        Self::Bottom,
        Self::Top,
        Self::Res,
        Self::Sphere,
        Self::Light,
        Self::Back,
        Self::Ambient,
        Self::Output,
    ];

    /// Those that have no default.
    pub(super) const REQUIRED: [Self; 6] = [Self::Near, Self::Left, Self::Right, Self::Bottom, Self::Top, Self::Res];

    pub(super) fn from_token(token: &[u8]) -> Option<Self> {
        // The one that fills large files first.
        if token == b"SPHERE" {
            return Some(Self::Sphere);
        }
        Self::ALL.into_iter().find(|keyword| keyword.text().as_bytes() == token)
    }

    pub(in super::super) const fn text(self) -> &'static str {
        match self {
            Self::Near => "NEAR",
            Self::Left => "LEFT",
            Self::Right => "RIGHT",
            Self::Bottom => "BOTTOM",
            Self::Top => "TOP",
            Self::Res => "RES",
            Self::Sphere => "SPHERE",
            Self::Light => "LIGHT",
            Self::Back => "BACK",
            Self::Ambient => "AMBIENT",
            Self::Output => "OUTPUT",
        }
    }

    pub(in super::super) const fn form(self) -> &'static Form {
        match self {
            Self::Near => const { &Form::numbers(NEAR) },
            Self::Left => const { &Form::numbers(LEFT) },
            Self::Right => const { &Form::numbers(RIGHT) },
            Self::Bottom => const { &Form::numbers(BOTTOM) },
            Self::Top => const { &Form::numbers(TOP) },
            Self::Res => const { &Form::numbers(RES) },
            Self::Sphere => const { &Form::named(SPHERE, 2) },
            Self::Light => const { &Form::named(LIGHT, 0) },
            Self::Back => const { &Form::numbers(BACK) },
            Self::Ambient => const { &Form::numbers(AMBIENT) },
            Self::Output => const { &Form::named(&[], 0) },
        }
    }

    /// How the statement is written, such as `LIGHT name px py pz Ir Ig Ib`.
    pub(super) fn usage(self) -> String {
        let form = self.form();
        let mut words = vec![self.text()];
        words.extend(form.named.then_some("name"));
        let (always, optional) = form.fields.split_at(form.least());
        words.extend(always.iter().map(|field| field.name));
        let mut usage = words.join(" ");
        if !optional.is_empty() {
            let names: Vec<_> = optional.iter().map(|field| field.name).collect();
            usage = format!("{usage} [{}]", names.join(" "));
        }
        usage
    }
}

/// What an unknown keyword may have been meant to be.
pub(super) struct Guess {
    pub(super) keyword: Option<Keyword>,
    pub(super) help: String,
}

/// Other shapes that scene files of this family name.
const SHAPES: [&[u8]; 16] = [
    b"BOX",
    b"CONE",
    b"CUBE",
    b"CYLINDER",
    b"DISC",
    b"DISK",
    b"ELLIPSOID",
    b"MESH",
    b"PLANE",
    b"POLYGON",
    b"QUAD",
    b"TETRA",
    b"TETRAHEDRON",
    b"TORUS",
    b"TRI",
    b"TRIANGLE",
];

/// Guesses what `token`, which is no keyword, was meant to be.
pub(super) fn guess(token: &[u8]) -> Guess {
    let upper = token.to_ascii_uppercase();
    if let Some(keyword) = Keyword::from_token(&upper) {
        let help = format!("keywords are upper case: write `{}`", keyword.text());
        return Guess { keyword: Some(keyword), help };
    }
    if SHAPES.contains(&upper.as_slice()) {
        let help = "only spheres are rendered; a SPHERE with three different scales is an ellipsoid";
        return Guess { keyword: None, help: help.to_owned() };
    }
    if let Some(keyword) = similar(&upper) {
        return Guess { keyword: Some(keyword), help: format!("did you mean `{}`?", keyword.text()) };
    }
    if parse_number(token).is_ok() {
        let help = "a statement is one line: does this line continue the one before?";
        return Guess { keyword: None, help: help.to_owned() };
    }
    let keywords = Keyword::ALL.map(Keyword::text).join(" ");
    Guess { keyword: None, help: format!("the keywords are {keywords}; `#` starts a comment") }
}

/// The keyword that `upper` begins with (`BACKGROUND`, `NEAR=1`) or that it is a slip away from.
fn similar(upper: &[u8]) -> Option<Keyword> {
    let begins = |keyword: &Keyword| upper.starts_with(keyword.text().as_bytes());
    let near = |keyword: Keyword| {
        let text = keyword.text();
        let most = if text.len() <= 4 { 1 } else { 2 };
        Some((slips(upper, text), keyword)).filter(|&(slips, _)| slips <= most)
    };
    let nearest = || Keyword::ALL.into_iter().filter_map(near).min_by_key(|&(slips, _)| slips);
    Keyword::ALL.into_iter().find(begins).or_else(|| nearest().map(|(_, keyword)| keyword))
}

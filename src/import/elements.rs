//! The chemical elements: radii and colours.
//!
//! * Van der Waals radii: A. Bondi, J. Phys. Chem. 68 (1964) 441, for the nonmetals that it lists; else S. Alvarez, Dalton Trans. 42
//!   (2013) 8617.
//! * Covalent radii: B. Cordero et al., Dalton Trans. (2008) 2832; carbon's is that of sp3.
//! * Colours: those of Jmol, an extension of the models of Corey, Pauling and Koltun.

#![allow(clippy::unreadable_literal, reason = "colours are written as `rrggbb`")]

use glam::DVec3;

use super::color::hex_color;

/// What is known of an element. Radii are in ångström.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Such as `He`.
    pub symbol: &'static str,
    /// Van der Waals radius.
    pub van_der_waals: Option<f64>,
    /// Covalent radius.
    pub covalent: Option<f64>,
    color: u32,
}

impl Element {
    /// The element of a symbol in upper or lower case, perhaps with a number or a charge behind it (`Fe2+`, `C12`), or of an atomic
    /// number.
    pub fn of(token: &[u8]) -> Option<&'static Self> {
        if token.iter().all(u8::is_ascii_digit) {
            let number: usize = str::from_utf8(token).ok()?.parse().ok()?;
            return ELEMENTS.get(number.checked_sub(1)?);
        }
        let letters = token.iter().position(|byte| !byte.is_ascii_alphabetic()).unwrap_or(token.len());
        let (symbol, rest) = token.split_at(letters);
        let is_charge = rest.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'+' | b'-'));
        let is_deuterium = symbol.eq_ignore_ascii_case(b"D");
        let symbol = if is_deuterium { b"H" } else { symbol };
        ELEMENTS.iter().find(|element| is_charge && element.symbol.as_bytes().eq_ignore_ascii_case(symbol))
    }

    /// Its colour, each part 0 to 1.
    pub fn color(&self) -> DVec3 {
        hex_color(self.color)
    }
}

const fn element(symbol: &'static str, van_der_waals: f64, covalent: f64, color: u32) -> Element {
    const fn known(radius: f64) -> Option<f64> {
        if radius.is_nan() { None } else { Some(radius) }
    }
    Element { symbol, van_der_waals: known(van_der_waals), covalent: known(covalent), color }
}

/// No value in the source.
const NONE: f64 = f64::NAN;

/// All elements by atomic number, from hydrogen.
pub const ELEMENTS: [Element; 118] = [
    element("H", 1.20, 0.31, 0xffffff),
    element("He", 1.40, 0.28, 0xd9ffff),
    element("Li", 2.12, 1.28, 0xcc80ff),
    element("Be", 1.98, 0.96, 0xc2ff00),
    element("B", 1.91, 0.84, 0xffb5b5),
    element("C", 1.70, 0.76, 0x909090),
    element("N", 1.55, 0.71, 0x3050f8),
    element("O", 1.52, 0.66, 0xff0d0d),
    element("F", 1.47, 0.57, 0x90e050),
    element("Ne", 1.54, 0.58, 0xb3e3f5),
    element("Na", 2.50, 1.66, 0xab5cf2),
    element("Mg", 2.51, 1.41, 0x8aff00),
    element("Al", 2.25, 1.21, 0xbfa6a6),
    element("Si", 2.10, 1.11, 0xf0c8a0),
    element("P", 1.80, 1.07, 0xff8000),
    element("S", 1.80, 1.05, 0xffff30),
    element("Cl", 1.75, 1.02, 0x1ff01f),
    element("Ar", 1.88, 1.06, 0x80d1e3),
    element("K", 2.73, 2.03, 0x8f40d4),
    element("Ca", 2.62, 1.76, 0x3dff00),
    element("Sc", 2.58, 1.70, 0xe6e6e6),
    element("Ti", 2.46, 1.60, 0xbfc2c7),
    element("V", 2.42, 1.53, 0xa6a6ab),
    element("Cr", 2.45, 1.39, 0x8a99c7),
    element("Mn", 2.45, 1.39, 0x9c7ac7),
    element("Fe", 2.44, 1.32, 0xe06633),
    element("Co", 2.40, 1.26, 0xf090a0),
    element("Ni", 2.40, 1.24, 0x50d050),
    element("Cu", 2.38, 1.32, 0xc88033),
    element("Zn", 2.39, 1.22, 0x7d80b0),
    element("Ga", 2.32, 1.22, 0xc28f8f),
    element("Ge", 2.29, 1.20, 0x668f8f),
    element("As", 1.85, 1.19, 0xbd80e3),
    element("Se", 1.90, 1.20, 0xffa100),
    element("Br", 1.85, 1.20, 0xa62929),
    element("Kr", 2.02, 1.16, 0x5cb8d1),
    element("Rb", 3.21, 2.20, 0x702eb0),
    element("Sr", 2.84, 1.95, 0x00ff00),
    element("Y", 2.75, 1.90, 0x94ffff),
    element("Zr", 2.52, 1.75, 0x94e0e0),
    element("Nb", 2.56, 1.64, 0x73c2c9),
    element("Mo", 2.45, 1.54, 0x54b5b5),
    element("Tc", 2.44, 1.47, 0x3b9e9e),
    element("Ru", 2.46, 1.46, 0x248f8f),
    element("Rh", 2.44, 1.42, 0x0a7d8c),
    element("Pd", 2.15, 1.39, 0x006985),
    element("Ag", 2.53, 1.45, 0xc0c0c0),
    element("Cd", 2.49, 1.44, 0xffd98f),
    element("In", 2.43, 1.42, 0xa67573),
    element("Sn", 2.42, 1.39, 0x668080),
    element("Sb", 2.47, 1.39, 0x9e63b5),
    element("Te", 2.06, 1.38, 0xd47a00),
    element("I", 1.98, 1.39, 0x940094),
    element("Xe", 2.16, 1.40, 0x429eb0),
    element("Cs", 3.48, 2.44, 0x57178f),
    element("Ba", 3.03, 2.15, 0x00c900),
    element("La", 2.98, 2.07, 0x70d4ff),
    element("Ce", 2.88, 2.04, 0xffffc7),
    element("Pr", 2.92, 2.03, 0xd9ffc7),
    element("Nd", 2.95, 2.01, 0xc7ffc7),
    element("Pm", NONE, 1.99, 0xa3ffc7),
    element("Sm", 2.90, 1.98, 0x8fffc7),
    element("Eu", 2.87, 1.98, 0x61ffc7),
    element("Gd", 2.83, 1.96, 0x45ffc7),
    element("Tb", 2.79, 1.94, 0x30ffc7),
    element("Dy", 2.87, 1.92, 0x1fffc7),
    element("Ho", 2.81, 1.92, 0x00ff9c),
    element("Er", 2.83, 1.89, 0x00e675),
    element("Tm", 2.79, 1.90, 0x00d452),
    element("Yb", 2.80, 1.87, 0x00bf38),
    element("Lu", 2.74, 1.87, 0x00ab24),
    element("Hf", 2.63, 1.75, 0x4dc2ff),
    element("Ta", 2.53, 1.70, 0x4da6ff),
    element("W", 2.57, 1.62, 0x2194d6),
    element("Re", 2.49, 1.51, 0x267dab),
    element("Os", 2.48, 1.44, 0x266696),
    element("Ir", 2.41, 1.41, 0x175487),
    element("Pt", 2.29, 1.36, 0xd0d0e0),
    element("Au", 2.32, 1.36, 0xffd123),
    element("Hg", 2.45, 1.32, 0xb8b8d0),
    element("Tl", 2.47, 1.45, 0xa6544d),
    element("Pb", 2.60, 1.46, 0x575961),
    element("Bi", 2.54, 1.48, 0x9e4fb5),
    element("Po", NONE, 1.40, 0xab5c00),
    element("At", NONE, 1.50, 0x754f45),
    element("Rn", NONE, 1.50, 0x428296),
    element("Fr", NONE, 2.60, 0x420066),
    element("Ra", NONE, 2.21, 0x007d00),
    element("Ac", 2.80, 2.15, 0x70abfa),
    element("Th", 2.93, 2.06, 0x00baff),
    element("Pa", 2.88, 2.00, 0x00a1ff),
    element("U", 2.71, 1.96, 0x008fff),
    element("Np", 2.82, 1.90, 0x0080ff),
    element("Pu", 2.81, 1.87, 0x006bff),
    element("Am", 2.83, 1.80, 0x545cf2),
    element("Cm", 3.05, 1.69, 0x785ce3),
    element("Bk", 3.40, NONE, 0x8a4fe3),
    element("Cf", 3.05, NONE, 0xa136d4),
    element("Es", 2.70, NONE, 0xb31fd4),
    element("Fm", NONE, NONE, 0xb31fba),
    element("Md", NONE, NONE, 0xb30da6),
    element("No", NONE, NONE, 0xbd0d87),
    element("Lr", NONE, NONE, 0xc70066),
    element("Rf", NONE, NONE, 0xcc0059),
    element("Db", NONE, NONE, 0xd1004f),
    element("Sg", NONE, NONE, 0xd90045),
    element("Bh", NONE, NONE, 0xe00038),
    element("Hs", NONE, NONE, 0xe6002e),
    element("Mt", NONE, NONE, 0xeb0026),
    element("Ds", NONE, NONE, 0xff1493),
    element("Rg", NONE, NONE, 0xff1493),
    element("Cn", NONE, NONE, 0xff1493),
    element("Nh", NONE, NONE, 0xff1493),
    element("Fl", NONE, NONE, 0xff1493),
    element("Mc", NONE, NONE, 0xff1493),
    element("Lv", NONE, NONE, 0xff1493),
    element("Ts", NONE, NONE, 0xff1493),
    element("Og", NONE, NONE, 0xff1493),
];

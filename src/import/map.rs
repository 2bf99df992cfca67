//! Colour maps.
//!
//! Viridis, magma, inferno and plasma are by S. van der Walt, N. Smith and E. Firing (CC0); cividis by J. Nuñez, C. Anderton and
//! R. Renslow, PLOS ONE 13 (2018) e0199239; coolwarm by K. Moreland, ISVC 2009. `maps.txt` has 256 colours of each, as matplotlib
//! draws them. Categories are the palette of M. Okabe and K. Ito without black, light colours first.

#![allow(clippy::unreadable_literal, reason = "colours are written as `rrggbb`")]

use std::str::FromStr;

use glam::DVec3;
use serde::Serialize;

use super::color::{hex_color, hex_of};

/// A line for each map: its name, then all colours as `rrggbb`.
const TABLES: &str = include_str!("maps.txt");
/// Colours of a map.
const STEPS: usize = 256;

/// The colours of categories; from the eighth on they begin anew, darker.
const CATEGORIES: [u32; 7] = [0x56b4e9, 0xe69f00, 0x009e73, 0xcc79a7, 0xf0e442, 0x0072b2, 0xd55e00];

/// How numbers become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names say all")]
pub enum Map {
    Viridis,
    Magma,
    Inferno,
    Plasma,
    Cividis,
    Coolwarm,
    /// Black to white.
    Gray,
    /// A colour for each of few values or words.
    Categories,
}

impl Map {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Viridis,
        Self::Magma,
        Self::Inferno,
        Self::Plasma,
        Self::Cividis,
        Self::Coolwarm,
        Self::Gray,
        Self::Categories,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Magma => "magma",
            Self::Inferno => "inferno",
            Self::Plasma => "plasma",
            Self::Cividis => "cividis",
            Self::Coolwarm => "coolwarm",
            Self::Gray => "gray",
            Self::Categories => "categories",
        }
    }

    /// Its colours from the least value to the greatest, evenly spaced, or one after the other those of categories.
    pub fn colors(self) -> Vec<DVec3> {
        match self {
            Self::Gray => vec![DVec3::ZERO, DVec3::ONE],
            Self::Categories => CATEGORIES.map(hex_color).to_vec(),
            _ => {
                let table = TABLES.lines().find_map(|line| line.strip_prefix(self.name())?.strip_prefix(' '));
                let colors = table.unwrap_or_default().as_bytes().chunks_exact(6).filter_map(hex_of);
                colors.take(STEPS).collect()
            }
        }
    }
}

impl FromStr for Map {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|map| map.name() == text)
            .ok_or_else(|| format!("expected one of {}", Self::ALL.map(Self::name).join(", ")))
    }
}

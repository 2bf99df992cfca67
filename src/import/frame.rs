//! The particles of one frame, as the file has them.

use std::collections::HashMap;

use glam::DVec3;

use super::atom_name::guess;
use super::elements::Element;

/// The different words of a column, numbered by first appearance. They keep their numbers from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Labels {
    names: Vec<Box<[u8]>>,
    numbers: HashMap<Box<[u8]>, u32>,
    last: u32,
}

impl Labels {
    /// The number of a word, and whether it has not been seen before.
    pub(super) fn number(&mut self, word: &[u8]) -> (u32, bool) {
        // Neighbours are often of one kind.
        if self.names.get(self.last as usize).is_some_and(|name| **name == *word) {
            return (self.last, false);
        }
        let known = self.numbers.get(word).copied();
        self.last = known.unwrap_or_else(|| {
            let number = self.names.len() as u32;
            self.names.push(word.into());
            self.numbers.insert(word.into(), number);
            number
        });
        (self.last, known.is_none())
    }

    /// The words by number.
    pub(super) fn names(&self) -> impl Iterator<Item = &[u8]> {
        self.names.iter().map(|name| &**name)
    }

    pub(super) fn len(&self) -> usize {
        self.names.len()
    }
}

/// What numbers in place of elements are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Numbers {
    Atomic,
    Types,
}

/// What a scene is made of. Lists other than `positions` are empty or as long as it.
#[derive(Debug, Default)]
pub(super) struct Frame {
    pub(super) positions: Vec<DVec3>,
    /// Element or type of each particle, a number of `labels`.
    pub(super) kinds: Vec<u32>,
    pub(super) labels: Labels,
    /// The element of each label, where it is one.
    pub(super) elements: Vec<Option<&'static Element>>,
    /// Of each label, whether it is the name of an atom from which its element was guessed.
    guessed: Vec<bool>,
    /// How many particles have an element that was guessed.
    pub(super) guesses: u64,
    /// What labels that are numbers are, where that had to be decided.
    pub(super) numbers: Option<Numbers>,
    pub(super) radii: Vec<f64>,
    /// Of the column that gives colours, NaN where it is missing; where that holds words, their numbers in `words`.
    pub(super) values: Vec<f64>,
    pub(super) words: Labels,
    /// As the file has them: 0 to 1, or 0 to `levels`; NaN where one is missing.
    pub(super) colors: Vec<DVec3>,
    /// The greatest level of a colour, where the file says so.
    pub(super) levels: Option<f64>,
}

impl Frame {
    /// Makes room for the next frame.
    pub(super) fn clear(&mut self) {
        self.positions.clear();
        self.kinds.clear();
        self.guesses = 0;
        self.radii.clear();
        self.values.clear();
        self.colors.clear();
    }

    /// Adds the kind of a particle; whether it has not been seen before and is no element.
    pub(super) fn push_kind(&mut self, token: &[u8], is_element: bool) -> bool {
        let (number, is_new) = self.labels.number(token);
        if is_new {
            // A type may be an element's symbol, but its number is no atomic number.
            let may_be = is_element || token.first().is_some_and(u8::is_ascii_alphabetic);
            let known = if may_be { Element::of(token) } else { None };
            let guessed = if is_element && known.is_none() { guess(token) } else { None };
            self.guessed.push(guessed.is_some());
            self.elements.push(known.or(guessed));
        }
        self.guesses += u64::from(self.guessed[number as usize]);
        self.kinds.push(number);
        is_new && is_element && self.elements[number as usize].is_none()
    }

    /// Decides with the first frame what labels that are numbers are: types where they are 1, 2 … without a gap, or where
    /// `are_types` says so.
    pub(super) fn decide_numbers(&mut self, are_types: bool) {
        let number_of = |label: &[u8]| str::from_utf8(label).ok()?.parse::<usize>().ok();
        let mut numbers: Vec<_> = self.labels.names().filter_map(number_of).collect();
        if numbers.is_empty() {
            return;
        }
        numbers.sort_unstable();
        numbers.dedup();
        let has_no_gap = numbers.iter().zip(1..).all(|(&number, expected)| number == expected);
        let decided = if are_types || has_no_gap { Numbers::Types } else { Numbers::Atomic };
        if *self.numbers.get_or_insert(decided) == Numbers::Types {
            for (element, label) in self.elements.iter_mut().zip(self.labels.names()) {
                if number_of(label).is_some() {
                    *element = None;
                }
            }
        }
    }
}

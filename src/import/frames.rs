//! A choice of frames.

use std::str::FromStr;

/// Which frames of a trajectory, counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Frames {
    /// Every one.
    All,
    /// The last one.
    Last,
    /// Those from the first to the last of each pair, in the order of the file.
    Ranges(Vec<(usize, usize)>),
}

impl Default for Frames {
    /// The first.
    fn default() -> Self {
        Self::Ranges(vec![(1, 1)])
    }
}

impl Frames {
    /// Whether one frame is chosen at the most.
    pub fn is_one(&self) -> bool {
        match self {
            Self::All => false,
            Self::Last => true,
            Self::Ranges(ranges) => matches!(ranges[..], [(first, last)] if first == last),
        }
    }

    /// Whether this frame is to be read.
    pub(super) fn wants(&self, number: usize) -> bool {
        match self {
            Self::All | Self::Last => true,
            Self::Ranges(ranges) => ranges.iter().any(|&(first, last)| (first..=last).contains(&number)),
        }
    }

    /// The last frame that is chosen by its number.
    pub(super) fn end(&self) -> Option<usize> {
        match self {
            Self::All | Self::Last => None,
            Self::Ranges(ranges) => ranges.iter().map(|&(_, last)| last).max(),
        }
    }
}

impl FromStr for Frames {
    type Err = String;

    /// `all`, `last`, or a list such as `7` or `1-50,73`.
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse().ok().filter(|&number: &usize| number > 0);
        let range = |text: &str| {
            let (first, last) = text.split_once('-').unwrap_or((text, text));
            Some((number(first)?, number(last)?)).filter(|(first, last)| first <= last)
        };
        match text {
            "all" => Ok(Self::All),
            "last" => Ok(Self::Last),
            _ => (text.split(',').map(range).collect::<Option<_>>().map(Self::Ranges))
                .ok_or_else(|| "expected all, last, or frames counted from 1 such as 7 or 1-50,73".into()),
        }
    }
}

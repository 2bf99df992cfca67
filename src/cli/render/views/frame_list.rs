//! Which frames of many are rendered.

use std::str::FromStr;

/// A list such as `1-50,73`: ranges of numbers from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FrameList(Vec<[u32; 2]>);

impl FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |part: &str| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let number = |text: &str| text.trim().parse().ok().filter(|&number: &u32| number > 0);
            let (first, last) = (number(first)?, number(last)?);
            (first <= last).then_some([first, last])
        };
        let range = |part: &str| {
            range(part).ok_or_else(|| format!("'{part}' is no frame such as 73 and no range such as 1-50"))
        };
        text.split(',').map(range).collect::<Result<_, _>>().map(Self)
    }
}

impl FrameList {
    /// The numbers in ascending order, each once; otherwise the first that is none of `count` frames.
    pub(super) fn of(&self, count: u32) -> Result<Vec<u32>, u32> {
        if let Some(&[first, _]) = self.0.iter().find(|[_, last]| *last > count) {
            return Err(first.max(count + 1));
        }
        let mut numbers: Vec<u32> = self.0.iter().flat_map(|&[first, last]| first..=last).collect();
        numbers.sort_unstable();
        numbers.dedup();
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str, count: u32) -> Result<Vec<u32>, u32> {
        text.parse::<FrameList>().unwrap_or_else(|why| panic!("{text}: {why}")).of(count)
    }

    #[test]
    fn ranges_and_numbers_are_put_in_order() {
        assert_eq!(numbers("1-3,7", 9), Ok(vec![1, 2, 3, 7]));
        assert_eq!(numbers("5, 2-3,3,5-5", 5), Ok(vec![2, 3, 5]));
    }

    #[test]
    fn frames_that_are_not_there_are_named() {
        assert_eq!(numbers("1-10", 9), Err(10));
        assert_eq!(numbers("2,30", 9), Err(30));
    }

    #[test]
    fn what_is_no_list_is_refused() {
        for text in ["", "0", "1-", "-3", "5-2", "a", "1,,2", "1-2-3", "0-4"] {
            assert!(text.parse::<FrameList>().is_err(), "{text}");
        }
    }
}

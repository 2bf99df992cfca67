//! One of something for each sphere: all of them, or each once it is asked for.

use std::fmt;
use std::ops::Index;
use std::sync::{Arc, OnceLock};

/// By the index of the sphere.
#[derive(Debug, Clone)]
pub(crate) struct PerSphere<S> {
    /// Empty where each is made once it is asked for.
    all: Vec<S>,
    lazy: Option<Arc<Lazy<S>>>,
}

struct Lazy<S> {
    made: Vec<OnceLock<Box<S>>>,
    make: Box<dyn Fn(usize) -> S + Send + Sync>,
}

impl<S> PerSphere<S> {
    /// So many, each made once it is asked for.
    pub(crate) fn lazy(count: usize, make: impl Fn(usize) -> S + Send + Sync + 'static) -> Self {
        let made = (0..count).map(|_| OnceLock::new()).collect();
        Self { all: Vec::new(), lazy: Some(Arc::new(Lazy { made, make: Box::new(make) })) }
    }

    /// All of them; none where each is made once it is asked for.
    pub(crate) fn all(&self) -> &[S] {
        &self.all
    }

    /// How many there are by now.
    #[cfg(test)]
    pub(crate) fn made(&self) -> usize {
        let made = self.lazy.iter().flat_map(|lazy| &lazy.made).filter(|one| one.get().is_some());
        self.all.len() + made.count()
    }

    #[cold]
    fn asked_for(&self, sphere: usize) -> &S {
        match &self.lazy {
            Some(lazy) => lazy.made[sphere].get_or_init(|| Box::new((lazy.make)(sphere))),
            None => &self.all[sphere],
        }
    }
}

impl<S> FromIterator<S> for PerSphere<S> {
    fn from_iter<I: IntoIterator<Item = S>>(each: I) -> Self {
        Self { all: each.into_iter().collect(), lazy: None }
    }
}

impl<S> Index<usize> for PerSphere<S> {
    type Output = S;

    #[inline]
    fn index(&self, sphere: usize) -> &S {
        match self.all.get(sphere) {
            Some(one) => one,
            None => self.asked_for(sphere),
        }
    }
}

impl<S> fmt::Debug for Lazy<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lazy").field("spheres", &self.made.len()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_made_once_it_is_asked_for() {
        let squares = PerSphere::lazy(1_000_000, |sphere| sphere * sphere);
        assert_eq!([squares[3], squares[9], squares.clone()[3], squares[999_999]], [9, 81, 9, 999_998_000_001]);
        assert_eq!(squares.made(), 3);
        let all: PerSphere<usize> = (0..4).collect();
        assert_eq!((all[3], all.all()), (3, [0, 1, 2, 3].as_slice()));
    }
}

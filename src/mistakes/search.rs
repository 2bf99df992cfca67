//! Which causes, alone or in pairs, explain a picture.

use std::collections::HashSet;
use std::time::Instant;

use rayon::prelude::*;

use super::case::{Case, Sample, Score};
use super::catalogue::{CAUSES, Changes, Right, Way, rank, ways};
use super::fit::fits;
use super::variant::{Border, Variant};

/// Pixels of each kind on which every cause is tried, at the most and at the least.
const FIRST: [usize; 2] = [600, 100];
/// Likewise every pair.
const PAIR: usize = 40;
/// Likewise every rendering of a fit,
const FIT: [usize; 2] = [80, 24];
/// which is to take no longer than this, in seconds.
const FIT_SECONDS: f64 = 2e-4;
/// Pixels of each kind on which the best of them are tried, at the most.
const SECOND: usize = 4000;
/// Causes that a pair may begin with: as many by the pixels that they leave and as many by the sum of all differences.
const BEGINNERS: usize = 14;
/// Of these as many are completed by fits.
const FITTED_BEGINNERS: usize = 2;
/// Of the many fits as many end a pair.
const FITS: usize = 30;
/// Single causes and pairs that are tried on more pixels.
const CONTENDERS: usize = 60;
/// Those of them that are tried on all.
const FINALISTS: usize = 6;
/// About how long all single causes take on the first sample, in seconds of one core.
const FIRST_SECONDS: f64 = 2.0;
/// A pair has to leave less than this part of what its better half leaves.
const PAIR_LEAVES: f64 = 0.5;
/// What a fitted cause leaves counts so many times, and this part of all pixels besides: anything can be fitted a little.
const FIT_HANDICAP: (f64, f64) = (2.0, 0.005);
/// Specks fit whatever is too dark.
const SPECKS_HANDICAP: (f64, f64) = (2.0, 0.1);
/// Whoever leaves this part of the pixels has explained them but for rounding.
const GOOD: f64 = 0.005;

/// A cause that explains a smaller part of the pixels is not named.
const LEAST_SHARE: f64 = 0.5;
/// Nor one that explains fewer pixels, unless there are no more.
const LEAST_PIXELS: f64 = 3.0;

/// One or two causes that explain some of the pixels.
#[derive(Clone)]
pub(super) struct Hypothesis<'w> {
    pub ways: Vec<&'w Way>,
    pub variant: Variant,
    pub score: Score,
}

impl Hypothesis<'_> {
    /// What it leaves, with the handicaps of its causes.
    fn handicapped(&self, before: f64) -> f64 {
        self.ways.iter().fold(self.score.left, |left, way| {
            let (factor, part) = handicap(way.name);
            left * factor + part * before
        })
    }

    fn ranks(&self) -> usize {
        self.ways.iter().map(|way| rank(way.name)).sum()
    }
}

fn handicap(name: &str) -> (f64, f64) {
    match name {
        "shadow-acne" => SPECKS_HANDICAP,
        "sphere-missing" => (1.0, 0.0),
        _ if is_fitted(name) => FIT_HANDICAP,
        _ => (1.0, 0.0),
    }
}

fn is_fitted(name: &str) -> bool {
    CAUSES.iter().any(|known| known.name == name && matches!(known.changes, Changes::Fitted))
}

/// What a search has found.
pub(super) struct Found {
    /// The causes that explain the picture together.
    pub best: Vec<Part>,
    /// Pixels that they leave.
    pub left: f64,
    /// Causes that would explain as much in place of the first, and others that explain less.
    pub others: Vec<Part>,
}

/// A cause among those found.
pub(super) struct Part {
    pub name: &'static str,
    pub detail: String,
    /// Part of the pixels that it explains, between 0 and 1.
    pub share: f64,
    /// Whether it explains exactly as much as the first.
    pub is_equal: bool,
    pub variant: Variant,
}

/// Runs through all single causes and, where they leave much, pairs.
pub(super) fn search(case: &Case, right: &Right) -> Option<Found> {
    let before = case.before() as f64;
    let known = ways(right);
    let seconds = seconds_a_pixel(case, right.variant);
    let budget = FIRST_SECONDS / (seconds * known.len() as f64 * 2.0);
    let count = (budget as usize).clamp(FIRST[1], FIRST[0]);
    let first = case.sample(count);
    let second = case.sample(SECOND.min(count * 8));
    let full = case.sample(((20.0 / seconds) as usize / FINALISTS / 2).max(SECOND));
    let base = right.variant;

    let alone = known.iter().filter(|way| makes_the_size(right, way.name)).map(|way| vec![way]);
    let mut singles = screened(case, base, alone.collect(), &first);
    sort(&mut singles, before);
    let finalists = finals(case, &singles, &second, &full);
    if case.exactly {
        // Of a part of the pixels nothing follows for all.
        let exact = finalists.into_iter().filter(|h| h.score.left == 0.0 && !case.limit.has_cut()).collect();
        return found(case, base, &full, exact);
    }
    let explains =
        |finalists: &[Hypothesis]| finalists.first().is_some_and(|best| best.score.left <= (before * GOOD).max(1.0));
    if explains(&finalists) || singles.is_empty() || case.limit.is_over() {
        return found(case, base, &full, finalists);
    }
    let fewer = case.sample(((FIT_SECONDS / seconds) as usize).clamp(FIT[1], FIT[0]));
    let fits_alone = right.other_size.is_none();
    let fitted = if fits_alone { fits(case, right.scene, base, [&first, &fewer]) } else { Vec::new() };
    singles.extend(screened(case, base, fitted.iter().map(|way| vec![way]).collect(), &first));
    let specks = specks();
    singles.extend(screened(case, base, if fits_alone { vec![vec![&specks]] } else { Vec::new() }, &first));
    sort(&mut singles, before);
    let mut finalists = finals(case, &singles, &second, &full);
    let best = finalists.first().map_or(before, |best| best.score.left);
    if explains(&finalists) || case.limit.is_over() {
        return found(case, base, &full, finalists);
    }

    // Pairs: of the best with all, and of what changes how pixels are written with all.
    let few = case.sample(PAIR.min(count));
    let beginners = beginners(&singles);
    let simple: Vec<&Way> = known.iter().filter(|way| is_simple(way)).collect();
    let fits_of_many = singles.iter().map(|single| single.ways[0]).filter(|way| is_fitted(way.name)).take(FITS);
    let all: Vec<&Way> = simple.iter().copied().chain(fits_of_many).collect();
    let writers = simple.iter().copied().filter(|way| fits_alone && is_writer(way));
    let mut tried = HashSet::new();
    let mut specs = Vec::new();
    for a in beginners.iter().copied().chain(writers) {
        for &b in &all {
            let [a_at, b_at] = [a, b].map(|way| std::ptr::from_ref(way) as usize);
            if go_together(a.name, b.name) && tried.insert((a_at.min(b_at), a_at.max(b_at))) {
                specs.push(vec![a, b]);
            }
        }
    }
    let mut pairs = screened(case, base, specs, &few);
    sort(&mut pairs, before);
    pairs.truncate(4 * CONTENDERS);
    let mut pairs = screened(case, base, pairs.into_iter().map(|pair| pair.ways).collect(), &first);
    // Fits again, after what the best causes have changed.
    let completed: Vec<(&Way, Vec<Way>)> = beginners
        .iter()
        .take(FITTED_BEGINNERS)
        .map(|&way| {
            let mut base = right.variant.clone();
            (way.apply)(&mut base);
            (way, fits(case, right.scene, &base, [&first, &fewer]))
        })
        .collect();
    for (way, fits) in &completed {
        let specs = fits.iter().filter(|fit| go_together(fit.name, way.name)).map(|fit| vec![*way, fit]).collect();
        pairs.extend(screened(case, base, specs, &first));
    }
    sort(&mut pairs, before);
    let pairs = finals(case, &pairs, &second, &full);
    if let Some(pair) = pairs.first()
        && pair.handicapped(before) < PAIR_LEAVES * best
        && best - pair.score.left >= 3.0
    {
        finalists = pairs;
    }
    found(case, base, &full, finalists)
}

/// How long a pixel of the right picture takes.
fn seconds_a_pixel(case: &Case, right: &Variant) -> f64 {
    let sample = case.sample(100);
    let start = Instant::now();
    _ = case.score(right, &sample);
    let pixels = sample.differing.len() + sample.equal.len();
    (start.elapsed().as_secs_f64() / pixels.max(1) as f64).max(2e-7)
}

/// The scores of combinations of causes on a sample, as many as there is time for.
fn screened<'w>(case: &Case, right: &Variant, specs: Vec<Vec<&'w Way>>, sample: &Sample) -> Vec<Hypothesis<'w>> {
    let each = |ways: Vec<&'w Way>| {
        let mut variant = right.clone();
        for way in &ways {
            (way.apply)(&mut variant);
        }
        let score = case.score(&variant, sample)?;
        Some(Hypothesis { ways, variant, score })
    };
    specs.into_par_iter().filter_map(each).collect()
}

fn sort(hypotheses: &mut [Hypothesis], before: f64) {
    let key = |h: &Hypothesis| (h.handicapped(before), h.ranks());
    hypotheses.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    });
}

/// The best of the hypotheses, by their scores on all pixels or, where there is no time for that, by those that they have.
fn finals<'w>(case: &Case, hypotheses: &[Hypothesis<'w>], second: &Sample, full: &Sample) -> Vec<Hypothesis<'w>> {
    let before = case.before() as f64;
    let mut contenders: Vec<_> = hypotheses.iter().take(CONTENDERS).cloned().collect();
    contenders.par_iter_mut().for_each(|contender| {
        contender.score = case.score(&contender.variant, second).unwrap_or(contender.score);
    });
    sort(&mut contenders, before);
    contenders.truncate(FINALISTS);
    for finalist in &mut contenders {
        finalist.score = case.score_in_parallel(&finalist.variant, full).unwrap_or(finalist.score);
    }
    sort(&mut contenders, before);
    contenders
}

/// Those that leave the least, and those that bring the picture nearest.
fn beginners<'w>(singles: &[Hypothesis<'w>]) -> Vec<&'w Way> {
    let mut by_error: Vec<&Hypothesis> = singles.iter().collect();
    by_error.sort_by(|a, b| a.score.error.total_cmp(&b.score.error));
    let mut picked: Vec<&Way> = Vec::new();
    for list in [singles.iter().collect::<Vec<_>>(), by_error] {
        let mut taken = 0;
        for hypothesis in list {
            let way = hypothesis.ways[0];
            // Of the many ways of one cause a few are enough.
            let alike = picked.iter().filter(|other| other.name == way.name).count();
            if alike < 2 && taken < BEGINNERS && !picked.iter().any(|&other| std::ptr::eq(other, way)) {
                picked.push(way);
                taken += 1;
            }
        }
    }
    picked
}

/// Whether a cause can be why a picture has the size that it has.
fn makes_the_size(right: &Right, name: &str) -> bool {
    let [width, height] = right.variant.size;
    right.other_size.is_none_or(|shown| match name {
        "size-off-by-one" => true,
        "size-swapped" | "transposed" | "rotated-90" | "written-by-columns" => shown == [height, width],
        _ => false,
    })
}

/// Whether a cause changes how pixels are written.
fn is_writer(way: &Way) -> bool {
    const FIRST_OF_OTHERS: &str = "ambient-missing";
    rank(way.name) < rank(FIRST_OF_OTHERS) && is_simple(way)
}

/// Whether two causes are two: not the same, and neither the whole convention and a part of it.
fn go_together(a: &str, b: &str) -> bool {
    let of_convention = |name: &str| name.starts_with("sample-") || name.starts_with("levels-");
    let holds = |a: &str, b: &str| a == "other-convention" && of_convention(b);
    a != b && !holds(a, b) && !holds(b, a)
}

/// Whether a way is not one of many alike.
fn is_simple(way: &Way) -> bool {
    way.name != "shifted" || {
        way.detail.ends_with(Border::Rendered.name()) && !["3", "4"].iter().any(|far| way.detail.contains(far))
    }
}

/// Lights that are missing here and there.
fn specks() -> Way {
    Way { name: "shadow-acne", detail: String::new(), apply: Box::new(|v| v.specks = true) }
}

/// The first hypothesis with the share of each of its causes, and the others.
fn found(case: &Case, right: &Variant, full: &Sample, hypotheses: Vec<Hypothesis>) -> Option<Found> {
    let before = case.before() as f64;
    let share = |left: f64| ((before - left) / before).clamp(0.0, 1.0);
    let mut hypotheses = hypotheses.into_iter();
    let best = hypotheses.next().filter(|best| share(best.score.left) >= LEAST_SHARE)?;
    if !case.exactly && before - best.score.left < LEAST_PIXELS.min(before) {
        return None;
    }
    let left = best.score.left;
    // What a cause explains is what its absence would leave.
    let without = |index: usize| {
        let mut variant = right.clone();
        best.ways.iter().enumerate().filter(|(at, _)| *at != index).for_each(|(_, way)| (way.apply)(&mut variant));
        let score = case.score_in_parallel(&variant, full).or_else(|| case.rough_score(&variant));
        score.map_or(left, |score| score.left)
    };
    let part = |way: &Way, share: f64, is_equal: bool, variant: &Variant| Part {
        name: way.name,
        detail: way.detail.clone(),
        share,
        is_equal,
        variant: variant.clone(),
    };
    let mut causes: Vec<Part> = if let [way] = best.ways[..] {
        vec![part(way, share(left), false, &best.variant)]
    } else {
        let of = |(index, way): (usize, &&Way)| {
            part(way, ((without(index) - left) / before).clamp(0.0, 1.0), false, &best.variant)
        };
        best.ways.iter().enumerate().map(of).collect()
    };
    causes.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut others: Vec<Part> = Vec::new();
    for other in hypotheses {
        let is_equal = other.score.left == left && other.handicapped(before) <= best.handicapped(before);
        let share = share(other.score.left);
        for way in other.ways {
            let is_named = causes.iter().chain(&others).any(|part| part.name == way.name);
            if !is_named && share >= LEAST_SHARE && (is_equal || left > before * GOOD) {
                others.push(part(way, share, is_equal, &other.variant));
            }
        }
    }
    Some(Found { best: causes, left, others })
}

//! Box matching: where the pixels around a point are found again, by trying displacements.
//!
//! J. Diener's thesis, 2.4.1 (eq. 2.3) and 2.5.1 (eq. 2.10): with the template `I` of side `n = 2r + 1` around a point,
//! the displacement `d*` in a search window is the one of least `Σ (I(p) - J(p + d))²` over `p = 0..n-1` in both
//! directions (errata E4: the thesis prints sums of n + 1 terms), or of greatest normalised correlation.
//!
//! *Exhaustive* compares whole templates at all displacements. *Pyramidal* does so only in the coarsest of pictures
//! made of 2x2 averages, where template and search window are `2^k` times smaller, carries the best share of the
//! displacements down, and tries the four finer ones of each and those around them (errata E4: level k - 1 starts from
//! level k). Both end with a quadratic through the nine costs around the best displacement.
//!
//! Costs are whole numbers, so answers are the same bits at every SIMD level and for any number of threads.

mod kernel;
mod least;
mod peak;
mod planes;
mod search;
mod template;
#[cfg(test)]
mod tests;

pub use planes::Boxes;
pub use template::Template;

use crate::klt::State;
use crate::{Point, simd};
use search::Search;

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Radius of the template, pixels, 1..=128; its side is `2r + 1`.
    pub radius_px: u32,
    /// Farthest displacement along x and along y, pixels.
    pub search_px: u32,
    /// Which displacements are tried.
    pub method: Method,
    /// What makes two windows alike.
    pub measure: Measure,
    /// A template whose brightness varies less (standard deviation, gray levels) is flat, and nothing is looked for.
    pub min_contrast: f32,
}

/// Which displacements are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// All of them.
    Exhaustive,
    /// All of them in the coarsest picture, and in finer ones those around the best.
    Pyramidal {
        /// Sizes of the picture, its own among them; a pyramid with fewer is used whole.
        levels: u32,
        /// Share of the displacements tried on a level, the best of them, that the next finer one starts from, 0..=1.
        share: f32,
    },
}

/// What makes two windows alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Sum of squared differences of brightness.
    Ssd,
    /// Normalised cross-correlation, mean taken off: brightness and contrast may change.
    Ncc,
}

impl Default for Params {
    /// Pyramidal, two levels, 0.7 %; squared differences of a template of 21x21 pixels.
    fn default() -> Self {
        let method = Method::Pyramidal { levels: 2, share: 0.007 };
        Self { radius_px: 10, search_px: 32, method, measure: Measure::Ssd, min_contrast: 1.0 }
    }
}

impl Params {
    /// Levels that [`Boxes`] need for these parameters.
    #[must_use]
    pub fn levels(&self) -> u32 {
        match self.method {
            Method::Exhaustive => 1,
            Method::Pyramidal { levels, .. } => levels,
        }
    }
}

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Position in the next picture; where it was looked for if it was not found. Always finite.
    pub to: Point,
    /// Whether it was found.
    pub state: State,
    /// Displacement of least cost from the template's own pixel, `[x, y]`, pixels; 0 where nothing was looked for.
    pub step: [i32; 2],
    /// Its cost: the sum of squared differences, or `2³¹ (1 - ncc)` rounded down; 0 where nothing was looked for.
    pub cost: u32,
}

/// Follows points from one picture to the next, on up to `max_threads` threads.
///
/// `guesses` are positions in the next picture to search around; without them a point is looked for around where it
/// was. The answer has one entry a point, in order.
///
/// # Panics
/// When the pictures differ in size or in levels, were made for another radius, or there is not one guess a point.
#[must_use]
#[track_caller]
pub fn track(
    prev: &Boxes,
    next: &Boxes,
    from: &[Point],
    guesses: Option<&[Point]>,
    params: &Params,
    max_threads: usize,
) -> Vec<Match> {
    track_at(simd::best(), prev, next, from, guesses, params, max_threads)
}

/// [`track`] with the kernels of a chosen level; the answer is the same, only the time differs.
///
/// # Panics
/// As [`track`].
#[must_use]
#[track_caller]
pub fn track_at(
    simd: simd::Level,
    prev: &Boxes,
    next: &Boxes,
    from: &[Point],
    guesses: Option<&[Point]>,
    params: &Params,
    max_threads: usize,
) -> Vec<Match> {
    let guesses = guesses.unwrap_or(from);
    assert_eq!(from.len(), guesses.len(), "one guess a point");
    assert_eq!((prev.size(), prev.n_levels()), (next.size(), next.n_levels()), "size of the two pictures");
    in_chunks(from.len(), max_threads, |range, out| {
        let mut search = Search::new(simd, params);
        let mut template = Template::default();
        out.extend(from[range.clone()].iter().zip(&guesses[range]).map(|(&from, &guess)| {
            template.cut(prev, from);
            search.find(&template, next, guess)
        }));
    })
}

/// Looks for templates that were cut before, each around its guess, on up to `max_threads` threads.
///
/// # Panics
/// When a template was cut from a picture of another size, or for another radius, or there is not one guess a template.
#[must_use]
#[track_caller]
pub fn find(
    templates: &[&Template],
    next: &Boxes,
    guesses: &[Point],
    params: &Params,
    max_threads: usize,
) -> Vec<Match> {
    assert_eq!(templates.len(), guesses.len(), "one guess a template");
    in_chunks(templates.len(), max_threads, |range, out| {
        let mut search = Search::new(simd::best(), params);
        let pairs = templates[range.clone()].iter().zip(&guesses[range]);
        out.extend(pairs.map(|(template, &guess)| search.find(template, next, guess)));
    })
}

/// Does `0..n` in as many ranges as there are threads, and puts the answers in order.
fn in_chunks(
    n: usize,
    max_threads: usize,
    work: impl Fn(std::ops::Range<usize>, &mut Vec<Match>) + Sync,
) -> Vec<Match> {
    /// Fewer points than this are not worth a thread.
    const POINTS_A_THREAD: usize = 64;
    let n_threads = max_threads.min(n / POINTS_A_THREAD).max(1);
    let chunk = n.div_ceil(n_threads).max(1);
    let mut parts: Vec<Vec<Match>> = vec![Vec::with_capacity(chunk); n_threads];
    let range = |i: usize| (i * chunk).min(n)..((i + 1) * chunk).min(n);
    std::thread::scope(|scope| {
        let mut jobs = parts.iter_mut().enumerate();
        let first = jobs.next();
        let work = &work;
        for (i, part) in jobs {
            scope.spawn(move || work(range(i), part));
        }
        if let Some((i, part)) = first {
            work(range(i), part);
        }
    });
    parts.concat()
}

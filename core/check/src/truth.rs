//! Level 7: trackers against clips whose motion is known.
//!
//! A tracker that does not claim more is allowed half a pixel, and a fifth of the points lost. One that is further off is
//! doubtful as long as it is better than none: where the picture shifts it must be off by less than half of what a tracker
//! would be that leaves every point where it was, and where more than that happens, by less at all. Some trackers cannot follow a texture by their nature, because they know things by
//! their colours: these are doubtful too, where they follow coloured discs instead.

mod dense;
mod detect;
mod status;

use crate::clip::{Clip, Discs, FPS, Moved, Texture, centre, grid};
use crate::course::{follow, of_tracker, row, tracker};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{Point, Points};
use honami_model::track::Status;
use std::f64::consts::{PI, TAU};
use std::time::Duration;

pub(crate) fn checks() -> Vec<Check> {
    [CHECKS, status::CHECKS, dense::CHECKS, detect::CHECKS].concat()
}

/// So far off is as good as there.
const NEAR_PX: f64 = 0.5;
/// Lost points that are none too many.
const LOST_SHARE: f64 = 0.2;
/// A tracker that is off by less than this share of the motion follows it.
const FOLLOWS_SHARE: f64 = 0.5;
/// One that is off by less than this share is better than none.
const BETTER_SHARE: f64 = 0.9;
/// Size of the pictures.
pub(crate) const SIZE: [u32; 2] = [160, 120];
/// Frames of a clip.
const N_FRAMES: usize = 12;
/// Nearer to the border a window does not see enough.
const MARGIN_PX: f64 = 16.0;

const DEADLINE: Duration = Duration::from_secs(60);

const CHECKS: &[Check] = &[
    Check {
        id: "truth.still",
        level: 7,
        claim: "where nothing moves, no point does",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, still),
    },
    Check {
        id: "truth.shift",
        level: 7,
        claim: "it follows a picture that shifts by fractions of a pixel",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| judge(subject, &Case::moving(shift))),
    },
    Check {
        id: "truth.turn",
        level: 7,
        claim: "it follows a picture that turns by a degree a frame",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| judge(subject, &Case::hard(turn))),
    },
    Check {
        id: "truth.zoom",
        level: 7,
        claim: "it follows a picture that grows by a hundredth a frame",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| judge(subject, &Case::hard(zoom))),
    },
    Check {
        id: "truth.sway",
        level: 7,
        claim: "it follows what sways at 1, 3, 6 and 10 Hz at once",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| judge(subject, &Case::hard(sway))),
    },
    Check {
        id: "truth.light",
        level: 7,
        claim: "it follows through light that fades by a hundredth a frame",
        deadline: DEADLINE,
        run: |subject| {
            of_tracker(subject, |subject| judge(subject, &Case { light: fading, ..Case::hard(shift) }))
        },
    },
    Check {
        id: "truth.blur",
        level: 7,
        claim: "it follows a picture that blurs",
        deadline: DEADLINE,
        run: |subject| {
            of_tracker(subject, |subject| judge(subject, &Case { blur: blurring, ..Case::hard(shift) }))
        },
    },
];

/// A motion, and what else happens to the picture.
struct Case {
    moved: fn(usize) -> Moved,
    /// Contrast and brightness, relative.
    light: fn(usize) -> f64,
    /// Standard deviation of a Gaussian, pixels.
    blur: fn(usize) -> f64,
    /// A tracker must be off by less than this share of what one would be that leaves every point where it was.
    share: f64,
}

impl Case {
    fn moving(moved: fn(usize) -> Moved) -> Self {
        Self { moved, light: |_| 1.0, blur: |_| 0.0, share: FOLLOWS_SHARE }
    }

    /// One that some trackers are not made for.
    fn hard(moved: fn(usize) -> Moved) -> Self {
        Self { share: BETTER_SHARE, ..Self::moving(moved) }
    }

    /// The case as a texture, and points that stay in the picture.
    fn texture(&self, subject: &Subject) -> (Clip, Vec<Point>) {
        let mut chance = subject.chance("truth");
        let texture = Texture::new(&mut chance);
        let blurred: Vec<_> = (0..N_FRAMES).map(|t| texture.blurred((self.blur)(t))).collect();
        let clip = Clip::new(SIZE, N_FRAMES, |at, t| {
            (self.light)(t) * (128.0 + blurred[t].at((self.moved)(t).back(at, centre(SIZE))))
        });
        (clip, grid(SIZE, MARGIN_PX + 20.0, [6, 4], &mut chance))
    }

    /// The same motion of coloured discs, and the middle of each.
    fn discs(&self, subject: &Subject) -> (Clip, Vec<Point>) {
        let seeds = grid(SIZE, 30.0, [3, 2], &mut subject.chance("truth.discs"));
        let centres = seeds.iter().map(|seed| [f64::from(seed.x), f64::from(seed.y)]).collect();
        (Discs::new(centres).clip(SIZE, N_FRAMES, self.moved), seeds)
    }
}

fn shift(t: usize) -> Moved {
    Moved { shift: [1.3 * t as f64, -0.6 * t as f64], ..Moved::NOT }
}

fn turn(t: usize) -> Moved {
    Moved { turn: (t as f64).to_radians(), ..Moved::NOT }
}

fn zoom(t: usize) -> Moved {
    Moved { zoom: 1.01_f64.powf(t as f64), ..Moved::NOT }
}

fn fading(t: usize) -> f64 {
    0.99_f64.powf(t as f64)
}

fn blurring(t: usize) -> f64 {
    0.1 * t as f64
}

/// To and fro at four frequencies at once, each by 0.8 px a frame at most.
fn sway(t: usize) -> Moved {
    let of = |hz: f64| 0.4 / (PI * hz / FPS).sin() * (TAU * hz * t as f64 / FPS).sin();
    Moved { shift: [of(1.0) + of(6.0), of(3.0) + of(10.0)], ..Moved::NOT }
}

/// How near the samples of a course are to the truth.
#[derive(Clone, Copy, Debug)]
struct Score {
    /// Samples that a tracker could have.
    n_due: usize,
    /// Of those, it calls so many tracked.
    n_seen: usize,
    /// Of these, pixels.
    rms_px: f64,
    /// Mean error of these, right and down, pixels.
    bias_px: [f64; 2],
    /// What the same samples would be off by, had every point stayed where it was.
    unmoved_px: f64,
}

impl Score {
    /// Holds a course against a motion. Samples near the border do not count.
    fn of(all: &[Points], seeds: &[Point], moved: fn(usize) -> Moved) -> Self {
        let (mut n_due, mut n_seen) = (0, 0);
        let (mut squares, mut sums, mut unmoved) = (0.0, [0.0; 2], 0.0);
        for (t, points) in all.iter().enumerate().skip(1) {
            for seed in seeds {
                let from = [f64::from(seed.x), f64::from(seed.y)];
                let truth = moved(t).there(from, centre(SIZE));
                if !within(truth, MARGIN_PX) {
                    continue;
                }
                n_due += 1;
                let Some(row) = row(points, seed.id).filter(|row| row.status.is_seen()) else { continue };
                n_seen += 1;
                let off = [f64::from(row.x) - truth[0], f64::from(row.y) - truth[1]];
                squares += off[0].powi(2) + off[1].powi(2);
                sums = [sums[0] + off[0], sums[1] + off[1]];
                unmoved += (from[0] - truth[0]).powi(2) + (from[1] - truth[1]).powi(2);
            }
        }
        let n = n_seen.max(1) as f64;
        Self {
            n_due,
            n_seen,
            rms_px: (squares / n).sqrt(),
            bias_px: sums.map(|sum| sum / n),
            unmoved_px: (unmoved / n).sqrt(),
        }
    }

    fn lost_share(&self) -> f64 {
        1.0 - self.n_seen as f64 / self.n_due.max(1) as f64
    }

    fn is_near(&self) -> bool {
        self.rms_px <= NEAR_PX && self.lost_share() <= LOST_SHARE
    }

    /// Whether what it calls tracked is clearly better than nothing.
    fn follows(&self, share: f64) -> bool {
        self.n_seen > 0 && self.rms_px < share * self.unmoved_px
    }
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (rms, [right, down], lost) = (self.rms_px, self.bias_px, 100.0 * self.lost_share());
        write!(f, "rms {rms:.2} px, bias ({right:+.2}, {down:+.2}) px, {lost:.0} % lost")
    }
}

/// Whether a place lies in the picture, so far from its border.
fn within([x, y]: [f64; 2], margin_px: f64) -> bool {
    let inside = |v: f64, size: u32| (margin_px..=f64::from(size - 1) - margin_px).contains(&v);
    inside(x, SIZE[0]) && inside(y, SIZE[1])
}

fn judge(subject: &Subject, case: &Case) -> Result<Verdict, Fault> {
    let (clip, seeds) = case.texture(subject);
    let texture = Score::of(&follow(&mut tracker(subject)?, &clip, &seeds)?, &seeds, case.moved);
    if texture.is_near() {
        return Ok(Verdict::Holds(texture.to_string()));
    }
    let wanted = format!("wanted {NEAR_PX} px and {:.0} % lost at most", 100.0 * LOST_SHARE);
    if texture.follows(case.share) {
        return Ok(Verdict::Doubtful(format!("{texture}; {wanted}")));
    }
    let (clip, seeds) = case.discs(subject);
    let discs = Score::of(&follow(&mut tracker(subject)?, &clip, &seeds)?, &seeds, case.moved);
    if discs.follows(case.share) {
        return Ok(Verdict::Doubtful(format!("in a texture {texture}, {wanted}; coloured discs: {discs}")));
    }
    let unmoved = texture.unmoved_px;
    Err(Fault(format!(
        "in a texture {texture}, {wanted}; left where they were, points would be off by {unmoved:.2} px; coloured \
         discs: {discs}"
    )))
}

/// What a measurement found in a texture; if that is a fault, in coloured discs, which is then a doubt. The measurement says
/// what it has found, `Err` if that is a fault.
fn in_either(
    subject: &Subject,
    case: &Case,
    seeds: impl Fn(Vec<Point>) -> Vec<Point>,
    measure: impl Fn(&Clip, &[Point]) -> Result<Result<String, String>, Fault>,
) -> Result<Verdict, Fault> {
    let (clip, points) = case.texture(subject);
    let texture = match measure(&clip, &seeds(points))? {
        Ok(what) => return Ok(Verdict::Holds(what)),
        Err(what) => what,
    };
    let (clip, points) = case.discs(subject);
    match measure(&clip, &points)? {
        Ok(discs) => Ok(Verdict::Doubtful(format!("in a texture {texture}; coloured discs: {discs}"))),
        Err(discs) => Err(Fault(format!("in a texture {texture}; coloured discs: {discs}"))),
    }
}

/// A point that is called tracked may tremble by so much where nothing moves.
const STILL_PX: f64 = 0.05;

fn still(subject: &Subject) -> Result<Verdict, Fault> {
    let case = Case::moving(|_| Moved::NOT);
    let worst = |(clip, seeds): (Clip, Vec<Point>)| -> Result<(f64, f64), Fault> {
        let all = follow(&mut tracker(subject)?, &clip, &seeds)?;
        let off = |points: &Points, seed: &Point| {
            let row = row(points, seed.id).filter(|row| row.status == Status::Tracked)?;
            Some(f64::from((row.x - seed.x).hypot(row.y - seed.y)))
        };
        let off: Vec<_> = all.iter().flat_map(|points| seeds.iter().map(|seed| off(points, seed))).collect();
        let lost = off.iter().filter(|off| off.is_none()).count() as f64 / off.len().max(1) as f64;
        Ok((off.into_iter().flatten().fold(0.0, f64::max), lost))
    };
    let (texture, lost) = worst(case.texture(subject))?;
    let said = format!("at most {texture:.3} px in {N_FRAMES} frames, {:.0} % lost", 100.0 * lost);
    if texture <= STILL_PX && lost <= LOST_SHARE {
        return Ok(Verdict::Holds(said));
    }
    let wanted = format!("wanted {STILL_PX} px and {:.0} % lost at most", 100.0 * LOST_SHARE);
    // Who loses what is there says so: that is no lie.
    if texture <= NEAR_PX {
        return Ok(Verdict::Doubtful(format!("{said}; {wanted}")));
    }
    let (discs, discs_lost) = worst(case.discs(subject))?;
    if discs <= NEAR_PX && discs_lost <= LOST_SHARE {
        return Ok(Verdict::Doubtful(format!("in a texture {said}; coloured discs: at most {discs:.3} px")));
    }
    Err(Fault(format!(
        "nothing moves, and points do, {said}; {wanted}; coloured discs: at most {discs:.3} px"
    )))
}

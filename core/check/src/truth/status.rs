//! What a tracker says of points: who is there, who has left, who is hidden; and points that come and go on the way.

use super::{Case, DEADLINE, FOLLOWS_SHARE, LOST_SHARE, MARGIN_PX, NEAR_PX, SIZE, Score, in_either, shift};
use crate::clip::{Clip, Moved, centre, grid};
use crate::course::{follow, is_at, of_tracker, row, tracker};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, Point, PointRow, Points};
use honami_model::track::Status;

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "truth.ids",
        level: 7,
        claim: "a point keeps its id, is there in every frame, and in the first where it was seeded",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, ids),
    },
    Check {
        id: "truth.outside",
        level: 7,
        claim: "what has left the picture is not called tracked",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, outside),
    },
    Check {
        id: "truth.hidden",
        level: 7,
        claim: "something that passes before the picture takes no point with it",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, hidden),
    },
    Check {
        id: "truth.seeds",
        level: 7,
        claim: "points that are seeded, moved, retired and brought back on the way are followed from there",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, seeds),
    },
];

fn ids(subject: &Subject) -> Result<Verdict, Fault> {
    let (clip, seeds) = Case::moving(shift).texture(subject);
    let all = follow(&mut tracker(subject)?, &clip, &seeds)?;
    let frames: Vec<_> = all.iter().map(|points| points.frame).collect();
    if frames != (0..clip.pictures.len() as i64).collect::<Vec<_>>() {
        return Err(Fault(format!("wanted every frame's points once and in order, got frames {frames:?}")));
    }
    for seed in &seeds {
        let Some(row) = row(&all[0], seed.id) else {
            return Err(Fault(format!(
                "point {} was seeded before the first frame, which has no row of it",
                seed.id
            )));
        };
        if !is_at(row, seed) || row.status != Status::Tracked {
            return Err(Fault(format!(
                "point {} was seeded at ({}, {}) before the first frame, which has it {:?} at ({}, {})",
                seed.id, seed.x, seed.y, row.status, row.x, row.y
            )));
        }
    }
    let n_ended: usize = all.iter().map(|points| points.ended.len()).sum();
    let ended = n_ended as f64 / seeds.len() as f64;
    if ended > LOST_SHARE {
        let n = seeds.len();
        return Err(Fault(format!(
            "{n_ended} of {n} points have no row any more, in a clip that is easy to follow"
        )));
    }
    Ok(Verdict::Holds(if n_ended > 0 { format!("{n_ended} points ended") } else { String::new() }))
}

/// To the right, out of the picture.
fn leaving(t: usize) -> Moved {
    Moved { shift: [4.0 * t as f64, 0.0], ..Moved::NOT }
}

/// A window of a usual size sees nothing more of a point that is so far beyond the border.
const GONE_PX: f64 = 8.0;

fn outside(subject: &Subject) -> Result<Verdict, Fault> {
    let at_the_right = |_| {
        let mut seeds = grid(SIZE, MARGIN_PX, [2, 6], &mut subject.chance("truth.outside"));
        seeds.iter_mut().for_each(|seed| seed.x = SIZE[0] as f32 - 8.0 - (seed.id * 5 % 20) as f32);
        seeds
    };
    in_either(subject, &Case::moving(leaving), at_the_right, |clip, seeds| {
        let all = follow(&mut tracker(subject)?, clip, seeds)?;
        let [mut n_gone, mut n_said, mut n_vouched] = [0_usize; 3];
        for (t, points) in all.iter().enumerate() {
            for seed in seeds {
                let Some(row) = row(points, seed.id).filter(|row| row.status.is_seen()) else { continue };
                if !clip.view(t).gray.holds([row.x, row.y]) {
                    return Err(Fault(format!(
                        "point {} is called tracked at ({}, {}) of a picture of {}x{}",
                        row.id, row.x, row.y, SIZE[0], SIZE[1]
                    )));
                }
                n_said += usize::from(is_gone(seed, t));
                n_vouched += usize::from(is_gone(seed, t) && is_good(row));
            }
            n_gone += seeds.iter().filter(|seed| is_gone(seed, t)).count();
        }
        let said = format!(
            "{n_said} of {n_gone} samples of points that had left are called tracked, {n_vouched} of them with good quality"
        );
        let few = |n: usize| n as f64 <= LOST_SHARE * n_gone as f64;
        // A tracker may leave it to the quality to say so, which then must.
        Ok(if few(n_said) || few(n_vouched) { Ok(said) } else { Err(said) })
    })
}

/// Whether a point is so far beyond the right border that nothing of it is left.
fn is_gone(seed: &Point, t: usize) -> bool {
    let x = leaving(t).there([f64::from(seed.x), 0.0], centre(SIZE))[0];
    x > f64::from(SIZE[0]) - 0.5 + GONE_PX
}

/// Whether the quality of a sample says nothing against it.
fn is_good(row: &PointRow) -> bool {
    row.fb.is_none_or(|fb| fb <= 1.0) && row.ncc.is_none_or(|ncc| ncc >= 0.8)
}

/// Radius of what passes, pixels.
const PASSING_PX: f64 = 10.0;

/// Where it is: over half the height of the picture, from the left to the right.
fn passing(t: usize) -> [f64; 2] {
    [-20.0 + 12.0 * t as f64, 0.5 * f64::from(SIZE[1])]
}

fn slowly(t: usize) -> Moved {
    Moved { shift: [0.5 * t as f64, 0.3 * t as f64], ..Moved::NOT }
}

fn hidden(subject: &Subject) -> Result<Verdict, Fault> {
    let case = Case::moving(slowly);
    let (mut clip, seeds) = case.texture(subject);
    cover(&mut clip);
    let all = follow(&mut tracker(subject)?, &clip, &seeds)?;
    let off = |seed: &Point, t: usize| {
        let truth = slowly(t).there([f64::from(seed.x), f64::from(seed.y)], centre(SIZE));
        (truth[0] - passing(t)[0]).hypot(truth[1] - passing(t)[1])
    };
    let nearest = |seed: &Point| (0..all.len()).map(|t| off(seed, t)).fold(f64::MAX, f64::min);
    let (passed, free): (Vec<Point>, Vec<Point>) =
        seeds.iter().partition(|seed| nearest(seed) < PASSING_PX + GONE_PX);
    let (free, passed) = (Score::of(&all, &free, slowly), Score::of(&all, &passed, slowly));
    let said = format!("points that it passed: {passed}; the others: {free}");
    if free.is_near() && passed.rms_px < FOLLOWS_SHARE * PASSING_PX {
        return Ok(Verdict::Holds(said));
    }
    if free.follows(FOLLOWS_SHARE) {
        return Ok(Verdict::Doubtful(said));
    }
    // Whoever cannot follow a texture at all has been told so before.
    let (clip, seeds) = case.texture(subject);
    let alone = Score::of(&follow(&mut tracker(subject)?, &clip, &seeds)?, &seeds, slowly);
    if alone.follows(FOLLOWS_SHARE) {
        return Err(Fault(format!("{said}; with nothing before the picture: {alone}")));
    }
    Ok(Verdict::Doubtful(format!("it does not follow this texture: {alone}")))
}

/// Lets a plain disc pass before a clip.
fn cover(clip: &mut Clip) {
    let width = clip.width as usize;
    for (t, picture) in clip.pictures.iter_mut().enumerate() {
        let [cx, cy] = passing(t);
        for (k, pixel) in picture.luma.iter_mut().enumerate() {
            if ((k % width) as f64 - cx).hypot((k / width) as f64 - cy) <= PASSING_PX {
                *pixel = 90;
            }
        }
    }
}

/// Points that come and go: one is seeded after frame `CHANGED`,
const NEW: u32 = 901;
/// one that was seeded elsewhere is moved then,
const MOVED: u32 = 902;
/// one is retired after frame `GONE` and brought back after frame `BACK`.
const RETIRED: u32 = 903;
const GONE: usize = 1;
const CHANGED: usize = 2;
const BACK: usize = 3;

fn seeds(subject: &Subject) -> Result<Verdict, Fault> {
    let some = |seeds: Vec<Point>| seeds.into_iter().step_by(4).collect();
    in_either(subject, &Case::moving(shift), some, |clip, seeds| {
        // Their true places are those of seeds, all but that MOVED begins elsewhere.
        let [new, moved, retired] =
            [(NEW, 0), (MOVED, 1), (RETIRED, 2)].map(|(id, k)| Point { id, ..seeds[k] });
        let all = change(subject, clip, [new, moved, retired])?;
        let present =
            |id: u32| -> Vec<usize> { (0..all.len()).filter(|&t| row(&all[t], id).is_some()).collect() };
        let n = all.len();
        let wanted: [(u32, Vec<usize>); 3] = [
            (NEW, (CHANGED + 1..n).collect()),
            (MOVED, (0..n).collect()),
            (RETIRED, (0..=GONE).chain(BACK + 1..n).collect()),
        ];
        for (id, wanted) in wanted {
            let got = present(id);
            if got != wanted {
                let what = ["seeded", "moved", "retired and brought back"][(id - NEW) as usize];
                return Err(Fault(format!(
                    "a point that was {what} has rows in frames {got:?}, wanted {wanted:?}"
                )));
            }
        }
        let offs =
            [(new, CHANGED), (moved, CHANGED), (retired, BACK)].map(|(point, from)| off(&all, point, from));
        let words = offs.map(|off| off.map_or("lost".to_owned(), |(off, _)| format!("off by {off:.2} px")));
        let said = format!("seeded: {}; moved: {}; brought back: {}", words[0], words[1], words[2]);
        let followed = |(off, unmoved): (f64, f64)| off < (FOLLOWS_SHARE * unmoved).max(NEAR_PX);
        Ok(if offs.into_iter().all(|off| off.is_some_and(followed)) { Ok(said) } else { Err(said) })
    })
}

/// Leads a tracker through a clip, where one point is seeded on the way, the second moved, the third taken away and
/// brought back. Points are given as they are in the first frame; what happens to them happens where they then are.
fn change(subject: &Subject, clip: &Clip, [new, moved, retired]: [Point; 3]) -> Result<Vec<Points>, Fault> {
    let (mut tracker, cx) = (tracker(subject)?, CallContext::silent());
    let mut all = Vec::new();
    let then = |point: Point, t: usize| {
        let [x, y] = shift(t).there([f64::from(point.x), f64::from(point.y)], centre(SIZE));
        Point { x: x as f32, y: y as f32, ..point }
    };
    tracker.begin(clip.stream(), &cx)?;
    tracker.seed(&[Point { x: moved.x + 20.0, ..moved }, retired], &cx)?;
    for t in 0..clip.pictures.len() {
        all.extend(tracker.push(&clip.view(t), &cx)?);
        match t {
            CHANGED => tracker.seed(&[then(new, t), then(moved, t)], &cx)?,
            GONE => tracker.retire(&[RETIRED, 4_000_000_000], &cx)?,
            BACK => tracker.seed(&[then(retired, t)], &cx)?,
            _ => {}
        }
    }
    all.extend(tracker.end(&cx)?);
    Ok(all)
}

/// How far a point is off after a frame, and how far it would be had it stayed where it was in that frame, root mean
/// squares, pixels; `None` where it is never seen.
fn off(all: &[Points], point: Point, from: usize) -> Option<(f64, f64)> {
    let truth = |t: usize| shift(t).there([f64::from(point.x), f64::from(point.y)], centre(SIZE));
    let (mut n, mut squares, mut unmoved) = (0.0, 0.0, 0.0);
    for (t, points) in all.iter().enumerate().skip(from + 1) {
        let Some(row) = row(points, point.id).filter(|row| row.status.is_seen()) else { continue };
        let (truth, start) = (truth(t), truth(from));
        n += 1.0;
        squares += (f64::from(row.x) - truth[0]).powi(2) + (f64::from(row.y) - truth[1]).powi(2);
        unmoved += (start[0] - truth[0]).powi(2) + (start[1] - truth[1]).powi(2);
    }
    (n > 0.0).then(|| ((squares / n).sqrt(), (unmoved / n).sqrt()))
}

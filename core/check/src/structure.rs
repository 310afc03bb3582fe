//! Level 8: structure builders against groups that sway on branches that were planted.
//!
//! That a skeleton is one (a tree, bones of constant length, a direction in every frame, groups and tracks that there are)
//! is checked of every answer by the host; here it is provoked.

use crate::clusterer::{SIZE, Samples, tracks};
use crate::course::{HERE, at, refusal};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, Filmed, GroupTree, Grown, HostError, Kind, Tracks, Values};
use honami_model::picture::Gray;
use honami_model::skeleton::seen;
use honami_model::track::Status;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(30);

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "structure.few",
        level: 8,
        claim: "it grows 2 groups of a track; one group it grows or refuses with a reason",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, few),
    },
    Check {
        id: "structure.hard",
        level: 8,
        claim: "it bears tracks that are the same, at rest, short, with gaps, never seen, and masks of all kinds",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, hard),
    },
    Check {
        id: "structure.follows",
        level: 8,
        claim: "every group has a joint, which moves as the group does",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, follows),
    },
    Check {
        id: "structure.leaves",
        level: 8,
        claim: "leaves are seen where their tracks are",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, leaves),
    },
    Check {
        id: "structure.order",
        level: 8,
        claim: "from tracks in another order it grows the same",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, order),
    },
    Check {
        id: "structure.root",
        level: 8,
        claim: "it stands where it is told that the plant leaves the ground",
        deadline: DEADLINE,
        run: |subject| of_structure(subject, root),
    },
];

fn of_structure(subject: &Subject, check: fn(&Subject) -> Result<Verdict, Fault>) -> Result<Verdict, Fault> {
    match subject.info.kind {
        Kind::Structure => check(subject),
        kind => Ok(Verdict::Beside(format!("it is a {kind}"))),
    }
}

/// Where branches sway about, pixels.
const ROOT: [f64; 2] = [160.0, 225.0];

/// Tracks of so many groups, in turn: fanned out above the root, each swaying about it in its own time. 40 frames.
fn planted(chance: &mut Pcg64, n_groups: usize, n: usize) -> Vec<Samples> {
    let track = |k: usize| {
        let group = k % n_groups;
        let lean = 2.0 * ((group as f64 + 0.5) / n_groups as f64 - 0.5);
        let far = 130.0 + 40.0 * (2.3 * group as f64).sin();
        let hz = [0.7, 1.9, 1.2, 2.6][group % 4];
        let beside = [(); 2].map(|()| chance.random_range(-6.0..6.0));
        let sample = |t: usize| {
            let sway = 0.06 * (TAU * hz * t as f64 / crate::clip::FPS + group as f64).sin();
            let (sin, cos) = (lean + sway).sin_cos();
            let place = [ROOT[0] + far * sin + beside[0], ROOT[1] - far * cos + beside[1]];
            (place[0] as f32, place[1] as f32, Status::Tracked)
        };
        (0, (0..40).map(sample).collect())
    };
    (0..n).map(track).collect()
}

/// The tree of so many groups, of which track k is in `group_of[k]`, with the row of each.
fn tree(n_groups: usize, group_of: &[usize]) -> (GroupTree, Vec<usize>) {
    let mut tree = GroupTree::new(group_of.len());
    let mut rows = vec![0; n_groups];
    let mut open = vec![(0..n_groups, None)];
    while let Some((groups, parent)) = open.pop() {
        let row = tree.len();
        if groups.len() == 1 {
            rows[groups.start] = row;
            let own = group_of.iter().enumerate().filter(|(_, group)| **group == groups.start);
            let own: Vec<usize> = own.map(|(track, _)| track).collect();
            tree.push(parent, row as u32, &own);
            continue;
        }
        tree.push(parent, row as u32, &[]);
        let half = groups.start.midpoint(groups.end);
        open.push((half..groups.end, Some(row)));
        open.push((groups.start..half, Some(row)));
    }
    (tree, rows)
}

/// Tracks that take turns in so many groups.
fn in_turn(all: &[Samples], n_groups: usize) -> (Tracks, GroupTree, Vec<usize>) {
    let group_of: Vec<usize> = (0..all.len()).map(|k| k % n_groups).collect();
    let (groups, rows) = tree(n_groups, &group_of);
    (tracks(all), groups, rows)
}

/// Tracks of four groups.
pub(crate) fn four_groups(chance: &mut Pcg64, n: usize) -> (Tracks, GroupTree) {
    let (tracks, groups, _) = in_turn(&planted(chance, 4, n), 4);
    (tracks, groups)
}

fn bare<'a>(tracks: &'a Tracks, groups: &'a GroupTree) -> Filmed<'a> {
    Filmed { tracks, groups, root: None, mask: None }
}

fn run(subject: &Subject, filmed: &Filmed<'_>) -> Result<Grown, HostError> {
    subject.structure(HERE, &Values::default())?.run(filmed, &CallContext::silent())
}

/// Whether it grows this; what it may refuse with a reason, it may.
fn grows(subject: &Subject, filmed: &Filmed<'_>, may_refuse: bool) -> Result<bool, HostError> {
    match run(subject, filmed) {
        Ok(_) => Ok(true),
        Err(error) if may_refuse && refusal(&error).is_some() => Ok(false),
        Err(error) => Err(error),
    }
}

fn refuses(refused: &[&str]) -> Verdict {
    Verdict::Holds(if refused.is_empty() {
        String::new()
    } else {
        format!("refuses: {}", refused.join(", "))
    })
}

fn few(subject: &Subject) -> Result<Verdict, Fault> {
    let mut refused = Vec::new();
    for (what, n_groups, n) in
        [("one track", 1, 1), ("one group", 1, 3), ("two groups of a track", 2, 2), ("three groups", 3, 4)]
    {
        let (tracks, groups, _) =
            in_turn(&planted(&mut subject.chance("structure.few"), n_groups, n), n_groups);
        if !grows(subject, &bare(&tracks, &groups), n_groups == 1).map_err(at(what))? {
            refused.push(what);
        }
    }
    Ok(refuses(&refused))
}

fn hard(subject: &Subject) -> Result<Verdict, Fault> {
    let base = planted(&mut subject.chance("structure.hard"), 2, 10);
    let changed = |change: fn(usize, &mut Samples)| {
        let mut all = base.clone();
        all.iter_mut().enumerate().for_each(|(k, track)| change(k, track));
        all
    };
    let cases: [(&str, Vec<Samples>); 8] = [
        ("all the same", vec![base[0].clone(); 6]),
        ("all in one place", changed(|_, (_, samples)| samples.fill((50.0, 60.0, Status::Tracked)))),
        (
            "at rest",
            changed(|_, (_, samples)| {
                let first = samples[0];
                samples.fill(first);
            }),
        ),
        ("one frame", changed(|_, (_, samples)| samples.truncate(1))),
        (
            "gaps",
            changed(|k, (_, samples)| {
                samples.iter_mut().skip(k).step_by(3).for_each(|sample| sample.2 = Status::Lost);
            }),
        ),
        ("a group never seen", changed(|k, (_, samples)| lose(samples, k % 2 == 0))),
        ("never seen", changed(|_, (_, samples)| lose(samples, true))),
        (
            "one after the other",
            changed(|k, (first, samples)| {
                *first = 4 * k as i64;
                samples.truncate(4);
            }),
        ),
    ];
    let mut refused = Vec::new();
    for (name, given) in &cases {
        let (tracks, groups, _) = in_turn(given, 2);
        if !grows(subject, &bare(&tracks, &groups), true).map_err(at(name))? {
            refused.push(*name);
        }
    }
    let (tracks, groups, _) = in_turn(&base, 2);
    let [width, height] = SIZE;
    let white = vec![255; width as usize * height as usize];
    let half: Vec<u8> = (0..white.len()).map(|k| u8::from(k % (width as usize) < 160)).collect();
    for (name, data) in
        [("a white mask", &white), ("half a mask", &half), ("a black mask", &vec![0; white.len()])]
    {
        let mask = Some(Gray { data, width, height, stride: width as usize });
        if !grows(subject, &Filmed { mask, ..bare(&tracks, &groups) }, true).map_err(at(name))? {
            refused.push(name);
        }
    }
    Ok(refuses(&refused))
}

fn lose(samples: &mut [(f32, f32, Status)], is_lost: bool) {
    samples.iter_mut().filter(|_| is_lost).for_each(|sample| sample.2 = Status::Lost);
}

/// Where the first joint of a group is seen, frame by frame.
fn joint_of(grown: &Grown, group: usize) -> Result<Vec<[f64; 2]>, Fault> {
    let found = grown.bears.iter().find(|pair| pair.1 as usize == group);
    let joint = found.ok_or_else(|| Fault(format!("group {group} has no joint")))?.0 as usize;
    let skeleton = &grown.skeleton;
    let place = |frame| seen(skeleton.places(skeleton.directions(frame))[joint]);
    Ok((0..skeleton.times().len()).map(place).collect())
}

/// The mean over a group's tracks, which take turns, in every frame.
fn centre(all: &[Samples], group: usize, n_groups: usize) -> Vec<[f64; 2]> {
    let own: Vec<&Samples> = all.iter().skip(group).step_by(n_groups).collect();
    let mean = |t: usize| {
        let sum = own.iter().fold([0.0; 2], |sum, (_, samples)| {
            [sum[0] + f64::from(samples[t].0), sum[1] + f64::from(samples[t].1)]
        });
        sum.map(|v| v / own.len() as f64)
    };
    (0..own[0].1.len()).map(mean).collect()
}

/// How far places are from their mean, root mean square.
fn spread(places: &[[f64; 2]]) -> f64 {
    let n = places.len() as f64;
    let mean = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / n);
    let squares = places.iter().map(|place| (place[0] - mean[0]).powi(2) + (place[1] - mean[1]).powi(2));
    (squares.sum::<f64>() / n).sqrt()
}

/// What may be left of the motion of a group beside its joint's: published methods shift joints half of the way to what bears
/// them, so that they move half as far (zeng leaves .49, diener .29 at most of 24 seeds), and a tenth is theirs to lose. A
/// joint that follows a third of the motion, or none, is beyond it.
const LEFT: f64 = 0.6;

fn follows(subject: &Subject) -> Result<Verdict, Fault> {
    let mut most = 0.0_f64;
    for n_groups in [2, 4, 7] {
        let all = planted(&mut subject.chance("structure.follows"), n_groups, 5 * n_groups);
        let (tracks, groups, rows) = in_turn(&all, n_groups);
        // Where it sways about is known: a bone of constant length from elsewhere could not follow.
        let grown = run(subject, &Filmed { root: Some(ROOT), ..bare(&tracks, &groups) })?;
        for (group, &row) in rows.iter().enumerate() {
            let (joint, centre) = (joint_of(&grown, row)?, centre(&all, group, n_groups));
            let beside: Vec<[f64; 2]> =
                joint.iter().zip(&centre).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
            let left = spread(&beside) / spread(&centre);
            let is_followed = left <= LEFT;
            if !is_followed {
                return Err(Fault(format!(
                    "of {n_groups} groups, {left:.2} of the motion of group {row} is not that of its joint"
                )));
            }
            most = most.max(left);
        }
    }
    Ok(Verdict::Holds(format!("{most:.2} of the motion left at most")))
}

/// Whether places so far apart are one: samples are f32. What is no number is not.
fn is_one(off_px: f64) -> bool {
    off_px <= 1e-3
}

fn leaves(subject: &Subject) -> Result<Verdict, Fault> {
    let all = planted(&mut subject.chance("structure.leaves"), 3, 12);
    let (tracks, groups, _) = in_turn(&all, 3);
    let skeleton = run(subject, &bare(&tracks, &groups))?.skeleton;
    let mut n = 0;
    for (id, (_, samples)) in tracks.ids().iter().zip(&all) {
        // The first: others are copies.
        let Some(leaf) = skeleton.leaves().iter().find(|leaf| leaf.track.0 == *id) else { continue };
        n += 1;
        for ((frame, sample), offset) in (0_u32..).zip(samples).zip(&leaf.offsets) {
            let from = skeleton.places(skeleton.directions(frame))[leaf.joint as usize];
            let place = seen(std::array::from_fn(|axis| from[axis] + offset[axis]));
            let off = (place[0] - f64::from(sample.0)).hypot(place[1] - f64::from(sample.1));
            if !is_one(off) {
                return Err(Fault(format!("in frame {frame} the leaf of track {id} is {off} px from it")));
            }
        }
    }
    Ok(match n {
        0 => Verdict::Beside("it has no leaves".into()),
        n => Verdict::Holds(format!("{n} of {} tracks", all.len())),
    })
}

fn order(subject: &Subject) -> Result<Verdict, Fault> {
    let mut chance = subject.chance("structure.order");
    let (n_groups, all) = (4, planted(&mut chance, 4, 20));
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.shuffle(&mut chance);
    let mixed: Vec<Samples> = order.iter().map(|&k| all[k].clone()).collect();
    let group_of: Vec<usize> = order.iter().map(|k| k % n_groups).collect();
    let (straight_tracks, straight, rows) = in_turn(&all, n_groups);
    let (mixed_tracks, mixed) = (tracks(&mixed), tree(n_groups, &group_of).0);
    let [a, b] = [(&straight_tracks, &straight), (&mixed_tracks, &mixed)]
        .map(|(tracks, groups)| run(subject, &bare(tracks, groups)));
    let (a, b) = (a?, b?);
    for row in rows {
        let (was, is) = (joint_of(&a, row)?, joint_of(&b, row)?);
        let mut off = was.iter().zip(&is).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        if let Some(off) = off.find(|off| !is_one(*off)) {
            return Err(Fault(format!("in another order the joint of group {row} is {off} px away")));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

fn root(subject: &Subject) -> Result<Verdict, Fault> {
    let (tracks, groups, _) = in_turn(&planted(&mut subject.chance("structure.root"), 3, 9), 3);
    for root in [ROOT, [131.5, 239.25]] {
        let grown = run(subject, &Filmed { root: Some(root), ..bare(&tracks, &groups) })?;
        let stands = seen(grown.skeleton.root());
        if !is_one((stands[0] - root[0]).hypot(stands[1] - root[1])) {
            return Err(Fault(format!("told that the root is at {root:?} px, it stands at {stands:?}")));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

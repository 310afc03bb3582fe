//! Level 8: clusterers against groups that were planted.
//!
//! That a hierarchy is well-formed (n - 1 merges of n leaves, each cluster merged once, sizes that add up, heights that
//! are finite) is checked of every answer by the host; here it is provoked.

use crate::course::{HERE, refusal};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, Clustering, HostError, Kind, Tracks, Values};
use honami_model::hierarchy::Dendrogram;
use honami_model::track::Status;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(30);

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "clusterer.few",
        level: 8,
        claim: "it groups 2 and 3 tracks; none and one it groups or refuses with a reason",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, few),
    },
    Check {
        id: "clusterer.hard",
        level: 8,
        claim: "it bears tracks that are the same, at rest, short, with gaps, and never seen together",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, hard),
    },
    Check {
        id: "clusterer.groups",
        level: 8,
        claim: "it finds groups that move apart and differently",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, groups),
    },
    Check {
        id: "clusterer.heights",
        level: 8,
        claim: "merges come in the order of their heights",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, heights),
    },
    Check {
        id: "clusterer.order",
        level: 8,
        claim: "tracks in another order are grouped the same",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, order),
    },
    Check {
        id: "clusterer.scale",
        level: 8,
        claim: "a picture of twice the size is grouped the same",
        deadline: DEADLINE,
        run: |subject| of_clusterer(subject, scale),
    },
];

fn of_clusterer(subject: &Subject, check: fn(&Subject) -> Result<Verdict, Fault>) -> Result<Verdict, Fault> {
    match subject.info.kind {
        Kind::Clusterer => check(subject),
        kind => Ok(Verdict::Beside(format!("it is a {kind}"))),
    }
}

/// A track: its first frame, and samples that may not have been seen.
pub(crate) type Samples = (i64, Vec<(f32, f32, Status)>);

/// Size of the pictures.
pub(crate) const SIZE: [u32; 2] = [320, 240];

/// Tracks of so many groups, in turn; each group has a place, a frequency and a direction of its own. 40 frames.
fn planted(chance: &mut Pcg64, n_groups: usize, n: usize) -> Vec<Samples> {
    let track = |k: usize| {
        let group = k % n_groups;
        let angle = TAU * group as f64 / n_groups as f64;
        let mut near = || chance.random_range(-8.0..8.0);
        let (x, y) = (160.0 + 90.0 * angle.cos() + near(), 120.0 + 70.0 * angle.sin() + near());
        let hz = [0.7, 1.9, 1.2, 2.6][group % 4];
        let sample = |t: usize| {
            let sway = 9.0 * (TAU * hz * t as f64 / crate::clip::FPS + angle).sin();
            let (dx, dy) = (sway * angle.cos() - 0.3 * sway * angle.sin(), sway * angle.sin());
            ((x + dx) as f32, (y + dy) as f32, Status::Tracked)
        };
        (0, (0..40).map(sample).collect())
    };
    (0..n).map(track).collect()
}

/// What a clusterer or a structure builder is given; tracks have ids of their own, 7 apart.
pub(crate) fn tracks(all: &[Samples]) -> Tracks {
    let end = all.iter().map(|(first, samples)| first + samples.len() as i64).max().unwrap_or(0);
    let times = (0..end).map(|t| t as f64 / crate::clip::FPS).collect();
    let mut tracks = Tracks::new(SIZE[0], SIZE[1], 0, times);
    for (k, (first, samples)) in (0_u32..).zip(all) {
        tracks.push(100 + 7 * k, *first, samples.iter().copied());
    }
    tracks.seed = 1;
    tracks
}

/// Tracks of two groups.
pub(crate) fn two_groups(chance: &mut Pcg64, n: usize) -> Tracks {
    tracks(&planted(chance, 2, n))
}

fn run(subject: &Subject, tracks: &Tracks) -> Result<Clustering, HostError> {
    subject.clusterer(HERE, &Values::default())?.run(tracks, &CallContext::silent())
}

fn few(subject: &Subject) -> Result<Verdict, Fault> {
    let mut refused = Vec::new();
    for n in 0..=3 {
        let given = two_groups(&mut subject.chance("clusterer.few"), n);
        match run(subject, &given) {
            Ok(_) => {}
            Err(error) if n < 2 && refusal(&error).is_some() => refused.push(n.to_string()),
            Err(error) => return Err(Fault(format!("{n} tracks: {error}"))),
        }
    }
    Ok(Verdict::Holds(if refused.is_empty() {
        String::new()
    } else {
        format!("refuses {}", refused.join(" and "))
    }))
}

fn hard(subject: &Subject) -> Result<Verdict, Fault> {
    let base = planted(&mut subject.chance("clusterer.hard"), 2, 10);
    let changed = |change: fn(usize, &mut Samples)| {
        let mut all = base.clone();
        all.iter_mut().enumerate().for_each(|(k, track)| change(k, track));
        all
    };
    let cases: [(&str, Vec<Samples>); 7] = [
        ("all the same", vec![base[0].clone(); 6]),
        ("pairs of the same", base.iter().take(4).flat_map(|track| [track.clone(), track.clone()]).collect()),
        (
            "at rest",
            changed(|_, (_, samples)| {
                let first = samples[0];
                samples.iter_mut().for_each(|sample| *sample = first);
            }),
        ),
        ("one sample", changed(|_, (_, samples)| samples.truncate(1))),
        (
            "gaps",
            changed(|k, (_, samples)| {
                samples.iter_mut().skip(k).step_by(3).for_each(|sample| sample.2 = Status::Lost);
            }),
        ),
        (
            "never seen",
            changed(|k, (_, samples)| {
                if k < 3 {
                    samples.iter_mut().for_each(|sample| sample.2 = Status::Lost);
                }
            }),
        ),
        (
            "one after the other",
            changed(|k, (first, samples)| {
                *first = 4 * k as i64;
                samples.truncate(4);
            }),
        ),
    ];
    let mut refused = Vec::new();
    for (name, given) in cases {
        match run(subject, &tracks(&given)) {
            Ok(_) => {}
            Err(error) if refusal(&error).is_some() => refused.push(name),
            Err(error) => return Err(Fault(format!("tracks that are {name}: {error}"))),
        }
    }
    Ok(Verdict::Holds(if refused.is_empty() {
        String::new()
    } else {
        format!("refuses: {}", refused.join(", "))
    }))
}

fn groups(subject: &Subject) -> Result<Verdict, Fault> {
    for n_groups in [2_usize, 3, 4] {
        let given = planted(&mut subject.chance("clusterer.groups"), n_groups, 8 * n_groups);
        let found = run(subject, &tracks(&given))?.dendrogram.cut(n_groups as u32);
        // Tracks of the groups take turns: who is n_groups apart belongs together, and nobody else.
        let n = given.len();
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
        let wrong = pairs.filter(|&(a, b)| (found[a] == found[b]) != (a % n_groups == b % n_groups)).count();
        if wrong > 0 {
            let all = n * (n - 1) / 2;
            return Err(Fault(format!(
                "of {n_groups} planted groups, {wrong} of {all} pairs of tracks are wrong"
            )));
        }
    }
    Ok(Verdict::Holds("2, 3 and 4 groups".into()))
}

fn heights(subject: &Subject) -> Result<Verdict, Fault> {
    let tree = run(subject, &two_groups(&mut subject.chance("clusterer.heights"), 24))?.dendrogram;
    let falls = tree.merges().windows(2).position(|pair| pair[1].height < pair[0].height);
    Ok(match falls {
        // Centroid linkage does that: legal, and the cut of such a tree says little.
        Some(k) => Verdict::Doubtful(format!("merge {} is lower than the one before it", k + 1)),
        None => Verdict::Holds(String::new()),
    })
}

/// Rounding may differ where sums are taken in another order.
const ALIKE: f64 = 1e-6;

fn order(subject: &Subject) -> Result<Verdict, Fault> {
    let mut chance = subject.chance("clusterer.order");
    let given = planted(&mut chance, 3, 21);
    let mut order: Vec<usize> = (0..given.len()).collect();
    order.shuffle(&mut chance);
    let mixed: Vec<_> = order.iter().map(|&k| given[k].clone()).collect();
    let (straight, mixed) =
        (run(subject, &tracks(&given))?.dendrogram, run(subject, &tracks(&mixed))?.dendrogram);
    same_tree(&straight, &mixed, &order).map_err(|what| Fault(format!("in another order {what}")))?;
    Ok(Verdict::Holds(String::new()))
}

/// Whether two trees have the same groups at every cut, and heights that are alike; leaf k of the second is `order[k]` of
/// the first.
fn same_tree(a: &Dendrogram, b: &Dendrogram, order: &[usize]) -> Result<(), String> {
    for (k, (a, b)) in sorted(a).iter().zip(&sorted(b)).enumerate() {
        if (a - b).abs() > ALIKE * a.abs().max(b.abs()) {
            return Err(format!("merge {k} has height {b}, wanted {a}"));
        }
    }
    for n_groups in 2..order.len() as u32 {
        let (groups, mixed) = (a.cut(n_groups), b.cut(n_groups));
        let differs =
            |(k, l): &(usize, usize)| (groups[order[*k]] == groups[order[*l]]) != (mixed[*k] == mixed[*l]);
        let pairs = (0..order.len()).flat_map(|k| (0..k).map(move |l| (k, l)));
        if let Some((k, l)) = pairs.into_iter().find(differs) {
            return Err(format!(
                "tracks {} and {} are grouped otherwise at {n_groups} groups",
                order[k], order[l]
            ));
        }
    }
    Ok(())
}

fn sorted(tree: &Dendrogram) -> Vec<f64> {
    let mut heights: Vec<_> = tree.merges().iter().map(|merge| merge.height).collect();
    heights.sort_by(f64::total_cmp);
    heights
}

fn scale(subject: &Subject) -> Result<Verdict, Fault> {
    let given = planted(&mut subject.chance("clusterer.scale"), 3, 18);
    let mut large = given.clone();
    for sample in large.iter_mut().flat_map(|(_, samples)| samples) {
        (sample.0, sample.1) = (2.0 * sample.0, 2.0 * sample.1);
    }
    let mut large = tracks(&large);
    (large.width, large.height) = (2 * SIZE[0], 2 * SIZE[1]);
    let (small, large) = (run(subject, &tracks(&given))?.dendrogram, run(subject, &large)?.dendrogram);
    let (small, large) = (small.cut(3), large.cut(3));
    let same = (0..small.len()).all(|k| (0..k).all(|l| (small[k] == small[l]) == (large[k] == large[l])));
    Ok(if same {
        Verdict::Holds(String::new())
    } else {
        Verdict::Doubtful("3 groups of a larger picture are others".into())
    })
}

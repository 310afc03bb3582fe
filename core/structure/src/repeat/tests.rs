//! Loops of motions that come back exactly, and of those that do not.

use honami_model::skeleton::Joint;
use honami_model::track::TrackId;

use super::*;

/// All frames that there are.
const WHOLE: Range<u32> = 0..u32::MAX;

/// Two bones, the second as far from upright as `angle` says.
fn swinging(n_frames: u32, angle: impl Fn(f64) -> f64) -> Skeleton {
    let bone = |parent| Joint { parent: Some(parent), length: 50.0, ..Joint::default() };
    let joints = vec![Joint::default(), bone(0), bone(1)];
    let pose = |t: u32| {
        let angle = angle(f64::from(t));
        let half = angle / 2.0;
        [[0.0, 0.0, 1.0], [half.sin(), 0.0, half.cos()], [angle.sin(), 0.0, angle.cos()]]
    };
    let leaf = |t: u32| [3.0, f64::from(t), angle(f64::from(t))];
    let leaf = Leaf { track: TrackId(4), joint: 2, offsets: (0..n_frames).map(leaf).collect() };
    let times = FrameTimes::constant(n_frames, 25.0).unwrap();
    Skeleton::new([0.0; 3], joints, (0..n_frames).flat_map(pose).collect(), times)
        .unwrap()
        .with_leaves(vec![leaf])
        .unwrap()
}

/// The farthest that the tip goes in a step from each frame to the next, the last one round to the first.
fn steps(skeleton: &Skeleton) -> Vec<f64> {
    let n = skeleton.times().len();
    let tip = |t: u32| skeleton.places(skeleton.directions(t % n))[2];
    (0..n)
        .map(|t| {
            let (a, b) = (tip(t), tip(t + 1));
            (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
        })
        .collect()
}

#[test]
fn a_motion_that_comes_back_is_cut_where_it_does() {
    let skeleton = swinging(100, |t| 0.4 * (t * std::f64::consts::TAU / 40.0).sin());
    let (looped, frames) = repeat(&skeleton, WHOLE).unwrap();
    // Half periods differ in where it goes on to.
    assert_eq!((frames.end - frames.start) % 40, 0, "{frames:?}");
    for (k, frame) in frames.clone().enumerate() {
        let far = looped.directions(k as u32)[2][0] - skeleton.directions(frame)[2][0];
        assert!(far.abs() < 1e-9, "nothing has to be corrected: {far} in frame {frame}");
    }
    assert_eq!(looped.times().get(0), skeleton.times().get(frames.start), "times are those of the clip");
    assert_eq!(looped.leaves()[0].offsets.len(), frames.len());
}

#[test]
fn a_motion_that_does_not_come_back_has_no_jump_either() {
    let skeleton = swinging(90, |t| 0.3 * (t * 0.31).sin() + 0.2 * (t * 0.173 + 1.0).sin() + 0.002 * t);
    let (looped, frames) = repeat(&skeleton, WHOLE).unwrap();
    assert!(frames.len() >= 45);
    let steps = steps(&looped);
    let (last, others) = steps.split_last().unwrap();
    let most = others.iter().copied().fold(0.0, f64::max);
    assert!(*last < most * 1.05, "{last} px from the last to the first, {most} px at most elsewhere");
    let leaf = &looped.leaves()[0].offsets;
    assert!((leaf[leaf.len() - 1][1] - leaf[0][1]).abs() < 1e-9, "what only drifts is taken back");
}

/// Against every range, each summed from all bones: none has ends more alike.
#[test]
fn no_other_range_has_a_smaller_jump() {
    let mut n_found = 0;
    for seed in 0..8_u32 {
        let phase = f64::from(seed);
        let skeleton =
            swinging(40, |t| 0.4 * (t * (0.31 + 0.07 * phase)).sin() + 0.2 * (t * t * 0.013 + phase).cos());
        let jump = |first: u32, end: u32| -> f64 {
            let pose = |frame: u32| skeleton.directions(frame);
            let squares = |row: usize, axis: usize| {
                let apart = pose(end)[row][axis] - pose(first)[row][axis];
                let on = pose(first + 1)[row][axis] - pose(first)[row][axis];
                let off = pose(end)[row][axis] - pose(end - 1)[row][axis];
                apart.powi(2) + (off - on).powi(2)
            };
            let of = |row: usize| (0..3).map(|axis| squares(row, axis)).sum::<f64>();
            (1..3).map(|row| skeleton.joints()[row].length * of(row)).sum()
        };
        let found = repeat(&skeleton, WHOLE).unwrap().1;
        let least = (0..20).flat_map(|first| (first + 20..40).map(move |end| (first, end)));
        let least = least.map(|(first, end)| jump(first, end)).fold(f64::INFINITY, f64::min);
        assert!(jump(found.start, found.end) <= least * (1.0 + 1e-9), "{found:?}");
        n_found += usize::from(found != (0..20));
    }
    assert!(n_found > 4, "not always the first");
}

#[test]
fn a_loop_takes_four_frames() {
    let error = repeat(&swinging(3, |t| t), WHOLE).unwrap_err();
    assert_eq!(error, StructureError::TooBrief { came: 3, wanted: 4 });
    let (looped, frames) = repeat(&swinging(4, |_| 0.1), WHOLE).unwrap();
    assert_eq!(looped.times().len() as usize, frames.len());
}

/// What stands still repeats best, and is no part of what may be.
#[test]
fn a_loop_is_of_the_frames_that_it_may_be_of() {
    let skeleton = swinging(300, |t| if t < 100.0 { 0.3 * (t * 0.31).sin() + 0.002 * t } else { 0.1 });
    assert!(repeat(&skeleton, WHOLE).unwrap().1.start >= 100);
    let (looped, frames) = repeat(&skeleton, 20..100).unwrap();
    assert!(frames.start >= 20 && frames.end < 100 && frames.len() >= 40, "{frames:?}");
    assert!(steps(&looped).iter().any(|step| *step > 1.0));
    let error = repeat(&skeleton, 50..53).unwrap_err();
    assert_eq!(error, StructureError::TooBrief { came: 3, wanted: 4 });
}

#[test]
fn what_is_closed_ends_as_it_begins() {
    let skeleton = swinging(5, |t| 0.1 * t);
    let found = closed(&skeleton, 0.25).unwrap();
    assert_eq!(found.times().as_slice()[..5], *skeleton.times().as_slice());
    assert_eq!((found.times().len(), found.times().get(5)), (6, Some(0.25)));
    for (frame, of) in [0, 1, 2, 3, 4, 0].into_iter().enumerate() {
        assert_eq!(found.directions(frame as u32), skeleton.directions(of));
    }
    assert!(matches!(closed(&skeleton, 0.16), Err(StructureError::Times(_))));
}

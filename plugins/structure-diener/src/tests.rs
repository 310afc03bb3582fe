//! What the plugin hands over is what the algorithm has grown, to the last bit.

use honami_plugin::testing::{Samples, grow};
use honami_plugin::{Filmed, Gray, Groups};
use honami_structure::diener;

use super::*;

/// Two groups of two tracks on a fork, and a track of no group.
const GROUPS: Groups<'static> = Groups { parents: &[-1, 0, 0], of: &[1, 2, 1, 2, -1] };

fn samples() -> Samples {
    let mut samples = Samples::new(5, 0, 30, |track, frame| {
        let (side, time) = (if track % 2 == 0 { -1.0 } else { 1.0 }, f64::from(frame) / 5.0);
        let sway = 12.0 * (time + side).sin();
        [400.0 + side * 120.0 + sway + 9.0 * f64::from(track), 200.0 + 0.3 * sway + 5.0 * f64::from(track)]
    });
    samples.lose(2, 4..11, [0.0, 0.0]);
    samples
}

#[test]
fn the_skeleton_is_that_of_the_library() {
    let samples = samples();
    for (flat, root) in [(true, Some([390.0, 560.0])), (false, None)] {
        let filmed = Filmed { tracks: samples.tracks(), groups: GROUPS, root, mask: None };
        let skeleton = grow::<Diener>(&Settings { flat }, &filmed).unwrap();
        let seen = honami_growing::seen(&filmed).unwrap();
        let settings = diener::Settings { root, is_flat: flat };
        let grown = diener::grow(&seen.paths, &seen.groups, &seen.times, settings).unwrap();
        let wanted = &grown.skeleton;
        let lengths: Vec<u64> = skeleton.joints.iter().map(|joint| joint.length.to_bits()).collect();
        let wanted_lengths: Vec<u64> = wanted.joints().iter().map(|joint| joint.length.to_bits()).collect();
        assert_eq!(lengths, wanted_lengths);
        let pose: Vec<[f64; 3]> = (0..30).flat_map(|frame| wanted.directions(frame)).copied().collect();
        assert_eq!(
            (&skeleton.pose, skeleton.root.map(f64::to_bits)),
            (&pose, wanted.root().map(f64::to_bits))
        );
        // Forks are told of, too, of the copy in the picture; tips of the mirror image as well.
        for (group, joint) in (0_u32..).zip(&grown.joint_of) {
            let told: Vec<u32> = (0_u32..)
                .zip(&skeleton.joints)
                .filter(|(_, joint)| joint.groups.contains(&group))
                .map(|(row, _)| row)
                .collect();
            let n = if flat || group == 0 { 1 } else { 2 };
            assert_eq!((told.first(), told.len()), (joint.as_ref(), n), "group {group}");
        }
        assert_eq!(skeleton.leaves.len(), wanted.leaves().len());
        for (leaf, wanted) in skeleton.leaves.iter().zip(wanted.leaves()) {
            assert_eq!((leaf.joint, 100 + leaf.track), (wanted.joint, wanted.track.0));
            assert_eq!(leaf.offsets, wanted.offsets);
        }
    }
}

#[test]
fn what_does_not_grow_says_why() {
    let still = Samples::new(5, 0, 3, |_, _| [0.0, 0.0]);
    let filmed = Filmed { tracks: still.tracks(), groups: GROUPS, root: None, mask: None };
    let error = grow::<Diener>(&Settings::default(), &filmed).unwrap_err();
    assert!(error.to_string().contains("place the root elsewhere"), "{error}");
    let pixels = vec![255; 800 * 600];
    let mask = Some(Gray::packed(&pixels, 800, 600));
    let error = grow::<Diener>(&Settings::default(), &Filmed { mask, ..filmed }).unwrap_err();
    assert!(error.to_string().contains("it knows no envelope"), "{error}");
}

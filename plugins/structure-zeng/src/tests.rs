//! What the plugin hands over is what the algorithm has grown, to the last bit.

use honami_plugin::testing::{Samples, grow};
use honami_plugin::{Filmed, Gray, Groups};
use honami_structure::zeng::Alpha;

use super::*;

const SIZE: [usize; 2] = [800, 600];

/// Four groups of two tracks, on two forks on a fork.
const GROUPS: Groups<'static> = Groups { parents: &[-1, 0, 1, 1, 0, 4, 4], of: &[2, 3, 5, 6, 2, 3, 5, 6] };

fn samples() -> Samples {
    Samples::new(8, 0, 20, |track, frame| {
        let (group, time) = (f64::from(track % 4), f64::from(frame) / 5.0);
        let lean = 0.5 * (group - 1.5) + 0.03 * (time + group).sin();
        let far = 300.0 + 20.0 * group;
        [400.0 + far * lean.sin() + f64::from(track), 500.0 - far * lean.cos() - 2.0 * f64::from(track)]
    })
}

#[test]
fn the_skeleton_is_that_of_the_library() {
    let samples = samples();
    let middle: Vec<u8> =
        (0..SIZE[0] * SIZE[1]).map(|k| u8::from((270..530).contains(&(k % SIZE[0])))).collect();
    let mask = Gray::packed(&middle, SIZE[0] as u32, SIZE[1] as u32);
    let white = middle.iter().map(|pixel| 255 * pixel).collect();
    let painted = Alpha { width: SIZE[0], pixels: white };
    for (flat, mask, envelope) in
        [(true, None, None), (false, None, None), (false, Some(mask), Some(painted))]
    {
        let root = Some([400.0, 580.0]);
        let is_painted = mask.is_some();
        let filmed = Filmed { tracks: samples.tracks(), groups: GROUPS, root, mask };
        let settings = Settings { flat, shift: 0.2, copies: 4 };
        let skeleton = grow::<Zeng>(&settings, &filmed).unwrap();
        let seen = honami_growing::seen(&filmed).unwrap();
        let settings = zeng::Settings { root, is_flat: flat, shift: 0.2, copies: 4, envelope };
        let grown = zeng::grow(&seen.paths, &seen.groups, &seen.times, &settings).unwrap();
        let wanted = &grown.skeleton;
        let pose: Vec<[f64; 3]> = (0..20).flat_map(|frame| wanted.directions(frame)).copied().collect();
        assert_eq!(skeleton.pose, pose);
        assert_eq!(
            (skeleton.joints.len(), skeleton.leaves.len()),
            (wanted.joints().len(), wanted.leaves().len())
        );
        // Every group where a joint is that the library says it is.
        for (group, joint) in (0_u32..).zip(&grown.joint_of) {
            let told = (0_u32..).zip(&skeleton.joints).find(|(_, joint)| joint.groups.contains(&group));
            assert_eq!(told.map(|(row, _)| row), *joint, "group {group}");
        }
        let n_left_out = grown.joint_of.iter().filter(|joint| joint.is_none()).count();
        assert_eq!((n_left_out > 0, grown.n_cut > 0), (is_painted, is_painted), "{:?}", grown.joint_of);
    }
}

#[test]
fn an_envelope_without_white_says_so() {
    let (samples, black) = (samples(), vec![0; SIZE[0] * SIZE[1]]);
    let mask = Some(Gray::packed(&black, SIZE[0] as u32, SIZE[1] as u32));
    let filmed = Filmed { tracks: samples.tracks(), groups: GROUPS, root: None, mask };
    let error = grow::<Zeng>(&Settings::default(), &filmed).unwrap_err();
    assert!(error.to_string().contains("paint white where branches may be"), "{error}");
}

//! Rigs of loops, read by another's reader.

use gltf::animation::util::ReadOutputs;
use honami_model::clip::FrameTimes;
use honami_model::skeleton::Joint;

use super::*;

/// What wraps from the last key to the first has no jump there, and takes as long as the frames that are filmed.
#[test]
fn rigs_of_loops_end_as_they_begin() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let joint = |parent: u32| Joint { parent: Some(parent), length: 1.0, ..Joint::default() };
    let lean = |rad: f64| [rad.sin(), 0.0, rad.cos()];
    let directions = [0.1, 0.5, -0.3, -0.6].iter().flat_map(|by| [lean(0.0), lean(*by), lean(2.0 * by)]);
    let times = FrameTimes::new(vec![3.0, 3.1, 3.2, 3.3]).unwrap();
    let joints = vec![Joint::default(), joint(0), joint(1)];
    let skeleton = Skeleton::new([0.0; 3], joints, directions.collect(), times).unwrap();
    for (again_s, wanted) in [(None, vec![0.0, 0.1, 0.2, 0.3]), (Some(3.42), vec![0.0, 0.1, 0.2, 0.3, 0.42])]
    {
        let carried = Carried {
            bound: None,
            library: None,
            unit: 1.0,
            blend: Blend::Linear,
            fewer: None,
            again_s,
            are_weights_shown: false,
        };
        for (name, kind) in
            [("a.glb", Out::Rig), ("a.usda", Out::Usd), ("%d.ply", Out::Frames(MeshFormat::Ply))]
        {
            write(&skeleton, 0, kind, &carried, &at(name)).unwrap();
        }
        assert!(at("3.ply").exists() && !at("4.ply").exists(), "frames are those of the clip");
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&fs::read(at("a.glb")).unwrap()).unwrap();
        let animation = document.animations().next().unwrap();
        let mut n_turned = 0;
        for channel in animation.channels() {
            let reader = channel.reader(|_| blob.as_deref());
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            assert_eq!(times.len(), wanted.len());
            assert!(times.iter().zip(&wanted).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{times:?}");
            let Some(ReadOutputs::Rotations(turns)) = reader.read_outputs() else { continue };
            let turns: Vec<[f32; 4]> = turns.into_f32().collect();
            let along =
                |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>().abs();
            // A quaternion and its negative are one turn.
            let is_back = 1.0 - along(turns[0], turns[wanted.len() - 1]) < 1e-6;
            assert!(1.0 - along(turns[0], turns[3]) > 1e-3, "else every motion is a loop");
            assert_eq!(is_back, again_s.is_some());
            n_turned += 1;
        }
        // Ends of tips do not turn.
        assert!(n_turned >= 2, "{n_turned}");
        let text = fs::read_to_string(at("a.usda")).unwrap();
        let keys = text.split("timeSamples = {").nth(1).unwrap().split('}').next().unwrap();
        let keys: Vec<&str> = keys.lines().filter_map(|line| Some(line.split_once(": ")?.1)).collect();
        assert_eq!((keys.len(), keys[0] == keys[keys.len() - 1]), (wanted.len(), again_s.is_some()));
        let end = if again_s.is_some() { "endTimeCode = 4.2\n" } else { "endTimeCode = 3\n" };
        assert!(text.contains(end), "{text}");
    }
}

//! A structure builder: a bone from the root to the middle of every group.

use honami_plugin::{Cx, Error, Filmed, Info, Joint, Leaf, Result, Skeleton, Structure, export, params};

params! {
    /// What the user may choose.
    pub struct Choice {
        /// Whether every bone carries the tracks of its group.
        leaves: bool = true => { label: "Leaves" },
    }
}

struct Fan;

impl Structure for Fan {
    type Params = Choice;
    const INFO: Info = Info {
        id: "org.honami.fan",
        name: "Fan",
        doc: "A bone from the root to the middle of every group.",
        ..Info::NEW
    };

    fn grow(params: &Choice, filmed: &Filmed<'_>, cx: &Cx<'_>) -> Result<Skeleton> {
        let (groups, n_frames) = (filmed.groups, filmed.tracks.times_s.len());
        let mut fan = Vec::new();
        for group in (0..groups.len()).filter(|&group| groups.parts(group).next().is_none()) {
            cx.progress(group as f64 / groups.len() as f64, "following groups")?;
            let tracks: Vec<usize> = groups.tracks(group).collect();
            let middle = middle(filmed, &tracks, n_frames);
            fan.push((group, tracks, middle.ok_or_else(|| Error::data("a group is never seen"))?));
        }
        let [x, y] = filmed.root.unwrap_or_else(|| below(fan.iter().flat_map(|(_, _, middle)| middle)));
        let mut joints = vec![Joint::default()];
        // Of every bone where it points, frame by frame; the root's counts for nothing.
        let mut bones = vec![vec![[0.0, 0.0, 1.0]; n_frames]];
        let mut leaves = Vec::new();
        for (group, tracks, middle) in fan {
            let apart = || middle.iter().map(|at| (at[0] - x, y - at[1]));
            let length = apart().map(|(x, z)| x.hypot(z)).sum::<f64>() / n_frames as f64;
            if length < 1e-6 {
                return Err(Error::data("a group is where the root is"));
            }
            let way = |(x, z): (f64, f64)| match x.hypot(z) {
                far if far > 0.0 => [x / far, 0.0, z / far],
                _ => [0.0, 0.0, 1.0],
            };
            let bone: Vec<[f64; 3]> = apart().map(way).collect();
            for &track in tracks.iter().filter(|_| params.leaves) {
                let offset = |(frame, way): (usize, &[f64; 3])| {
                    let end = [x + length * way[0], y - length * way[2]];
                    let [right, down] = seen(filmed, track, frame).unwrap_or(middle[frame]);
                    [right - end[0], 0.0, end[1] - down]
                };
                let offsets = bone.iter().enumerate().map(offset).collect();
                leaves.push(Leaf { joint: joints.len() as u32, track: track as u32, offsets });
            }
            joints.push(Joint { parent: Some(0), length, groups: vec![group as u32] });
            bones.push(bone);
        }
        let pose = (0..n_frames).flat_map(|frame| bones.iter().map(move |bone| bone[frame])).collect();
        Ok(Skeleton { root: [x, 0.0, -y], joints, pose, leaves })
    }
}

/// Where a track is seen in a frame, pixels (right, down).
fn seen(filmed: &Filmed<'_>, track: usize, frame: usize) -> Option<[f64; 2]> {
    let track = filmed.tracks.get(track)?;
    let first = track.first_frame - filmed.tracks.first_time;
    let k = usize::try_from(frame as i64 - first).ok().filter(|&k| track.seen(k))?;
    Some([f64::from(track.x[k]), f64::from(track.y[k])])
}

/// The mean of tracks, frame by frame; as in the frame before where none is seen, and at first as when one is. `None`
/// where none ever is.
fn middle(filmed: &Filmed<'_>, tracks: &[usize], n_frames: usize) -> Option<Vec<[f64; 2]>> {
    let mean = |frame: usize| {
        let places: Vec<[f64; 2]> = tracks.iter().filter_map(|&track| seen(filmed, track, frame)).collect();
        let sum = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>();
        (!places.is_empty()).then(|| [0, 1].map(|axis| sum(axis) / places.len() as f64))
    };
    let mut last = (0..n_frames).find_map(mean)?;
    let middle = (0..n_frames).map(|frame| {
        last = mean(frame).unwrap_or(last);
        last
    });
    Some(middle.collect())
}

/// Under the middle of places, as low as the lowest.
fn below<'a>(places: impl Iterator<Item = &'a [f64; 2]>) -> [f64; 2] {
    let (mut n, mut sum, mut lowest) = (0.0, 0.0, 0.0_f64);
    for place in places {
        (n, sum, lowest) = (n + 1.0, sum + place[0], lowest.max(place[1]));
    }
    [sum / f64::max(n, 1.0), lowest]
}

export! {
    library: { id: "org.honami.fan", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [structure Fan],
}

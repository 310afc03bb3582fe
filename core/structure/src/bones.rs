//! From places of groups to bones of constant length that reach them.

mod reach;

use honami_model::skeleton::Joint;

use self::reach::reach;
use crate::filmed::Track;
use crate::tree::Group;

/// A fork is one with what bears it where its bone is shorter than this share of the mean bone that it bears.
const COLLAPSE: f64 = 0.1;
/// Nothing is that short, of the farthest any group is from the root.
const TINY: f64 = 1e-9;

/// So often bones that end at groups are made as long as these ask for.
const ROUNDS: u32 = 6;

/// Joints and their motion.
#[derive(Debug)]
pub(crate) struct Bones {
    /// Each after its parent, the root first.
    pub(crate) joints: Vec<Joint>,
    /// Of every joint, a frame each, unit.
    pub(crate) directions: Vec<Track>,
    /// Where every joint is, a frame each.
    pub(crate) at: Vec<Track>,
    /// The joint that each group has become.
    pub(crate) joint_of: Vec<u32>,
    /// Forks that were one with what bears them.
    pub(crate) n_collapsed: usize,
}

impl Bones {
    /// Bones from a base that stays to where groups are.
    pub(crate) fn along(groups: &[Group], base: [f64; 3], at: &[Track]) -> Self {
        let n_frames = at.first().map_or(0, Vec::len);
        let still = vec![base; n_frames];
        let farthest = at.iter().map(|track| mean_distance(&still, track)).fold(0.0, f64::max);
        let mut bones = Self {
            joints: vec![Joint::default()],
            directions: vec![vec![[0.0, 0.0, 1.0]; n_frames]],
            at: vec![still],
            joint_of: Vec::with_capacity(groups.len()),
            n_collapsed: 0,
        };
        for (group, track) in groups.iter().zip(at) {
            let parent = group.parent.map_or(0, |row| bones.joint_of[row]);
            let length = mean_distance(&bones.at[parent as usize], track);
            let borne = group.children.iter().map(|&child| mean_distance(track, &at[child]));
            let wanted = COLLAPSE * borne.sum::<f64>() / group.children.len().max(1) as f64;
            if length < wanted || length <= TINY * farthest {
                bones.n_collapsed += usize::from(!group.children.is_empty());
                bones.joint_of.push(parent);
            } else {
                bones.joint_of.push(bones.joints.len() as u32);
                bones.aim(parent, length, track);
            }
        }
        bones.reach(groups, at);
        bones
    }

    /// Moves bones so that joints of terminal groups are where these are, as near as they come; bones that end there are
    /// made as long as that asks for in the mean, and moved again.
    fn reach(&mut self, groups: &[Group], at: &[Track]) {
        let mut target_of = vec![None; self.joints.len()];
        for (row, joint) in
            self.joint_of.iter().enumerate().filter(|(row, _)| groups[*row].children.is_empty())
        {
            target_of[*joint as usize] = Some(&at[row]);
        }
        for round in 0..ROUNDS {
            for (row, target) in target_of.iter().enumerate().skip(1).filter(|_| round > 0) {
                let (Some(target), Some(parent)) = (target, self.joints[row].parent) else {
                    continue;
                };
                let length = mean_distance(&self.at[parent as usize], target);
                // One that would have none keeps what it has.
                if length > TINY * self.joints[row].length {
                    self.joints[row].length = length;
                }
            }
            (0..self.at[0].len()).for_each(|frame| self.reach_in(frame, &target_of));
        }
    }

    /// The same in one frame.
    fn reach_in(&mut self, frame: usize, target_of: &[Option<&Track>]) {
        let targets: Vec<Option<[f64; 3]>> =
            target_of.iter().map(|track| track.map(|track| track[frame])).collect();
        let mut places: Vec<[f64; 3]> = self.at.iter().map(|track| track[frame]).collect();
        reach(&self.joints, &targets, &mut places);
        for (row, joint) in self.joints.iter().enumerate().skip(1) {
            let from = places[joint.parent.unwrap_or(0) as usize];
            let apart = std::array::from_fn(|axis| places[row][axis] - from[axis]);
            let length = distance(places[row], from);
            if length > TINY * joint.length {
                self.directions[row][frame] = apart.map(|v: f64| v / length);
            }
            let direction = self.directions[row][frame];
            places[row] = std::array::from_fn(|axis| from[axis] + joint.length * direction[axis]);
            self.at[row][frame] = places[row];
        }
    }

    /// One more bone, aimed from where its base has come to be. Where it has no direction, for its ends are one, it points as
    /// in the frame before; in the first frames, as when it first has one.
    fn aim(&mut self, parent: u32, length: f64, track: &Track) {
        let from = &self.at[parent as usize];
        let towards = |(from, to): (&[f64; 3], &[f64; 3])| {
            let far = distance(*from, *to);
            (far > TINY * length).then(|| std::array::from_fn(|axis| (to[axis] - from[axis]) / far))
        };
        let seen: Vec<Option<[f64; 3]>> = from.iter().zip(track).map(towards).collect();
        let mut last = seen.iter().flatten().next().copied().unwrap_or([0.0, 0.0, 1.0]);
        let directions: Track = seen
            .into_iter()
            .map(|direction| {
                last = direction.unwrap_or(last);
                last
            })
            .collect();
        let end = |(from, direction): (&[f64; 3], &[f64; 3])| {
            std::array::from_fn(|axis| from[axis] + length * direction[axis])
        };
        let at = from.iter().zip(&directions).map(end).collect();
        self.at.push(at);
        self.directions.push(directions);
        self.joints.push(Joint { parent: Some(parent), length, ..Joint::default() });
    }

    /// Adds the mirror image behind the plane of the root, which both share; returns how many rows further on the image of
    /// a joint is.
    pub(crate) fn mirror(&mut self) -> u32 {
        let n = self.joints.len() - 1;
        let by = n as u32;
        for row in 1..=n {
            let parent = self.joints[row].parent.map(|parent| if parent == 0 { 0 } else { parent + by });
            self.joints.push(Joint { parent, ..self.joints[row].clone() });
            for tracks in [&mut self.directions, &mut self.at] {
                let image = tracks[row].iter().map(|&[x, y, z]| [x, -y, z]).collect();
                tracks.push(image);
            }
        }
        by
    }
}

fn mean_distance(a: &Track, b: &Track) -> f64 {
    a.iter().zip(b).map(|(a, b)| distance(*a, *b)).sum::<f64>() / a.len().max(1) as f64
}

/// From one place to another, pixels.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

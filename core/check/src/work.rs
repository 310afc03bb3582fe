//! A plugin with something to do, in steps that may come from anybody, between those of another, or not at all.

use crate::clip::{Clip, Texture, grid};
use crate::course::difference;
use crate::simulator::{DT, PLAIN, sapling};
use crate::{Subject, clusterer, structure};
use honami_host::{
    CallContext, Clusterer, Clustering, Filmed, GroupTree, Grown, HostError, Hosting, Kind, Node,
    PlantInstance, Point, Points, Simulator, Steps, StreamInfo, Structure, Tracker, Tracks, Values, WindRows,
};

/// What there is to do: a clip with points to follow, tracks to group, groups to grow from, or copies of a plant to
/// move.
#[derive(Clone, Debug)]
pub(crate) enum Task {
    Follow { clip: Clip, seeds: Vec<Point> },
    Group(Tracks),
    Grow { tracks: Tracks, groups: GroupTree },
    Sway { nodes: Vec<Node>, copies: Vec<PlantInstance>, steps_a_call: u32 },
}

/// So many calls move a plant.
const SWAYS: usize = 10;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    Points(Vec<Points>),
    Clustering(Option<Clustering>),
    Grown(Option<Grown>),
    Motion(Vec<Vec<[f32; 3]>>),
}

impl Outcome {
    /// Where another one differs, in words; `None` if they are the same.
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        match (self, other) {
            (Self::Points(a), Self::Points(b)) => difference(a, b),
            (Self::Motion(a), Self::Motion(b)) => {
                let call = a.iter().zip(b).position(|(a, b)| a != b);
                call.map(|call| format!("another motion from call {call} on"))
            }
            (Self::Grown(a), Self::Grown(b)) => (a != b).then(|| "another skeleton".into()),
            (a, b) => (a != b).then(|| "another hierarchy".into()),
        }
    }
}

impl Task {
    /// A small texture that moves, 20 points and 10 frames; or 40 tracks; or 40 nodes.
    pub(crate) fn small(subject: &Subject) -> Self {
        Self::of(subject, [96, 72], 10, [5, 4], 40)
    }

    /// One that moves to and fro for ever, as small as makes sense.
    pub(crate) fn endless(subject: &Subject) -> Self {
        Self::of(subject, [48, 36], 8, [3, 2], 12)
    }

    /// As many points as take a while; or as many tracks. Programs, most of them interpreted, take longer over each.
    pub(crate) fn large(subject: &Subject) -> Self {
        let points = if subject.info.is_program() { [80, 60] } else { [160, 120] };
        Self::of(subject, [160, 120], 3, points, 400)
    }

    fn of(
        subject: &Subject,
        size: [u32; 2],
        n_frames: usize,
        columns_and_rows: [u32; 2],
        n_tracks: usize,
    ) -> Self {
        let mut chance = subject.chance("work");
        match subject.info.kind {
            Kind::Tracker => {
                let texture = Texture::new(&mut chance);
                let at =
                    |[x, y]: [f64; 2], t: usize| 128.0 + texture.at([x - 0.9 * t as f64, y + 0.4 * t as f64]);
                let margin_px = 0.2 * f64::from(size[1]);
                let seeds = grid(size, margin_px, columns_and_rows, &mut chance);
                Self::Follow { clip: Clip::new(size, n_frames, at), seeds }
            }
            Kind::Clusterer => Self::Group(clusterer::two_groups(&mut chance, n_tracks)),
            Kind::Structure => {
                let (tracks, groups) = structure::four_groups(&mut chance, n_tracks);
                Self::Grow { tracks, groups }
            }
            // What takes a large one its time is steps.
            Kind::Simulator => {
                let copies = (0..5).map(|k| PlantInstance { yaw: k as f32, ..PLAIN }).collect();
                let steps_a_call = if n_tracks > 100 { 20_000 } else { 12 };
                Self::Sway { nodes: sapling(&mut chance, n_tracks as u32), copies, steps_a_call }
            }
        }
    }

    /// Of nothing done yet.
    fn nothing(&self) -> Outcome {
        match self {
            Self::Follow { .. } => Outcome::Points(Vec::new()),
            Self::Group(_) => Outcome::Clustering(None),
            Self::Grow { .. } => Outcome::Grown(None),
            Self::Sway { .. } => Outcome::Motion(Vec::new()),
        }
    }
}

/// A plugin at a task.
pub(crate) struct Work<'a> {
    plugin: Plugin,
    task: &'a Task,
    n_threads: u32,
    step: usize,
    outcome: Outcome,
}

enum Plugin {
    Tracker(Box<Tracker>),
    Clusterer(Clusterer),
    Structure(Structure),
    Simulator(Box<Simulator>),
}

impl<'a> Work<'a> {
    /// Starts a plugin with its defaults.
    pub(crate) fn start(subject: &Subject, hosting: Hosting, task: &'a Task) -> Result<Self, HostError> {
        let values = Values::default();
        let plugin = match task {
            Task::Follow { .. } => Plugin::Tracker(Box::new(subject.tracker(hosting, &values)?)),
            Task::Group(_) => Plugin::Clusterer(subject.clusterer(hosting, &values)?),
            Task::Grow { .. } => Plugin::Structure(subject.structure(hosting, &values)?),
            Task::Sway { .. } => Plugin::Simulator(Box::new(subject.simulator(hosting, &values)?)),
        };
        Ok(Self { plugin, task, n_threads: 1, step: 0, outcome: task.nothing() })
    }

    /// Lets it use more threads than one.
    pub(crate) fn threads(self, n_threads: u32) -> Self {
        Self { n_threads, ..self }
    }

    /// The same instance at another task, or at the same again.
    pub(crate) fn again(self, task: &'a Task) -> Self {
        Self { task, step: 0, outcome: task.nothing(), ..self }
    }

    /// Makes the next call; whether it was the last.
    pub(crate) fn step(&mut self, cx: &CallContext<'_>) -> Result<bool, HostError> {
        let step = self.step;
        self.step += 1;
        match (&mut self.plugin, self.task, &mut self.outcome) {
            (Plugin::Tracker(tracker), Task::Follow { clip, seeds }, Outcome::Points(all)) => {
                let n = clip.pictures.len();
                match step {
                    0 => {
                        let stream = StreamInfo {
                            max_threads: self.n_threads,
                            births: 50_000..50_200,
                            ..clip.stream()
                        };
                        tracker.begin(stream, cx)?;
                    }
                    1 => tracker.seed(seeds, cx)?,
                    step if step < n + 2 => all.extend(tracker.push(&clip.view(step - 2), cx)?),
                    _ => all.extend(tracker.end(cx)?),
                }
                Ok(step > n + 1)
            }
            (Plugin::Clusterer(clusterer), Task::Group(tracks), Outcome::Clustering(found)) => {
                let mut tracks = tracks.clone();
                tracks.max_threads = self.n_threads;
                *found = Some(clusterer.run(&tracks, cx)?);
                Ok(true)
            }
            (Plugin::Structure(structure), Task::Grow { tracks, groups }, Outcome::Grown(grown)) => {
                let mut tracks = tracks.clone();
                tracks.max_threads = self.n_threads;
                let filmed = Filmed { tracks: &tracks, groups, root: None, mask: None };
                *grown = Some(structure.run(&filmed, cx)?);
                Ok(true)
            }
            (Plugin::Simulator(simulator), Task::Sway { .. }, Outcome::Motion(all)) => {
                // Another round after the last.
                let at = step % (SWAYS + 1);
                if at == 0 {
                    all.clear();
                }
                all.extend(sway(simulator, self.task, at, self.n_threads, cx)?);
                Ok(at == SWAYS)
            }
            // A plugin has one kind, and its tasks are of that kind.
            _ => Ok(true),
        }
    }

    /// All calls that are left.
    pub(crate) fn finish(&mut self) -> Result<Outcome, HostError> {
        let cx = CallContext::silent();
        while !self.step(&cx)? {}
        Ok(self.outcome.clone())
    }

    /// The tracker, if it is one.
    pub(crate) fn tracker(&mut self) -> Option<&mut Tracker> {
        match &mut self.plugin {
            Plugin::Tracker(tracker) => Some(tracker),
            Plugin::Clusterer(_) | Plugin::Structure(_) | Plugin::Simulator(_) => None,
        }
    }

    /// What has come so far.
    pub(crate) fn outcome(&self) -> &Outcome {
        &self.outcome
    }
}

/// Call `step` of a simulator: it is prepared, then led through a wind that turns.
fn sway(
    simulator: &mut Simulator,
    task: &Task,
    step: usize,
    n_threads: u32,
    cx: &CallContext<'_>,
) -> Result<Option<Vec<[f32; 3]>>, HostError> {
    let Task::Sway { nodes, copies, steps_a_call } = task else { return Ok(None) };
    if step == 0 {
        simulator.prepare(nodes, copies, n_threads, 1, cx)?;
        return Ok(None);
    }
    let wind = WindRows {
        times_s: &[0.0, 0.2, 0.4],
        velocities: &[[1.0, 0.0, 0.0], [0.0, 5.0, 0.5], [-3.0, 0.0, 0.0]],
    };
    let steps = Steps { dt: DT, n: *steps_a_call, wind, detail: None };
    Ok(Some(simulator.step(&steps, cx)?.to_vec()))
}

//! What trackers are measured on: generated clips, pairs of pictures, tuning forks, and clips whose truth nobody knows.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::lab::{Lab, Pace};

/// Names of the sets, and what is in them.
pub(super) const SETS: [(&str, &str); 10] = [
    ("calm", "generated foliage, 1.5 px a frame, three seeds"),
    ("wind", "the same, 3.4 px a frame"),
    ("storm", "the same, 5.8 px a frame"),
    ("middlebury", "three pairs of pictures with their flow"),
    ("dic14", "three pairs of the DIC challenge's sample 14"),
    ("forks", "three tuning forks"),
    ("walnut", "a digitised walnut that is pulled and let go"),
    ("waving", "the building behind a shaken tree: it stands still"),
    ("malva", "mallow and pinnate leaves in wind"),
    ("reeds", "reeds in strong wind, 150 frames"),
];

/// Seeds of the generated clips.
pub(super) const SEEDS: [u32; 3] = [1, 2, 3];
/// Forks: their tone and the true frame rate.
pub(super) const FORKS: [(u32, u32); 3] = [(32, 500), (64, 1000), (128, 250)];
/// Columns of the DIC challenge's truth.
pub(super) const LEVELS: [(&str, usize); 3] = [("L1", 1), ("L3", 3), ("L5", 5)];
pub(super) const PAIRS: [&str; 3] = ["RubberWhale", "Hydrangea", "Grove2"];

/// One thing on which every tracker is measured.
pub(super) struct Case {
    /// Unique; rows are kept under it.
    pub(super) name: String,
    /// Generated clips are measured by the script of OpenCV, too.
    pub(super) is_generated: bool,
    /// Points for a quick tracker, a middling one and a slow one; 0: it is not measured here.
    limits: [usize; 3],
    pub(super) what: What,
}

/// What is done there.
pub(super) enum What {
    /// `honami compare`.
    Pictures {
        clip: Vec<PathBuf>,
        truth: Option<PathBuf>,
        points: PathBuf,
        /// Parameters, for trackers that have them.
        set: Vec<(&'static str, &'static str)>,
        /// So many of the frames.
        n_frames: Option<u32>,
        /// Whether points are tracked back, too.
        passes: bool,
    },
    /// `honami track`, `honami spectrum`.
    Fork { clip: PathBuf, points: PathBuf, fps: u32 },
    /// The same of a clip that says how fast it is, with the swing that was filmed.
    Walnut { clip: PathBuf, points: PathBuf, hz: f64, damping: f64 },
}

impl Case {
    pub(super) fn n_points(&self, pace: Pace) -> Option<usize> {
        let [quick, middling, slow] = self.limits;
        let n = match pace {
            Pace::Quick => quick,
            Pace::Middling => middling,
            Pace::Slow => slow,
        };
        (n > 0).then_some(n)
    }
}

/// Makes what is not there yet.
pub(super) fn prepare(lab: &Lab, sets: &[String]) -> anyhow::Result<Vec<Case>> {
    render(lab, "probe", "calm", 7, 10)?;
    let mut cases = Vec::new();
    for (set, _) in SETS.iter().filter(|(set, _)| sets.is_empty() || sets.iter().any(|wanted| wanted == set))
    {
        match (*set, &lab.data) {
            ("calm" | "wind" | "storm", _) => cases.extend(foliage(lab, set)?),
            (_, None) => {}
            ("middlebury", Some(data)) => cases.extend(middlebury(lab, data)?),
            ("dic14", Some(data)) => cases.extend(dic(lab, data)?),
            ("forks", Some(data)) => cases.extend(forks(lab, data)?),
            ("walnut", Some(data)) => cases.push(walnut(lab, data)?),
            ("waving", Some(data)) => cases.push(waving(lab, data)?),
            ("malva", Some(data)) => {
                cases.push(real(lab, "malva", &data.join("video/malva.mp4"), None)?);
                cases.push(real(lab, "leaves_cut", &data.join("video/leaves_cut.mp4"), None)?);
            }
            (_, Some(data)) => {
                cases.push(real(lab, "reeds_wind", &data.join("video/reeds_wind.mp4"), Some(150))?);
            }
        }
    }
    Ok(cases)
}

/// Renders a clip with its truth, and lists the points that are visible in its first frame.
fn render(lab: &Lab, name: &str, level: &str, seed: u32, n_frames: u32) -> anyhow::Result<PathBuf> {
    let clip = lab.folder.join(format!("{name}.y4m"));
    let points = clip.with_extension("points.csv");
    if !points.is_file() {
        let (seed, n_frames) = (seed.to_string(), n_frames.to_string());
        let words = ["--wind", level, "--leaves", "2600", "--frames", &n_frames, "--seed", &seed];
        if clip.exists() {
            fs::remove_file(&clip).with_context(|| format!("cannot remove {}", clip.display()))?;
        }
        lab.honami()?.arg("synth").arg(&clip).args(words).output()?;
        let truth = clip.with_extension("truth.csv");
        let text = fs::read_to_string(&truth).with_context(|| format!("cannot read {}", truth.display()))?;
        write(&points, visible_at_first(&text).as_bytes())?;
    }
    Ok(clip)
}

/// The points of a truth table that can be seen in frame 0, as a table of points.
fn visible_at_first(truth: &str) -> String {
    let mut points = String::from("id,x,y\n");
    for line in truth.lines().skip(1) {
        if let [id, "0", x, y, "1", ..] = line.split(',').collect::<Vec<_>>()[..] {
            points += &format!("{id},{x},{y}\n");
        }
    }
    points
}

fn foliage(lab: &Lab, level: &str) -> anyhow::Result<Vec<Case>> {
    let case = |seed| {
        let name = format!("{level}-{seed}");
        let clip = render(lab, &name, level, seed, 150)?;
        let what = What::Pictures {
            truth: Some(clip.with_extension("truth.csv")),
            points: clip.with_extension("points.csv"),
            clip: vec![clip],
            set: Vec::new(),
            n_frames: None,
            passes: false,
        };
        let limits = if seed == SEEDS[0] { [1200, 400, 100] } else { [1200, 300, 0] };
        Ok(Case { name, is_generated: true, limits, what })
    };
    SEEDS.into_iter().map(case).collect()
}

/// A fixed choice of points, so that all trackers have the same: the corners of a clip's first frame as KLT finds them.
fn corners(lab: &Lab, name: &str, clip: &Path, words: &[&str]) -> anyhow::Result<PathBuf> {
    let points = lab.folder.join(format!("{name}.points.csv"));
    if !points.is_file() {
        let project = lab.folder.join(format!("{name}.corners.honami"));
        let table = lab.folder.join(format!("{name}.corners.csv"));
        for old in [&project, &table] {
            fs::remove_file(old).or_else(|error| match error.kind() {
                std::io::ErrorKind::NotFound => Ok(()),
                _ => Err(error),
            })?;
        }
        lab.honami()?.arg("new").arg(&project).arg(clip).output()?;
        let harris =
            ["--detect", "klt", "--frames", "0..1", "--set", "method=harris", "--set", "quality=0.001"];
        lab.honami()?.arg("track").arg(&project).args(harris).args(words).output()?;
        lab.honami()?.arg("export").arg(&project).arg("tracks").arg(&table).output()?;
        let text = fs::read_to_string(&table).with_context(|| format!("cannot read {}", table.display()))?;
        let cells = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            Some(format!("{},{},{}\n", cells.first()?, cells.get(3)?, cells.get(4)?))
        };
        let rows: String = text.lines().skip(1).filter_map(cells).collect();
        write(&points, format!("id,x,y\n{rows}").as_bytes())?;
    }
    Ok(points)
}

fn middlebury(lab: &Lab, data: &Path) -> anyhow::Result<Vec<Case>> {
    let case = |pair: &str| {
        let folder = data.join("flow/middlebury").join(pair);
        let set = ["--set", "max_features=3000", "--set", "distance=7"];
        let points = corners(lab, pair, &folder, &set)?;
        let clip = ["frame10.png", "frame11.png"].map(|name| folder.join(name)).to_vec();
        let (truth, set) = (Some(folder.join("flow10.flo")), Vec::new());
        let what = What::Pictures { clip, truth, points, set, n_frames: None, passes: false };
        Ok(Case { name: pair.to_owned(), is_generated: false, limits: [3000, 3000, 1000], what })
    };
    PAIRS.into_iter().map(case).collect()
}

/// The picture of the DIC challenge, and how far its grid of points stays from the edges, pixels.
const DIC_SIZE: [usize; 2] = [2048, 589];
const DIC_MARGIN: usize = 40;
const DIC_STEP: usize = 16;

/// The truth says by how much every column moves to the right.
fn dic(lab: &Lab, data: &Path) -> anyhow::Result<Vec<Case>> {
    let folder = data.join("dic/challenge14");
    let table = folder.join("command.csv");
    let text = fs::read_to_string(&table).with_context(|| format!("cannot read {}", table.display()))?;
    let rows: Vec<Vec<f32>> = text
        .lines()
        .map(|line| line.split(',').map_while(|cell| cell.trim().parse().ok()).collect())
        .collect();
    let points = lab.folder.join("dic14.points.csv");
    let [width, height] = DIC_SIZE;
    let across = (DIC_MARGIN..width - DIC_MARGIN).step_by(DIC_STEP);
    let grid = across.flat_map(|x| (DIC_MARGIN..height - DIC_MARGIN).step_by(DIC_STEP).map(move |y| (x, y)));
    let grid = (0..).zip(grid).map(|(id, (x, y)): (usize, _)| format!("{id},{x},{y}\n"));
    write(&points, std::iter::once("id,x,y\n".to_owned()).chain(grid).collect::<String>().as_bytes())?;
    let case = |(level, column): (&str, usize)| {
        let moves = rows.iter().map(|row| row.get(column).copied().context("command.csv lacks columns"));
        let moves: Vec<f32> = moves.collect::<anyhow::Result<_>>()?;
        anyhow::ensure!(moves.len() >= width, "{} has {} rows, wanted {width}", table.display(), moves.len());
        let truth = lab.folder.join(format!("dic14-{level}.flo"));
        // The .flo format: docs of core/exchange/src/flo.rs.
        let mut bytes = b"PIEH".to_vec();
        bytes.extend([width as u32, height as u32].map(u32::to_le_bytes).as_flattened());
        for _ in 0..height {
            moves[..width].iter().for_each(|u| bytes.extend([u.to_le_bytes(), [0; 4]].as_flattened()));
        }
        write(&truth, &bytes)?;
        let clip = ["Reference".to_owned(), format!("{level} Amp0.1b")];
        let clip = clip.map(|name| folder.join(format!("Sample14 {name}.tif"))).to_vec();
        // The window of the reference run in the data's README: 31x31.
        let (truth, points, set) = (Some(truth), points.clone(), vec![("radius", "15")]);
        let what = What::Pictures { clip, truth, points, set, n_frames: None, passes: false };
        let limits = [4000, 4000, 1000];
        Ok(Case { name: format!("dic14-{level}"), is_generated: false, limits, what })
    };
    LEVELS.into_iter().map(case).collect()
}

fn forks(lab: &Lab, data: &Path) -> anyhow::Result<Vec<Case>> {
    let folder = data.join("video/tuning_forks");
    let table = folder.join("rois_x_y_w_h.csv");
    let text = fs::read_to_string(&table).with_context(|| format!("cannot read {}", table.display()))?;
    let case = |(tone, fps): (u32, u32)| {
        let name = format!("fork-{tone}");
        let is_it = format!("{tone},{fps},");
        let region =
            text.lines().find_map(|line| line.strip_prefix(&is_it)).context("no region of the fork")?;
        let clip = folder.join(format!("tuning_{tone}hz_{fps}fps.mp4"));
        let points = corners(lab, &name, &clip, &["--region", region, "--set", "max_features=60"])?;
        let what = What::Fork { clip, points, fps };
        Ok(Case { name, is_generated: false, limits: [60, 40, 20], what })
    };
    FORKS.into_iter().map(case).collect()
}

/// How the walnut is filmed: `honami synth`.
pub(super) const WALNUT: &str = "--classes S --pull 0.3 --frames 500 --size 480x360";

/// The wood of a walnut of the OpenAlea project, its slowest mode pulled out by 0.3 m and let go; leaves are the points.
fn walnut(lab: &Lab, data: &Path) -> anyhow::Result<Case> {
    let clip = lab.folder.join("walnut.y4m");
    let (points, said) = (clip.with_extension("points.csv"), clip.with_extension("json"));
    if !points.is_file() {
        if clip.exists() {
            fs::remove_file(&clip).with_context(|| format!("cannot remove {}", clip.display()))?;
        }
        let plant = data.join("trees/openalea_mtg/noylum2.mtg");
        let line = lab.honami()?.arg("synth").arg(&clip).arg("--plant").arg(&plant);
        write(&said, line.args(WALNUT.split(' ')).arg("--json").output()?.as_bytes())?;
        let truth = clip.with_extension("truth.csv");
        let text = fs::read_to_string(&truth).with_context(|| format!("cannot read {}", truth.display()))?;
        write(&points, visible_at_first(&text).as_bytes())?;
    }
    let text = fs::read_to_string(&said).with_context(|| format!("cannot read {}", said.display()))?;
    let swing = &serde_json::from_str::<serde_json::Value>(&text)?["plant"];
    let number = |key: &str| swing[key].as_f64().with_context(|| format!("{} has no {key}", said.display()));
    let what = What::Walnut { clip, points, hz: number("hz")?, damping: number("damping")? };
    Ok(Case { name: "walnut".to_owned(), is_generated: false, limits: [300, 100, 40], what })
}

/// The building at the left edge of the picture stands still until a man walks in at frame 242.
fn waving(lab: &Lab, data: &Path) -> anyhow::Result<Case> {
    let clip = data.join("video/WavingTrees");
    let set = ["--region", "1,18,16,62", "--set", "distance=3"];
    let points = corners(lab, "waving", &clip, &set)?;
    let truth = lab.folder.join("waving.truth.csv");
    let text = fs::read_to_string(&points).with_context(|| format!("cannot read {}", points.display()))?;
    let still = text.lines().skip(1).flat_map(|point| {
        let (id, at) = point.split_once(',').unwrap_or_default();
        (0..240).map(move |frame| format!("{id},{frame},{at},1,0\n"))
    });
    let head = "track,frame,x,y,visible,branch\n".to_owned();
    write(&truth, std::iter::once(head).chain(still).collect::<String>().as_bytes())?;
    let (clip, set, truth) = (vec![clip], Vec::new(), Some(truth));
    let what = What::Pictures { clip, truth, points, set, n_frames: Some(240), passes: false };
    Ok(Case { name: "waving".to_owned(), is_generated: false, limits: [400; 3], what })
}

/// A clip of which no truth is known: what is kept, and what comes back.
fn real(lab: &Lab, name: &str, clip: &Path, n_frames: Option<u32>) -> anyhow::Result<Case> {
    let points = corners(lab, name, clip, &["--set", "max_features=400", "--set", "distance=5"])?;
    let what = What::Pictures {
        clip: vec![clip.to_owned()],
        truth: None,
        points,
        set: Vec::new(),
        n_frames,
        passes: true,
    };
    Ok(Case { name: name.to_owned(), is_generated: false, limits: [400, 150, 60], what })
}

fn write(file: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    fs::write(file, bytes).with_context(|| format!("cannot write {}", file.display()))
}

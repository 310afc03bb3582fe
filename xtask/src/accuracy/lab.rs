//! Where rows are measured and kept: the program, its trackers, and the folder of clips and answers.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde_json::{Value, json as object};

use super::cases::{Case, What};
use super::json;
use crate::shell::{Step, built, target_dir};

/// Clips, points and rows of another version are made again: raise it when the measure or the cases change.
const VERSION: u32 = 2;
/// A tracker that takes no longer for a frame than so many times KLT's time is given everything;
const QUICK: f64 = 10.0;
/// one that takes longer than so many, very little.
const SLOW: f64 = 40.0;
/// Whose time is the unit, on whatever machine.
const UNIT: &str = "klt";

/// So many frames of a clip that is tracked both ways.
const SLOW_FRAMES: u32 = 100;

/// Who is measured.
pub(super) enum Tracker {
    /// A plugin: its short name and the hash of its content.
    Plugin { name: String, sha256: String, params: Vec<String> },
    /// OpenCV's KLT, by the script that is the peer of other benchmarks, too.
    Peer { version: String },
}

/// How much a tracker is given, so that all of it ends in a quarter of an hour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    Quick,
    Middling,
    Slow,
}

impl Tracker {
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Plugin { name, .. } => name,
            Self::Peer { .. } => "OpenCV KLT",
        }
    }

    /// What must be the same for a kept row to hold.
    fn key(&self) -> String {
        match self {
            Self::Plugin { name, sha256, .. } => format!("{name}-{}", &sha256[..16.min(sha256.len())]),
            Self::Peer { version } => format!("opencv-klt-{version}"),
        }
    }

    pub(super) fn has(&self, param: &str) -> bool {
        matches!(self, Self::Plugin { params, .. } if params.iter().any(|known| known == param))
    }
}

/// The folder of all that is measured here.
pub(super) struct Lab {
    pub(super) folder: PathBuf,
    /// Real clips, where `HONAMI_DATA` names them.
    pub(super) data: Option<PathBuf>,
}

impl Lab {
    pub(super) fn new() -> anyhow::Result<Self> {
        let folder = target_dir()?.join(format!("bench/accuracy-v{VERSION}"));
        fs::create_dir_all(folder.join("rows"))
            .with_context(|| format!("cannot make {}", folder.display()))?;
        let data = std::env::var_os("HONAMI_DATA").map(PathBuf::from);
        if data.is_none() {
            eprintln!("HONAMI_DATA is not set: only generated clips are measured");
        }
        Ok(Self { folder, data })
    }

    /// The program; what it decodes is kept beside the clips and not in a person's cache.
    pub(super) fn honami(&self) -> anyhow::Result<Step> {
        Ok(built("release", "honami")?.env("XDG_CACHE_HOME", self.folder.join("frames")))
    }

    /// The shipped trackers, or those of them that are named, and OpenCV where Python has it.
    pub(super) fn trackers(&self, with: &[String]) -> anyhow::Result<Vec<Tracker>> {
        let list = json(self.honami()?.args(["plugin", "list", "--json"]))?;
        let mut trackers = Vec::new();
        for plugin in list["plugins"].as_array().into_iter().flatten().filter(|p| p["kind"] == "tracker") {
            let name = plugin["short_name"].as_str().unwrap_or_default().to_owned();
            if with.is_empty() || with.contains(&name) {
                let info = json(self.honami()?.args(["plugin", "info", &name, "--json"]))?;
                let sha256 = info["sha256"].as_str().unwrap_or_default().to_owned();
                let params = plugin["params"].as_array().into_iter().flatten();
                let params = params.filter_map(|p| Some(p["id"].as_str()?.to_owned())).collect();
                trackers.push(Tracker::Plugin { name, sha256, params });
            }
        }
        let stray = with.iter().find(|name| !trackers.iter().any(|tracker| tracker.name() == *name));
        anyhow::ensure!(stray.is_none(), "there is no tracker {}", stray.map_or("", String::as_str));
        let version = Step::new("python3").args(["-c", "import cv2; print(cv2.__version__)"]).output();
        match version {
            Ok(version) if with.is_empty() => {
                trackers.push(Tracker::Peer { version: version.trim().to_owned() });
            }
            Ok(_) => {}
            Err(_) => eprintln!("python3 has no cv2: the row of OpenCV is left out"),
        }
        Ok(trackers)
    }

    /// Those that can track, and why the others cannot: one may want a file that nobody has named.
    pub(super) fn able(&self, trackers: Vec<Tracker>) -> (Vec<Tracker>, Vec<String>) {
        let mut left_out = Vec::new();
        let able = trackers.into_iter().filter(|tracker| match self.pace(tracker) {
            Ok(_) => true,
            Err(error) => {
                let line = format!("{error:#}");
                let why = line.rsplit("no row: ").next().unwrap_or(&line);
                left_out.push(format!("{}: {why}", tracker.name()));
                eprintln!("left out: {}: {line}", tracker.name());
                false
            }
        });
        (able.collect(), left_out)
    }

    /// The row of a tracker in a case, measured unless it is kept; `None` where the case is not for this tracker.
    pub(super) fn row(&self, case: &Case, tracker: &Tracker) -> anyhow::Result<Option<Value>> {
        let n_points = case.n_points(self.pace(tracker)?);
        let is_for_it = matches!(tracker, Tracker::Plugin { .. }) || case.is_generated;
        let Some(n_points) = n_points.filter(|_| is_for_it) else { return Ok(None) };
        let file = self.kept(case, tracker, n_points);
        if let Some(kept) = read(&file) {
            return Ok(Some(kept));
        }
        let row = match &case.what {
            What::Pictures { .. } => self.compare(case, tracker, n_points)?,
            What::Fork { .. } | What::Walnut { .. } => self.listen(case, tracker, n_points)?,
        };
        fs::write(&file, row.to_string()).with_context(|| format!("cannot write {}", file.display()))?;
        Ok(Some(row))
    }

    /// The row if it is kept.
    pub(super) fn kept_row(&self, case: &Case, tracker: &Tracker) -> Option<Value> {
        let pace = read(&self.probe(tracker)).map_or(Pace::Quick, |kept| pace_of(&kept));
        read(&self.kept(case, tracker, case.n_points(pace)?))
    }

    /// Whether a row is wanted that is not kept.
    pub(super) fn lacks(&self, case: &Case, tracker: &Tracker) -> bool {
        let pace = read(&self.probe(tracker)).map_or(Pace::Quick, |kept| pace_of(&kept));
        let is_for_it = matches!(tracker, Tracker::Plugin { .. }) || case.is_generated;
        is_for_it && case.n_points(pace).is_some() && self.kept_row(case, tracker).is_none()
    }

    fn kept(&self, case: &Case, tracker: &Tracker, n_points: usize) -> PathBuf {
        let name = format!("{}-{}-{n_points}.json", case.name, tracker.key());
        self.folder.join("rows").join(name)
    }

    fn probe(&self, tracker: &Tracker) -> PathBuf {
        self.folder.join("rows").join(format!("probe-{}.json", tracker.key()))
    }

    /// How quick a tracker is, on ten frames of a clip of its own: the median, which a busy machine changes least.
    fn pace(&self, tracker: &Tracker) -> anyhow::Result<Pace> {
        let Tracker::Plugin { name, .. } = tracker else { return Ok(Pace::Quick) };
        let file = self.probe(tracker);
        if let Some(kept) = read(&file) {
            return Ok(pace_of(&kept));
        }
        let (clip, points) = (self.folder.join("probe.y4m"), self.folder.join("probe.points.csv"));
        let line = self.honami()?.arg("compare").arg(&clip).arg("--points").arg(&points);
        let said = json(line.args(["--quick", "--with", name, "--with", UNIT, "--json"]))?;
        let ms = |row: usize| said["trackers"][row]["ms_median"].as_f64();
        let row = object!({ "times_klt": ms(0).zip(ms(1)).map(|(ms, unit)| ms / unit) });
        fs::write(&file, row.to_string()).with_context(|| format!("cannot write {}", file.display()))?;
        Ok(pace_of(&row))
    }

    /// `honami compare` with one tracker: its answer as it is.
    fn compare(&self, case: &Case, tracker: &Tracker, n_points: usize) -> anyhow::Result<Value> {
        let What::Pictures { clip, truth, points, set, n_frames, passes } = &case.what else {
            anyhow::bail!("{} is not compared", case.name)
        };
        let points = thinned(points, n_points)?;
        let mut line = self.honami()?.arg("compare").args(clip).arg("--points").arg(&points).arg("--json");
        if let Some(truth) = truth {
            line = line.arg("--truth").arg(truth);
        }
        let n_frames =
            if self.pace(tracker)? == Pace::Slow && *passes { Some(SLOW_FRAMES) } else { *n_frames };
        if let Some(n_frames) = n_frames {
            line = line.args(["--frames", &format!("0..{n_frames}")]);
        }
        if !passes {
            line = line.arg("--quick");
        }
        match tracker {
            Tracker::Plugin { name, .. } => {
                line = line.args(["--with", name]);
                for (param, value) in set.iter().filter(|(param, _)| tracker.has(param)) {
                    line = line.args(["--set", &format!("{param}={value}")]);
                }
            }
            Tracker::Peer { .. } => {
                let table = points.with_extension("opencv.csv");
                let script = Step::new("python3").args(["tests/peers/klt_opencv.py", "track"]);
                script.args(clip).arg(&points).arg(&table).output()?;
                line = line.arg("--tracks").arg(format!("opencv={}", table.display()));
            }
        }
        json(line)
    }

    /// The strongest sway of points on a fork or a plant.
    fn listen(&self, case: &Case, tracker: &Tracker, n_points: usize) -> anyhow::Result<Value> {
        let (clip, points, fps, n_frames) = match &case.what {
            What::Fork { clip, points, fps } => (clip, points, Some(fps), 880),
            What::Walnut { clip, points, .. } => (clip, points, None, 500),
            What::Pictures { .. } => anyhow::bail!("{} is not listened to", case.name),
        };
        let points = thinned(points, n_points)?;
        let project = self.folder.join(format!("{}-{}.honami", case.name, tracker.name()));
        remove(&project)?;
        let rate = fps.map(|fps| ["--fps".to_owned(), fps.to_string()]);
        self.honami()?.arg("new").arg(&project).arg(clip).args(rate.iter().flatten()).output()?;
        let n_frames = if self.pace(tracker)? == Pace::Slow { 200 } else { n_frames };
        let line = self.honami()?.arg("track").arg(&project).args(["--with", tracker.name(), "--points"]);
        line.arg(&points).args(["--frames", &format!("0..{n_frames}")]).output()?;
        let said = json(self.honami()?.arg("spectrum").arg(&project).arg("--json"))?;
        remove(&project)?;
        let all = &said["lines"][0];
        let hz = &all["peaks"][0]["hz"];
        Ok(object!({ "hz": hz, "swing": all["swing"], "points": all["tracks"], "frames": n_frames }))
    }
}

fn pace_of(probe: &Value) -> Pace {
    match probe["times_klt"].as_f64() {
        Some(times) if times > SLOW => Pace::Slow,
        Some(times) if times > QUICK => Pace::Middling,
        _ => Pace::Quick,
    }
}

fn read(file: &Path) -> Option<Value> {
    serde_json::from_str(&fs::read_to_string(file).ok()?).ok()
}

fn remove(file: &Path) -> anyhow::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", file.display()))
        }
        _ => Ok(()),
    }
}

/// A table of at most so many of the points, evenly chosen.
fn thinned(points: &Path, n_points: usize) -> anyhow::Result<PathBuf> {
    let text = fs::read_to_string(points).with_context(|| format!("cannot read {}", points.display()))?;
    let (head, rows) = text.split_once('\n').unwrap_or_default();
    let rows: Vec<&str> = rows.lines().collect();
    if rows.len() <= n_points {
        return Ok(points.to_owned());
    }
    let chosen = (0..n_points).map(|k| rows[k * rows.len() / n_points]);
    let text: String = std::iter::once(head).chain(chosen).map(|line| format!("{line}\n")).collect();
    let file = points.with_extension(format!("{n_points}.csv"));
    // Others may be reading it: it never changes, and stands there whole.
    let part = file.with_extension(format!("{:?}.part", std::thread::current().id()).replace(['(', ')'], ""));
    fs::write(&part, text).with_context(|| format!("cannot write {}", part.display()))?;
    fs::rename(&part, &file).with_context(|| format!("cannot write {}", file.display()))?;
    Ok(file)
}

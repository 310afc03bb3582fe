//! Overlay movies: the clip with what was measured drawn over it, for talks and for looking again.

mod draw;
mod lens;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use honami_host::{Kind, Values};
use honami_media::write::{self, Format};
use honami_model::clip::FrameTimes;
use honami_model::picture;
use honami_model::track::{TrackId, TrackSet};
use rayon::prelude::*;

use self::draw::Drawing;
use self::lens::Lens;
use crate::error::WorkbenchError;
use crate::export::chosen;
use crate::grow::{self, GrowRequest, Growth};
use crate::progress::{Flow, Progress};
use crate::session::Session;

/// How long the trail behind a track is, seconds.
pub const TRAIL_S: f64 = 0.5;
/// A clip of one frame has no rate; a movie has one.
const USUAL_FPS: f64 = 25.0;
/// Frames of a movie of a clip whose frames are unevenly spaced, unless the clip itself has more.
const MOST_FRAMES: u64 = 1_000_000;
/// Sides of movies, pixels.
const SIDES: std::ops::RangeInclusive<f64> = 16.0..=8192.0;

/// What can be drawn over the picture, from below upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// The surroundings of every track in the colour of its velocity, with the wheel that explains it.
    Motion,
    /// Where tracks have just been.
    Trails,
    /// About every group an ellipse in which 95 % of its tracks are.
    Groups,
    /// The bones behind the tracks.
    Skeleton,
    /// A mark a track.
    Tracks,
    /// How fast tracks go, and where.
    Arrows,
    /// Numbers and names of groups.
    Labels,
    /// The frame and its time.
    Time,
}

impl Layer {
    /// All, from below upwards.
    pub const ALL: [Self; 8] = [
        Self::Motion,
        Self::Trails,
        Self::Groups,
        Self::Skeleton,
        Self::Tracks,
        Self::Arrows,
        Self::Labels,
        Self::Time,
    ];

    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Trails => "trails",
            Self::Groups => "groups",
            Self::Skeleton => "skeleton",
            Self::Tracks => "tracks",
            Self::Arrows => "arrows",
            Self::Labels => "labels",
            Self::Time => "time",
        }
    }
}

impl std::str::FromStr for Layer {
    type Err = String;
    fn from_str(word: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|layer| layer.word() == word).ok_or_else(|| {
            let words: Vec<_> = Self::ALL.iter().map(|layer| layer.word()).collect();
            format!("wanted some of {}, got {word}", words.join(", "))
        })
    }
}

/// How large a movie is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MovieSize {
    /// So many times as wide and as high as the clip.
    Scale(f64),
    /// Width and height, pixels; the picture keeps its shape, with black beside it.
    Pixels([u32; 2]),
}

/// What a movie is to show.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieRequest {
    /// What is drawn; `None`: tracks and trails, and the skeleton where one grows.
    pub show: Option<BTreeSet<Layer>>,
    /// Frames of the clip, from the first to one past the last, which may be left open.
    pub frames: (u32, Option<u32>),
    /// Its size.
    pub size: MovieSize,
    /// Frames a second of the movie; `None`: as filmed.
    pub fps: Option<f64>,
    /// How long trails are, seconds of the clip.
    pub trail_s: f64,
    /// Only these tracks.
    pub tracks: Option<TrackSet>,
    /// Only the tracks of these groups, numbered from 1.
    pub groups: Option<BTreeSet<u32>>,
    /// Short name of the structure builder that grows the skeleton.
    pub structure: String,
}

/// What was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Movie {
    /// What was drawn.
    pub shown: BTreeSet<Layer>,
    /// Frames of the clip that it is of.
    pub frames: Range<u32>,
    /// Its own frames.
    pub n_frames: usize,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Frames a second.
    pub fps: f64,
    /// How fast time goes in it: 1 as filmed.
    pub speed: f64,
    /// Tracks that are drawn, at one time or another.
    pub n_tracks: usize,
    /// Groups that these are of.
    pub n_groups: usize,
    /// Bones.
    pub n_bones: usize,
    /// Bytes of the file, or of all images.
    pub bytes: u64,
    /// What whoever shows it should know, a sentence each.
    pub notes: Vec<String>,
    /// Time it took.
    pub seconds: f64,
}

/// Draws over the clip and writes a movie, whole or not at all: `.mp4` by ffmpeg, `.y4m`, or a folder of PNG images.
///
/// # Errors
/// [`WorkbenchError::Frames`], [`WorkbenchError::MovieSize`], [`WorkbenchError::MovieLength`], [`WorkbenchError::NoTracks`], [`WorkbenchError::NoSuchTracks`],
/// [`WorkbenchError::NoGroups`] where groups, labels or a skeleton are asked for, [`WorkbenchError::Stopped`], and what the
/// clip, the disk, ffmpeg or the structure builder met.
pub fn write(
    session: &Session,
    out: &Path,
    request: &MovieRequest,
    progress: &dyn Progress,
) -> Result<Movie, WorkbenchError> {
    let begun = Instant::now();
    let media = &session.media;
    let clip = media.clip();
    let n_frames = clip.n_frames();
    let frames = request.frames.0..request.frames.1.unwrap_or(n_frames);
    if frames.start >= frames.end || frames.end > n_frames {
        let Range { start, end } = frames;
        return Err(WorkbenchError::Frames { start, end, n_frames });
    }
    let lens = Lens::of([clip.width, clip.height], request.size)?;
    let (rate, fps) = rates(&clip.times, request.fps);
    let plan = Plan::of(&clip.times, frames.clone(), rate)?;
    let mut drawn = drawn(session, request)?;
    let [width, height] = lens.size;
    // Players of compressed movies know limited range best.
    let is_mp4 = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("mp4"));
    let range = if is_mp4 { picture::Range::Limited } else { picture::Range::Full };
    let mut movie = write::create(out, &Format { width, height, fps, colour: true, range })?;
    drawn.grow(session, request, progress)?;
    let mut notes: Vec<String> = plan.note.into_iter().chain(std::mem::take(&mut drawn.notes)).collect();
    let drawing = Drawing::new(&clip.times, &lens, &drawn, &frames, (request.trail_s, fps / rate));
    notes.extend(drawing.note());
    // As many pictures at once as there are cores; what is written is the same for any number.
    let at_once = rayon::current_num_threads().max(1);
    let mut done = 0;
    for some in plan.frames.chunks(at_once) {
        if progress.report(done, plan.frames.len() as u64, "frame") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let pictures = some.iter().map(|&frame| Ok((frame, media.frame(frame)?)));
        let pictures = pictures.collect::<Result<Vec<_>, WorkbenchError>>()?;
        let pictures: Vec<_> = pictures
            .into_par_iter()
            .map(|(frame, picture)| drawing.draw(picture.rgb_area(lens.area, width, height), frame))
            .collect();
        for picture in &pictures {
            movie.push_rgb(picture.pixels())?;
        }
        done += pictures.len() as u64;
    }
    movie.finish()?;
    Ok(Movie {
        frames,
        n_frames: plan.frames.len(),
        size: lens.size,
        fps,
        speed: fps / rate,
        n_tracks: drawn.tracks.len(),
        n_groups: drawn.tracks.iter().filter_map(|track| track.group).collect::<BTreeSet<_>>().len(),
        n_bones: drawing.n_bones(),
        bytes: bytes_of(out)?,
        shown: drawn.show,
        notes,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

/// Frames a second as filmed, and in the movie.
fn rates(times: &FrameTimes, wanted: Option<f64>) -> (f64, f64) {
    let rate = times.nominal_fps().or(wanted).unwrap_or(USUAL_FPS);
    (rate, wanted.unwrap_or(rate))
}

/// Which frame of the clip each frame of the movie shows.
struct Plan {
    frames: Vec<u32>,
    /// Where that is not simply one after the other.
    note: Option<String>,
}

impl Plan {
    /// One after the other; of a clip whose frames are unevenly spaced the nearest in time.
    ///
    /// # Errors
    /// [`WorkbenchError::MovieLength`]: one frame with a stray time would be held for years.
    fn of(times: &FrameTimes, of: Range<u32>, rate: f64) -> Result<Self, WorkbenchError> {
        let all: Vec<u32> = of.clone().collect();
        let when = &times.as_slice()[of.start as usize..of.end as usize];
        if !times.is_variable() {
            return Ok(Self { frames: all, note: None });
        }
        let (first, last) = (when[0], when[when.len() - 1]);
        let wanted = ((last - first) * rate).round();
        let most = MOST_FRAMES.max(u64::from(of.end - of.start)) as f64;
        if wanted >= most {
            return Err(too_long(when, of.start, wanted));
        }
        let n = wanted as u64 + 1;
        let nearest = |k: u64| {
            let time_s = first + k as f64 / rate;
            let after = when.partition_point(|&t| t < time_s).min(when.len() - 1);
            let before = after.saturating_sub(1);
            let is_before = time_s - when[before] <= when[after] - time_s;
            of.start + if is_before { before } else { after } as u32
        };
        let frames: Vec<u32> = (0..n).map(nearest).collect();
        let n_shown = frames.iter().collect::<BTreeSet<_>>().len();
        let (n_left_out, n_again) = (all.len() - n_shown, frames.len() - n_shown);
        let note = format!(
            "frames of the clip are not evenly spaced, those of the movie are: {n_left_out} of {} left out, {n_again} shown \
             again, each within {:.0} ms of its time",
            all.len(),
            worst_s(when, first, n, rate) * 1e3
        );
        Ok(Self { frames, note: Some(note) })
    }
}

/// Whose fault it is that a movie would have so many frames: the frame before which there is the longest gap.
fn too_long(when: &[f64], first: u32, n_frames: f64) -> WorkbenchError {
    let gap = |k: &usize| when[k + 1] - when[*k];
    let longest = (0..when.len() - 1).max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or_default();
    WorkbenchError::MovieLength { n_frames, frame: first + longest as u32 + 1, gap_s: gap(&longest) }
}

/// The farthest that a frame of the movie is from the time of the nearest of the clip, seconds.
fn worst_s(when: &[f64], first: f64, n: u64, rate: f64) -> f64 {
    let apart = |k: u64| {
        let time_s = first + k as f64 / rate;
        let after = when.partition_point(|&t| t < time_s);
        let near = [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|at| when.get(at));
        near.map(|t| (t - time_s).abs()).fold(f64::INFINITY, f64::min)
    };
    (0..n).map(apart).fold(0.0, f64::max)
}

/// What is drawn, as the project has it.
struct Drawn {
    show: BTreeSet<Layer>,
    tracks: Vec<draw::Shown>,
    /// What groups are called: their numbers from 1, and names that they were given.
    names: BTreeMap<u32, String>,
    growth: Option<Growth>,
    /// Whether there is a skeleton to be grown, and it was asked for.
    skeleton: Option<bool>,
    notes: Vec<String>,
}

fn drawn(session: &Session, request: &MovieRequest) -> Result<Drawn, WorkbenchError> {
    let project = &session.project;
    let grouping = project.grouping()?;
    let usual = || BTreeSet::from([Layer::Trails, Layer::Tracks]);
    let show = request.show.clone().unwrap_or_else(usual);
    let of_groups = [Layer::Groups, Layer::Skeleton, Layer::Labels];
    if grouping.is_none() && of_groups.iter().any(|layer| show.contains(layer)) {
        return Err(WorkbenchError::NoGroups);
    }
    let skeleton = match &request.show {
        None => grouping.is_some().then_some(false),
        Some(show) => show.contains(&Layer::Skeleton).then_some(true),
    };
    let is_bare = show.iter().all(|layer| *layer == Layer::Time);
    let tracks =
        if is_bare { Vec::new() } else { chosen(project, request.tracks.as_ref(), request.groups.as_ref())? };
    let group_of = |id: &TrackId| grouping.as_ref().and_then(|of| of.group_of.get(id)).copied();
    let mut names = BTreeMap::new();
    for (group, &node) in grouping.iter().flat_map(|grouping| (0_u32..).zip(&grouping.nodes)) {
        let given = grouping.as_ref().and_then(|of| project.document().group_name(of.clustering, node));
        let number = (group + 1).to_string();
        names.insert(group, given.map_or_else(|| number.clone(), |name| format!("{number} {name}")));
    }
    let tracks = tracks.into_iter().map(|(id, span)| draw::Shown { group: group_of(&id), span }).collect();
    Ok(Drawn { show, tracks, names, growth: None, skeleton, notes: Vec::new() })
}

impl Drawn {
    /// Grows the skeleton, where one is drawn. One that was not asked for may be missing: then a note says why.
    fn grow(
        &mut self,
        session: &Session,
        request: &MovieRequest,
        progress: &dyn Progress,
    ) -> Result<(), WorkbenchError> {
        let Some(is_asked) = self.skeleton else { return Ok(()) };
        let grown = session.registry.find(Kind::Structure, &request.structure).map_err(WorkbenchError::from);
        let grown = grown.and_then(|plugin| {
            let wanted = GrowRequest { params: Values::defaults(&plugin.params), ..GrowRequest::default() };
            grow::grow(&session.project, &session.options.host, plugin, &wanted, progress)
        });
        match grown {
            Ok(growth) => {
                self.show.insert(Layer::Skeleton);
                self.growth = Some(growth);
            }
            Err(error @ WorkbenchError::Stopped) => return Err(error),
            Err(error) if is_asked => return Err(error),
            Err(error) => self.notes.push(format!("no skeleton is drawn: {error}")),
        }
        Ok(())
    }
}

/// Bytes of a file, or of all files in a folder.
fn bytes_of(out: &Path) -> Result<u64, WorkbenchError> {
    let fail = |source| WorkbenchError::Io { what: "cannot look at", source, path: out.to_owned() };
    let size = |path: PathBuf| path.metadata().map(|about| about.len());
    if !out.is_dir() {
        return size(out.to_owned()).map_err(fail);
    }
    let files = std::fs::read_dir(out).map_err(fail)?;
    files.map(|file| file.and_then(|file| size(file.path())).map_err(fail)).sum()
}

#[cfg(test)]
mod tests;

//! Tracks of other programs become a run of the project, and what they call key-frames becomes hand work.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use honami_exchange::Watch;
use honami_exchange::foreign::{self, ForeignTrack, ForeignTracks, Format, ReadOptions};
use honami_exchange::origin::{Origin, resized};
use honami_model::document::{Key, RunId};
use honami_model::edit::{Edit, Transaction};
use honami_model::provenance::{Provenance, Value};
use honami_model::track::{Sample, Source, Span, Status, TrackId, TrackSet};
use honami_store::{Project, RunHead};

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};
use crate::stamp;
use crate::track::MAX_NUMBER;

/// How often it is told how far a file is read.
const TICK: Duration = Duration::from_millis(100);

/// Which file to read, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportRequest {
    /// The file.
    pub file: PathBuf,
    /// What it is; recognised, if not said.
    pub format: Option<Format>,
    /// Where it counts pixels from, if not where its format usually does.
    pub origin: Option<Origin>,
    /// Width and height of the pictures it was made on, if not the clip's; positions are scaled to the clip.
    pub size: Option<[u32; 2]>,
    /// The camera whose points are wanted, in a file of several.
    pub camera: Option<u32>,
    /// How many of its units of length a pixel is wide, if it does not say so itself.
    pub pixel_size: Option<f64>,
    /// Whether what the file calls key-frames becomes key-frames, or samples like all others.
    pub keys: bool,
}

/// What was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Imported {
    /// The run it became.
    pub run: RunId,
    /// What the file was.
    pub format: Format,
    /// Tracks.
    pub n_tracks: usize,
    /// Samples.
    pub n_samples: u64,
    /// Of these, key-frames.
    pub n_keys: usize,
    /// Tracks whose number in the file is another one's here.
    pub n_renumbered: usize,
    /// Samples of frames that the clip does not have: left out.
    pub n_beyond: u64,
    /// Seen samples that lie outside the picture: kept.
    pub n_outside: u64,
    /// What the file holds that is no track of points, with numbers.
    pub dropped: Vec<String>,
}

/// Reads a file into the project: one run, one edit that undo takes back; nothing when it fails.
///
/// A file's numbers are kept where they are free. Frames beyond the clip are left out.
///
/// # Errors
/// What is wrong with the file, [`WorkbenchError::Stopped`], [`WorkbenchError::PictureSize`] when it was made on other pictures,
/// [`WorkbenchError::NothingToImport`], and what the project met.
pub fn tracks(
    project: &mut Project,
    request: &ImportRequest,
    progress: &dyn Progress,
) -> Result<Imported, WorkbenchError> {
    let format = request.format.map_or_else(|| foreign::recognise(&request.file), Ok)?;
    let clip = &project.clip().clip;
    let (size, n_frames) = ([clip.width, clip.height], clip.n_frames());
    let theirs = request.size.unwrap_or(size);
    let ImportRequest { origin, camera, pixel_size, .. } = *request;
    let options = ReadOptions { size: theirs, origin, camera, pixel_size };
    let ForeignTracks { tracks, size: said, dropped } = read(request, format, &options, progress)?;
    if let Some(came) = said.filter(|&said| request.size.is_none() && said != size) {
        return Err(WorkbenchError::PictureSize { path: request.file.clone(), came, wanted: size });
    }
    let sha256 = honami_media::sha256_of_file(&request.file)?;

    let fits = |track: &ForeignTrack| track.samples().any(|(frame, _)| frame < n_frames);
    let n_all: usize = tracks.iter().map(ForeignTrack::n_samples).sum();
    let tracks: Vec<ForeignTrack> = tracks.into_iter().filter(fits).collect();
    let nothing = || WorkbenchError::NothingToImport { path: request.file.clone(), n_frames };
    if tracks.is_empty() {
        return Err(nothing());
    }
    let ids = numbers(project, &tracks)?;
    let mut taken = Taken::default();
    for (track, &id) in tracks.iter().zip(&ids) {
        taken.take(track, id, n_frames, |sample| {
            let [x, y] = resized([sample.x.into(), sample.y.into()], theirs, size).map(|v| v as f32);
            Sample { x, y, ..sample }
        });
    }
    if !request.keys {
        taken.keys.clear();
    }
    let Taken { spans, keys, n_samples } = taken;
    let provenance = provenance(project, request, format, sha256);
    let n_outside = spans.iter().flat_map(|(_, span)| &span.samples).filter(|s| is_outside(s, size)).count();
    let set: TrackSet = ids.iter().copied().collect();
    let head = RunHead { provenance, tracks: set.clone(), frames: extent(&spans) };
    let run = project.keep_runs(&[(head, spans)])?.first().copied().ok_or_else(nothing)?;
    let n_renumbered = tracks.iter().zip(&ids).filter(|(t, id)| t.number.is_some_and(|n| n != id.0)).count();
    let names = tracks.into_iter().zip(&ids).filter_map(|(track, &id)| Some((id, track.name?)));
    let n_keys = keys.len();
    project.commit(transaction(request, run, set, names, keys))?;
    Ok(Imported {
        run,
        format,
        n_tracks: ids.len(),
        n_samples,
        n_keys,
        n_renumbered,
        n_beyond: n_all as u64 - n_samples,
        n_outside: n_outside as u64,
        dropped,
    })
}

/// Reads the file and tells how far it is, until it is told to stop.
fn read(
    request: &ImportRequest,
    format: Format,
    options: &ReadOptions,
    progress: &dyn Progress,
) -> Result<ForeignTracks, WorkbenchError> {
    let file = &request.file;
    let io = |what| move |source| WorkbenchError::Io { what, source, path: file.clone() };
    let n_kb = std::fs::metadata(file).map_err(io("reading"))?.len().div_ceil(1000);
    let what = format!("kB of {}", file.file_name().unwrap_or_default().to_string_lossy());
    let watch = Watch::default();
    let tell = || {
        if progress.report((watch.n_bytes() / 1000).min(n_kb), n_kb, &what) == Flow::Stop {
            watch.stop();
        }
    };
    let (reading, ended) = mpsc::sync_channel::<()>(0);
    let tracks = std::thread::scope(|scope| {
        let teller = std::thread::Builder::new().name("progress".to_owned());
        let telling = move || {
            while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                tell()
            }
        };
        teller.spawn_scoped(scope, telling).map_err(io("starting a thread for"))?;
        let tracks = foreign::read(file, format, options, &watch);
        drop(reading);
        Ok::<_, WorkbenchError>(tracks)
    })?;
    if watch.is_stopped() { Err(WorkbenchError::Stopped) } else { Ok(tracks?) }
}

/// A number for every track: its own, if it is free and nobody's before it, else a new one.
fn numbers(project: &mut Project, tracks: &[ForeignTrack]) -> Result<Vec<TrackId>, WorkbenchError> {
    let free = project.reserve_tracks(0)?.end;
    let mut claimed = BTreeSet::new();
    let own = |track: &ForeignTrack| track.number.filter(|number| (free..=MAX_NUMBER).contains(number));
    let own: Vec<Option<u32>> = tracks.iter().map(|t| own(t).filter(|n| claimed.insert(*n))).collect();
    project.claim_tracks(&claimed.iter().copied().map(TrackId).collect())?;
    let n_new = own.iter().filter(|number| number.is_none()).count();
    let mut new = project.reserve_tracks(u32::try_from(n_new).unwrap_or(u32::MAX))?;
    Ok(own.into_iter().filter_map(|number| number.or_else(|| new.next()).map(TrackId)).collect())
}

/// What is taken from a file.
#[derive(Default)]
struct Taken {
    spans: Vec<(TrackId, Span)>,
    keys: Vec<(TrackId, u32, Key)>,
    n_samples: u64,
}

impl Taken {
    fn take(&mut self, track: &ForeignTrack, id: TrackId, n_frames: u32, place: impl Fn(Sample) -> Sample) {
        for span in track.spans.iter().filter(|span| span.first_frame < n_frames) {
            let inside = (n_frames - span.first_frame) as usize;
            let mut samples: Vec<Sample> = span.samples.iter().take(inside).map(|&s| place(s)).collect();
            for (frame, sample) in span.frames().zip(&mut samples) {
                if sample.source == Source::Key {
                    let status =
                        if sample.status == Status::Newborn { Status::Tracked } else { sample.status };
                    self.keys.push((id, frame, Key { status, ..Key::set(sample.x, sample.y) }));
                }
                sample.source = Source::Imported;
            }
            self.n_samples += samples.len() as u64;
            self.spans.push((id, Span { first_frame: span.first_frame, samples }));
        }
    }
}

fn is_outside(sample: &Sample, [width, height]: [u32; 2]) -> bool {
    let inside = |v: f32, side: u32| (-0.5..=f64::from(side) - 0.5).contains(&f64::from(v));
    sample.status.is_seen() && !(inside(sample.x, width) && inside(sample.y, height))
}

fn extent(spans: &[(TrackId, Span)]) -> Range<u32> {
    let frames = || spans.iter().map(|(_, span)| span.frames());
    let start = frames().map(|frames| frames.start).min().unwrap_or(0);
    start..frames().map(|frames| frames.end).max().unwrap_or(0)
}

fn transaction(
    request: &ImportRequest,
    run: RunId,
    tracks: TrackSet,
    names: impl Iterator<Item = (TrackId, String)>,
    keys: Vec<(TrackId, u32, Key)>,
) -> Transaction {
    let file = request.file.file_name().unwrap_or_default().to_string_lossy();
    let keyed = if keys.is_empty() { String::new() } else { format!(", {} key-frames", keys.len()) };
    let label = format!("imported {tracks}{keyed} from {file}");
    let show = Edit::ShowRun { run, tracks, above: None };
    let names = names.map(|(track, name)| Edit::NameTrack { track, name: Some(name) });
    let keys = keys.into_iter().map(|(track, frame, key)| Edit::SetKey { track, frame, key });
    Transaction::new(label, std::iter::once(show).chain(names).chain(keys).collect())
}

/// Where the run came from: the file in the place of a plugin.
fn provenance(project: &Project, request: &ImportRequest, format: Format, sha256: String) -> Provenance {
    let text = |text: &str| Value::Text(text.to_owned());
    let file = request.file.file_name().unwrap_or_default().to_string_lossy();
    let mut params = vec![("file", text(&file)), ("format", text(format.word()))];
    params.extend(request.origin.map(|origin| ("origin", text(origin.word()))));
    params.extend(request.size.map(|size| ("size", Value::List(size.map(f64::from).to_vec()))));
    params.extend(request.camera.map(|camera| ("camera", Value::Int(camera.into()))));
    params.extend(request.pixel_size.map(|size| ("pixel_size", Value::Float(size))));
    let params = params.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    stamp::imported(project, params, sha256)
}

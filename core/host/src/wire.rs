//! What the host and a plugin's own process say to each other.
//!
//! The process has a socket as its standard input: one JSON object a line, every request is answered by one `done`.
//! With the first line come two memories (`SCM_RIGHTS`): one that only the host writes, one that the process writes.
//! Pictures and columns lie there, at places that are bytes from the start, multiples of 64. A plugin of any language
//! can be served so; members that the other side does not know are ignored.

pub(crate) mod memory;

use crate::draft::{Gust, Node};
use crate::instance::Request;
use crate::reply::Element;
use crate::types::{DetectRequest, FrameView, Point, StreamInfo, Tracks};
use crate::values::Value;
use honami_model::picture::{Chroma, Gray, Range};
use memory::{Inbox, Outbox, bytes_of};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of what is said here.
pub(crate) const VERSION: u32 = 1;

/// From the host.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "m", rename_all = "snake_case")]
pub(crate) enum Ask {
    /// The first line: make an instance of this plugin. The two memories come with it.
    Hello {
        honami: u32,
        plugin: String,
    },
    /// Every parameter at once.
    SetParams {
        values: BTreeMap<String, Value>,
    },
    Begin(Stream),
    Seed {
        points: Columns,
    },
    Retire {
        ids: Columns,
    },
    Push {
        frame: Frame,
    },
    End,
    Detect {
        frame: Frame,
        max_features: u32,
        mask: Option<Plane>,
        points: Columns,
        max_threads: u32,
        seed: u64,
    },
    Field {
        from: Frame,
        to: Frame,
        max_threads: u32,
    },
    Cluster(Movement),
    Grow(Movement),
    Prepare {
        skeleton: Columns,
        n_instances: u32,
        max_threads: u32,
        seed: u64,
    },
    Reset,
    Step {
        dt: f64,
        n_steps: u32,
        wind: Columns,
    },
}

/// To the host.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "m", rename_all = "snake_case")]
pub(crate) enum Tell {
    /// A line of the plugin's log.
    Log { level: i32, text: String },
    /// Before the plugin is loaded: how far the process has shut itself in.
    ShutIn { level: String },
    /// What the plugin is at; how far is in the memory.
    At { text: String },
    /// The answer to a request.
    Done(Answer),
    /// The answer to `hello`, when there is no instance; the process ends.
    Refused(Refusal),
}

/// Why there is no instance.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Refusal {
    /// The plugin says so.
    Failed { code: i32, text: String },
    /// It broke the contract.
    Misbehaved { function: String, what: String },
    /// The library is none.
    Unusable { why: String },
}

/// How a call ended, and what it brought.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Answer {
    /// What the function returned.
    pub(crate) code: i32,
    /// Of a failure, in the plugin's words.
    pub(crate) text: String,
    /// How it broke the contract.
    pub(crate) faults: Vec<String>,
    /// Committed tables by schema.
    pub(crate) tables: BTreeMap<String, Columns>,
}

/// A table: where each column begins.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Columns {
    pub(crate) rows: u64,
    pub(crate) at: BTreeMap<String, u64>,
}

/// Bytes row by row, without gaps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Plane {
    at: u64,
    width: u32,
    height: u32,
}

/// A frame of a clip.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Frame {
    gray: Plane,
    #[serde(default)]
    chroma: Option<[Plane; 2]>,
    /// `limited` or `full`, if known.
    #[serde(default)]
    range: Option<String>,
    index: i64,
    time_s: f64,
}

/// What is known of a stream before its first frame.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Stream {
    width: u32,
    height: u32,
    fps: Option<f64>,
    n_frames: Option<u64>,
    reversed: bool,
    max_threads: u32,
    seed: u64,
    birth_first: u32,
    birth_count: u32,
}

/// Tracks and the times of their frames.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Movement {
    tracks: Columns,
    n_samples: u64,
    times: Columns,
    width: u32,
    height: u32,
    max_threads: u32,
    seed: u64,
}

const LIMITED: &str = "limited";
const FULL: &str = "full";

/// Lays what belongs to a request into the memory and says it; `None` when it does not fit.
pub(crate) fn ask(request: &Request<'_>, out: &mut Outbox) -> Option<Ask> {
    out.clear();
    Some(match *request {
        Request::SetParams(values) => {
            let values = values.iter().map(|(id, value, _)| ((*id).to_owned(), (*value).clone()));
            Ask::SetParams { values: values.collect() }
        }
        Request::Begin(info) => Ask::Begin(Stream {
            width: info.width,
            height: info.height,
            fps: info.fps,
            n_frames: info.n_frames,
            reversed: info.reversed,
            max_threads: info.max_threads,
            seed: info.seed,
            birth_first: info.births.start,
            birth_count: info.births.len() as u32,
        }),
        Request::Seed(points) => Ask::Seed { points: put_points(points, out)? },
        Request::Retire(ids) => Ask::Retire { ids: put(out, ids.len(), &[("id", bytes_of(ids))])? },
        Request::Push(view) => Ask::Push { frame: put_frame(view, out)? },
        Request::End => Ask::End,
        Request::Detect(wanted) => Ask::Detect {
            frame: put_frame(&wanted.frame, out)?,
            max_features: wanted.max_features,
            mask: match &wanted.mask {
                Some(mask) => Some(put_plane(mask, out)?),
                None => None,
            },
            points: put_points(wanted.points, out)?,
            max_threads: wanted.max_threads,
            seed: wanted.seed,
        },
        Request::Field { from, to, max_threads } => {
            Ask::Field { from: put_frame(from, out)?, to: put_frame(to, out)?, max_threads }
        }
        Request::Cluster(tracks) => Ask::Cluster(put_tracks(tracks, out)?),
        Request::Grow(tracks) => Ask::Grow(put_tracks(tracks, out)?),
        Request::Prepare { nodes, n_instances, max_threads, seed } => {
            Ask::Prepare { skeleton: put_nodes(nodes, out)?, n_instances, max_threads, seed }
        }
        Request::Reset => Ask::Reset,
        Request::Step { dt, n_steps, wind } => {
            let times: Vec<f64> = wind.iter().map(|gust| gust.time_s).collect();
            let winds: Vec<f32> = wind.iter().flat_map(|gust| gust.wind).collect();
            let wind = put(out, wind.len(), &[("time_s", bytes_of(&times)), ("wind", bytes_of(&winds))])?;
            Ask::Step { dt, n_steps, wind }
        }
    })
}

fn put(out: &mut Outbox, rows: usize, columns: &[(&str, &[u8])]) -> Option<Columns> {
    let place = |(name, bytes): &(&str, &[u8])| {
        Some(((*name).to_owned(), out.put(bytes.len(), std::iter::once(*bytes))?))
    };
    Some(Columns { rows: rows as u64, at: columns.iter().map(place).collect::<Option<_>>()? })
}

fn put_points(points: &[Point], out: &mut Outbox) -> Option<Columns> {
    let ids: Vec<u32> = points.iter().map(|point| point.id).collect();
    let [xs, ys]: [Vec<f32>; 2] =
        [points.iter().map(|point| point.x).collect(), points.iter().map(|point| point.y).collect()];
    put(out, ids.len(), &[("id", bytes_of(&ids)), ("x", bytes_of(&xs)), ("y", bytes_of(&ys))])
}

fn put_nodes(nodes: &[Node], out: &mut Outbox) -> Option<Columns> {
    let rows = |row: fn(&Node) -> Option<u32>| -> Vec<i32> {
        nodes.iter().map(|node| row(node).and_then(|row| i32::try_from(row).ok()).unwrap_or(-1)).collect()
    };
    let (parents, tracks) = (rows(|node| node.parent), rows(|node| node.track));
    let [x, y, z] = [0, 1, 2].map(|k| nodes.iter().map(|node| node.position[k]).collect::<Vec<f32>>());
    let radii: Vec<f32> = nodes.iter().map(|node| node.radius).collect();
    let columns = [
        ("parent", bytes_of(&parents)),
        ("x", bytes_of(&x)),
        ("y", bytes_of(&y)),
        ("z", bytes_of(&z)),
        ("radius", bytes_of(&radii)),
        ("track", bytes_of(&tracks)),
    ];
    put(out, nodes.len(), &columns)
}

fn put_tracks(tracks: &Tracks, out: &mut Outbox) -> Option<Movement> {
    let columns = [
        ("id", bytes_of(&tracks.ids)),
        ("frame0", bytes_of(&tracks.first_frames)),
        ("len", bytes_of(&tracks.lens)),
        ("offset", bytes_of(&tracks.offsets)),
        ("x", bytes_of(&tracks.x)),
        ("y", bytes_of(&tracks.y)),
        ("status", bytes_of(&tracks.status)),
    ];
    let times = [("frame", bytes_of(&tracks.frames)), ("time_s", bytes_of(&tracks.times_s))];
    Some(Movement {
        tracks: put(out, tracks.len(), &columns)?,
        n_samples: tracks.x.len() as u64,
        times: put(out, tracks.frames.len(), &times)?,
        width: tracks.width,
        height: tracks.height,
        max_threads: tracks.max_threads,
        seed: tracks.seed,
    })
}

fn put_plane(gray: &Gray<'_>, out: &mut Outbox) -> Option<Plane> {
    let (width, height) = (gray.width as usize, gray.height as usize);
    let at = if gray.stride == width {
        out.put(width * height, std::iter::once(gray.data.get(..width * height)?))?
    } else {
        let rows = (0..height).map_while(|y| gray.data.get(y * gray.stride..y * gray.stride + width));
        out.put(width * height, rows)?
    };
    Some(Plane { at, width: gray.width, height: gray.height })
}

fn put_frame(view: &FrameView<'_>, out: &mut Outbox) -> Option<Frame> {
    let range = view.range.map(|range| match range {
        Range::Limited => LIMITED.to_owned(),
        Range::Full => FULL.to_owned(),
    });
    let chroma = match &view.chroma {
        Some(chroma) => Some([put_plane(&chroma.cb, out)?, put_plane(&chroma.cr, out)?]),
        None => None,
    };
    Some(Frame { gray: put_plane(&view.gray, out)?, chroma, range, index: view.index, time_s: view.time_s })
}

/// Takes what was said apart in the plugin's process, and hands it on.
///
/// # Errors
/// When it is not what this honami says.
pub(crate) fn hear<R>(
    ask: &Ask,
    inbox: &Inbox,
    kind_of: impl Fn(&str) -> u32,
    act: impl FnOnce(&Request<'_>) -> R,
) -> Result<R, &'static str> {
    let request = match ask {
        Ask::Hello { .. } => return Err("a second hello"),
        Ask::SetParams { values } => {
            let values: Vec<_> = values.iter().map(|(id, value)| (id.as_str(), value, kind_of(id))).collect();
            return Ok(act(&Request::SetParams(&values)));
        }
        Ask::Begin(stream) => {
            let info = StreamInfo {
                width: stream.width,
                height: stream.height,
                fps: stream.fps,
                n_frames: stream.n_frames,
                reversed: stream.reversed,
                max_threads: stream.max_threads,
                seed: stream.seed,
                births: stream.birth_first..stream.birth_first.saturating_add(stream.birth_count),
            };
            return Ok(act(&Request::Begin(&info)));
        }
        Ask::Seed { points } => return Ok(act(&Request::Seed(&take_points(points, inbox)?))),
        Ask::Retire { ids } => return Ok(act(&Request::Retire(take(ids, inbox, "id", 1)?))),
        Ask::Push { frame } => return Ok(act(&Request::Push(&take_frame(frame, inbox)?))),
        Ask::End => Request::End,
        Ask::Detect { frame, max_features, mask, points, max_threads, seed } => {
            let points = take_points(points, inbox)?;
            let wanted = DetectRequest {
                frame: take_frame(frame, inbox)?,
                max_features: *max_features,
                mask: mask.map(|mask| take_plane(mask, inbox)).transpose()?,
                points: &points,
                max_threads: *max_threads,
                seed: *seed,
            };
            return Ok(act(&Request::Detect(&wanted)));
        }
        Ask::Field { from, to, max_threads } => {
            let (from, to) = (take_frame(from, inbox)?, take_frame(to, inbox)?);
            return Ok(act(&Request::Field { from: &from, to: &to, max_threads: *max_threads }));
        }
        Ask::Cluster(movement) => return Ok(act(&Request::Cluster(&take_tracks(movement, inbox)?))),
        Ask::Grow(movement) => return Ok(act(&Request::Grow(&take_tracks(movement, inbox)?))),
        Ask::Prepare { skeleton, n_instances, max_threads, seed } => {
            let nodes = take_nodes(skeleton, inbox)?;
            let (n_instances, max_threads, seed) = (*n_instances, *max_threads, *seed);
            return Ok(act(&Request::Prepare { nodes: &nodes, n_instances, max_threads, seed }));
        }
        Ask::Reset => Request::Reset,
        Ask::Step { dt, n_steps, wind } => {
            let times = take::<f64>(wind, inbox, "time_s", 1)?.iter();
            let (winds, _) = take::<f32>(wind, inbox, "wind", 3)?.as_chunks::<3>();
            let gusts: Vec<_> = times.zip(winds).map(|(&time_s, &wind)| Gust { time_s, wind }).collect();
            return Ok(act(&Request::Step { dt: *dt, n_steps: *n_steps, wind: &gusts }));
        }
    };
    Ok(act(&request))
}

fn take<'m, T: Element>(
    columns: &Columns,
    inbox: &'m Inbox,
    name: &str,
    n_components: usize,
) -> Result<&'m [T], &'static str> {
    let n = usize::try_from(columns.rows).ok().and_then(|rows| rows.checked_mul(n_components));
    let at = columns.at.get(name).ok_or("a column is missing")?;
    n.and_then(|n| inbox.elements(*at, n)).ok_or("a column lies outside the memory")
}

fn take_points(points: &Columns, inbox: &Inbox) -> Result<Vec<Point>, &'static str> {
    let ids = take::<u32>(points, inbox, "id", 1)?.iter();
    let (xs, ys) = (take::<f32>(points, inbox, "x", 1)?, take::<f32>(points, inbox, "y", 1)?);
    Ok(ids.zip(xs).zip(ys).map(|((&id, &x), &y)| Point { id, x, y }).collect())
}

fn take_nodes(skeleton: &Columns, inbox: &Inbox) -> Result<Vec<Node>, &'static str> {
    let number = |name| take::<f32>(skeleton, inbox, name, 1);
    let row = |name| take::<i32>(skeleton, inbox, name, 1);
    let (parents, tracks) = (row("parent")?, row("track")?);
    let (x, y, z, radii) = (number("x")?, number("y")?, number("z")?, number("radius")?);
    let node = |k: usize| Node {
        parent: u32::try_from(parents[k]).ok(),
        position: [x[k], y[k], z[k]],
        radius: radii[k],
        track: u32::try_from(tracks[k]).ok(),
    };
    Ok((0..parents.len()).map(node).collect())
}

fn take_tracks(movement: &Movement, inbox: &Inbox) -> Result<Tracks, &'static str> {
    let (tracks, times) = (&movement.tracks, &movement.times);
    let samples = Columns { rows: movement.n_samples, at: tracks.at.clone() };
    Ok(Tracks {
        ids: take(tracks, inbox, "id", 1)?.to_vec(),
        first_frames: take(tracks, inbox, "frame0", 1)?.to_vec(),
        lens: take(tracks, inbox, "len", 1)?.to_vec(),
        offsets: take(tracks, inbox, "offset", 1)?.to_vec(),
        x: take(&samples, inbox, "x", 1)?.to_vec(),
        y: take(&samples, inbox, "y", 1)?.to_vec(),
        status: take(&samples, inbox, "status", 1)?.to_vec(),
        frames: take(times, inbox, "frame", 1)?.to_vec(),
        times_s: take(times, inbox, "time_s", 1)?.to_vec(),
        width: movement.width,
        height: movement.height,
        max_threads: movement.max_threads,
        seed: movement.seed,
    })
}

fn take_plane(plane: Plane, inbox: &Inbox) -> Result<Gray<'_>, &'static str> {
    let Plane { at, width, height } = plane;
    let data =
        inbox.elements(at, width as usize * height as usize).ok_or("a picture lies outside the memory")?;
    Ok(Gray { data, width, height, stride: width as usize })
}

fn take_frame<'m>(frame: &Frame, inbox: &'m Inbox) -> Result<FrameView<'m>, &'static str> {
    let chroma = match frame.chroma {
        Some([cb, cr]) => Some(Chroma { cb: take_plane(cb, inbox)?, cr: take_plane(cr, inbox)? }),
        None => None,
    };
    let range = match frame.range.as_deref() {
        Some(LIMITED) => Some(Range::Limited),
        Some(FULL) => Some(Range::Full),
        _ => None,
    };
    let gray = take_plane(frame.gray, inbox)?;
    Ok(FrameView { gray, chroma, range, index: frame.index, time_s: frame.time_s })
}

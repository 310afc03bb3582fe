//! The process' side of a request: what was said is taken apart again.

use super::memory::Inbox;
use super::{Ask, Columns, FULL, Frame, LIMITED, Movement, Plane};
use crate::instance::Request;
use crate::reply::Element;
use crate::simulator::{Detail, PlantInstance, Steps, WindRows};
use crate::types::{DetectRequest, Filmed, FrameView, GroupTree, Node, Point, StreamInfo, Tracks};
use honami_model::picture::{Chroma, Gray, Range};

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
        Ask::Save => Request::Save,
        Ask::Load { state } => Request::Load(take(state, inbox, "bytes", 1)?),
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
        Ask::Grow { movement, groups, root, mask } => {
            let tracks = &take_tracks(movement, inbox)?;
            let groups = &take_groups(groups, tracks.len(), inbox)?;
            let mask = mask.map(|mask| take_plane(mask, inbox)).transpose()?;
            return Ok(act(&Request::Grow(&Filmed { tracks, groups, root: *root, mask })));
        }
        Ask::Prepare { skeleton, instances, max_threads, seed } => {
            let (nodes, instances) = (take_nodes(skeleton, inbox)?, take_instances(instances, inbox)?);
            let (nodes, instances, max_threads, seed) = (&nodes, &instances, *max_threads, *seed);
            return Ok(act(&Request::Prepare { nodes, instances, max_threads, seed }));
        }
        Ask::Reset => Request::Reset,
        Ask::Step { dt, n_steps, wind, n_winds, detail } => {
            let winds = Columns { rows: *n_winds, at: wind.at.clone() };
            let wind = WindRows {
                times_s: take(wind, inbox, "time_s", 1)?,
                velocities: take::<f32>(&winds, inbox, "wind", 3)?.as_chunks().0,
            };
            let detail = detail.as_ref().map(|detail| take_detail(detail, inbox)).transpose()?;
            let steps = Steps { dt: *dt, n: *n_steps, wind, detail: detail.as_deref() };
            return Ok(act(&Request::Step(&steps)));
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

fn take_instances(instances: &Columns, inbox: &Inbox) -> Result<Vec<PlantInstance>, &'static str> {
    let number = |name| take::<f32>(instances, inbox, name, 1);
    let rows = number("yaw")?.iter().zip(number("scale")?).zip(number("mass")?);
    Ok(rows.map(|((&yaw, &scale), &mass)| PlantInstance { yaw, scale, mass }).collect())
}

fn take_detail(detail: &Columns, inbox: &Inbox) -> Result<Vec<Detail>, &'static str> {
    let (nodes, modes) = (take::<u32>(detail, inbox, "nodes", 1)?, take::<u32>(detail, inbox, "modes", 1)?);
    Ok(nodes.iter().zip(modes).map(|(&nodes, &modes)| Detail { nodes, modes }).collect())
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

fn take_groups(groups: &Columns, n_tracks: usize, inbox: &Inbox) -> Result<GroupTree, &'static str> {
    let of = Columns { rows: n_tracks as u64, at: groups.at.clone() };
    Ok(GroupTree {
        parents: take(groups, inbox, "parent", 1)?.to_vec(),
        of: take(&of, inbox, "group", 1)?.to_vec(),
        numbers: Vec::new(),
    })
}

fn take_plane(plane: Plane, inbox: &Inbox) -> Result<Gray<'_>, &'static str> {
    let Plane { at, width, height } = plane;
    let data =
        inbox.picture(at, width as usize * height as usize).ok_or("a picture lies outside the memory")?;
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

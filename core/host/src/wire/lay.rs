//! The host's side of a request: what belongs to it is laid into the memory, and said.

use super::memory::{Outbox, bytes_of};
use super::{Ask, Columns, FULL, Frame, LIMITED, Movement, Plane, Stream};
use crate::instance::Request;
use crate::simulator::{Detail, PlantInstance, WindRows};
use crate::types::{Filmed, FrameView, GroupTree, Node, Point, Tracks};
use honami_model::picture::{Gray, Range};

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
        Request::Save => Ask::Save,
        Request::Load(bytes) => Ask::Load { state: put(out, bytes.len(), &[("bytes", bytes)])? },
        Request::Detect(wanted) => Ask::Detect {
            frame: put_frame(&wanted.frame, out)?,
            max_features: wanted.max_features,
            mask: put_mask(wanted.mask.as_ref(), out)?,
            points: put_points(wanted.points, out)?,
            max_threads: wanted.max_threads,
            seed: wanted.seed,
        },
        Request::Field { from, to, max_threads } => {
            Ask::Field { from: put_frame(from, out)?, to: put_frame(to, out)?, max_threads }
        }
        Request::Cluster(tracks) => Ask::Cluster(put_tracks(tracks, out)?),
        Request::Grow(filmed) => put_filmed(filmed, out)?,
        Request::Prepare { nodes, instances, max_threads, seed } => {
            let (skeleton, instances) = (put_nodes(nodes, out)?, put_instances(instances, out)?);
            Ask::Prepare { skeleton, instances, max_threads, seed }
        }
        Request::Reset => Ask::Reset,
        Request::Step(steps) => {
            let WindRows { times_s, velocities } = steps.wind;
            let columns = [("time_s", bytes_of(times_s)), ("wind", bytes_of(velocities.as_flattened()))];
            Ask::Step {
                dt: steps.dt,
                n_steps: steps.n,
                wind: put(out, times_s.len(), &columns)?,
                n_winds: velocities.len() as u64,
                detail: match steps.detail {
                    Some(detail) => Some(put_detail(detail, out)?),
                    None => None,
                },
            }
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

fn put_instances(instances: &[PlantInstance], out: &mut Outbox) -> Option<Columns> {
    let of = |number: fn(&PlantInstance) -> f32| instances.iter().map(number).collect::<Vec<f32>>();
    let (yaw, scale, mass) = (of(|copy| copy.yaw), of(|copy| copy.scale), of(|copy| copy.mass));
    let columns = [("yaw", bytes_of(&yaw)), ("scale", bytes_of(&scale)), ("mass", bytes_of(&mass))];
    put(out, instances.len(), &columns)
}

fn put_detail(detail: &[Detail], out: &mut Outbox) -> Option<Columns> {
    let of = |number: fn(&Detail) -> u32| detail.iter().map(number).collect::<Vec<u32>>();
    let (nodes, modes) = (of(|copy| copy.nodes), of(|copy| copy.modes));
    put(out, detail.len(), &[("nodes", bytes_of(&nodes)), ("modes", bytes_of(&modes))])
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

fn put_filmed(filmed: &Filmed<'_>, out: &mut Outbox) -> Option<Ask> {
    let GroupTree { parents, of, .. } = filmed.groups;
    Some(Ask::Grow {
        movement: put_tracks(filmed.tracks, out)?,
        groups: put(out, parents.len(), &[("parent", bytes_of(parents)), ("group", bytes_of(of))])?,
        root: filmed.root,
        mask: put_mask(filmed.mask.as_ref(), out)?,
    })
}

/// The plane of a mask, where there is one; `None` when it does not fit.
fn put_mask(mask: Option<&Gray<'_>>, out: &mut Outbox) -> Option<Option<Plane>> {
    match mask {
        Some(mask) => put_plane(mask, out).map(Some),
        None => Some(None),
    }
}

fn put_plane(gray: &Gray<'_>, out: &mut Outbox) -> Option<Plane> {
    let (width, height) = (gray.width as usize, gray.height as usize);
    let at = if gray.stride == width {
        out.put_picture(width * height, std::iter::once(gray.data.get(..width * height)?))?
    } else {
        let rows = (0..height).map_while(|y| gray.data.get(y * gray.stride..y * gray.stride + width));
        out.put_picture(width * height, rows)?
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

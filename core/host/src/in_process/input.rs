//! What goes to a plugin, in the shapes of the header. Everything borrows; nothing outlives the call.

use crate::simulator::{Detail, PlantInstance, Steps, WindRows};
use crate::types::{DetectRequest, Filmed, FrameView, GroupTree, Node, Point, StreamInfo, Tracks};
use honami_abi::{self as abi, dtype, schema};
use honami_model::picture::Range;
use std::ffi::CStr;
use std::ptr::null;

/// Columns that belong together. Those that are gathered from records are kept in `_owned`.
pub(super) struct InputTable {
    table: abi::Table,
    columns: Vec<abi::Column>,
    _owned: Vec<Owned>,
}

/// A gathered column.
enum Owned {
    U32(Vec<u32>),
    I32(Vec<i32>),
    F32(Vec<f32>),
}

impl InputTable {
    fn new(schema: &'static CStr, rows: usize, columns: Vec<abi::Column>) -> Self {
        let table = abi::Table {
            struct_size: size_of::<abi::Table>() as u32,
            ncols: columns.len() as u32,
            schema: schema.as_ptr(),
            cols: columns.as_ptr(),
            rows: rows as u64,
        };
        Self { table, columns, _owned: Vec::new() }
    }

    /// The table, for as long as `self` lives.
    pub(super) fn raw(&self) -> *const abi::Table {
        debug_assert_eq!(self.table.cols, self.columns.as_ptr(), "columns do not move");
        &raw const self.table
    }

    fn gathered(schema: &'static CStr, rows: usize, parts: Vec<(&'static CStr, Owned)>) -> Self {
        // A vector's elements stay where they are when the vector moves.
        let columns = parts
            .iter()
            .map(|(name, owned)| match owned {
                Owned::U32(data) => column(name, dtype::U32, rows, data),
                Owned::I32(data) => column(name, dtype::I32, rows, data),
                Owned::F32(data) => column(name, dtype::F32, rows, data),
            })
            .collect();
        let owned = parts.into_iter().map(|(_, owned)| owned).collect();
        Self { _owned: owned, ..Self::new(schema, rows, columns) }
    }

    pub(super) fn points(points: &[Point]) -> Self {
        Self::gathered(
            schema::POINTS,
            points.len(),
            vec![
                (c"id", Owned::U32(points.iter().map(|p| p.id).collect())),
                (c"x", Owned::F32(points.iter().map(|p| p.x).collect())),
                (c"y", Owned::F32(points.iter().map(|p| p.y).collect())),
            ],
        )
    }

    pub(super) fn tracks(tracks: &Tracks) -> Self {
        let (n, samples) = (tracks.len(), tracks.x.len());
        let columns = vec![
            column(c"id", dtype::U32, n, &tracks.ids),
            column(c"frame0", dtype::I64, n, &tracks.first_frames),
            column(c"len", dtype::U32, n, &tracks.lens),
            column(c"offset", dtype::U64, n, &tracks.offsets),
            column(c"x", dtype::F32, samples, &tracks.x),
            column(c"y", dtype::F32, samples, &tracks.y),
            column(c"status", dtype::U8, samples, &tracks.status),
        ];
        Self::new(schema::TRACKS, n, columns)
    }

    pub(super) fn times(tracks: &Tracks) -> Self {
        let n = tracks.frames.len();
        let frames = column(c"frame", dtype::I64, n, &tracks.frames);
        Self::new(schema::TIMES, n, vec![frames, column(c"time_s", dtype::F64, n, &tracks.times_s)])
    }

    pub(super) fn groups(groups: &GroupTree) -> Self {
        let (n, tracks) = (groups.parents.len(), groups.of.len());
        let parents = column(c"parent", dtype::I32, n, &groups.parents);
        Self::new(schema::GROUPS, n, vec![parents, column(c"group", dtype::I32, tracks, &groups.of)])
    }

    pub(super) fn skeleton(nodes: &[Node]) -> Self {
        let row = |row: Option<u32>| row.and_then(|row| i32::try_from(row).ok()).unwrap_or(-1);
        let axis = |k: usize| Owned::F32(nodes.iter().map(|n| n.position[k]).collect());
        Self::gathered(
            schema::SKELETON,
            nodes.len(),
            vec![
                (c"parent", Owned::I32(nodes.iter().map(|n| row(n.parent)).collect())),
                (c"x", axis(0)),
                (c"y", axis(1)),
                (c"z", axis(2)),
                (c"radius", Owned::F32(nodes.iter().map(|n| n.radius).collect())),
                (c"track", Owned::I32(nodes.iter().map(|n| row(n.track)).collect())),
            ],
        )
    }

    pub(super) fn instances(instances: &[PlantInstance]) -> Self {
        let of = |number: fn(&PlantInstance) -> f32| Owned::F32(instances.iter().map(number).collect());
        let columns = vec![
            (c"yaw", of(|copy| copy.yaw)),
            (c"scale", of(|copy| copy.scale)),
            (c"mass", of(|copy| copy.mass)),
        ];
        Self::gathered(schema::INSTANCES, instances.len(), columns)
    }

    pub(super) fn wind(wind: WindRows<'_>) -> Self {
        let (n, velocities) = (wind.times_s.len(), wind.velocities.as_flattened());
        let columns = vec![
            column(c"time_s", dtype::F64, n, wind.times_s),
            column(c"wind", dtype::F32, wind.velocities.len(), velocities),
        ];
        Self::new(schema::WIND, n, columns)
    }

    pub(super) fn detail(detail: &[Detail]) -> Self {
        let of = |number: fn(&Detail) -> u32| Owned::U32(detail.iter().map(number).collect());
        let columns = vec![(c"nodes", of(|copy| copy.nodes)), (c"modes", of(|copy| copy.modes))];
        Self::gathered(schema::DETAIL, detail.len(), columns)
    }
}

/// A column over `data`, which holds a whole number of elements a row.
fn column<T>(name: &'static CStr, dtype: u32, rows: usize, data: &[T]) -> abi::Column {
    // The plugin only reads: the header says so of every table that the host passes in.
    let start = data.as_ptr().cast_mut().cast();
    let ncomp = data.len().checked_div(rows).unwrap_or(1) as u32;
    abi::Column { name: name.as_ptr(), dtype, ncomp, data: start, rows: rows as u64 }
}

pub(super) fn frame(view: &FrameView<'_>) -> abi::Frame {
    abi::Frame {
        struct_size: size_of::<abi::Frame>() as u32,
        pixel: abi::GRAY8,
        width: view.gray.width,
        height: view.gray.height,
        stride: view.gray.stride as i64,
        data: view.gray.data.as_ptr(),
        index: view.index,
        time_s: view.time_s,
        cb: view.chroma.map_or(null(), |chroma| chroma.cb.data.as_ptr()),
        cr: view.chroma.map_or(null(), |chroma| chroma.cr.data.as_ptr()),
        chroma_stride: view.chroma.map_or(0, |chroma| chroma.cb.stride as i64),
        range: match view.range {
            None => 0,
            Some(Range::Limited) => abi::range::LIMITED,
            Some(Range::Full) => abi::range::FULL,
        },
        reserved: 0,
        chroma_width: view.chroma.map_or(0, |chroma| chroma.cb.width),
        chroma_height: view.chroma.map_or(0, |chroma| chroma.cb.height),
    }
}

pub(super) fn stream(info: &StreamInfo) -> abi::StreamInfo {
    abi::StreamInfo {
        struct_size: size_of::<abi::StreamInfo>() as u32,
        pixel: abi::GRAY8,
        width: info.width,
        height: info.height,
        fps: info.fps.unwrap_or(0.0),
        nframes: info.n_frames.and_then(|n| i64::try_from(n).ok()).unwrap_or(-1),
        direction: if info.reversed { -1 } else { 1 },
        max_threads: info.max_threads.max(1),
        seed: info.seed,
        birth_first: info.births.start,
        birth_count: info.births.len() as u32,
    }
}

pub(super) fn detect(
    wanted: &DetectRequest<'_>,
    frame: &abi::Frame,
    points: *const abi::Table,
) -> abi::DetectInput {
    abi::DetectInput {
        struct_size: size_of::<abi::DetectInput>() as u32,
        max_features: wanted.max_features,
        frame,
        mask: wanted.mask.map_or(null(), |mask| mask.data.as_ptr()),
        mask_stride: wanted.mask.map_or(0, |mask| mask.stride as i64),
        points: if wanted.points.is_empty() { null() } else { points },
        max_threads: wanted.max_threads.max(1),
        reserved: 0,
        seed: wanted.seed,
    }
}

pub(super) fn clusterer(
    tracks: &Tracks,
    rows: *const abi::Table,
    times: *const abi::Table,
) -> abi::ClustererInput {
    abi::ClustererInput {
        struct_size: size_of::<abi::ClustererInput>() as u32,
        max_threads: tracks.max_threads.max(1),
        width: tracks.width,
        height: tracks.height,
        seed: tracks.seed,
        tracks: rows,
        times,
    }
}

pub(super) fn structure(
    filmed: &Filmed<'_>,
    [tracks, times, groups]: [&InputTable; 3],
) -> abi::StructureInput {
    let Filmed { tracks: of, root, mask, .. } = filmed;
    abi::StructureInput {
        struct_size: size_of::<abi::StructureInput>() as u32,
        max_threads: of.max_threads.max(1),
        width: of.width,
        height: of.height,
        seed: of.seed,
        tracks: tracks.raw(),
        times: times.raw(),
        groups: groups.raw(),
        root: root.as_ref().map_or(null(), |root| root.as_ptr()),
        mask: mask.map_or(null(), |mask| mask.data.as_ptr()),
        mask_stride: mask.map_or(0, |mask| mask.stride as i64),
    }
}

pub(super) fn steps(steps: &Steps<'_>, wind: &InputTable, detail: Option<&InputTable>) -> abi::StepInput {
    abi::StepInput {
        struct_size: size_of::<abi::StepInput>() as u32,
        n_steps: steps.n,
        dt: steps.dt,
        wind: if steps.wind.times_s.is_empty() { null() } else { wind.raw() },
        detail: detail.map_or(null(), InputTable::raw),
    }
}

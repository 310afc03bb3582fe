//! A short life of a plugin, in the hands of one host or another.

use super::Sized32;
use super::desk::Desk;
use super::dress::{Dress, Placed};
use super::library::Library;
use super::made::Made;
use crate::{Fault, Subject};
use honami_abi::{self as abi, Code, Column, dtype, interface, schema};
use honami_host::{Kind, PluginInfo};
use std::ffi::CStr;
use std::ptr::null;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;
const N_FRAMES: i64 = 4;
/// Tracks of a clusterer or a structure builder, and frames of each.
const N_TRACKS: usize = 8;
const N_TIMES: usize = 40;

/// What is done with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene {
    pub(crate) dress: Dress,
    /// Whether frames have colour.
    pub(crate) has_colour: bool,
    /// Whether parameters are set, or none of them is named.
    pub(crate) sets_params: bool,
    /// The function that gets no memory for its results.
    pub(crate) refuses: Option<&'static str>,
}

/// What came of it.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Played {
    /// All that was committed, in its order.
    pub(crate) results: Vec<(String, u64, Vec<u8>)>,
    /// The function that could not do it, and why; nothing was asked of the plugin after that.
    pub(crate) ended: Option<String>,
    /// How often it was refused memory.
    pub(crate) n_refused: u32,
}

/// Why a scene ends early.
enum Stop {
    Fault(Fault),
    Failed(String),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// Plays a scene with a plugin.
pub(crate) fn play(subject: &Subject, scene: Scene) -> Result<Played, Fault> {
    let info = &subject.info;
    let library = Library::dressed(subject, scene.dress)?;
    let desk = Desk::dressed(scene.dress)?;
    let made = Made::of(&library, &desk, info)?;
    let mut stage = Stage { info, scene, desk, made, results: Vec::new() };
    let ended = match stage.all() {
        Ok(()) => None,
        Err(Stop::Failed(why)) => Some(why),
        Err(Stop::Fault(fault)) => return Err(fault),
    };
    Ok(Played { n_refused: stage.desk.n_refused(), results: stage.results, ended })
}

struct Stage<'a> {
    info: &'a PluginInfo,
    scene: Scene,
    desk: Desk,
    made: Made,
    results: Vec<(String, u64, Vec<u8>)>,
}

impl Stage<'_> {
    fn all(&mut self) -> Result<(), Stop> {
        let reserved = if let Dress::Reserved(number) = self.scene.dress { number } else { 0 };
        let code = self.made.set_defaults(&self.desk, self.info, self.scene.sets_params, reserved)?;
        self.after("set_params", code)?;
        match self.info.kind {
            Kind::Tracker => self.tracker(),
            Kind::Clusterer => self.clusterer(),
            Kind::Simulator => self.simulator(),
            Kind::Structure => self.structure(),
        }
    }

    fn placed<T: Sized32>(&self, value: &T) -> Result<Placed<T>, Fault> {
        Placed::new(value, self.scene.dress)
    }

    /// Makes a call that may have results.
    fn call(
        &mut self,
        name: &'static str,
        call: impl FnOnce(*mut abi::Instance, *const abi::Call) -> Code,
    ) -> Result<(), Stop> {
        let before = self.desk.n_refused();
        self.desk.refuse(self.scene.refuses == Some(name));
        let code = call(self.made.raw(), self.desk.raw());
        self.desk.refuse(false);
        if self.desk.n_refused() > before && code >= 0 {
            return Err(Fault(format!(
                "{name} was refused memory for its results and returned {code}, wanted HONAMI_E_MEMORY (-6) or another failure"
            ))
            .into());
        }
        self.results.extend(self.desk.results());
        self.after(name, code)
    }

    fn after(&self, name: &str, code: Code) -> Result<(), Stop> {
        let why = self.desk.why();
        if code >= 0 { Ok(()) } else { Err(Stop::Failed(format!("{name}: {why} (code {code})"))) }
    }

    fn tracker(&mut self) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::TrackerV1 = unsafe { self.made.table(interface::TRACKER)? };
        let (Some(begin), Some(seed), Some(retire), Some(push), Some(end)) =
            (table.begin, table.seed, table.retire, table.push, table.end)
        else {
            return Err(lacking(interface::TRACKER).into());
        };
        let picture = Picture::new(0);
        let first = self.placed(&picture.frame(0, self.scene.has_colour))?;
        if self.info.offers("honami.detect/1") {
            self.detect(&first)?;
        }
        let stream = self.placed(&stream())?;
        // SAFETY: the plugin's function, a live instance, structs and columns that outlive the call.
        self.call("begin", |raw, call| unsafe { begin(raw, call, stream.raw()) })?;
        // SAFETY: as in `begin`.
        self.call("the first push", |raw, call| unsafe { push(raw, call, first.raw()) })?;
        let points = Columns::points();
        let seeds = self.placed(&points.table(schema::POINTS, points.rows))?;
        // SAFETY: as in `begin`.
        self.call("seed", |raw, call| unsafe { seed(raw, call, seeds.raw()) })?;
        for k in 1..N_FRAMES {
            let picture = Picture::new(k);
            let frame = self.placed(&picture.frame(k, self.scene.has_colour))?;
            // SAFETY: as in `begin`.
            self.call("push", |raw, call| unsafe { push(raw, call, frame.raw()) })?;
            // Nobody, and then one.
            let ids = if k == 1 { &[][..] } else { &[3_u32][..] };
            let at = if ids.is_empty() { null() } else { ids.as_ptr() };
            // SAFETY: as in `begin`.
            self.call("retire", |raw, call| unsafe { retire(raw, call, at, ids.len() as u64) })?;
        }
        if self.info.offers("honami.field/1") {
            self.field(&first)?;
        }
        // SAFETY: as in `begin`.
        self.call("end", |raw, call| unsafe { end(raw, call) })
    }

    fn detect(&mut self, frame: &Placed<abi::Frame>) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::DetectV1 = unsafe { self.made.table(interface::DETECT)? };
        let detect = table.detect.ok_or_else(|| lacking(interface::DETECT))?;
        let input = abi::DetectInput {
            struct_size: 0,
            max_features: 16,
            frame: frame.raw(),
            mask: null(),
            mask_stride: 0,
            points: null(),
            max_threads: 1,
            reserved: 0,
            seed: 1,
        };
        let input = self.placed(&input)?;
        // SAFETY: as in `begin`.
        self.call("detect", |raw, call| unsafe { detect(raw, call, input.raw()) })
    }

    fn field(&mut self, from: &Placed<abi::Frame>) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::FieldV1 = unsafe { self.made.table(interface::FIELD)? };
        let field = table.field.ok_or_else(|| lacking(interface::FIELD))?;
        let picture = Picture::new(1);
        let to = self.placed(&picture.frame(1, self.scene.has_colour))?;
        let input = abi::FieldInput { struct_size: 0, max_threads: 1, from: from.raw(), to: to.raw() };
        let input = self.placed(&input)?;
        // SAFETY: as in `begin`.
        self.call("field", |raw, call| unsafe { field(raw, call, input.raw()) })
    }

    fn clusterer(&mut self) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::ClustererV1 = unsafe { self.made.table(interface::CLUSTERER)? };
        let run = table.run.ok_or_else(|| lacking(interface::CLUSTERER))?;
        let (tracks, times) = (Columns::tracks(), Columns::times());
        let placed_tracks = self.placed(&tracks.table(schema::TRACKS, tracks.rows))?;
        let placed_times = self.placed(&times.table(schema::TIMES, times.rows))?;
        let input = abi::ClustererInput {
            struct_size: 0,
            max_threads: 1,
            width: WIDTH,
            height: HEIGHT,
            seed: 1,
            tracks: placed_tracks.raw(),
            times: placed_times.raw(),
        };
        let input = self.placed(&input)?;
        // SAFETY: as in `begin`.
        self.call("run", |raw, call| unsafe { run(raw, call, input.raw()) })
    }

    fn structure(&mut self) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::StructureV1 = unsafe { self.made.table(interface::STRUCTURE)? };
        let run = table.run.ok_or_else(|| lacking(interface::STRUCTURE))?;
        let (tracks, times, groups) = (Columns::tracks(), Columns::times(), Columns::groups());
        let placed_tracks = self.placed(&tracks.table(schema::TRACKS, tracks.rows))?;
        let placed_times = self.placed(&times.table(schema::TIMES, times.rows))?;
        let placed_groups = self.placed(&groups.table(schema::GROUPS, groups.rows))?;
        let root = [36.5, 70.0];
        for root in [null(), root.as_ptr()] {
            let input = abi::StructureInput {
                struct_size: 0,
                max_threads: 1,
                width: WIDTH,
                height: HEIGHT,
                seed: 1,
                tracks: placed_tracks.raw(),
                times: placed_times.raw(),
                groups: placed_groups.raw(),
                root,
                mask: null(),
                mask_stride: 0,
            };
            let input = self.placed(&input)?;
            // SAFETY: as in `begin`.
            self.call("run", |raw, call| unsafe { run(raw, call, input.raw()) })?;
        }
        Ok(())
    }

    fn simulator(&mut self) -> Result<(), Stop> {
        // SAFETY: the struct of that interface.
        let table: abi::SimulatorV1 = unsafe { self.made.table(interface::SIMULATOR)? };
        let (Some(prepare), Some(reset), Some(step)) = (table.prepare, table.reset, table.step) else {
            return Err(lacking(interface::SIMULATOR).into());
        };
        let (plant, copies, wind) = (Columns::skeleton(), Columns::instances(), Columns::wind());
        let skeleton = self.placed(&plant.table(schema::SKELETON, plant.rows))?;
        let instances = self.placed(&copies.table(schema::INSTANCES, copies.rows))?;
        let (skeleton, instances) = (skeleton.raw(), instances.raw());
        let input = abi::SimulatorInput { struct_size: 0, max_threads: 1, seed: 1, skeleton, instances };
        let input = self.placed(&input)?;
        // SAFETY: as in `begin`.
        self.call("prepare", |raw, call| unsafe { prepare(raw, call, input.raw()) })?;
        let wind = self.placed(&wind.table(schema::WIND, wind.rows))?;
        for _ in 0..2 {
            for wind in [null(), wind.raw()] {
                let input = abi::StepInput { struct_size: 0, n_steps: 3, dt: 0.005, wind, detail: null() };
                let input = self.placed(&input)?;
                // SAFETY: as in `begin`.
                self.call("step", |raw, call| unsafe { step(raw, call, input.raw()) })?;
            }
            // SAFETY: as in `begin`.
            self.call("reset", |raw, call| unsafe { reset(raw, call) })?;
        }
        Ok(())
    }
}

fn lacking(id: &CStr) -> Fault {
    Fault(format!("its table of {} lacks functions", id.to_string_lossy()))
}

fn stream() -> abi::StreamInfo {
    abi::StreamInfo {
        struct_size: 0,
        pixel: abi::GRAY8,
        width: WIDTH,
        height: HEIGHT,
        fps: 25.0,
        nframes: N_FRAMES,
        direction: 1,
        max_threads: 1,
        seed: 1,
        birth_first: 1000,
        birth_count: 1000,
    }
}

/// A texture that moves right by a pixel in each frame.
struct Picture {
    luma: Vec<u8>,
    chroma: Vec<u8>,
}

impl Picture {
    fn new(index: i64) -> Self {
        let value = |k: u32| {
            let (x, y) = (f64::from(k % WIDTH) - index as f64, f64::from(k / WIDTH));
            let waves =
                (0.35 * x + 0.1 * y).sin() + (0.23 * y - 0.17 * x).sin() + (0.9 * x).sin() * (0.8 * y).cos();
            (128.0 + 40.0 * waves) as u8
        };
        let chroma = (0..WIDTH * HEIGHT / 4).map(|k| 96 + (k % 64) as u8).collect();
        Self { luma: (0..WIDTH * HEIGHT).map(value).collect(), chroma }
    }

    fn frame(&self, index: i64, has_colour: bool) -> abi::Frame {
        let (chroma, halved) = if has_colour { (self.chroma.as_ptr(), 2) } else { (null(), u32::MAX) };
        abi::Frame {
            struct_size: 0,
            pixel: abi::GRAY8,
            width: WIDTH,
            height: HEIGHT,
            stride: i64::from(WIDTH),
            data: self.luma.as_ptr(),
            index,
            time_s: index as f64 / 25.0,
            cb: chroma,
            cr: chroma,
            chroma_stride: i64::from(WIDTH / halved),
            range: 0,
            reserved: 0,
            chroma_width: WIDTH / halved,
            chroma_height: HEIGHT / halved,
        }
    }
}

/// The columns of a table, and their data.
struct Columns {
    columns: Vec<Column>,
    rows: u64,
    _data: Vec<Box<[u64]>>,
}

impl Columns {
    fn new(rows: usize) -> Self {
        Self { columns: Vec::new(), rows: rows as u64, _data: Vec::new() }
    }

    /// Another column, of numbers as their bytes.
    fn with<const N: usize>(
        mut self,
        name: &'static CStr,
        dtype: u32,
        data: impl Iterator<Item = [u8; N]>,
    ) -> Self {
        let bytes: Vec<u8> = data.flatten().collect();
        let words = bytes.chunks(8).map(|chunk| {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            u64::from_ne_bytes(word)
        });
        let mut words: Box<[u64]> = words.collect();
        let rows = (bytes.len() / N) as u64;
        self.columns.push(Column {
            name: name.as_ptr(),
            dtype,
            ncomp: 1,
            data: words.as_mut_ptr().cast(),
            rows,
        });
        self._data.push(words);
        self
    }

    /// A column of f32.
    fn floats<'a>(self, name: &'static CStr, data: impl IntoIterator<Item = &'a f32>) -> Self {
        self.with(name, dtype::F32, data.into_iter().map(|v| v.to_ne_bytes()))
    }

    /// A trunk of 1.5 m that forks.
    fn skeleton() -> Self {
        Self::new(5)
            .with(c"parent", dtype::I32, [-1_i32, 0, 1, 2, 2].into_iter().map(i32::to_ne_bytes))
            .floats(c"x", &[0.0, 0.0, 0.0, 0.3, -0.2])
            .floats(c"y", &[0.0, 0.0, 0.0, 0.1, 0.2])
            .floats(c"z", &[0.0, 0.5, 1.0, 1.4, 1.5])
            .floats(c"radius", &[0.03, 0.025, 0.02, 0.01, 0.01])
    }

    fn instances() -> Self {
        Self::new(2).floats(c"yaw", &[0.0, 1.0]).floats(c"scale", &[1.0, 1.5]).floats(c"mass", &[1.0, 0.5])
    }

    /// A wind of its own for each of two copies, at two times.
    fn wind() -> Self {
        let velocities = [[2.0_f32, 0.0, 0.0], [0.0, 3.0, 0.0], [1.0, 1.0, 0.5], [0.0; 3]];
        let rows = velocities.len() as u64;
        let mut wind = Self::new(2)
            .with(c"time_s", dtype::F64, [0.0_f64, 0.01].into_iter().map(f64::to_ne_bytes))
            .floats(c"wind", velocities.as_flattened());
        if let Some(column) = wind.columns.last_mut() {
            (column.ncomp, column.rows) = (3, rows);
        }
        wind
    }

    fn table(&self, schema: &CStr, rows: u64) -> abi::Table {
        let ncols = self.columns.len() as u32;
        abi::Table { struct_size: 0, ncols, schema: schema.as_ptr(), cols: self.columns.as_ptr(), rows }
    }

    fn points() -> Self {
        let points = [(3_u32, 40.0_f32, 30.0_f32), (1, 50.5, 36.25), (2, 60.0, 40.0), (9, 45.0, 42.5)];
        Self::new(points.len())
            .with(c"id", dtype::U32, points.iter().map(|p| p.0.to_ne_bytes()))
            .with(c"x", dtype::F32, points.iter().map(|p| p.1.to_ne_bytes()))
            .with(c"y", dtype::F32, points.iter().map(|p| p.2.to_ne_bytes()))
    }

    /// Half of them sway twice as fast as the others.
    fn tracks() -> Self {
        let all = || (0..N_TRACKS).flat_map(|track| (0..N_TIMES).map(move |frame| (track, frame)));
        let x = all().map(|(track, frame)| {
            let pace = if track % 2 == 0 { 0.25 } else { 0.5 };
            (10.0 * track as f64 + 3.0 * (pace * frame as f64 + 0.01 * track as f64).sin()) as f32
        });
        Self::new(N_TRACKS)
            .with(c"id", dtype::U32, (0..N_TRACKS as u32).map(|id| id.to_ne_bytes()))
            .with(c"frame0", dtype::I64, (0..N_TRACKS).map(|_| 0_i64.to_ne_bytes()))
            .with(c"len", dtype::U32, (0..N_TRACKS).map(|_| (N_TIMES as u32).to_ne_bytes()))
            .with(c"offset", dtype::U64, (0..N_TRACKS).map(|k| ((k * N_TIMES) as u64).to_ne_bytes()))
            .with(c"x", dtype::F32, x.map(f32::to_ne_bytes))
            .with(c"y", dtype::F32, all().map(|(track, _)| (8.0 * track as f32).to_ne_bytes()))
            .with(c"status", dtype::U8, all().map(|_| [abi::status::TRACKED]))
    }

    /// The whole, and two parts of it that tracks take turns in.
    fn groups() -> Self {
        let of = (0..N_TRACKS).map(|track| (1 + (track % 2) as i32).to_ne_bytes());
        Self::new(3).with(c"parent", dtype::I32, [-1_i32, 0, 0].into_iter().map(i32::to_ne_bytes)).with(
            c"group",
            dtype::I32,
            of,
        )
    }

    fn times() -> Self {
        Self::new(N_TIMES).with(c"frame", dtype::I64, (0..N_TIMES as i64).map(i64::to_ne_bytes)).with(
            c"time_s",
            dtype::F64,
            (0..N_TIMES).map(|k| (k as f64 / 25.0).to_ne_bytes()),
        )
    }
}

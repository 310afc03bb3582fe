//! Trackers across the border.

use super::table::{Reserved, column, given, slice};
use super::{Descriptor, HostCall, State, Told, door, new_instance};
use crate::state::Setting;
use crate::tracker::{Chroma, Detect, Frame, Gray, Points, Range, Seed, Stream, Tracker};
use crate::{Cx, Error, Params, Result};
use honami_abi::{self as abi, Call, Code, Instance, code, dtype, interface, schema};
use std::ffi::{CStr, c_void};

/// Describes a tracker to [`export!`](crate::export!).
#[must_use]
pub const fn tracker<T: Tracker>() -> Descriptor {
    Descriptor {
        kind: "tracker",
        info: T::INFO,
        interfaces: [
            ("honami.tracker/1", true),
            ("honami.detect/1", T::DETECT.is_some()),
            ("honami.field/1", T::FIELD.is_some()),
            ("honami.state/1", T::STATE.is_some()),
        ],
        params: T::Params::SCHEMA,
        latency: T::LATENCY,
        create: new_instance::<TrackerState<T>>,
    }
}

pub(super) struct TrackerState<T: Tracker> {
    params: T::Params,
    /// A number for the parameters that were set.
    told: u64,
    running: Option<T>,
    /// The stream that was begun last.
    setting: Option<Setting>,
    seeds: Vec<Seed>,
    out: Points,
}

impl<T: Tracker> State for TrackerState<T> {
    type Params = T::Params;

    fn new() -> Self {
        Self {
            params: T::Params::default(),
            told: 0,
            running: None,
            setting: None,
            seeds: Vec::new(),
            out: Points::default(),
        }
    }

    fn set(&mut self, params: T::Params, told: Told) -> Result<()> {
        if self.running.is_some() {
            return Err(Error::with_code(code::STATE, "parameters are set before begin or after end"));
        }
        (self.params, self.told) = (params, told.all());
        Ok(())
    }

    fn interface(id: &CStr) -> *const c_void {
        if id == interface::TRACKER {
            (&raw const *Self::TRACKER).cast()
        } else if id == interface::DETECT && T::DETECT.is_some() {
            (&raw const *Self::DETECT).cast()
        } else if id == interface::FIELD && T::FIELD.is_some() {
            (&raw const *Self::FIELD).cast()
        } else if id == interface::STATE && T::STATE.is_some() {
            (&raw const *Self::STATE).cast()
        } else {
            std::ptr::null()
        }
    }
}

impl<T: Tracker> TrackerState<T> {
    const TRACKER: &'static abi::TrackerV1 = &abi::TrackerV1 {
        struct_size: size_of::<abi::TrackerV1>() as u32,
        latency: T::LATENCY,
        begin: Some(begin::<T>),
        seed: Some(seed::<T>),
        retire: Some(retire::<T>),
        push: Some(push::<T>),
        end: Some(end::<T>),
    };
    const DETECT: &'static abi::DetectV1 = &abi::DetectV1 {
        struct_size: size_of::<abi::DetectV1>() as u32,
        reserved: 0,
        detect: Some(detect::<T>),
    };
    const FIELD: &'static abi::FieldV1 =
        &abi::FieldV1 { struct_size: size_of::<abi::FieldV1>() as u32, reserved: 0, field: Some(field::<T>) };

    const STATE: &'static abi::StateV1 = &super::state::table::<T>();

    /// The tracker in its stream, and under what it works.
    pub(super) fn at_work(&self) -> Result<(&T, &Setting)> {
        let both = self.running.as_ref().zip(self.setting.as_ref());
        both.ok_or_else(|| Error::with_code(code::STATE, "there is no stream: call begin first"))
    }

    /// What its trackers are made with.
    pub(super) fn settings(&self) -> &T::Params {
        &self.params
    }

    /// Another tracker takes the place of the one in the stream.
    pub(super) fn go_on_as(&mut self, tracker: T) {
        self.running = Some(tracker);
    }

    fn running(&mut self) -> Result<&mut T> {
        self.running
            .as_mut()
            .ok_or_else(|| Error::with_code(code::STATE, "there is no stream: call begin first"))
    }

    /// What was asked for beside the stream; a failure ends that too, as every failure does.
    fn aside<R>(&mut self, result: Result<R>) -> Result<R> {
        if result.is_err() {
            self.running = None;
        }
        result
    }

    /// Works on the stream; a failure ends it.
    fn with_running(&mut self, f: impl FnOnce(&mut T, &[Seed], &mut Points) -> Result<()>) -> Result<()> {
        self.running()?;
        let Self { running: Some(tracker), seeds, out, .. } = self else { return Ok(()) };
        let result = f(tracker, seeds, out);
        if result.is_err() {
            self.running = None;
        }
        result
    }
}

unsafe extern "C" fn begin<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    stream: *const abi::StreamInfo,
) -> Code {
    // SAFETY: the host keeps the contract of honami_tracker_v1, here and in the functions below.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            let stream = given(stream)?;
            if stream.pixel != abi::GRAY8 {
                return Err(Error::unsupported(format!(
                    "only 8-bit gray pixels, not format {}",
                    stream.pixel
                )));
            }
            if state.running.is_some() {
                return Err(Error::with_code(code::STATE, "a stream is running: end it first"));
            }
            let stream = Stream {
                width: stream.width,
                height: stream.height,
                fps: (stream.fps > 0.0).then_some(stream.fps),
                n_frames: u64::try_from(stream.nframes).ok(),
                reversed: stream.direction < 0,
                max_threads: stream.max_threads.max(1),
                seed: stream.seed,
                births: stream.birth_first..stream.birth_first.saturating_add(stream.birth_count),
            };
            state.running = Some(T::begin(&state.params, &stream, &Cx::new(call))?);
            state.setting = Some(Setting { params: state.told, stream });
            Ok(code::OK)
        })
    }
}

unsafe extern "C" fn seed<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    points: *const abi::Table,
) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            read_seeds(&given(points)?, &mut state.seeds)?;
            state.with_running(|tracker, seeds, _| tracker.seed(seeds, &Cx::new(call)))?;
            Ok(code::OK)
        })
    }
}

/// # Safety
/// The table is one of the host's and alive.
unsafe fn read_seeds(table: &abi::Table, seeds: &mut Vec<Seed>) -> Result<()> {
    // SAFETY: the caller's promise.
    let (ids, x, y) = unsafe {
        (column::<u32>(table, c"id", 1)?, column::<f32>(table, c"x", 1)?, column::<f32>(table, c"y", 1)?)
    };
    seeds.clear();
    seeds.extend(ids.iter().zip(x).zip(y).map(|((&id, &x), &y)| Seed { id, x, y }));
    Ok(())
}

unsafe extern "C" fn retire<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    ids: *const u32,
    n: u64,
) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, _| {
            state.running()?.retire(slice(ids, n)?);
            Ok(code::OK)
        })
    }
}

unsafe extern "C" fn push<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    frame: *const abi::Frame,
) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            let frame = read_frame(frame)?;
            state.out.restart(frame.index);
            state.with_running(|tracker, _, out| tracker.push(&frame, out, &Cx::new(call)))?;
            write_points::<T>(&state.out, call)
        })
    }
}

unsafe extern "C" fn end<T: Tracker>(instance: *mut Instance, call: *const Call) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            state.out.restart(0);
            let mut tracker =
                state.running.take().ok_or_else(|| Error::with_code(code::STATE, "there is no stream"))?;
            tracker.end(&mut state.out, &Cx::new(call))?;
            if !state.out.rows().is_empty() {
                write_points::<T>(&state.out, call)?;
            }
            Ok(code::OK)
        })
    }
}

/// # Safety
/// The frame is null or one of the host's and lives for `'a`.
unsafe fn read_frame<'a>(frame: *const abi::Frame) -> Result<Frame<'a>> {
    // SAFETY: the caller's promise; the header wants `height` rows of `stride` bytes, the last at least `width`.
    unsafe {
        let frame = given(frame)?;
        let gray = read_gray(frame.data, frame.width, frame.height, frame.stride)?;
        let (chroma, range) = match abi::has!(frame, abi::Frame, chroma_height) {
            true => (read_chroma(&frame)?, read_range(frame.range)),
            false => (None, None),
        };
        Ok(Frame { gray, chroma, range, index: frame.index, time_s: frame.time_s })
    }
}

/// # Safety
/// As [`read_gray`], for both chroma planes of the frame.
unsafe fn read_chroma<'a>(frame: &abi::Frame) -> Result<Option<Chroma<'a>>> {
    if frame.cb.is_null() && frame.cr.is_null() {
        return Ok(None);
    }
    let (width, height, stride) = (frame.chroma_width, frame.chroma_height, frame.chroma_stride);
    // SAFETY: the caller's promise.
    let (cb, cr) =
        unsafe { (read_gray(frame.cb, width, height, stride)?, read_gray(frame.cr, width, height, stride)?) };
    Ok(Some(Chroma { cb, cr }))
}

fn read_range(range: u32) -> Option<Range> {
    match range {
        abi::range::LIMITED => Some(Range::Limited),
        abi::range::FULL => Some(Range::Full),
        _ => None,
    }
}

/// # Safety
/// `data` is null or holds `height` rows of `stride` bytes, the last at least `width`, for `'a`.
unsafe fn read_gray<'a>(data: *const u8, width: u32, height: u32, stride: i64) -> Result<Gray<'a>> {
    let wrong = || {
        Error::with_code(code::ARGUMENT, format!("a {width}x{height} picture with rows of {stride} bytes"))
    };
    let stride = usize::try_from(stride).ok().ok_or_else(wrong)?;
    if width == 0 || height == 0 || stride < width as usize {
        return Err(wrong());
    }
    let n = (u64::from(height) - 1) * stride as u64 + u64::from(width);
    // SAFETY: the caller's promise.
    Ok(Gray { data: unsafe { slice(data, n) }?, width, height, stride })
}

fn write_points<T: Tracker>(points: &Points, call: &HostCall<'_>) -> Result<Code> {
    let rows = points.rows();
    if T::LATENCY > 0 && rows.is_empty() {
        return Ok(code::AGAIN);
    }
    let mut columns =
        vec![(c"id", dtype::U32, 1), (c"x", dtype::F32, 1), (c"y", dtype::F32, 1), (c"status", dtype::U8, 1)];
    let optional = [
        (rows.iter().any(|p| p.fb.is_some()), (c"fb", dtype::F32, 1)),
        (rows.iter().any(|p| p.ncc.is_some()), (c"ncc", dtype::F32, 1)),
        (T::LATENCY > 0, (c"frame", dtype::I64, 1)),
    ];
    columns.extend(optional.iter().filter(|(wanted, _)| *wanted).map(|(_, column)| column));
    let mut out = Reserved::new(call, schema::POINTS, rows.len(), &columns)?;
    out.fill(0, rows.iter().map(|p| p.id));
    out.fill(1, rows.iter().map(|p| p.x));
    out.fill(2, rows.iter().map(|p| p.y));
    out.fill(3, rows.iter().map(|p| p.status as u8));
    for (k, (name, ..)) in columns.iter().enumerate().skip(4) {
        match name.to_bytes() {
            b"fb" => out.fill(k, rows.iter().map(|p| p.fb.unwrap_or(abi::FB_NONE))),
            b"ncc" => out.fill(k, rows.iter().map(|p| p.ncc.unwrap_or(abi::NCC_NONE))),
            _ => out.fill(k, points.frames().iter().copied()),
        }
    }
    out.commit()?;
    Ok(code::OK)
}

unsafe extern "C" fn detect<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    input: *const abi::DetectInput,
) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            let input = given(input)?;
            let frame = read_frame(input.frame)?;
            let Gray { width, height, .. } = frame.gray;
            let mask = match input.mask.is_null() {
                true => None,
                false => Some(read_gray(input.mask, width, height, input.mask_stride)?),
            };
            match input.points.is_null() {
                true => state.seeds.clear(),
                false => read_seeds(&given(input.points)?, &mut state.seeds)?,
            }
            let request = Detect {
                frame,
                max_features: input.max_features,
                mask,
                points: &state.seeds,
                max_threads: input.max_threads.max(1),
                seed: input.seed,
            };
            let find = T::DETECT.ok_or_else(|| Error::unsupported("this tracker detects nothing"))?;
            let found = find(&state.params, &request, &Cx::new(call));
            let mut features = state.aside(found)?;
            features.truncate(input.max_features as usize);
            let columns = [(c"x", dtype::F32, 1), (c"y", dtype::F32, 1), (c"score", dtype::F32, 1)];
            let mut out = Reserved::new(call, schema::FEATURES, features.len(), &columns)?;
            out.fill(0, features.iter().map(|f| f.x));
            out.fill(1, features.iter().map(|f| f.y));
            out.fill(2, features.iter().map(|f| f.score));
            out.commit()?;
            Ok(code::OK)
        })
    }
}

unsafe extern "C" fn field<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    input: *const abi::FieldInput,
) -> Code {
    // SAFETY: see `begin`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            let input = given(input)?;
            let (from, to) = (read_frame(input.from)?, read_frame(input.to)?);
            let measure = T::FIELD.ok_or_else(|| Error::unsupported("this tracker measures no field"))?;
            let field = measure(&state.params, &from, &to, input.max_threads.max(1), &Cx::new(call));
            let field = state.aside(field)?;
            let vectors = [(c"u", dtype::F32, 1), (c"v", dtype::F32, 1), (c"known", dtype::U8, 1)];
            let mut out = Reserved::new(call, schema::VECTORS, field.vectors.len(), &vectors)?;
            let part = |k: usize| field.vectors.iter().map(move |vector| vector.unwrap_or_default()[k]);
            out.fill(0, part(0));
            out.fill(1, part(1));
            out.fill(2, field.vectors.iter().map(|vector| u8::from(vector.is_some())));
            out.commit()?;
            let (f, n) = (dtype::F32, dtype::U32);
            let grid = [(c"gx", f, 1), (c"gy", f, 1), (c"step", f, 1), (c"nx", n, 1), (c"ny", n, 1)];
            let mut out = Reserved::new(call, schema::GRID, 1, &grid)?;
            out.fill(0, std::iter::once(field.origin[0]));
            out.fill(1, std::iter::once(field.origin[1]));
            out.fill(2, std::iter::once(field.step));
            out.fill(3, std::iter::once(field.nx));
            out.fill(4, std::iter::once(field.ny));
            out.commit()?;
            Ok(code::OK)
        })
    }
}

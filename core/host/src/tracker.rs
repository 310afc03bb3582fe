//! A tracker at work, and the check of what it returns.

mod live;
mod state;

pub use state::Checkpoint;

use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Done, Handle, Request};
use crate::reply::{self, Reply};
use crate::types::{DetectRequest, Feature, Field, FrameView, Point, Points, StreamInfo};
use honami_model::picture::Gray;
use live::Live;

/// A tracker at work. Made by [`Host`](crate::Host).
///
/// `begin`, `push` (frame 0), `seed`, `push` (frame 1) … `end`. Seeds hold in the frame pushed last; before the first
/// push, in the first frame, where the tracker then reports them. A stream that fails ends the tracker; one that is
/// cancelled may be followed by another.
#[derive(Debug)]
pub struct Tracker {
    pub(crate) handle: Handle,
    pub(crate) reply: Reply,
    pub(crate) latency: u32,
    pub(crate) has_state: bool,
    pub(crate) stream: Option<Stream>,
}

/// The stream that is going on.
#[derive(Debug)]
pub(crate) struct Stream {
    info: StreamInfo,
    last: Option<(i64, f64)>,
    live: Live,
}

impl Tracker {
    /// Its id.
    #[must_use]
    pub fn plugin(&self) -> &str {
        &self.handle.plugin
    }

    /// By how many frames results lag behind; `u32::MAX`: all come at the end.
    #[must_use]
    pub fn latency(&self) -> u32 {
        self.latency
    }

    /// Whether its deaths are not counted: it begins where another one has died, and what dies twice of the same has
    /// failed once.
    pub fn pardon(&mut self, is_pardoned: bool) {
        if let Some(tally) = &mut self.handle.tally {
            tally.pause(is_pardoned);
        }
    }

    /// Starts a stream.
    ///
    /// # Errors
    /// [`HostError`], when one is going on or the plugin refuses it.
    pub fn begin(&mut self, info: StreamInfo, cx: &CallContext<'_>) -> Result<(), HostError> {
        if self.stream.is_some() {
            return Err(self.handle.usage("a stream is going on: end it first"));
        }
        if info.fps.is_some_and(|fps| !(fps.is_finite() && fps > 0.0)) || info.width == 0 || info.height == 0
        {
            let (width, height, fps) = (info.width, info.height, info.fps);
            return Err(self
                .handle
                .usage(format!("no stream has {width}x{height} pixels at {fps:?} frames a second")));
        }
        self.handle.ask(&Request::Begin(&info), cx, &mut self.reply)?;
        let live = Live::new(info.births.clone());
        self.stream = Some(Stream { info, last: None, live });
        Ok(())
    }

    /// Adds points, or moves those that are live.
    ///
    /// # Errors
    /// [`HostError`], when a position is not finite, an id comes twice or from the births, or the plugin fails.
    pub fn seed(&mut self, points: &[Point], cx: &CallContext<'_>) -> Result<(), HostError> {
        let Some(stream) = &mut self.stream else { return Err(no_stream(&self.handle)) };
        let mut ids: Vec<u32> = points.iter().map(|point| point.id).collect();
        ids.sort_unstable();
        if let Some(pair) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(self.handle.usage(format!("point {} is seeded twice", pair[0])));
        }
        if let Some(point) = points.iter().find(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return Err(self.handle.usage(format!("point {} has no finite position", point.id)));
        }
        if let Some(id) = ids.iter().find(|id| stream.info.births.contains(id) && !stream.live.is_known(**id))
        {
            return Err(self.handle.usage(format!("point {id} has an id that is reserved for births")));
        }
        let asked = self.handle.ask(&Request::Seed(points), cx, &mut self.reply);
        self.over_on_error(asked)?;
        if let Some(stream) = &mut self.stream {
            stream.live.seed(&ids);
        }
        Ok(())
    }

    /// Forgets points; ids that are not live are ignored.
    ///
    /// # Errors
    /// [`HostError`], when the plugin fails.
    pub fn retire(&mut self, ids: &[u32], cx: &CallContext<'_>) -> Result<(), HostError> {
        if self.stream.is_none() {
            return Err(no_stream(&self.handle));
        }
        let asked = self.handle.ask(&Request::Retire(ids), cx, &mut self.reply);
        self.over_on_error(asked)?;
        if let Some(stream) = &mut self.stream {
            stream.live.retire(ids);
        }
        Ok(())
    }

    /// Follows all live points into a frame. Gives the points of that frame; under latency those of earlier frames, or
    /// nothing yet.
    ///
    /// # Errors
    /// [`HostError`], when the frame does not fit the stream, or the plugin fails, is stopped, or returns what it must
    /// not: unknown ids, ids twice, numbers that are not finite, an unknown status, no rows at all.
    pub fn push(&mut self, frame: &FrameView<'_>, cx: &CallContext<'_>) -> Result<Vec<Points>, HostError> {
        let Some(stream) = &mut self.stream else { return Err(no_stream(&self.handle)) };
        if let Some(what) = stream.misfit(frame) {
            return Err(self.handle.usage(what));
        }
        stream.last = Some((frame.index, frame.time_s));
        stream.live.pushed(frame.index);
        let asked = self.handle.ask(&Request::Push(frame), cx, &mut self.reply);
        let done = self.over_on_error(asked)?;
        self.read("push", done)
    }

    /// Ends the stream; gives what was still due under latency.
    ///
    /// # Errors
    /// [`HostError`], as for [`push`](Self::push).
    pub fn end(&mut self, cx: &CallContext<'_>) -> Result<Vec<Points>, HostError> {
        if self.stream.is_none() {
            return Err(no_stream(&self.handle));
        }
        let asked = self.handle.ask(&Request::End, cx, &mut self.reply);
        self.over_on_error(asked)?;
        let points = self.read("end", Done::Ok);
        self.stream = None;
        points
    }

    fn read(&mut self, function: &'static str, done: Done) -> Result<Vec<Points>, HostError> {
        let Some(stream) = &mut self.stream else { return Ok(Vec::new()) };
        let table = self.reply.table(&reply::POINTS);
        let lag_max = match (function, self.latency) {
            ("end", _) | (_, 0) => 0,
            (_, latency) => latency as usize,
        };
        let checked = if done == Done::Again && (table.is_some() || self.latency == 0) {
            Err("returned again with a result, or without a latency".into())
        } else {
            stream.live.read(table, lag_max, self.latency > 0)
        };
        checked.map_err(|what| {
            self.stream = None;
            self.handle.misbehaved(function, what)
        })
    }

    fn over_on_error<T>(&mut self, result: Result<T, HostError>) -> Result<T, HostError> {
        if result.is_err() {
            self.stream = None;
        }
        result
    }

    /// Finds features in a frame, best first. Needs the interface `honami.detect/1`; legal at any time.
    ///
    /// # Errors
    /// [`HostError`], when the mask is not of the frame's size, or the plugin cannot do it, is stopped, or returns
    /// features outside the frame, too many, or numbers that are not finite.
    pub fn detect(
        &mut self,
        wanted: &DetectRequest<'_>,
        cx: &CallContext<'_>,
    ) -> Result<Vec<Feature>, HostError> {
        let gray = wanted.frame.gray;
        let mask_fits =
            |mask: &Gray<'_>| mask.is_whole() && (mask.width, mask.height) == (gray.width, gray.height);
        if !wanted.frame.is_whole() || !wanted.mask.as_ref().is_none_or(mask_fits) {
            return Err(self.handle.usage("the frame is not whole, or the mask has another size"));
        }
        let asked = self.handle.ask(&Request::Detect(wanted), cx, &mut self.reply);
        self.over_on_error(asked)?;
        let checked = read_features(&self.reply, wanted);
        checked.map_err(|what| self.handle.misbehaved("detect", what))
    }

    /// Measures dense motion between two frames. Needs the interface `honami.field/1`; legal at any time.
    ///
    /// # Errors
    /// [`HostError`], when the frames differ in size, or the plugin cannot do it, is stopped, or returns a grid that
    /// does not fit its vectors or numbers that are not finite.
    pub fn field(
        &mut self,
        from: &FrameView<'_>,
        to: &FrameView<'_>,
        max_threads: u32,
        cx: &CallContext<'_>,
    ) -> Result<Field, HostError> {
        let (a, b) = (from.gray, to.gray);
        if !from.is_whole() || !to.is_whole() || (a.width, a.height) != (b.width, b.height) {
            return Err(self.handle.usage("the frames are not whole, or differ in size"));
        }
        let asked = self.handle.ask(&Request::Field { from, to, max_threads }, cx, &mut self.reply);
        self.over_on_error(asked)?;
        read_field(&self.reply).map_err(|what| self.handle.misbehaved("field", what))
    }
}

fn no_stream(handle: &Handle) -> HostError {
    handle.usage("there is no stream: begin one first")
}

impl Stream {
    /// Why a frame cannot come now.
    fn misfit(&self, frame: &FrameView<'_>) -> Option<String> {
        let (width, height) = (frame.gray.width, frame.gray.height);
        if !frame.is_whole() || (width, height) != (self.info.width, self.info.height) {
            let wanted = (self.info.width, self.info.height);
            return Some(format!(
                "frame {} is {width}x{height} or not whole, wanted {wanted:?}",
                frame.index
            ));
        }
        let (last_index, last_time) = self.last?;
        let forward = frame.index > last_index && frame.time_s > last_time;
        let backward = frame.index < last_index && frame.time_s < last_time;
        let fits = if self.info.reversed { backward } else { forward };
        (!fits)
            .then(|| format!("frame {} does not come after frame {last_index} in this stream", frame.index))
    }
}

fn read_features(reply: &Reply, wanted: &DetectRequest<'_>) -> Result<Vec<Feature>, String> {
    let table = reply.table(&reply::FEATURES).ok_or("returned without committing honami.features/1")?;
    if table.rows() > wanted.max_features as usize {
        return Err(format!("committed {} features of at most {}", table.rows(), wanted.max_features));
    }
    let (width, height) = (wanted.frame.gray.width as f32, wanted.frame.gray.height as f32);
    let (xs, ys, scores) = (table.required("x"), table.required("y"), table.required("score"));
    let features = xs.iter().zip(ys).zip(scores).map(|((&x, &y), &score)| Feature { x, y, score });
    features
        .map(|feature| {
            // Pixel centres are whole numbers: the picture reaches half a pixel further. A NaN is in no range.
            let Feature { x, y, score } = feature;
            let inside =
                (-0.5..width - 0.5).contains(&x) && (-0.5..height - 0.5).contains(&y) && score.is_finite();
            if inside { Ok(feature) } else { Err(format!("found a feature at ({x}, {y}) of score {score}")) }
        })
        .collect()
}

fn read_field(reply: &Reply) -> Result<Field, String> {
    let vectors = reply.table(&reply::VECTORS).ok_or("returned without committing honami.vectors/1")?;
    let grid = reply.table(&reply::GRID).ok_or("returned without committing honami.grid/1")?;
    let number = |name| grid.required(name).first().copied().unwrap_or(f32::NAN);
    let count = |name| grid.required(name).first().copied().unwrap_or(0);
    let known = vectors.column::<u8>("known");
    let (u, v) = (vectors.required::<f32>("u"), vectors.required::<f32>("v"));
    if !u.iter().chain(v).all(|v| v.is_finite()) {
        return Err("committed vectors that are not finite".into());
    }
    let vector =
        |(k, (&u, &v)): (usize, (&f32, &f32))| known.is_none_or(|known| known[k] != 0).then_some([u, v]);
    let field = Field {
        origin: [number("gx"), number("gy")],
        step: number("step"),
        nx: count("nx"),
        ny: count("ny"),
        vectors: u.iter().zip(v).enumerate().map(vector).collect(),
    };
    if field.nx as usize * field.ny as usize != vectors.rows() {
        return Err(format!("committed {} vectors on a grid of {}x{}", vectors.rows(), field.nx, field.ny));
    }
    let finite = field.origin.iter().all(|v| v.is_finite());
    if finite && field.step.is_finite() && field.step > 0.0 {
        Ok(field)
    } else {
        Err("committed a grid with numbers that are not finite, or without a step".into())
    }
}

//! Trackers: plugins that follow points through the frames of a clip.

use crate::{Cx, Error, Info, Params, Result, State};
use honami_abi as abi;

/// Follows points through a stream of frames.
///
/// The order of calls: `begin`, `push` (frame 0), `seed`, `push` (frame 1), `push`, `seed`, `retire`, `push` … `end`.
///
/// Seeds hold in the frame pushed **last**; those that come before the first push hold in the first frame, where `push`
/// reports them where they were seeded. An id is live from its seed (or birth) until it is retired, or until `push`
/// leaves it out, which ends it for good. Seeding a live id moves it: a correction by hand.
pub trait Tracker: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;
    /// By how many frames results lag behind; see [`Points::add_at`]. `u32::MAX`: all come in `end`.
    const LATENCY: u32 = 0;
    /// Where to put features, if the tracker has a view on that.
    const DETECT: Option<DetectFn<Self::Params>> = None;
    /// Dense motion between two frames, if the tracker measures that.
    const FIELD: Option<FieldFn<Self::Params>> = None;
    /// What it carries from frame to frame, if it can save and load that.
    const STATE: Option<State<Self>> = None;

    /// Starts a stream with no points.
    ///
    /// # Errors
    /// Whatever keeps it from working on such a stream.
    fn begin(params: &Self::Params, stream: &Stream, cx: &Cx<'_>) -> Result<Self>;

    /// Adds points, or moves those that are live already.
    ///
    /// # Errors
    /// Whatever ends the stream.
    fn seed(&mut self, seeds: &[Seed], cx: &Cx<'_>) -> Result<()>;

    /// Forgets points; ignores ids that are not live.
    fn retire(&mut self, ids: &[u32]);

    /// Follows all live points into this frame: adds one row a live point to `out`, which comes empty.
    ///
    /// # Errors
    /// Whatever ends the stream. A lost point is no error but a row.
    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()>;

    /// Adds what is still due under [`LATENCY`](Self::LATENCY).
    ///
    /// # Errors
    /// Whatever keeps it from that.
    fn end(&mut self, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let (_, _) = (out, cx);
        Ok(())
    }
}

/// Finds features in a frame, best first, at most as many as asked for.
pub type DetectFn<P> = fn(&P, &Detect<'_>, &Cx<'_>) -> Result<Vec<Feature>>;
/// Measures dense motion from one frame to another.
pub type FieldFn<P> = fn(&P, from: &Frame<'_>, to: &Frame<'_>, max_threads: u32, &Cx<'_>) -> Result<Field>;

/// What is known of a stream before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Stream {
    /// Width of every frame, pixels.
    pub width: u32,
    /// Height of every frame, pixels.
    pub height: u32,
    /// Nominal frames per second; `None` if unknown. Exact times are in the frames.
    pub fps: Option<f64>,
    /// Frames to come, if known.
    pub n_frames: Option<u64>,
    /// Whether frames come backward: index and time fall.
    pub reversed: bool,
    /// Threads that may work at a time, at least 1.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
    /// Ids that the tracker may give to points of its own making (status [`Status::Newborn`]); often empty.
    pub births: std::ops::Range<u32>,
}

/// An 8-bit luma picture; rows are `stride` bytes apart.
#[derive(Clone, Copy, Debug)]
pub struct Gray<'a> {
    /// At least `(height - 1) * stride + width` bytes.
    pub data: &'a [u8],
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Bytes from a row to the next, at least `width`.
    pub stride: usize,
}

impl<'a> Gray<'a> {
    /// A picture whose rows follow each other without gaps.
    ///
    /// # Panics
    /// When `data` is not `width * height` bytes.
    #[must_use]
    #[track_caller]
    pub fn packed(data: &'a [u8], width: u32, height: u32) -> Self {
        assert_eq!(data.len(), width as usize * height as usize, "bytes of a {width}x{height} picture");
        Self { data, width, height, stride: width as usize }
    }

    /// One row, `width` bytes.
    ///
    /// # Panics
    /// When `y` is not a row of the picture.
    #[must_use]
    #[track_caller]
    pub fn row(&self, y: u32) -> &'a [u8] {
        assert!(y < self.height, "row {y} of {}", self.height);
        let start = y as usize * self.stride;
        &self.data[start..start + self.width as usize]
    }

    /// Pixels of the window of radius `r` (side 2r + 1) around the pixel nearest to (x, y), row by row; `None` where it
    /// leaves the picture.
    #[must_use]
    pub fn window(&self, x: f32, y: f32, r: u32) -> Option<Vec<u8>> {
        let [left, top] = [x, y].map(|v| (f64::from(v) + 0.5).floor() - f64::from(r));
        let fits = |start: f64, n: u32| start >= 0.0 && start + f64::from(2 * r) < f64::from(n);
        if !fits(left, self.width) || !fits(top, self.height) {
            return None;
        }
        let (left, top) = (left as usize, top as u32);
        let rows = (top..=top + 2 * r).map(|y| &self.row(y)[left..=left + 2 * r as usize]);
        Some(rows.collect::<Vec<_>>().concat())
    }
}

/// The colour of a picture: chroma planes as the clip has them, nothing converted.
#[derive(Clone, Copy, Debug)]
pub struct Chroma<'a> {
    /// Blue difference, 128 is none.
    pub cb: Gray<'a>,
    /// Red difference, 128 is none; laid out as `cb`.
    pub cr: Gray<'a>,
}

/// Which bytes mean black and white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Range {
    /// 16 is black, 235 white (most video).
    Limited = abi::range::LIMITED,
    /// 0 is black, 255 white (images).
    Full = abi::range::FULL,
}

/// A frame of the stream. Its pixels are the host's: copy what the next frame will need.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The picture.
    pub gray: Gray<'a>,
    /// Its colour; `None` where the clip has none, and from hosts of ABI 1.0.
    pub chroma: Option<Chroma<'a>>,
    /// Meaning of the bytes, if known.
    pub range: Option<Range>,
    /// Frame number in the clip.
    pub index: i64,
    /// Presentation time, seconds.
    pub time_s: f64,
}

impl<'a> Frame<'a> {
    /// A frame without colour.
    #[must_use]
    pub fn new(gray: Gray<'a>, index: i64, time_s: f64) -> Self {
        Self { gray, chroma: None, range: None, index, time_s }
    }

    /// Blue and red difference of a pixel; `None` without colour.
    ///
    /// # Panics
    /// When (x, y) lies outside the picture.
    #[must_use]
    #[track_caller]
    pub fn chroma_at(&self, x: u32, y: u32) -> Option<[u8; 2]> {
        let Gray { width, height, .. } = self.gray;
        assert!(x < width && y < height, "pixel ({x}, {y}) of {width}x{height}");
        let of =
            |pixel: u32, n: u32, samples: u32| (u64::from(pixel) * u64::from(samples) / u64::from(n)) as u32;
        self.chroma.map(|Chroma { cb, cr }| {
            let (i, j) = (of(x, width, cb.width) as usize, of(y, height, cb.height));
            [cb.row(j)[i], cr.row(j)[i]]
        })
    }
}

/// A point to follow. (0,0) is the centre of the top-left pixel, y points down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// The host's number for it.
    pub id: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
}

/// What is known of a point in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// The tracker has lost it; the position is its last guess.
    Lost = abi::status::LOST,
    /// Seen and followed.
    Tracked = abi::status::TRACKED,
    /// Hidden; the position is predicted.
    Occluded = abi::status::OCCLUDED,
    /// Has left the picture.
    Outside = abi::status::OUTSIDE,
    /// Judged wrong.
    Rejected = abi::status::REJECTED,
    /// Born in this frame by the tracker itself.
    Newborn = abi::status::NEWBORN,
}

impl TryFrom<u8> for Status {
    type Error = Error;

    fn try_from(number: u8) -> Result<Self> {
        use Status::{Lost, Newborn, Occluded, Outside, Rejected, Tracked};
        [Lost, Tracked, Occluded, Outside, Rejected, Newborn]
            .into_iter()
            .find(|status| *status as u8 == number)
            .ok_or_else(|| Error::data(format!("there is no status {number}")))
    }
}

/// A point in a frame, as the tracker reports it. Positions are finite, also of lost points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The seed's id, or one of [`Stream::births`].
    pub id: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// What is known of it.
    pub status: Status,
    /// Forward-backward error of the step that led here, pixels, if measured.
    pub fb: Option<f32>,
    /// Normalised cross-correlation with the template, -1..=1, if measured.
    pub ncc: Option<f32>,
}

impl Point {
    /// A point without quality.
    #[must_use]
    pub fn new(id: u32, x: f32, y: f32, status: Status) -> Self {
        Self { id, x, y, status, fb: None, ncc: None }
    }
}

/// The rows that a push hands back.
#[derive(Clone, Debug, Default)]
pub struct Points {
    rows: Vec<Point>,
    frames: Vec<i64>,
    now: i64,
}

impl Points {
    /// Makes it empty, for the frame with this index.
    pub fn restart(&mut self, index: i64) {
        self.rows.clear();
        self.frames.clear();
        self.now = index;
    }

    /// Adds a row of the frame being pushed.
    pub fn add(&mut self, point: Point) {
        self.add_at(self.now, point);
    }

    /// Adds a row of an earlier frame, at most [`Tracker::LATENCY`] frames back. All rows of a frame come in one push.
    pub fn add_at(&mut self, index: i64, point: Point) {
        self.rows.push(point);
        self.frames.push(index);
    }

    /// The rows so far.
    #[must_use]
    pub fn rows(&self) -> &[Point] {
        &self.rows
    }

    /// The frame of each row.
    #[must_use]
    pub fn frames(&self) -> &[i64] {
        &self.frames
    }
}

/// Where features are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Detect<'a> {
    /// The frame to look at.
    pub frame: Frame<'a>,
    /// At most so many.
    pub max_features: u32,
    /// Non-zero where features may be; `None`: everywhere.
    pub mask: Option<Gray<'a>>,
    /// Points that are there already: keep a distance from them.
    pub points: &'a [Seed],
    /// Threads that may work at a time, at least 1.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

/// A place worth following.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// How good it is; larger is better.
    pub score: f32,
}

/// Dense motion: displacements at the nodes of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Position of node (0,0), pixels.
    pub origin: [f32; 2],
    /// Distance between nodes, pixels.
    pub step: f32,
    /// Nodes in x.
    pub nx: u32,
    /// Nodes in y.
    pub ny: u32,
    /// Displacements right and down, pixels, `(ny, nx)` row-major; `None` where nothing could be measured.
    pub vectors: Vec<Option<[f32; 2]>>,
}

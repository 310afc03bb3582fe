//! Level 6: pictures that are as bad as a host may hand them over, and not a byte of memory beside them.

use crate::clip::{Clip, FPS, Texture, grid};
use crate::course::{at, difference, follow, is_at, of_tracker, refusal, row, tracker};
use crate::guarded::{Edge, Guarded};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, FrameView, HostError, Point, Points, StreamInfo};
use honami_model::picture::{Chroma, Gray};
use rand::RngExt;
use std::time::Duration;

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "frames.small",
        level: 6,
        claim: "it bears pictures of 1x1 pixels and other small ones, or refuses them with a reason",
        deadline: Duration::from_secs(30),
        run: |subject| of_tracker(subject, small),
    },
    Check {
        id: "frames.odd",
        level: 6,
        claim: "it bears black, white, noise, repeated frames and sudden changes",
        deadline: Duration::from_secs(30),
        run: |subject| of_tracker(subject, odd),
    },
    Check {
        id: "frames.long",
        level: 6,
        claim: "it bears pictures that are 4096 wide or 2304 high",
        deadline: Duration::from_secs(60),
        run: |subject| of_tracker(subject, long),
    },
    Check {
        id: "frames.many",
        level: 6,
        claim: "it works on for 120 frames",
        deadline: Duration::from_secs(60),
        run: |subject| of_tracker(subject, many),
    },
    Check {
        id: "frames.gaps",
        level: 6,
        claim: "it bears frames that are left out, and clips that run backward",
        deadline: Duration::from_secs(30),
        run: |subject| of_tracker(subject, gaps),
    },
    Check {
        id: "frames.stride",
        level: 6,
        claim: "what lies between the rows of a picture changes nothing",
        deadline: Duration::from_secs(30),
        run: |subject| of_tracker(subject, stride),
    },
    Check {
        id: "frames.bounds",
        level: 6,
        claim: "it reads nothing before or after a picture, and writes nothing into it",
        deadline: Duration::from_secs(30),
        run: |subject| of_tracker(subject, bounds),
    },
    Check {
        id: "frames.large",
        level: 10,
        claim: "it bears pictures of 4096x2304 pixels",
        deadline: Duration::from_secs(120),
        run: |subject| of_tracker(subject, large),
    },
];

/// A texture that moves.
fn moving(subject: &Subject, size: [u32; 2], n_frames: usize) -> Clip {
    let texture = Texture::new(&mut subject.chance("frames"));
    Clip::new(size, n_frames, |[x, y], t| 128.0 + texture.at([x - 1.3 * t as f64, y + 0.6 * t as f64]))
}

/// In the middle, in corners and outside.
fn places([width, height]: [u32; 2]) -> Vec<Point> {
    let [right, below] = [width, height].map(|n| n as f32 - 0.5);
    let places = [[0.5 * right, 0.5 * below], [-0.5, -0.5], [right, below], [0.0, below], [-40.0, 900.0]];
    places.into_iter().zip(1..).map(|([x, y], id)| Point { id, x, y }).collect()
}

fn small(subject: &Subject) -> Result<Verdict, Fault> {
    let mut refused = Vec::new();
    for size in [[1, 1], [2, 1], [1, 2], [7, 5], [5, 7], [3, 90], [90, 3], [17, 13]] {
        let name = format!("{}x{}", size[0], size[1]);
        match follow(&mut tracker(subject)?, &moving(subject, size, 4), &places(size)) {
            Ok(_) => {}
            Err(error) if refusal(&error).is_some() && size[0].min(size[1]) < 8 => refused.push(name),
            Err(error) => return Err(at(name)(error)),
        }
    }
    let refused = if refused.is_empty() { String::new() } else { format!("refuses {}", refused.join(", ")) };
    Ok(Verdict::Holds(refused))
}

fn odd(subject: &Subject) -> Result<Verdict, Fault> {
    type Make = fn([f64; 2], usize) -> f64;
    let formulas: [(&str, Make); 5] = [
        ("black", |_, _| 0.0),
        ("white", |_, _| 255.0),
        ("black, then white", |_, t| if t == 0 { 0.0 } else { 255.0 }),
        ("one edge", |[x, _], t| if x < 30.0 + t as f64 { 10.0 } else { 240.0 }),
        ("one bright pixel", |[x, y], _| if (x - 32.0).hypot(y - 24.0) < 0.5 { 255.0 } else { 0.0 }),
    ];
    let size = [64, 48];
    let mut clips: Vec<_> = formulas.iter().map(|(name, make)| (*name, Clip::new(size, 5, make))).collect();
    let mut chance = subject.chance("frames.odd");
    let mut noise = Clip::new(size, 5, |_, _| 0.0);
    noise.pictures.iter_mut().for_each(|picture| picture.luma.iter_mut().for_each(|v| *v = chance.random()));
    clips.push(("noise", noise));
    let mut again = moving(subject, size, 6);
    again.pictures[2] = again.pictures[1].clone();
    again.pictures[5] = again.pictures[4].clone();
    clips.push(("repeated frames", again));
    let grid = grid(size, 6.0, [5, 4], &mut chance);
    for (name, clip) in clips {
        follow(&mut tracker(subject)?, &clip, &grid).map_err(at(name))?;
        follow(&mut tracker(subject)?, &clip, &places(size))
            .map_err(at(format!("{name}, points on borders")))?;
        follow(&mut tracker(subject)?, &clip, &[]).map_err(at(format!("{name}, no points")))?;
    }
    Ok(Verdict::Holds(String::new()))
}

fn long(subject: &Subject) -> Result<Verdict, Fault> {
    sizes(subject, &[[4096, 40], [40, 2304]])
}

fn large(subject: &Subject) -> Result<Verdict, Fault> {
    sizes(subject, &[[4096, 2304]])
}

fn sizes(subject: &Subject, sizes: &[[u32; 2]]) -> Result<Verdict, Fault> {
    for &size in sizes {
        let seeds = grid(size, 15.0, [6, 2], &mut subject.chance("frames.sizes"));
        let clip = moving(subject, size, 2);
        let stream = StreamInfo { max_threads: 2, ..clip.stream() };
        let followed = crate::course::follow_in(&mut tracker(subject)?, &clip, &seeds, stream);
        followed.map_err(at(format!("{}x{}", size[0], size[1])))?;
    }
    Ok(Verdict::Holds(String::new()))
}

fn many(subject: &Subject) -> Result<Verdict, Fault> {
    let clip = moving(subject, [64, 48], 6);
    let seeds = grid([64, 48], 14.0, [4, 3], &mut subject.chance("frames.many"));
    let (mut tracker, cx) = (tracker(subject)?, CallContext::silent());
    tracker.begin(StreamInfo { n_frames: Some(120), ..clip.stream() }, &cx)?;
    tracker.seed(&seeds, &cx)?;
    for t in 0..120_usize {
        // To and fro through the pictures.
        let picture = 5 - (t % 10).abs_diff(5);
        let view = FrameView { index: t as i64, time_s: t as f64 / FPS, ..clip.view(picture) };
        tracker.push(&view, &cx).map_err(at(format!("frame {t}")))?;
    }
    tracker.end(&cx)?;
    Ok(Verdict::Holds(String::new()))
}

fn gaps(subject: &Subject) -> Result<Verdict, Fault> {
    let clip = moving(subject, [64, 48], 6);
    let seeds = grid([64, 48], 14.0, [4, 3], &mut subject.chance("frames.gaps"));
    let orders: [(&str, [i64; 6], bool); 4] = [
        ("from frame 1000 on", [1000, 1001, 1002, 1003, 1004, 1005], false),
        ("with frames left out", [0, 1, 5, 6, 40, 100_000], false),
        ("backward", [5, 4, 3, 2, 1, 0], true),
        ("backward with frames left out", [9000, 700, 699, 10, 9, 1], true),
    ];
    for (name, order, reversed) in orders {
        let all = in_order(subject, &clip, &seeds, &order, reversed).map_err(at(name))?;
        let frames: Vec<_> = all.iter().map(|points| points.frame).collect();
        if frames != order {
            return Err(Fault(format!("{name}: wanted points of frames {order:?}, got {frames:?}")));
        }
        let first = |seed: &&Point| row(&all[0], seed.id).is_none_or(|row| !is_at(row, seed));
        if let Some(seed) = seeds.iter().find(first) {
            return Err(Fault(format!(
                "{name}: point {} was seeded at ({}, {}) before the first frame, which does not have it there",
                seed.id, seed.x, seed.y
            )));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

/// Pushes the pictures of a clip under other numbers.
fn in_order(
    subject: &Subject,
    clip: &Clip,
    seeds: &[Point],
    order: &[i64],
    reversed: bool,
) -> Result<Vec<Points>, HostError> {
    let (mut tracker, cx) = (tracker(subject)?, CallContext::silent());
    tracker.begin(StreamInfo { reversed, n_frames: None, ..clip.stream() }, &cx)?;
    tracker.seed(seeds, &cx)?;
    let mut all = Vec::new();
    for (t, &index) in order.iter().enumerate() {
        all.extend(tracker.push(&FrameView { index, time_s: index as f64 / FPS, ..clip.view(t) }, &cx)?);
    }
    all.extend(tracker.end(&cx)?);
    Ok(all)
}

/// Follows points through pictures that lie in memory as `lay` says; it gives the bytes of a plane, its stride, and those
/// of the two planes of colour.
fn follow_laid(
    subject: &Subject,
    clip: &Clip,
    seeds: &[Point],
    lay: impl Fn(usize) -> Result<Laid, Fault>,
) -> Result<Vec<Points>, Fault> {
    let (mut tracker, cx) = (tracker(subject)?, CallContext::silent());
    tracker.begin(clip.stream(), &cx)?;
    tracker.seed(seeds, &cx)?;
    let mut all = Vec::new();
    for t in 0..clip.pictures.len() {
        let laid = lay(t)?;
        all.extend(tracker.push(&laid.view(clip, t), &cx)?);
    }
    all.extend(tracker.end(&cx)?);
    Ok(all)
}

/// Planes of a picture in memory of their own: luma, and colour at half size.
struct Laid {
    planes: [Guarded; 3],
    /// Bytes that lie between the end of a row and the next.
    gap: usize,
}

impl Laid {
    fn new(clip: &Clip, t: usize, gap: usize, edge: Edge) -> Result<Self, Fault> {
        let picture = &clip.pictures[t];
        let spread = |plane: &[u8], width: usize| {
            // What lies between rows differs from frame to frame, and ends with the last row.
            let mut bytes = Vec::new();
            for row in plane.chunks(width) {
                bytes.extend_from_slice(row);
                bytes.extend((0..gap).map(|k| (k * 31 + t * 97) as u8));
            }
            bytes.truncate(bytes.len() - gap);
            Guarded::new(&bytes, edge).map_err(|error| Fault(format!("no memory to guard: {error}")))
        };
        let (width, half) = (clip.width as usize, clip.width.div_ceil(2) as usize);
        let [cb, cr] = &picture.chroma;
        Ok(Self { planes: [spread(&picture.luma, width)?, spread(cb, half)?, spread(cr, half)?], gap })
    }

    fn view(&self, clip: &Clip, t: usize) -> FrameView<'_> {
        let plane = |k: usize, [width, height]: [u32; 2]| Gray {
            data: self.planes[k].bytes(),
            width,
            height,
            stride: width as usize + self.gap,
        };
        let (size, half) = ([clip.width, clip.height], [clip.width, clip.height].map(|n| n.div_ceil(2)));
        FrameView {
            gray: plane(0, size),
            chroma: Some(Chroma { cb: plane(1, half), cr: plane(2, half) }),
            range: None,
            index: t as i64,
            time_s: t as f64 / FPS,
        }
    }
}

/// A coloured clip of odd size: rows and planes begin at odd addresses.
fn coloured(subject: &Subject) -> Clip {
    let mut clip = moving(subject, [61, 47], 4);
    let half = [clip.width, clip.height].map(|n| n.div_ceil(2));
    for (t, picture) in clip.pictures.iter_mut().enumerate() {
        picture.chroma = [2.0, 3.0].map(|k| {
            crate::clip::plane(half, |[x, y]| 128.0 + 60.0 * ((x - 0.6 * t as f64) / k + y / 5.0).sin())
        });
    }
    clip
}

/// Points in the middle and on borders.
fn everywhere(subject: &Subject, clip: &Clip) -> Vec<Point> {
    let size = [clip.width, clip.height];
    let mut seeds = grid(size, 0.0, [5, 4], &mut subject.chance("frames.everywhere"));
    seeds.extend(places(size).into_iter().map(|point| Point { id: point.id + 100, ..point }));
    seeds
}

fn stride(subject: &Subject) -> Result<Verdict, Fault> {
    if !subject.info.caps.deterministic {
        return Ok(Verdict::Beside("its manifest says that its results differ".into()));
    }
    let clip = coloured(subject);
    let seeds = everywhere(subject, &clip);
    let packed = follow_laid(subject, &clip, &seeds, |t| Laid::new(&clip, t, 0, Edge::Back))?;
    for gap in [1, 3, 67] {
        let spread = follow_laid(subject, &clip, &seeds, |t| Laid::new(&clip, t, gap, Edge::Back))?;
        if let Some(what) = difference(&packed, &spread) {
            return Err(Fault(format!("packed, and with {gap} bytes between rows: {what}")));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

fn bounds(subject: &Subject) -> Result<Verdict, Fault> {
    if subject.info.is_program() {
        return Ok(Verdict::Beside("it is a program, which is given copies".into()));
    }
    let clip = coloured(subject);
    let seeds = everywhere(subject, &clip);
    for edge in [Edge::Back, Edge::Front] {
        follow_laid(subject, &clip, &seeds, |t| Laid::new(&clip, t, 0, edge))?;
        follow_laid(subject, &clip, &seeds, |t| Laid::new(&clip, t, 3, edge))?;
    }
    Ok(Verdict::Holds(String::new()))
}

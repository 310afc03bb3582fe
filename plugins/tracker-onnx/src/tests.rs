//! The plugin on nets that are made here: they really track, by matching a patch over the whole picture.

mod write;

use std::fs;
use std::path::Path;

use honami_plugin::{Chroma, Gray, testing};
use honami_vision::texture;
use tempfile::TempDir;

use super::*;
use crate::net::FrameShape;
use write::{Dim, Graph, Is, Open};

/// A net that is made for a test.
struct Toy {
    /// Width and height of what it sees, pixels.
    size: i64,
    /// Points at a time.
    points: Dim,
    /// Steps after which it calls every point hidden; only its state knows how many there were.
    life: f32,
}

impl Toy {
    const PATCH: i64 = 9;

    /// The mean of the colours.
    fn encoder(&self) -> Graph {
        Graph::default()
            .input("frame", &[Is(1), Is(3), Open("height"), Open("width")])
            .floats("third", &[1, 3, 1, 1], &[1.0 / 3.0; 3])
            .conv(&["frame", "third"], "features", 0)
            .output("features", &[Is(1), Is(1), Open("height"), Open("width")])
    }

    /// Patches around points, given as (y, x).
    fn query(&self) -> Graph {
        let reach = Self::PATCH / 2;
        let pixel = 2.0 / self.size as f32;
        let offsets: Vec<f32> = (-reach..=reach)
            .flat_map(|y| (-reach..=reach).flat_map(move |x| [x as f32 * pixel, y as f32 * pixel]))
            .collect();
        let n = Self::PATCH * Self::PATCH;
        Graph::default()
            .input("features", &[Is(1), Is(1), Is(self.size), Is(self.size)])
            .input("points", &[Is(1), self.points, Is(2)])
            .ints("xy", &[2], &[1, 0])
            .ints("apart", &[4], &[1, -1, 1, 2])
            .floats("pixel", &[1], &[pixel])
            .floats("corner", &[1], &[1.0])
            .floats("offsets", &[1, 1, n, 2], &offsets)
            .ints("patches", &[4], &[-1, 1, Self::PATCH, Self::PATCH])
            .node("Transpose", &["points"], "turned")
            .node("Gather", &["turned", "xy"], "rows")
            .node("Transpose", &["rows"], "places")
            .node("Reshape", &["places", "apart"], "centres")
            .node("Mul", &["centres", "pixel"], "scaled")
            .node("Sub", &["scaled", "corner"], "middle")
            .node("Add", &["middle", "offsets"], "grid")
            .node("GridSample", &["features", "grid"], "samples")
            .node("Reshape", &["samples", "patches"], "templates")
            .output("templates", &[self.points, Is(1), Is(Self::PATCH), Is(Self::PATCH)])
    }

    /// Where the squared difference to the patch is least, softly; hidden where it is large everywhere.
    fn step(&self) -> Graph {
        let centres = |y: i64, x: i64| [x as f32 + 0.5, y as f32 + 0.5];
        let size = self.size;
        let coordinates: Vec<f32> =
            (0..size).flat_map(|y| (0..size).flat_map(move |x| centres(y, x))).collect();
        let border = Self::PATCH / 2;
        let patch = (Self::PATCH * Self::PATCH) as usize;
        Graph::default()
            .input("features", &[Is(1), Is(1), Is(size), Is(size)])
            .input("templates", &[self.points, Is(1), Is(Self::PATCH), Is(Self::PATCH)])
            .input("age", &[self.points, Is(1)])
            .floats("ones", &[1, 1, Self::PATCH, Self::PATCH], &vec![1.0; patch])
            .floats("two", &[1], &[2.0])
            .floats("sharp", &[1], &[-20.0])
            .floats("limit", &[1], &[0.2])
            .floats("gain", &[1], &[10.0])
            .floats("year", &[1], &[1.0])
            .floats("life", &[1], &[self.life])
            .floats("sure", &[1], &[10.0])
            .floats("nothing", &[1], &[0.0])
            .ints("inner", &[3], &[1, 2, 3])
            .ints("last", &[1], &[2])
            .ints("a point", &[4], &[1, -1, 1, 1])
            .ints("flat", &[3], &[1, -1, size * size])
            .ints("list", &[2], &[1, -1])
            .ints("track", &[4], &[1, -1, 1, 2])
            .floats("coordinates", &[size * size, 2], &coordinates)
            .conv(&["features", "templates"], "product", border)
            .node("Mul", &["features", "features"], "squares")
            .conv(&["squares", "ones"], "power", border)
            .node("Mul", &["templates", "templates"], "template squares")
            .node("ReduceSum", &["template squares", "inner"], "template power")
            .node("Reshape", &["template power", "a point"], "own power")
            .node("Mul", &["product", "two"], "both")
            .node("Sub", &["power", "both"], "less")
            .node("Add", &["less", "own power"], "difference")
            .node("Reshape", &["difference", "flat"], "differences")
            .node("Mul", &["differences", "sharp"], "scores")
            .node("Softmax", &["scores"], "share")
            .node("MatMul", &["share", "coordinates"], "position")
            .node("Reshape", &["position", "track"], "tracks")
            .node("Mul", &["share", "differences"], "weighed")
            .node("ReduceSum", &["weighed", "last"], "mean difference")
            .node("Reshape", &["mean difference", "list"], "unlikeness")
            .node("Sub", &["unlikeness", "limit"], "excess")
            .node("Sub", &["age", "life"], "beyond")
            .node("Relu", &["beyond"], "overdue")
            .node("Reshape", &["overdue", "list"], "overdue list")
            .node("Add", &["excess", "overdue list"], "doubt")
            .node("Mul", &["doubt", "gain"], "occlusion")
            .node("Mul", &["occlusion", "nothing"], "zero")
            .node("Sub", &["zero", "sure"], "expected_dist")
            .node("Add", &["age", "year"], "new age")
            .output("tracks", &[Is(1), self.points, Is(1), Is(2)])
            .output("occlusion", &[Is(1), self.points])
            .output("expected_dist", &[Is(1), self.points])
            .output("new age", &[self.points, Is(1)])
    }

    fn save(&self, folder: &Path) {
        for (name, graph) in [("encoder", self.encoder()), ("query", self.query()), ("step", self.step())] {
            fs::write(folder.join(format!("{name}.onnx")), graph.file(name)).unwrap();
        }
    }
}

const TOY: Toy = Toy { size: 64, points: Open("n"), life: 1e6 };

/// A net in a folder of its own, and the parameters that name it.
fn net(toy: &Toy) -> (TempDir, Settings) {
    let folder = TempDir::new().unwrap();
    toy.save(folder.path());
    let settings = Settings { graphs: folder.path().into(), size: toy.size, ..Settings::default() };
    (folder, settings)
}

const WIDTH: u32 = 128;
const HEIGHT: u32 = 96;

/// Frames of a texture that drifts; `hidden` is covered by gray around (70, 50).
fn clip(n: usize, hidden: std::ops::Range<usize>) -> Vec<Vec<u8>> {
    let frame = |t: usize| {
        texture::render(WIDTH, HEIGHT, |x, y| {
            let covers = hidden.contains(&t) && (x - 70.0).hypot(y - 50.0) < 30.0;
            if covers { 250.0 } else { texture::value(8, x - 1.6 * t as f64, y + 0.9 * t as f64) }
        })
    };
    (0..n).map(frame).collect()
}

fn run(settings: &Settings, seeds: &[Seed], clip: &[Vec<u8>]) -> Vec<Vec<Point>> {
    let frames = clip.iter().zip(0..);
    let frames = frames.map(|(data, t)| Frame::new(Gray::packed(data, WIDTH, HEIGHT), t, t as f64 / 25.0));
    testing::track::<Onnx>(settings, &testing::stream(WIDTH, HEIGHT), seeds, frames).unwrap()
}

fn seeds(n: u32) -> Vec<Seed> {
    (0..n).map(|id| Seed { id, x: 50.0 + 4.7 * id as f32, y: 60.0 - 3.1 * id as f32 }).collect()
}

/// Distance from where the seed has gone, pixels of the clip.
fn error(row: &Point, t: usize) -> f32 {
    let seed = seeds(20)[row.id as usize];
    (row.x - seed.x - 1.6 * t as f32).hypot(row.y - seed.y + 0.9 * t as f32)
}

#[test]
fn hard_input_is_borne() {
    let (_folder, settings) = net(&Toy { size: 16, ..TOY });
    testing::suite::<Onnx>(&Settings { batch: 4096, ..settings });
}

#[test]
fn points_are_followed_hidden_and_found_again() {
    let (_folder, settings) = net(&TOY);
    let rows = run(&settings, &seeds(7), &clip(10, 4..6));
    for (t, rows) in rows[..10].iter().enumerate() {
        let is_hidden = (4..6).contains(&t);
        let expected = if is_hidden { Status::Occluded } else { Status::Tracked };
        for row in rows.iter().filter(|_| !is_hidden) {
            let error = error(row, t);
            assert!(row.status == Status::Tracked && error < 1.0, "frame {t}: {row:?} is off by {error}");
        }
        // This one is behind the middle of what hides.
        assert_eq!(rows[4].status, expected, "frame {t}");
    }
}

#[test]
fn fewer_points_than_a_graph_wants_are_filled_up() {
    let clip = clip(5, 0..0);
    let (_open, open) = net(&TOY);
    let (_fixed, fixed) = net(&Toy { points: Is(3), ..TOY });
    let [open, fixed] = [open, fixed].map(|settings| run(&settings, &seeds(7), &clip));
    for (a, b) in open.iter().flatten().zip(fixed.iter().flatten()) {
        assert!(a.id == b.id && (a.x - b.x).hypot(a.y - b.y) < 1e-3 && a.status == b.status, "{a:?} {b:?}");
    }
}

#[test]
fn the_state_that_comes_out_goes_in_again() {
    let (_folder, settings) = net(&Toy { life: 3.0, ..TOY });
    let rows = run(&settings, &seeds(2), &clip(8, 0..0));
    for (t, rows) in rows[..8].iter().enumerate() {
        let expected = if t < 4 { Status::Tracked } else { Status::Occluded };
        assert!(rows.iter().all(|row| row.status == expected), "frame {t}: {rows:?}");
    }
}

#[test]
fn a_net_that_does_not_fit_is_refused_with_what_was_wanted() {
    let wide = Toy { size: 32, ..TOY };
    let features = [Is(1), Is(1), Open("height"), Open("width")];
    let no_points = || {
        Graph::default()
            .input("features", &features)
            .node("Relu", &["features"], "other")
            .output("other", &features)
    };
    // A file, what it becomes (`None`: it goes), and words of the complaint.
    type Case<'a> = (&'a str, Option<Vec<u8>>, &'a [&'a str]);
    let cases: [Case<'_>; 7] = [
        ("step.onnx", None, &["there is no", "step.onnx", "folder"]),
        ("query.onnx", Some(b"no graph".to_vec()), &["query.onnx", "cannot be used"]),
        (
            "encoder.onnx",
            Some(TOY.step().file("e")),
            &["encoder.onnx", "its one input must be a frame", "templates [n, 1, 9, 9]"],
        ),
        ("query.onnx", Some(no_points().file("q")), &["query.onnx", "the points, [1, n, 2]"]),
        ("query.onnx", Some(wide.query().file("q")), &[]),
        ("step.onnx", Some(no_points().file("s")), &["step.onnx", "tracks"]),
        (
            "step.onnx",
            Some(TOY.step().input("more", &[Is(1)]).file("s")),
            &["unexplained", "[age, more]", "[new age]"],
        ),
    ];
    for (name, file, words) in cases {
        let (folder, settings) = net(&TOY);
        let path = folder.path().join(name);
        match file {
            Some(file) => fs::write(path, file).unwrap(),
            None => fs::remove_file(path).unwrap(),
        }
        let begun = Onnx::begin(&settings, &testing::stream(WIDTH, HEIGHT), &testing::cx());
        // Shapes that are open in one graph show only when a frame comes.
        if words.is_empty() {
            let mut tracker = begun.unwrap();
            tracker.seed(&seeds(2), &testing::cx()).unwrap();
            let clip = clip(2, 0..0);
            let push = |t: usize, tracker: &mut Onnx| {
                let frame = Frame::new(Gray::packed(&clip[t], WIDTH, HEIGHT), t as i64, 0.0);
                tracker.push(&frame, &mut Points::default(), &testing::cx())
            };
            let error = push(0, &mut tracker).and_then(|()| push(1, &mut tracker)).unwrap_err().to_string();
            assert!(error.contains("query.onnx failed"), "{error}");
            continue;
        }
        let Err(error) = begun else { panic!("{name} {words:?} is taken") };
        let error = error.to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?}: {error}");
    }
    let error = Onnx::begin(&Settings::default(), &testing::stream(8, 8), &testing::cx()).err().unwrap();
    assert!(error.to_string().contains("give `graphs` the folder"), "{error}");
}

#[test]
fn a_frame_is_seen_in_colour_from_minus_one_to_one() {
    let shape = FrameShape { dims: vec![1, 2, 2, 3], is_planar: false, width: 2, height: 2 };
    // Pure red in BT.601, of limited range.
    let luma = [81; 16];
    let (cb, cr) = ([90_u8; 2], [240_u8; 2]);
    let [cb, cr] = [&cb, &cr].map(|plane| Gray::packed(plane, 1, 2));
    let mut frame = Frame::new(Gray::packed(&luma, 4, 4), 0, 0.0);
    let gray = picture::tensor(&frame, &shape);
    assert!(gray.chunks(3).all(|c| (c[0] - c[1]).abs() < 1e-6 && (c[1] - c[2]).abs() < 1e-6), "{gray:?}");
    frame.chroma = Some(Chroma { cb, cr });
    frame.range = Some(honami_plugin::Range::Limited);
    let planar = FrameShape { dims: vec![1, 3, 2, 2], is_planar: true, ..shape.clone() };
    for colour in picture::tensor(&frame, &shape).chunks(3) {
        assert!(
            colour.iter().zip([1.0, -1.0, -1.0]).all(|(c, wanted)| (c - wanted).abs() < 0.02),
            "{colour:?}"
        );
    }
    let planes = picture::tensor(&frame, &planar);
    assert!(planes[..4].iter().all(|c| *c > 0.98) && planes[4..].iter().all(|c| *c < -0.98), "{planes:?}");
}

#[test]
fn positions_keep_their_place_at_any_size() {
    let shape = FrameShape { dims: vec![1, 3, 64, 64], is_planar: true, width: 64, height: 64 };
    let scale = Scale::new((128, 96), &shape);
    for (clip, net) in
        [([-0.5, -0.5], [0.0, 0.0]), ([127.5, 95.5], [64.0, 64.0]), ([63.5, 47.5], [32.0, 32.0])]
    {
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-4;
        assert!(near(scale.to_net(clip), net) && near(scale.to_clip(net), clip), "{clip:?} {net:?}");
    }
}

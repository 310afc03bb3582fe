//! Movies of a made-up project, read back; and what is drawn of every kind of sample.

use std::sync::Arc;

use honami_media::OpenOptions;
use honami_model::track::{Quality, Sample, Source, Span, Status};
use honami_scene::palette::{self, KEY};

use super::*;
use crate::tried;

fn request(show: &[Layer]) -> MovieRequest {
    MovieRequest {
        show: (!show.is_empty()).then(|| show.iter().copied().collect()),
        frames: (0, None),
        size: MovieSize::Scale(1.0),
        fps: None,
        trail_s: TRAIL_S,
        tracks: None,
        groups: None,
        structure: "diener".to_owned(),
    }
}

fn read(path: &Path) -> honami_media::Media {
    honami_media::open(path, &OpenOptions { cache_bytes: Some(0), ..OpenOptions::default() }).unwrap()
}

fn apart(a: [u8; 3], b: [u8; 3]) -> i32 {
    (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).pow(2)).sum::<i32>().isqrt()
}

#[test]
fn marks_that_are_read_back_have_the_colours_of_their_groups() {
    let (folder, session) = tried::grouped();
    for name in ["m.y4m", "images", "m.mp4"] {
        let out = folder.path().join(name);
        let movie = match write(&session, &out, &request(&[Layer::Tracks]), &()) {
            Ok(movie) => movie,
            Err(error) => {
                let line = error.to_string();
                assert!(line.contains("unlike .y4m or a folder of images, needs ffmpeg"), "{name}: {line}");
                continue;
            }
        };
        assert_eq!((movie.n_frames, movie.size, movie.n_tracks, movie.n_groups), (6, [64, 48], 2, 2));
        assert!(movie.bytes > 1000 && movie.notes.is_empty(), "{movie:?}");
        let media = read(&out);
        assert_eq!(media.clip().n_frames(), 6, "{name}");
        for frame in 0..6 {
            let picture = media.frame(frame).unwrap();
            for (group, at) in [(0, (10, 10)), (1, (50, 30))] {
                let got = picture.planes().rgb(at.0, at.1);
                let nearest = (0..12).min_by_key(|k| apart(got, palette::group(Some(*k))));
                assert_eq!(nearest, Some(group), "{name} {frame}: {got:?}");
                let most = if name == "m.mp4" { 80 } else { 5 };
                assert!(apart(got, palette::group(Some(group))) <= most, "{name} {frame}: {got:?}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let of = |n_threads: usize| {
        let (folder, session) = tried::grouped();
        let out = folder.path().join("m.y4m");
        let show = Layer::ALL.into_iter().filter(|layer| *layer != Layer::Skeleton).collect::<Vec<_>>();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let path = out.clone();
        pool.install(move || write(&session, &path, &request(&show), &())).unwrap();
        std::fs::read(out).unwrap()
    };
    assert_eq!(of(1), of(4));
}

#[test]
fn what_cannot_be_made_is_told_and_leaves_nothing_behind() {
    struct Stops;
    impl Progress for Stops {
        fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
            Flow::Stop
        }
    }
    let (folder, session) = tried::grouped();
    let names = || {
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(name).collect();
        names.sort();
        names
    };
    let before = names();
    let tracks = || request(&[Layer::Tracks]);
    let nobody = |show: &[Layer]| MovieRequest { structure: "nobody".to_owned(), ..request(show) };
    let cases: [(&str, MovieRequest, &str); 6] = [
        ("m.avi", tracks(), "movies are written as .mp4, .y4m or a folder of PNG images, not .avi"),
        ("m.y4m", MovieRequest { frames: (2, Some(9)), ..tracks() }, "frames 2..9 were asked for"),
        ("m.y4m", MovieRequest { size: MovieSize::Scale(0.2), ..tracks() }, "not 12 x 9"),
        ("m.y4m", MovieRequest { size: MovieSize::Scale(f64::NAN), ..tracks() }, "16 to 8192 pixels"),
        ("m.y4m", MovieRequest { groups: Some([7].into()), ..tracks() }, "none of the tracks"),
        ("m.y4m", nobody(&[Layer::Skeleton]), "nobody"),
    ];
    for (name, request, want) in cases {
        let error = write(&session, &folder.path().join(name), &request, &()).unwrap_err().to_string();
        assert!(error.contains(want), "{error}");
        assert_eq!(names(), before, "{error}");
    }
    let stopped = write(&session, &folder.path().join("m.y4m"), &tracks(), &Stops);
    assert!(matches!(stopped, Err(WorkbenchError::Stopped)));
    assert_eq!(names(), before);
    // A skeleton that nobody asked for may be missing.
    let movie = write(&session, &folder.path().join("m.y4m"), &nobody(&[]), &()).unwrap();
    assert_eq!(movie.shown, BTreeSet::from([Layer::Trails, Layer::Tracks]));
    assert!(movie.notes[0].starts_with("no skeleton is drawn: "), "{:?}", movie.notes);
}

const GREY: [u8; 3] = [128; 3];

fn sample(x: f32, status: Status, source: Source) -> Sample {
    Sample { x, y: 20.0, status, source, quality: Quality::default() }
}

/// A frame over grey with these tracks of group 0, the last of three frames.
fn drawn_over_grey(show: &[Layer], tracks: Vec<Vec<Sample>>) -> impl Fn(usize, usize) -> [u8; 3] {
    let shown = |samples| draw::Shown { group: Some(0), span: Arc::new(Span { first_frame: 0, samples }) };
    let drawn = Drawn {
        show: show.iter().copied().collect(),
        tracks: tracks.into_iter().map(shown).collect(),
        names: BTreeMap::from([(0, "1".to_owned())]),
        growth: None,
        skeleton: None,
        notes: Vec::new(),
    };
    let lens = Lens::of([100, 40], MovieSize::Scale(1.0)).unwrap();
    let times = FrameTimes::constant(3, 25.0).unwrap();
    let canvas = Drawing::new(&times, &lens, &drawn, &(0..3), (0.08, 1.0)).draw(vec![GREY; 4000], 2);
    move |x, y| canvas.pixels()[y * 100 + x]
}

#[test]
fn what_was_measured_is_filled_and_what_was_not_is_hollow_or_crossed_out() {
    let colour = palette::group(Some(0));
    let all = [
        (10.0, Status::Tracked, Source::Tracked),
        (20.0, Status::Newborn, Source::Tracked),
        (30.0, Status::Tracked, Source::Key),
        (40.0, Status::Occluded, Source::Tracked),
        (50.0, Status::Tracked, Source::Interpolated),
        (60.0, Status::Lost, Source::Tracked),
        (70.0, Status::Outside, Source::Tracked),
        (80.0, Status::Rejected, Source::Tracked),
    ];
    let tracks = all.map(|(x, status, source)| vec![sample(x, status, source); 3]).to_vec();
    let pixel = drawn_over_grey(&[Layer::Tracks], tracks);
    for x in [10, 20, 30] {
        assert_eq!(pixel(x, 20), colour, "{x}");
        assert_eq!(pixel(x - 1, 20), colour, "{x}");
    }
    let is_key =
        |x| (3..6).any(|off| apart(pixel(x + off, 20), KEY) < 60 && apart(pixel(x, 20 + off), KEY) < 60);
    assert!(is_key(30) && !is_key(10), "a ring about the key-frame alone");
    for x in [40, 50] {
        assert_eq!(pixel(x, 20), GREY, "hollow");
        assert!((1..4).any(|off| apart(pixel(x + off, 20), colour) < 110), "a ring at {x}");
    }
    assert!(apart(pixel(60, 20), palette::UNSEEN) < 10 && pixel(62, 20) == GREY, "crossed out");
    for x in [70, 80] {
        assert!((0..4).all(|off| pixel(x + off, 20) == GREY), "{x}");
    }
}

#[test]
fn trails_are_where_a_track_was_seen_and_fade() {
    let (seen, hidden) = (Status::Tracked, Status::Occluded);
    let moved = |status: [Status; 3]| {
        let samples = [20.0, 30.0, 40.0].into_iter().zip(status);
        vec![samples.map(|(x, status)| sample(x, status, Source::Tracked)).collect()]
    };
    let colour = palette::group(Some(0));
    let pixel = drawn_over_grey(&[Layer::Trails], moved([seen; 3]));
    let far = [22, 30, 38].map(|x| apart(pixel(x, 20), colour));
    assert!(far[0] > far[1] && far[1] > far[2] && far[2] < 40, "{far:?}");
    let pixel = drawn_over_grey(&[Layer::Trails], moved([seen, hidden, seen]));
    assert!((21..40).all(|x| pixel(x, 20) == GREY), "nobody knows how it went");
}

#[test]
fn groups_have_their_ellipse_and_labels_their_place() {
    let tracks = [[30.0, 0.0], [70.0, 0.0], [50.0, 8.0], [50.0, -8.0]];
    let tracks =
        tracks.map(|[x, y]| vec![Sample { y: 20.0 + y, ..sample(x, Status::Tracked, Source::Tracked) }; 3]);
    let colour = palette::group(Some(0));
    let pixel = drawn_over_grey(&[Layer::Groups], tracks.to_vec());
    // Deviations of 20 and 8 px, twice each of four: 2.4477 times the root of 2/3 of them.
    let half = 2.447_746_8 * (2.0_f64 / 3.0).sqrt() * 20.0;
    assert!(apart(pixel((50.0 - half).round() as usize, 20), colour) < 40, "its edge");
    let inside = pixel(50, 20);
    assert!(inside != GREY && apart(inside, GREY) < 40, "a tint within: {inside:?}");
    let pixel = drawn_over_grey(&[Layer::Labels], tracks.to_vec());
    let is_there = |rows: std::ops::Range<usize>| {
        rows.into_iter().any(|y| (44..57).any(|x| apart(pixel(x, y), colour) < 20))
    };
    assert!(is_there(13..27) && !is_there(30..40), "in the middle of its group");
}

#[test]
fn motion_has_the_colour_of_where_it_goes_and_a_wheel() {
    let right: Vec<Sample> = [20.0, 22.0, 24.0].map(|x| sample(x, Status::Tracked, Source::Tracked)).to_vec();
    let pixel = drawn_over_grey(&[Layer::Motion], vec![right.clone()]);
    let [r, g, b] = pixel(24, 20);
    assert!(r > 200 && g < 60 && b < 60, "right is red: {r} {g} {b}");
    let reds = (50..100).flat_map(|x| (0..40).map(move |y| (x, y)));
    let most = reds.clone().filter(|(x, y)| apart(pixel(*x, *y), [255, 0, 0]) < 60).count();
    assert!(most > 5, "the wheel's right is red, too");
    let pixel = drawn_over_grey(&[Layer::Arrows], vec![right]);
    assert!(apart(pixel(25, 20), palette::group(Some(0))) < 30, "an arrow to the right");
    assert_eq!(pixel(20, 20), GREY);
}

#[test]
fn clips_of_uneven_rate_become_movies_of_even_rate() {
    let even = FrameTimes::constant(10, 25.0).unwrap();
    let plan = Plan::of(&even, 3..7, 25.0).unwrap();
    assert_eq!((plan.frames, plan.note), (vec![3, 4, 5, 6], None));
    // Frames at 0, 1, 2, 2.1, 2.2, 5 and 6 tenths: the usual rate is 10.
    let times = FrameTimes::new([0.0, 1.0, 2.0, 2.1, 2.2, 5.0, 6.0, 7.0].map(|t| t / 10.0).to_vec()).unwrap();
    let plan = Plan::of(&times, 0..8, times.nominal_fps().unwrap()).unwrap();
    assert_eq!(plan.frames, [0, 1, 2, 4, 5, 5, 6, 7]);
    let note = plan.note.unwrap();
    assert!(note.contains("1 of 8 left out, 1 shown again, each within 100 ms"), "{note}");
    // One stray time.
    let stray = FrameTimes::new([0.0, 0.04, 0.08, 1e9, 1e9 + 0.04].to_vec()).unwrap();
    let error = Plan::of(&stray, 0..5, 25.0).err().unwrap();
    let told = error.to_string();
    assert!(
        told.contains("2.5e10 frames, since frame 3 of the clip is 1.0e9 s after the one before it"),
        "{told}"
    );
    // On one side of it there is a movie.
    assert_eq!(Plan::of(&stray, 0..3, 25.0).unwrap().frames, [0, 1, 2]);
    assert_eq!(Plan::of(&stray, 3..5, 25.0).unwrap().frames, [3, 4]);
}

#[test]
fn places_of_the_clip_are_where_the_picture_shows_them() {
    let doubled = Lens::of([100, 50], MovieSize::Scale(2.0)).unwrap();
    assert_eq!(
        (doubled.size, doubled.at([0.0, 0.0]), doubled.at([99.0, 49.0])),
        ([200, 100], [0.5, 0.5], [198.5, 98.5])
    );
    // A square movie of a wide clip: as wide as it can be, in the middle.
    let square = Lens::of([100, 50], MovieSize::Pixels([200, 200])).unwrap();
    assert_eq!((square.at([0.0, 0.0]), square.at([99.0, 49.0])), ([0.5, 50.5], [198.5, 148.5]));
    assert!((square.unit - doubled.unit).abs() < 1e-12, "strokes are as wide as the picture asks for");
    let large = Lens::of([1920, 1080], MovieSize::Scale(1.0)).unwrap();
    assert!((large.unit - 2.25).abs() < 1e-12);
    // Sides that are no whole numbers: nothing beside the clip is seen.
    let odd = Lens::of([101, 51], MovieSize::Scale(0.5)).unwrap();
    assert_eq!((odd.size, odd.area.width, odd.area.height), ([50, 25], 100.0, 50.0));
}

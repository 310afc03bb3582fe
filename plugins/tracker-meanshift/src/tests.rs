//! The plugin against a coloured disc that is known, and against all that a host may hand it.

use honami_plugin::{Chroma, Gray, testing};
use honami_vision::texture;

use super::*;

const WIDTH: u32 = 120;
const HEIGHT: u32 = 90;

/// Noise in green and gray, and a red disc of 8 px; luma, then both chroma planes.
fn picture_of(disc: Option<[f64; 2]>, grain: u64) -> [Vec<u8>; 3] {
    let colour = |channel: usize, x: f64, y: f64| {
        let inside = disc.is_some_and(|[cx, cy]| (x - cx).hypot(y - cy) < 8.0);
        let noise = texture::hash(grain, x.floor() as i64, y.floor() as i64);
        let (base, spread) = match (channel, inside) {
            (0, _) => (120.0, 12.0),
            (1, _) => (110.0, 2.0),
            (_, true) => (170.0, 2.0),
            (_, false) => (118.0, 2.0),
        };
        base + spread * noise
    };
    let half =
        |c| texture::render(WIDTH / 2, HEIGHT / 2, move |x, y| colour(c, 2.0 * x + 0.5, 2.0 * y + 0.5));
    [texture::render(WIDTH, HEIGHT, |x, y| colour(0, x, y)), half(1), half(2)]
}

fn frame([y, cb, cr]: &[Vec<u8>; 3], t: usize) -> Frame<'_> {
    let plane = |data| Gray::packed(data, WIDTH / 2, HEIGHT / 2);
    let chroma = Some(Chroma { cb: plane(cb), cr: plane(cr) });
    Frame { chroma, ..Frame::new(Gray::packed(y, WIDTH, HEIGHT), t as i64, t as f64 / 25.0) }
}

/// A region as large as the disc.
fn settings() -> Settings {
    Settings { region: 8.0, ..Settings::default() }
}

fn seed(id: u32, x: f32, y: f32) -> Seed {
    Seed { id, x, y }
}

fn run(settings: &Settings, seeds: &[Seed], clip: &[[Vec<u8>; 3]]) -> Vec<Vec<Point>> {
    let frames = clip.iter().enumerate().map(|(t, picture)| frame(picture, t));
    testing::track::<MeanShift>(settings, &testing::stream(WIDTH, HEIGHT), seeds, frames).unwrap()
}

#[test]
fn it_bears_what_every_tracker_must() {
    testing::suite::<MeanShift>(&Settings::default());
    testing::suite::<MeanShift>(&Settings { adapt: true, region: 3.0, iterations: 3, ..Settings::default() });
}

#[test]
fn a_disc_is_followed_lost_when_it_is_hidden_and_found_again() {
    let truth = |t: usize| [30.0 + 1.5 * t as f64, 40.0 + 3.0 * (0.6 * t as f64).sin()];
    // Hidden for two frames, in which it goes on.
    let hidden = |t: usize| (6..8).contains(&t);
    let clip: Vec<_> = (0..14).map(|t| picture_of((!hidden(t)).then(|| truth(t)), t as u64)).collect();
    let rows = run(&settings(), &[seed(4, 30.0, 40.0)], &clip);
    for (t, rows) in rows.iter().enumerate().take(clip.len()) {
        let [row] = rows[..] else { panic!("one row, not {rows:?}") };
        if hidden(t) {
            assert_eq!((row.status, row.fb), (Status::Lost, None), "frame {t}");
            continue;
        }
        let [x, y] = truth(t).map(|c| c as f32);
        let off = (row.x - x).hypot(row.y - y);
        assert!(row.status == Status::Tracked && off < 1.0, "frame {t}: off by {off} px, {row:?}");
        assert!(t == 0 || t == 8 || row.fb.is_some_and(|fb| fb < 1.0), "frame {t}: {row:?}");
        assert_eq!(row.ncc, None, "likeness of colours is no correlation");
    }
}

#[test]
fn a_disc_that_leaves_the_picture_is_outside() {
    let clip: Vec<_> = (0..12).map(|t| picture_of(Some([85.0 + 5.0 * t as f64, 45.0]), t)).collect();
    let rows = run(&settings(), &[seed(0, 85.0, 45.0)], &clip);
    assert_eq!(rows[3][0].status, Status::Tracked);
    assert_eq!(rows[11][0].status, Status::Outside, "{:?}", rows[11]);
}

#[test]
fn a_correction_takes_the_colours_of_its_own_frame() {
    let clip: Vec<_> = (0..6).map(|t| picture_of(Some([60.0 + t as f64, 45.0]), t)).collect();
    let mut tracker = MeanShift::begin(&settings(), &testing::stream(WIDTH, HEIGHT), &testing::cx()).unwrap();
    tracker.seed(&[seed(1, 20.0, 20.0)], &testing::cx()).unwrap();
    let mut out = Points::default();
    for (t, picture) in clip.iter().enumerate() {
        out.restart(t as i64);
        tracker.push(&frame(picture, t), &mut out, &testing::cx()).unwrap();
        if t == 2 {
            tracker.seed(&[seed(1, 62.0, 45.0)], &testing::cx()).unwrap();
        }
    }
    let row = out.rows()[0];
    assert!((row.x - 65.0).hypot(row.y - 45.0) < 1.0, "{row:?}");
}

#[test]
fn without_chroma_it_works_on_luma() {
    let bright = |cx: f64| {
        texture::render(WIDTH, HEIGHT, |x, y| {
            let noise = 12.0 * texture::hash(2, x as i64, y as i64);
            noise + if (x - cx).hypot(y - 45.0) < 8.0 { 200.0 } else { 80.0 }
        })
    };
    let data: Vec<_> = (0..5).map(|t| bright(50.0 + 3.0 * f64::from(t))).collect();
    let frames =
        data.iter().zip(0..).map(|(luma, t)| Frame::new(Gray::packed(luma, WIDTH, HEIGHT), t, t as f64));
    let seeds = [seed(0, 50.0, 45.0)];
    let rows = testing::track::<MeanShift>(&settings(), &testing::stream(WIDTH, HEIGHT), &seeds, frames);
    let row = rows.unwrap()[4][0];
    assert!((row.x - 62.0).hypot(row.y - 45.0) < 1.0 && row.status == Status::Tracked, "{row:?}");
}

//! The plugin as a host drives it, on pictures whose motion is known.

use honami_follow::Losing;
use honami_plugin::{Point, Seed, Status, testing};
use honami_vision::texture;

use super::*;

/// Motion from each frame to the next, pixels: of the ground, and of what passes over it.
const GROUND: [f64; 2] = [0.8, 0.5];
const PASSING: [f64; 2] = [-2.4, 0.3];

/// Over a texture that drifts; right of x = 100, below y = 80, another one passes.
fn track(settings: &Settings, seeds: &[Seed], n_frames: usize) -> Vec<Vec<Point>> {
    let clip = testing::Clip::new(200, 150, n_frames, |x, y, t| {
        let (seed, by) = if x > 100.0 && y > 80.0 { (7, PASSING) } else { (2, GROUND) };
        texture::value(seed, x - by[0] * t as f64, y - by[1] * t as f64)
    });
    clip.track::<Robust>(settings, seeds).unwrap()
}

#[test]
fn it_bears_whatever_a_host_hands_it() {
    testing::suite::<Robust>(&Settings { backward: true, lose_share: 0.1, ..Settings::default() });
}

/// A fifth of the region is passed over at first, a third at the end: that pulls the mean by up to a pixel a frame.
#[test]
fn what_passes_over_a_region_does_not_carry_it_away() {
    let seeds = [Seed { id: 4, x: 60.0, y: 60.0 }, Seed { id: 9, x: 130.0, y: 72.5 }];
    let rows = track(&Settings { region: 14, step: 3, backward: true, ..Settings::default() }, &seeds, 7);
    for (t, rows) in rows.iter().enumerate() {
        assert_eq!(rows.iter().map(|r| r.id).collect::<Vec<_>>(), [4, 9], "frame {t}");
        for (row, seed) in rows.iter().zip(&seeds) {
            let error = testing::off_px(row, seed, GROUND, t);
            assert!(error < 0.4 && row.status == Status::Tracked, "frame {t}: {row:?}, {error} px off");
            // Quality belongs to a step: the first frame has none.
            assert_eq!((row.fb.is_some(), row.ncc.is_some()), (t > 0, t > 0));
            assert!(row.fb.is_none_or(|fb| fb < 0.2), "frame {t}: {row:?}");
        }
    }
}

#[test]
fn limits_lose_points_where_they_were_seen_last() {
    let seeds = [Seed { id: 0, x: 60.0, y: 60.0 }, Seed { id: 1, x: 130.0, y: 74.0 }];
    let status = |settings: Settings| {
        let last = track(&settings, &seeds, 2).swap_remove(1);
        assert!(
            last.iter()
                .zip(&seeds)
                .all(|(row, s)| row.status != Status::Lost || (row.x, row.y) == (s.x, s.y))
        );
        [last[0].status, last[1].status]
    };
    let (tracked, lost) = (Status::Tracked, Status::Lost);
    let plain = Settings::default();
    assert_eq!(status(plain.clone()), [tracked, tracked]);
    assert_eq!(
        status(Settings { lose_share: 0.75, ..plain.clone() }),
        [tracked, lost],
        "a third of it goes another way"
    );
    assert_eq!(
        status(Settings { losing: Losing { lose_ncc: 0.985, ..plain.losing.clone() }, ..plain.clone() }),
        [tracked, lost]
    );
    assert_eq!(
        status(Settings { losing: Losing { lose_fb: 1e-6, ..plain.losing.clone() }, ..plain }),
        [lost, lost]
    );
}

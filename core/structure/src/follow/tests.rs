//! Against the mean where all is seen, and against a known motion where it is not.

use super::*;

fn path(at: impl Iterator<Item = Option<[f64; 2]>>) -> Path {
    Path { track: TrackId(0), at: at.collect() }
}

fn motion(frame: usize) -> [f64; 2] {
    let t = frame as f64;
    [100.0 + 7.0 * (0.9 * t).sin(), 50.0 + 3.0 * (0.4 * t).cos()]
}

fn beside(frame: usize, place: [f64; 2]) -> [f64; 2] {
    let [x, y] = motion(frame);
    [x + place[0], y + place[1]]
}

#[test]
fn where_all_are_seen_the_centre_is_their_mean() {
    let paths: Vec<Path> = (0..5)
        .map(|k| path((0..20).map(|t| Some([(k * t) as f64 % 7.0, (k + t * t) as f64 % 11.0]))))
        .collect();
    let refs: Vec<&Path> = paths.iter().collect();
    let followed = follow(&refs).unwrap();
    for t in 0..20 {
        let mean = mean(paths.iter().map(|path| path.at[t].unwrap())).unwrap();
        assert_eq!(followed.centre[t].map(f64::to_bits), mean.map(f64::to_bits));
    }
}

#[test]
fn the_centre_does_not_jump_when_a_track_begins_or_ends() {
    // When each of three tracks is seen: with others for long, for one frame in a thousand, and never.
    type Seen = fn(usize) -> bool;
    let cases: [(usize, [Seen; 3], f64); 3] = [
        (60, [|t| t < 30, |t| (10..50).contains(&t) && t != 33, |t| t >= 25], 1e-9),
        (1000, [|t| t <= 400, |t| (400..=700).contains(&t), |t| t >= 700], 1e-6),
        // What moves while one goes and another comes cannot be told from where they are.
        (90, [|t| t < 30, |t| (30..60).contains(&t), |t| t >= 60], 2.0 * 7.0 * 0.9),
    ];
    let places = [[-40.0, 0.0], [0.0, 20.0], [90.0, -5.0]];
    for (n_frames, seen, allowed) in cases {
        let path_of = |k: usize| path((0..n_frames).map(|t| seen[k](t).then(|| beside(t, places[k]))));
        let paths: Vec<Path> = (0..3).map(path_of).collect();
        let refs: Vec<&Path> = paths.iter().collect();
        let followed = follow(&refs).unwrap();
        // The centre is the motion and one shift for all frames.
        let shift = [followed.centre[0][0] - motion(0)[0], followed.centre[0][1] - motion(0)[1]];
        for t in 0..n_frames {
            let wanted = beside(t, shift);
            let error = (followed.centre[t][0] - wanted[0]).hypot(followed.centre[t][1] - wanted[1]);
            assert!(error < allowed, "{n_frames} frames, {t}: {error}");
            for (k, place) in places.iter().enumerate() {
                let ([x, y], [wx, wy]) = (followed.at(k, &paths[k], t), beside(t, *place));
                assert!((x - wx).hypot(y - wy) < allowed, "{n_frames} frames: track {k}, {t}");
            }
        }
        let beside: Vec<[f64; 2]> =
            (0..3).flat_map(|k| paths[k].seen().map(move |(_, _)| k)).map(|k| followed.places[k]).collect();
        let mean = mean(beside.into_iter()).unwrap();
        assert!(
            mean[0].hypot(mean[1]) < 1e-6,
            "in the mean over all that is seen it is the centre: {mean:?}"
        );
    }
}

#[test]
fn where_nothing_is_seen_the_centre_goes_straight_on() {
    let at = |t: usize| match t {
        2 => Some([10.0, 0.0]),
        6 => Some([30.0, 8.0]),
        _ => None,
    };
    let only = path((0..8).map(at));
    let followed = follow(&[&only]).unwrap();
    let wanted = [
        [10.0, 0.0],
        [10.0, 0.0],
        [10.0, 0.0],
        [15.0, 2.0],
        [20.0, 4.0],
        [25.0, 6.0],
        [30.0, 8.0],
        [30.0, 8.0],
    ];
    for (t, wanted) in wanted.into_iter().enumerate() {
        let found = followed.at(0, &path((0..8).map(|_| None)), t);
        assert!((found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-9, "frame {t}: {found:?}");
    }
}

#[test]
fn what_is_never_seen_is_not_followed() {
    assert_eq!(follow(&[]), None);
    assert_eq!(follow(&[&path((0..4).map(|_| None))]), None);
    let (never, seen) = (path((0..2).map(|_| None)), path((0..2).map(|_| Some([1.0, 2.0]))));
    let followed = follow(&[&never, &seen]).unwrap();
    assert_eq!((followed.centre[1], followed.places[0]), ([1.0, 2.0], [0.0, 0.0]));
}

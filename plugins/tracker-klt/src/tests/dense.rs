//! Dense motion on pictures that turn, drift and hide: known everywhere.

use super::*;

/// Radians from one frame to the next, about the middle of the picture.
const TURN: f64 = 0.03;

fn field(from: Frame<'_>, to: Frame<'_>, max_threads: u32) -> honami_plugin::Field {
    klt_field(&Settings::default().klt(), &from, &to, max_threads, &testing::cx()).unwrap()
}

/// Where each node lies, and its displacement.
fn nodes(field: &honami_plugin::Field) -> impl Iterator<Item = ([f64; 2], Option<[f64; 2]>)> {
    (0..field.nx * field.ny).map(|i| {
        let place = [i % field.nx, i / field.nx].map(|n| n as f32 * field.step);
        let at = [0, 1].map(|axis| f64::from(field.origin[axis] + place[axis]));
        (at, field.vectors[i as usize].map(|moved| moved.map(f64::from)))
    })
}

#[test]
fn a_turn_is_measured_at_every_node_that_stays_in_the_picture() {
    let clip = turning(2, TURN);
    let field = field(clip.frame(0), clip.frame(1), 2);
    assert_eq!((field.nx, field.ny, field.step), (24, 18, 10.0));
    let (sin, cos) = TURN.sin_cos();
    let mut errors = Vec::new();
    let mut n_unknown = 0;
    for ([x, y], moved) in nodes(&field) {
        let (dx, dy) = (x - MIDDLE[0], y - MIDDLE[1]);
        let truth = [(cos - 1.0) * dx - sin * dy, sin * dx + (cos - 1.0) * dy];
        match moved {
            None => n_unknown += 1,
            Some([u, v]) => errors.push((u - truth[0]).hypot(v - truth[1])),
        }
    }
    errors.sort_by(f64::total_cmp);
    let (median, high) = (errors[errors.len() / 2], errors[errors.len() * 95 / 100]);
    // A window moves as the middle of its texture does, which in a turn is a few pixels off its own.
    assert!(median < 0.1 && high < 0.3, "median {median} px, 95 % below {high} px");
    assert!(n_unknown < 24, "{n_unknown} of 432 nodes are not known");
}

#[test]
fn what_drifts_hides_and_shows_no_texture() {
    let clip = clip(4);
    let (mut n, mut n_good) = (0, 0);
    for (at, moved) in nodes(&field(clip.frame(1), clip.frame(2), 1)) {
        let is_inside = (20.0..220.0).contains(&at[0]) && (20.0..160.0).contains(&at[1]);
        let error = moved.map_or(f64::INFINITY, |[u, v]| (u - STEP[0]).hypot(v - STEP[1]));
        n += usize::from(is_inside);
        n_good += usize::from(is_inside && error < 0.1);
    }
    assert_eq!(n_good, n, "nodes away from the edges");
    // The disc appears in frame 3: where what it hides has gone nobody knows, nor where all is gray.
    let hidden = nodes(&field(clip.frame(2), clip.frame(3), 1))
        .find(|(at, _)| (at[0] - 60.0).hypot(at[1] - 60.0) < 8.0);
    assert_eq!(hidden.unwrap().1, None);
    let gray = Clip::new(WIDTH, HEIGHT, 2, |_, _, _| 128.0);
    assert!(nodes(&field(gray.frame(0), gray.frame(1), 1)).all(|(_, moved)| moved.is_none()));
}

#[test]
fn time_turned_round_turns_the_motion_and_threads_change_nothing() {
    let clip = clip(3);
    let there = field(clip.frame(1), clip.frame(2), 1);
    assert_eq!(there, field(clip.frame(1), clip.frame(2), 5));
    let back = field(clip.frame(2), clip.frame(1), 1);
    let middle = (9 * back.nx + 12) as usize;
    let [[there, _], [back, _]] = [there, back].map(|field| field.vectors[middle].unwrap());
    assert!((there + back).abs() < 0.05 && back < -1.5, "{there} and {back}");
}

#[test]
fn a_picture_smaller_than_a_window_has_one_node() {
    let frame = Frame::new(Gray::packed(&[7; 6], 3, 2), 0, 0.0);
    let field = klt_field(&Settings::default().klt(), &frame, &frame, 1, &testing::cx()).unwrap();
    assert_eq!((field.nx, field.ny, field.origin, field.vectors), (1, 1, [1.0, 0.5], vec![None]));
}

//! Boards that were drawn, and those of OpenCV's pictures.

mod drawn;

use super::*;
use drawn::{Drawn, found};

/// Root mean square and greatest distance, pixels.
fn off(found: &[[f64; 2]], truth: &[[f64; 2]]) -> [f64; 2] {
    let far: Vec<f64> = found.iter().zip(truth).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).collect();
    let rms = (far.iter().map(|far| far * far).sum::<f64>() / far.len() as f64).sqrt();
    [rms, far.into_iter().fold(0.0, f64::max)]
}

#[test]
fn corners_are_found_to_a_fraction_of_a_pixel() {
    let plain = Drawn::default();
    let board = |columns, rows| Board { columns, rows };
    for (name, drawn, bound) in [
        ("plain", plain, 0.045),
        ("without noise", Drawn { noise: 0.0, ..plain }, 0.045),
        ("tilted by 45", Drawn { turns_deg: [5.0, 45.0, 10.0], ..plain }, 0.06),
        ("tilted by 60", Drawn { turns_deg: [3.0, 60.0, 4.0], ..plain }, 0.08),
        ("tilted the other way", Drawn { turns_deg: [-58.0, 10.0, 20.0], ..plain }, 0.06),
        ("rolled by 40", Drawn { turns_deg: [10.0, 5.0, 40.0], ..plain }, 0.045),
        ("rolled by 95", Drawn { turns_deg: [10.0, 5.0, 95.0], ..plain }, 0.045),
        ("upside down", Drawn { turns_deg: [10.0, 5.0, 180.0], ..plain }, 0.045),
        ("a barrel", Drawn { lens: -0.25, square_px: 50.0, ..plain }, 0.06),
        ("small squares", Drawn { square_px: 11.0, aside_px: [180.0, -140.0], ..plain }, 0.08),
        ("large squares", Drawn { square_px: 115.0, size: [1280, 960], ..plain }, 0.045),
        ("blurred", Drawn { blur_px: 3.0, ..plain }, 0.06),
        ("very blurred", Drawn { blur_px: 6.0, noise: 0.5, ..plain }, 0.2),
        ("noisy", Drawn { noise: 15.0, ..plain }, 0.15),
        ("dim", Drawn { dark: 40.0, bright: 60.0, noise: 1.0, ..plain }, 0.1),
        ("faint and bright", Drawn { dark: 200.0, bright: 225.0, noise: 1.0, ..plain }, 0.1),
        ("4 by 3", Drawn { board: board(4, 3), square_px: 70.0, ..plain }, 0.045),
        ("6 by 9", Drawn { board: board(6, 9), ..plain }, 0.045),
        (
            "a corner hidden outside of the corners",
            Drawn { before: Some([0.0, 0.0, 118.0, 95.0]), ..plain },
            0.045,
        ),
    ] {
        let corners = found(&drawn, 1).unwrap_or_else(|error| panic!("{name}: {error}"));
        let [rms, most] = off(&corners, &drawn.corners());
        assert!(rms < bound && most < 4.0 * bound, "{name}: {rms:.3} px, {most:.3} at most");
    }
}

#[test]
fn boards_that_look_the_same_from_both_ends_begin_so_that_rows_lead_right() {
    for (columns, rows) in [(6, 6), (7, 7), (8, 6), (7, 5)] {
        for roll in [-170.0, -100.0, -60.0, -20.0, 20.0, 80.0, 130.0, 175.0] {
            let board = Board { columns, rows };
            let drawn = Drawn { board, turns_deg: [10.0, -5.0, roll], ..Drawn::default() };
            let corners = found(&drawn, 2).unwrap();
            let along = [0, 1].map(|axis| corners[columns - 1][axis] - corners[0][axis]);
            // Of an even square all four corners are dark.
            let most = if (columns, rows) == (6, 6) { 0.65 } else { -0.05 };
            assert!(along[0] >= most * along[0].hypot(along[1]), "{columns} by {rows} at {roll}: {along:?}");
            // They are those of the board, in another order.
            let truth = drawn.corners();
            let near = |a: &[f64; 2]| truth.iter().any(|b| (a[0] - b[0]).hypot(a[1] - b[1]) < 0.15);
            assert!(corners.iter().all(near));
        }
    }
}

#[test]
fn what_is_not_there_whole_is_not_found() {
    let plain = Drawn::default();
    let not_found = |drawn: &Drawn| match found(drawn, 3) {
        Err(BoardError::NotFound { came, .. }) => came,
        other => panic!("{drawn:?}: {other:?}"),
    };
    // A hand over three columns, one finger over a corner, and a board that is half outside.
    assert!((20..54).contains(&not_found(&Drawn { before: Some([380.0, 0.0, 640.0, 480.0]), ..plain })));
    let [x, y] = plain.corners()[22];
    let finger = Drawn { before: Some([x - 22.0, y - 22.0, x + 22.0, y + 22.0]), ..plain };
    assert_eq!(not_found(&finger), 53);
    not_found(&Drawn { aside_px: [220.0, 0.0], ..plain });
    not_found(&Drawn { turns_deg: [0.0, 84.0, 0.0], ..plain });
    let error = found(&finger, 3).unwrap_err().to_string();
    assert!(error.contains("9 by 6") && error.contains("53 corners, 9 by 6"), "{error}");
}

#[test]
fn other_boards_and_none_are_named() {
    let plain = Drawn::default();
    let picture = plain.picture(4);
    let gray = Gray::packed(&picture, 640, 480);
    let wanted = |columns, rows| find(&gray, Board { columns, rows }, Window::Squares);
    assert_eq!(wanted(8, 6), Err(BoardError::Other { columns: 8, rows: 6, wide: 9, high: 6 }));
    assert_eq!(wanted(5, 4), Err(BoardError::Other { columns: 5, rows: 4, wide: 9, high: 6 }));
    assert!(matches!(wanted(11, 6), Err(BoardError::NotFound { came: 54, wide: 9, high: 6, .. })));
    assert_eq!(wanted(1, 6), Err(BoardError::Board { columns: 1, rows: 6 }));
    let small = Gray::packed(&picture[..19 * 30], 30, 19);
    let error = find(&small, plain.board, Window::Squares);
    assert_eq!(error, Err(BoardError::Picture { width: 30, height: 19 }));
    let noise = Drawn { dark: 128.0, bright: 128.0, noise: 40.0, ..plain }.picture(5);
    for nothing in [vec![77; 640 * 480], noise, drawn::leaves()] {
        let found = find(&Gray::packed(&nothing, 640, 480), plain.board, Window::Squares);
        assert!(matches!(found, Err(BoardError::NotFound { came: 0..30, .. })), "{found:?}");
    }
}

#[test]
fn a_window_that_reaches_beyond_its_square_is_drawn_off_as_opencv_is() {
    let drawn = Drawn { square_px: 26.0, turns_deg: [0.0, 62.0, 0.0], noise: 0.0, ..Drawn::default() };
    let picture = drawn.picture(6);
    let gray = Gray::packed(&picture, 640, 480);
    let rms = |window| off(&find(&gray, drawn.board, window).unwrap(), &drawn.corners())[0];
    let [squares, small, large] = [Window::Squares, Window::Radius(3), Window::Radius(11)].map(rms);
    assert!(squares < 0.1 && small < 0.15 && large > 0.3, "{squares} {small} {large}");
}

#[test]
fn opencvs_pictures_show_all_their_boards() {
    let Some(root) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA (calib/opencv)");
        return;
    };
    let folder = std::path::Path::new(&root).join("calib/opencv");
    for number in (1..10).chain(11..15) {
        let [left, right] = ["left", "right"].map(|side| {
            let picture = image::open(folder.join(format!("{side}{number:02}.jpg"))).unwrap().to_luma8();
            let gray = Gray::packed(picture.as_raw(), picture.width(), picture.height());
            find(&gray, Board { columns: 9, rows: 6 }, Window::Squares)
                .unwrap_or_else(|e| panic!("{side}{number}: {e}"))
        });
        // Both cameras agree which corner is the first: their axes are parallel, and what the right one sees lies farther left.
        for (l, r) in left.iter().zip(&right) {
            assert!(
                (l[1] - r[1]).abs() < 40.0 && (60.0..260.0).contains(&(l[0] - r[0])),
                "{number}: {l:?} {r:?}"
            );
        }
    }
}

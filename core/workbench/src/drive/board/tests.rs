//! Which points another tracker is given.

use honami_host::PointRow;

use super::*;

/// Three points that a tracker follows through four frames; the second is hidden, the third lost in the last.
fn answers() -> Vec<Points> {
    let row = |frame: i64, id: u32| {
        let status = match (id, frame) {
            (2, 3) => Status::Occluded,
            (3, 3) => Status::Lost,
            _ => Status::Tracked,
        };
        PointRow { id, x: frame as f32, y: id as f32, status, fb: None, ncc: None }
    };
    let answer =
        |frame| Points { frame, rows: [1, 2, 3].map(|id| row(frame, id)).to_vec(), ended: Vec::new() };
    (0..4).map(answer).collect()
}

#[test]
fn hidden_points_are_followed_on_where_they_are_taken_to_be() {
    let at = |id: u32| Point { id, x: 3.0, y: id as f32 };
    let mut board = Board::new(0);
    board.take(answers());
    let told = |board: &Board| (board.seen().collect::<Vec<_>>(), board.live().collect::<Vec<_>>());
    assert_eq!(told(&board), (vec![at(1)], vec![at(1), at(2)]));
    board.flush(&mut |_, _| Ok(())).unwrap();
    // Of a frame that was not handed over another tracker knows nothing.
    board.take(vec![Points { frame: 4, ..Points::default() }]);
    assert_eq!(told(&board), (vec![], vec![]));
    assert_eq!(board.back(), (4, Some(3)));
    assert_eq!(told(&board), (vec![at(1)], vec![at(1), at(2)]));
    board.lose(4);
    let mut lost = Vec::new();
    let mut sink = |frame, rows: &Rows| {
        lost.extend(rows.iter().map(|(track, sample)| (frame, track.0, sample.status)));
        Ok(())
    };
    board.flush(&mut sink).unwrap();
    assert_eq!(lost, [(4, 1, Status::Lost), (4, 2, Status::Lost)]);
    assert_eq!(board.back(), (5, Some(3)));
    assert_eq!(told(&board), (vec![at(1)], vec![at(1), at(2)]));
}

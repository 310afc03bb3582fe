//! What strokes mark, counted by hand.

use super::*;

fn count(painting: &Painting) -> [usize; 2] {
    [Mark::Foreground, Mark::Background]
        .map(|mark| painting.marks.marks.iter().filter(|of| **of == mark).count())
}

#[test]
fn a_stroke_marks_what_its_brush_passes() {
    let mut painting = Painting::new(0, [10.0, 10.0], [40, 30]);
    assert_eq!(painting.radius_px, 1);
    painting.begin([10.0, 10.0]);
    assert_eq!(count(&painting), [9, 0], "pixels no farther than 1.5 px");
    painting.lead([20.0, 10.0], true);
    assert_eq!(count(&painting), [9 + 30, 0]);
    painting.next_brush();
    painting.widen(-1);
    painting.begin([15.0, 10.0]);
    assert_eq!(count(&painting), [38, 1], "a later stroke lies over an earlier one");
    painting.next_brush();
    painting.begin([15.0, 10.0]);
    assert_eq!((painting.word(), count(&painting)), ("eraser", [38, 0]));
    // A stroke that leaves the picture marks what is in it.
    painting.next_brush();
    painting.begin([39.0, 0.0]);
    painting.lead([60.0, -20.0], true);
    assert_eq!(count(&painting), [39, 0]);

    let n_changes = painting.marks.n_changes;
    for wanted in [[38, 0], [38, 1], [39, 0], [0, 0]] {
        assert!(painting.take_back());
        assert_eq!(count(&painting), wanted);
    }
    assert!(!painting.take_back());
    assert!(painting.marks.n_changes > n_changes, "what is seen is drawn anew");
}

#[test]
fn a_pen_paints_only_while_it_is_down() {
    let mut painting = Painting::new(0, [5.0, 5.0], [40, 30]);
    painting.widen(-9);
    painting.lead([10.0, 5.0], painting.is_down);
    assert_eq!(count(&painting), [0, 0]);
    painting.set_pen(true);
    painting.lead([14.0, 5.0], painting.is_down);
    assert_eq!(count(&painting), [5, 0]);
    // Another brush is put down where it is wanted; the stroke before stays as it is.
    painting.next_brush();
    painting.lead([14.0, 9.0], painting.is_down);
    assert_eq!(count(&painting), [5, 0]);
    painting.set_pen(true);
    painting.lead([14.0, 5.0], painting.is_down);
    assert_eq!(count(&painting), [4, 5]);
    painting.set_pen(false);
    painting.lead([30.0, 9.0], painting.is_down);
    assert_eq!(count(&painting), [4, 5]);
    assert_eq!(painting.strokes.len(), 2);
}

#[test]
fn what_was_kept_is_gone_on_from() {
    let parts = || Arc::new(Parts { width: 4, height: 3, parts: vec![Part::Kept; 12] });
    let marks = || Arc::new([[Mark::Background; 4], [Mark::Unknown; 4], [Mark::Foreground; 4]].concat());
    let mut painting = Painting::new(0, [0.0, 0.0], [4, 3]);
    painting.go_on_from(marks(), parts());
    assert_eq!((count(&painting), painting.can_keep()), ([4, 4], false));
    assert_eq!(painting.part_at([3.2, 2.0]), Some(Part::Kept));
    assert_eq!(painting.part_at([4.0, 2.0]), None);
    assert_eq!(painting.marks.seen([0.0, 1.0], [3.0, 1.0]), None);
    assert_eq!(painting.marks.seen([0.0, 1.0], [3.0, 2.0]), Some(Mark::Foreground));
    painting.widen(-1);
    painting.begin([0.0, 1.0]);
    painting.found = Some((Some(1), parts()));
    assert!(painting.can_keep());
    painting.begin([1.0, 1.0]);
    assert!(!painting.can_keep(), "one more stroke");
    painting.take_back();
    painting.take_back();
    assert_eq!(count(&painting), [4, 4], "taking back ends at what was kept");

    let mut painting = Painting::new(0, [0.0, 0.0], [4, 3]);
    painting.begin([3.0, 0.0]);
    painting.go_on_from(marks(), parts());
    assert!(painting.found.is_none(), "what came late does not paint over strokes");
}

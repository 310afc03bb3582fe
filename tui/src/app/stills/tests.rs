//! When a still is due, and what it covers.

use super::*;
use crate::term::signals::Signals;

const AREA: Rect = Rect { x: 2, y: 1, width: 6, height: 4 };

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// A frame with a picture in the area.
fn frame(scene: u64) -> Frame {
    let mut frame = Frame::new(10, 8);
    for at in AREA.positions() {
        let i = frame.cells.index_of(at.x, at.y);
        frame.softness[i] = 1;
    }
    Frame { scene, ..frame }
}

fn picture() -> Option<Pixmap> {
    Some(Pixmap { width: 24, height: 32, pixels: vec![[9, 99, 200]; 24 * 32] })
}

/// Waits for what the thread makes.
fn made(stills: &mut Stills) -> Option<Still> {
    let wish = stills.ordered;
    while stills.is_busy {
        if let Some(still) = stills.take() {
            assert_eq!(stills.ordered, wish);
            return Some(still);
        }
        std::thread::yield_now();
    }
    None
}

#[test]
fn a_picture_that_stays_gets_one_still() {
    let signals = Signals::catch().unwrap();
    let mut stills = Stills::new(signals.waker()).unwrap();
    let wish = |scene| wish(&frame(scene), AREA, Pixels::Kitty);
    stills.see(wish(1), false, ms(1000));
    assert_eq!((stills.due(), stills.wish(ms(1249))), (Some(ms(1250)), None));
    // It changes, and then stays.
    stills.see(wish(2), false, ms(1100));
    assert_eq!((stills.due(), stills.wish(ms(1300))), (Some(ms(1350)), None));
    stills.see(wish(2), false, ms(1360));
    let wanted = stills.wish(ms(1360)).unwrap();
    assert_eq!((wanted.scene, wanted.area), (2, AREA));
    stills.order(wanted, picture(), 1e6, 0);
    assert_eq!(stills.due(), None);
    assert_eq!(made(&mut stills).unwrap().area, AREA);
    // It is there: nothing is due. Once it is gone, it is due again.
    stills.see(wish(2), true, ms(1400));
    assert_eq!(stills.due(), None);
    stills.see(wish(2), false, ms(1500));
    assert!(stills.wish(ms(1700)).is_some());
}

#[test]
fn what_comes_too_late_or_is_too_large_is_not_shown() {
    let signals = Signals::catch().unwrap();
    let mut stills = Stills::new(signals.waker()).unwrap();
    let wish = |scene| wish(&frame(scene), AREA, Pixels::Kitty);
    stills.see(wish(1), false, ms(0));
    let wanted = stills.wish(ms(300)).unwrap();
    stills.order(wanted, picture(), 1e6, 0);
    stills.see(wish(2), false, ms(310));
    assert_eq!(made(&mut stills), None);
    // A link that carries nothing in time.
    let wanted = stills.wish(ms(600)).unwrap();
    stills.order(wanted, picture(), 20.0, 0);
    assert_eq!(made(&mut stills), None);
    assert_eq!(stills.due(), None, "the same picture is not tried twice");
}

#[test]
fn what_lies_on_the_picture_stays_free() {
    let mut frame = frame(1);
    assert_eq!(wish(&frame, AREA, Pixels::Kitty).map(|wish| wish.area), Some(AREA));
    let i = frame.cells.index_of(4, 3);
    frame.softness[i] = 0;
    assert_eq!(wish(&frame, AREA, Pixels::Kitty).map(|wish| wish.area.height), Some(2));
    let i = frame.cells.index_of(4, 2);
    frame.softness[i] = 0;
    assert_eq!(wish(&frame, AREA, Pixels::Kitty), None);
    assert_eq!(wish(&frame, Rect { width: 60, ..AREA }, Pixels::Kitty), None);
}

#[test]
fn no_more_pixels_than_there_are() {
    let sixel = Pixels::Sixel { cell_px: (9, 19) };
    for (pixels, cell_px, image_px, expect) in [
        (Pixels::Kitty, Some((10, 20)), (6.4, 12.8), (7, 13)),
        (Pixels::Kitty, Some((10, 20)), (30.0, 60.0), (10, 20)),
        (Pixels::Kitty, Some((10, 20)), (0.5, 1.0), (4, 8)),
        (Pixels::Kitty, None, (30.0, 60.0), (8, 16)),
        (sixel, None, (1.0, 1.0), (9, 19)),
    ] {
        assert_eq!(grid(pixels, cell_px, image_px), expect);
    }
}

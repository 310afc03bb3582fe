//! Stills of pictures that stay: when one is due, and a thread that makes it.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use ratatui::layout::Rect;

use crate::term::capabilities::Pixels;
use crate::term::encode::Frame;
use crate::term::signals::Waker;
use crate::term::still::{self, Pixmap, Room, Still};

/// A picture that has not changed for so long stays.
const STAYS: Duration = Duration::from_millis(250);
/// A still is there within this, seconds.
const WITHIN_S: f64 = 0.5;
/// Bytes of a still, at most.
const MOST: usize = 2 << 20;
/// Pixels of a cell where the terminal does not say.
const CELL_PX: (u16, u16) = (8, 16);
/// Fewest pixels of a cell: tracks are drawn in them.
const LEAST_PX: (u32, u32) = (4, 8);
/// Rows that are worth a still.
const LEAST_ROWS: u16 = 2;

/// What a still is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wish {
    pub(super) scene: u64,
    pub(super) area: Rect,
    pub(super) pixels: Pixels,
}

/// A wish, and what is needed to fulfil it.
struct Order {
    wish: Wish,
    picture: Pixmap,
    room: Room,
}

/// Stills of one clip.
pub(super) struct Stills {
    orders: SyncSender<Order>,
    made: Receiver<(Wish, Option<Still>)>,
    /// What the screen asks for, and since when it has been the same.
    wanted: Option<(Wish, Duration)>,
    /// What was last ordered; it is not ordered twice.
    ordered: Option<Wish>,
    is_busy: bool,
    /// What was ordered was given to the screen.
    is_given: bool,
}

impl Stills {
    pub(super) fn new(waker: Waker) -> std::io::Result<Self> {
        let (orders, inbox) = sync_channel::<Order>(1);
        let (outbox, made) = sync_channel(1);
        // It ends when its orders do.
        std::thread::Builder::new().name("stills".to_owned()).spawn(move || {
            for Order { wish, picture, room } in inbox {
                let still = still::make(wish.pixels, wish.area, &picture, room);
                if outbox.send((wish, still)).is_err() {
                    break;
                }
                waker.wake();
            }
        })?;
        Ok(Self { orders, made, wanted: None, ordered: None, is_busy: false, is_given: false })
    }

    /// Takes notice of what the screen asks for, if for anything, and whether the last still is there.
    pub(super) fn see(&mut self, wish: Option<Wish>, is_there: bool, now: Duration) {
        if self.is_given && !is_there {
            (self.ordered, self.is_given) = (None, false);
        }
        self.wanted = wish.map(|wish| match self.wanted {
            Some((same, since)) if same == wish => (wish, since),
            _ => (wish, now),
        });
    }

    /// When an order is due, if it is as yet.
    pub(super) fn due(&self) -> Option<Duration> {
        let (wish, since) = self.wanted?;
        (!self.is_busy && self.ordered != Some(wish)).then_some(since + STAYS)
    }

    /// What is to be ordered now.
    pub(super) fn wish(&self, now: Duration) -> Option<Wish> {
        self.due().filter(|due| *due <= now)?;
        self.wanted.map(|(wish, _)| wish)
    }

    /// Orders a still that so many bytes per second carry in time, with so many bytes on their way at once; without
    /// a picture there is none.
    pub(super) fn order(&mut self, wish: Wish, picture: Option<Pixmap>, goodput: f64, at_once: usize) {
        (self.ordered, self.is_given) = (Some(wish), false);
        let room = Room { in_all: ((goodput * WITHIN_S) as usize).min(MOST), at_once };
        let order = picture.map(|picture| Order { wish, picture, room });
        self.is_busy = order.is_some_and(|order| self.orders.try_send(order).is_ok());
    }

    /// A still that is made, if it is still wanted.
    pub(super) fn take(&mut self) -> Option<Still> {
        let (wish, still) = self.made.try_recv().ok()?;
        self.is_busy = false;
        let is_wanted = self.ordered == Some(wish) && self.wanted.is_some_and(|(wanted, _)| wanted == wish);
        let still = still.filter(|_| is_wanted);
        self.is_given = still.is_some();
        if !is_wanted {
            self.ordered = None;
        }
        still
    }
}

/// What a frame asks for: a still over the rows above whatever else lies on the picture in `area`.
pub(super) fn wish(frame: &Frame, area: Rect, pixels: Pixels) -> Option<Wish> {
    if area.intersection(frame.cells.area) != area {
        return None;
    }
    let is_picture =
        |row: &u16| (area.left()..area.right()).all(|x| frame.softness[frame.cells.index_of(x, *row)] > 0);
    let n_rows = (area.top()..area.bottom()).take_while(is_picture).count();
    let area = Rect { height: u16::try_from(n_rows).unwrap_or(0), ..area };
    (area.height >= LEAST_ROWS && area.width > 0).then_some(Wish { scene: frame.scene, area, pixels })
}

/// Pixels of a cell that a still has: as many as the terminal shows, but no more than the image has.
///
/// `image_px` is how many image pixels a cell covers, across and down.
pub(super) fn grid(pixels: Pixels, cell_px: Option<(u16, u16)>, image_px: (f64, f64)) -> (u32, u32) {
    if let Pixels::Sixel { cell_px: (width, height) } = pixels {
        return (width.into(), height.into());
    }
    let (width, height) = cell_px.unwrap_or(CELL_PX);
    let side =
        |image: f64, cell: u16, least: u32| (image.ceil() as u32).max(least).min(u32::from(cell).max(1));
    (side(image_px.0, width, LEAST_PX.0), side(image_px.1, height, LEAST_PX.1))
}

#[cfg(test)]
mod tests;

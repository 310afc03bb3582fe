//! Pictures for the screen: at once where the frame is decoded, from a thread where it is not.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use honami_workbench::media::{FrameRef, Media, MediaError, Rect};

use super::layout::Lens;
use super::view::Shot;
use crate::term::signals::Waker;

/// While the clip is being decoded, a wished frame is looked for this often.
const LOOK: Duration = Duration::from_millis(20);

/// A picture that comes within this is waited for: else the frame would be painted twice, once without it.
const NEARLY: Duration = Duration::from_millis(10);

/// What the screen and the thread share: one wish, one fulfilment. The newest wish wins.
#[derive(Default)]
struct Desk {
    wish: Option<u32>,
    here: Option<(u32, Result<FrameRef, MediaError>)>,
    /// The thread decodes a frame itself, and cannot be told to stop.
    is_decoding: bool,
    is_closed: bool,
}

type Shared = Arc<(Mutex<Desk>, Condvar)>;

/// Pictures of one clip.
pub(super) struct Pictures {
    media: Arc<Media>,
    shot: Option<Shot>,
    shared: Shared,
    thread: Option<JoinHandle<()>>,
}

fn lock(shared: &Shared) -> MutexGuard<'_, Desk> {
    shared.0.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pictures {
    pub(super) fn new(media: Arc<Media>, waker: Waker) -> std::io::Result<Self> {
        let shared = Shared::default();
        let (desk, clip) = (Arc::clone(&shared), Arc::clone(&media));
        let thread = std::thread::Builder::new()
            .name("pictures".to_owned())
            .spawn(move || fulfil(&desk, &clip, &waker))?;
        Ok(Self { media, shot: None, shared, thread: Some(thread) })
    }

    /// Brings the picture of a frame to hand, or as near as it is possible without waiting; wakes the screen
    /// when there is more. Returns whether another picture is at hand than before.
    ///
    /// # Errors
    /// When the frame cannot be decoded.
    pub(super) fn look(&mut self, frame: u32, lens: Lens) -> Result<bool, MediaError> {
        if self.shot.as_ref().is_some_and(|shot| shot.frame == frame && shot.lens == lens) {
            return Ok(false);
        }
        let picture = match self.media.try_frame(frame)? {
            Some(picture) => picture,
            None => match self.ask(frame)? {
                Some(picture) => picture,
                None => return Ok(false),
            },
        };
        self.shot = Some(Shot { frame, lens, pixels: scaled(&picture, lens) });
        Ok(true)
    }

    /// The picture at hand.
    pub(super) fn shot(&self) -> Option<&Shot> {
        self.shot.as_ref()
    }

    /// The picture at hand, with so many pixels to a cell; `None` where that takes time.
    pub(super) fn fine(&self, grid: (u32, u32)) -> Option<Shot> {
        let Shot { frame, lens, .. } = self.shot.as_ref()?;
        let lens = Lens { grid, ..*lens };
        let picture = self.media.try_frame(*frame).ok()??;
        Some(Shot { frame: *frame, lens, pixels: scaled(&picture, lens) })
    }

    /// Takes a frame from the desk, or puts the wish for it there.
    fn ask(&self, frame: u32) -> Result<Option<FrameRef>, MediaError> {
        let mut desk = lock(&self.shared);
        let is_here = |desk: &Desk| desk.here.as_ref().is_some_and(|(n, _)| *n == frame);
        if !is_here(&desk) && desk.wish != Some(frame) {
            desk.wish = Some(frame);
            self.shared.1.notify_one();
            let waited = self.shared.1.wait_timeout_while(desk, NEARLY, |desk| !is_here(desk));
            desk = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        if !is_here(&desk) {
            return Ok(None);
        }
        desk.here.take().map(|(_, picture)| picture).transpose()
    }
}

/// What a lens shows of a picture.
fn scaled(picture: &FrameRef, lens: Lens) -> Vec<[u8; 3]> {
    let area = Rect { x: lens.x, y: lens.y, width: lens.width, height: lens.height };
    let (columns, rows) = lens.size();
    picture.rgb_area(area, columns, rows)
}

/// The thread: fetches what is wished for, one frame after another.
fn fulfil(shared: &Shared, media: &Media, waker: &Waker) {
    let mut desk = lock(shared);
    while !desk.is_closed {
        let Some(frame) = desk.wish else {
            desk = shared.1.wait(desk).unwrap_or_else(PoisonError::into_inner);
            continue;
        };
        // What the clip's own decoder will come by is waited for here, where the newest wish and the end are seen.
        if frame >= media.n_ready() && matches!(media.try_frame(frame), Ok(None)) {
            desk = shared.1.wait_timeout(desk, LOOK).unwrap_or_else(PoisonError::into_inner).0;
            continue;
        }
        desk.is_decoding = true;
        drop(desk);
        let picture = media.frame(frame);
        desk = lock(shared);
        desk.is_decoding = false;
        desk.here = Some((frame, picture));
        if desk.wish == Some(frame) {
            desk.wish = None;
        }
        shared.1.notify_all();
        waker.wake();
    }
}

impl Drop for Pictures {
    fn drop(&mut self) {
        let mut desk = lock(&self.shared);
        desk.is_closed = true;
        let is_decoding = desk.is_decoding;
        drop(desk);
        self.shared.1.notify_one();
        // A frame being decoded is not waited for: it ends with the program.
        if let Some(thread) = self.thread.take().filter(|_| !is_decoding) {
            // A panic there was reported where it happened.
            thread.join().ok();
        }
    }
}

//! Frames decoded on demand, for clips that are raw already or that the cache cannot hold.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::error::MediaError;
use crate::source::{Decode, Source};

/// Memory for recent frames, bytes; two frames are kept whatever their size.
const RECENT_BYTES: usize = 256 << 20;

/// A decoder with the frames that it gave last. Going back beyond these starts it again.
pub(crate) struct OnDemand {
    source: Arc<dyn Source>,
    running: Option<Box<dyn Decode>>,
    /// The frame that `running` gives next.
    next: u32,
    recent: VecDeque<(u32, Arc<[u8]>)>,
    capacity: usize,
    frame_len: usize,
}

impl OnDemand {
    pub(crate) fn new(source: Arc<dyn Source>, frame_len: usize, capacity: Option<usize>) -> Self {
        let capacity = capacity.unwrap_or(RECENT_BYTES / frame_len).max(2);
        Self { source, running: None, next: 0, recent: VecDeque::new(), capacity, frame_len }
    }

    /// Frames decoded since the decoder was last started, from the first of the clip.
    pub(crate) fn n_decoded(&self) -> u32 {
        self.next
    }

    /// Frame `n`, if it is one of the recent ones.
    pub(crate) fn recent(&self, n: u32) -> Option<Arc<[u8]>> {
        self.recent.iter().rev().find(|(k, _)| *k == n).map(|(_, frame)| Arc::clone(frame))
    }

    /// Frame `n`; `None` when the stream ends before it.
    pub(crate) fn frame(&mut self, n: u32) -> Result<Option<Arc<[u8]>>, MediaError> {
        if let Some(frame) = self.recent(n) {
            return Ok(Some(frame));
        }
        // Kept again only once it has given this frame: after the end, an error or a panic it is of no use.
        let mut running = match self.running.take() {
            Some(running) if n == self.next || (n > self.next && !self.source.is_raw()) => running,
            stale => {
                drop(stale);
                let (start, running) = self.source.decode(n)?;
                self.next = start;
                running
            }
        };
        loop {
            let mut frame = vec![0; self.frame_len];
            if !running.next(&mut frame)? {
                return Ok(None);
            }
            let frame: Arc<[u8]> = frame.into();
            if self.recent.len() == self.capacity {
                self.recent.pop_front();
            }
            self.recent.push_back((self.next, Arc::clone(&frame)));
            self.next += 1;
            if self.next > n {
                self.running = Some(running);
                return Ok(Some(frame));
            }
        }
    }
}

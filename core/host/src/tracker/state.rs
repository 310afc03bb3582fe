//! What a tracker carries from frame to frame, kept so that another one can go on with it.

use super::live::Live;
use super::{Tracker, no_stream};
use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::Request;
use crate::reply;

/// A tracker saves no more than this.
const STATE_BYTES_MAX: usize = 1 << 30;

/// A tracker between two frames of its stream.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// What the plugin has saved; its own.
    pub bytes: Vec<u8>,
    /// Index and time of the frame pushed last.
    last: Option<(i64, f64)>,
    /// The points that were live.
    live: Live,
}

impl Tracker {
    /// Whether the plugin can save what it carries (`honami.state/1`).
    #[must_use]
    pub fn can_save(&self) -> bool {
        self.has_state
    }

    /// Whether the plugin can end while this process goes on.
    #[must_use]
    pub fn can_end(&self) -> bool {
        self.handle.can_end()
    }

    /// Saves what the tracker carries between two frames; the stream goes on.
    ///
    /// # Errors
    /// [`HostError`], when there is no stream or the plugin cannot. After [`HostError::Failed`] the stream goes on all the
    /// same, unless its code is that of a fault.
    pub fn save(&mut self, cx: &CallContext<'_>) -> Result<Checkpoint, HostError> {
        if self.stream.is_none() {
            return Err(no_stream(&self.handle));
        }
        let asked = self.handle.ask(&Request::Save, cx, &mut self.reply);
        self.over_unless_refused(asked)?;
        let table = self.reply.table(&reply::STATE);
        let bytes = match table.map(|table| table.required::<u8>("bytes")) {
            Some(bytes) if bytes.len() <= STATE_BYTES_MAX => Ok(bytes.to_vec()),
            Some(bytes) => Err(format!("saved {} bytes, at most {STATE_BYTES_MAX} are kept", bytes.len())),
            None => Err("returned without committing honami.state/1".to_owned()),
        };
        let bytes = bytes.map_err(|what| {
            self.stream = None;
            self.handle.misbehaved("save", what)
        })?;
        let Some(stream) = &self.stream else { return Err(no_stream(&self.handle)) };
        Ok(Checkpoint { bytes, last: stream.last, live: stream.live.clone() })
    }

    /// Goes on from a checkpoint of the same stream, under the same parameters, in place of this stream's beginning: it
    /// comes directly after [`begin`](Self::begin). The next frame is the one after that pushed last before the checkpoint.
    ///
    /// # Errors
    /// [`HostError`], when the stream has gone on already or the plugin refuses the bytes. After [`HostError::Failed`] the
    /// stream goes on as it was begun, unless its code is that of a fault.
    pub fn load(&mut self, from: &Checkpoint, cx: &CallContext<'_>) -> Result<(), HostError> {
        let Some(stream) = &self.stream else { return Err(no_stream(&self.handle)) };
        if stream.last.is_some() {
            return Err(self.handle.usage("a checkpoint is loaded before the first frame"));
        }
        let asked = self.handle.ask(&Request::Load(&from.bytes), cx, &mut self.reply);
        self.over_unless_refused(asked)?;
        if let Some(stream) = &mut self.stream {
            (stream.last, stream.live) = (from.last, from.live.clone());
        }
        Ok(())
    }

    fn over_unless_refused<T>(&mut self, result: Result<T, HostError>) -> Result<T, HostError> {
        if matches!(&result, Err(HostError::Failed { .. })) && !self.handle.has_failed() {
            return result;
        }
        self.over_on_error(result)
    }
}

//! Dense motion of a clip, as the project's own tracker measures it.

use std::sync::Arc;

use honami_host::{CallContext, Host, Kind, PluginInfo, Tracker, Values};
use honami_media::{FrameRef, Media};
use honami_model::track::TrackId;
use honami_motion::overlay::VelocityField;

use crate::drive::view;
use crate::error::WorkbenchError;
use crate::retrack::usual;
use crate::session::Session;
use crate::track::threads;

/// Measures the dense motion of any frame. Works on any thread; nothing is kept in the project.
pub struct DenseMeter {
    media: Arc<Media>,
    plugin: PluginInfo,
    values: Values,
    host: Host,
    tracker: Option<Tracker>,
}

/// Chooses the tracker that made a track, with its parameters, or else that of the last run, or else the first; it is
/// loaded when the first field is measured.
///
/// # Errors
/// [`WorkbenchError::NoTracker`], [`WorkbenchError::NoDense`], [`WorkbenchError::OneFrame`].
pub fn prepare(session: &Session, track: Option<TrackId>) -> Result<DenseMeter, WorkbenchError> {
    let (plugin, values) = usual(session, track)?.ok_or(WorkbenchError::NoTracker)?;
    let plugin = session.registry.find(Kind::Tracker, &plugin)?.clone();
    if !plugin.offers("honami.field/1") {
        return Err(WorkbenchError::NoDense { plugin: plugin.short_name });
    }
    if session.media.clip().n_frames() < 2 {
        return Err(WorkbenchError::OneFrame);
    }
    let (media, host) = (Arc::clone(&session.media), session.options.host.clone());
    Ok(DenseMeter { media, plugin, values, host, tracker: None })
}

impl DenseMeter {
    /// Short name of the tracker.
    #[must_use]
    pub fn plugin(&self) -> &str {
        &self.plugin.short_name
    }

    /// Velocities in a frame, over the way to the next one; in the last frame over that from the one before. Waits for
    /// the frames to be decoded.
    ///
    /// # Errors
    /// What the clip or the tracker met.
    pub fn measure(&mut self, frame: u32) -> Result<VelocityField, WorkbenchError> {
        let other =
            if frame + 1 < self.media.clip().n_frames() { frame + 1 } else { frame.saturating_sub(1) };
        let pictures: [FrameRef; 2] = [self.media.frame(frame)?, self.media.frame(other)?];
        let [from, to] = [(&pictures[0], frame), (&pictures[1], other)]
            .map(|(picture, frame)| view(&self.media, picture, frame));
        let cx = CallContext::silent();
        let tracker = match &mut self.tracker {
            Some(tracker) => tracker,
            none => none.insert(self.host.tracker(&self.plugin, &self.values, &cx)?.0),
        };
        let field = tracker.field(&from, &to, threads(), &cx).inspect_err(|error| {
            // Its process has ended: the next field is measured in another.
            self.tracker.take_if(|_| error.end().is_some());
        })?;
        // The times of two frames differ; backward in time both lengths turn their sign.
        let step_s = to.time_s - from.time_s;
        let velocity = |moved: [f32; 2]| moved.map(|px| (f64::from(px) / step_s) as f32);
        Ok(VelocityField {
            origin: field.origin.map(f64::from),
            step_px: f64::from(field.step),
            nx: field.nx as usize,
            velocities: field.vectors.into_iter().map(|moved| moved.map(velocity)).collect(),
        })
    }
}

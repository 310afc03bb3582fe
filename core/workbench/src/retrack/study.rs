//! A track and its tracker, taken out of the project: tracked again on any thread, as often as one likes.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use honami_host::{Host, Registry, Values};
use honami_media::Media;
use honami_model::clip::FrameTimes;
use honami_model::correct::Correction;
use honami_model::document::Key;
use honami_model::history::EntryId;
use honami_model::over::Laid;
use honami_model::track::{Sample, TrackId};
use honami_review::fuse::{Ends, Picked, fuse};
use honami_review::loko::Placed;

use super::lay::{Runs, Tracked};
use super::pass::{Found, Meter, Scene};
use super::plan::{self, Anchors, Limits, Pass, Stretch};
use super::{Direction, RetrackJob, RetrackRequest, Way, direction, lay};
use crate::error::WorkbenchError;
use crate::ground::Ground;
use crate::offer::Model;
use crate::progress::Progress;
use crate::session::Session;

/// A track as it lay in the project, with the clip and the tracker that made it.
pub struct Study {
    pub(super) media: Arc<Media>,
    pub(super) registry: Arc<Registry>,
    pub(super) host: Host,
    pub(crate) ground: Ground,
    pub(super) revision: EntryId,
    /// The tracker that made it, and its parameters; `None` where there is no tracker at all.
    usual: Option<(String, Values)>,
}

/// Takes a track out of the project.
///
/// # Errors
/// When there is no such track, and what the project met.
pub fn study(session: &Session, track: TrackId) -> Result<Study, WorkbenchError> {
    Ok(Study {
        media: Arc::clone(&session.media),
        registry: Arc::clone(&session.registry),
        host: session.options.host.clone(),
        ground: Ground::of(&session.project, track)?,
        revision: session.project.revision(),
        usual: direction::usual(session, Some(track))?,
    })
}

impl Study {
    /// The track.
    #[must_use]
    pub fn track(&self) -> TrackId {
        self.ground.id
    }

    pub(crate) fn times(&self) -> &FrameTimes {
        &self.media.clip().times
    }

    pub(crate) fn anchors(&self, keys: &[(u32, Key)]) -> Anchors {
        lay::anchors(&self.ground, keys, self.times())
    }

    /// What a person means who says `way` with the cursor on `frame`: up to the neighbouring key-frames, or where there
    /// are none to the track's birth and as far as it was followed before; from a key-frame outside that, to the clip's
    /// ends. On a key-frame, both ways are both of its sides. Nothing outside a marked range is changed.
    ///
    /// `keys` are set with it; those that the project has too are moved.
    #[must_use]
    pub fn around(
        &self,
        way: Way,
        frame: u32,
        keys: Vec<(u32, Key)>,
        marked: Option<Range<u32>>,
    ) -> RetrackRequest {
        let (times, n_frames) = (self.times(), self.media.clip().n_frames());
        let limits = Limits { marked, followed: self.ground.followed(times), n_frames };
        let frames = plan::around(&self.anchors(&keys), frame, way, &limits);
        RetrackRequest { track: self.track(), way, frames, keys, with: None }
    }

    /// Loads the tracker, once for each direction.
    ///
    /// # Errors
    /// When the plugin, its parameters or the frames are not what they must be, or no key-frame in them says where the
    /// feature is.
    pub fn job(self: &Arc<Self>, request: RetrackRequest) -> Result<RetrackJob, WorkbenchError> {
        let (first, last) = (*request.frames.start(), *request.frames.end());
        let n_frames = self.media.clip().n_frames();
        if first > last || last >= n_frames {
            return Err(WorkbenchError::Frames { start: first, end: last.saturating_add(1), n_frames });
        }
        let anchors = self.anchors(&request.keys);
        let stretches = plan::stretches(&anchors, &request.frames, request.way);
        if stretches.is_empty() && first == last && (1..n_frames - 1).contains(&first) {
            return Err(WorkbenchError::Followed { track: self.track(), frame: first });
        }
        if stretches.is_empty() {
            return Err(WorkbenchError::NoAnchor { track: self.track(), first, last });
        }
        let (plugin, values) = self.tracker(request.with.as_ref())?;
        let start = |pass: fn(&Stretch) -> Option<Pass>, word| {
            let passes: Vec<Pass> = stretches.iter().filter_map(pass).collect();
            Direction::start(self, (plugin, values), &passes, word)
        };
        Ok(RetrackJob {
            forward: start(Stretch::forward, "forward")?,
            backward: start(Stretch::backward, "backward")?,
            margin_px: direction::margin_px(values),
            study: Arc::clone(self),
            request,
            stretches,
        })
    }

    fn tracker<'a>(
        &'a self,
        with: Option<&'a (String, Values)>,
    ) -> Result<(&'a str, &'a Values), WorkbenchError> {
        let (plugin, values) = with.or(self.usual.as_ref()).ok_or(WorkbenchError::NoTracker)?;
        Ok((plugin, values))
    }

    /// Where the tracker that made the track finds the feature in a frame between two positions: from both of them,
    /// from the first alone, and from the second alone; nowhere without a tracker. Nothing comes of it but what is
    /// returned.
    ///
    /// # Errors
    /// [`WorkbenchError::Stopped`], and what the clip or the tracker met.
    pub(crate) fn between(
        &self,
        ends: [Placed; 2],
        frame: u32,
        progress: &dyn Progress,
    ) -> Result<[Option<Sample>; 3], WorkbenchError> {
        let stretch = Stretch::between(ends);
        let Some((plugin, values)) = &self.usual else { return Ok([None; 3]) };
        let path = self.ground.shown(self.times()).span().clone();
        let (margin_px, total) = (direction::margin_px(values), 2 * stretch.frames.len() as u64);
        let meter = Meter { progress, done: AtomicU64::new(0), total };
        let scene = Scene { media: &self.media, track: self.track(), path: &path, margin_px, meter: &meter };
        let make = |pass: Option<Pass>, word| {
            let passes: Vec<Pass> = pass.into_iter().collect();
            let direction = Direction::start(self, (plugin, values), &passes, word)?;
            let passes: Vec<_> = passes.into_iter().map(Some).collect();
            let made = direction.map(|direction| direction.make(&scene, &passes)).transpose()?;
            Ok::<_, WorkbenchError>(made.and_then(|made| made.found.into_iter().next().flatten()))
        };
        let (ahead, back) =
            rayon::join(|| make(stretch.forward(), "forward"), || make(stretch.backward(), "backward"));
        let (forward, backward) = (ahead?, back?);
        let alone = |found: &Option<Found>| found.as_ref().and_then(|found| found.span.get(frame)).copied();
        let (first, second) = (alone(&forward), alone(&backward));
        let both = Tracked { stretch, forward, backward }.path(Runs::default(), self.times());
        let both = both.into_iter().find(|(at, _)| *at == frame).map(|(_, laid)| laid.sample);
        Ok([both, first, second])
    }

    /// Whether several runs have followed the feature: then they can be [`fused`](Self::fused).
    #[must_use]
    pub fn has_rivals(&self) -> bool {
        let runs = &self.ground.runs;
        runs.iter().any(|(run, _)| *run != runs[0].0)
    }

    /// The models that can be offered for it, in their order.
    pub fn models(&self) -> impl Iterator<Item = Model> + use<> {
        let (has_rivals, has_tracker) = (self.has_rivals(), self.usual.is_some());
        Model::ALL.into_iter().filter(move |model| match model {
            Model::Fused => has_rivals,
            model => model.way().is_none() || has_tracker,
        })
    }

    /// The correction that sets key-frames and lays the best path through what several runs have found around a frame,
    /// up to the neighbouring key-frames.
    ///
    /// # Errors
    /// [`WorkbenchError::LostAtOnce`] where some frame was seen by none of them; what the document refuses.
    pub fn fused(&self, frame: u32, keys: &[(u32, Key)]) -> Result<Correction, WorkbenchError> {
        let n_frames = self.media.clip().n_frames();
        let limits = Limits { marked: None, followed: 0..n_frames, n_frames };
        let frames = plan::around(&self.anchors(keys), frame, Way::Both, &limits);
        let stretches = plan::stretches(&self.anchors(keys), &frames, Way::Both);
        let path = stretches.iter().flat_map(|stretch| self.picked(stretch)).collect::<Vec<_>>();
        let laid = lay::laid(&self.ground, keys, path, self.times())?;
        let (first, last) = laid.frames;
        Ok(laid.labelled(keys, &format!("{first}-{last} fused from its runs"), ""))
    }

    /// Where the best path between two positions is in a frame.
    pub(crate) fn fused_between(&self, ends: [Placed; 2], frame: u32) -> Option<Sample> {
        let picked = self.picked(&Stretch::between(ends));
        picked.into_iter().find(|(at, _)| *at == frame).map(|(_, laid)| laid.sample)
    }

    /// The best path through a stretch, each sample with the run it is from; empty where there is none.
    fn picked(&self, stretch: &Stretch) -> Vec<(u32, Laid)> {
        let runs = &self.ground.runs;
        let candidates: Vec<_> = runs.iter().rev().map(|(_, span)| span).collect();
        let ends = Ends { before: stretch.before, after: stretch.after };
        let picked = fuse(stretch.frames.clone(), &ends, &candidates).unwrap_or_default();
        let laid = |picked: Picked| {
            let run = runs.iter().rev().nth(picked.candidate).map(|(run, _)| *run);
            Laid { sample: picked.sample, run }
        };
        stretch.frames.clone().zip(picked.into_iter().map(laid)).collect()
    }
}

//! One direction: a tracker with its parameters, and the run that its passes become.

use honami_host::{CallContext, Kind, Tracker, Values};
use honami_model::provenance::{Provenance, Value};
use honami_model::track::TrackId;
use honami_store::RunHead;

use super::Study;
use super::pass::{Found, Rider, Scene};
use super::plan::Pass;
use crate::error::WorkbenchError;
use crate::session::Session;
use crate::stamp::stamp;

/// How much of the picture a tracker is given round the path at least, pixels.
const MARGIN_PX: u32 = 128;

/// A tracker for one direction, and the head of the run that it makes.
pub(super) struct Direction {
    tracker: Tracker,
    head: RunHead,
}

/// What one direction found: one entry a stretch.
#[derive(Default)]
pub(super) struct Made {
    pub(super) found: Vec<Option<Found>>,
    pub(super) head: Option<RunHead>,
    pub(super) warnings: Vec<String>,
}

impl Direction {
    /// Loads the tracker for these passes; `None` where there are none.
    pub(super) fn start(
        study: &Study,
        (plugin, values): (&str, &Values),
        passes: &[Pass],
        word: &str,
    ) -> Result<Option<Self>, WorkbenchError> {
        let frames = || passes.iter().flat_map(|pass| [pass.from, pass.frames.start, pass.frames.end - 1]);
        let (Some(first), Some(last)) = (frames().min(), frames().max()) else { return Ok(None) };
        let plugin = study.registry.find(Kind::Tracker, plugin)?;
        let (tracker, origin) = study.host.tracker(plugin, values, &CallContext::silent())?;
        let from: Vec<String> = passes.iter().map(|pass| pass.from.to_string()).collect();
        let what = format!("retrack {word} from {}", from.join(", "));
        let provenance = stamp(study.revision, &what, plugin, values, origin);
        let head = RunHead { provenance, tracks: study.track().into(), frames: first..last + 1 };
        Ok(Some(Self { tracker, head }))
    }

    /// Makes all passes of this direction, one after the other.
    pub(super) fn make(mut self, scene: &Scene<'_>, passes: &[Option<Pass>]) -> Result<Made, WorkbenchError> {
        let mut made = Made::default();
        let mut rider = Rider { scene, tracker: &mut self.tracker };
        for pass in passes {
            let found = pass.as_ref().map(|pass| rider.follow(pass, &mut made.warnings)).transpose()?;
            made.found.push(found);
        }
        made.head = Some(self.head);
        Ok(made)
    }
}

/// The tracker and the parameters that made a track, or else those of the last run; a tracker that is not at hand any
/// more is passed over. `None`: there is none.
pub(crate) fn usual(
    session: &Session,
    track: Option<TrackId>,
) -> Result<Option<(String, Values)>, WorkbenchError> {
    let known = |provenance: Provenance| {
        let plugin = session.registry.find(Kind::Tracker, &provenance.plugin_id).ok()?;
        Some((plugin.id.clone(), provenance.params.into_iter().collect::<Values>()))
    };
    let project = &session.project;
    for run in track.into_iter().flat_map(|track| project.document().runs_of(track).rev()) {
        if let Some(usual) = known(project.run(run)?.head.provenance) {
            return Ok(Some(usual));
        }
    }
    let last = project.runs()?.into_iter().rev().find_map(|run| known(run.head.provenance));
    let any = || session.registry.plugins().iter().find(|plugin| plugin.kind == Kind::Tracker);
    Ok(last.or_else(|| Some((any()?.id.clone(), Values::default()))))
}

/// How much of the picture a tracker is given round the path, pixels.
///
/// A tracker that names its window `radius` and the levels of its pyramid `levels` says how far it looks: as far as
/// the window reaches on the coarsest level.
pub(super) fn margin_px(values: &Values) -> u32 {
    let whole = |id| match values.get(id) {
        Some(Value::Int(n)) => u32::try_from(*n).ok(),
        _ => None,
    };
    let reach_px = whole("radius").zip(whole("levels")).map_or(0, |(radius_px, levels)| {
        radius_px.saturating_mul(1_u32.checked_shl(levels.saturating_sub(1)).unwrap_or(u32::MAX))
    });
    MARGIN_PX.max(reach_px.saturating_mul(3) / 2)
}

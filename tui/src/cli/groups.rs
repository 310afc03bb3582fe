//! `cluster`: find the groups that move together.

use honami_workbench::cluster::{self, ClusterOutcome, ClusterRequest};
use honami_workbench::plugins::{Kind, Values};
use honami_workbench::progress::Progress;
use honami_workbench::session::Session;
use serde_json::json;

use super::args::{Cluster, Common};
use super::{Answer, report, session, track};

/// The clusterer that is used unless one is named.
pub(super) const DEFAULT: &str = "bod";

/// Clusters, and shows the groups.
pub(super) fn cluster(args: &Cluster, common: &Common) -> anyhow::Result<Answer> {
    let mut session = session(&args.project, common)?;
    let plugin = args.plugin.with.as_deref().unwrap_or(DEFAULT).to_owned();
    let params = track::values(&session.registry, Kind::Clusterer, &plugin, &args.plugin.set)?;
    let request = ClusterRequest { plugin, params, groups: args.groups };
    Ok(describe(&run(&mut session, &request, &report::Bar::with(common))?))
}

/// The default clusterer with its default parameters.
pub(super) fn request() -> ClusterRequest {
    ClusterRequest { plugin: DEFAULT.to_owned(), params: Values::default(), groups: None }
}

/// Prepares, runs and finishes.
pub(super) fn run(
    session: &mut Session,
    request: &ClusterRequest,
    progress: &dyn Progress,
) -> anyhow::Result<ClusterOutcome> {
    let job = cluster::prepare(session, request)?;
    let done = job.run(progress)?;
    Ok(cluster::finish(session, done)?)
}

fn describe(outcome: &ClusterOutcome) -> Answer {
    let json = json!({
        "clustering": outcome.clustering.0,
        "tracks": outcome.n_tracks,
        "groups": outcome.group_sizes,
        "outlier_frames": outcome.outlier_frames,
        "seconds": outcome.seconds,
        "warnings": outcome.warnings,
    });
    Answer { json, text: report::with_warnings(&outcome.line, &outcome.warnings), done: true }
}

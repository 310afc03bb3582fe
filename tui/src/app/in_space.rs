//! Tracks in space, as the project keeps them of two cameras.

use std::sync::Arc;

use honami_model::space::{Fix, SpaceId, SpaceTrack};
use honami_model::track::TrackId;
use honami_workbench::store::{Project, StoreError};

/// The tracks in space that the project shows.
#[derive(Clone, Debug, PartialEq)]
pub struct InSpace {
    id: SpaceId,
    tracks: Arc<Vec<SpaceTrack>>,
    /// Whether the tracks have changed since.
    pub is_stale: bool,
}

impl InSpace {
    /// What a project shows; fixes that are known from before are not read again.
    ///
    /// # Errors
    /// What the project file met.
    pub fn of(project: &Project, before: Option<Self>) -> Result<Option<Self>, StoreError> {
        let Some(id) = project.document().space() else { return Ok(None) };
        let tracks = match before.filter(|before| before.id == id) {
            Some(before) => before.tracks,
            None => Arc::new(project.space(id)?.tracks),
        };
        let is_stale = project.is_space_stale(id)?.is_some();
        Ok(Some(Self { id, tracks, is_stale }))
    }

    /// Where a track is in space, frame by frame; `None` where it is not.
    #[must_use]
    pub fn fixes(&self, track: TrackId) -> Option<&[Fix]> {
        self.tracks.iter().find(|placed| placed.track == track).map(|placed| &placed.fixes[..])
    }
}

#[cfg(test)]
pub(super) mod tests {
    use honami_model::edit::Transaction;
    use honami_model::provenance::Provenance;
    use honami_workbench::session::Session;
    use honami_workbench::store::Space;

    use super::*;

    /// Track 1 is 2.3 m away in frames 40 to 49, ± 12 mm.
    pub(in crate::app) fn in_space(is_stale: bool) -> InSpace {
        let fix = |frame| Fix {
            frame,
            place_m: [0.1, -0.2, 2.3142],
            errors_m: [0.001, 0.001, 0.0123],
            residual_px: 0.3,
        };
        let track = SpaceTrack { track: TrackId(1), right: TrackId(5), fixes: (40..50).map(fix).collect() };
        InSpace { id: SpaceId(1), tracks: Arc::new(vec![track]), is_stale }
    }

    #[test]
    fn a_project_s_tracks_in_space_are_read_once_and_are_stale_when_their_tracks_change() {
        let folder = tempfile::tempdir().unwrap();
        let mut clip = b"YUV4MPEG2 W64 H48 F25:1 Cmono\n".to_vec();
        for _ in 0..4 {
            clip.extend(b"FRAME\n");
            clip.extend([90; 64 * 48]);
        }
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("clip.y4m"), clip).unwrap();
        let session = Session::create(&path("p.honami"), &path("clip.y4m"), None, &Default::default());
        let mut project = session.unwrap().project;
        assert_eq!(InSpace::of(&project, None).unwrap(), None);
        let track = TrackId(project.reserve_tracks(1).unwrap().start);
        project.commit(Transaction::add_track(track, 0, 5.0, 6.0)).unwrap();
        let InSpace { tracks, .. } = in_space(false);
        let tracks = tracks.iter().map(|placed| SpaceTrack { track, ..placed.clone() }).collect();
        let provenance = Provenance {
            what: "triangulate".to_owned(),
            plugin_id: "org.honami.triangulate".to_owned(),
            plugin_version: "0.1.0".to_owned(),
            plugin_sha256: String::new(),
            abi: (0, 0),
            params: Default::default(),
            seed: 0,
            input_revision: project.revision().0,
            sandbox: String::new(),
            simd: String::new(),
            date: "2026-11-24T03:00:00Z".to_owned(),
            honami_version: "0.1.0".to_owned(),
        };
        let id = project.save_space(&Space { provenance, tracks }).unwrap();
        project.commit(Transaction::show_space(id, 1)).unwrap();
        let shown = InSpace::of(&project, None).unwrap().unwrap();
        assert_eq!((shown.fixes(track).map(<[Fix]>::len), shown.is_stale), (Some(10), false));
        assert_eq!(shown.fixes(TrackId(track.0 + 1)), None);
        project.commit(Transaction::set_key(track, 2, [7.0, 8.0], None)).unwrap();
        let later = InSpace::of(&project, Some(shown.clone())).unwrap().unwrap();
        assert!(later.is_stale && Arc::ptr_eq(&later.tracks, &shown.tracks));
    }
}

//! What later frames depend on, as bytes.

use honami_follow::{from_bytes, to_bytes};
use honami_plugin::{Error, Result, Status, Stream};
use honami_vision::Point;
use honami_vision::particles::{Particle, Swarm};
use honami_vision::pyramid::Pyramid;
use honami_vision::saved::SavedPicture;
use serde::{Deserialize, Serialize};

use super::births::Births;
use super::settings::Settings;
use super::{Live, Particles, Seen};

/// What later frames depend on.
#[derive(Serialize, Deserialize)]
struct Carried {
    seen: Option<(SavedPicture, Vec<Particle>, u64)>,
    points: Vec<(u32, Point, u8)>,
    births: Births,
}

impl Particles {
    pub(super) fn save(&self) -> Result<Vec<u8>> {
        let seen = self.seen.as_ref().map(|Seen { swarm, now, .. }| {
            (SavedPicture::of(&now.picture()), swarm.living().to_vec(), swarm.n_born())
        });
        let points = self.points.iter().map(|(&id, point)| (id, point.at, point.status as u8)).collect();
        to_bytes(&Carried { seen, points, births: self.births.clone() })
    }

    pub(super) fn load(settings: &Settings, stream: &Stream, bytes: &[u8]) -> Result<Self> {
        let Carried { seen, points, births } = from_bytes(bytes)?;
        let mut tracker = Self::new(settings, stream);
        if let Some((last, living, n_born)) = seen {
            let picture = last.gray().ok_or_else(|| Error::data("its picture is not whole"))?;
            let now = Pyramid::new(&picture, tracker.params.klt.levels, tracker.params.klt.radius_px);
            let swarm = Swarm::of(&tracker.params, living, n_born);
            tracker.seen = Some(Seen { swarm, before: now.clone(), now });
        }
        for (id, at, status) in points {
            tracker.points.insert(id, Live { at, status: Status::try_from(status)? });
        }
        tracker.births = births;
        Ok(tracker)
    }
}

//! What a tracker carries from picture to picture, for another one to go on with.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::{Live, Params, Tracker};
use crate::pyramid::Pyramid;
use crate::saved::SavedPicture;

/// All that later pictures depend on, beside the parameters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Saved<'a> {
    /// The picture pushed last.
    last: Option<SavedPicture>,
    live: Cow<'a, [Live]>,
    n_seeds: u32,
    is_changed: bool,
}

impl Tracker {
    /// All that later pictures depend on.
    #[must_use]
    pub fn save(&self) -> Saved<'_> {
        let last = self.pyramids.as_ref().map(|[last, _]| SavedPicture::of(&last.picture()));
        let (n_seeds, is_changed) = (self.n_seeds, self.is_changed);
        Saved { last, live: Cow::Borrowed(&self.live), n_seeds, is_changed }
    }

    /// A tracker that goes on as the one did that saved this; `None` where no tracker with these parameters could have.
    #[must_use]
    pub fn load(params: Params, max_threads: usize, saved: Saved<'_>) -> Option<Self> {
        let tracker = Self::new(params, max_threads);
        let Saved { last, live, n_seeds, is_changed } = saved;
        // When points have come or gone, those near each other are looked up anew.
        let n_slots = if is_changed { usize::MAX } else { live.len() };
        let is_sound = live.iter().all(|point| point.is_sound(&tracker.params, n_slots))
            && live.windows(2).all(|pair| pair[0].id < pair[1].id);
        let first = match &last {
            Some(picture) => {
                let klt = &tracker.params.klt;
                Some(Pyramid::new(&picture.gray()?, klt.levels, klt.radius_px))
            }
            None => None,
        };
        let pyramids = first.map(|first| [first.clone(), first]);
        is_sound.then(|| Self { pyramids, live: live.into_owned(), n_seeds, is_changed, ..tracker })
    }
}

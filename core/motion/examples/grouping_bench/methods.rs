//! The methods that are compared, each from tracks to a hierarchy.

use honami_model::hierarchy::Dendrogram;
use honami_motion::likeness::{self, Flutter};
use honami_motion::{Criterion, Likeness, MotionError, Positions, composite, denoised, likenesses, linkage};

type Method = fn(&Positions) -> Result<Dendrogram, MotionError>;

/// What a row is called, and what it does.
pub(crate) const METHODS: [(&str, Method); 8] = [
    ("position", |tracks| thesis(tracks, 0.0)),
    ("distance of movement (`movement`)", |tracks| thesis(tracks, 1.0)),
    ("the same, denoised", |tracks| thesis(&denoised(tracks, 0, &mut |_| true)?.0, 1.0)),
    ("`bod`, flutter=keep", |tracks| components(tracks, Likeness::Loadings, 0.6, Flutter::Keep)),
    ("`bod`, flutter=down", |tracks| components(tracks, Likeness::Loadings, 0.6, Flutter::TakeDown)),
    ("**`bod`, as it comes**", |tracks| components(tracks, Likeness::Loadings, 0.6, Flutter::Auto)),
    ("`bod`, likeness=turned", |tracks| components(tracks, Likeness::Turned, 0.5, Flutter::Auto)),
    ("`bod`, likeness=steps", |tracks| components(tracks, Likeness::Steps, 1.0, Flutter::Auto)),
];

fn thesis(tracks: &Positions, movement_weight: f64) -> Result<Dendrogram, MotionError> {
    let options = composite::Options { movement_weight, ..Default::default() };
    linkage(composite(tracks, &options, &mut |_| true)?.condensed, tracks.n_tracks(), Criterion::Ward)
}

fn components(
    tracks: &Positions,
    likeness: Likeness,
    position_weight: f64,
    flutter: Flutter,
) -> Result<Dendrogram, MotionError> {
    let options = likeness::Options { likeness, position_weight, flutter, ..Default::default() };
    let found = likenesses(tracks, &options, &mut |_| true)?;
    linkage(found.condensed, found.n_tracks, Criterion::Ward)
}

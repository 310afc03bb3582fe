//! What the line of the selected track says of its place in space.

use honami_model::space::Fix;

use crate::app::state::State;
use crate::app::tracks::TrackRow;

/// `z 2.314 ± 0.012 m`: how far away the track is in this frame, along the left camera's line of sight.
pub(super) fn words(state: &State, row: &TrackRow) -> Option<String> {
    let space = state.space.as_ref()?;
    let fixes = space.fixes(row.id)?;
    let here = fixes.iter().find(|fix| fix.frame == state.frame);
    let place = here.map_or_else(|| "in space, not here".to_owned(), depth);
    Some(if space.is_stale { format!("{place} (stale)") } else { place })
}

/// To two digits of its error.
fn depth(fix: &Fix) -> String {
    let (z_m, error_m) = (fix.place_m[2], f64::from(fix.errors_m[2]));
    let digits = (1.0 - error_m.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("z {z_m:.digits$} ± {error_m:.digits$} m")
}

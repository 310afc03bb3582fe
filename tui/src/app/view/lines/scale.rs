//! What the lines of the screen say of scale bars: of the one that is kept, and while one is set.

use honami_model::brief::Brief;
use honami_workbench::scale::ScaleBar;

use super::{Context, scaled};
use crate::app::action::Action;
use crate::app::scaling::Scaling;
use crate::app::state::State;
use crate::scale::{per_px, per_px_and_error};

/// What a pixel is, by the bar that is kept; in the frame that it is seen in, how long it is.
pub(super) fn kept(state: &State) -> Option<String> {
    let bar = state.scale.as_ref()?;
    let length =
        if bar.frame == state.frame { format!("bar {} m, ", Brief(bar.length_m)) } else { String::new() };
    Some(format!("{length}{}", per_px(bar)))
}

/// How ends are set, or what a bar measures, each with how soon it is left out.
pub(super) fn ways(state: &State, scaling: &Scaling) -> Vec<(u8, String)> {
    if scaling.bar.is_some() {
        let limits = ["it measures along itself, in its own plane", "nearer or farther has another scale"];
        return (0..).zip(limits.map(str::to_owned)).collect();
    }
    let hints = state.keys.hints(Context::Scale);
    let keys = |word: &str| {
        let (keys, _) = hints.iter().find(|(_, other)| *other == word)?;
        Some(format!("{keys} {}", scaled(word, Context::Scale, state.zoom)))
    };
    let mut ways = vec![(0, "scale bar".to_owned())];
    if scaling.is_placing() {
        ways.extend(state.mouse.then(|| (1, "click sets an end".to_owned())));
        ways.extend(keys("1 px").map(|keys| (2, format!("{keys} a step"))));
        ways.extend(keys(".25").map(|keys| (4, keys)));
        let closer = state.keys.keys_of(Context::Scale, Action::ZoomIn);
        ways.extend(closer.map(|key| (3, format!("{key} closer"))));
    }
    ways
}

/// What is set so far, what comes next, and what all of it says.
pub(super) fn words(scaling: &Scaling) -> String {
    if let Some(bar) = &scaling.bar {
        return told(bar);
    }
    let [x, y] = scaling.at;
    match &scaling.ends[..] {
        [] => format!("one end  {x:.1}, {y:.1}"),
        [a] => format!("other end  {x:.1}, {y:.1}  {:.1} px", (x - a.at[0]).hypot(y - a.at[1])),
        [a, b, ..] => {
            let far = (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]);
            format!("length of these {far:.1} px, as 0.5m or 25mm: {}▏", scaling.typed)
        }
    }
}

/// `2.0000 mm/px ± 0.28 %  along 30°  0.5 m over 250.0 px`.
fn told(bar: &ScaleBar) -> String {
    let degrees = bar.direction_rad().to_degrees();
    let (length, far) = (Brief(bar.length_m), bar.length_px());
    format!("{}  along {degrees:.0}°  {length} m over {far:.1} px", per_px_and_error(bar))
}

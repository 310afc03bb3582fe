//! Screens of scale bars: while one is set, what it says, and as it is kept; and of tracks in space.

use honami_workbench::scale::ScaleBar;

use super::*;
use crate::app::in_space::tests::in_space;

#[test]
fn screens_of_scale_bars() {
    let (low, small, large) = ((40, 12), (80, 24), (120, 40));
    let placed = "e b 4 0 h Enter 8 0 l 4 0 k";
    let typed = "e b 4 0 h Enter 8 0 l 4 0 k Enter 2 0 0 m m";
    let told = "e b 4 0 h Enter 8 0 l 4 0 k Enter 2 0 0 m m Enter";
    for (size, at) in [(low, "40x12"), (small, "80x24"), (large, "120x40")] {
        check(&format!("scale_{at}"), size, placed, |_| {});
        check(&format!("scale_typing_{at}"), size, typed, |_| {});
        check(&format!("scale_told_{at}"), size, told, |_| {});
    }
    check("scale_zoomed_80x24", small, "e b z z 4 0 h Enter 3 0 l", |_| {});
    check("scale_mono_80x24", small, placed, |state| state.mono = true);
    let kept = |state: &mut State| {
        let ends = [[120.0, 120.0], [200.0, 80.0]];
        let bar = ScaleBar { frame: 40, ends, length_m: 0.2, length_error_m: 0.0, end_error_px: 0.5 };
        update(state, Msg::Fact(Fact::Scale(Some(bar))));
    };
    check("scale_kept_80x24", small, "", kept);
    check("scale_kept_elsewhere_120x40", large, ".", kept);
    check("scale_kept_mono_40x12", low, "", |state| {
        kept(state);
        state.mono = true;
    });
}

/// What two cameras see of a track is in its line.
#[test]
fn a_track_in_space_says_how_far_away_it_is() {
    let (low, small, large) = ((40, 12), (80, 24), (120, 40));
    let space = |is_stale| {
        move |state: &mut State| {
            update(state, Msg::Fact(Fact::Space(Some(in_space(is_stale)))));
            state.review = Default::default();
        }
    };
    check("space_80x24", small, "", space(false));
    check("space_stale_120x40", large, "", space(true));
    check("space_elsewhere_80x24", small, ".  1 0 .", space(false));
    check("space_40x12", low, "", space(false));
}

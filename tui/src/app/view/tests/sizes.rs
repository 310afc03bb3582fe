//! Screens of other sizes than the usual two, without colours, and with names that take more room than letters.

use super::*;

/// Low and narrow, and large: everything that lies over the picture or beside it.
#[test]
fn screens_of_other_sizes() {
    let (low, huge) = ((40, 12), (200, 60));
    check("review_200x60", huge, "", |_| {});
    check("queue_200x60", huge, "P q n n", fixture::crowd);
    check("help_200x60", huge, "?", |_| {});
    check("form_200x60", huge, "t r j j", |_| {});
    check("plots_200x60", huge, "P p", plot);
    check("history_200x60", huge, "U j", |_| {});
    check("move_40x12", low, "m 3 l", |_| {});
    check("slide_40x12", low, "T 2 l L", |_| {});
    check("range_40x12", low, "y j y r 1 9 l", |_| {});
    check("form_40x12", low, "t r j j", |_| {});
    check("form_bare_40x12", low, "t r", fixture::bare);
    check("typing_40x12", low, "t r j j 2 5", |_| {});
    check("help_40x12", low, "?", |_| {});
    check("palette_40x12", low, ": f r a m e", |_| {});
    check("tracks_40x12", low, "/", |_| {});
    check("prompt_40x12", low, "g f 1 2", |_| {});
    check("labels_40x12", low, "g l", fixture::crowd);
    check("dial_40x12", low, "v d 3 h", |_| {});
    check("key_frames_40x12", low, "P k", |_| {});
    check("groups_40x12", low, "P g", |_| {});
    check("history_40x12", low, "U j", |_| {});
    check("log_40x12", low, "5 . X g f 1 2 Enter P l", |_| {});
    check("plots_40x12", low, "P p", plot);
    check("playing_40x12", low, "; b", |state| state.dropped = Some([5, 13]));
    check("error_40x12", low, "", |state| {
        let text = "radius: wanted 2 to 50 (px), got 99".to_owned();
        state.notice = Some(Notice { text, is_error: true });
    });
    check("locked_40x12", low, "d d", |state| {
        state.read_only = Some("ada@lab2 (pid 4711) since 2026-11-22T02:27:01Z".to_owned());
    });
}

/// Without colours: nothing is said by a colour alone.
#[test]
fn screens_without_colours() {
    let mono = |state: &mut State| state.mono = true;
    check("mono_40x12", (40, 12), "", mono);
    check("mono_120x40", (120, 40), "P t y j", mono);
    check("mono_200x60", (200, 60), "P q", |state| {
        fixture::crowd(state);
        mono(state);
    });
    check("mono_form_80x24", (80, 24), "t r j j", mono);
    check("mono_range_80x24", (80, 24), "r 1 9 l", mono);
    check("mono_groups_80x24", (80, 24), "P g", mono);
}

/// Names of characters that take two cells, and longer than there is room.
#[test]
fn screens_of_wide_names() {
    let names = |state: &mut State| {
        state.name = "楓の枝の揺れ".to_owned();
        state.tracks[0].name = Some("芽の左".to_owned());
        state.tracks[1].name = Some("一番上の枝の先にある若い葉の裏側の中央".to_owned());
        state.tracks[2].name = Some("葉1".to_owned());
        state.groups.iter_mut().for_each(|groups| groups.what = "動きによる分類".to_owned());
    };
    for (size, at) in [((40, 12), "40x12"), ((80, 24), "80x24"), ((120, 40), "120x40"), ((200, 60), "200x60")]
    {
        check(&format!("wide_{at}"), size, "j", names);
        check(&format!("wide_tracks_{at}"), size, "P t j", names);
        check(&format!("wide_find_{at}"), size, "/ Down", names);
    }
    check("wide_groups_80x24", (80, 24), "P g", names);
    check("wide_typing_80x24", (80, 24), "j e n", names);
    check("wide_typing_40x12", (40, 12), "j e n", names);
    check("wide_notice_40x12", (40, 12), "", |state| {
        names(state);
        let text = "一番上の枝の先にある若い葉の裏側の中央: 名前が長すぎます".to_owned();
        state.notice = Some(Notice { text, is_error: true });
    });
    let mut start = crate::app::start::tests::start();
    start.recent[0].path = PathBuf::from("/資料/二千二十六年/楓の枝の揺れ・北側の窓から.honami");
    start.recent[1].path = PathBuf::from("/資料/葉.honami");
    for (size, at) in [((40, 12), "40x12"), ((80, 24), "80x24"), ((120, 36), "120x36")] {
        start.size = size;
        compare(&format!("wide_start_{at}"), &start::draw(&start));
    }
}

#[test]
fn what_is_being_opened_is_said_in_the_middle() {
    let keys = crate::app::keymap::KeyMap::default();
    for (size, at) in [((40, 12), "40x12"), ((80, 24), "80x24")] {
        let name = "楓の枝の揺れ.mp4";
        compare(
            &format!("opening_{at}"),
            &opening(name, &format!("finding the frames of {name}"), &keys, at == "80x24", size),
        );
    }
}

#[test]
fn a_text_is_fitted_by_cells_not_by_letters() {
    for (text, cells, expect) in [
        ("bud", 5, "bud  "),
        ("bud", 3, "bud"),
        ("bud", 2, "b…"),
        ("bud", 0, ""),
        ("芽の左", 7, "芽の左 "),
        ("芽の左", 5, "芽の…"),
        ("芽の左", 4, "芽… "),
        ("芽の左", 1, "…"),
    ] {
        assert_eq!(fitted(text, cells), expect, "{text} in {cells}");
        assert_eq!(width(expect), cells);
    }
    for (text, room, expect) in [
        ("go to the end", 6, &["go to", "the", "end"][..]),
        ("in /a/long/path", 6, &["in /a/", "long/p", "ath"]),
        ("芽の左 is here", 5, &["芽の", "左 is", "here"]),
    ] {
        assert_eq!(lines::wrapped(text, room), expect, "{text} in {room}");
    }
}

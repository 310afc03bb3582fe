//! The start screen by its keys and by the mouse.

use super::*;
use crate::app::files::Listing;

/// A start screen with two projects and three offers.
pub(in crate::app) fn start() -> Start {
    let recent =
        |path: &str, n_tracks, n_open, when_s| Recent { path: PathBuf::from(path), n_tracks, n_open, when_s };
    let mut start = Start::new(&Config::default(), None);
    let now_s = 1_700_000_000;
    start.now_s = now_s;
    start.recent = vec![
        recent("/data/2026/malva.honami", 135, Some(12), now_s - 100_000),
        recent("/data/2026/ficus-03.honami", 2010, None, now_s - 300_000),
    ];
    let offers = [("demo", "a generated clip, tracked and grouped"), ("doctor", "what this machine has")];
    start.rows.extend(offers.map(|(name, doc)| (name.to_owned(), doc.to_owned())));
    start.about = "ffmpeg found · display: half blocks, true colour".to_owned();
    start
}

/// A listing as the disk would give it.
pub(in crate::app) fn listing() -> Listing {
    let row = |name: &str, what: &str| {
        (name.to_owned(), what.to_owned(), Lead::File(Path::new("/data").join(name)))
    };
    Listing {
        folder: PathBuf::from("/data"),
        rows: vec![row("malva.honami", "project"), row("sway.mp4", "clip")],
    }
}

/// The wish after some keys; a wish for a folder is granted.
fn press(start: &mut Start, keys: &str) -> Option<Wish> {
    let mut last = None;
    for key in keys.split_whitespace() {
        last = start.on_key(key.parse().unwrap());
        if let Some(Wish::Follow(Lead::Folder(_))) = last {
            start.menu = Some(Menu::of_files(listing()));
        }
    }
    last
}

#[test]
fn keys_choose_what_is_opened() {
    let open = |path: &str| Some(Wish::Open(PathBuf::from(path)));
    let follow = |lead: Lead| Some(Wish::Follow(lead));
    let typed = |path: &str| follow(Lead::Typed(PathBuf::from(path)));
    for (keys, wish) in [
        ("Enter", open("/data/2026/malva.honami")),
        ("j Enter", open("/data/2026/ficus-03.honami")),
        ("j k k Enter", open("/data/2026/malva.honami")),
        ("j j Enter", follow(Lead::Folder(PathBuf::from(".")))),
        ("g c", follow(Lead::Folder(PathBuf::from(".")))),
        ("g c Down Enter", follow(Lead::File(PathBuf::from("/data/sway.mp4")))),
        ("g c w a y Enter", follow(Lead::File(PathBuf::from("/data/sway.mp4")))),
        ("g c a / b Enter", typed("/data/a/b")),
        ("g c / a Enter", typed("/a")),
        ("g c ~ / a Enter", typed("~/a")),
        ("g c x y z Enter", typed("/data/xyz")),
        ("g c x Backspace Enter", follow(Lead::File(PathBuf::from("/data/malva.honami")))),
        ("g c x y z Ctrl-u Enter", follow(Lead::File(PathBuf::from("/data/malva.honami")))),
        ("j j j j Enter", Some(Wish::Offer(0))),
        ("j j j j j j j Enter", Some(Wish::Offer(1))),
        ("q", Some(Wish::Leave)),
        ("Esc", Some(Wish::Leave)),
        ("Q", Some(Wish::Leave)),
        ("g c Esc", None),
        ("g c Esc Esc", Some(Wish::Leave)),
        ("Ctrl-l", Some(Wish::Redraw)),
        ("Ctrl-z", Some(Wish::Suspend)),
        ("x", None),
    ] {
        assert_eq!(press(&mut start(), keys), wish, "{keys}");
    }
}

#[test]
fn every_binding_answers() {
    use crate::app::keymap::KeyMap;
    for binding in KeyMap::default().bindings().iter().filter(|binding| binding.context == Context::Start) {
        let mut start = start();
        start.at = 1;
        let keys = binding.keys.iter();
        let wish = keys.filter_map(|key| start.on_key(*key)).last();
        assert!(start.pending.is_empty() && (wish.is_some() || start.at != 1), "{binding:?} is silent");
    }
}

#[test]
fn nothing_to_choose_from_is_no_fault() {
    let mut start = start();
    start.recent.clear();
    assert_eq!(press(&mut start, "k Enter"), Some(Wish::Follow(Lead::Folder(PathBuf::from(".")))));
    start.menu = Some(Menu::of_files(Listing::default()));
    assert_eq!(press(&mut start, "Down Up Enter"), None);
}

#[test]
fn a_text_is_read_and_left() {
    let mut start = start();
    start.page = Some(("doctor".to_owned(), vec!["one".to_owned(), "two".to_owned()], 0));
    press(&mut start, "j j j");
    assert_eq!(start.page.as_ref().unwrap().2, 1, "it ends with its last line");
    assert_eq!(press(&mut start, "q"), None);
    assert_eq!((start.page.is_none(), start.at), (true, 0));
}

#[test]
fn a_click_opens_the_row_under_the_mouse() {
    let click =
        |start: &mut Start, row: u16| start.on_mouse(Mouse { kind: MouseKind::Press(0), column: 10, row });
    let mut small = start();
    small.size = (40, 7);
    small.at = 5;
    for (mut start, row, wish) in [
        (start(), 0, None),
        (start(), 2, Some(Wish::Open(PathBuf::from("/data/2026/malva.honami")))),
        (start(), 6, Some(Wish::Offer(0))),
        (start(), 8, None),
        // Two rows are shown: the last.
        (small, 2, Some(Wish::Offer(0))),
    ] {
        assert_eq!(click(&mut start, row), wish, "row {row}");
    }
    let mut start = start();
    start.menu = Some(Menu::of_files(listing()));
    let lead = Lead::File(PathBuf::from("/data/malva.honami"));
    // The list lies at the bottom: its head, and two rows.
    assert_eq!(click(&mut start, 19), Some(Wish::Follow(lead)));
    assert_eq!(click(&mut start, 18), None);
}

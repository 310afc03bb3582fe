//! What is kept of the projects opened lately.

use super::*;

fn recent(path: &str, n_tracks: usize, when_s: u64) -> Recent {
    Recent { path: PathBuf::from(path), n_tracks, n_open: n_tracks.checked_sub(7), when_s }
}

#[test]
fn the_list_is_written_and_read_newest_first_and_without_doubles() {
    let mut text = String::new();
    for (path, n_tracks, when_s) in
        [("/a/malva.honami", 0, 1), ("/b/a tab\there.honami", 7, 2), ("/a/malva.honami", 135, 3)]
    {
        text = after(of(&text), recent(path, n_tracks, when_s));
    }
    assert_eq!(of(&text), [recent("/a/malva.honami", 135, 3), recent("/b/a tab\there.honami", 7, 2)]);
}

#[test]
fn a_line_without_what_is_to_be_reviewed_is_read_too() {
    let old = Recent { n_open: None, ..recent("/a.honami", 135, 3) };
    assert_eq!(of("3\t135\t/a.honami\n"), std::slice::from_ref(&old));
    assert_eq!(after(Vec::new(), old), "3\t135\t/a.honami\n");
}

#[test]
fn it_is_bounded_and_takes_no_nonsense() {
    let mut text = "no line\n1\t2\n1\t2\trelative.honami\nx\t2\t/a\n1\t2/x\t/a\n".to_owned();
    assert_eq!(of(&text), []);
    for n in 0..100 {
        text = after(of(&text), recent(&format!("/{n}.honami"), 0, n));
    }
    text = after(of(&text), recent("/a\nb.honami", 0, 100));
    let list = of(&text);
    assert_eq!((list.len(), list[0].when_s), (N_MAX - 1, 99), "a name with a line break has no line");
}

#[test]
fn times_are_said_as_people_say_them() {
    let day = 86_400;
    for (ago_s, said) in [
        (0, "just now"),
        (61, "1 minute ago"),
        (3599, "59 minutes ago"),
        (7200, "2 hours ago"),
        (day, "yesterday"),
        (3 * day, "3 days ago"),
        (90 * day, "3 months ago"),
    ] {
        assert_eq!(recent("/a", 0, 0).ago(ago_s), said);
    }
    assert_eq!(recent("/a", 0, 10).ago(5), "just now", "a clock that was set back");
}

//! The decoder against a table of real sequences, at every split, and against garbage.

use proptest::prelude::*;

use super::*;

/// The one door: bytes in, events out, in words.
fn decode(chunks: &[&[u8]]) -> Vec<String> {
    let mut decoder = Decoder::default();
    let mut events = Vec::new();
    for chunk in chunks {
        decoder.feed(chunk, &mut events);
    }
    decoder.flush(&mut events);
    events.iter().map(word).collect()
}

fn word(event: &Event) -> String {
    match event {
        Event::Key(key) => key.to_string(),
        Event::Mouse(m) => format!("{:?}@{},{}", m.kind, m.column, m.row),
        other => format!("{other:?}"),
    }
}

const TABLE: &[(&[u8], &[&str])] = &[
    (b"aG ", &["a", "G", "space"]),
    ("é木".as_bytes(), &["é", "木"]),
    (b"\r\t\x7f\x12\x00", &["Enter", "Tab", "Backspace", "Ctrl-r", "Ctrl-space"]),
    (b"\x1b", &["Esc"]),
    (b"\x1b\x1b[A", &["Esc", "Up"]),
    (b"\x1bx\x1b[Z", &["Alt-x", "Shift-Tab"]),
    (b"\x1b[", &["Alt-["]),
    (b"\x1b[A\x1bOB\x1b[1;5C\x1b[3~\x1b[24~\x1bOP", &["Up", "Down", "Ctrl-Right", "Delete", "F12", "F1"]),
    (b"\x1b[27u\x1b[114;5u\x1b[27;5;46~", &["Esc", "Ctrl-r", "Ctrl-."]),
    (b"\x1b[1;2R\x1b[0n\x1b[?1u\x1b[I", &["Shift-F3", "Reply(Ready)"]),
    (b"\x1b[?62;;22c\x1b[>41;354;0c", &["Reply(Attributes([62, 1, 22]))"]),
    (b"\x1b[6;20;10t", &["Reply(CellSize { width: 10, height: 20 })"]),
    (b"\x1b[4;480;800tq", &["Reply(TextSize { width: 800, height: 480 })", "q"]),
    (b"\x1b[8;24;80tq", &["q"]),
    (b"\x1b_Gi=1;OK\x1b\\q", &["Reply(Graphics { is_ok: true })", "q"]),
    (b"\x1b_Gi=1;EINVAL:no\x1b\\", &["Reply(Graphics { is_ok: false })"]),
    (b"\x1b_Gno word\x1b\\q", &["q"]),
    (b"\x1bP1+r544e=666f6f\x1b\\\x1bP0+r544e\x1b\\q", &["Reply(Entry(\"foo\"))", "q"]),
    (b"\x1bP1+r544e=6\xc3\xb6\x1b\\\x1bP1+r436f=3\x1b\\q", &["q"]),
    // Keys between answers, and an Esc before one.
    (
        b"j\x1b[0nk\x1b\x1b[?2026;1$yl",
        &["j", "Reply(Ready)", "k", "Esc", "Reply(Mode { mode: 2026, state: 1 })", "l"],
    ),
    // A mouse of three bytes, and the Linux console's F1.
    (b"\x1b[M !!q\x1b[[Aq", &["q", "q"]),
    (b"\x1b[?2026;2$y", &["Reply(Mode { mode: 2026, state: 2 })"]),
    (b"\x1bP>|tmux 3.3a\x1b\\q", &["Reply(Version(\"tmux 3.3a\"))", "q"]),
    (b"\x1b]11;rgb:ffff/8080/0000\x07q", &["Reply(Background([255, 128, 0]))", "q"]),
    (b"\x1b]11;rgba:ff/8/0/f\x1b\\q", &["Reply(Background([255, 136, 0]))", "q"]),
    (b"\x1b]11;rgb:fffff/0/0\x07\x1b]11;rgb:/0/0\x07\x1b]10;rgb:0/0/0\x07q", &["q"]),
    (b"\x1b[<0;10;5M\x1b[<0;10;5m\x1b[<32;1;1M", &["Press(0)@9,4", "Release(0)@9,4", "Drag(0)@0,0"]),
    (b"\x1b[<35;9;9m\x1b[<64;3;3m\x1b[<2;1;1mq", &["Release(2)@0,0", "q"]),
    (b"\x1b[<64;3;3M\x1b[<65;3;3M\x1b[<35;2;2M", &["WheelUp@2,2", "WheelDown@2,2"]),
    (b"\x1b[200~a\x1b[Ab\x1b[201~c", &["Paste(\"a\\u{1b}[Ab\")", "c"]),
    (b"\x1b[200~never ended\x1b[20", &["Paste(\"never ended\")"]),
    (b"\xffa\xc3\x28", &["a", "("]),
    (b"\x1b[12\x1b[B", &["Down"]),
    (b"\x1b]0;title cut off\x1b[B", &["Down"]),
];

#[test]
fn every_sequence_at_every_split() {
    for (bytes, expect) in TABLE {
        assert_eq!(decode(&[bytes]), *expect, "{:?}", String::from_utf8_lossy(bytes));
        for at in 1..bytes.len() {
            let (a, b) = bytes.split_at(at);
            assert_eq!(decode(&[a, b]), *expect, "{:?} split at {at}", String::from_utf8_lossy(bytes));
        }
    }
}

#[test]
fn endless_strings_neither_grow_nor_swallow_what_follows() {
    let mut decoder = Decoder::default();
    let mut events = Vec::new();
    decoder.feed(b"\x1bP", &mut events);
    for _ in 0..1000 {
        decoder.feed(&[b'x'; 999], &mut events);
        assert!(decoder.pending.len() <= STRING_MAX);
    }
    decoder.feed(b"\x1b\\q", &mut events);
    assert_eq!(events.iter().map(word).collect::<Vec<_>>(), ["q"]);
}

#[test]
fn a_long_paste_is_cut_and_an_endless_one_can_be_ended() {
    let mut decoder = Decoder::default();
    let mut events = Vec::new();
    decoder.feed(b"\x1b[200~", &mut events);
    for _ in 0..1000 {
        decoder.feed(&[b'x'; 999], &mut events);
        assert_eq!(decoder.unfinished(), Some(Unfinished::Paste));
    }
    assert_eq!(events, []);
    decoder.flush(&mut events);
    decoder.feed(b"q", &mut events);
    assert_eq!(events, [Event::Paste("x".repeat(PASTE_MAX)), Event::Key(Key::plain(Code::Char('q')))]);
    assert_eq!(decoder.unfinished(), None);
}

#[test]
fn what_was_cut_off_takes_no_key_for_ever() {
    for cut in [&b"\x1b[?62;"[..], b"\x1b]11;rgb:ff", b"\x1b_Gi=1;O", b"\x1bP>|tm", b"\x1b[M!", b"\x1b[200"] {
        let (mut decoder, mut events) = (Decoder::default(), Vec::new());
        decoder.feed(b"a", &mut events);
        decoder.feed(cut, &mut events);
        let unfinished = decoder.unfinished();
        assert!(matches!(unfinished, Some(Unfinished::Sequence(_))), "{cut:?}: {unfinished:?}");
        decoder.flush(&mut events);
        decoder.feed(b"q", &mut events);
        assert_eq!(events.iter().map(word).collect::<Vec<_>>(), ["a", "q"], "{cut:?}");
        assert_eq!(decoder.unfinished(), None);
    }
}

#[test]
fn half_a_sequence_stays_the_same_while_it_grows() {
    let (mut decoder, mut events) = (Decoder::default(), Vec::new());
    decoder.feed(b"ab\x1b]11;", &mut events);
    let first = decoder.unfinished();
    decoder.feed(&[b'x'; 3 * STRING_MAX], &mut events);
    assert_eq!(decoder.unfinished(), first);
    decoder.feed(b"\x07\x1b]12;", &mut events);
    assert_ne!(decoder.unfinished(), first);
}

proptest! {
    #[test]
    fn whatever_came_before_a_key_comes_after_it_is_flushed(
        garbage in prop::collection::vec(
            prop_oneof![any::<u8>(), Just(0x1b), Just(b'['), Just(b']'), Just(b'P'), Just(b'_'), Just(b';')],
            0..64,
        ),
    ) {
        let (mut decoder, mut events) = (Decoder::default(), Vec::new());
        decoder.feed(&garbage, &mut events);
        prop_assert!(decoder.pending.len() <= STRING_MAX);
        while decoder.unfinished().is_some() {
            decoder.flush(&mut events);
        }
        events.clear();
        decoder.feed(b"q", &mut events);
        prop_assert_eq!(events.last().map(word), Some("q".to_owned()));
    }

    #[test]
    fn splits_change_nothing(
        pieces in prop::collection::vec(
            prop_oneof![
                (0..TABLE.len()).prop_map(|i| TABLE[i].0.to_vec()),
                prop::collection::vec(any::<u8>(), 0..12),
            ],
            0..12,
        ),
        cuts in prop::collection::vec(0.0..1.0, 0..12),
    ) {
        let bytes: Vec<u8> = pieces.concat();
        let mut at: Vec<usize> = cuts.iter().map(|c: &f64| (c * bytes.len() as f64) as usize).collect();
        at.extend([0, bytes.len()]);
        at.sort_unstable();
        let chunks: Vec<&[u8]> = at.windows(2).map(|w| &bytes[w[0]..w[1]]).collect();
        prop_assert_eq!(decode(&chunks), decode(&[&bytes]));
    }
}

//! What is learnt from the answers of real terminals, in every order and at every split.

use super::*;
use crate::term::input::{Decoder, Event};

/// What one terminal answers, and what follows from it on 80x24 cells.
struct Case {
    name: &'static str,
    around: Around,
    answers: &'static [&'static [u8]],
    pixels: Option<Pixels>,
    synchronizes: bool,
    is_light: bool,
}

const KITTY_OK: &[u8] = b"\x1b_Gi=1;OK\x1b\\";
const CELL_10X20: &[u8] = b"\x1b[6;20;10t";
const DARK: &[u8] = b"\x1b]11;rgb:1e1e/1e1e/2e2e\x1b\\";
const LIGHT: &[u8] = b"\x1b]11;rgb:ff/ff/dd\x07";
const SYNC: &[u8] = b"\x1b[?2026;2$y";
const NO_SYNC: &[u8] = b"\x1b[?2026;0$y";
const SIXEL_10X20: Option<Pixels> = Some(Pixels::Sixel { cell_px: (10, 20) });

const CASES: &[Case] = &[
    Case {
        name: "kitty",
        around: Around::Nothing,
        answers: &[b"\x1bP>|kitty(0.35.2)\x1b\\", SYNC, KITTY_OK, CELL_10X20, DARK, b"\x1b[?62;52;c"],
        pixels: Some(Pixels::Kitty),
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "WezTerm",
        around: Around::Nothing,
        answers: &[
            b"\x1bP>|WezTerm 20240203-110809-5046fc22\x1b\\",
            SYNC,
            KITTY_OK,
            CELL_10X20,
            DARK,
            b"\x1b[?65;4;6;18;22c",
        ],
        pixels: Some(Pixels::Iterm { in_parts: false }),
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "iTerm2 3.5",
        around: Around::Nothing,
        answers: &[b"\x1bP>|iTerm2 3.5.10\x1b\\", SYNC, CELL_10X20, LIGHT, b"\x1b[?64;1;2;4;6;17;18;21;22c"],
        pixels: Some(Pixels::Iterm { in_parts: true }),
        synchronizes: true,
        is_light: true,
    },
    Case {
        name: "iTerm2 3.4",
        around: Around::Nothing,
        answers: &[b"\x1bP>|iTerm2 3.4.23\x1b\\", SYNC, b"\x1b[?62;4c"],
        pixels: Some(Pixels::Iterm { in_parts: false }),
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "foot",
        around: Around::Nothing,
        answers: &[b"\x1bP>|foot(1.16.2)\x1b\\", SYNC, CELL_10X20, DARK, b"\x1b[?62;4;22c"],
        pixels: SIXEL_10X20,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "Ghostty: 22 is colour, not sixel, but it speaks kitty's protocol",
        around: Around::Nothing,
        answers: &[b"\x1bP>|ghostty 1.1.3\x1b\\", SYNC, KITTY_OK, CELL_10X20, DARK, b"\x1b[?62;22c"],
        pixels: Some(Pixels::Kitty),
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "22 alone is no sixel",
        around: Around::Nothing,
        answers: &[CELL_10X20, b"\x1b[?62;22c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "4 as the class is no sixel",
        around: Around::Nothing,
        answers: &[CELL_10X20, b"\x1b[?4;6c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "xterm without sixel",
        around: Around::Nothing,
        answers: &[
            b"\x1bP>|XTerm(390)\x1b\\",
            NO_SYNC,
            b"\x1b]11;rgb:ffff/ffff/ffff\x1b\\",
            b"\x1b[?64;1;2;6;9;15;16;17;18;21;22;28c",
        ],
        pixels: None,
        synchronizes: false,
        is_light: true,
    },
    Case {
        name: "xterm as VT340, which tells only the size of everything",
        around: Around::Nothing,
        answers: &[b"\x1bP>|XTerm(379)\x1b\\", NO_SYNC, b"\x1b[4;480;800t", b"\x1b[?63;1;2;4;6;9;15;16;22c"],
        pixels: SIXEL_10X20,
        synchronizes: false,
        is_light: false,
    },
    Case {
        name: "mintty",
        around: Around::Nothing,
        answers: &[b"\x1bP>|mintty 3.6.4\x1b\\", SYNC, CELL_10X20, b"\x1b[?64;1;2;4;6;9;11;15;21;22;28;29c"],
        pixels: Some(Pixels::Iterm { in_parts: false }),
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "Windows Terminal 1.22, which does not say its name",
        around: Around::Nothing,
        answers: &[SYNC, CELL_10X20, DARK, b"\x1b[?61;4;6;7;14;21;22;23;24;28;32;42;52c"],
        pixels: SIXEL_10X20,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "Windows Terminal before pixels",
        around: Around::Nothing,
        answers: &[b"\x1b[?61;6;7;22;23;24;28;32;42c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "tmux 3.3a without passthrough",
        around: Around::Tmux,
        answers: &[b"\x1bP>|tmux 3.3a\x1b\\", b"\x1b[?1;2c"],
        pixels: None,
        synchronizes: false,
        is_light: false,
    },
    Case {
        name: "tmux 3.7b in kitty, with passthrough",
        around: Around::Tmux,
        answers: &[
            b"\x1bP>|tmux 3.7b\x1b\\",
            SYNC,
            CELL_10X20,
            b"\x1b[?1;2;4c",
            KITTY_OK,
            b"\x1bP1+r544E=787465726D2D6B69747479\x1b\\",
        ],
        pixels: Some(Pixels::KittyInTmux),
        synchronizes: false,
        is_light: false,
    },
    Case {
        name: "tmux 3.8 in WezTerm, with passthrough: it cannot place by characters",
        around: Around::Tmux,
        answers: &[
            b"\x1bP>|tmux 3.8\x1b\\",
            SYNC,
            b"\x1b[?1;2c",
            KITTY_OK,
            b"\x1bP1+r544E=77657A7465726D\x1b\\",
        ],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "tmux with sixel, behind a TERM that does not tell of it",
        around: Around::Nothing,
        answers: &[b"\x1bP>|tmux 3.4\x1b\\", CELL_10X20, b"\x1b[?1;2;4c"],
        pixels: None,
        synchronizes: false,
        is_light: false,
    },
    Case {
        name: "mosh answers for itself, and shows no pictures",
        around: Around::Nothing,
        answers: &[b"\x1b[?62c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "GNU screen",
        around: Around::Screen,
        answers: &[CELL_10X20, b"\x1b[?1;2;4c"],
        pixels: None,
        synchronizes: false,
        is_light: false,
    },
    Case {
        name: "silence",
        around: Around::Nothing,
        answers: &[],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "a name, but no answer to what everybody answers",
        around: Around::Nothing,
        answers: &[b"\x1bP>|kitty(0.35.2)\x1b\\", KITTY_OK],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "sixel, but cells of no believable size",
        around: Around::Nothing,
        answers: &[b"\x1b[6;0;65535t", b"\x1b[4;1;1t", b"\x1b[?62;4c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
    Case {
        name: "kitty's protocol refused",
        around: Around::Nothing,
        answers: &[b"\x1b_Gi=1;ENOTSUPPORTED:no\x1b\\", b"\x1b[?62;c"],
        pixels: None,
        synchronizes: true,
        is_light: false,
    },
];

/// What is known after some chunks; asserts that none of them was taken for a key.
fn learnt(around: Around, chunks: &[&[u8]]) -> Capabilities {
    let mut capabilities = Capabilities::new(around);
    let (mut decoder, mut events) = (Decoder::default(), Vec::new());
    chunks.iter().for_each(|chunk| decoder.feed(chunk, &mut events));
    for event in &events {
        match event {
            Event::Reply(reply) => capabilities.learn(reply),
            other => panic!("an answer was taken for {other:?}"),
        }
    }
    assert_eq!(decoder.unfinished(), None);
    capabilities
}

#[track_caller]
fn check(case: &Case, capabilities: &Capabilities) {
    let seen = (capabilities.pixels((80, 24)), capabilities.synchronizes(), capabilities.is_light());
    assert_eq!(seen, (case.pixels, case.synchronizes, case.is_light), "{}", case.name);
}

#[test]
fn real_terminals_in_every_order() {
    for case in CASES {
        let mut answers = case.answers.to_vec();
        for _ in 0..answers.len().max(1) {
            check(case, &learnt(case.around, &answers));
            answers.reverse();
            check(case, &learnt(case.around, &answers));
            answers.reverse();
            let n = answers.len().min(1);
            answers.rotate_left(n);
        }
    }
}

#[test]
fn answers_split_anywhere() {
    for case in CASES {
        let bytes = case.answers.concat();
        for at in 0..=bytes.len() {
            let (a, b) = bytes.split_at(at);
            check(case, &learnt(case.around, &[a, b]));
        }
    }
}

#[test]
fn what_everybody_answers_is_asked_last() {
    for around in [Around::Nothing, Around::Tmux, Around::Screen] {
        let questions = Capabilities::new(around).questions();
        assert!(questions.starts_with(ASK) && questions.ends_with(b"\x1b[c"), "{around:?}");
        let text = String::from_utf8(questions).unwrap();
        assert_eq!(text.contains("\x1bPtmux;"), around == Around::Tmux);
        assert_eq!(text.matches("a=q").count(), usize::from(around != Around::Screen));
    }
}

#[test]
fn what_stands_around() {
    let around = |set: &[(&str, &str)]| {
        Around::from_env(|k| set.iter().find(|(name, _)| *name == k).map(|(_, v)| (*v).to_owned()))
    };
    assert_eq!(around(&[("TERM", "xterm-256color")]), Around::Nothing);
    assert_eq!(around(&[("TERM", "tmux-256color")]), Around::Tmux);
    assert_eq!(around(&[("TERM", "screen-256color"), ("TMUX", "/tmp/t,1,0")]), Around::Tmux);
    assert_eq!(around(&[("TERM", "screen")]), Around::Screen);
}

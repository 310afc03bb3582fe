//! Terminals that can show pixels, that answer late, and that lie.

use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;

use super::{PATIENCE, STATUS, Terminal, folder};

const KITTY: &[(&[u8], &[u8])] = &[
    STATUS,
    (b"\x1b[>q", b"\x1bP>|kitty(0.35.2)\x1b\\"),
    (b"\x1b_Gi=1,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", b"\x1b_Gi=1;OK\x1b\\"),
    (b"\x1b[16t", b"\x1b[6;20;10t"),
    (b"\x1b[c", b"\x1b[?62;52;c"),
];
const ITERM: &[(&[u8], &[u8])] = &[
    STATUS,
    (b"\x1b[>q", b"\x1bP>|iTerm2 3.5.10\x1b\\"),
    (b"\x1b[16t", b"\x1b[6;20;10t"),
    (b"\x1b[c", b"\x1b[?64;1;2;4;6;17;18;21;22c"),
];

/// honami on a terminal that answers so.
fn honami(folder: &std::path::Path, answers: &[(&'static [u8], &'static [u8])]) -> Terminal {
    let mut terminal = Terminal::honami(folder, (80, 24), false);
    terminal.answers = answers.to_vec();
    terminal
}

/// The picture in the pieces that follow a beginning, each between `begin` and `end`.
fn picture(seen: &[u8], begin: &str, end: &str) -> image::RgbImage {
    let text = String::from_utf8_lossy(seen);
    let parts = text.split(begin).skip(1).filter_map(|rest| rest.split(end).next());
    let file: String = parts.map(|part| part.rsplit(';').next().unwrap()).collect();
    image::load_from_memory(&BASE64.decode(file).unwrap()).unwrap().into_rgb8()
}

#[test]
fn a_paused_picture_becomes_pixels_and_a_key_takes_them_away() {
    let folder = folder();
    let mut terminal = honami(folder.path(), KITTY);
    terminal.wait_for_text("0/11");
    let begun = terminal.wait_for_bytes(0, "a=T,f=100,i=");
    let whole = terminal.wait_for_bytes(begun, "m=0");
    let whole = terminal.wait_for_bytes(whole, "\x1b\\");
    // The clip's square, 16,24 of 64x48, where it is shown: bright in the middle, dark at the edge.
    let still = picture(&terminal.seen[begun - "\x1b_Ga=T,f=100,i=".len()..whole], "\x1b_G", "\x1b\\");
    let at = |x: u32, y: u32| still[(still.width() * x / 64, still.height() * y / 48)].0;
    assert_eq!((at(16, 24), at(60, 4)), ([255; 3], [0; 3]), "{}x{}", still.width(), still.height());
    terminal.press(".");
    let gone = terminal.wait_for_bytes(whole, "\x1b_Ga=d,d=I,i=");
    terminal.wait_for_text("1/11");
    // Without pixels from now on: the next one comes only when they are wanted again.
    let again = terminal.wait_for_bytes(gone, "a=T,f=100,i=");
    terminal.press("vs");
    terminal.wait_for_text("stills off");
    terminal.wait_for_bytes(again, "\x1b_Ga=d,d=I,i=");
    terminal.press("vs");
    terminal.wait_for_text("stills on: a picture that stays is shown by PNG");
    let back = terminal.seen.len();
    terminal.wait_for_bytes(back, "a=T,f=100,i=");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn jpeg_in_parts_is_the_picture_too_and_is_sent_once() {
    let folder = folder();
    let mut terminal = honami(folder.path(), ITERM);
    let begun = terminal.wait_for_bytes(0, "MultipartFile=");
    let whole = terminal.wait_for_bytes(begun, "FileEnd");
    let still = picture(&terminal.seen[begun..whole], "FilePart=", "\x07");
    let middle = still[(still.width() / 4, still.height() / 2)].0;
    assert!(middle.iter().all(|&c| c > 240), "{middle:?}");
    // It is there once, and then nothing is sent.
    let until = Instant::now() + PATIENCE;
    while terminal.listen(Duration::from_millis(2500)).0 {
        assert!(Instant::now() < until, "it never falls silent");
    }
    let seen = String::from_utf8_lossy(&terminal.seen).into_owned();
    let stills =
        seen.split("MultipartFile=").skip(1).map(|still| picture(still.as_bytes(), "FilePart=", "\x07"));
    let mut stills: Vec<Vec<u8>> = stills.map(image::RgbImage::into_raw).collect();
    let n_sent = stills.len();
    stills.dedup();
    assert_eq!(stills.len(), n_sent, "a picture was sent twice");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn nothing_waits_for_answers_and_late_ones_count() {
    let folder = folder();
    let mut terminal = honami(folder.path(), KITTY);
    terminal.held = Some(Vec::new());
    terminal.wait_for("the first frame", |s| s.contents().contains("0/11") && s.contents().contains('▀'));
    terminal.press("5.");
    terminal.wait_for_text("5/11");
    assert!(!terminal.held.as_ref().unwrap().is_empty(), "it has asked");
    let late = terminal.held.take().unwrap();
    // In the middle of a command, one byte after the other.
    terminal.press("3");
    late.iter().for_each(|byte| terminal.press(std::str::from_utf8(&[*byte]).unwrap()));
    terminal.press(".");
    terminal.wait_for_text("8/11");
    let now = terminal.seen.len();
    terminal.wait_for_bytes(now, "a=T,f=100,i=");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn lies_and_garbage_are_no_keys() {
    let folder = folder();
    let lies: &[(&[u8], &[u8])] = &[
        STATUS,
        (b"\x1b[>q", b"\x1bP>|q dd q\x1b\\\x1bPqqq\x1b\\"),
        (b"\x1b[?2026$p", b"\x1b[?2026;999999999999$y\x1b[?q"),
        (b"\x1b[16t", b"\x1b[6;0;65535t\x1b[6;t"),
        (b"\x1b[14t", b"\x1b[4;1;1t"),
        (b"\x1b]11;?\x1b\\", b"\x1b]11;rgb:qqqq/dd/q\x1b\\"),
        (b"\x1b_Gi=1,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", b"\x1b_Gi=1;EQUIT q\x1b\\\x1b_qqq\x1b\\"),
        (b"\x1b[c", b"\x1b[?62;4;;;4c\x1b[?c\x1b[>0;q"),
    ];
    let mut terminal = honami(folder.path(), lies);
    terminal.wait_for_text("0/11");
    terminal.press("3\x1b[0n\x1b[?62;4c.\x1b[0n\x1b[0n");
    terminal.wait_for_text("3/11");
    // An answer that was cut off takes the keys of a moment, and no more.
    terminal.press("\x1b]11;rgb:ff");
    terminal.press("\x1b[C");
    terminal.wait_for_text("4/11");
    assert!(!String::from_utf8_lossy(&terminal.seen).contains("\x1bP0;1;0q"), "no sixel without a size");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

//! Each protocol's bytes, read back by somebody who did not write them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;

use super::*;

const ROOMY: Room = Room { in_all: 1 << 20, at_once: 1 << 20 };
const AREA: Rect = Rect { x: 3, y: 2, width: 8, height: 4 };

/// Leaves: waves with noise on them.
fn picture(width: u32, height: u32) -> Pixmap {
    let mut noise = 1_u32;
    let mut pixel = |x: u32, y: u32| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let wave = (x as f32 * 0.2).sin() * (y as f32 * 0.15).cos();
        let v = 120.0 + 80.0 * wave + f32::from((noise >> 24) as u8 % 16);
        [(v * 0.6) as u8, v as u8, (v * 0.4) as u8]
    };
    let pixels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    Pixmap { width, height, pixels }
}

/// Peak signal to noise ratio, dB.
fn psnr(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let squares: f64 =
        a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| f64::from(x.abs_diff(*y)).powi(2)).sum();
    10.0 * (255.0_f64.powi(2) / (squares / (3 * a.len()) as f64).max(1e-9)).log10()
}

/// What an image library sees in a file.
fn read(file: &[u8]) -> Pixmap {
    let image = image::load_from_memory(file).unwrap().into_rgb8();
    Pixmap { width: image.width(), height: image.height(), pixels: image.pixels().map(|p| p.0).collect() }
}

fn text(piece: &[u8]) -> &str {
    std::str::from_utf8(piece).unwrap()
}

/// What stands between a beginning and an end.
fn inside<'a>(piece: &'a str, begin: &str, end: &str) -> &'a str {
    let rest = piece.strip_prefix(begin).unwrap_or_else(|| panic!("{piece:?} does not begin with {begin:?}"));
    rest.strip_suffix(end).unwrap_or_else(|| panic!("{piece:?} does not end with {end:?}"))
}

#[test]
fn jpeg_in_one_sequence() {
    let picture = picture(64, 64);
    let still = make(Pixels::Iterm { in_parts: false }, AREA, &picture, ROOMY).unwrap();
    assert_eq!((still.pieces.len(), still.replaces), (1, true));
    let body = inside(text(&still.pieces[0]), "\x1b[3;4H\x1b]1337;File=", "\x07");
    let (how, file) = body.split_once(':').unwrap();
    let file = BASE64.decode(file).unwrap();
    let wanted = "width=8;height=4;preserveAspectRatio=0;doNotMoveCursor=1";
    assert_eq!(how, format!("inline=1;size={};{wanted}", file.len()));
    let shown = read(&file);
    assert_eq!((shown.width, shown.height), (64, 64));
    assert!(psnr(&shown.pixels, &picture.pixels) > 28.0, "{} dB", psnr(&shown.pixels, &picture.pixels));
}

#[test]
fn jpeg_in_parts() {
    let picture = picture(320, 180);
    let still =
        make(Pixels::Iterm { in_parts: true }, AREA, &picture, Room { at_once: 10, ..ROOMY }).unwrap();
    let n = still.pieces.len();
    assert!(n > 4 && still.pieces.iter().all(|piece| piece.len() <= PIECE_MAX));
    inside(text(&still.pieces[0]), "\x1b[3;4H\x1b]1337;MultipartFile=inline=1;", "\x07");
    assert_eq!(text(&still.pieces[n - 1]), "\x1b[3;4H\x1b]1337;FileEnd\x07");
    assert_eq!(still.stop, still.pieces[n - 1]);
    let parts = still.pieces[1..n - 1].iter();
    let file: String = parts.map(|piece| inside(text(piece), "\x1b]1337;FilePart=", "\x07")).collect();
    assert!(psnr(&read(&BASE64.decode(file).unwrap()).pixels, &picture.pixels) > 28.0);
}

/// The file in the sequences of kitty's protocol, whose grammar is checked.
fn kitty_file(sequences: &[&str], place: &str) -> Vec<u8> {
    let mut file = String::new();
    for (i, sequence) in sequences.iter().enumerate() {
        let (keys, part) = inside(sequence, "\x1b_G", "\x1b\\").split_once(';').unwrap();
        let more = u8::from(i + 1 < sequences.len());
        let id = 0x68_0000 | std::process::id() & 0xffff;
        let expect = match i {
            0 => format!("a=T,f=100,i={id},p=1,{place},q=2,m={more}"),
            _ => format!("m={more},q=2"),
        };
        assert_eq!(keys, expect);
        assert!(part.len() <= 4096 && (more == 0 || part.len() % 4 == 0), "{} bytes", part.len());
        file.push_str(part);
    }
    BASE64.decode(file).unwrap()
}

#[test]
fn png_straight() {
    let picture = picture(64, 48);
    let still = make(Pixels::Kitty, AREA, &picture, ROOMY).unwrap();
    assert!(!still.replaces && still.pieces.iter().all(|piece| piece.len() <= PIECE_MAX));
    // The cursor is set before the first piece, and before the last, with which the picture appears.
    let n = still.pieces.len();
    assert!(n > 1);
    let go = "\x1b[3;4H";
    let sequences: Vec<&str> = still.pieces.iter().map(|piece| text(piece)).collect();
    assert!(sequences[0].starts_with(go) && sequences[n - 1].starts_with(go));
    let sequences: Vec<&str> = sequences.iter().map(|s| s.strip_prefix(go).unwrap_or(s)).collect();
    assert_eq!(read(&kitty_file(&sequences, "c=8,r=4,z=1,C=1")), picture, "in all its colours");
    let remove = text(&still.remove);
    assert!(remove.starts_with("\x1b_Ga=d,d=I,i="), "{remove:?}");
    assert_eq!(text(&still.stop), format!("\x1b_Gm=0,q=2;\x1b\\{remove}"));
}

#[test]
fn png_through_tmux() {
    let picture = picture(64, 48);
    let still = make(Pixels::KittyInTmux, AREA, &picture, ROOMY).unwrap();
    assert!(still.replaces && still.pieces.iter().all(|piece| piece.len() <= PIECE_MAX));
    let (wrapped, placed): (Vec<&str>, Vec<&str>) =
        still.pieces.iter().map(|piece| text(piece)).partition(|piece| piece.starts_with("\x1bP"));
    let sequences: Vec<String> = wrapped
        .iter()
        .map(|piece| inside(piece, "\x1bPtmux;", "\x1b\\").replace("\x1b\x1b", "\x1b"))
        .collect();
    let sequences: Vec<&str> = sequences.iter().map(String::as_str).collect();
    assert_eq!(read(&kitty_file(&sequences, "U=1,c=8,r=4")), picture);
    // A terminal sees placeholders in exactly those cells, each row with its mark, in the colour of the number.
    let mut emulator = vt100::Parser::new(24.try_into().unwrap(), 80.try_into().unwrap(), 0);
    emulator.process(placed.concat().as_bytes());
    let [_, r, g, b] = (0x68_0000 | std::process::id() & 0xffff).to_be_bytes();
    for y in 0..24 {
        for x in 0..80 {
            let cell = emulator.screen().cell(y, x).unwrap();
            assert_eq!(cell.contents().starts_with('\u{10eeee}'), AREA.contains((x, y).into()), "{x},{y}");
            if AREA.contains((x, y).into()) {
                assert_eq!(cell.fgcolor(), vt100::Color::Rgb(r, g, b));
            }
        }
    }
    let marks = ["\u{305}", "\u{30d}", "\u{30e}", "\u{310}"];
    for (y, mark) in (AREA.y..).zip(marks) {
        let first = emulator.screen().cell(y, AREA.x).unwrap().contents().to_owned();
        assert_eq!(first, format!("\u{10eeee}{mark}\u{305}"));
    }
}

/// A terminal's idea of sixel: paints one image at a place of a canvas.
fn paint_sixel(piece: &str, cell: (usize, usize), canvas: &mut [[u8; 3]], columns: usize) {
    let (place, image) = piece.split_once("\x1bP0;1;0q").unwrap();
    let (row, column) = inside(place, "\x1b[", "H").split_once(';').unwrap();
    let number = |s: &str| s.parse::<usize>().unwrap();
    let (left, mut top) = ((number(column) - 1) * cell.0, (number(row) - 1) * cell.1);
    let image = image.strip_suffix("\x1b\\").unwrap();
    let mut bytes = image.bytes().peekable();
    let (mut colours, mut colour, mut x) = (vec![[0_u8; 3]; 256], 0, left);
    while let Some(b) = bytes.next() {
        let mut numbers = || {
            let mut numbers = vec![0_usize];
            while let Some(d) = bytes.next_if(|b| b.is_ascii_digit() || *b == b';') {
                match d {
                    b';' => numbers.push(0),
                    _ => *numbers.last_mut().unwrap() = *numbers.last().unwrap() * 10 + usize::from(d - b'0'),
                }
            }
            numbers
        };
        let (n, six) = match b {
            b'"' => {
                numbers();
                continue;
            }
            b'#' => {
                match numbers()[..] {
                    [n, 2, r, g, b] => colours[n] = [r, g, b].map(|c| u8::try_from(c * 255 / 100).unwrap()),
                    [n] => colour = n,
                    ref other => panic!("{other:?}"),
                }
                continue;
            }
            b'$' => {
                x = left;
                continue;
            }
            b'-' => {
                (x, top) = (left, top + 6);
                continue;
            }
            b'!' => (numbers()[0], bytes.next().unwrap()),
            six => (1, six),
        };
        assert!((0x3f..0x7f).contains(&six), "{six:#x}");
        for x in x..x + n {
            for bit in (0..6).filter(|bit| (six - 0x3f) >> bit & 1 == 1) {
                canvas[(top + bit) * columns + x] = colours[colour];
            }
        }
        x += n;
    }
}

#[test]
fn sixel_in_tiles() {
    // Cells of 10 by 20: not a whole number of bands.
    let picture = picture(80, 80);
    let still = make(Pixels::Sixel { cell_px: (10, 20) }, AREA, &picture, ROOMY).unwrap();
    assert!(still.pieces.len() >= 4 && still.pieces.iter().all(|piece| piece.len() <= PIECE_MAX));
    let unpainted = [255, 0, 255];
    let (columns, rows) = (20 * 10, 10 * 20);
    let mut canvas = vec![unpainted; columns * rows];
    still.pieces.iter().for_each(|piece| paint_sixel(text(piece), (10, 20), &mut canvas, columns));
    let shown = |x: usize, y: usize| canvas[y * columns + x];
    let inside = |x: usize, y: usize| (30..110).contains(&x) && (40..120).contains(&y);
    for y in 0..rows {
        for x in 0..columns {
            assert_eq!(shown(x, y) != unpainted, inside(x, y), "pixel {x},{y}");
        }
    }
    let seen: Vec<[u8; 3]> =
        (40..120).flat_map(|y| (30..110).map(move |x| (x, y))).map(|(x, y)| shown(x, y)).collect();
    assert!(psnr(&seen, &picture.pixels) > 28.0, "{} dB", psnr(&seen, &picture.pixels));
}

#[test]
fn stills_fit_the_room_or_are_none() {
    let picture = picture(320, 180);
    let protocols = [
        Pixels::Iterm { in_parts: false },
        Pixels::Iterm { in_parts: true },
        Pixels::Kitty,
        Pixels::KittyInTmux,
        Pixels::Sixel { cell_px: (10, 20) },
    ];
    let area = Rect::new(0, 1, 32, 9);
    for pixels in protocols {
        let mut sizes = Vec::new();
        for in_all in [1 << 20, 60_000, 30_000, 12_000, 100] {
            let still = make(pixels, area, &picture, Room { in_all, at_once: in_all });
            let size = still.map(|still| still.pieces.iter().map(Vec::len).sum::<usize>());
            // What stands around the data comes on top: a tenth, and the placeholders.
            assert!(
                size.is_none_or(|n| n <= in_all + in_all / 10 + 2000),
                "{pixels:?}: {size:?} in {in_all}"
            );
            sizes.push(size);
        }
        eprintln!("{pixels:?}: {sizes:?}");
        assert!(sizes[0].is_some() && sizes[4].is_none(), "{pixels:?}: {sizes:?}");
    }
    let cut = make(Pixels::Iterm { in_parts: false }, area, &picture, Room { at_once: 100, ..ROOMY });
    assert_eq!(cut, None, "a picture that cannot be cut must fit into what may be on its way");
}

#[test]
fn few_colours_are_kept_exactly() {
    let pixels: Vec<[u8; 3]> =
        (0..64_u8).map(|i| [[0, 0, 0], [255, 0, 0], [16, 200, 99]][usize::from(i % 3)]).collect();
    let (colours, indices) = palette::palette(&pixels, 16);
    let shown: Vec<[u8; 3]> = indices.iter().map(|&i| colours[usize::from(i)]).collect();
    assert_eq!(shown, pixels);
    assert_eq!(colours.len(), 3);
    let (colours, _) = palette::palette(&picture(64, 64).pixels, 16);
    assert_eq!(colours.len(), 16);
}

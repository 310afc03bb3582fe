//! The encoder against a terminal emulator, cell by cell.

use std::num::NonZero;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use ratatui::style::{Modifier, Style};

use super::*;
use crate::term::colour::base_index;
use crate::term::glyph::Glyphs;

const ONE: NonZero<u16> = NonZero::new(1).unwrap();
/// Columns and rows of the screens.
const SIZES: [(u16, u16); 4] = [(24, 6), (18, 8), (24, 4), (7, 3)];
const N_CELLS: usize = 24 * 6;

/// What a test puts in a cell.
#[derive(Clone, Debug)]
enum Ink {
    Picture(&'static str, [u8; 3], [u8; 3]),
    Text(&'static str, Color, Color, Modifier),
}

fn ink() -> impl Strategy<Value = Ink> {
    let colour = prop_oneof![
        Just(Color::Reset),
        (0..=255_u8).prop_map(Color::Indexed),
        Just(Color::Cyan),
        any::<[u8; 3]>().prop_map(|[r, g, b]| Color::Rgb(r, g, b)),
    ];
    let modifier = prop_oneof![
        Just(Modifier::empty()),
        Just(Modifier::BOLD),
        Just(Modifier::BOLD | Modifier::REVERSED),
        Just(Modifier::DIM | Modifier::UNDERLINED),
    ];
    let glyph =
        prop_oneof![3 => Just(HALF_BLOCK), 1 => Just("▙"), 1 => Just("🬕"), 1 => Just("𜵝"), 1 => Just(" ")];
    let text = prop_oneof![Just("a"), Just("┃"), Just("木"), Just(" "), Just("◆")];
    prop_oneof![
        3 => (glyph, any::<[u8; 3]>(), any::<[u8; 3]>()).prop_map(|(g, a, b)| Ink::Picture(g, a, b)),
        2 => (text, colour.clone(), colour, modifier).prop_map(|(t, f, b, m)| Ink::Text(t, f, b, m)),
    ]
}

fn frame((columns, rows): (u16, u16), inks: &[Ink]) -> Frame {
    let mut frame = Frame::new(columns, rows);
    for (i, ink) in (0..columns * rows).zip(inks) {
        let (x, y) = (i % columns, i / columns);
        let covered = x > 0 && frame.cells[(x - 1, y)].cell_width() > 1;
        match *ink {
            _ if covered => {}
            Ink::Picture(glyph, [a, b, c], [d, e, f]) => {
                let style = Style::new().fg(Color::Rgb(a, b, c)).bg(Color::Rgb(d, e, f));
                frame.cells[(x, y)].set_symbol(glyph).set_style(style);
                frame.softness[usize::from(i)] = 1;
            }
            // A wide glyph does not fit into the last column.
            Ink::Text(t, ..) if x + 1 == columns && t.cell_width() > 1 => {}
            Ink::Text(t, f, b, m) => {
                frame.cells.set_string(x, y, t, Style::new().fg(f).bg(b).add_modifier(m));
            }
        }
    }
    frame
}

/// The emulator's word for one of our colours.
fn emulated(colour: Color) -> vt100::Color {
    match (colour, base_index(colour)) {
        (Color::Rgb(r, g, b), _) => vt100::Color::Rgb(r, g, b),
        (Color::Indexed(n), _) | (_, Some(n)) => vt100::Color::Idx(n),
        _ => vt100::Color::Default,
    }
}

/// Whether a terminal of this depth can show a cell's colours.
fn shows(depth: Depth, cell: &Cell) -> bool {
    [cell.fg, cell.bg].iter().all(|colour| match depth {
        Depth::True => true,
        Depth::Ansi256 => !matches!(colour, Color::Rgb(..)),
        Depth::Ansi16 => !matches!(colour, Color::Rgb(..) | Color::Indexed(16..)),
        Depth::Mono => *colour == Color::Reset,
    })
}

/// The two pixels that a cell of the emulator shows.
fn pixels_of(cell: &vt100::Cell) -> [vt100::Color; 2] {
    match cell.contents() {
        "▀" => [cell.fgcolor(), cell.bgcolor()],
        "▄" => [cell.bgcolor(), cell.fgcolor()],
        _ => [cell.bgcolor(); 2],
    }
}

/// Asserts that every cell of the emulator is the frame's.
fn assert_shows(screen: &vt100::Screen, frame: &Frame) {
    let mut covered = 0;
    for (i, cell) in frame.cells.content.iter().enumerate() {
        let (x, y) = frame.cells.pos_of(i);
        if covered > 0 {
            covered -= 1;
            continue;
        }
        covered = cell.cell_width().max(1) - 1;
        if cell.symbol() == UNKNOWN.symbol() {
            continue;
        }
        let there = screen.cell(y, x).unwrap();
        if let Some(wanted) = half(cell) {
            assert_eq!(
                pixels_of(there),
                wanted.map(|[r, g, b]| vt100::Color::Rgb(r, g, b)),
                "pixels at {x},{y}"
            );
            continue;
        }
        let glyph = if there.contents().is_empty() { " " } else { there.contents() };
        assert_eq!(glyph, cell.symbol(), "glyph at {x},{y}");
        // Of a blank nobody sees the foreground.
        if glyph != " " || cell.modifier.intersects(Modifier::UNDERLINED | Modifier::REVERSED) {
            assert_eq!(there.fgcolor(), emulated(cell.fg), "foreground of {glyph:?} at {x},{y}");
        }
        assert_eq!(there.bgcolor(), emulated(cell.bg), "background of {glyph:?} at {x},{y}");
        let attributes = [
            (there.bold(), Modifier::BOLD),
            (there.dim(), Modifier::DIM),
            (there.underline(), Modifier::UNDERLINED),
            (there.inverse(), Modifier::REVERSED),
        ];
        for (set, attribute) in attributes {
            assert_eq!(set, cell.modifier.contains(attribute), "{attribute:?} at {x},{y}");
        }
    }
}

/// One frame on the way, as during playing.
#[derive(Clone, Debug)]
struct Step {
    size: (u16, u16),
    inks: Vec<Ink>,
    budget: usize,
    moving: bool,
    /// What is covered before, as by a still.
    covered: Option<Rect>,
}

fn step() -> impl Strategy<Value = Step> {
    let halves = || (any::<[u8; 3]>(), any::<[u8; 3]>()).prop_map(|(a, b)| Ink::Picture(HALF_BLOCK, a, b));
    // As plants are: few colours, near each other.
    let leaf = |v: u8| [v / 2, v, v / 3];
    let leaves = (90..110_u8, 90..110_u8).prop_map(move |(a, b)| Ink::Picture(HALF_BLOCK, leaf(a), leaf(b)));
    let text = ink().prop_filter("text", |ink| matches!(ink, Ink::Text(..)));
    let cells = |ink: BoxedStrategy<Ink>| prop::collection::vec(ink, N_CELLS);
    let inks = prop_oneof![
        cells(ink().boxed()),
        cells(halves().boxed()),
        cells(leaves.clone().boxed()),
        cells(prop_oneof![4 => leaves, 1 => halves(), 1 => text].boxed()),
    ];
    let covered = (0..9_u16, 0..3_u16, 1..9_u16, 1..4_u16).prop_map(|(x, y, w, h)| Rect::new(x, y, w, h));
    (
        prop::sample::select(&SIZES[..]),
        inks,
        100_usize..3000,
        any::<bool>(),
        prop::option::weighted(0.2, covered),
    )
        .prop_map(|(size, inks, budget, moving, covered)| Step { size, inks, budget, moving, covered })
}

/// What the encoder takes the screen for, as a frame.
fn believed(encoder: &Encoder, frame: &Frame) -> Frame {
    let mut believed = frame.clone();
    believed.cells.content.clone_from(&encoder.shown);
    believed
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::with_cases(192) })]
    #[test]
    fn the_emulator_shows_what_was_wanted(
        steps in prop::collection::vec(step(), 1..6),
        depth in prop_oneof![5 => Just(Depth::True), 1 => Just(Depth::Ansi256), 1 => Just(Depth::Ansi16), 1 => Just(Depth::Mono)],
    ) {
        let mut emulator = vt100::Parser::new(ONE, ONE, 0);
        let mut encoder = Encoder::new(depth);
        for Step { size, inks, budget, moving, covered } in &steps {
            let frame = frame(*size, inks);
            emulator.screen_mut().set_size(size.1.try_into().unwrap(), size.0.try_into().unwrap());
            covered.iter().for_each(|area| encoder.cover(*area));
            let mut bytes = Vec::new();
            encoder.encode(&frame, *budget, *moving, &mut bytes);
            emulator.process(&bytes);
            let is_all_picture = frame.softness.iter().all(|&softness| softness > 0);
            prop_assert!(!is_all_picture || bytes.len() <= *budget, "{} of {budget} bytes", bytes.len());
            assert_shows(emulator.screen(), &believed(&encoder, &frame));
        }
        let Step { size, inks, budget, .. } = steps.last().unwrap();
        let last = frame(*size, inks);
        let mut n_paints = 0;
        loop {
            let mut bytes = Vec::new();
            let left = encoder.encode(&last, *budget, false, &mut bytes);
            emulator.process(&bytes);
            n_paints += 1;
            prop_assert!(n_paints < 500, "does not converge: {left} cells left");
            if left == 0 {
                break;
            }
        }
        let mut poorer = last.clone();
        poorer.cells.content = encoder.wanted(&last).into_owned();
        prop_assert!(poorer.cells.content.iter().all(|cell| shows(depth, cell)));
        assert_shows(emulator.screen(), &poorer);
        let mut nothing = Vec::new();
        prop_assert_eq!(encoder.encode(&last, *budget, false, &mut nothing), 0);
        prop_assert!(nothing.is_empty(), "an exact screen costs nothing");
    }
}

/// A leafy picture: noise on waves, moving with t.
fn leaves(glyphs: Glyphs, columns: u16, rows: u16, t: f32) -> Frame {
    let mut frame = Frame::new(columns, rows);
    let mut noise = 1_u32;
    let (across, down) = glyphs.grid();
    // In half blocks, as everywhere.
    let scale = (1.0 / across as f32, 2.0 / down as f32);
    let mut pixel = |x: u32, y: u32| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = (x as f32 * scale.0, y as f32 * scale.1);
        let wave = (0.7 * x + 3.0 * (0.2 * y + t).sin()).sin() * (0.5 * y + 2.0 * (0.1 * x - t).cos()).cos();
        let v = 90.0 + 70.0 * wave + f32::from((noise >> 24) as u8 % 9);
        [(v * 0.6) as u8, v as u8, (v * 0.4) as u8]
    };
    let colour = |[r, g, b]: [u8; 3]| Color::Rgb(r, g, b);
    for y in 0..rows {
        for x in 0..columns {
            let at = |i: u32| (u32::from(x) * across + i % across, u32::from(y) * down + i / across);
            let pixels: Vec<_> = (0..across * down).map(at).map(|(x, y)| (pixel(x, y), 1)).collect();
            let (symbol, fg, bg) = glyphs.fit(&pixels);
            let i = frame.cells.index_of(x, y);
            frame.cells.content[i].set_char(symbol).set_fg(colour(fg)).set_bg(colour(bg));
            frame.softness[i] = 1;
        }
    }
    frame
}

/// Peak signal to noise ratio of what an encoder's terminal shows, dB; cells that are no picture count as wrong.
fn psnr(encoder: &Encoder, frame: &Frame) -> f64 {
    let squares: u64 = encoder
        .shown
        .iter()
        .zip(&frame.cells.content)
        .map(|(a, b)| glyph::difference(a, b).map_or(6 * 255 * 255, |d| u64::from(d.squares)))
        .sum();
    let mean = squares as f64 / (6 * frame.cells.content.len()) as f64;
    10.0 * (255.0_f64.powi(2) / mean.max(1e-9)).log10()
}

#[test]
fn the_budget_holds_and_buys_the_worst_cells() {
    for (glyphs, least_db) in [(Glyphs::Halves, 33.0), (Glyphs::Quadrants, 27.0), (Glyphs::Octants, 27.0)] {
        let mut encoder = Encoder::new(Depth::True);
        let mut sizes = Vec::new();
        let mut quality = Vec::new();
        for k in 0..60_u8 {
            let frame = leaves(glyphs, 80, 20, f32::from(k) * 0.05);
            let mut bytes = Vec::new();
            encoder.encode(&frame, 8192, true, &mut bytes);
            if k >= 20 {
                sizes.push(bytes.len());
                quality.push(psnr(&encoder, &frame));
            }
        }
        let mean_db = quality.iter().sum::<f64>() / quality.len() as f64;
        let mean_size = sizes.iter().sum::<usize>() / sizes.len();
        eprintln!("8 kB frames in {glyphs}: {mean_size} bytes, {mean_db:.1} dB");
        assert!(sizes.iter().all(|&n| n <= 8192), "a frame exceeds its budget: {sizes:?}");
        assert!(mean_size > 7000, "the budget is not used: {mean_size}");
        assert!(mean_db > least_db, "{glyphs}: {mean_db} dB");
    }
}

#[test]
fn poor_terminals_get_what_they_can_show() {
    let frame = leaves(Glyphs::Halves, 8, 2, 0.0);
    for (depth, expect) in [(Depth::Ansi256, "38;5;"), (Depth::Mono, ""), (Depth::Ansi16, "\x1b[")] {
        let mut encoder = Encoder::new(depth);
        let mut bytes = Vec::new();
        assert_eq!(encoder.encode(&frame, 1 << 20, false, &mut bytes), 0);
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(expect) && !text.contains("8;2;"), "{depth:?}: {text:?}");
        assert!(depth != Depth::Mono || text.is_ascii(), "{text:?}");
    }
}

#[test]
fn without_colours_a_blank_is_as_bright_as_the_background() {
    let mut frame = Frame::new(2, 1);
    for (x, v) in [(0, 0), (1, 255)] {
        let colour = Color::Rgb(v, v, v);
        frame.cells[(x, 0)].set_symbol(HALF_BLOCK).set_fg(colour).set_bg(colour);
    }
    for (is_light, expect) in [(false, " @"), (true, "@ ")] {
        let mut encoder = Encoder::new(Depth::Mono);
        encoder.set_light(is_light);
        let symbols: String = encoder.wanted(&frame).iter().map(Cell::symbol).collect();
        assert_eq!(symbols, expect);
    }
}

#[test]
fn one_changed_letter_costs_a_few_bytes() {
    let mut encoder = Encoder::new(Depth::True);
    let mut frame = Frame::new(80, 24);
    frame.cells.set_string(0, 0, "frame 12", Style::new());
    encoder.encode(&frame, 8192, false, &mut Vec::new());
    frame.cells.set_string(0, 0, "frame 13", Style::new());
    let mut bytes = Vec::new();
    encoder.encode(&frame, 8192, false, &mut bytes);
    assert_eq!(bytes, b"\x1b[1;8H3");
}

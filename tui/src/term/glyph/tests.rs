//! Patterns against brute force, and differences against pixels.

use proptest::prelude::*;
use ratatui::style::Color;

use super::*;

/// The pixels that a cell shows on a grid of 2 by 12.
fn shown(symbol: char, fg: [u8; 3], bg: [u8; 3]) -> Vec<[u8; 3]> {
    let parts = covered(symbol.encode_utf8(&mut [0; 4])).unwrap();
    (0..N_PARTS).map(|i| if parts >> i & 1 == 1 { fg } else { bg }).collect()
}

/// The pixels of a grid on 2 by 12.
fn spread(pixels: &[([u8; 3], u8)], (across, down): (u32, u32)) -> Vec<[u8; 3]> {
    let at = |i: u32| (i / 2 * down / 12 * across + i % 2 * across / 2) as usize;
    (0..N_PARTS).map(|i| pixels[at(i)].0).collect()
}

fn squares(a: &[[u8; 3]], b: &[[u8; 3]]) -> u32 {
    a.iter().zip(b).map(|(a, b)| distance(*a, *b)).sum()
}

/// Least sum of squares over all ways to part the pixels in two kinds.
fn best(pixels: &[([u8; 3], u8)], grid: (u32, u32)) -> u32 {
    let target = spread(pixels, grid);
    (0..1_u16 << pixels.len())
        .map(|mask| {
            let (fg, bg) = (mean(pixels, mask), mean(pixels, !mask));
            let kinds = mask_of_bits(pixels, mask, fg, bg);
            squares(&spread(&kinds, grid), &target)
        })
        .min()
        .unwrap()
}

fn mask_of_bits(pixels: &[([u8; 3], u8)], mask: u16, fg: [u8; 3], bg: [u8; 3]) -> Vec<([u8; 3], u8)> {
    (0..pixels.len()).map(|i| (if mask >> i & 1 == 1 { fg } else { bg }, 1)).collect()
}

fn cell(symbol: char, fg: [u8; 3], bg: [u8; 3]) -> Cell {
    let mut cell = Cell::EMPTY;
    cell.set_char(symbol).set_fg(Color::Rgb(fg[0], fg[1], fg[2])).set_bg(Color::Rgb(bg[0], bg[1], bg[2]));
    cell
}

#[test]
fn two_colours_are_shown_exactly_in_every_pattern() {
    let (red, blue) = ([200, 10, 20], [10, 20, 220]);
    for glyphs in Glyphs::ALL {
        let (across, down) = glyphs.grid();
        for pattern in 0..1_u32 << (across * down) {
            let pixels: Vec<([u8; 3], u8)> =
                (0..across * down).map(|i| (if pattern >> i & 1 == 1 { red } else { blue }, 1)).collect();
            let (symbol, fg, bg) = glyphs.fit(&pixels);
            assert_eq!(shown(symbol, fg, bg), spread(&pixels, glyphs.grid()), "{glyphs:?} {pattern:b}");
        }
    }
}

#[test]
fn a_heavy_pixel_keeps_its_colour() {
    let mut pixels =
        vec![([100, 100, 100], 1), ([110, 105, 100], 1), ([95, 100, 100], 1), ([255, 60, 255], 8)];
    pixels[2].0 = [255, 255, 255];
    let (_, fg, bg) = Glyphs::Quadrants.fit(&pixels);
    assert!([fg, bg].iter().any(|c| distance(*c, [255, 60, 255]) < 3000), "{fg:?} {bg:?}");
}

#[test]
fn names_and_turns() {
    let mut glyphs = Glyphs::Halves;
    for expect in Glyphs::ALL {
        assert_eq!(glyphs, expect);
        assert_eq!(Glyphs::from_env(|_| Some(glyphs.name().to_owned())), Some(glyphs));
        glyphs = glyphs.next();
    }
    assert_eq!(glyphs, Glyphs::Halves);
    assert_eq!(Glyphs::from_env(|_| Some("hexagon".to_owned())), None);
}

#[test]
fn what_looks_alike_differs_by_nothing() {
    let (a, b) = ([1, 2, 3], [200, 100, 50]);
    for (x, y) in [
        (cell('▀', a, b), cell('▄', b, a)),
        (cell(' ', b, a), cell('▀', a, a)),
        (cell('█', a, b), cell(' ', b, a)),
        (cell('▌', a, b), cell('▐', b, a)),
    ] {
        assert_eq!(difference(&x, &y), Some(Difference { squares: 0, most: 0 }), "{x:?} {y:?}");
    }
    assert_eq!(difference(&cell('x', a, b), &cell('▀', a, b)), None);
    assert_eq!(difference(&Cell::EMPTY, &cell('▀', [0; 3], [0; 3])), None);
}

proptest! {
    #[test]
    fn fits_are_nearly_the_best(
        which in 1_usize..4,
        pixels in prop::collection::vec((any::<[u8; 3]>(), Just(1_u8)), 8),
    ) {
        let glyphs = Glyphs::ALL[which];
        let (across, down) = glyphs.grid();
        let pixels = &pixels[..(across * down) as usize];
        let (symbol, fg, bg) = glyphs.fit(pixels);
        let got = squares(&shown(symbol, fg, bg), &spread(pixels, glyphs.grid()));
        let least = best(pixels, glyphs.grid());
        // One colour for all would be worse than either.
        let flat = mean(pixels, u16::MAX);
        let plain = squares(&[flat; N_PARTS as usize], &spread(pixels, glyphs.grid()));
        prop_assert!(got <= plain + N_PARTS * 3, "{got} is worse than one colour, {plain}");
        prop_assert!(got <= 2 * least + plain / 4 + N_PARTS * 3, "{got}, best {least}, one colour {plain}");
    }

    #[test]
    fn differences_are_those_of_pixels(
        (a, b) in (any::<(u16, [u8; 3], [u8; 3])>(), any::<(u16, [u8; 3], [u8; 3])>()),
        tables in any::<(u8, u8)>(),
    ) {
        let symbol = |table: u8, n: u16| match table % 3 {
            0 => QUADRANTS[usize::from(n % 16)],
            1 => SEXTANTS[usize::from(n % 64)],
            _ => OCTANTS[usize::from(n % 256)],
        };
        let (sa, sb) = (symbol(tables.0, a.0), symbol(tables.1, b.0));
        let difference = difference(&cell(sa, a.1, a.2), &cell(sb, b.1, b.2)).unwrap();
        let (pa, pb) = (shown(sa, a.1, a.2), shown(sb, b.1, b.2));
        // Four roundings down.
        let exact = squares(&pa, &pb) / 12;
        prop_assert!((exact.saturating_sub(4)..=exact).contains(&difference.squares), "{difference:?} {exact}");
        let most = pa.iter().zip(&pb).flat_map(|(a, b)| a.iter().zip(b)).map(|(x, y)| x.abs_diff(*y)).max();
        prop_assert_eq!(Some(difference.most), most);
    }
}

//! Parts as they are drawn: what goes in is plant or not, what comes out is a letter a pixel.

use super::*;

fn parts(plant: &[&str], wish: &PartsWish) -> Parts {
    let (width, height) = (plant[0].len() as u32, plant.len() as u32);
    let alpha = plant.concat().bytes().map(|b| if b == b'#' { 0.5 } else { 0.49 }).collect();
    Parts::new(&Matte { width, height, alpha, n_steps: 0 }, wish)
}

#[track_caller]
fn check(plant: &[&str], wish: &PartsWish, wanted: &[&str]) {
    let found = parts(plant, wish);
    let letter = |part: &Part| match part {
        Part::Outside => '.',
        Part::Inner => 'i',
        Part::Boundary => 'b',
        Part::Trunk => 't',
        Part::Kept => 'k',
    };
    let rows: Vec<String> =
        found.parts.chunks(found.width as usize).map(|row| row.iter().map(letter).collect()).collect();
    assert_eq!(rows, wanted, "\n{}\n", rows.join("\n"));
    let n_pixels: usize = Part::ALL.iter().map(|&part| found.n_pixels(part)).sum();
    assert_eq!(n_pixels, found.parts.len());
    let is_kept =
        found.mask().iter().zip(&found.parts).all(|(&mask, &part)| (mask == 255) == (part == Part::Kept));
    assert!(is_kept);
}

const TREE: [&str; 12] = [
    "..............",
    ".#..########..",
    "...##########.",
    "..############",
    "..####..######",
    "..####..###.##",
    "...###########",
    "....########..",
    "......##......",
    ".....###......",
    "......##......",
    "......##......",
];

#[test]
fn a_tree_has_a_boundary_a_trunk_and_background_inside() {
    let wish = PartsWish { boundary_px: 1, speck: 2, trunk: true };
    check(
        &TREE,
        &wish,
        &[
            "..............",
            "....bbbbbbbb..",
            "...bkkkkkkkkb.",
            "..bkkkbbkkkkkb",
            "..bkkbiibkkkkk",
            "..bkkbiibkkkkk",
            "...bkkbbkkkkbb",
            "....bbkkbbbb..",
            "......tt......",
            ".....ttt......",
            "......tt......",
            "......tt......",
        ],
    );
    // With the trunk, without a band, and with every speck.
    check(
        &TREE,
        &PartsWish { boundary_px: 0, speck: 0, trunk: false },
        &[
            "..............",
            ".k..kkkkkkkk..",
            "...kkkkkkkkkk.",
            "..kkkkkkkkkkkk",
            "..kkkkiikkkkkk",
            "..kkkkiikkkikk",
            "...kkkkkkkkkkk",
            "....kkkkkkkk..",
            "......kk......",
            ".....kkk......",
            "......kk......",
            "......kk......",
        ],
    );
}

#[test]
fn what_never_widens_has_no_trunk() {
    let wish = PartsWish { boundary_px: 0, speck: 0, trunk: true };
    check(&["..##..", "..##..", ".###..", "..##.."], &wish, &["..kk..", "..kk..", ".kkk..", "..kk.."]);
    check(&["..##..", ".####.", "######"], &wish, &["..kk..", ".kkkk.", "kkkkkk"]);
    // The foot is that of the largest piece.
    check(
        &[".#####..", ".#####..", "...#....", "...#...#", "......##"],
        &wish,
        &[".kkkkk..", ".kkkkk..", "...t....", "...t...k", "......kk"],
    );
    check(&["....", "....", "...."], &wish, &["....", "....", "...."]);
}

#[test]
fn the_band_is_round() {
    let rows = [".######", "#######", "#######", "#######"];
    let wish = PartsWish { boundary_px: 2, speck: 0, trunk: false };
    check(&rows, &wish, &[".bbkkkk", "bbkkkkk", "bkkkkkk", "kkkkkkk"]);
}

#[test]
fn a_picture_shows_every_part_in_its_colour() {
    let found = parts(&TREE, &PartsWish { boundary_px: 1, speck: 2, trunk: true });
    let rgb = vec![[100, 100, 100]; found.parts.len()];
    let painted = found.painted(&Picture::new(14, 12, &rgb).unwrap()).unwrap();
    for (part, painted) in found.parts.iter().zip(&painted) {
        assert_eq!(*painted, part.colour().map(|c| ((u32::from(c) + 100) / 2) as u8), "{}", part.word());
    }
    let other = Picture::new(12, 14, &rgb).unwrap();
    assert_eq!(found.painted(&other), Err(MattingError::Size { wanted: [12, 14], came: [14, 12] }));
}

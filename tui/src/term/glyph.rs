//! Characters as pixels: a cell shows two colours in a pattern, and which patterns there are depends on the font.
//!
//! Half blocks are in every font. Quadrants, sextants and octants show two to four times as many pixels, of which
//! a cell still has two colours only. Nothing tells whether the font has them: they are the user's choice.

use std::fmt;
use std::sync::LazyLock;

use ratatui::buffer::Cell;
use ratatui::style::Color;
use ratatui::symbols::pixel::{OCTANTS, QUADRANTS, SEXTANTS};

use super::colour::{distance, rgb};

/// The upper half block: its foreground is the upper pixel of the cell, its background the lower one.
pub const HALF_BLOCK: &str = "▀";

/// Which characters show the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glyphs {
    /// One pixel above another.
    #[default]
    Halves,
    /// Two by two.
    Quadrants,
    /// Two across, three down.
    Sextants,
    /// Two across, four down (Unicode 16).
    Octants,
}

impl Glyphs {
    /// All of them, the coarsest first.
    pub const ALL: [Self; 4] = [Self::Halves, Self::Quadrants, Self::Sextants, Self::Octants];

    /// Those that the environment asks for, if for any (`HONAMI_GLYPHS` = `half`, `quadrant`, `sextant`, `octant`).
    #[must_use]
    pub fn from_env(var: impl Fn(&str) -> Option<String>) -> Option<Self> {
        Self::named(&var("HONAMI_GLYPHS")?)
    }

    /// Those of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|glyphs| glyphs.name() == name)
    }

    /// One word, as settings have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Halves => "half",
            Self::Quadrants => "quadrant",
            Self::Sextants => "sextant",
            Self::Octants => "octant",
        }
    }

    /// The next finer ones; after the finest, the coarsest.
    #[must_use]
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }

    /// Pixels of a cell, across and down.
    #[must_use]
    pub fn grid(self) -> (u32, u32) {
        match self {
            Self::Halves => (1, 2),
            Self::Quadrants => (2, 2),
            Self::Sextants => (2, 3),
            Self::Octants => (2, 4),
        }
    }

    /// The character and the two colours that show some pixels best.
    ///
    /// `pixels` are those of one cell, row-major, each with its weight. The foreground is the colour of the upper
    /// left pixel's kind, so that the same picture has one way to be shown.
    #[must_use]
    pub fn fit(self, pixels: &[([u8; 3], u8)]) -> (char, [u8; 3], [u8; 3]) {
        if self == Self::Halves {
            return ('▀', pixels[0].0, pixels[1].0);
        }
        let (mut mask, mut means) = (split(pixels), [[0; 3]; 2]);
        for round in 0..2 {
            means = [mean(pixels, mask), mean(pixels, !mask)];
            if round == 0 {
                mask = nearer(pixels, means);
            }
        }
        let all = (1 << pixels.len()) - 1;
        if mask & 1 == 0 {
            mask = !mask;
            means.swap(0, 1);
        }
        let pattern = usize::from(mask & all);
        let symbol = match self {
            Self::Halves | Self::Quadrants => QUADRANTS[pattern],
            Self::Sextants => SEXTANTS[pattern],
            Self::Octants => OCTANTS[pattern],
        };
        if pattern == usize::from(all) { (' ', means[0], means[0]) } else { (symbol, means[0], means[1]) }
    }
}

impl fmt::Display for Glyphs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Halves => "half blocks",
            Self::Quadrants => "quadrants",
            Self::Sextants => "sextants",
            Self::Octants => "octants",
        })
    }
}

/// Two kinds of pixels to begin with: above and below the middle of the channel that varies most.
fn split(pixels: &[([u8; 3], u8)]) -> u16 {
    let range = |c: usize| {
        let values = pixels.iter().map(|(rgb, _)| rgb[c]);
        (values.clone().min().unwrap_or(0), values.max().unwrap_or(0))
    };
    let widest = (0..3).max_by_key(|&c| range(c).1 - range(c).0).unwrap_or(0);
    let (least, most) = range(widest);
    let middle = (u16::from(least) + u16::from(most)).div_ceil(2);
    mask_of(pixels, |rgb| u16::from(rgb[widest]) >= middle)
}

/// Which pixels are nearer to the first of two colours.
fn nearer(pixels: &[([u8; 3], u8)], [a, b]: [[u8; 3]; 2]) -> u16 {
    mask_of(pixels, |rgb| distance(rgb, a) <= distance(rgb, b))
}

fn mask_of(pixels: &[([u8; 3], u8)], is_in: impl Fn([u8; 3]) -> bool) -> u16 {
    pixels.iter().enumerate().fold(0, |mask, (i, (rgb, _))| mask | u16::from(is_in(*rgb)) << i)
}

/// Weighted mean of the pixels in a mask; of all where there are none.
fn mean(pixels: &[([u8; 3], u8)], mask: u16) -> [u8; 3] {
    let all = (1_u16 << pixels.len()) - 1;
    let mask = if mask & all == 0 { all } else { mask };
    let (mut sum, mut weight) = ([0_u32; 3], 0_u32);
    for (_, (rgb, w)) in pixels.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1) {
        let w = u32::from(*w).max(1);
        weight += w;
        sum.iter_mut().zip(rgb).for_each(|(s, c)| *s += w * u32::from(*c));
    }
    sum.map(|s| u8::try_from((s + weight / 2) / weight.max(1)).unwrap_or(u8::MAX))
}

/// Rows and columns on which all patterns can be drawn: 2 by 12.
const N_PARTS: u32 = 24;

/// Characters and the parts of a cell that their foreground covers, one bit each, row-major; sorted.
static COVERED: LazyLock<Vec<(char, u32)>> = LazyLock::new(|| {
    let tables = [(&QUADRANTS[..], 2), (&SEXTANTS[..], 3), (&OCTANTS[..], 4)];
    let parts = |pattern: usize, rows: usize| {
        (0..N_PARTS as usize)
            .filter(|part| pattern >> (part / 2 * rows / 12 * 2 + part % 2) & 1 == 1)
            .fold(0, |parts, part| parts | 1 << part)
    };
    let mut covered: Vec<(char, u32)> = tables
        .iter()
        .flat_map(|(table, rows)| table.iter().enumerate().map(|(n, c)| (*c, parts(n, *rows))))
        .collect();
    covered.sort_unstable();
    covered.dedup_by_key(|(c, _)| *c);
    covered
});

/// The parts of a cell that a character's foreground covers; `None` of what is no pixels.
fn covered(symbol: &str) -> Option<u32> {
    if symbol == HALF_BLOCK {
        return Some(0xfff);
    }
    let c = symbol.chars().next()?;
    COVERED.binary_search_by_key(&c, |(c, _)| *c).ok().map(|i| COVERED[i].1)
}

/// How much two cells differ as pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Sum of squared channel differences of a cell of two pixels.
    pub squares: u32,
    /// Largest difference of a channel.
    pub most: u8,
}

/// How a cell differs from another as pixels; `None` where one of them shows no pixels, or none that are known.
#[must_use]
pub fn difference(a: &Cell, b: &Cell) -> Option<Difference> {
    if a.modifier != b.modifier {
        return None;
    }
    let (in_a, in_b) = (covered(a.symbol())?, covered(b.symbol())?);
    let mut difference = Difference { squares: 0, most: 0 };
    let pairs = [
        (in_a & in_b, a.fg, b.fg),
        (in_a & !in_b, a.fg, b.bg),
        (!in_a & in_b, a.bg, b.fg),
        (!in_a & !in_b, a.bg, b.bg),
    ];
    for (parts, a, b) in pairs {
        let n = (parts & ((1 << N_PARTS) - 1)).count_ones();
        if n > 0 && a != b {
            // Nobody knows what the terminal's own colours are.
            if a == Color::Reset || b == Color::Reset {
                return None;
            }
            let (a, b) = (rgb(a), rgb(b));
            difference.squares += n * distance(a, b) / (N_PARTS / 2);
            let most = a.iter().zip(b).map(|(x, y)| x.abs_diff(y)).max().unwrap_or(0);
            difference.most = difference.most.max(most);
        }
    }
    Some(difference)
}

#[cfg(test)]
mod tests;

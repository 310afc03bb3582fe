//! What colours a terminal can show, and the nearest ones where it cannot show the wanted.

use ratatui::style::Color;

/// How many colours the terminal shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Depth {
    /// None: brightness becomes characters.
    Mono,
    /// The 16 colours of the user's theme.
    Ansi16,
    /// xterm's 256.
    Ansi256,
    /// 24 bits.
    #[default]
    True,
}

impl Depth {
    /// The depth to begin with, from the environment (`HONAMI_COLOR`, `NO_COLOR`, `COLORTERM`, `TERM`).
    ///
    /// Terminals that call themselves `…256color` are taken to show 24 bits: nearly all of them do, ssh does not
    /// forward `COLORTERM`, and 256 colours never show foliage better than 23 dB.
    #[must_use]
    pub fn from_env(var: impl Fn(&str) -> Option<String>) -> Self {
        match var("HONAMI_COLOR").as_deref() {
            Some("true") => return Self::True,
            Some("256") => return Self::Ansi256,
            Some("16") => return Self::Ansi16,
            Some("mono") => return Self::Mono,
            _ => {}
        }
        if var("NO_COLOR").is_some_and(|v| !v.is_empty()) {
            return Self::Mono;
        }
        let term = var("TERM").unwrap_or_default();
        if var("COLORTERM").is_some_and(|v| v == "truecolor" || v == "24bit") {
            return Self::True;
        }
        match term.as_str() {
            "" | "dumb" | "vt100" | "vt220" => Self::Mono,
            "linux" | "xterm" | "screen" | "ansi" | "rxvt" => Self::Ansi16,
            _ => Self::True,
        }
    }

    /// The nearest colour that the terminal can show.
    #[must_use]
    pub fn nearest(self, colour: Color) -> Color {
        match (self, colour) {
            (Self::Mono, _) => Color::Reset,
            (Self::True, _) | (_, Color::Reset) => colour,
            (Self::Ansi256, Color::Rgb(r, g, b)) => Color::Indexed(nearest_256([r, g, b])),
            (Self::Ansi16, Color::Rgb(r, g, b)) => Color::Indexed(nearest_16([r, g, b])),
            (Self::Ansi16, Color::Indexed(n)) if n > 15 => Color::Indexed(nearest_16(rgb_of_index(n))),
            _ => colour,
        }
    }
}

/// The 16 colours as xterm has them by default.
const BASE: [[u8; 3]; 16] = [
    [0, 0, 0],
    [205, 0, 0],
    [0, 205, 0],
    [205, 205, 0],
    [0, 0, 238],
    [205, 0, 205],
    [0, 205, 205],
    [229, 229, 229],
    [127, 127, 127],
    [255, 0, 0],
    [0, 255, 0],
    [255, 255, 0],
    [92, 92, 255],
    [255, 0, 255],
    [0, 255, 255],
    [255, 255, 255],
];

/// Channel values of xterm's 6x6x6 cube.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// Red, green and blue of a colour as far as it is known; the terminal's own default counts as black.
#[must_use]
pub fn rgb(colour: Color) -> [u8; 3] {
    match colour {
        Color::Rgb(r, g, b) => [r, g, b],
        Color::Indexed(n) => rgb_of_index(n),
        named => base_index(named).map_or([0; 3], |n| BASE[usize::from(n)]),
    }
}

/// Number of a named colour in the 16; `None` for the default and for the others.
#[must_use]
pub fn base_index(colour: Color) -> Option<u8> {
    const NAMED: [Color; 16] = [
        Color::Black,
        Color::Red,
        Color::Green,
        Color::Yellow,
        Color::Blue,
        Color::Magenta,
        Color::Cyan,
        Color::Gray,
        Color::DarkGray,
        Color::LightRed,
        Color::LightGreen,
        Color::LightYellow,
        Color::LightBlue,
        Color::LightMagenta,
        Color::LightCyan,
        Color::White,
    ];
    (0..16).zip(NAMED).find(|(_, c)| *c == colour).map(|(n, _)| n)
}

fn rgb_of_index(n: u8) -> [u8; 3] {
    match n {
        0..=15 => BASE[usize::from(n)],
        16..=231 => {
            let n = usize::from(n - 16);
            [CUBE[n / 36], CUBE[n / 6 % 6], CUBE[n % 6]]
        }
        _ => [8 + 10 * (n - 232); 3],
    }
}

fn nearest_256(rgb: [u8; 3]) -> u8 {
    let level = rgb.map(|c| {
        if c < 48 {
            0
        } else if c < 115 {
            1
        } else {
            (c - 35) / 40
        }
    });
    let cube = 16 + 36 * level[0] + 6 * level[1] + level[2];
    let mean = rgb.iter().map(|&c| u32::from(c)).sum::<u32>() / 3;
    let gray = 232 + u8::try_from(mean.saturating_sub(3) / 10).unwrap_or(23).min(23);
    if distance(rgb, rgb_of_index(gray)) < distance(rgb, rgb_of_index(cube)) { gray } else { cube }
}

fn nearest_16(rgb: [u8; 3]) -> u8 {
    (0..16).min_by_key(|&n| distance(rgb, BASE[usize::from(n)])).unwrap_or(0)
}

/// Sum of squared channel differences.
#[must_use]
pub fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    a.iter().zip(b).map(|(&x, y)| u32::from(x.abs_diff(y)).pow(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_colours() {
        for (rgb, index) in
            [([0, 0, 0], 16), ([255, 255, 255], 231), ([128, 128, 128], 244), ([250, 10, 5], 196)]
        {
            assert_eq!(nearest_256(rgb), index);
        }
        // What the cube and the grays hold exactly is kept exactly.
        for n in 16..=255 {
            assert_eq!(rgb_of_index(nearest_256(rgb_of_index(n))), rgb_of_index(n));
        }
        assert_eq!(Depth::Ansi16.nearest(Color::Rgb(250, 250, 10)), Color::Indexed(11));
        assert_eq!(Depth::Ansi16.nearest(Color::Cyan), Color::Cyan);
        assert_eq!(Depth::Mono.nearest(Color::Cyan), Color::Reset);
    }

    #[test]
    fn depth_from_the_environment() {
        let depth = |set: &[(&str, &str)]| {
            Depth::from_env(|k| set.iter().find(|(name, _)| *name == k).map(|(_, v)| (*v).to_owned()))
        };
        assert_eq!(depth(&[("TERM", "xterm-256color")]), Depth::True);
        assert_eq!(depth(&[("TERM", "linux")]), Depth::Ansi16);
        assert_eq!(depth(&[("TERM", "xterm"), ("COLORTERM", "truecolor")]), Depth::True);
        assert_eq!(depth(&[("TERM", "xterm-256color"), ("NO_COLOR", "1")]), Depth::Mono);
        assert_eq!(depth(&[("TERM", "foot"), ("HONAMI_COLOR", "256")]), Depth::Ansi256);
        assert_eq!(depth(&[]), Depth::Mono);
    }
}

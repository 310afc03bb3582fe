//! Pictures as the numbers of their colours' bins.

use honami_model::picture::{Chroma, Gray};

/// How finely colours are told apart. Luma is divided from 0 to 255, each chroma channel from 64 to 191, and what
/// lies beyond falls into the outermost bins: natural colours seldom do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bins {
    /// Parts of luma, 1..=32; more or less than that is taken as the nearest.
    pub luma: u32,
    /// Parts of each chroma channel, 1..=32. Odd, so that gray, 128, lies in the middle of a bin and not on an edge.
    pub chroma: u32,
}

impl Bins {
    /// The most parts of a channel: 32³ bins have 16-bit numbers.
    pub const MAX: u32 = 32;

    fn parts(self) -> [u32; 2] {
        [self.luma, self.chroma].map(|n| n.clamp(1, Self::MAX))
    }

    /// Number of bins.
    #[must_use]
    pub fn len(self) -> usize {
        let [luma, chroma] = self.parts();
        (luma * chroma * chroma) as usize
    }

    /// Whether there is none: never.
    #[must_use]
    pub fn is_empty(self) -> bool {
        false
    }

    /// The bin of a colour `[Y, Cb, Cr]`, less than [`len`](Self::len).
    #[must_use]
    pub fn of(self, [y, cb, cr]: [u8; 3]) -> u16 {
        let [luma, chroma] = self.parts();
        let part = |c: u8| (u32::from(c).clamp(64, 191) - 64) * chroma / 128;
        ((u32::from(y) * luma / 256 * chroma + part(cb)) * chroma + part(cr)) as u16
    }
}

/// A picture as the bins of its pixels' colours. A picture without chroma is gray everywhere.
#[derive(Clone, Debug)]
pub struct Colours {
    numbers: Vec<u16>,
    width: u32,
    height: u32,
    bins: Bins,
}

impl Colours {
    /// The bins of a picture; pixel `(x, y)` has the chroma sample `(x · chroma width / width, …)`, rounded down.
    #[must_use]
    pub fn new(luma: &Gray<'_>, chroma: Option<&Chroma<'_>>, bins: Bins) -> Self {
        let mut colours = Self { numbers: Vec::new(), width: 0, height: 0, bins };
        colours.fill(luma, chroma);
        colours
    }

    /// As [`new`](Self::new), in the memory of a picture that is no longer needed.
    pub fn fill(&mut self, luma: &Gray<'_>, chroma: Option<&Chroma<'_>>) {
        (self.width, self.height) = (luma.width, luma.height);
        self.numbers.clear();
        let [n_luma, n_chroma] = self.bins.parts();
        let of_luma: Vec<u16> =
            (0..=255_u32).map(|y| (y * n_luma / 256 * n_chroma * n_chroma) as u16).collect();
        let gray = self.bins.of([0, 128, 128]);
        let scaled =
            |k: u32, n: u32, samples: u32| (u64::from(k) * u64::from(samples) / u64::from(n)) as usize;
        let columns: Vec<usize> = chroma
            .map_or_else(Vec::new, |c| (0..luma.width).map(|x| scaled(x, luma.width, c.cb.width)).collect());
        for y in 0..luma.height {
            let row = luma.row(y).iter().map(|&v| of_luma[usize::from(v)]);
            match chroma {
                None => self.numbers.extend(row.map(|bin| bin + gray)),
                Some(Chroma { cb, cr }) => {
                    let j = scaled(y, luma.height, cb.height) as u32;
                    let (cb, cr) = (cb.row(j), cr.row(j));
                    let of_chroma: Vec<u16> =
                        cb.iter().zip(cr).map(|(&cb, &cr)| self.bins.of([0, cb, cr])).collect();
                    self.numbers.extend(row.zip(&columns).map(|(bin, &i)| bin + of_chroma[i]));
                }
            }
        }
    }

    /// Width and height, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// How colours are told apart.
    #[must_use]
    pub fn bins(&self) -> Bins {
        self.bins
    }

    /// The bins of some pixels of a row.
    pub(super) fn row(&self, y: u32, xs: std::ops::RangeInclusive<u32>) -> &[u16] {
        let start = y as usize * self.width as usize;
        &self.numbers[start + *xs.start() as usize..=start + *xs.end() as usize]
    }
}

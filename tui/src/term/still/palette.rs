//! The few colours that show a picture best: median cut (Heckbert 1982) over colours of 5 bits a channel.

/// Colours told apart: 5 bits a channel.
const N_BINS: usize = 1 << 15;

/// Pixels of one of those colours.
#[derive(Clone, Copy, Default)]
struct Bin {
    n: u64,
    sum: [u64; 3],
}

fn bin_of([r, g, b]: [u8; 3]) -> usize {
    usize::from(r >> 3) << 10 | usize::from(g >> 3) << 5 | usize::from(b >> 3)
}

/// Channel of a colour told apart.
fn channel(bin: usize, c: usize) -> usize {
    bin >> (10 - 5 * c) & 31
}

/// At most `n` colours, 1 to 256, and for each pixel the number of its colour.
pub(super) fn palette(pixels: &[[u8; 3]], n: usize) -> (Vec<[u8; 3]>, Vec<u8>) {
    let mut bins = vec![Bin::default(); N_BINS];
    for &rgb in pixels {
        let bin = &mut bins[bin_of(rgb)];
        bin.n += 1;
        bin.sum.iter_mut().zip(rgb).for_each(|(sum, c)| *sum += u64::from(c));
    }
    let mut boxes: Vec<Vec<usize>> = vec![(0..N_BINS).filter(|&bin| bins[bin].n > 0).collect()];
    while boxes.len() < n.clamp(1, 256) {
        let Some((widest, c)) = most_wanting(&boxes, &bins) else { break };
        let other = cut(&mut boxes[widest], c, &bins);
        boxes.push(other);
    }
    let mut number = vec![0_u8; N_BINS];
    let mut colours = Vec::with_capacity(boxes.len());
    for (i, members) in (0_u8..=255).zip(&boxes) {
        members.iter().for_each(|&bin| number[bin] = i);
        let count = members.iter().map(|&bin| bins[bin].n).sum::<u64>().max(1);
        let mean = |c: usize| members.iter().map(|&bin| bins[bin].sum[c]).sum::<u64>() / count;
        colours.push([0, 1, 2].map(|c| u8::try_from(mean(c)).unwrap_or(u8::MAX)));
    }
    (colours, pixels.iter().map(|&rgb| number[bin_of(rgb)]).collect())
}

/// The box that gains most by being cut, and the channel along which; `None` when all hold one colour.
fn most_wanting(boxes: &[Vec<usize>], bins: &[Bin]) -> Option<(usize, usize)> {
    let gain = |members: &[usize], c: usize| {
        let values = members.iter().map(|&bin| channel(bin, c));
        let range = values.clone().max().unwrap_or(0) - values.min().unwrap_or(0);
        members.iter().map(|&bin| bins[bin].n).sum::<u64>() * (range * range) as u64
    };
    (0..boxes.len())
        .flat_map(|i| (0..3).map(move |c| (i, c)))
        .map(|(i, c)| (gain(&boxes[i], c), i, c))
        .filter(|(gain, ..)| *gain > 0)
        .max_by_key(|&(gain, i, c)| (gain, std::cmp::Reverse((i, c))))
        .map(|(_, i, c)| (i, c))
}

/// Cuts a box so that both halves have about as many pixels; returns the brighter half.
fn cut(members: &mut Vec<usize>, c: usize, bins: &[Bin]) -> Vec<usize> {
    members.sort_by_key(|&bin| channel(bin, c));
    let half = members.iter().map(|&bin| bins[bin].n).sum::<u64>() / 2;
    let mut below = 0;
    let at = members.iter().position(|&bin| {
        below += bins[bin].n;
        below > half
    });
    members.split_off(at.unwrap_or(0).clamp(1, members.len() - 1))
}

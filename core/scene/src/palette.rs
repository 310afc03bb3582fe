//! The colours of groups, keys and what is not seen: the same in the terminal, in movies and in the viewer.

/// Colours of groups: far from foliage and from each other; they repeat after the last.
const GROUPS: [[u8; 3]; 12] = [
    [255, 209, 0],
    [0, 200, 255],
    [255, 80, 80],
    [255, 120, 240],
    [120, 140, 255],
    [255, 150, 40],
    [170, 255, 90],
    [0, 240, 180],
    [200, 100, 255],
    [255, 220, 180],
    [170, 110, 60],
    [200, 200, 200],
];

/// Tracks without a group.
const ALONE: [u8; 3] = [90, 220, 255];

/// Key-frames.
pub const KEY: [u8; 3] = [255, 215, 95];
/// What is hidden or lost.
pub const UNSEEN: [u8; 3] = [130, 130, 130];
/// Bones that end in forks.
pub const FORK: [u8; 3] = [235, 235, 235];
/// Round what must be seen on petals and on sky.
pub const DARK: [u8; 3] = [20, 20, 20];

/// Colour of a group, numbered from 0; of what has none where `None`.
#[must_use]
pub fn group(group: Option<u32>) -> [u8; 3] {
    group.map_or(ALONE, |group| GROUPS[group as usize % GROUPS.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_told_apart_and_twelve_are_of_different_colours() {
        let apart = |a: [u8; 3], b: [u8; 3]| -> i32 {
            (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).pow(2)).sum::<i32>().isqrt()
        };
        for a in 0..12 {
            for b in 0..a {
                let distance = apart(group(Some(a)), group(Some(b)));
                assert!(distance >= 45, "{a} {b}: {distance}");
            }
        }
        assert_eq!(group(Some(12)), group(Some(0)));
        let greenest = |[r, g, b]: [u8; 3]| g > r && g > b && r < 120 && b < 120;
        assert!((0..12).all(|k| !greenest(group(Some(k)))), "foliage has that colour");
    }
}

//! What there is to say where so little was filmed that nothing much follows from it.

use honami_model::brief::counted;

/// Fewer frames have no sway in them: at 25 a second a branch of 5 Hz comes back after five.
const FRAMES: usize = 8;
/// Fewer tracks are hardly one group.
const TRACKS: usize = 5;

/// A sentence where so many tracks in so many frames are too few to tell which of them move together.
pub(crate) fn scarce(n_tracks: usize, n_frames: usize) -> Option<String> {
    (n_tracks < TRACKS || n_frames < FRAMES).then(|| {
        format!(
            "there is little to go by, {} in {}: groups, and what grows from them, follow from {TRACKS} tracks in {FRAMES} \
             frames at least, and better from many more",
            counted(n_tracks, "track"),
            counted(n_frames, "frame")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::scarce;

    #[test]
    fn little_is_told_with_how_much_it_is() {
        assert!(scarce(2, 2).unwrap().starts_with("there is little to go by, 2 tracks in 2 frames: "));
        assert!(scarce(1, 500).unwrap().contains(" 1 track in 500 frames"));
        assert!(scarce(300, 7).is_some() && scarce(4, 8).is_some());
        assert_eq!(scarce(5, 8), None);
    }
}

//! Where features may be, from frame to frame.

/// Masks, each with the frame from which on it counts; none: features may be everywhere.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Areas {
    /// In order of frames; a byte a pixel of the clip, non-zero where features may be.
    masks: Vec<(u32, Vec<u8>)>,
}

impl Areas {
    /// Masks of frames. Each counts until the next one does, the first also before its frame.
    #[must_use]
    pub fn new(mut masks: Vec<(u32, Vec<u8>)>) -> Self {
        masks.sort_by_key(|(frame, _)| *frame);
        Self { masks }
    }

    /// One mask for all frames.
    #[must_use]
    pub fn always(mask: Vec<u8>) -> Self {
        Self { masks: vec![(0, mask)] }
    }

    /// The mask that counts in a frame; `None`: everywhere.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<&[u8]> {
        let n_before = self.masks.partition_point(|(of, _)| *of <= frame);
        self.masks.get(n_before.saturating_sub(1)).map(|(_, mask)| mask.as_slice())
    }

    /// Whether features may be nowhere in any frame.
    #[must_use]
    pub fn are_empty(&self) -> bool {
        let is_empty = |(_, mask): &(u32, Vec<u8>)| mask.iter().all(|&pixel| pixel == 0);
        !self.masks.is_empty() && self.masks.iter().all(is_empty)
    }
}

#[cfg(test)]
mod tests {
    use super::Areas;

    #[test]
    fn a_mask_counts_from_its_frame_until_the_next_and_the_first_before_it() {
        let areas = Areas::new(vec![(30, vec![3]), (10, vec![1]), (20, vec![0])]);
        for (frame, mask) in [(0, 1), (9, 1), (10, 1), (19, 1), (20, 0), (29, 0), (30, 3), (99, 3)] {
            assert_eq!(areas.at(frame), Some(&[mask][..]), "{frame}");
        }
        assert_eq!(Areas::default().at(7), None);
        assert_eq!(Areas::always(vec![5]).at(7), Some(&[5][..]));
        let empty = [Areas::default(), areas, Areas::new(vec![(3, vec![0]), (9, vec![0])])]
            .map(|areas| areas.are_empty());
        assert_eq!(empty, [false, false, true]);
    }
}

//! Positions of several tracks over the same frames, with gaps.

/// Where n tracks are in T frames; a position is there only where the feature was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Positions {
    n_tracks: usize,
    n_frames: usize,
    /// (n_tracks, n_frames), row-major.
    at: Vec<Option<[f32; 2]>>,
}

impl Positions {
    /// n tracks over T frames, none seen yet.
    #[must_use]
    pub fn new(n_tracks: usize, n_frames: usize) -> Self {
        Self { n_tracks, n_frames, at: vec![None; n_tracks * n_frames] }
    }

    /// Tracks of their first frame and their samples from there on, one a frame, `None` where it was not seen; also the
    /// first frame of all, which is frame 0 here.
    #[must_use]
    pub fn of_samples(tracks: &[(i64, Vec<Option<[f32; 2]>>)]) -> (i64, Self) {
        let origin = tracks.iter().map(|(first, _)| *first).min().unwrap_or(0);
        // Spans of a clip in memory: their lengths fit.
        let start = |first: i64| (first - origin) as usize;
        let n_frames = tracks.iter().map(|(first, samples)| start(*first) + samples.len()).max().unwrap_or(0);
        let mut positions = Self::new(tracks.len(), n_frames);
        for (track, (first, samples)) in tracks.iter().enumerate() {
            for (sample, frame) in samples.iter().zip(start(*first)..) {
                sample.iter().for_each(|at| positions.set(track, frame, *at));
            }
        }
        (origin, positions)
    }

    /// Marks a track as seen at a position, pixels; one that is not finite counts as not seen.
    ///
    /// # Panics
    /// When there is no such track or frame.
    #[track_caller]
    pub fn set(&mut self, track: usize, frame: usize, [x, y]: [f32; 2]) {
        assert!(track < self.n_tracks && frame < self.n_frames, "track {track}, frame {frame}");
        self.at[track * self.n_frames + frame] = (x.is_finite() && y.is_finite()).then_some([x, y]);
    }

    /// Position of a track in a frame, where it was seen.
    ///
    /// # Panics
    /// When there is no such track or frame.
    #[must_use]
    #[track_caller]
    pub fn get(&self, track: usize, frame: usize) -> Option<[f32; 2]> {
        assert!(track < self.n_tracks && frame < self.n_frames, "track {track}, frame {frame}");
        self.at[track * self.n_frames + frame]
    }

    /// Number of tracks n.
    #[must_use]
    pub fn n_tracks(&self) -> usize {
        self.n_tracks
    }

    /// Number of frames T.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }
}

//! A track while its file is being read: samples in any order, each frame once.

use std::sync::Arc;

use honami_model::track::{Sample, Span};

use super::{Flaw, ForeignTrack, MAX_SAMPLES};

/// Samples that a file may still hold.
#[derive(Debug)]
pub(crate) struct Room(usize);

impl Room {
    pub(crate) fn new() -> Self {
        Self(MAX_SAMPLES)
    }

    /// Takes the room of some samples.
    pub(crate) fn take(&mut self, n: usize) -> Result<(), Flaw> {
        self.0 = self.0.checked_sub(n).ok_or(Flaw::TooMany)?;
        Ok(())
    }
}

/// A track in the making.
#[derive(Debug, Default)]
pub(crate) struct Draft {
    pub(crate) number: Option<u32>,
    pub(crate) name: Option<String>,
    pub(crate) samples: Vec<(u32, Sample)>,
}

impl Draft {
    pub(crate) fn numbered(number: u32) -> Self {
        Self { number: Some(number), ..Self::default() }
    }

    pub(crate) fn put(&mut self, room: &mut Room, frame: u32, sample: Sample) -> Result<(), Flaw> {
        room.take(1)?;
        self.samples.push((frame, sample));
        Ok(())
    }

    /// The track; `None` without samples.
    pub(crate) fn done(mut self) -> Result<Option<ForeignTrack>, Flaw> {
        self.samples.sort_by_key(|&(frame, _)| frame);
        if let Some(twice) = self.samples.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let number = self.number.map(|number| number.to_string());
            let track = self.name.or(number).unwrap_or_else(|| "without a name".to_owned());
            return Err(Flaw::Twice { track, frame: twice[0].0 });
        }
        let run = |run: &[(u32, Sample)]| {
            Arc::new(Span { first_frame: run[0].0, samples: run.iter().map(|&(_, sample)| sample).collect() })
        };
        let spans: Vec<Arc<Span>> =
            self.samples.chunk_by(|a, b| a.0.checked_add(1) == Some(b.0)).map(run).collect();
        let name = self.name.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
        let track = ForeignTrack { number: self.number, name, spans };
        Ok(Some(track).filter(|track| !track.spans.is_empty()))
    }
}

/// The tracks of all drafts that have samples.
pub(crate) fn all(drafts: impl IntoIterator<Item = Draft>) -> Result<Vec<ForeignTrack>, Flaw> {
    drafts.into_iter().filter_map(|draft| draft.done().transpose()).collect()
}

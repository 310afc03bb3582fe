//! Rows on their way from a tracker to the sink.

use std::collections::{BTreeMap, BTreeSet};

use honami_host::{Point, Points};
use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use super::{Rows, Sink};
use crate::error::WorkbenchError;

/// Rows on their way to the sink: those the tracker gave, and the seeds of frames it has not answered yet.
#[derive(Clone)]
pub(super) struct Board {
    /// One past the last frame that was handed over.
    pub(super) end: u32,
    answered: BTreeMap<u32, Rows>,
    pub(super) placed: BTreeMap<u32, Vec<Point>>,
    /// Where the live points were seen last.
    last: BTreeMap<u32, Point>,
    /// Where they were seen in the last frame that was handed over and not lost, and which that was.
    handed: Vec<Point>,
    handed_frame: Option<u32>,
    /// Frames that nobody could look at.
    lost: BTreeSet<u32>,
}

impl Board {
    pub(super) fn new(first: u32) -> Self {
        Self {
            end: first,
            answered: BTreeMap::new(),
            placed: BTreeMap::new(),
            last: BTreeMap::new(),
            handed: Vec::new(),
            handed_frame: None,
            lost: BTreeSet::new(),
        }
    }

    pub(super) fn take(&mut self, answers: Vec<Points>) {
        for answer in answers {
            let frame = u32::try_from(answer.frame).unwrap_or(u32::MAX);
            if frame < self.end {
                // Handed over before a restart.
                continue;
            }
            self.last.clear();
            let mut rows = Rows::with_capacity(answer.rows.len());
            for row in answer.rows {
                if row.status.is_seen() {
                    self.last.insert(row.id, Point { id: row.id, x: row.x, y: row.y });
                }
                let quality = Quality { fb_px: row.fb, ncc: row.ncc };
                let sample =
                    Sample { x: row.x, y: row.y, status: row.status, source: Source::Tracked, quality };
                rows.push((TrackId(row.id), sample));
            }
            self.answered.insert(frame, rows);
        }
    }

    /// Forgets the answers that were not handed over; the first frame without rows, and that in which all were seen last.
    pub(super) fn back(&mut self) -> (u32, Option<u32>) {
        self.answered.clear();
        self.last = self.handed.iter().map(|point| (point.id, *point)).collect();
        (self.end, self.handed_frame)
    }

    /// All are lost in a frame that nobody could look at.
    pub(super) fn lose(&mut self, frame: u32) {
        let (status, source, quality) = (Status::Lost, Source::Tracked, Quality::default());
        self.lost.insert(frame);
        let rows =
            self.last.values().map(|p| (TrackId(p.id), Sample { x: p.x, y: p.y, status, source, quality }));
        self.answered.insert(frame, rows.collect());
    }

    pub(super) fn is_lost(&self, frame: u32) -> bool {
        self.lost.contains(&frame)
    }

    /// Lays down the seeds of a frame that was not handed over yet.
    pub(super) fn place(&mut self, frame: u32, points: &[Point]) {
        if !points.is_empty() && frame >= self.end {
            self.last.extend(points.iter().map(|point| (point.id, *point)));
            self.placed.insert(frame, points.to_vec());
        }
    }

    pub(super) fn seen(&self) -> impl Iterator<Item = Point> {
        self.last.values().copied()
    }

    /// Hands over the answered frames, with the seeds placed in them.
    pub(super) fn flush(&mut self, sink: Sink<'_>) -> Result<(), WorkbenchError> {
        while let Some((frame, mut rows)) = self.answered.pop_first() {
            for point in self.placed.remove(&frame).unwrap_or_default() {
                rows.retain(|(track, _)| track.0 != point.id);
                let quality = Quality::default();
                let (status, source) = (Status::Tracked, Source::Tracked);
                rows.push((TrackId(point.id), Sample { x: point.x, y: point.y, status, source, quality }));
            }
            sink(frame, &rows)?;
            if !self.lost.contains(&frame) {
                let seen = rows.iter().filter(|(_, sample)| sample.status.is_seen());
                self.handed =
                    seen.map(|(track, sample)| Point { id: track.0, x: sample.x, y: sample.y }).collect();
                self.handed_frame = Some(frame);
            }
            self.end = frame + 1;
        }
        Ok(())
    }
}

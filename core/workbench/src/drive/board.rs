//! Rows on their way from a tracker to the sink.

use std::collections::{BTreeMap, BTreeSet};

use honami_host::{Point, Points};
use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use super::{Rows, Sink};
use crate::error::WorkbenchError;

/// A point that a tracker follows.
#[derive(Clone, Copy)]
struct Live {
    point: Point,
    is_seen: bool,
}

impl Live {
    /// `None` for one that has come to its end.
    fn of(id: u32, x: f32, y: f32, status: Status) -> Option<Self> {
        let is_seen = status.is_seen();
        (is_seen || status == Status::Occluded).then_some(Self { point: Point { id, x, y }, is_seen })
    }
}

/// Rows on their way to the sink: those the tracker gave, and the seeds of frames it has not answered yet.
#[derive(Clone)]
pub(super) struct Board {
    /// One past the last frame that was handed over.
    pub(super) end: u32,
    answered: BTreeMap<u32, Rows>,
    pub(super) placed: BTreeMap<u32, Vec<Point>>,
    /// Where the live points are, and whether they are seen there; hidden ones are where the tracker takes them to be.
    last: BTreeMap<u32, Live>,
    /// Where they were in the last frame that was handed over and not lost, and which that was.
    handed: Vec<Live>,
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
                self.last.extend(Live::of(row.id, row.x, row.y, row.status).map(|live| (row.id, live)));
                let quality = Quality { fb_px: row.fb, ncc: row.ncc };
                let sample =
                    Sample { x: row.x, y: row.y, status: row.status, source: Source::Tracked, quality };
                rows.push((TrackId(row.id), sample));
            }
            self.answered.insert(frame, rows);
        }
    }

    /// Forgets the answers that were not handed over; the first frame without rows, and that before in
    /// which it is known where all were.
    pub(super) fn back(&mut self) -> (u32, Option<u32>) {
        self.answered.clear();
        self.last = self.handed.iter().map(|live| (live.point.id, *live)).collect();
        (self.end, self.handed_frame)
    }

    /// All are lost in a frame that nobody could look at.
    pub(super) fn lose(&mut self, frame: u32) {
        let (status, source, quality) = (Status::Lost, Source::Tracked, Quality::default());
        self.lost.insert(frame);
        let rows = self.live().map(|p| (TrackId(p.id), Sample { x: p.x, y: p.y, status, source, quality }));
        self.answered.insert(frame, rows.collect());
    }

    pub(super) fn is_lost(&self, frame: u32) -> bool {
        self.lost.contains(&frame)
    }

    /// Lays down the seeds of a frame that was not handed over yet.
    pub(super) fn place(&mut self, frame: u32, points: &[Point]) {
        if !points.is_empty() && frame >= self.end {
            self.last.extend(points.iter().map(|point| (point.id, Live { point: *point, is_seen: true })));
            self.placed.insert(frame, points.to_vec());
        }
    }

    /// Those that are seen, where they are.
    pub(super) fn seen(&self) -> impl Iterator<Item = Point> {
        self.last.values().filter(|live| live.is_seen).map(|live| live.point)
    }

    /// Those that are followed, hidden ones with them.
    pub(super) fn live(&self) -> impl Iterator<Item = Point> {
        self.last.values().map(|live| live.point)
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
                let live = rows.iter().filter_map(|(track, s)| Live::of(track.0, s.x, s.y, s.status));
                self.handed = live.collect();
                self.handed_frame = Some(frame);
            }
            self.end = frame + 1;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;

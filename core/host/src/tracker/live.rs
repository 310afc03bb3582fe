//! Which points are live in which frame of a stream: the rule that every row of a tracker is held against.

use crate::reply::Table;
use crate::types::{PointRow, Points};
use honami_abi::{FB_NONE, NCC_NONE};
use honami_model::track::Status;
use std::collections::{BTreeSet, VecDeque};
use std::ops::Range;

/// The points of a stream, and the frames whose rows are still to come.
#[derive(Clone, Debug)]
pub(super) struct Live {
    births: Range<u32>,
    born: BTreeSet<u32>,
    /// By id and beginning, ascending. Those of one id follow each other: what is retired and seeded again while rows
    /// are still to come has several.
    lives: Vec<Life>,
    /// Pushed frames without rows so far, oldest first.
    pending: VecDeque<i64>,
    /// Frames with rows; also the number of the oldest pending frame in the stream.
    n_read: u64,
}

/// A time in which a point is followed. Frames are counted in the order of the stream.
#[derive(Clone, Copy, Debug)]
struct Life {
    id: u32,
    /// Its first row is due in this frame.
    from: u64,
    /// It has no row from this frame on.
    until: u64,
    /// Frames up to this one have been read with a row of it.
    read: u64,
}

impl Life {
    fn is_due(&self, frame: u64) -> bool {
        self.from <= frame && frame < self.until
    }
}

impl Live {
    pub(super) fn new(births: Range<u32>) -> Self {
        Self { births, born: BTreeSet::new(), lives: Vec::new(), pending: VecDeque::new(), n_read: 0 }
    }

    fn n_pushed(&self) -> u64 {
        self.n_read + self.pending.len() as u64
    }

    /// Where the lives of an id stand in the list, or would.
    fn of(&self, id: u32) -> Range<usize> {
        let start = self.lives.partition_point(|life| life.id < id);
        start..start + self.lives[start..].iter().take_while(|life| life.id == id).count()
    }

    /// Whether the id has been seen in this stream.
    pub(super) fn is_known(&self, id: u32) -> bool {
        self.born.contains(&id) || !self.of(id).is_empty()
    }

    pub(super) fn seed(&mut self, ids: &[u32]) {
        let from = self.n_pushed();
        for &id in ids {
            let lives = self.of(id);
            let k = lives.end;
            match self.lives[lives].last_mut().filter(|life| life.until == u64::MAX) {
                Some(_) if self.pending.is_empty() => continue,
                // Rows that are still to come may end it; then this seed has brought it back.
                Some(life) => life.until = from,
                None => {}
            }
            self.lives.insert(k, Life { id, from, until: u64::MAX, read: from });
        }
    }

    pub(super) fn retire(&mut self, ids: &[u32]) {
        let until = self.n_pushed();
        for &id in ids {
            let lives = self.of(id);
            for life in &mut self.lives[lives] {
                life.until = life.until.min(until);
            }
        }
        self.forget();
    }

    pub(super) fn pushed(&mut self, index: i64) {
        self.pending.push_back(index);
    }

    /// Checks a table of points against what is due. Afterwards at most `lag_max` frames may still be pending.
    pub(super) fn read(
        &mut self,
        table: Option<&Table>,
        lag_max: usize,
        late: bool,
    ) -> Result<Vec<Points>, String> {
        let mut all = Vec::with_capacity(1);
        if let Some(table) = table {
            if late {
                self.read_late(table, &mut all)?;
            } else if let Some(frame) = self.pending.front().copied() {
                all.push(self.read_frame(frame, rows(table)?)?);
            } else if table.rows() > 0 {
                return Err(format!("committed {} points when no frame was due", table.rows()));
            }
        }
        while self.pending.len() > lag_max {
            let Some(&frame) = self.pending.front() else { break };
            if self.lives.iter().any(|life| life.is_due(self.n_read)) {
                return Err(format!("returned without committing honami.points/1 for frame {frame}"));
            }
            all.push(self.read_frame(frame, Vec::new())?);
        }
        Ok(all)
    }

    /// Rows of several frames, those of a frame together, frames in the order of the stream.
    fn read_late(&mut self, table: &Table, all: &mut Vec<Points>) -> Result<(), String> {
        let frames: &[i64] = match table.column("frame") {
            Some(frames) => frames,
            None if table.rows() == 0 => &[],
            None => return Err("committed points without column frame under a latency".into()),
        };
        let rows = rows(table)?;
        let mut start = 0;
        for group in frames.chunk_by(|a, b| a == b) {
            let frame = group[0];
            // Frames before it that nothing was due in may be left out.
            while let Some(&next) = self.pending.front().filter(|next| **next != frame) {
                if self.lives.iter().any(|life| life.is_due(self.n_read)) {
                    return Err(format!(
                        "committed points of frame {frame} when those of frame {next} were due"
                    ));
                }
                all.push(self.read_frame(next, Vec::new())?);
            }
            if self.pending.is_empty() {
                return Err(format!("committed points of frame {frame}, which is not due"));
            }
            all.push(self.read_frame(frame, rows[start..start + group.len()].to_vec())?);
            start += group.len();
        }
        Ok(())
    }

    /// Checks the rows of the oldest pending frame.
    fn read_frame(&mut self, frame: i64, rows: Vec<PointRow>) -> Result<Points, String> {
        let now = self.n_read;
        let mut guess = 0;
        for row in &rows {
            // Trackers mostly keep the order: the next life is the right one.
            let found = match self.lives.get(guess) {
                Some(life) if life.id == row.id && life.is_due(now) => Some(guess),
                _ => self.of(row.id).find(|&k| self.lives[k].is_due(now)),
            };
            let k = match found {
                Some(k) => k,
                None => self.birth(row, now, frame)?,
            };
            let life = &mut self.lives[k];
            if life.read > now {
                return Err(format!("committed point {} twice in frame {frame}", row.id));
            }
            if row.status == Status::Newborn && found.is_some() {
                return Err(format!(
                    "committed point {} as newborn in frame {frame}, it was there before",
                    row.id
                ));
            }
            life.read = now + 1;
            guess = k + 1;
        }
        let mut ended = Vec::new();
        for life in self.lives.iter_mut().filter(|life| life.is_due(now) && life.read <= now) {
            life.until = now;
            ended.push(life.id);
        }
        self.pending.pop_front();
        self.n_read += 1;
        self.forget();
        Ok(Points { frame, rows, ended })
    }

    /// A row of an id that is not live: a birth, or a fault.
    fn birth(&mut self, row: &PointRow, now: u64, frame: i64) -> Result<usize, String> {
        let id = row.id;
        if !self.births.contains(&id) {
            return Err(format!("committed point {id} in frame {frame}, which is not live there"));
        }
        if row.status != Status::Newborn {
            return Err(format!("committed point {id} of the births in frame {frame} before it was newborn"));
        }
        if !self.born.insert(id) {
            return Err(format!("gave birth to point {id} in frame {frame} a second time"));
        }
        let k = self.of(id).end;
        self.lives.insert(k, Life { id, from: now, until: u64::MAX, read: now });
        Ok(k)
    }

    /// Drops lives that have no rows to come.
    fn forget(&mut self) {
        let now = self.n_read;
        if self.lives.iter().any(|life| life.until <= now) {
            self.lives.retain(|life| life.until > now);
        }
    }
}

/// The rows of a table, each checked by itself.
fn rows(table: &Table) -> Result<Vec<PointRow>, String> {
    let (ids, statuses) = (table.required::<u32>("id"), table.required::<u8>("status"));
    let (xs, ys) = (table.required::<f32>("x"), table.required::<f32>("y"));
    let (fbs, nccs) = (table.column::<f32>("fb"), table.column::<f32>("ncc"));
    let mut rows = Vec::with_capacity(ids.len());
    for (k, &id) in ids.iter().enumerate() {
        let (x, y, fb, ncc) =
            (xs[k], ys[k], fbs.map_or(FB_NONE, |fb| fb[k]), nccs.map_or(NCC_NONE, |ncc| ncc[k]));
        if !(x.is_finite() && y.is_finite()) {
            return Err(format!("put point {id} at ({x}, {y})"));
        }
        rows.push(PointRow {
            id,
            x,
            y,
            status: Status::from_u8(statuses[k])
                .ok_or_else(|| format!("gave point {id} status {}", statuses[k]))?,
            fb: measured(fb, FB_NONE, 0.0..=f32::MAX).ok_or_else(|| format!("gave point {id} fb {fb}"))?,
            // Rounding may carry a correlation a little past 1.
            ncc: measured(ncc, NCC_NONE, -1.001..=1.001)
                .ok_or_else(|| format!("gave point {id} ncc {ncc}"))?
                .map(|ncc| ncc.clamp(-1.0, 1.0)),
        });
    }
    Ok(rows)
}

/// A quality that may not have been measured; `None` when it is out of its range.
fn measured(value: f32, none: f32, range: std::ops::RangeInclusive<f32>) -> Option<Option<f32>> {
    if value.to_bits() == none.to_bits() { Some(None) } else { range.contains(&value).then_some(Some(value)) }
}

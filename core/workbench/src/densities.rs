//! Power over frequency in units that others have, too: Welch's densities of series and of tracks.

pub use honami_motion::welch::{Density, HalfPower, Window};
use honami_motion::welch::{FEWEST, Welch};

/// Pieces in a record where nothing is said of their length: with halves that overlap there are seven.
const IN_A_RECORD: usize = 4;

/// How series are cut into pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pieces {
    /// What they are seen through.
    pub window: Window,
    /// Length of each, seconds; a fourth of the record where nothing is said.
    pub piece_s: Option<f64>,
}

/// Pieces that a record cannot be cut into.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PieceError {
    /// Longer than the record.
    #[error("pieces of {piece_s} s are longer than the record, which has {lasts_s:.2} s: --piece is shorter")]
    Long {
        /// Asked for, seconds.
        piece_s: f64,
        /// What there is, seconds.
        lasts_s: f64,
    },
    /// Too few samples.
    #[error(
        "pieces of {piece_s} s have fewer than {FEWEST} samples, which last {:.3} s here: --piece is longer",
        FEWEST as f64 / fps
    )]
    Short {
        /// Asked for, seconds.
        piece_s: f64,
        /// Samples a second.
        fps: f64,
    },
}

impl Pieces {
    /// For records of so many samples; `None` where they are too few for any piece.
    pub(crate) fn welch(self, fps: f64, n_samples: usize) -> Result<Option<Welch>, PieceError> {
        let n_piece = match self.piece_s {
            None => (n_samples / IN_A_RECORD).max(FEWEST),
            Some(piece_s) => {
                let n_piece = (piece_s * fps).round();
                if n_piece < FEWEST as f64 {
                    return Err(PieceError::Short { piece_s, fps });
                }
                if n_piece > n_samples as f64 {
                    return Err(PieceError::Long { piece_s, lasts_s: n_samples as f64 / fps });
                }
                n_piece as usize
            }
        };
        Ok(Welch::new(fps, self.window, n_piece).ok().filter(|_| n_piece <= n_samples))
    }
}

/// The density of a track, of x and y together, from where it was seen without a break.
pub(crate) fn of_track(welch: &Welch, positions: &[Option<[f32; 2]>]) -> Option<Density> {
    let is_gap = |at: &Option<[f32; 2]>| !at.is_some_and(|at| at.iter().all(|c| c.is_finite()));
    let unbroken: Vec<&[Option<[f32; 2]>]> = positions.split(is_gap).collect();
    let along = |axis: usize| {
        let values =
            |stretch: &&[Option<[f32; 2]>]| stretch.iter().flatten().map(|at| f64::from(at[axis])).collect();
        let stretches: Vec<Vec<f64>> = unbroken.iter().map(values).collect();
        welch.density(&stretches.iter().map(Vec::as_slice).collect::<Vec<_>>())
    };
    Some(along(0)?.plus(&along(1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_fit_a_record() {
        let pieces = |piece_s| Pieces { piece_s, ..Pieces::default() };
        let length =
            |piece_s, n| pieces(piece_s).welch(10.0, n).map(|welch| welch.map(|welch| welch.piece_s()));
        for (piece_s, n, wanted) in [
            (None, 400, Ok(Some(10.0))),
            (None, 20, Ok(Some(0.8))),
            (None, 7, Ok(None)),
            (Some(2.0), 400, Ok(Some(2.0))),
            (Some(0.7), 400, Err(PieceError::Short { piece_s: 0.7, fps: 10.0 })),
            (Some(40.1), 400, Err(PieceError::Long { piece_s: 40.1, lasts_s: 40.0 })),
        ] {
            assert_eq!(length(piece_s, n), wanted, "{piece_s:?} of {n}");
        }
    }

    #[test]
    fn a_track_has_the_power_of_both_directions_from_where_it_is_seen() {
        // 3 px across and 4 px down have 12.5 px² on average, whatever lies in the gap.
        let at = |k: u32| {
            let swing = (std::f64::consts::TAU * 2.0 * f64::from(k) / 25.0).sin();
            (!(100..110).contains(&k)).then_some([(3.0 * swing) as f32, (4.0 * swing + 7.0) as f32])
        };
        let positions: Vec<_> = (0..300).map(at).collect();
        let welch = Pieces { piece_s: Some(2.0), ..Pieces::default() }.welch(25.0, 300).unwrap().unwrap();
        let found = of_track(&welch, &positions).unwrap();
        assert!((found.mean_square() / 12.5 - 1.0).abs() < 0.02, "{}", found.mean_square());
        assert_eq!(found.n_pieces, 3 + 6, "of 100 and of 190 frames, 50 each, by 25");
        assert_eq!(of_track(&welch, &positions[80..120]), None);
    }
}

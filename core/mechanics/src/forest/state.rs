//! What later steps of a forest depend on, as bytes.

use super::Forest;

/// Bytes that are not the state of this forest.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// Of other copies or other modes, or cut off.
    #[error(
        "a state of {copies} copies with {modes} modes has {wanted} bytes and begins with these numbers; {came} came, of {came_copies} copies with {came_modes} modes"
    )]
    Size {
        /// Of this forest.
        copies: usize,
        /// Of each.
        modes: usize,
        /// So many bytes.
        wanted: usize,
        /// So many came.
        came: usize,
        /// What they say of copies,
        came_copies: u64,
        /// and of modes.
        came_modes: u64,
    },
    /// Numbers that no plant can have.
    #[error("a state of numbers that are none")]
    Numbers,
}

/// Copies, modes, seconds.
const HEAD_BYTES: usize = 24;

impl Forest {
    /// Time, amplitudes and speeds: the same bytes for the same state.
    #[must_use]
    pub fn save(&self) -> Vec<u8> {
        let sizes = [self.copies.len() as u64, self.omegas.len() as u64];
        let numbers = self.amplitudes.iter().chain(&self.speeds).flat_map(|v| v.to_le_bytes());
        let head = sizes.into_iter().flat_map(u64::to_le_bytes).chain(self.time.to_le_bytes());
        head.chain(numbers).collect()
    }

    /// Goes on from what was saved.
    ///
    /// # Errors
    /// [`StateError`]; it then goes on as before.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let (copies, modes) = (self.copies.len(), self.omegas.len());
        let number = |k: usize| bytes.get(8 * k..8 * k + 8).and_then(|bytes| bytes.try_into().ok());
        let [came_copies, came_modes, time] = [0, 1, 2].map(|k| number(k).map_or(0, u64::from_le_bytes));
        let wanted = HEAD_BYTES + 2 * copies * modes * size_of::<f32>();
        if bytes.len() != wanted || [came_copies, came_modes] != [copies as u64, modes as u64] {
            let came = bytes.len();
            return Err(StateError::Size { copies, modes, wanted, came, came_copies, came_modes });
        }
        let time = f64::from_bits(time);
        let numbers = bytes[HEAD_BYTES..].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        let numbers: Vec<f32> = numbers.collect();
        if !time.is_finite() || !numbers.iter().all(|v| v.is_finite()) {
            return Err(StateError::Numbers);
        }
        let (amplitudes, speeds) = numbers.split_at(copies * modes);
        self.amplitudes.copy_from_slice(amplitudes);
        self.speeds.copy_from_slice(speeds);
        self.time = time;
        Ok(())
    }
}

//! What a plugin carries from frame to frame, or from step to step, as bytes that go on where it stopped.

#[cfg(test)]
mod tests;

use crate::tracker::{Stream, Tracker};
use crate::{Error, Result};

/// How a tracker saves what later frames depend on, and goes on from it.
///
/// The bytes are the tracker's own. Around them the SDK lays whose they are, of which parameters and stream, and their sum:
/// `load` is only given what `save` gave under the same `version`.
#[derive(Debug)]
pub struct State<T: Tracker> {
    /// Another one when the bytes mean something else.
    pub version: u32,
    /// All that later frames depend on; the same bytes for the same state.
    pub save: fn(&T) -> Result<Vec<u8>>,
    /// The tracker as it was when it saved these bytes. It must bear any others, too.
    pub load: fn(&T::Params, &Stream, &[u8]) -> Result<T>,
}

/// What saved bytes begin with; then their sum, whose they are, and under what they were saved.
const MAGIC: u64 = u64::from_le_bytes(*b"honami/1");
/// Bytes before the tracker's own.
const HEAD_BYTES: usize = 32;

/// Under what a tracker works: bytes of another setting are refused.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    /// Of the parameters, by [`mix`].
    pub(crate) params: u64,
    pub(crate) stream: Stream,
}

impl Setting {
    fn sum(&self) -> u64 {
        let Stream { width, height, reversed, seed, births, .. } = &self.stream;
        let numbers = [*width, *height, u32::from(*reversed), births.start, births.end].map(u64::from);
        numbers.iter().chain([seed]).fold(self.params, |sum, number| mix(sum, &number.to_le_bytes()))
    }
}

/// Whose bytes they are, and under what they were saved, as numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whose {
    /// Of the plugin's id and the version of its bytes,
    pub(crate) whose: u64,
    /// and of its parameters and what it works on.
    pub(crate) under: u64,
}

impl Whose {
    /// Of a tracker in a stream.
    fn tracker<T: Tracker>(state: &State<T>, setting: &Setting) -> Self {
        Self { whose: mix(u64::from(state.version), T::INFO.id.as_bytes()), under: setting.sum() }
    }
}

/// What is laid before a plugin's own bytes.
pub(crate) fn head(by: Whose, own: &[u8]) -> [u8; HEAD_BYTES] {
    let sum = [by.whose, by.under].iter().fold(mix(0, own), |sum, number| mix(sum, &number.to_le_bytes()));
    let mut head = [0; HEAD_BYTES];
    for (place, number) in head.chunks_exact_mut(8).zip([MAGIC, sum, by.whose, by.under]) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    head
}

/// A plugin's own bytes behind the head, which must be that of these.
pub(crate) fn own(by: Whose, bytes: &[u8]) -> Result<&[u8]> {
    let refused = |what: &str| Error::data(format!("what was saved {what}"));
    let (said, own) = bytes.split_at_checked(HEAD_BYTES).ok_or_else(|| refused("is cut off"))?;
    let wanted = head(by, own);
    let differs = |k: usize| said[8 * k..][..8] != wanted[8 * k..][..8];
    if differs(0) {
        return Err(refused("is something else"));
    }
    if differs(2) {
        return Err(refused("is of another plugin, or of another version of it"));
    }
    if differs(3) {
        return Err(refused("is of other parameters, or of another input"));
    }
    if differs(1) {
        return Err(refused("is damaged"));
    }
    Ok(own)
}

/// Whatever a plugin says of its own bytes, it cannot work on them.
pub(crate) fn unreadable(error: &Error) -> Error {
    Error::data(format!("what was saved cannot be read: {error}"))
}

/// What is laid before a tracker's own bytes.
pub(crate) fn tracker_head<T: Tracker>(state: &State<T>, setting: &Setting, own: &[u8]) -> [u8; HEAD_BYTES] {
    head(Whose::tracker(state, setting), own)
}

/// The tracker that saved these bytes.
pub(crate) fn load<T: Tracker>(
    state: &State<T>,
    params: &T::Params,
    setting: &Setting,
    bytes: &[u8],
) -> Result<T> {
    let own = own(Whose::tracker(state, setting), bytes)?;
    (state.load)(params, &setting.stream, own).map_err(|error| unreadable(&error))
}

/// Adds bytes to a sum. One that differs in a single place always has another sum.
pub(crate) fn mix(sum: u64, bytes: &[u8]) -> u64 {
    let add = |sum: u64, word: u64| (sum.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let (words, rest) = bytes.as_chunks::<8>();
    let sum = words.iter().fold(sum, |sum, word| add(sum, u64::from_le_bytes(*word)));
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    add(add(sum, u64::from_le_bytes(last)), bytes.len() as u64)
}

//! Bytes of what trackers carry from frame to frame.

use honami_plugin::{Error, Result};
use serde::{Deserialize, Serialize};

/// The bytes of what a tracker carries; the same for the same.
///
/// # Errors
/// When there is no memory for them.
pub fn to_bytes<T: Serialize>(carried: &T) -> Result<Vec<u8>> {
    Ok(postcard::to_allocvec(carried)?)
}

/// What a tracker carried that saved these bytes.
///
/// # Errors
/// When they are not all of it, or more.
pub fn from_bytes<'b, T: Deserialize<'b>>(bytes: &'b [u8]) -> Result<T> {
    let (carried, rest) = postcard::take_from_bytes(bytes)?;
    if rest.is_empty() { Ok(carried) } else { Err(Error::data(format!("{} bytes too many", rest.len()))) }
}

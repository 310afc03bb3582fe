//! Pictures among the bytes that a tracker saves.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::Gray;

/// A picture of its own memory, without gaps between rows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedPicture {
    width: u32,
    height: u32,
    #[serde(serialize_with = "write", deserialize_with = "read")]
    data: Vec<u8>,
}

impl SavedPicture {
    /// A copy of a picture.
    #[must_use]
    pub fn of(picture: &Gray<'_>) -> Self {
        let Gray { width, height, .. } = *picture;
        let mut data = Vec::with_capacity(width as usize * height as usize);
        (0..height).for_each(|y| data.extend_from_slice(picture.row(y)));
        Self { width, height, data }
    }

    /// The picture; `None` where the bytes are not as many as its pixels, or there are none.
    #[must_use]
    pub fn gray(&self) -> Option<Gray<'_>> {
        let Self { width, height, ref data } = *self;
        let is_whole = !data.is_empty() && data.len() as u64 == u64::from(width) * u64::from(height);
        is_whole.then_some(Gray { data, width, height, stride: width as usize })
    }
}

// A number at a time would take longer than tracking does.
fn write<S: Serializer>(data: &[u8], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_bytes(data)
}

fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
    <&[u8]>::deserialize(from).map(<[u8]>::to_vec)
}

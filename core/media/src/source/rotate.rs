//! Turns frames upright where the file says that the camera was held on its side.

use super::{Decode, Probed, Shape, Source};
use crate::error::MediaError;

/// The clip turned clockwise by `quarters` times 90 degrees, as players show it.
pub(crate) fn turned(probed: Probed, quarters: u32) -> Probed {
    let quarters = quarters % 4;
    if quarters == 0 {
        return probed;
    }
    let stored = probed.shape;
    let (width, height) =
        if quarters == 2 { (stored.width, stored.height) } else { (stored.height, stored.width) };
    let mut notes = probed.notes;
    notes.push(format!("turned by {} degrees clockwise, as the file asks", 90 * quarters));
    Probed {
        shape: Shape { width, height, ..stored },
        times_s: probed.times_s,
        notes,
        source: Box::new(Turned { inner: probed.source, stored, quarters }),
    }
}

struct Turned {
    inner: Box<dyn Source>,
    stored: Shape,
    quarters: u32,
}

impl Source for Turned {
    fn recipe(&self) -> String {
        format!("{}, turned {}", self.inner.recipe(), self.quarters)
    }

    fn is_raw(&self) -> bool {
        self.inner.is_raw()
    }

    fn decode(&self, wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        let (start, inner) = self.inner.decode(wanted)?;
        let upright = vec![0; self.stored.frame_len()];
        Ok((start, Box::new(Turning { inner, stored: self.stored, quarters: self.quarters, lying: upright })))
    }
}

struct Turning {
    inner: Box<dyn Decode>,
    stored: Shape,
    quarters: u32,
    lying: Vec<u8>,
}

impl Decode for Turning {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        if !self.inner.next(&mut self.lying)? {
            return Ok(false);
        }
        let shape = self.stored;
        let (luma, chroma) = self.lying.split_at(shape.luma_len());
        let (to_luma, to_chroma) = frame.split_at_mut(shape.luma_len());
        turn(luma, shape.width as usize, self.quarters, to_luma);
        let half = shape.width.div_ceil(2) as usize;
        for (from, to) in
            chroma.chunks_exact(shape.chroma_len()).zip(to_chroma.chunks_exact_mut(shape.chroma_len()))
        {
            turn(from, half, self.quarters, to);
        }
        Ok(true)
    }
}

/// Turns one plane with rows of `width` clockwise by quarters: an exact permutation of its samples.
pub(crate) fn turn(from: &[u8], width: usize, quarters: u32, to: &mut [u8]) {
    let height = from.len() / width;
    for (y, row) in from.chunks_exact(width).enumerate() {
        for (x, &value) in row.iter().enumerate() {
            let at = match quarters {
                1 => x * height + (height - 1 - y),
                2 => (height - 1 - y) * width + (width - 1 - x),
                3 => (width - 1 - x) * height + y,
                _ => y * width + x,
            };
            to[at] = value;
        }
    }
}

#[cfg(test)]
mod tests;

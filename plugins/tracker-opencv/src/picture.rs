//! Frames as OpenCV and as honami's own algorithms want them.

use honami_vision::Gray;
use opencv::core::{CV_8UC1, Mat};
use opencv::prelude::*;

/// A copy of a frame, without gaps between rows: what the host hands out is gone with the call.
pub(crate) struct Picture {
    /// Its pixels, in one channel.
    pub(crate) mat: Mat,
}

impl Picture {
    pub(crate) fn copy(gray: &Gray<'_>) -> opencv::Result<Self> {
        let mut mat =
            Mat::new_rows_cols_with_default(gray.height as i32, gray.width as i32, CV_8UC1, 0.into())?;
        let rows = mat.data_bytes_mut()?.chunks_exact_mut(gray.width as usize);
        rows.zip(0..).for_each(|(row, y)| row.copy_from_slice(gray.row(y)));
        Ok(Self { mat })
    }

    /// Width and height, pixels.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.mat.cols() as u32, self.mat.rows() as u32)
    }

    pub(crate) fn gray(&self) -> opencv::Result<Gray<'_>> {
        let (width, height) = self.size();
        Ok(Gray { data: self.mat.data_bytes()?, width, height, stride: width as usize })
    }
}

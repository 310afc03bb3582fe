//! Frames in: videos and image sequences with exact random access; and movies out.
//!
//! [`open()`] takes a video (through a child ffmpeg, or H.264 in MP4 without it), a Y4M file, a folder of images or
//! an image pattern. Frame n is the n-th frame of a sequential decode in display order, always the same bytes: a
//! thread decodes the clip once into a memory-mapped cache, from which frames are read in any order. The cache is
//! bounded and can be deleted at any time; without it frames are decoded on demand, exactly but slower.
//!
//! Pixels are 8 bits. Luma is what the video codes; chroma is kept at half size (4:2:0). RGB images become
//! full-range BT.601 YCbCr. Frames are as stored (not scaled for oblong pixels), but turned upright.

mod cache;
mod convert;
mod demand;
mod error;
mod hash;
mod media;
mod open;
mod programs;
mod scale;
mod source;
mod still;
pub mod write;

pub use error::{MediaError, Size};
pub use hash::{sha256_of_bytes, sha256_of_file};
pub use media::{FrameRef, Media};
pub use open::{
    Decoder, Extent, OpenOptions, Step, cache_folder, open, open_images, open_with, sha256_of_clip, size_of,
};
pub use programs::ffmpeg_version;
pub use scale::Rect;
pub use still::Still;

#[cfg(test)]
mod tests;

//! Pyramids, sub-pixel sampling, corners, correlation and optical flow on 8-bit luma.
//!
//! Pixel convention, here and everywhere in honami: x right, y down, `(0, 0)` is the **centre** of the
//! top-left pixel, so a picture covers `-0.5..width - 0.5` by `-0.5..height - 0.5`. Positions are `[x, y]` in
//! pixels. Windows are given by radius; their side is `2 * radius + 1`.
//!
//! Nothing here does input or output, keeps a clock or draws a random number; results are the same bits for
//! any number of threads and at every SIMD level (Fourier transforms, in `piv`, round as the processor has them).

pub mod anchor;
pub mod board;
pub mod boxes;
pub mod detect;
pub mod field;
pub mod horn_schunck;
pub mod klt;
pub mod lucas_kanade;
pub mod meanshift;
pub mod meeting;
pub mod ncc;
pub mod particles;
pub mod piv;
pub mod plane;
pub mod pyramid;
pub mod robust;
pub mod sample;
pub mod saved;
pub mod simd;
pub mod texture;
pub mod work;

/// What everything here looks at.
pub use honami_model::picture::{Chroma, Gray};

/// A position in a picture, `[x, y]`, pixels.
pub type Point = [f32; 2];

#[cfg(test)]
mod middlebury;

/// Property tests draw the same cases in every run.
#[cfg(test)]
fn cases(cases: u32) -> proptest::test_runner::Config {
    use proptest::test_runner::{Config, RngSeed};
    Config { cases, rng_seed: RngSeed::Fixed(0), failure_persistence: None, ..Config::default() }
}

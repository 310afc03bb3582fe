//! Measures a clip as a reviewer meets it and prints JSON: `media_bench CLIP [ffmpeg|builtin]`.
//!
//! The clip is decoded anew into an empty cache, so decoding is part of the numbers.
#![expect(clippy::print_stdout, reason = "a benchmark reports on standard output")]

use std::path::Path;
use std::time::Instant;

use honami_media::{Decoder, MediaError, OpenOptions, Rect, open};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Terminal picture: 160x90 half-block pixels.
const PICTURE: (u32, u32) = (160, 90);
const N_SEEKS: usize = 500;

fn main() -> Result<(), MediaError> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "clip.mp4".to_owned());
    let decoder = match args.next().as_deref() {
        Some("ffmpeg") => Decoder::Ffmpeg,
        Some("builtin") => Decoder::Builtin,
        _ => Decoder::Auto,
    };
    let cache = std::env::temp_dir().join(format!("honami-media-bench-{}", std::process::id()));
    let options = OpenOptions { cache_dir: Some(cache.clone()), decoder, ..OpenOptions::default() };
    let report = measure(Path::new(&path), &options);
    std::fs::remove_dir_all(&cache).unwrap_or_default();
    println!("{:#}", report?);
    Ok(())
}

fn measure(path: &Path, options: &OpenOptions) -> Result<serde_json::Value, MediaError> {
    let start = Instant::now();
    let media = open(path, options)?;
    let open_ms = ms(start);
    let n = media.clip().n_frames();
    media.frame(0)?;
    let first_frame_ms = ms(start);
    media.frame(n - 1)?;
    let decode_fps = f64::from(n) / start.elapsed().as_secs_f64();

    let touch = |k: u32| -> Result<f64, MediaError> {
        let start = Instant::now();
        let frame = media.frame(k)?;
        std::hint::black_box(frame.bytes().iter().map(|&b| u64::from(b)).sum::<u64>());
        Ok(ms(start))
    };
    let mut back = (0..n).rev().map(touch).collect::<Result<Vec<_>, _>>()?;
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut seeks = (0..N_SEEKS).map(|_| touch(random.random_range(0..n))).collect::<Result<Vec<_>, _>>()?;

    let (width, height) = PICTURE;
    let whole = Rect::whole(media.clip().width, media.clip().height);
    let start = Instant::now();
    for k in (0..n).rev() {
        std::hint::black_box(media.rgb_area(k, whole, width, height)?);
    }
    let play_s = start.elapsed().as_secs_f64();
    drop(media);
    let start = Instant::now();
    drop(open(path, options)?);
    Ok(serde_json::json!({
        "clip": path.file_name().unwrap_or_default().to_string_lossy(),
        "frames": n,
        "open_ms": open_ms,
        "first_frame_ms": first_frame_ms,
        "decode_fps": decode_fps,
        "step_back_ms": {"median": quantile(&mut back, 0.5), "p99": quantile(&mut back, 0.99)},
        "seek_ms": {"median": quantile(&mut seeks, 0.5), "p99": quantile(&mut seeks, 0.99)},
        "rgb_area_ms": play_s * 1e3 / f64::from(n),
        "play_back_fps_160x90": f64::from(n) / play_s,
        "reopen_ms": ms(start),
    }))
}

fn ms(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * q).round() as usize]
}

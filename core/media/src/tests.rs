//! Clips that the tests make or find, and the proof that any order of reading gives the same frames.

use std::path::{Path, PathBuf};
use std::process::Command;

use honami_model::clip::{Clip, FrameTimes};
use image::{DynamicImage, GrayImage, ImageBuffer, RgbImage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use tempfile::TempDir;

use crate::cache::{Filling, Folder, Wanted};
use crate::media::Head;
use crate::source::Shape;
use crate::{Decoder, Media, OpenOptions, ffmpeg_version, open};

mod bad;
mod caching;
mod exact;
mod kinds;
mod videos;

/// A folder of its own with a cache of its own.
struct Place {
    dir: TempDir,
}

impl Place {
    fn new() -> Self {
        Self { dir: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn cache(&self) -> PathBuf {
        self.path("cache")
    }

    fn options(&self) -> OpenOptions {
        OpenOptions { cache_dir: Some(self.cache()), ..OpenOptions::default() }
    }

    fn open(&self, name: &str) -> Media {
        open(&self.path(name), &self.options()).unwrap()
    }

    /// Names in a folder, sorted.
    fn names(&self, folder: &str) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(self.path(folder)) else { return Vec::new() };
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Names of the cache's files, without the key.
    fn cached(&self) -> Vec<String> {
        self.names("cache").iter().map(|name| name.rsplit('.').next().unwrap().to_owned()).collect()
    }

    /// A cache file to be filled with `n` frames.
    fn filling(&self, shape: Shape, n: u32) -> Filling {
        let wanted = Wanted { key: "key".to_owned(), shape, n_frames: n };
        Folder::find(Some(&self.cache()), None).unwrap().begin(&wanted).unwrap()
    }

    /// What opening would know of a clip of `n` frames.
    fn head(&self, shape: Shape, n: u32) -> Head {
        let clip =
            Clip { width: shape.width, height: shape.height, times: FrameTimes::constant(n, 25.0).unwrap() };
        Head {
            clip,
            notes: Vec::new(),
            sha256: String::new(),
            path: self.path("clip"),
            shape,
            recent_frames: Some(2),
            miscounted: None,
        }
    }

    /// `n` moving gray pictures as PNG, in a folder.
    fn png_folder(&self, name: &str, n: u32, width: u32, height: u32) -> PathBuf {
        let folder = self.path(name);
        std::fs::create_dir_all(&folder).unwrap();
        for k in 0..n {
            gray(width, height, k).save(folder.join(format!("f{k}.png"))).unwrap();
        }
        folder
    }
}

/// A picture that differs from frame to frame in every row: a moving ramp with seeded noise.
fn gray(width: u32, height: u32, frame: u32) -> GrayImage {
    let mut random = Pcg64Mcg::seed_from_u64(u64::from(frame));
    ImageBuffer::from_fn(width, height, |x, y| {
        let ramp = (3 * x + 5 * y + 7 * frame) % 200;
        image::Luma([ramp as u8 + random.random_range(0..50)])
    })
}

fn rgb(width: u32, height: u32, frame: u32) -> RgbImage {
    let channels = [0, 100, 200].map(|seed| gray(width, height, frame + seed));
    ImageBuffer::from_fn(width, height, |x, y| {
        image::Rgb(channels.each_ref().map(|c| c.get_pixel(x, y).0[0]))
    })
}

fn bytes_of(media: &Media) -> Vec<Vec<u8>> {
    (0..media.clip().n_frames()).map(|n| media.frame(n).unwrap().bytes().to_vec()).collect()
}

/// Runs ffmpeg in `dir`; `false`, with a line, where it is not installed.
fn ffmpeg(dir: &Path, arguments: &str) -> bool {
    if ffmpeg_version().is_none() {
        eprintln!("skipped: needs ffmpeg");
        return false;
    }
    let mut command = Command::new("ffmpeg");
    command.current_dir(dir).args(["-nostdin", "-v", "error", "-y"]).args(arguments.split_whitespace());
    assert!(command.status().unwrap().success(), "ffmpeg {arguments}");
    true
}

/// A file of the real data, or `None`, with a line, where there is none.
fn data(name: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA ({name})");
        return None;
    };
    let path = Path::new(&root).join(name);
    assert!(path.exists(), "{} is missing", path.display());
    Some(path)
}

/// Every frame in order, then 200 seeded seeks, then 200 steps back from the end: always the same bytes. Their hashes.
fn assert_exact(media: &Media) -> Vec<String> {
    let n = media.clip().n_frames();
    let hash = |k: u32| crate::hash::sha256_of_bytes(media.frame(k).unwrap().bytes());
    let in_order: Vec<String> = (0..n).map(hash).collect();
    let mut random = Pcg64Mcg::seed_from_u64(n.into());
    for _ in 0..200 {
        let k = random.random_range(0..n);
        assert_eq!(hash(k), in_order[k as usize], "frame {k} of {media:?}");
    }
    for k in (0..n).rev().take(200) {
        assert_eq!(hash(k), in_order[k as usize], "frame {k} of {media:?}, going back");
    }
    in_order
}

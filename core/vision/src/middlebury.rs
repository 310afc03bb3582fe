//! Pairs of pictures whose motion is known at every pixel: textures that are moved here, and the Middlebury pairs where
//! `HONAMI_DATA` names a folder that has them. For tests.

use std::path::{Path, PathBuf};

use honami_model::picture::Gray;

use crate::field::Field;
use crate::plane::Scales;
use crate::{Point, texture};

/// Two pictures and the motion between them.
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pictures: [Vec<u8>; 2],
    /// Displacement of every pixel, row by row; `None` where it is not known.
    pub(crate) truth: Vec<Option<Point>>,
}

impl Pair {
    /// A texture that moves by a law: where a place of the second picture was in the first. The law is affine,
    /// `back = A x + b` with `A` row by row, about the middle of the picture.
    pub(crate) fn affine(name: &str, size: (u32, u32), a: [f64; 4], b: [f64; 2]) -> Self {
        let (width, height) = size;
        let middle = [f64::from(width - 1) / 2.0, f64::from(height - 1) / 2.0];
        let still = texture::render(width, height, |x, y| texture::value(5, x, y));
        let moved = texture::render(width, height, |x, y| {
            let (x, y) = (x - middle[0], y - middle[1]);
            let (x, y) = (a[0] * x + a[1] * y + b[0], a[2] * x + a[3] * y + b[1]);
            texture::value(5, x + middle[0], y + middle[1])
        });
        let determinant = a[0] * a[3] - a[1] * a[2];
        let forth = |x: f64, y: f64| {
            let (dx, dy) = (x - middle[0] - b[0], y - middle[1] - b[1]);
            let to = [(a[3] * dx - a[1] * dy) / determinant, (a[0] * dy - a[2] * dx) / determinant];
            [(to[0] + middle[0] - x) as f32, (to[1] + middle[1] - y) as f32]
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x), f64::from(y))));
        let truth = pixels.map(|(x, y)| Some(forth(x, y))).collect();
        Self { name: name.to_owned(), width, height, pictures: [still, moved], truth }
    }

    /// One of the pairs of Baker et al., "A database and evaluation methodology for optical flow", IJCV 92, 2011.
    pub(crate) fn middlebury(name: &str) -> Option<Self> {
        let Some(root) = std::env::var_os("HONAMI_DATA") else {
            eprintln!("skipped: needs HONAMI_DATA (flow/middlebury/{name})");
            return None;
        };
        let folder: PathBuf = Path::new(&root).join("flow/middlebury").join(name);
        let picture = |file: &str| image::open(folder.join(file)).unwrap().to_luma8();
        let [first, second] = ["frame10.png", "frame11.png"].map(picture);
        let (width, height) = first.dimensions();
        let flow = std::fs::read(folder.join("flow10.flo")).unwrap();
        let words: Vec<[u8; 4]> = flow.chunks_exact(4).map(|w| w.try_into().unwrap()).collect();
        assert_eq!(f32::from_le_bytes(words[0]).to_bits(), 202_021.25_f32.to_bits());
        assert_eq!([words[1], words[2]].map(u32::from_le_bytes), [width, height]);
        let known = |d: Point| d.iter().all(|c| c.abs() < 1e9).then_some(d);
        let truth =
            words[3..].chunks_exact(2).map(|d| known([f32::from_le_bytes(d[0]), f32::from_le_bytes(d[1])]));
        let truth = truth.collect();
        Some(Self {
            name: name.to_owned(),
            width,
            height,
            pictures: [first.into_raw(), second.into_raw()],
            truth,
        })
    }

    /// Pyramids of both pictures.
    pub(crate) fn scales(&self, n_levels: u32, smoothing_px: f32) -> [Scales; 2] {
        self.pictures
            .each_ref()
            .map(|data| Scales::new(&Gray::packed(data, self.width, self.height), n_levels, smoothing_px, 2))
    }

    /// Errors at the pixels, pixels, smallest first: of those that stay in the picture, `margin` pixels from its border,
    /// whose truth and motion are known. And the share of these pixels whose motion is known.
    pub(crate) fn errors(&self, field: &Field, margin: u32) -> (Vec<f32>, f64) {
        let inside = |[x, y]: Point, margin: f32| {
            (margin..=(self.width - 1) as f32 - margin).contains(&x)
                && (margin..=(self.height - 1) as f32 - margin).contains(&y)
        };
        let (mut errors, mut n) = (Vec::new(), 0);
        for (i, truth) in (0..).zip(&self.truth) {
            let at = [(i % self.width) as f32, (i / self.width) as f32];
            let Some(d) = *truth else { continue };
            if inside(at, margin as f32) && inside([at[0] + d[0], at[1] + d[1]], margin as f32) {
                n += 1;
                errors.extend(field.at(at).map(|got| (got[0] - d[0]).hypot(got[1] - d[1])));
            }
        }
        errors.sort_by(f32::total_cmp);
        let share = errors.len() as f64 / f64::from(n.max(1));
        (errors, share)
    }
}

/// Mean of errors.
pub(crate) fn mean(errors: &[f32]) -> f64 {
    errors.iter().map(|e| f64::from(*e)).sum::<f64>() / errors.len() as f64
}

/// Motions of a texture that every dense method is held against.
pub(crate) fn moved() -> Vec<Pair> {
    let (sin, cos) = 0.03_f64.sin_cos();
    let one = [1.0, 0.0, 0.0, 1.0];
    [
        ("still", one, [0.0; 2]),
        ("a fraction", one, [-0.3, 0.45]),
        ("two pixels", one, [-2.3, 1.6]),
        ("fourteen pixels", one, [13.7, -4.2]),
        ("a turn", [cos, sin, -sin, cos], [0.0; 2]),
        ("a shear and a stretch", [1.03, 0.04, 0.0, 0.98], [0.5, 0.0]),
    ]
    .map(|(name, a, b)| Pair::affine(name, (240, 180), a, b))
    .into()
}

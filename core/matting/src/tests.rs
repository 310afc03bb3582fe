//! Whole mattes: against the definition, against the authors' own code, and where the opacities are known.

use std::path::Path;

use nalgebra::{Cholesky, DMatrix, DVector};

use super::*;
use crate::laplacian::definition;

/// Integers below `n` that look drawn by chance.
pub(crate) fn noise(seed: u32, n: u32) -> impl FnMut() -> u32 {
    let mut state = u64::from(seed) * 2 + 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(n)) as u32
    }
}

/// Pictures of every kind that a window may meet, with a name.
pub(crate) fn kinds(width: usize, height: usize) -> Vec<(&'static str, Vec<[u8; 3]>)> {
    let mut any = noise(3, 256);
    let noisy = (0..width * height).map(|_| [0; 3].map(|_: u8| any() as u8)).collect();
    let places = || (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let mut grain = noise(5, 9);
    let two = places().map(|[x, y]| {
        let colour: [u32; 3] = if x + y > (width + height) / 2 { [200, 90, 40] } else { [30, 60, 180] };
        colour.map(|value| (value + grain()) as u8)
    });
    let two = two.collect();
    let smooth =
        places().map(|[x, y]| [4 * x + 20, 3 * y + 9, 2 * x + 2 * y].map(|value| value as u8)).collect();
    let mut gray = noise(8, 200);
    let gray = (0..width * height).map(|_| [gray() as u8; 3]).collect();
    let flat = places().map(|[x, _]| if x < width / 2 { [10, 20, 30] } else { [240, 230, 20] }).collect();
    vec![("noise", noisy), ("two colours", two), ("smooth", smooth), ("gray", gray), ("flat", flat)]
}

/// A column of background at the left, one of foreground at the right.
pub(crate) fn columns(width: usize, height: usize) -> Vec<Mark> {
    let row = |x| match x {
        0 => Mark::Background,
        x if x == width - 1 => Mark::Foreground,
        _ => Mark::Unknown,
    };
    (0..width * height).map(|pixel| row(pixel % width)).collect()
}

/// The least of the cost as it is defined, window by window, by dense factors.
fn least(picture: &Picture<'_>, marks: &[Mark], options: &Options) -> DVector<f64> {
    let weight = |mark: &Mark| mark.alpha().map_or(0.0, |_| options.lambda);
    let weights = DVector::from_iterator(marks.len(), marks.iter().map(weight));
    let known = DVector::from_iterator(marks.len(), marks.iter().map(|mark| mark.alpha().unwrap_or(0.0)));
    let cost = definition(picture, options.epsilon) + DMatrix::from_diagonal(&weights);
    Cholesky::new(cost).unwrap().solve(&weights.component_mul(&known))
}

#[test]
fn a_matte_is_the_least_of_the_cost_as_it_is_defined() {
    for (width, height) in [(3, 3), (12, 10), (40, 27)] {
        for (name, rgb) in kinds(width, height) {
            let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
            for (epsilon, lambda) in [(1e-7, 100.0), (1e-4, 1.0)] {
                let options = Options { epsilon, lambda };
                let marks = columns(width, height);
                let found = matte(&picture, &marks, &options, &mut |_| true).unwrap();
                let wanted = least(&picture, &marks, &options);
                let off =
                    found.alpha.iter().zip(&wanted).map(|(a, b)| (f64::from(*a) - b.clamp(0.0, 1.0)).abs());
                let off = off.fold(0.0, f64::max);
                assert!(off < 5e-4, "{name} {width}x{height}, {options:?}: off by {off:e}");
                assert!(found.n_steps <= 60, "{name} {width}x{height}, {options:?}: {} steps", found.n_steps);
            }
        }
    }
}

#[test]
fn opacities_of_colours_on_two_lines_are_found() {
    // Red says how much there is of a foreground whose green varies, before a background whose blue varies: each is on a
    // line of colours, so the opacity is linear in colour (theorem 2 of Levin et al.).
    let (width, height) = (48, 36);
    let mut any = noise(11, 100);
    let truth: Vec<u32> = (0..width * height)
        .map(|pixel| {
            let (x, y) = ((pixel % width) as f64, (pixel / width) as f64);
            (100.0 + 100.0 * ((x - 24.0) / 7.0 + (y / 5.0).sin()).tanh()).round() as u32
        })
        .collect();
    let colour = |&k: &u32| [20 + k, k * any() / 200, (200 - k) * any() / 200].map(|value| value as u8);
    let rgb: Vec<[u8; 3]> = truth.iter().map(colour).collect();
    let mut marks = vec![Mark::Unknown; truth.len()];
    for pixel in 0..truth.len() {
        match truth[pixel] {
            0 if pixel % 11 == 0 => marks[pixel] = Mark::Background,
            200 if pixel % 11 == 0 => marks[pixel] = Mark::Foreground,
            _ => {}
        }
    }
    let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
    let found = matte(&picture, &marks, &Options::default(), &mut |_| true).unwrap();
    let off =
        found.alpha.iter().zip(&truth).map(|(alpha, &k)| (f64::from(*alpha) - f64::from(k) / 200.0).abs());
    let off = off.fold(0.0, f64::max);
    assert!(off < 0.01, "off by {off}");
}

/// A picture of the authors' pair.
fn rgb(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let image = image::open(path).unwrap().to_rgb8();
    (image.width(), image.height(), image.as_raw().as_chunks().0.to_vec())
}

/// What the authors' own code found, with the same ε and λ, from the scribbles; the trimap says the same in other words.
#[test]
fn mattes_are_those_of_the_authors() {
    let Some(root) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA (matting/closed_form)");
        return;
    };
    let folder = Path::new(&root).join("matting/closed_form");
    let (width, height, source) = rgb(&folder.join("source.png"));
    let picture = Picture::new(width, height, &source).unwrap();
    let (_, _, scribbles) = rgb(&folder.join("scribbles.png"));
    let scribbles = from_scribbles(&picture, &Picture::new(width, height, &scribbles).unwrap()).unwrap();
    let trimap = image::open(folder.join("trimap.png")).unwrap().to_luma8();
    let trimap = from_trimap(&picture, trimap.as_raw(), [width, height]).unwrap();
    let wanted = image::open(folder.join("matlab_alpha.png")).unwrap().to_luma8();
    for (name, marks) in [("scribbles", scribbles), ("trimap", trimap)] {
        let found = matte(&picture, &marks, &Options::default(), &mut |_| true).unwrap().gray();
        let off: Vec<u8> = found.iter().zip(wanted.as_raw()).map(|(a, b)| a.abs_diff(*b)).collect();
        // Both are rounded to 1 of 255; beside that they are the same.
        let n_off = off.iter().filter(|&&off| off > 0).count();
        assert!(off.iter().all(|&off| off <= 1), "{name}: off by {:?} of 255", off.iter().max());
        assert!(n_off < off.len() / 50, "{name}: {n_off} of {} pixels are off", off.len());
    }
}

#[test]
fn any_number_of_threads_finds_the_same_bits() {
    // Large enough that every part of the work is shared.
    let (width, height) = (230, 170);
    let (_, rgb) = kinds(width, height).swap_remove(1);
    let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
    let marks = columns(width, height);
    let found = [1, 2, 3].map(|n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| matte(&picture, &marks, &Options::default(), &mut |_| true).unwrap())
    });
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
}

#[test]
fn a_matte_says_how_far_it_is_and_stops_when_told() {
    let (_, rgb) = kinds(40, 27).swap_remove(1);
    let picture = Picture::new(40, 27, &rgb).unwrap();
    let marks = columns(40, 27);
    let mut told = Vec::new();
    let full = matte(&picture, &marks, &Options::default(), &mut |share| {
        told.push(share);
        true
    });
    assert!(told.len() > full.unwrap().n_steps, "{told:?}");
    assert!(told.iter().all(|share| (0.0..=1.0).contains(share)), "{told:?}");
    assert!(told[told.len() - 1] > 0.6, "{told:?}");
    for stop in [0, 1, 3] {
        let mut n_told = 0;
        let stopped = matte(&picture, &marks, &Options::default(), &mut |_| {
            n_told += 1;
            n_told <= stop
        });
        assert_eq!((stopped, n_told), (Err(MattingError::Stopped), stop + 1));
    }
}

#[test]
fn what_makes_no_matte_has_a_name() {
    use MattingError::*;
    let rgb = vec![[9, 9, 9]; 12];
    let new = |width, height| Picture::new(width, height, &rgb).map(|picture| picture.size());
    assert_eq!(new(2, 6), Err(TooSmall { width: 2, height: 6 }));
    assert_eq!(new(4, 4), Err(Pixels { wanted: 16, came: 12 }));
    assert_eq!(new(4000, 3001), Err(TooLarge { width: 4000, height: 3001 }));
    assert_eq!(new(u32::MAX, u32::MAX), Err(TooLarge { width: u32::MAX, height: u32::MAX }));

    let picture = Picture::new(4, 3, &rgb).unwrap();
    let tried = |marks: &[Mark], options: &Options| {
        let matte = matte(&picture, marks, options, &mut |_| true);
        matte.map(|matte| matte.alpha.len())
    };
    let usual = Options::default();
    assert_eq!(tried(&[Mark::Background; 11], &usual), Err(Pixels { wanted: 12, came: 11 }));
    assert_eq!(tried(&[Mark::Unknown; 12], &usual), Err(NothingMarked));
    assert_eq!(tried(&[Mark::Background; 12], &usual), Err(NoForeground));
    assert_eq!(tried(&[Mark::Foreground; 12], &usual), Err(NoBackground));
    assert_eq!(tried(&columns(4, 3), &usual), Ok(12));
    for came in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-10, 2.0] {
        let error = tried(&columns(4, 3), &Options { epsilon: came, ..usual }).unwrap_err();
        assert!(matches!(error, Option { name: "epsilon", .. }), "{error}");
    }
    for came in [f64::NAN, f64::INFINITY, 0.0, 1e7] {
        let error = tried(&columns(4, 3), &Options { lambda: came, ..usual }).unwrap_err();
        assert!(matches!(error, Option { name: "lambda", .. }), "{error}");
    }
}

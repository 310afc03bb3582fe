//! Against sums by hand, colour that is known, and what the paper promises.

use honami_model::picture::{Chroma, Gray};
use proptest::prelude::*;

use super::*;
use crate::texture;

const BINS: Bins = Bins { luma: 16, chroma: 15 };
const PARAMS: Params = Params { max_iterations: 30, epsilon_px: 0.02, adapts: false };

/// Luma and half-size chroma of its own memory.
struct Picture {
    size: [u32; 2],
    y: Vec<u8>,
    cb: Vec<u8>,
    cr: Vec<u8>,
}

impl Picture {
    /// From `[Y, Cb, Cr]` of a place; a chroma sample lies between its four pixels.
    fn new(size: [u32; 2], colour: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        let [width, height] = size;
        let half = [width.div_ceil(2), height.div_ceil(2)];
        let plane = |c: usize, [w, h]: [u32; 2], step: f64, first: f64| -> Vec<u8> {
            let pixels =
                (0..h).flat_map(|y| (0..w).map(move |x| [x, y].map(|k| f64::from(k) * step + first)));
            pixels.map(|[x, y]| colour(x, y)[c].round().clamp(0.0, 255.0) as u8).collect()
        };
        let y = plane(0, size, 1.0, 0.0);
        Self { size, y, cb: plane(1, half, 2.0, 0.5), cr: plane(2, half, 2.0, 0.5) }
    }

    fn colours(&self, coloured: bool) -> Colours {
        let [width, height] = self.size;
        let plane = |data| Gray::packed(data, width.div_ceil(2), height.div_ceil(2));
        let chroma = Chroma { cb: plane(&self.cb), cr: plane(&self.cr) };
        Colours::new(&Gray::packed(&self.y, width, height), coloured.then_some(&chroma), BINS)
    }
}

fn region(at: Point, radius_px: f32) -> Region {
    Region { at, radius_px }
}

fn histogram(colours: &Colours, of: Region) -> Histogram {
    Search::new(colours, &PARAMS).histogram(of).unwrap()
}

fn find(colours: &Colours, model: &Histogram, from: Region, params: &Params) -> Found {
    follow(colours, &[Target { model, from }], params, 1)[0].unwrap()
}

#[test]
fn a_histogram_is_that_worked_out_by_hand() {
    // h = 1.5: the centre weighs 1, its four neighbours 1 - 1/2.25 = 5/9, the corners 1 - 2/2.25 = 1/9; 33/9 together.
    let pixels = [0, 20, 255, 40, 20, 0, 20, 0, 255];
    let bins = Bins { luma: 16, chroma: 1 };
    let colours = Colours::new(&Gray::packed(&pixels, 3, 3), None, bins);
    let found = Search::new(&colours, &PARAMS).histogram(region([1.0, 1.0], 1.5)).unwrap();
    let wanted = [(0, 1.0 + 5.0 + 5.0), (1, 5.0 + 9.0 + 1.0), (2, 5.0), (15, 1.0 + 1.0)];
    assert_eq!(found.shares().len(), wanted.len());
    for ((bin, share), (wanted_bin, ninths)) in found.shares().iter().zip(wanted) {
        assert_eq!(*bin, wanted_bin);
        assert!((f64::from(*share) - ninths / 33.0).abs() < 1e-6, "bin {bin}: {share}");
    }
}

#[test]
fn colours_fall_into_the_bins_that_the_numbers_say() {
    let bins = Bins { luma: 4, chroma: 8 };
    let number = |y: u16, cb: u16, cr: u16| y * 64 + cb * 8 + cr;
    for (colour, wanted) in [
        ([0, 128, 128], number(0, 4, 4)),
        ([63, 64, 191], number(0, 0, 7)),
        ([64, 79, 80], number(1, 0, 1)),
        ([255, 0, 255], number(3, 0, 7)),
    ] {
        assert_eq!(bins.of(colour), wanted, "{colour:?}");
        assert!(usize::from(wanted) < bins.len());
    }
    assert_eq!(Bins { luma: 0, chroma: 99 }.len(), 32 * 32);
    // A picture of odd size, with its pixels' own bins.
    let picture = Picture::new([5, 3], |x, y| [10.0 * x, 100.0 + 9.0 * y, 128.0 - 7.0 * x]);
    let colours = picture.colours(true);
    for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
        let half = (y / 2 * 3 + x / 2) as usize;
        let wanted = BINS.of([picture.y[(5 * y + x) as usize], picture.cb[half], picture.cr[half]]);
        assert_eq!(colours.row(y, x..=x), [wanted], "pixel ({x}, {y})");
    }
}

#[test]
fn similarity_is_one_for_equal_histograms_and_zero_for_strangers() {
    let of = |shares: &[(u16, f32)]| Histogram { shares: shares.to_vec() };
    let (a, b) = (of(&[(1, 0.5), (4, 0.25), (9, 0.25)]), of(&[(0, 0.5), (5, 0.5)]));
    assert!((a.similarity(&a) - 1.0).abs() < 1e-12);
    assert_eq!(a.similarity(&b).to_bits(), 0.0_f64.to_bits());
    // √(.5·.1) + √(.25·.9).
    let c = of(&[(1, 0.1), (9, 0.9)]);
    assert!((a.similarity(&c) - (0.05_f64.sqrt() + 0.225_f64.sqrt())).abs() < 1e-7);
    assert_eq!(a.similarity(&c).to_bits(), c.similarity(&a).to_bits());
}

#[test]
fn a_step_leads_to_the_mean_of_the_weighted_pixels() {
    // A row of five, h = 2.5: kernel weights 1 - d²/6.25. The model wants half of each colour.
    let colours = Colours::new(&Gray::packed(&[0, 0, 0, 255, 255], 5, 1), None, Bins { luma: 2, chroma: 1 });
    let model = Histogram { shares: vec![(0, 0.5), (1, 0.5)] };
    let weight = |d: f64| 1.0 - d * d / 6.25;
    let dark = weight(-2.0) + weight(-1.0) + weight(0.0);
    let bright = weight(1.0) + weight(2.0);
    let total = dark + bright;
    let [w_dark, w_bright] = [dark, bright].map(|q| (0.5 / (q / total)).sqrt());
    let wanted = (w_dark * (-2.0 - 1.0) + w_bright * (1.0 + 2.0)) / (3.0 * w_dark + 2.0 * w_bright);
    let found = find(&colours, &model, region([2.0, 0.0], 2.5), &Params { max_iterations: 1, ..PARAMS });
    assert!((f64::from(found.region.at[0]) - 2.0 - wanted).abs() < 1e-5, "{found:?}, wanted {wanted}");
    assert!(found.region.at[1].abs() < 1e-9, "{found:?}");
    assert!(wanted > 0.1, "there is too little white at the start");
}

/// Noise, -1..1, another at every pixel.
fn noise(seed: u64, x: f64, y: f64) -> f64 {
    texture::hash(seed, x.floor() as i64, y.floor() as i64)
}

/// Green clutter of all brightnesses with a red disc in it that is as bright as what is about it.
fn disc_over_clutter(at: Point, radius: f64) -> Picture {
    let [cx, cy] = at.map(f64::from);
    Picture::new([160, 120], |x, y| {
        let inside = (x - cx).hypot(y - cy) < radius;
        let (luma, grain) = (128.0 + 100.0 * noise(3, x, y), 3.0 * noise(4, x, y));
        if inside { [luma, 110.0 + grain, 165.0 + grain] } else { [luma, 105.0 + grain, 118.0 - grain] }
    })
}

#[test]
fn a_coloured_disc_is_followed_over_clutter_within_a_pixel() {
    let start = [40.0, 60.0];
    let first = disc_over_clutter(start, 12.0);
    for coloured in [true, false] {
        let model = histogram(&first.colours(coloured), region(start, 12.0));
        let (mut last, mut worst) = (region(start, 12.0), 0.0_f32);
        for t in 1..12 {
            let truth = [40.0 + 6.3 * t as f32, 60.0 + 14.0 * (t as f32 * 0.5).sin()];
            let found = find(&disc_over_clutter(truth, 12.0).colours(coloured), &model, last, &PARAMS);
            worst = worst.max((found.region.at[0] - truth[0]).hypot(found.region.at[1] - truth[1]));
            last = found.region;
        }
        match coloured {
            true => assert!(worst < 1.0, "off by {worst} px"),
            false => assert!(worst > 20.0, "without colour nothing tells the disc: off by {worst} px only"),
        }
    }
}

#[test]
fn a_jump_of_less_than_the_radius_is_found() {
    let model = histogram(&disc_over_clutter([60.0, 60.0], 12.0).colours(true), region([60.0, 60.0], 12.0));
    for k in 0..8_u8 {
        let (sin, cos) = (f32::from(k) * 0.8).sin_cos();
        let truth = [60.0 + 11.0 * cos, 60.0 + 11.0 * sin];
        let found =
            find(&disc_over_clutter(truth, 12.0).colours(true), &model, region([60.0, 60.0], 12.0), &PARAMS);
        let off = (found.region.at[0] - truth[0]).hypot(found.region.at[1] - truth[1]);
        assert!(off < 1.5 && found.similarity > 0.9, "{truth:?}: off by {off} px, {found:?}");
    }
}

#[test]
fn a_gray_clip_is_tracked_by_its_brightness() {
    let blob = |cx: f64| {
        texture::render(100, 60, |x, y| {
            20.0 * noise(8, x, y) + if (x - cx).hypot(y - 30.0) < 9.0 { 190.0 } else { 70.0 }
        })
    };
    let colours = |cx: f64| Colours::new(&Gray::packed(&blob(cx), 100, 60), None, BINS);
    let model = histogram(&colours(40.0), region([40.0, 30.0], 9.0));
    let found = find(&colours(46.0), &model, region([40.0, 30.0], 9.0), &PARAMS);
    assert!((found.region.at[0] - 46.0).hypot(found.region.at[1] - 30.0) < 1.0, "{found:?}");
}

#[test]
fn a_disc_that_grows_takes_its_region_with_it() {
    let params = Params { adapts: true, ..PARAMS };
    let at = [80.0, 60.0];
    // A region within one colour is the same in every size: it takes what lies round the disc to tell.
    let model = histogram(&disc_over_clutter(at, 14.0).colours(true), region(at, 18.0));
    let (mut adapted, mut fixed) = (region(at, 18.0), region(at, 18.0));
    let mut size = 14.0;
    for _ in 0..60 {
        size *= 1.006;
        let colours = disc_over_clutter(at, size).colours(true);
        adapted = find(&colours, &model, adapted, &params).region;
        fixed = find(&colours, &model, fixed, &PARAMS).region;
    }
    let wanted = size as f32 * 18.0 / 14.0;
    assert!((adapted.radius_px / wanted - 1.0).abs() < 0.1, "{adapted:?}, the disc has {size} px");
    assert_eq!(region(at, fixed.radius_px), region(at, 18.0));
}

#[test]
fn outside_the_picture_nothing_is_found_and_nothing_alike_stays_where_it_was() {
    let colours = Colours::new(&Gray::packed(&[255; 64], 8, 8), None, BINS);
    let strange = Histogram { shares: vec![(0, 1.0)] };
    for at in [[-30.0, 4.0], [4.0, 1e30], [f32::NAN, 4.0], [f32::INFINITY, 4.0]] {
        let target = Target { model: &strange, from: region(at, 5.0) };
        assert_eq!(follow(&colours, &[target], &PARAMS, 1), [None], "{at:?}");
        assert_eq!(Search::new(&colours, &PARAMS).histogram(target.from), None);
    }
    for at in [[4.0, 4.0], [-0.5, 7.5], [-4.0, 3.0]] {
        let found = find(&colours, &strange, region(at, 5.0), &PARAMS);
        assert_eq!(found, Found { region: region(at, 5.0), similarity: 0.0 });
    }
    let flat = histogram(&colours, region([3.3, 4.1], 5.0));
    let still = find(&colours, &flat, region([3.3, 4.1], 5.0), &PARAMS);
    assert_eq!(still.region, region([3.3, 4.1], 5.0), "where all is alike nothing moves");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let pictures = [0.0, 3.0].map(|d| disc_over_clutter([60.0 + d, 60.0], 12.0).colours(true));
    let places = (0..200_u16).map(|k| region([f32::from(k % 20) * 8.3, f32::from(k / 20) * 12.7], 7.5));
    let from: Vec<Region> = places.collect();
    let models: Vec<_> = from.iter().map(|r| histogram(&pictures[0], *r)).collect();
    let targets: Vec<_> = models.iter().zip(&from).map(|(model, &from)| Target { model, from }).collect();
    let once = follow(&pictures[1], &targets, &PARAMS, 1);
    for n in [2, 3, 16] {
        assert_eq!(follow(&pictures[1], &targets, &PARAMS, n), once, "{n} threads");
    }
}

proptest! {
    #![proptest_config(crate::cases(64))]

    #[test]
    fn similarity_never_falls_from_step_to_step(
        seed in 0_u64..1000,
        [from_x, from_y] in [-2.0_f32..42.0, -2.0_f32..32.0],
        [model_x, model_y] in [0.0_f32..40.0, 0.0_f32..30.0],
        radius in 1.5_f32..12.0,
    ) {
        let noise = |salt: u64, x: f64, y: f64| texture::value(seed + salt, 3.0 * x, 3.0 * y);
        let picture = Picture::new([40, 30], |x, y| [0, 5, 9].map(|salt| noise(salt, x, y)));
        let colours = picture.colours(true);
        let model = histogram(&colours, region([model_x, model_y], radius));
        let mut before = -1.0;
        for max_iterations in 0..12 {
            let params = Params { max_iterations, ..PARAMS };
            let from = region([from_x, from_y], radius);
            let Some(found) = follow(&colours, &[Target { model: &model, from }], &params, 1)[0] else { break };
            prop_assert!(found.similarity >= before && found.similarity <= 1.0);
            prop_assert!(found.region.at.iter().all(|c| c.is_finite()));
            // What the search says is what the histograms say.
            let there = histogram(&colours, found.region).similarity(&model);
            prop_assert!((there - found.similarity).abs() < 1e-6);
            before = found.similarity;
        }
    }
}

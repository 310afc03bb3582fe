//! The picture against the truth: leaves are where it says, move as it says, and are covered when it says so.

use super::{scene, small};
use crate::geometry::Point;
use crate::plant::{Item, Plant};
use crate::{Level, Picture, Scene, Settings};

/// Without light and noise.
fn plain() -> Settings {
    Settings { noise: 0.0, lighting: 0.0, ..small() }
}

/// Centroid of all that is plant, weighted by how much of each pixel it covers.
fn centroid(scene: &Scene, plant: &Plant, frame: u32) -> Point {
    let mut canvas = scene.camera.background.clone();
    canvas.plant(plant, &scene.pose(frame));
    let (mut sum, mut weight) = (Point::new(0.0, 0.0), 0.0);
    for (i, pixel) in canvas.pixels.iter().enumerate() {
        let place = Point::new((i % canvas.width) as f64, (i / canvas.width) as f64);
        sum = sum + place * f64::from(pixel[3]);
        weight += f64::from(pixel[3]);
    }
    sum * (1.0 / weight)
}

#[test]
fn a_leaf_alone_moves_as_the_truth_says_to_a_fraction_of_a_pixel() {
    let whole = scene(&Settings { width: 320, height: 240, n_leaves: 80, level: Level::Wind, ..plain() });
    let (mut worst_px, mut squares) = (0.0_f64, Vec::new());
    for id in (0..80).step_by(3) {
        // The blade alone: as it narrows in turning away, the petiole would weigh more.
        let mut alone = whole.plant.clone();
        alone.order = vec![Item::Leaf(id)];
        alone.leaves[id].petiole_px = 0.0;
        let frame_of = |frame| whole.pose(frame).leaves[id].frame;
        // An egg's centroid is off its centre, but turns with it.
        let off: Vec<Point> = (0..whole.n_frames())
            .map(|frame| frame_of(frame).into_local(centroid(&whole, &alone, frame)))
            .collect();
        let mean = off.iter().fold(Point::new(0.0, 0.0), |sum, &p| sum + p) * (1.0 / off.len() as f64);
        for (frame, off) in (0..).zip(off) {
            let at = whole.truth().leaves[id].path[frame as usize];
            assert!((Point::new(at.x, at.y) - frame_of(frame).origin).norm() < 1e-12);
            let missed_px = (off - mean).norm();
            worst_px = worst_px.max(missed_px);
            squares.push(missed_px * missed_px);
        }
    }
    let rms_px = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(rms_px < 0.03 && worst_px < 0.1, "{rms_px} px rms, {worst_px} px at worst");
}

/// Luma around a place, 9x9, bilinear; `None` at the edge.
fn patch(picture: &Picture, at: Point) -> Option<Vec<f64>> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let fits = |c: f64, n: usize| c >= 5.0 && c < n as f64 - 6.0;
    (fits(at.x, width) && fits(at.y, height)).then(|| {
        let places = (0..81).map(|i| (at.x + f64::from(i % 9) - 4.0, at.y + f64::from(i / 9) - 4.0));
        let sample = |(x, y): (f64, f64)| {
            let (column, row) = (x as usize, y as usize);
            let (fx, fy) = (x.fract(), y.fract());
            let luma = |dx: usize, dy: usize| f64::from(picture.y[(row + dy) * width + column + dx]);
            (1.0 - fy) * ((1.0 - fx) * luma(0, 0) + fx * luma(1, 0))
                + fy * ((1.0 - fx) * luma(0, 1) + fx * luma(1, 1))
        };
        places.map(sample).collect()
    })
}

/// Normalised correlation of two patches.
fn ncc(a: &[f64], b: &[f64]) -> f64 {
    let centred = |p: &[f64]| {
        let mean = p.iter().sum::<f64>() / p.len() as f64;
        p.iter().map(|v| v - mean).collect::<Vec<_>>()
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (a, b) = (centred(a), centred(b));
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt().max(1e-9)
}

#[test]
fn the_texture_of_seen_leaves_goes_where_the_truth_says() {
    let settings = Settings { width: 480, height: 360, n_leaves: 300, level: Level::Storm, ..plain() };
    let scene = scene(&settings);
    let (first, second) = (scene.render(6), scene.render(7));
    let (mut followed, mut stayed) = (Vec::new(), Vec::new());
    for leaf in &scene.truth().leaves {
        let (from, to) = (leaf.path[6], leaf.path[7]);
        let (start, end) = (Point::new(from.x, from.y), Point::new(to.x, to.y));
        let patches = (patch(&first, start), patch(&second, end), patch(&second, start));
        if let (true, (Some(before), Some(after), Some(in_place))) = (from.visible && to.visible, patches) {
            followed.push(ncc(&before, &after));
            stayed.push(ncc(&before, &in_place));
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (followed, stayed) = (median(&mut followed), median(&mut stayed));
    assert!(followed > 0.93 && stayed < 0.7, "followed {followed}, stayed {stayed}");
}

#[test]
fn a_centre_is_visible_exactly_where_its_leaf_is_on_top() {
    let (width, height) = (480, 360);
    let settings = Settings { width, height, n_frames: 10, n_leaves: 200, level: Level::Storm, ..plain() };
    let mut dyed = scene(&settings);
    dyed.plant.leaves.iter_mut().for_each(|leaf| leaf.colour = [100.0, 100.0, 0.0]);
    dyed.plant.branches.iter_mut().for_each(|branch| branch.colour = [100.0, 100.0, 0.0]);
    let (mut n_seen, mut n_covered, mut n_undecided, mut n_wrong) = (0, 0, 0, 0);
    for id in (0..200).step_by(2) {
        // One blue leaf in a plant without blue: what is blue at its centre is that leaf.
        let usual = std::mem::replace(&mut dyed.plant.leaves[id].colour, [0.0, 0.0, 200.0]);
        let frame = (id / 2 % 10) as u32;
        let at = dyed.truth().leaves[id].path[frame as usize];
        let (x, y) = (at.x.round(), at.y.round());
        if (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y) {
            // The whole plant moves by part of a pixel, so that the leaf's centre is that of a pixel.
            let planted = dyed.plant.branches[0].base;
            dyed.plant.branches[0].base = planted + Point::new(x - at.x, y - at.y);
            let mut canvas = dyed.camera.background.clone();
            canvas.plant(&dyed.plant, &dyed.pose(frame));
            dyed.plant.branches[0].base = planted;
            let pixel = canvas.pixels[y as usize * canvas.width + x as usize];
            let blue = pixel[2] / (pixel[0] + pixel[1] + pixel[2]);
            n_seen += usize::from(at.visible);
            n_covered += usize::from(!at.visible);
            // In between, an edge runs through the pixel.
            n_undecided += usize::from((0.25..=0.75).contains(&blue));
            n_wrong += usize::from(if at.visible { blue < 0.25 } else { blue > 0.75 });
        } else {
            assert!(!at.visible, "leaf {id} is outside");
        }
        dyed.plant.leaves[id].colour = usual;
    }
    assert!(n_seen > 30 && n_covered > 20, "{n_seen} seen, {n_covered} covered: too few to tell");
    assert!(n_undecided < 10, "{n_undecided} undecided");
    assert_eq!(n_wrong, 0, "of {} centres", n_seen + n_covered);
}

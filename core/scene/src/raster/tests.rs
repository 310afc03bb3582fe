//! Pictures of a small forest and of single strokes.

use super::stroke::Stroke;
use super::{BAND, forest};
use crate::forest::live::Live;
use crate::testing;
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 64];

fn picture(live: &mut Live, size: [u32; 2]) -> Vec<[u8; 3]> {
    let (scene, grove) = (live.scene().clone(), live.grove().clone());
    let camera = scene.orbit.camera();
    let seen = live.seen(&camera, size).unwrap();
    forest(&scene, &grove, &seen, &camera, size)
}

fn live(n_copies: usize) -> Live {
    Live::new(Arc::new(testing::forest(n_copies, "wind")), 1, 1 << 20).unwrap()
}

#[test]
fn a_plant_stands_between_sky_and_ground() {
    let pixels = picture(&mut live(1), SIZE);
    let at = |x: u32, y: u32| pixels[(y * SIZE[0] + x) as usize];
    let [red, green, blue] = at(2, 2);
    assert!(blue > green && green > red, "the sky is blue: {:?}", at(2, 2));
    let [_, green, blue] = at(2, 61);
    assert!(green > blue, "the ground is not: {:?}", at(2, 61));
    // The lowest part of the stem is brown, in the middle of the picture.
    let is_brown = |[red, green, blue]: [u8; 3]| red > green && green > blue;
    assert!((30..62).any(|y| is_brown(at(48, y)) || is_brown(at(47, y))));
    // Leaves are green and darker than the ground.
    let n_leaves = pixels.iter().filter(|[r, g, b]| g > r && r > b && *g < 130).count();
    assert!((60..1500).contains(&n_leaves), "{n_leaves}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let mut live = live(4);
    let of = |n: usize, live: &mut Live| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| picture(live, SIZE))
    };
    let one = of(1, &mut live);
    assert!(one == of(4, &mut live));
    live.blow("steady:speed=40").unwrap();
    (0..15).for_each(|_| live.step().unwrap());
    assert!(one != of(1, &mut live), "and others in another frame");
}

#[test]
fn strokes_cover_their_area_and_hide_what_is_behind() {
    let stroke = |depth: f32, colour| Stroke {
        from: [10.0, 8.0],
        to: [30.0, 8.0],
        depths: [depth; 2],
        radii: [3.0; 2],
        colour,
        round: 0.0,
    };
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    for strokes in [[stroke(2.0, red), stroke(5.0, blue)], [stroke(5.0, blue), stroke(2.0, red)]] {
        let mut colours = vec![[0.0; 3]; 40 * BAND];
        let mut depths = vec![f32::INFINITY; colours.len()];
        for stroke in &strokes {
            stroke.draw(0, 40, &mut colours, &mut depths, &|colour, _| colour);
        }
        let n_red = colours.iter().filter(|colour| colour[0] > 0.5).count() as f32;
        assert!(colours.iter().all(|colour| colour[2] < 0.5));
        // A bar and two halves of a disc.
        let wanted = 20.0 * 6.0 + std::f32::consts::PI * 9.0;
        assert!((n_red - wanted).abs() < 0.06 * wanted, "{n_red} of {wanted}");
    }
}

/// What is a tenth of a sample broad takes a tenth of the samples that one of a whole sample does.
#[test]
fn what_is_thin_is_faint() {
    let n = |radius: f32| {
        let mut colours = vec![[0.0; 3]; 4000 * BAND];
        let mut depths = vec![f32::INFINITY; colours.len()];
        let stroke = Stroke {
            from: [0.0, 8.5],
            to: [4000.0, 8.5],
            depths: [1.0; 2],
            radii: [radius; 2],
            colour: [1.0; 3],
            round: 0.0,
        };
        stroke.draw(0, 4000, &mut colours, &mut depths, &|colour, _| colour);
        colours.iter().filter(|colour| colour[0] > 0.0).count() as f32
    };
    let (whole, tenth) = (n(0.5), n(0.05));
    assert!((tenth / whole - 0.1).abs() < 0.02, "{tenth} of {whole}");
}

//! Clips with a truth: they are what they say.

use super::{Clip, Discs, Moved, Texture, centre, grid};
use rand_pcg::Pcg64;

fn chance() -> Pcg64 {
    Pcg64::new(7, 11)
}

#[test]
fn there_and_back_is_where_it_was() {
    let moved = Moved { turn: 0.3, zoom: 1.2, shift: [4.0, -7.5] };
    for at in [[0.0, 0.0], [31.5, 8.25], [-4.0, 900.0]] {
        let back = moved.back(moved.there(at, [20.0, 10.0]), [20.0, 10.0]);
        assert!((back[0] - at[0]).hypot(back[1] - at[1]) < 1e-9, "{at:?} became {back:?}");
    }
}

#[test]
fn a_blurred_texture_is_the_convolution_with_a_gaussian() {
    let (texture, sigma) = (Texture::new(&mut chance()), 1.7_f64);
    let (at, reach) = ([12.3, -4.5], 40);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, j) in (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| (i, j))) {
        let [x, y] = [f64::from(i) * 0.25, f64::from(j) * 0.25];
        let weight = (-(x * x + y * y) / (2.0 * sigma * sigma)).exp();
        sum += weight * texture.at([at[0] + x, at[1] + y]);
        weights += weight;
    }
    let blurred = texture.blurred(sigma).at(at);
    assert!((blurred - sum / weights).abs() < 1e-3, "{blurred}, wanted {}", sum / weights);
}

#[test]
fn a_texture_uses_the_range_of_a_byte() {
    let texture = Texture::new(&mut chance());
    let clip = Clip::new([160, 120], 1, |at, _| 128.0 + texture.at(at));
    let luma: Vec<f64> = clip.pictures[0].luma.iter().map(|&v| f64::from(v)).collect();
    let mean = luma.iter().sum::<f64>() / luma.len() as f64;
    let deviation = (luma.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / luma.len() as f64).sqrt();
    assert!((30.0..60.0).contains(&deviation) && (110.0..146.0).contains(&mean), "{mean} +- {deviation}");
}

#[test]
fn points_of_a_grid_keep_the_margin_and_have_ids_of_their_own() {
    let points = grid([160, 120], 20.0, [6, 4], &mut chance());
    assert_eq!(points.iter().map(|point| point.id).collect::<Vec<_>>(), (1..=24).collect::<Vec<_>>());
    let outside = points.iter().find(|p| !(20.0..=139.0).contains(&p.x) || !(20.0..=99.0).contains(&p.y));
    assert_eq!(outside, None);
}

#[test]
fn the_middle_of_a_disc_has_its_colour_wherever_it_went() {
    let (size, at) = ([80, 60], [30.0, 25.0]);
    let moved = |t: usize| Moved { shift: [5.0 * t as f64, 3.0 * t as f64], ..Moved::NOT };
    let clip = Discs::new(vec![at]).clip(size, 3, moved);
    for t in 0..3 {
        let [x, y] = moved(t).there(at, centre(size)).map(|v| v.round() as usize);
        let frame = clip.view(t);
        let chroma = frame.chroma.map(|c| [c.cb.row(y as u32 / 2)[x / 2], c.cr.row(y as u32 / 2)[x / 2]]);
        assert_eq!((frame.gray.row(y as u32)[x], chroma), (50, Some([198, 128])), "frame {t}");
    }
}

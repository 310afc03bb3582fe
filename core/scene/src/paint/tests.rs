//! Areas, symmetry, edges of the picture and pixels that are known exactly.

use std::f64::consts::PI;

use super::*;

const BLACK: [u8; 3] = [0; 3];
const WHITE: Ink = Ink { rgb: [255; 3], alpha: 1.0 };

fn drawn(size: [u32; 2], draw: impl Fn(&mut Canvas)) -> Canvas {
    let mut canvas = Canvas::filled(BLACK, size[0], size[1]);
    draw(&mut canvas);
    canvas
}

/// What is white, in pixels.
fn area(canvas: &Canvas) -> f64 {
    canvas.pixels().iter().map(|pixel| f64::from(pixel[0]) / 255.0).sum()
}

fn rows(canvas: &Canvas) -> Vec<Vec<u8>> {
    canvas.pixels().chunks(canvas.width()).map(|row| row.iter().map(|pixel| pixel[0]).collect()).collect()
}

/// Turned by a quarter, as often as said.
fn turned(point: Point, middle: f64, times: u32) -> Point {
    (0..times).fold(point, |[x, y], _| [2.0 * middle - y, x])
}

type Draw = fn(&mut Canvas, &dyn Fn(Point) -> Point);

/// Shapes with their areas, each about (40, 40).
const SHAPES: [(&str, f64, Draw); 9] = [
    ("disc", PI * 12.3 * 12.3, |c, p| c.disc(p([40.0, 40.0]), 12.3, WHITE)),
    ("small disc", PI * 1.5 * 1.5, |c, p| c.disc(p([40.3, 40.1]), 1.5, WHITE)),
    ("ring", 2.0 * PI * 17.0 * 2.5, |c, p| c.ring(p([40.2, 39.7]), 17.0, 2.5, WHITE)),
    ("thin ring", 2.0 * PI * 17.0 * 0.5, |c, p| c.ring(p([40.2, 39.7]), 17.0, 0.5, WHITE)),
    ("ellipse", PI * 25.0 * 10.0, |c, p| {
        let (centre, axes) = (p([40.0, 40.0]), [[20.0, 15.0], [-6.0, 8.0]]);
        let end = axes.map(|[x, y]| p([40.0 + x, 40.0 + y]));
        c.ellipse(centre, end.map(|end| [end[0] - centre[0], end[1] - centre[1]]), WHITE);
    }),
    // Its circumference is 115.066 (Ramanujan).
    ("outline", 115.066 * 2.0, |c, p| {
        let (centre, axes) = (p([40.0, 40.0]), [[20.0, 15.0], [-6.0, 8.0]]);
        let end = axes.map(|[x, y]| p([40.0 + x, 40.0 + y]));
        c.ellipse_outline(centre, end.map(|end| [end[0] - centre[0], end[1] - centre[1]]), 2.0, WHITE);
    }),
    ("line", 50.0 * 3.0 + PI * 1.5 * 1.5, |c, p| c.line(p([20.0, 25.0]), p([60.0, 55.0]), 3.0, WHITE)),
    ("thin line", 50.0 * 0.4, |c, p| c.line(p([20.0, 25.0]), p([60.0, 55.0]), 0.4, WHITE)),
    ("corner", 60.0 * 4.0 + PI * 4.0 - 4.0 + PI, |c, p| {
        c.polyline(&[p([20.0, 20.0]), p([50.0, 20.0]), p([50.0, 50.0])], 4.0, WHITE);
    }),
];

#[test]
fn shapes_cover_as_much_as_they_are_large() {
    for (name, want, draw) in SHAPES {
        let got = area(&drawn([80, 80], |canvas| draw(canvas, &|point| point)));
        // Round edges, seen as straight ones, have pi / 12 pixels too much; bytes are rounded.
        assert!((got - want).abs() < 0.006 * want + 0.35, "{name}: {got:.2}, not {want:.2}");
    }
}

#[test]
fn shapes_that_are_turned_by_a_quarter_are_the_same_pixels() {
    for (name, _, draw) in SHAPES {
        let upright = rows(&drawn([80, 80], |canvas| draw(canvas, &|point| point)));
        for times in 1..4 {
            let other = rows(&drawn([80, 80], |canvas| draw(canvas, &|point| turned(point, 39.5, times))));
            for (y, row) in upright.iter().enumerate() {
                for (x, &a) in row.iter().enumerate() {
                    let [to_x, to_y] = turned([x as f64, y as f64], 39.5, times);
                    let b = other[to_y.round() as usize][to_x.round() as usize];
                    // Turned places round otherwise.
                    assert!(a.abs_diff(b) <= 1, "{name} {times}: {a} {b} at {x},{y}");
                }
            }
        }
    }
}

#[test]
fn what_is_outside_is_clipped_and_changes_nothing_inside() {
    for (name, _, draw) in SHAPES {
        let whole = rows(&drawn([120, 120], |c| draw(c, &|[x, y]| [x - 18.0 + 30.0, y - 25.0 + 30.0])));
        let part = rows(&drawn([30, 40], |c| draw(c, &|[x, y]| [x - 18.0, y - 25.0])));
        for (y, row) in part.iter().enumerate() {
            assert_eq!(row[..], whole[y + 30][30..60], "{name}, row {y}");
        }
        let away = drawn([30, 40], |c| draw(c, &|[x, y]| [x - 1e6, y + 1e30]));
        assert!(area(&away) <= 0.0, "{name}");
    }
}

#[test]
fn lines_of_one_pixel_on_centres_are_exact() {
    let line = rows(&drawn([9, 5], |c| c.line([2.0, 2.0], [6.0, 2.0], 1.0, WHITE)));
    let mut want = vec![vec![0; 9]; 5];
    want[2][2..=6].fill(255);
    assert_eq!(line, want);
    let upright = rows(&drawn([9, 5], |c| c.line([4.0, 0.0], [4.0, 4.0], 1.0, WHITE)));
    assert!(upright.iter().all(|row| row[..] == [0, 0, 0, 0, 255, 0, 0, 0, 0]), "{upright:?}");
    // Between two rows it is half of each; of half the width it is half as much.
    let between = rows(&drawn([3, 4], |c| c.line([-9.0, 1.5], [9.0, 1.5], 1.0, WHITE)));
    assert_eq!(between, [[0; 3], [128; 3], [128; 3], [0; 3]]);
    let thin = rows(&drawn([3, 3], |c| c.line([-9.0, 1.0], [9.0, 1.0], 0.5, WHITE)));
    assert_eq!(thin, [[0; 3], [128; 3], [0; 3]]);
    let corner = rows(&drawn([6, 4], |c| c.rectangle([0.5, 0.5], [3.5, 2.75], WHITE)));
    assert_eq!(corner, [[0; 6], [0, 255, 255, 255, 0, 0], [0, 255, 255, 255, 0, 0], [0, 64, 64, 64, 0, 0]]);
}

#[test]
fn ink_lies_over_the_picture_and_once_where_lines_join() {
    let mut canvas = Canvas::filled([100, 0, 200], 20, 20);
    let ink = Ink { rgb: [200, 100, 0], alpha: 0.5 };
    canvas.polyline(&[[3.0, 10.0], [10.0, 10.0], [3.0, 10.0], [16.0, 10.0]], 1.0, ink);
    let row: Vec<[u8; 3]> = canvas.pixels()[200..220].to_vec();
    assert_eq!(row[2], [100, 0, 200]);
    assert_eq!(row[3..=16], [[150, 50, 100]; 14], "though it goes over itself");
    canvas.line([3.0, 10.0], [16.0, 10.0], 1.0, Ink::opaque([1, 2, 3]).times(2.0));
    assert_eq!(canvas.pixels()[205], [1, 2, 3], "no more than all of it");
}

#[test]
fn trails_fade_to_where_they_began() {
    let trail = drawn([12, 1], |c| {
        c.trail(&[[0.0, 0.0], [4.0, 0.0], [8.0, 0.0]], 1.0, WHITE, [0.0, 1.0]);
    });
    let want: Vec<u8> = (0..=8).map(|x| (255.0 / 8.0 * f64::from(x)).round() as u8).collect();
    assert_eq!(rows(&trail)[0][..9], want);
}

#[test]
fn arrows_point_where_they_go() {
    let arrow = |to: Point| drawn([60, 60], |c| c.arrow([30.0, 30.0], to, 2.0, WHITE));
    // A shaft with one round end of 16 px, and a head of 9 by 9.
    let long = area(&arrow([55.0, 30.0]));
    let want = 16.0 * 2.0 + PI / 2.0 + 81.0 / 2.0;
    assert!((long - want).abs() < 1.5, "{long:.2}, not {want:.2}");
    let pixels = rows(&arrow([55.0, 30.0]));
    assert!(pixels[30][54] > 0 && pixels[27][47] == 255 && pixels[27][53] == 0, "it is pointed at its end");
    let short = area(&arrow([30.0, 34.0]));
    assert!((short - 8.0).abs() < 1.5, "a head of 4 by 4, whose corners are seen as edges: {short:.2}");
    assert!(area(&arrow([30.0, 30.0])) <= 0.0, "nowhere");
}

#[test]
fn what_has_no_area_or_no_place_is_not_drawn() {
    let nan = f64::NAN;
    let nothing = drawn([20, 20], |c| {
        c.disc([nan, 3.0], 4.0, WHITE);
        c.disc([3.0, 3.0], 0.0, WHITE);
        c.disc([3.0, 3.0], nan, WHITE);
        c.ring([3.0, 3.0], 4.0, 0.0, WHITE);
        c.ellipse([9.0, 9.0], [[4.0, 0.0], [0.0, 0.0]], WHITE);
        c.ellipse_outline([9.0, 9.0], [[nan, 0.0], [0.0, 3.0]], 1.0, WHITE);
        c.line([3.0, 3.0], [nan, 9.0], 2.0, WHITE);
        c.line([3.0, 3.0], [9.0, 9.0], 0.0, WHITE);
        c.arrow([3.0, 3.0], [f64::INFINITY, 9.0], 2.0, WHITE);
        c.polyline(&[[3.0, 3.0]], 2.0, WHITE);
        c.rectangle([5.0, 5.0], [5.0, 9.0], WHITE);
        c.text([2.0, 2.0], 0.0, "text", WHITE);
    });
    assert!(area(&nothing) <= 0.0);
    let mut none = Canvas::filled(BLACK, 0, 0);
    none.disc([0.0, 0.0], 5.0, WHITE);
    assert_eq!((none.height(), none.pixels().len()), (0, 0));
}

/// The face is drawn by others; what is known of any: an l is upright, an o symmetric, a dot at the foot.
#[test]
fn letters_are_readable_at_any_size() {
    for height in [12.0, 16.0, 24.0, 32.0, 47.0, 64.0] {
        let size = [(8.0 * height) as u32, (2.0 * height) as u32];
        let shown = |text: &str| drawn(size, |c| c.text([4.0, 4.0], height, text, WHITE));
        let ink = |text: &str| area(&shown(text)) / (height * height);
        let at_32 = |text| area(&drawn([256, 64], |c| c.text([4.0, 4.0], 32.0, text, WHITE))) / (32.0 * 32.0);
        for letter in ["o", "M"] {
            let (got, want) = (ink(letter), at_32(letter));
            assert!((got - want).abs() < 0.03 * want, "{letter} at {height}: {got} of a square, not {want}");
        }
        assert!(ink("ooo") > 2.9 * ink("o") && ink(" ") <= 0.0);
        let o = rows(&shown("o"));
        let left = 4.0 - 0.5 + text_width("o", height) / 2.0;
        let weighted: f64 =
            o.iter().flat_map(|row| row.iter().enumerate()).map(|(x, v)| x as f64 * f64::from(*v)).sum();
        let weight: f64 = o.iter().flatten().map(|v| f64::from(*v)).sum();
        assert!((weighted / weight - left).abs() < 0.06 * height, "it stands in the middle of its width");
        let darkest = o.iter().flatten().max().copied();
        assert!(darkest > Some(200), "{darkest:?} at {height}");
        assert_eq!(shown("木"), shown("\u{fffd}"), "what the face has not");
        assert_ne!(shown("é"), shown("\u{fffd}"));
    }
}

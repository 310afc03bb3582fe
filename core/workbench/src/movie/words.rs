//! Words over a movie: names of groups, the frame and its time, and the wheel that explains the colours of motion.

use honami_model::track::Sample;
use honami_motion::overlay::{Mapping, over};
use honami_scene::paint::{Canvas, Ink, Point, text_width};
use honami_scene::palette::{self, DARK};

use super::Drawn;
use super::lens::Lens;

/// Heights of lines, in units of the lens.
const LABEL: f64 = 17.0;
const STAMP: f64 = 16.0;
/// No line is lower, pixels: it could not be read.
const LOWEST: f64 = 13.0;
/// Radius of the wheel, and how far it and the stamp are from the edges.
const WHEEL: f64 = 30.0;
const MARGIN: f64 = 8.0;
const WHITE: [u8; 3] = [255; 3];

/// A word about a group, where it stays for the whole movie.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    /// Upper left corner.
    at: Point,
    text: String,
    rgb: [u8; 3],
}

/// The labels of groups: each at the mean of where its tracks were seen, none over another where there is room.
pub(super) fn labels(of: &Drawn, lens: &Lens) -> Vec<Label> {
    let height = high(LABEL * lens.unit);
    let size = lens.size.map(f64::from);
    let mut wanted: Vec<Label> = Vec::new();
    for (&group, name) in &of.names {
        let tracks = of.tracks.iter().filter(|track| track.group == Some(group));
        let seen = |sample: &&Sample| sample.status.is_seen();
        let samples = tracks.flat_map(|track| track.span.samples.iter().filter(seen));
        let (n, sum) = samples.fold((0.0, [0.0; 2]), |(n, [x, y]), sample| {
            (n + 1.0, [x + f64::from(sample.x), y + f64::from(sample.y)])
        });
        if n > 0.0 {
            let [x, y] = lens.at(sum.map(|sum| sum / n));
            let width = text_width(name, height);
            let at = [
                (x - width / 2.0).clamp(0.0, (size[0] - width).max(0.0)),
                (y - height / 2.0).clamp(0.0, (size[1] - height).max(0.0)),
            ];
            wanted.push(Label { at, text: name.clone(), rgb: palette::group(Some(group)) });
        }
    }
    one_under_the_other(wanted, height)
}

/// Labels of a height, those that touch one higher up moved down until they do not.
fn one_under_the_other(mut wanted: Vec<Label>, height: f64) -> Vec<Label> {
    wanted.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
    let touches = |a: &Label, b: &Label| {
        let [wide, other] = [a, b].map(|label| text_width(&label.text, height));
        let is_beside = a.at[0] >= b.at[0] + other || b.at[0] >= a.at[0] + wide;
        // The sum that a label is moved by: a difference of the two would not be exactly its height.
        !is_beside && a.at[1] < b.at[1] + height && b.at[1] < a.at[1] + height
    };
    let mut placed: Vec<Label> = Vec::new();
    for mut label in wanted {
        while let Some(above) = placed.iter().find(|placed| touches(placed, &label)) {
            label.at[1] = above.at[1] + height;
        }
        placed.push(label);
    }
    placed
}

impl Label {
    pub(super) fn draw(&self, canvas: &mut Canvas, unit: f64) {
        written(canvas, self.at, high(LABEL * unit), &self.text, self.rgb);
    }
}

/// A height at which letters can be read.
fn high(height: f64) -> f64 {
    height.max(LOWEST)
}

/// Text with dark round it, to be read on petals and on sky.
fn written(canvas: &mut Canvas, at: Point, height: f64, text: &str, rgb: [u8; 3]) {
    let reach = height / 16.0;
    for (x, y) in
        [(-1.0, -1.0), (0.0, -1.4), (1.0, -1.0), (-1.4, 0.0), (1.4, 0.0), (-1.0, 1.0), (0.0, 1.4), (1.0, 1.0)]
    {
        let moved = [at[0] + x * reach, at[1] + y * reach];
        canvas.text(moved, height, text, Ink::opaque(DARK).times(0.6));
    }
    canvas.text(at, height, text, Ink::opaque(rgb));
}

/// The frame and its time in the lower left corner; how fast time goes, where not as filmed.
pub(super) fn stamp(canvas: &mut Canvas, unit: f64, (frame, end): (u32, u32), time_s: f64, speed: f64) {
    let digits = end.saturating_sub(1).to_string().len();
    let mut text = format!("frame {frame:digits$}  {time_s:.2} s");
    if (speed - 1.0).abs() > 0.005 {
        text += &format!("  {} speed", told(speed));
    }
    let (height, margin) = (high(STAMP * unit), MARGIN * unit);
    let top = canvas.height() as f64 - margin - height;
    let corner = [margin + text_width(&text, height) + margin, top + height];
    canvas.rectangle(
        [margin - 0.5, top - 0.5],
        [corner[0] - 0.5, corner[1] - 0.5],
        Ink::opaque([0; 3]).times(0.5),
    );
    canvas.text([1.5 * margin, top], height, &text, Ink::opaque(WHITE));
}

/// `1/5`, `2x`, `0.37x`.
fn told(speed: f64) -> String {
    let whole = |v: f64| (v - v.round()).abs() < 0.005 * v;
    match speed {
        v if v < 1.0 && whole(1.0 / v) => format!("1/{:.0}", 1.0 / v),
        v if whole(v) => format!("{v:.0}x"),
        v => format!("{v:.2}x"),
    }
}

/// The wheel in the upper right corner: each direction in its colour, stronger with speed, and below it the speed of its rim.
pub(super) fn wheel(canvas: &mut Canvas, unit: f64, mapping: &Mapping, rim_px_s: f64) {
    let (radius, margin, height) = (WHEEL * unit, MARGIN * unit, high(0.75 * STAMP * unit));
    let text = format!("{rim_px_s:.*} px/s", if rim_px_s < 10.0 { 1 } else { 0 });
    let half = radius.max(text_width(&text, height) / 2.0);
    let centre = [canvas.width() as f64 - margin - half, margin + radius];
    canvas.disc(centre, radius, Ink::opaque(DARK).times(0.75));
    let columns = canvas.width();
    let reach = |axis: usize, n: usize| {
        let first = (centre[axis] - radius).ceil().max(0.0) as usize;
        first..((centre[axis] + radius).floor().max(0.0) as usize + 1).min(n)
    };
    for row in reach(1, canvas.height()) {
        for column in reach(0, columns) {
            let part = [column as f64 - centre[0], row as f64 - centre[1]].map(|way| way / radius);
            if part[0].hypot(part[1]) <= 1.0
                && let Some(tint) = mapping.tint(part.map(|part| part * rim_px_s))
            {
                let pixel = &mut canvas.pixels_mut()[row * columns + column];
                *pixel = over(*pixel, tint);
            }
        }
    }
    canvas.ring(centre, radius, 1.5 * unit, Ink::opaque(WHITE).times(0.8));
    let at = [centre[0] - text_width(&text, height) / 2.0, centre[1] + radius + margin / 4.0];
    written(canvas, at, height, &text, WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In steps that no power of two divides: sums of them are rounded.
    #[test]
    fn labels_stand_under_one_another_wherever_they_are() {
        for k in 0..2000 {
            let (height, top) = (LOWEST + 0.0137 * f64::from(k), 0.731 * f64::from(k));
            let at = |down: f64| Label { at: [10.0, top + down], text: "a leaf".to_owned(), rgb: WHITE };
            let placed = one_under_the_other(vec![at(0.3 * height), at(0.0), at(0.31 * height)], height);
            let tops: Vec<f64> = placed.iter().map(|label| label.at[1]).collect();
            assert_eq!(tops, [top, top + height, top + height + height], "{height}");
        }
    }

    #[test]
    fn speeds_are_told_in_the_simplest_way() {
        for (speed, want) in
            [(0.2, "1/5"), (0.5, "1/2"), (2.0, "2x"), (0.37, "0.37x"), (10.0, "10x"), (1.5, "1.50x")]
        {
            assert_eq!(told(speed), want);
        }
    }
}

//! Lines, boxes and words of an SVG, and the field of a plot.

use std::fmt::Write as _;

/// What is read first.
pub(super) const INK: &str = "#222222";
/// What is read when it is looked for.
pub(super) const QUIET: &str = "#666666";
/// Lines behind everything.
const FAINT: &str = "#dddddd";

/// Which end of a text stands at its place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How something is drawn.
pub(super) struct Pen {
    colour: &'static str,
    /// Width of a line, height of a text, pixels.
    size: f64,
    dashes: &'static str,
    is_bold: bool,
}

impl Pen {
    pub(super) fn line(colour: &'static str, size: f64, dashes: &'static str) -> Self {
        Self { colour, size, dashes, is_bold: false }
    }

    pub(super) fn grid() -> Self {
        Self::line(FAINT, 1.0, "")
    }

    pub(super) fn text(colour: &'static str, size: f64) -> Self {
        Self { colour, size, dashes: "", is_bold: false }
    }

    pub(super) fn bold(colour: &'static str, size: f64) -> Self {
        Self { is_bold: true, ..Self::text(colour, size) }
    }

    fn stroke(&self) -> String {
        let dashes = match self.dashes {
            "" => String::new(),
            dashes => format!(" stroke-dasharray=\"{dashes}\""),
        };
        format!("stroke=\"{}\" stroke-width=\"{}\"{dashes}", self.colour, self.size)
    }
}

/// A drawing in the making; places are x right, y down, pixels.
pub(super) struct Canvas {
    svg: String,
}

impl Canvas {
    pub(super) fn new(width: f64, height: f64) -> Self {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans, Verdana, sans-serif\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        Self { svg }
    }

    pub(super) fn finish(self) -> String {
        self.svg + "</svg>\n"
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        self.svg.write_fmt(element).unwrap_or_default();
        self.svg.push('\n');
    }

    pub(super) fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: &str) {
        let width = width.max(0.0);
        self.put(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{fill}\"/>"
        ));
    }

    pub(super) fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], pen: &Pen) {
        self.put(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {}/>",
            pen.stroke()
        ));
    }

    pub(super) fn path(&mut self, points: &[[f64; 2]], pen: &Pen) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let stroke = pen.stroke();
        self.put(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {stroke}/>",
            points.join(" ")
        ));
    }

    /// A closed field without an edge.
    pub(super) fn area(&mut self, points: &[[f64; 2]], fill: &str) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.put(format_args!("<polygon points=\"{}\" fill=\"{fill}\"/>", points.join(" ")));
    }

    pub(super) fn dot(&mut self, [x, y]: [f64; 2], pen: &Pen) {
        self.put(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.2\" fill=\"{}\"/>", pen.colour));
    }

    pub(super) fn text(&mut self, [x, y]: [f64; 2], anchor: Anchor, pen: &Pen, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if pen.is_bold { " font-weight=\"bold\"" } else { "" };
        let (colour, size) = (pen.colour, pen.size);
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\"{weight}>{text}</text>"
        ));
    }
}

/// Room for the numbers left of an axis, pixels.
const NUMBERS: f64 = 40.0;

/// The field of a plot inside its numbers.
pub(super) struct Field {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Field {
    /// The field of a plot at a place, under its title.
    pub(super) fn new(canvas: &mut Canvas, title: &str, [x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        canvas.text([x, y - 16.0], Anchor::Start, &Pen::bold(INK, 13.0), title);
        Self { left: x + NUMBERS, right: x + width, top: y, bottom: y + height }
    }

    /// The place of a share of the way right and up.
    pub(super) fn at(&self, across: f64, up: f64) -> [f64; 2] {
        [self.left + across * (self.right - self.left), self.bottom - up * (self.bottom - self.top)]
    }

    /// A faint line across, with its number.
    pub(super) fn level(&self, canvas: &mut Canvas, up: f64, number: &str) {
        let [x, y] = self.at(0.0, up);
        canvas.line([x, y], self.at(1.0, up), &Pen::grid());
        canvas.text([x - 8.0, y + 4.0], Anchor::End, &Pen::text(QUIET, 11.0), number);
    }

    /// A number under the field.
    pub(super) fn tick(&self, canvas: &mut Canvas, across: f64, number: &str) {
        let [x, y] = self.at(across, 0.0);
        canvas.line([x, y], [x, y + 4.0], &Pen::line(QUIET, 1.0, ""));
        canvas.text([x, y + 18.0], Anchor::Middle, &Pen::text(QUIET, 11.0), number);
    }

    pub(super) fn caption(&self, canvas: &mut Canvas, text: &str) {
        let [x, y] = self.at(0.5, 0.0);
        canvas.text([x, y + 38.0], Anchor::Middle, &Pen::text(QUIET, 12.0), text);
    }
}

//! A drawn crown of leaves before leaves out of focus.

use honami_matting::Mark;

/// A picture whose opacities are known, and strokes on it.
pub(super) struct Crown {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgb: Vec<[u8; 3]>,
    pub(super) alpha: Vec<f64>,
    pub(super) marks: Vec<Mark>,
}

impl Crown {
    /// Leaves, more and more of them with the picture, lie about its middle.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let unit = f64::from(height) / 540.0;
        let leaves: Vec<Leaf> =
            (0..400).map(|k| Leaf::new(k, f64::from(width), f64::from(height), unit)).collect();
        let mut crown = Self { width, height, rgb: Vec::new(), alpha: Vec::new(), marks: Vec::new() };
        for y in 0..height {
            // Only leaves near the row are asked.
            let near: Vec<&Leaf> =
                leaves.iter().filter(|leaf| (leaf.y - f64::from(y)).abs() < leaf.length + 2.0).collect();
            for x in 0..width {
                crown.draw(f64::from(x), f64::from(y), &near, unit);
            }
        }
        crown
    }

    fn draw(&mut self, x: f64, y: f64, leaves: &[&Leaf], unit: f64) {
        let soft = |k: f64| (x / (60.0 * unit) + k).sin() * (y / (45.0 * unit) + 2.0 * k).cos();
        let mut colour = [0.35 + 0.2 * soft(0.3), 0.42 + 0.2 * soft(1.7), 0.75 + 0.15 * soft(2.9)];
        let mut alpha = 0.0;
        for leaf in leaves {
            let (cover, light) = leaf.at(x, y);
            let green = [0.25 * light, 0.55 * light, 0.12 * light];
            colour.iter_mut().zip(green).for_each(|(colour, green)| *colour += cover * (green - *colour));
            alpha += cover * (1.0 - alpha);
        }
        self.rgb.push(colour.map(|value| (value * 255.0).round().clamp(0.0, 255.0) as u8));
        self.alpha.push(alpha);
        // Strokes: along the border, and where every tenth leaf is.
        let edge = 6.0 * unit;
        let is_edge = x < edge || y < edge || x >= f64::from(self.width) - edge;
        let is_leaf =
            leaves.iter().any(|leaf| leaf.k % 10 == 0 && leaf.at(x, y).0 >= 1.0 && leaf.is_near(x, y));
        self.marks.push(if is_leaf {
            Mark::Foreground
        } else if is_edge && alpha == 0.0 {
            Mark::Background
        } else {
            Mark::Unknown
        });
    }
}

/// An ellipse with a vein.
struct Leaf {
    k: u32,
    x: f64,
    y: f64,
    turn: f64,
    length: f64,
    light: f64,
}

impl Leaf {
    fn new(k: u32, width: f64, height: f64, unit: f64) -> Self {
        // Digits of irrational numbers: spread evenly, the same in every run.
        let digit = |of: f64| (f64::from(k + 1) * of).fract();
        let (far, about) = (digit(0.618_034).sqrt(), digit(0.754_878) * std::f64::consts::TAU);
        Self {
            k,
            x: width / 2.0 + 0.36 * height * far * about.cos(),
            y: height / 2.0 + 0.4 * height * far * about.sin(),
            turn: digit(0.569_84) * std::f64::consts::PI,
            length: unit * (9.0 + 12.0 * digit(0.324_718)),
            light: 0.7 + 0.6 * digit(0.414_214),
        }
    }

    fn across(&self, x: f64, y: f64) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let [dx, dy] = [x - self.x, y - self.y];
        [dx * cos + dy * sin, dy * cos - dx * sin]
    }

    fn is_near(&self, x: f64, y: f64) -> bool {
        let [along, across] = self.across(x, y);
        along.hypot(across) < self.length / 4.0
    }

    /// How much of the pixel it covers, and how bright it is there.
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let [along, across] = self.across(x, y);
        let wide = 0.45 * self.length;
        let inside = 1.0 - (along / self.length).hypot(across / wide);
        let vein = 0.8 + 0.2 * (across.abs() / wide).min(1.0);
        ((0.5 + inside * wide).clamp(0.0, 1.0), self.light * vein)
    }
}

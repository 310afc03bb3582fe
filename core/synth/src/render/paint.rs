//! Painting from far to near, edges smoothed by how much of a pixel a shape covers.

use crate::geometry::{Frame, Point};
use crate::outline::{BranchOutline, LeafOutline, Outline};
use crate::plant::{Branch, Item, Leaf, Plant};
use crate::pose::{LeafPose, Pose};

/// Direction towards the light in the picture.
const TO_LIGHT: Point = Point::new(-0.62, -0.78);
/// Strength of the shadow that a leaf throws on the plant behind it.
const SHADOW: f32 = 0.42;

/// A picture in the making: red, green, blue 0..255, and how much of the pixel is plant, 0..1.
#[derive(Clone, Debug)]
pub(crate) struct Canvas {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// (height, width), row-major.
    pub(crate) pixels: Vec<[f32; 4]>,
}

impl Canvas {
    /// Paints a plant in a pose.
    pub(crate) fn plant(&mut self, plant: &Plant, pose: &Pose) {
        for item in &plant.order {
            match *item {
                Item::Branch(idx) => self.branch(&plant.branches[idx], &pose.branches[idx]),
                Item::Leaf(idx) => {
                    self.shadow(&plant.leaves[idx], &pose.leaves[idx]);
                    self.leaf(&plant.leaves[idx], &pose.leaves[idx]);
                }
            }
        }
    }

    /// Mean colour of the 2x2 pixels from (row, column) on, those beyond the edge left out.
    pub(crate) fn mean_of_four(&self, row: usize, column: usize) -> [f32; 3] {
        let (below, right) = ((row + 1).min(self.height - 1), (column + 1).min(self.width - 1));
        let four = [(row, column), (row, right), (below, column), (below, right)];
        let four = four.map(|(row, column)| self.pixels[row * self.width + column]);
        [0, 1, 2].map(|c| 0.25 * four.iter().map(|pixel| pixel[c]).sum::<f32>())
    }

    fn leaf(&mut self, leaf: &Leaf, pose: &LeafPose) {
        let outline = LeafOutline::new(leaf, pose);
        let axis = pose.frame.axis();
        // The halves rise from the midrib, so the half away from the light faces it.
        let across = (axis.x * TO_LIGHT.y - axis.y * TO_LIGHT.x) as f32;
        let gain = 1.0 + 0.3 * across * pose.roll_rad.sin() as f32;
        let fold = -0.15 * across;
        let per_px = [1.0 / outline.half_length_px, 1.0 / outline.half_width_px];
        self.fill(&pose.frame, &outline, 0.5, |pixel, x, y, depth_px| {
            let texel = leaf.texture.at(x * per_px[0], y * per_px[1]);
            let rim = 0.84 + 0.16 * (depth_px * 0.5).clamp(0.0, 1.0);
            let light = texel * rim * (gain + fold * (y * 0.9).clamp(-1.0, 1.0));
            blend(pixel, leaf.colour.map(|c| c * light), (depth_px + 0.5).min(1.0));
        });
    }

    /// Darkens the plant under a leaf, a little way off on the side away from the light.
    fn shadow(&mut self, leaf: &Leaf, pose: &LeafPose) {
        let outline = LeafOutline::new(leaf, pose);
        let soft_px = 0.12 * outline.half_length_px + 1.0;
        let offset = TO_LIGHT * (-0.24 * leaf.half_length_px);
        let frame = Frame::new(pose.frame.origin + offset, pose.frame.angle_rad);
        self.fill(&frame, &outline, soft_px, |pixel, _, _, depth_px| {
            let cover = (0.5 + 0.5 * depth_px / soft_px).min(1.0);
            let light = 1.0 - SHADOW * cover * pixel[3];
            for channel in &mut pixel[..3] {
                *channel *= light;
            }
        });
    }

    fn branch(&mut self, branch: &Branch, frame: &Frame) {
        let outline = BranchOutline::new(branch);
        let axis = frame.axis();
        let across = (axis.x * TO_LIGHT.y - axis.y * TO_LIGHT.x) as f32;
        self.fill(frame, &outline, 0.5, |pixel, x, y, depth_px| {
            let (radius_px, off_px) = outline.section(x, y);
            let round = (off_px / radius_px).clamp(-1.0, 1.0);
            // Furrows wind along the bark.
            let furrow = round * 6.0 + 1.6 * (x * 0.06).sin();
            let bark = 0.08 * (furrow + 0.5 * (x * 0.35).sin()).sin() + 0.06 * (x * 0.23 + furrow).sin();
            let light = 0.82 + 0.4 * across * round + bark;
            blend(pixel, branch.colour.map(|c| c * light), (depth_px + 0.5).min(1.0));
        });
    }

    /// Calls `paint(pixel, x, y, depth_px)` at every pixel that lies deeper than `-soft_px` in a shape.
    #[inline]
    fn fill(
        &mut self,
        frame: &Frame,
        outline: &impl Outline,
        soft_px: f32,
        mut paint: impl FnMut(&mut [f32; 4], f32, f32, f32),
    ) {
        let bounds = outline.bounds(soft_px + 0.5);
        let axis = frame.axis();
        let corners = [(0, 0), (0, 1), (1, 0), (1, 1)]
            .map(|(i, j)| frame.out(Point::new(f64::from(bounds.x[i]), f64::from(bounds.y[j]))).y);
        let top = corners.into_iter().fold(f64::INFINITY, f64::min).ceil().max(0.0);
        let bottom = corners.into_iter().fold(f64::NEG_INFINITY, f64::max).floor();
        if bottom < 0.0 || top > (self.height - 1) as f64 {
            return;
        }
        let (ax, ay) = (axis.x as f32, axis.y as f32);
        for row in top as usize..=(bottom as usize).min(self.height - 1) {
            // Local place of the row's pixel 0, then the columns where both coordinates are within bounds.
            let local = frame.into_local(Point::new(0.0, row as f64));
            let (x0, y0) = (local.x as f32, local.y as f32);
            let mut span = [0.0, (self.width - 1) as f32];
            clip(&mut span, x0, ax, bounds.x);
            clip(&mut span, y0, -ay, bounds.y);
            if span[0] > span[1] {
                continue;
            }
            let start = row * self.width;
            let columns = span[0].ceil() as usize..=span[1].floor() as usize;
            for column in columns {
                let (x, y) = (x0 + ax * column as f32, y0 - ay * column as f32);
                let depth_px = outline.depth_px(x, y);
                if depth_px > -soft_px {
                    paint(&mut self.pixels[start + column], x, y, depth_px);
                }
            }
        }
    }
}

/// Narrows a span of columns to where `start + step · column` lies within bounds.
fn clip(span: &mut [f32; 2], start: f32, step: f32, bounds: [f32; 2]) {
    if step.abs() < 1e-6 {
        if start < bounds[0] || start > bounds[1] {
            span[1] = -1.0;
        }
        return;
    }
    let ends = bounds.map(|bound| (bound - start) / step);
    span[0] = span[0].max(ends[0].min(ends[1]));
    span[1] = span[1].min(ends[0].max(ends[1]));
}

#[inline]
fn blend(pixel: &mut [f32; 4], colour: [f32; 3], cover: f32) {
    let [r, g, b] = colour;
    for (under, over) in pixel.iter_mut().zip([r, g, b, 1.0]) {
        *under += cover * (over - *under);
    }
}

//! Dense motion against a true flow: the end-point error of every pixel (Baker et al. 2011).

use honami_exchange::flo::Flow;
use honami_host::{CallContext, Tracker};
use honami_media::Media;
use honami_motion::accuracy::median;
use honami_motion::overlay::VelocityField;

use crate::drive::view;
use crate::error::WorkbenchError;

/// How far the motion that a tracker measures is from the true one, over the pixels of which both know something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldError {
    /// Mean distance, pixels.
    pub mean_px: f64,
    /// Median distance, pixels.
    pub median_px: f64,
    /// Root of the mean squared distance, pixels.
    pub rms_px: f64,
    /// Share of these pixels that are off by more than a pixel.
    pub over_1px: f64,
    /// Share of the pixels with a known truth of which the tracker knows the motion.
    pub reached: f64,
}

/// Measures the motion from a frame to the next one and compares it; `None` where nothing can be compared.
pub(super) fn measure(
    media: &Media,
    tracker: &mut Tracker,
    truth: &Flow,
    frame: u32,
) -> Result<Option<FieldError>, WorkbenchError> {
    let pictures = [media.frame(frame)?, media.frame(frame + 1)?];
    let [from, to] = [(&pictures[0], frame), (&pictures[1], frame + 1)]
        .map(|(picture, frame)| view(media, picture, frame));
    let field = tracker.field(&from, &to, 1, &CallContext::silent())?;
    // Displacements instead of velocities: both are vectors on a grid.
    let field = VelocityField {
        origin: field.origin.map(f64::from),
        step_px: f64::from(field.step),
        nx: field.nx as usize,
        velocities: field.vectors,
    };
    Ok(error(&field, truth))
}

/// `None` where nothing can be compared.
fn error(field: &VelocityField, truth: &Flow) -> Option<FieldError> {
    let width = truth.width as usize;
    let known = truth.vectors.iter().enumerate().filter_map(|(k, vector)| Some((k, (*vector)?)));
    let mut n_known = 0_usize;
    let mut errors = Vec::new();
    for (k, [u, v]) in known {
        n_known += 1;
        let at = field.at([(k % width) as f64, (k / width) as f64]);
        errors.extend(at.map(|[x, y]| (x - f64::from(u)).hypot(y - f64::from(v))));
    }
    let n = errors.len() as f64;
    let over = errors.iter().filter(|px| **px > 1.0).count() as f64;
    Some(FieldError {
        mean_px: errors.iter().sum::<f64>() / n,
        rms_px: (errors.iter().map(|px| px * px).sum::<f64>() / n).sqrt(),
        over_1px: over / n,
        reached: n / n_known as f64,
        median_px: median(errors)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_point_errors_by_hand() {
        // The field says (1, 0) everywhere in the left two columns; of the truth two pixels are unknown.
        let velocities = vec![Some([1.0, 0.0]); 4];
        let field = VelocityField { origin: [0.0, 0.0], step_px: 1.0, nx: 2, velocities };
        let known = [Some([1.0, 0.0]), Some([1.0, 3.0]), Some([0.0, 0.0]), Some([1.0, 0.5]), None, None];
        let truth = Flow { width: 3, height: 2, vectors: known.to_vec() };
        let wanted = FieldError {
            mean_px: 3.5 / 3.0,
            median_px: 0.5,
            rms_px: (9.25_f64 / 3.0).sqrt(),
            over_1px: 1.0 / 3.0,
            reached: 0.75,
        };
        assert_eq!(error(&field, &truth), Some(wanted));
        assert_eq!(error(&field, &Flow { width: 1, height: 1, vectors: vec![None] }), None);
        // What the tracker does not know is no motion of zero: it is not reached.
        let velocities = vec![Some([1.0, 0.0]), None, None, None];
        let found = error(&VelocityField { velocities, ..field }, &truth).unwrap();
        assert_eq!((found.mean_px, found.reached), (0.0, 0.25));
    }
}

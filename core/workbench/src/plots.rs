//! What is plotted of a track or of several together: where it is, how fast, how good, and how it sways.

use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::track::{Sample, Span};
use honami_motion::overlay::velocity;
use honami_motion::spectrum::{Analyser, Peak, Spectrum};

use crate::spectra::{OVER_FLOOR, OVER_FLOOR_OF_MANY, positions};

/// A value for every frame of the clip, `None` where there is none.
pub type Series = Vec<Option<f64>>;

/// How something sways.
#[derive(Clone, Debug, PartialEq)]
pub struct Sway {
    /// Power over frequency.
    pub spectrum: Spectrum,
    /// The strongest sway that stands out, if one does.
    pub peak: Option<Peak>,
    /// Of several tracks, the share of the power about the peak that is common to them, 0 to 1.
    pub coherence: Option<f64>,
}

/// Curves of one track, or the means of several.
#[derive(Clone, Debug, PartialEq)]
pub struct Plots {
    /// Number of tracks.
    pub n_tracks: usize,
    /// Image x, pixels; of several tracks the mean distance from where each is on average.
    pub x_px: Series,
    /// Image y, pixels, likewise.
    pub y_px: Series,
    /// Speed, px/s.
    pub speed_px_s: Series,
    /// Forward-backward error, pixels.
    pub fb_px: Series,
    /// Normalised cross-correlation with the template.
    pub ncc: Series,
    /// How it sways: of several tracks their median; or the line that says why nothing is known of it.
    pub sway: Result<Sway, String>,
}

/// Curves of tracks of a clip with these frame times. May take a second for many long tracks with gaps.
#[must_use]
pub fn of(tracks: &[Arc<Span>], times: &FrameTimes) -> Plots {
    let middles: Vec<[f64; 2]> =
        tracks.iter().map(|span| if tracks.len() > 1 { middle(span) } else { [0.0; 2] }).collect();
    let seen = |span: &Span, frame| span.get(frame).filter(|s| s.status.is_seen()).copied();
    let mean = |value: &dyn Fn(usize, &Span, u32) -> Option<f64>| -> Series {
        let in_frame = |frame| {
            let values = tracks.iter().enumerate().filter_map(|(i, span)| value(i, span, frame));
            let (n, sum) = values.fold((0_u32, 0.0), |(n, sum), value| (n + 1, sum + value));
            (n > 0).then(|| sum / f64::from(n))
        };
        (0..times.len()).map(in_frame).collect()
    };
    let quality = |part: fn(&Sample) -> Option<f32>| {
        mean(&move |_, span, frame| part(&seen(span, frame)?).map(f64::from))
    };
    Plots {
        n_tracks: tracks.len(),
        x_px: mean(&|i, span, frame| Some(f64::from(seen(span, frame)?.x) - middles[i][0])),
        y_px: mean(&|i, span, frame| Some(f64::from(seen(span, frame)?.y) - middles[i][1])),
        speed_px_s: mean(&|_, span, frame| velocity(span, times, frame).map(|[u, v]| u.hypot(v))),
        fb_px: quality(|sample| sample.quality.fb_px),
        ncc: quality(|sample| sample.quality.ncc),
        sway: sway(tracks, times),
    }
}

/// Where a track is on average, over the frames in which it is seen.
fn middle(span: &Span) -> [f64; 2] {
    let seen = span.samples.iter().filter(|s| s.status.is_seen());
    let (n, x, y) =
        seen.fold((0.0, 0.0, 0.0), |(n, x, y), s| (n + 1.0, x + f64::from(s.x), y + f64::from(s.y)));
    if n > 0.0 { [x / n, y / n] } else { [0.0; 2] }
}

fn sway(tracks: &[Arc<Span>], times: &FrameTimes) -> Result<Sway, String> {
    let analyser = Analyser::new(times).map_err(|error| error.to_string())?;
    let positions: Vec<_> = tracks.iter().map(|span| positions(span, times.len())).collect();
    let spectra: Vec<_> = positions.iter().map(|track| analyser.track(track)).collect();
    let why = spectra.iter().find_map(|spectrum| spectrum.as_ref().err().map(ToString::to_string));
    let spectra: Vec<Spectrum> = spectra.into_iter().filter_map(Result::ok).collect();
    let over_floor = if spectra.len() > 1 { OVER_FLOOR_OF_MANY } else { OVER_FLOOR };
    let Some(spectrum) = Spectrum::median(&spectra) else {
        return Err(why.unwrap_or_else(|| "there are no tracks".to_owned()));
    };
    if spectrum.power_px2.iter().all(|power| *power < 1e-12) {
        return Err("nothing sways: it stands still".to_owned());
    }
    let peak = spectrum.peaks(1, over_floor).into_iter().next();
    let coherence = peak.as_ref().and_then(|peak| analyser.coherence(&positions, peak.hz));
    Ok(Sway { spectrum, peak, coherence })
}

#[cfg(test)]
mod tests;

//! From keys and paints to figures.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::terminal::Paint;

/// A key that was pressed, and the frame it goes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Press {
    pub(crate) at: Instant,
    pub(crate) frame: u32,
}

/// What became of a row of keys.
pub(crate) struct Outcome {
    latencies_ms: Vec<f64>,
    n_counted: usize,
    seconds: f64,
    stale_ms: Option<f64>,
}

impl Outcome {
    /// Paints count when `counts` says so. A key is painted by the first such paint that shows its frame or that of
    /// a later key.
    pub(crate) fn of(presses: &[Press], paints: &[Paint], counts: impl Fn(&Paint) -> bool) -> Self {
        let mut latencies_ms = Vec::new();
        let mut n_painted = 0;
        let mut n_counted = 0;
        let mut last_painted = None;
        let end = presses.last().map(|press| press.at);
        for paint in paints.iter().filter(|paint| counts(paint)) {
            // The latest key that can be what is seen.
            let shown = presses.iter().rposition(|p| p.frame == paint.number && p.at <= paint.at);
            let Some(shown) = shown.filter(|shown| shown + 1 > n_painted) else { continue };
            for press in &presses[n_painted..=shown] {
                latencies_ms.push(ms(paint.at - press.at));
            }
            n_painted = shown + 1;
            n_counted += usize::from(end.is_some_and(|end| paint.at <= end));
            if n_painted == presses.len() {
                last_painted = Some(paint.at);
                break;
            }
        }
        latencies_ms.sort_by(f64::total_cmp);
        let seconds = match presses {
            [first, .., last] => (last.at - first.at).as_secs_f64(),
            _ => 0.0,
        };
        let stale_ms = last_painted.zip(end).map(|(at, end)| ms(at - end));
        // Keys that were never painted took for ever.
        latencies_ms.resize(presses.len(), f64::INFINITY);
        Self { latencies_ms, n_counted, seconds, stale_ms }
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "p50_ms": rounded(percentile(&self.latencies_ms, 50.0)),
            "p99_ms": rounded(percentile(&self.latencies_ms, 99.0)),
            "max_ms": rounded(percentile(&self.latencies_ms, 100.0)),
            "stale_ms": self.stale_ms.and_then(|ms| rounded(Some(ms))),
            "paints_per_s": rounded((self.seconds > 0.0).then(|| self.n_counted as f64 / self.seconds)),
        })
    }
}

/// Bytes and pictures of some paints.
pub(crate) fn paints_json(paints: &[Paint]) -> Value {
    let mut sizes: Vec<f64> = paints.iter().map(|paint| paint.n_bytes as f64).collect();
    let mut psnr: Vec<f64> = paints.iter().map(|paint| paint.psnr.min(99.0)).collect();
    sizes.sort_by(f64::total_cmp);
    psnr.sort_by(f64::total_cmp);
    json!({
        "n": paints.len(),
        "bytes_p50": rounded(percentile(&sizes, 50.0)),
        "bytes_p99": rounded(percentile(&sizes, 99.0)),
        "psnr_min_db": rounded(percentile(&psnr, 0.0)),
        "psnr_p1_db": rounded(percentile(&psnr, 1.0)),
        "psnr_p10_db": rounded(percentile(&psnr, 10.0)),
        "psnr_p50_db": rounded(percentile(&psnr, 50.0)),
    })
}

/// The smallest value that so many percent do not exceed.
fn percentile(sorted: &[f64], percent: f64) -> Option<f64> {
    let rank = (percent / 100.0 * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

/// To a tenth; `None` for what is not finite.
pub(crate) fn rounded(value: Option<f64>) -> Option<f64> {
    value.filter(|v| v.is_finite()).map(|v| (v * 10.0).round() / 10.0)
}

pub(crate) fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

//! Errors of mean, median and mode of displacements of which a part moves another way, as a table in JSON.
#![allow(clippy::print_stdout, reason = "a benchmark speaks to a person")]

use honami_vision::robust::{Params, mode};
use serde_json::json;

#[path = "robust_bench/draws.rs"]
mod draws;

fn main() {
    let params = Params::default();
    // Never degenerate: the draws are noisy.
    let at = |samples: &[[f64; 2]]| mode(samples, &params).map_or([f64::NAN; 2], |mode| mode.at);
    for share in [0.0, 0.1, 0.2, 0.3, 0.4, 0.45] {
        for away_px in [0.5, 1.0, 1.5, 2.0, 4.0, 16.0] {
            let [mean, median, mode] = draws::errors(share, away_px, &at).map(|e| (e * 1e3).round() / 1e3);
            println!(
                "{}",
                json!({ "outliers": share, "away_px": away_px, "rms_px": { "mean": mean, "median": median, "mode": mode } })
            );
        }
    }
}

//! How long the modes of trees take, from a thousand nodes to a hundred thousand.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use honami_mechanics::{Beams, Modes, Options};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "{:>8} {:>9} {:>9} {:>10} {:>9}  f1..f25 Hz",
        "nodes", "assemble", "modes", "of 7 runs", "residual"
    );
    let sizes: Vec<usize> = std::env::args().skip(1).map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    for n in if sizes.is_empty() { vec![1000, 3437, 10_000, 30_000, 100_000] } else { sizes } {
        let plant = honami_synth::tree(n, 1)?;
        let beams = Beams::new(&plant, &Options::default())?;
        let begun = Instant::now();
        beams.mass();
        let assemble = begun.elapsed();
        let mut times = Vec::new();
        let mut modes = None;
        for _ in 0..if n > 20_000 { 1 } else { 7 } {
            let begun = Instant::now();
            modes = Some(Modes::new(&beams, 25, 1)?);
            times.push(begun.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        let Some(modes) = modes else { continue };
        let worst = modes.residuals.iter().copied().fold(0.0, f64::max);
        println!(
            "{n:>8} {:>6.2} ms {:>6.1} ms {:>7.1} ms {worst:>9.1e}  {:.4} {:.4}",
            assemble.as_secs_f64() * 1e3,
            times[times.len() / 2],
            times[times.len() - 1],
            modes.hz(0),
            modes.hz(24),
        );
    }
    Ok(())
}

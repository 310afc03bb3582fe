//! Poses of many copies of a plant, cell by cell of the thesis's table 6.1.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use honami_mechanics::{Beams, Form, Modes, Options, Rig};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "{:>6} {:>6} {:>6} {:>7} {:>9} {:>9} {:>8}",
        "K", "N", "M", "powers", "fps 1 thr", "fps 2 thr", "Gnm/s"
    );
    for (k, n, m) in [
        (1000, 100, 25),
        (1000, 1000, 25),
        (1000, 8000, 25),
        (8000, 1000, 25),
        (500, 3437, 25),
        (4000, 3437, 25),
        (10_000, 3437, 25),
    ] {
        let beams = Beams::new(&honami_synth::tree(n, 1)?, &Options::default())?;
        let modes = Modes::new(&beams, m, 1)?;
        for form in [Form::Linear, Form::Mode(2), Form::Mode(3)] {
            let rig = Rig::new(&beams, &modes, &vec![1.0; m], form);
            let amplitudes: Vec<f32> = (0..k * m).map(|i| (i as f32 * 0.37).sin()).collect();
            let mut poses = vec![0.0; k * rig.n_columns()];
            let mut fps = [0.0_f64; 2];
            for (threads, fps) in (1..).zip(&mut fps) {
                for _ in 0..5 {
                    let begun = Instant::now();
                    rig.pose(&amplitudes, threads, &mut poses);
                    *fps = fps.max(begun.elapsed().as_secs_f64().recip());
                }
            }
            let powers = if let Form::Mode(powers) = form { powers } else { 1 };
            let nm = (k * n * m * powers) as f64 * fps[1] / 1e9;
            println!("{k:>6} {n:>6} {m:>6} {powers:>7} {:>9.1} {:>9.1} {nm:>8.1}", fps[0], fps[1]);
        }
    }
    Ok(())
}

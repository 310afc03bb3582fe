//! How long the slowest vibrations of a plant take, beside SciPy's on the same matrices: turn by turn, one thread.
//!
//! `modes_bench [--modes N] [--repeats N] [--python PYTHON] [NODES…]`
//!
//! A row a tree (`synth::tree(NODES, 1)`): milliseconds from its matrices to modes that are proved to be all, the worst
//! residual, SciPy's milliseconds, how many times as long that is, and how far apart the frequencies are. Without Python
//! or SciPy its columns are empty.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "modes_bench/peer.rs"]
mod peer;

use std::time::Instant;

use honami_mechanics::{Beams, Modes, Options};
use peer::Peer;

type Failure = Box<dyn std::error::Error>;

/// What the command line asks for.
struct Wish {
    nodes: Vec<usize>,
    n_modes: usize,
    repeats: usize,
    python: String,
}

fn main() -> Result<(), Failure> {
    let wish = wish(std::env::args().skip(1))?;
    println!(
        "{} modes, one thread, milliseconds: median (least-most of {} turns)",
        wish.n_modes, wish.repeats
    );
    println!(
        "{:>8} {:>26} {:>9} {:>9} {:>29} {:>21} {:>10}",
        "nodes", "honami", "µs a node", "residual", "scipy", "times as long", "apart"
    );
    wish.nodes.iter().try_for_each(|&n_nodes| row(n_nodes, &wish))
}

fn wish(mut args: impl Iterator<Item = String>) -> Result<Wish, Failure> {
    let mut wish = Wish { nodes: Vec::new(), n_modes: 25, repeats: 5, python: "python3".into() };
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(format!("{arg} needs a value"));
        match arg.as_str() {
            "--modes" => wish.n_modes = value()?.parse()?,
            "--repeats" => wish.repeats = value()?.parse()?,
            "--python" => wish.python = value()?,
            flag if flag.starts_with('-') => return Err(format!("unknown option {flag}").into()),
            nodes => wish.nodes.push(nodes.parse()?),
        }
    }
    if wish.nodes.is_empty() {
        wish.nodes = vec![1000, 3437, 10_000, 100_000];
    }
    Ok(wish)
}

/// Prints how long one tree takes.
fn row(n_nodes: usize, wish: &Wish) -> Result<(), Failure> {
    let beams = Beams::new(&honami_synth::tree(n_nodes, 1)?, &Options::default())?;
    let peer = Peer::start(&wish.python, &beams, wish.n_modes);
    let mut peer = peer.inspect_err(|why| println!("no peer: {why}")).ok();
    let (mut ours, mut theirs, mut times) = (Vec::new(), Vec::new(), Vec::new());
    let (mut residual, mut apart) = (0.0_f64, 0.0_f64);
    for _ in 0..wish.repeats {
        let begun = Instant::now();
        let modes = Modes::new(&beams, wish.n_modes, 1)?;
        let ms = 1e3 * begun.elapsed().as_secs_f64();
        ours.push(ms);
        residual = modes.residuals.iter().copied().fold(residual, f64::max);
        let Some(peer) = &mut peer else { continue };
        let turn = peer.turn()?;
        theirs.push(turn.ms);
        times.push(turn.ms / ms);
        let off = |(mode, hz): (usize, &f64)| (modes.hz(mode) / hz - 1.0).abs();
        apart = turn.hz.iter().enumerate().map(off).fold(apart, f64::max);
    }
    let a_node = 1e3 * median(&mut ours.clone()) / n_nodes as f64;
    let apart = if theirs.is_empty() { String::new() } else { format!("{apart:.1e}") };
    println!(
        "{n_nodes:>8} {:>26} {a_node:>9.2} {residual:>9.1e} {:>29} {:>21} {apart:>10}",
        spread(ours),
        spread(theirs),
        spread(times)
    );
    Ok(())
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn spread(mut values: Vec<f64>) -> String {
    let median = median(&mut values);
    match (values.first(), values.last()) {
        (Some(least), Some(most)) => format!("{median:.1} ({least:.1}-{most:.1})"),
        _ => String::new(),
    }
}

use honami_exchange::plant::mtg;
use honami_mechanics::{Beams, Modes, Options};
use honami_model::plant::RadiusRule;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(std::env::args().nth(1).unwrap())?;
    for classes in [vec!["S".to_owned()], vec![]] {
        let m = mtg::parse(&text, &mtg::Options { classes, ..Default::default() })?;
        println!("{:?} {} nodes {:.3} m", m.notes, m.plant.nodes().len(), m.plant.height());
        for rule in [RadiusRule::Mean, RadiusRule::Tip] {
            let beams = Beams::new(&m.plant, &Options { rule, ..Options::default() })?;
            let t = std::time::Instant::now();
            let modes = Modes::new(&beams, 25, 1)?;
            println!(
                "{rule:?} {} nodes, merged {} stubby {}: {:.4} {:.4} {:.4} .. {:.4} Hz, res {:e}, {:?}",
                beams.len(),
                beams.n_merged(),
                beams.n_stubby(),
                modes.hz(0),
                modes.hz(1),
                modes.hz(2),
                modes.hz(24),
                modes.residuals.iter().copied().fold(0.0, f64::max),
                t.elapsed()
            );
        }
    }
    Ok(())
}

//! `cargo xtask soak`: the end-to-end tests that kill, fill and refuse, for as long as one likes, on the program as shipped.

use anyhow::{Context as _, bail};

use crate::BUILD;
use crate::shell::cargo;

/// Kills of each kind of work, where nobody says how many or how long.
const KILLS: &str = "1000";

/// `soak [--kills N | --minutes N] [--seed S]`: so many kills, or so long, of each kind of work.
pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let mut asked = vec![("HONAMI_SOAK_KILLS", KILLS)];
    for pair in args.chunks(2) {
        let [word, number] = *pair else { bail!("{} wants a number", pair[0]) };
        number.parse::<u32>().with_context(|| format!("{word} wants a whole number, not {number}"))?;
        asked.push(match word {
            "--kills" => ("HONAMI_SOAK_KILLS", number),
            "--minutes" => ("HONAMI_SOAK_MINUTES", number),
            "--seed" => ("HONAMI_SOAK_SEED", number),
            _ => bail!("wanted soak [--kills N | --minutes N] [--seed S], got {word}"),
        });
    }
    cargo(BUILD).run()?;
    // The tests ask cargo for the program: this has them get the one that is shipped.
    let tests = cargo(&["test", "-p", "honami-tests", "--test", "it", "soak::", "--"]);
    let tests = tests.args(["--nocapture", "--test-threads=1"]).env("HONAMI_BUILD", "--release");
    asked.iter().fold(tests, |tests, (name, value)| tests.env(name, value)).run()
}

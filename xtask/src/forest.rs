//! `bench forest`: the tables of the thesis on this machine, and numpy's product of matrices cell by cell beside them.

use anyhow::Context as _;
use serde_json::{Value, json};

use crate::BUILD;
use crate::shell::{self, Step, cargo};

#[expect(unreachable_pub, reason = "it is the workbench's, where it is public")]
#[path = "../../core/workbench/src/plant/bench/cells.rs"]
mod cells;

use cells::{TABLE_6_1, TABLE_6_2};

/// `bench forest [--json] [KxNxM…]`: honami and numpy take turns, cell by cell.
pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let is_json = args.contains(&"--json");
    let wanted: Vec<&str> = args.iter().copied().filter(|arg| *arg != "--json").collect();
    cargo(BUILD).args(["-p", "honami", "-p", "honami-simulator-modal"]).run()?;
    let mut tables = json!({});
    let mut roof = json!(null);
    for (table, cells) in [("table_6_1", &TABLE_6_1[..]), ("table_6_2", &TABLE_6_2)] {
        let mut rows = Vec::new();
        let names = cells.iter().map(|(copies, nodes, modes, _)| format!("{copies}x{nodes}x{modes}"));
        for cell in names.filter(|cell| wanted.is_empty() || wanted.contains(&cell.as_str())) {
            let args = ["bench", "forest", "--json", "--cell", &cell];
            let ours = read(&shell::built("release", "honami")?.args(args).output()?)?;
            let numpy = read(&Step::new("python3").args(["tests/peers/forest_numpy.py", &cell]).output()?)?;
            let mut row = ours["cells"][0].clone();
            row["numpy_fps"] = numpy[&cell].clone();
            row["boundary"] = ours["boundary"].clone();
            roof = ours["roof"].clone();
            if !is_json {
                println!("{}", line(&cell, &row));
            }
            rows.push(row);
        }
        tables[table] = Value::Array(rows);
    }
    tables["roof"] = roof;
    if is_json {
        println!("{}", serde_json::to_string_pretty(&tables)?);
    } else {
        println!("at most: {}", tables["roof"]);
    }
    Ok(())
}

fn read(text: &str) -> anyhow::Result<Value> {
    serde_json::from_str(text).context("a benchmark that prints no JSON")
}

/// A cell in a line: frames per second.
fn line(cell: &str, row: &Value) -> String {
    let number = |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), |fps| format!("{fps:.1}"));
    let share = |form: &str| format!("{:.0} %", 100.0 * row[form]["of_limit"].as_f64().unwrap_or_default());
    format!(
        "{cell:14} thesis {:>7}  numpy {:>8}  linear {:>8} ({})  s,s2 {:>8} ({})  s,s2,s3 {:>8} ({})  turns {:>8}  state {:.1} %  plugin {:+.1} %",
        number(&row["thesis_fps"]),
        number(&row["numpy_fps"]),
        number(&row["fps"]),
        share("linear"),
        number(&row["squared"]["fps"]),
        share("squared"),
        number(&row["cubed"]["fps"]),
        share("cubed"),
        number(&row["turned"]["fps"]),
        100.0 * row["turned"]["state_share"].as_f64().unwrap_or_default(),
        100.0 * (row["boundary"]["ratio"][1].as_f64().unwrap_or_default() - 1.0),
    )
}

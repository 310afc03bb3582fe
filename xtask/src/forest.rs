//! `bench forest`: the tables of the thesis on this machine, and numpy's product of matrices cell by cell beside them.

use anyhow::Context as _;
use serde_json::{Value, json};

use crate::BUILD;
use crate::shell::{self, Step, cargo};

/// Cells of table 6.1 and the largest forest, and of table 6.2.
const TABLES: [(&str, &[&str]); 2] = [
    (
        "table_6_1",
        &[
            "100x1000x25",
            "100x2000x25",
            "100x8000x25",
            "1000x100x25",
            "1000x500x25",
            "1000x1000x25",
            "1000x2000x25",
            "1000x8000x25",
            "8000x20x25",
            "8000x100x25",
            "8000x500x25",
            "8000x1000x25",
            "10000x3437x25",
        ],
    ),
    (
        "table_6_2",
        &[
            "500x3437x5",
            "1000x3437x5",
            "2000x3437x5",
            "4000x3437x5",
            "500x3437x15",
            "1000x3437x15",
            "2000x3437x15",
            "4000x3437x15",
            "500x3437x25",
            "1000x3437x25",
            "2000x3437x25",
            "4000x3437x25",
        ],
    ),
];

/// `bench forest [--json] [KxNxM…]`: honami and numpy take turns, cell by cell.
pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let is_json = args.contains(&"--json");
    let wanted: Vec<&str> = args.iter().copied().filter(|arg| *arg != "--json").collect();
    cargo(BUILD).args(["-p", "honami", "-p", "honami-simulator-modal"]).run()?;
    let mut tables = json!({});
    let mut roof = json!(null);
    for (table, cells) in TABLES {
        let mut rows = Vec::new();
        for cell in cells.iter().filter(|cell| wanted.is_empty() || wanted.contains(cell)) {
            let args = ["bench", "forest", "--json", "--cell", cell];
            let ours = read(&shell::built("release", "honami")?.args(args).output()?)?;
            let numpy = read(&Step::new("python3").args(["tests/peers/forest_numpy.py", cell]).output()?)?;
            let mut row = ours["cells"][0].clone();
            row["numpy_fps"] = numpy[*cell].clone();
            row["boundary"] = ours["boundary"].clone();
            roof = ours["roof"].clone();
            if !is_json {
                println!("{}", line(cell, &row));
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

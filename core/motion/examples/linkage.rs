//! Links a condensed matrix from a file of little-endian f64: `linkage N average|ward FILE`; prints JSON.

use std::time::Instant;

use honami_motion::{Criterion, linkage};

#[expect(clippy::print_stdout, reason = "the result is for a script")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [n, method, path] = std::env::args()
        .skip(1)
        .collect::<Vec<_>>()
        .try_into()
        .map_err(|args| format!("wanted: linkage N average|ward FILE; came {args:?}"))?;
    let criterion = match method.as_str() {
        "average" => Criterion::Average,
        "ward" => Criterion::Ward,
        _ => return Err(format!("wanted average or ward, came {method}").into()),
    };
    let bytes = std::fs::read(path)?;
    let condensed = bytes.as_chunks().0.iter().map(|&chunk| f64::from_le_bytes(chunk)).collect();
    let start = Instant::now();
    let tree = linkage(condensed, n.parse()?, criterion)?;
    let ms = 1e3 * start.elapsed().as_secs_f64();
    let rows: Vec<[f64; 4]> =
        tree.merges().iter().map(|m| [f64::from(m.a), f64::from(m.b), m.height, f64::from(m.size)]).collect();
    println!("{}", serde_json::json!({ "ms": ms, "rows": rows }));
    Ok(())
}

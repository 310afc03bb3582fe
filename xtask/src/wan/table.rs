//! What was measured, as a table for people.

use serde_json::Value;

const HEAD: &str = "case                                paints/s  B/paint   p50 ms   p99 ms  stale ms  exact ms   dB p50   dB p1  by number p99/stale";

/// The storm's row of every case, then what the other parts of the sessions say.
pub(super) fn print(results: &serde_json::Map<String, Value>) {
    println!(
        "\nA step key held at 30 per second for 6 s; a paint counts from 35 dB on (30 dB at 120x36).\n{HEAD}"
    );
    rows(results, "storm");
    println!("\nA step key held at 25 per second for 5 s.\n{HEAD}");
    rows(results, "held");
    println!("\nSingle keys, 2 per second.\n{HEAD}");
    rows(results, "isolated");
    println!(
        "\ncase                                 first byte ms  chrome ms  exact ms  unacked B  idle B  switches/min  CPU %"
    );
    for (name, result) in results {
        let idle = &result["idle"];
        let per_minute = idle["used"]["switches"]
            .as_f64()
            .zip(idle["seconds"].as_f64())
            .map(|(switches, seconds)| switches * 60.0 / seconds);
        println!(
            "{name:36} {:>13} {:>10} {:>9} {:>10} {:>7} {:>13} {:>6}",
            number(&result["start"]["first_byte_ms"]),
            number(&result["start"]["first_chrome_ms"]),
            number(&result["start"]["exact_ms"]),
            number(&result["storm"]["unacked_max"]),
            number(&idle["bytes"]),
            per_minute.map_or("-".to_owned(), |n| format!("{n:.0}")),
            number(&idle["used"]["cpu_percent"]),
        );
    }
}

fn rows(results: &serde_json::Map<String, Value>, part: &str) {
    for (name, result) in results {
        let Some(measured) = result.get(part) else { continue };
        println!(
            "{name:36} {:>7} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>7}  {} / {}",
            number(&measured["paints_per_s"]),
            number(&measured["paints"]["bytes_p50"]),
            number(&measured["p50_ms"]),
            number(&measured["p99_ms"]),
            number(&measured["stale_ms"]),
            number(&measured["exact_ms"]),
            number(&measured["paints"]["psnr_p50_db"]),
            number(&measured["paints"]["psnr_p1_db"]),
            number(&measured["number_only"]["p99_ms"]),
            number(&measured["number_only"]["stale_ms"]),
        );
    }
}

/// A number as short as may be; `-` where there is none: never seen, or not measured here.
fn number(value: &Value) -> String {
    match value.as_f64() {
        Some(x) if x.abs() >= 1000.0 || x.fract() == 0.0 => format!("{x:.0}"),
        Some(x) => format!("{x:.1}"),
        None => "-".to_owned(),
    }
}

//! Time that the encoder takes for a frame of moving leaves, as one line of JSON per size.
//!
//! `cargo run --release -p honami --example encode_bench`

use std::io::Write as _;
use std::time::Instant;

use honami_tui::term::colour::Depth;
use honami_tui::term::encode::{Encoder, Frame, HALF_BLOCK};
use ratatui::style::{Color, Style};

/// Bytes of a frame, as on a link of 2 Mbit/s.
const BUDGET: usize = 8 << 10;
const N_FRAMES: u16 = 300;

fn main() -> std::io::Result<()> {
    for (columns, rows) in [(80, 24), (120, 36), (160, 45)] {
        let mut encoder = Encoder::new(Depth::True);
        let mut bytes = Vec::new();
        let mut times_ms = Vec::new();
        for t in 0..N_FRAMES {
            let frame = leaves(columns, rows, f32::from(t) * 0.05);
            bytes.clear();
            let start = Instant::now();
            encoder.encode(&frame, BUDGET, true, &mut bytes);
            times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times_ms.sort_by(f64::total_cmp);
        let (p50, p99) = (times_ms[times_ms.len() / 2], times_ms[times_ms.len() * 99 / 100]);
        let line = serde_json::json!({"columns": columns, "rows": rows, "p50_ms": p50, "p99_ms": p99});
        writeln!(std::io::stdout(), "{line}")?;
    }
    Ok(())
}

/// Waves with noise on them, every cell a part of the picture.
fn leaves(columns: u16, rows: u16, t: f32) -> Frame {
    let mut frame = Frame::new(columns, rows);
    let mut noise = 1_u32;
    let mut pixel = |x: f32, y: f32| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let wave = (0.7 * x + 3.0 * (0.2 * y + t).sin()).sin() * (0.5 * y + 2.0 * (0.1 * x - t).cos()).cos();
        let v = 90.0 + 70.0 * wave + f32::from((noise >> 24) as u8 % 9);
        Color::Rgb((v * 0.6) as u8, v as u8, (v * 0.4) as u8)
    };
    for (i, cell) in frame.cells.content.iter_mut().enumerate() {
        let (x, y) = ((i % usize::from(columns)) as f32, (i / usize::from(columns) * 2) as f32);
        cell.set_symbol(HALF_BLOCK).set_style(Style::new().fg(pixel(x, y)).bg(pixel(x, y + 1.0)));
    }
    frame.softness.fill(1);
    frame
}

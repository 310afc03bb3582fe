//! What the encoder makes of pictures in motion: time, bytes and likeness, as one line of JSON per size and clip.
//!
//! `cargo run --release -p honami --example encode_bench -- [BYTES] [CLIP…]`: waves with noise, and the clips, stepped
//! through frame by frame with so many bytes a frame. The likeness is that of what a terminal emulator shows.

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use anyhow::Context as _;
use honami_tui::term::colour::Depth;
use honami_tui::term::encode::{Encoder, Frame, HALF_BLOCK};
use honami_workbench::media::{self, OpenOptions, Rect};
use ratatui::style::{Color, Style};

/// Bytes of a frame, as on a link of 2 Mbit/s.
const BUDGET: usize = 8 << 10;
const N_FRAMES: u16 = 300;
/// Columns and rows of a screen, of which four lines are no picture.
const SIZES: [(u16, u16); 3] = [(80, 24), (120, 36), (160, 45)];

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args().skip(1).peekable();
    let budget = words.next_if(|word| word.parse::<usize>().is_ok());
    let budget = budget.map_or(Ok(BUDGET), |word| word.parse())?;
    let clips: Vec<String> = words.collect();
    for (columns, rows) in SIZES {
        let frames = (0..N_FRAMES).map(|t| leaves(columns, rows - 4, f32::from(t) * 0.05));
        measure("waves", frames, budget)?;
        for clip in &clips {
            measure(clip, pictures(Path::new(clip), columns, rows - 4)?.into_iter(), budget)?;
        }
    }
    Ok(())
}

/// Shows frames one after another; prints what it took.
fn measure(clip: &str, frames: impl Iterator<Item = Frame>, budget: usize) -> anyhow::Result<()> {
    let mut encoder = Encoder::new(Depth::True);
    let mut bytes = Vec::new();
    let (mut times_ms, mut sizes, mut psnr) = (Vec::new(), Vec::new(), Vec::new());
    let mut size = (0, 0);
    let mut emulator = None;
    for frame in frames {
        size = (frame.cells.area.width, frame.cells.area.height);
        let (rows, columns) = (size.1.try_into()?, size.0.try_into()?);
        bytes.clear();
        // The first frame is shown whole: what follows is motion.
        let all = emulator.is_none();
        let emulator = emulator.get_or_insert_with(|| vt100::Parser::new(rows, columns, 0));
        let start = Instant::now();
        encoder.encode(&frame, if all { usize::MAX } else { budget }, !all, &mut bytes);
        if !all {
            times_ms.push(start.elapsed().as_secs_f64() * 1e3);
            sizes.push(bytes.len() as f64);
        }
        emulator.process(&bytes);
        psnr.push(likeness(emulator.screen(), &frame));
    }
    let round = |x: f64| (x * 1e3).round() / 1e3;
    let [times, sizes, psnr] = [&mut times_ms, &mut sizes, &mut psnr].map(|values| {
        values.sort_by(f64::total_cmp);
        [0.01, 0.1, 0.5, 0.99].map(|part| round(values[(values.len() as f64 * part) as usize]))
    });
    let line = serde_json::json!({
        "clip": clip, "columns": size.0, "rows": size.1, "p50_ms": times[2], "p99_ms": times[3],
        "bytes_p50": sizes[2], "bytes_p99": sizes[3],
        "psnr_p1_db": psnr[0], "psnr_p10_db": psnr[1], "psnr_p50_db": psnr[2],
    });
    writeln!(std::io::stdout(), "{line}")?;
    Ok(())
}

/// Peak signal to noise ratio of the screen, dB.
fn likeness(screen: &vt100::Screen, frame: &Frame) -> f64 {
    let rgb = |colour| match colour {
        vt100::Color::Rgb(r, g, b) => [r, g, b],
        _ => [0; 3],
    };
    let mut squares = 0.0;
    for (i, cell) in frame.cells.content.iter().enumerate() {
        let (x, y) = frame.cells.pos_of(i);
        let Some(there) = screen.cell(y, x) else { continue };
        let (fg, bg) = (rgb(there.fgcolor()), rgb(there.bgcolor()));
        let shown = match there.contents() {
            "▀" => [fg, bg],
            "▄" => [bg, fg],
            "█" => [fg; 2],
            _ => [bg; 2],
        };
        for (shown, wanted) in shown.into_iter().zip([cell.fg, cell.bg]) {
            let wanted = honami_tui::term::colour::rgb(wanted);
            squares += f64::from(honami_tui::term::colour::distance(shown, wanted));
        }
    }
    let mean = squares / (6 * frame.cells.content.len()) as f64;
    (10.0 * (255.0_f64.powi(2) / mean).log10()).min(99.0)
}

/// The frames of a clip, as large as they fit.
fn pictures(clip: &Path, room_x: u16, room_y: u16) -> anyhow::Result<Vec<Frame>> {
    let media = media::open(clip, &OpenOptions::default()).with_context(|| clip.display().to_string())?;
    let (width, height) = (media.clip().width, media.clip().height);
    let scale = (f64::from(width) / f64::from(room_x)).max(f64::from(height) / f64::from(2 * room_y));
    let columns = ((f64::from(width) / scale).round() as u16).min(room_x);
    let rows = ((f64::from(height) / scale / 2.0).round() as u16).min(room_y);
    (0..media.clip().n_frames())
        .map(|n| {
            let whole = Rect::whole(width, height);
            let pixels = media.rgb_area(n, whole, columns.into(), (2 * rows).into())?;
            let at = |x: u16, y: u16| pixels[usize::from(y) * usize::from(columns) + usize::from(x)];
            Ok(half_blocks(columns, rows, at))
        })
        .collect()
}

/// A frame of nothing but picture.
fn half_blocks(columns: u16, rows: u16, pixel: impl Fn(u16, u16) -> [u8; 3]) -> Frame {
    let mut frame = Frame::new(columns, rows);
    for (i, cell) in frame.cells.content.iter_mut().enumerate() {
        let (x, y) = ((i % usize::from(columns)) as u16, (i / usize::from(columns) * 2) as u16);
        let [above, below] = [pixel(x, y), pixel(x, y + 1)].map(|[r, g, b]| Color::Rgb(r, g, b));
        cell.set_symbol(HALF_BLOCK).set_style(Style::new().fg(above).bg(below));
    }
    frame.softness.fill(1);
    frame
}

/// Waves with noise on them.
fn leaves(columns: u16, rows: u16, t: f32) -> Frame {
    half_blocks(columns, rows, |x, y| {
        let seed = u32::from(x) ^ (u32::from(y) << 10) ^ ((t * 1e3) as u32) << 20;
        let noise = seed.wrapping_mul(0x9e37_79b1).rotate_left(13).wrapping_mul(0x85eb_ca6b);
        let (x, y) = (f32::from(x), f32::from(y));
        let wave = (0.7 * x + 3.0 * (0.2 * y + t).sin()).sin() * (0.5 * y + 2.0 * (0.1 * x - t).cos()).cos();
        let v = 90.0 + 70.0 * wave + f32::from((noise >> 24) as u8 % 9);
        [(v * 0.6) as u8, v as u8, (v * 0.4) as u8]
    })
}

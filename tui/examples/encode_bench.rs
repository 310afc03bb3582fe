//! What the encoder makes of pictures in motion: time, bytes and likeness, as one line of JSON per size and clip.
//!
//! `cargo run --release -p honami --example encode_bench -- [BYTES] [CLIP…]`: waves with noise, and the clips, stepped
//! through frame by frame with so many bytes a frame. The likeness is that of what a terminal emulator shows. A last line
//! has what it takes from a hierarchy of 2,000 tracks that is cut elsewhere to the bytes of a screen in other colours.

use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Context as _;
use honami_model::clip::{Clip, FrameTimes};
use honami_model::document::ClusteringId;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_tui::app::groups::Groups;
use honami_tui::app::layout::{Layout, Lens};
use honami_tui::app::panel::Panel;
use honami_tui::app::state::State;
use honami_tui::app::tracks::TrackRow;
use honami_tui::app::update::{Fact, Msg, update};
use honami_tui::app::view::{Shot, draw};
use honami_tui::term::colour::Depth;
use honami_tui::term::encode::{Encoder, Frame, HALF_BLOCK};
use honami_workbench::media::{self, OpenOptions, Rect};
use ratatui::style::{Color, Style};

/// Bytes of a frame, as on a link of 2 Mbit/s.
const BUDGET: usize = 8 << 10;
const N_FRAMES: u16 = 300;
/// Tracks whose hierarchy is cut.
const N_TRACKS: u32 = 2000;
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
    cuts(160, 45)
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
    let [times, sizes, psnr] = [times_ms, sizes, psnr].map(quantiles);
    let line = serde_json::json!({
        "clip": clip, "columns": size.0, "rows": size.1, "p50_ms": times[2], "p99_ms": times[3],
        "bytes_p50": sizes[2], "bytes_p99": sizes[3],
        "psnr_p1_db": psnr[0], "psnr_p10_db": psnr[1], "psnr_p50_db": psnr[2],
    });
    writeln!(std::io::stdout(), "{line}")?;
    Ok(())
}

/// The least hundredth and tenth of some values, their median and their largest hundredth.
fn quantiles(mut values: Vec<f64>) -> [f64; 4] {
    let round = |x: f64| (x * 1e3).round() / 1e3;
    values.sort_by(f64::total_cmp);
    [0.01, 0.1, 0.5, 0.99].map(|part| round(values[(values.len() as f64 * part) as usize]))
}

/// Cuts a hierarchy of many tracks into more and more groups; prints what the groups, the screen and its bytes took.
fn cuts(columns: u16, rows: u16) -> anyhow::Result<()> {
    let clip = Clip { width: 1280, height: 720, times: FrameTimes::constant(2, 25.0)? };
    let mut state = State::new("cuts".to_owned(), clip, (columns, rows));
    state.panel = Some(Panel::Groups);
    state.tracks = (0..N_TRACKS).map(row).collect();
    let tracks: Vec<TrackId> = (0..N_TRACKS).map(TrackId).collect();
    // The first two that are left join, again and again.
    let merge = |row| Merge { a: 2 * row, b: 2 * row + 1, height: f64::from(row), size: 0 };
    let mut merges: Vec<Merge> = (0..N_TRACKS - 1).map(merge).collect();
    for row in 0..merges.len() {
        let size = |part: u32| part.checked_sub(N_TRACKS).map_or(1, |row| merges[row as usize].size);
        merges[row].size = size(merges[row].a) + size(merges[row].b);
    }
    let tree = Dendrogram::new(N_TRACKS, merges)?;
    let lens = Lens::of(&state, Layout::of(&state).picture);
    let (width, height) = lens.size();
    let pixels = (0..width * height).map(|i| [(i % 251) as u8, (i % 83) as u8, 40]).collect();
    let shot = Shot { frame: state.frame, lens, pixels };
    let mut encoder = Encoder::new(Depth::True);
    let (mut times_ms, mut sizes) = (Vec::new(), Vec::new());
    for n_groups in 2..100 {
        let mut bytes = Vec::new();
        let start = Instant::now();
        let groups = (ClusteringId(1), tracks.clone(), tree.clone());
        let groups = Groups::new("by bod".to_owned(), groups, (n_groups, &[]), Vec::new());
        update(&mut state, Msg::Fact(Fact::Groups(Some(Box::new(groups)))));
        encoder.encode(&draw(&state, Some(&shot)), usize::MAX, false, &mut bytes);
        times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        sizes.push(bytes.len() as f64);
    }
    let [times, sizes] = [times_ms, sizes].map(quantiles);
    let line = serde_json::json!({
        "cuts": N_TRACKS, "columns": columns, "rows": rows, "p50_ms": times[2], "p99_ms": times[3], "bytes_p50": sizes[2],
    });
    writeln!(std::io::stdout(), "{line}")?;
    Ok(())
}

/// A track that is seen in two frames.
fn row(track: u32) -> TrackRow {
    let (x, y) = ((track * 7 % 1280) as f32, (track * 3 % 720) as f32);
    let sample =
        Sample { x, y, status: Status::Tracked, source: Source::Tracked, quality: Quality::default() };
    TrackRow::new(TrackId(track), None, Arc::new(Span { first_frame: 0, samples: vec![sample; 2] }))
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

//! What ffprobe knows of a video: size, samples and the time of every frame.

use std::path::Path;
use std::process::Command;

use honami_model::picture::Range;
use serde::Deserialize;

use super::super::{Probed, Shape, check_size, seconds, turned};
use super::{Video, first_line};
use crate::convert::{Chroma, Coded};
use crate::error::MediaError;
use crate::programs;

/// Size, format and times; `count_frames` decodes the whole stream for them even where its packets look sound.
pub(crate) fn probe(path: &Path, count_frames: bool) -> Result<Probed, MediaError> {
    let entries = "packet=pts,size,flags:format=format_name:stream_tags=rotate:stream_side_data=rotation:\
                   stream_disposition=attached_pic:stream=codec_name,width,height,pix_fmt,color_range,time_base,\
                   nb_frames,field_order,r_frame_rate,sample_aspect_ratio";
    let (answer, complaint) = ffprobe(path, entries)?;
    let not_a_video =
        |why: &str| Err(MediaError::NotAVideo { path: path.to_path_buf(), why: why.to_owned() });
    // ffmpeg draws text files as ANSI art; nobody means that.
    if answer.format.format_name == "tty" {
        return not_a_video("a text file");
    }
    let Some(stream) = answer.streams.first().filter(|s| s.disposition.attached_pic == 0) else {
        return not_a_video("no video stream in it");
    };
    let (width, height) = match (stream.width, stream.height) {
        (Some(width), Some(height)) if width > 0 && height > 0 => check_size(path, width, height)?,
        _ => return not_a_video("its video stream has no pictures"),
    };
    check_whole(path, &answer, stream, complaint.as_deref())?;
    let (coded, pixel_format, range) = samples(stream);
    let shape = Shape { width, height, colour: coded.colour(), range };
    let (times_s, mut notes) = times(path, &answer, stream, count_frames)?;
    if stream.sample_aspect_ratio.as_deref().is_some_and(|r| !matches!(r, "1:1" | "0:1" | "N/A")) {
        let ratio = stream.sample_aspect_ratio.as_deref().unwrap_or_default();
        notes.push(format!("its pixels are not square ({ratio}): positions are in stored pixels"));
    }
    let source = Video { path: path.to_path_buf(), shape, coded, pixel_format };
    Ok(turned(Probed { shape, times_s, notes, source: Box::new(source) }, stream.quarters_clockwise()))
}

#[derive(Deserialize)]
struct Answer {
    #[serde(default)]
    packets: Vec<Packet>,
    #[serde(default)]
    frames: Vec<Frame>,
    #[serde(default)]
    streams: Vec<Stream>,
    #[serde(default)]
    format: Format,
}

#[derive(Deserialize, Default)]
struct Format {
    #[serde(default)]
    format_name: String,
}

#[derive(Deserialize)]
struct Packet {
    pts: Option<i64>,
    #[serde(default)]
    size: String,
    #[serde(default)]
    flags: String,
}

#[derive(Deserialize)]
struct Frame {
    pts: Option<i64>,
    best_effort_timestamp: Option<i64>,
}

#[derive(Deserialize)]
struct Stream {
    #[serde(default)]
    codec_name: String,
    width: Option<u64>,
    height: Option<u64>,
    #[serde(default)]
    pix_fmt: String,
    #[serde(default)]
    color_range: String,
    #[serde(default)]
    time_base: String,
    #[serde(default)]
    r_frame_rate: String,
    #[serde(default)]
    field_order: String,
    sample_aspect_ratio: Option<String>,
    nb_frames: Option<String>,
    #[serde(default)]
    disposition: Disposition,
    #[serde(default)]
    tags: Tags,
    #[serde(default)]
    side_data_list: Vec<SideData>,
}

#[derive(Deserialize, Default)]
struct Disposition {
    #[serde(default)]
    attached_pic: u8,
}

#[derive(Deserialize, Default)]
struct Tags {
    rotate: Option<String>,
}

#[derive(Deserialize)]
struct SideData {
    rotation: Option<f64>,
}

impl Stream {
    /// Quarter turns that make the picture upright. The display matrix counts counter-clockwise, the old tag clockwise.
    fn quarters_clockwise(&self) -> u32 {
        let from_matrix = self.side_data_list.iter().find_map(|data| data.rotation).map(|degrees| -degrees);
        let from_tag = || self.tags.rotate.as_deref().and_then(|degrees| degrees.parse().ok());
        let degrees: f64 = from_matrix.or_else(from_tag).unwrap_or(0.0);
        (degrees / 90.0).round().rem_euclid(4.0) as u32
    }
}

fn ffprobe(path: &Path, entries: &str) -> Result<(Answer, Option<String>), MediaError> {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-of", "json", "-select_streams", "v:0", "-show_entries", entries]);
    let output = command.arg(programs::file_url(path)).output();
    let output = output.map_err(|e| MediaError::io("start ffprobe", path, e))?;
    let complaint = (!output.stderr.is_empty()).then(|| first_line(&output.stderr, path));
    if !output.status.success() {
        let why = complaint.unwrap_or_else(|| output.status.to_string());
        return Err(MediaError::NotAVideo { path: path.to_path_buf(), why });
    }
    let answer = serde_json::from_slice(&output.stdout).map_err(|e| MediaError::Program {
        program: "ffprobe",
        line: format!("an answer that is no JSON ({e})"),
        path: path.to_path_buf(),
    })?;
    Ok((answer, complaint))
}

/// Refuses a file that ends before its index says.
fn check_whole(
    path: &Path,
    answer: &Answer,
    stream: &Stream,
    complaint: Option<&str>,
) -> Result<(), MediaError> {
    if let Some(text) = complaint.filter(|text| {
        ["partial file", "prematurely", "truncated"].iter().any(|sign| text.to_lowercase().contains(sign))
    }) {
        return Err(MediaError::damaged(path, text));
    }
    // Other containers count slots (AVI) or guess.
    let counted = answer.format.format_name.contains("mp4").then_some(stream.nb_frames.as_deref()).flatten();
    if let Some(promised) = counted.and_then(|n| n.parse::<usize>().ok())
        && answer.packets.len() < promised
    {
        let why = format!("{} of {promised} frames are there", answer.packets.len());
        return Err(MediaError::damaged(path, why));
    }
    Ok(())
}

/// How we read the stream's samples: planes as coded wherever we know their layout, so that luma passes untouched.
fn samples(stream: &Stream) -> (Coded, Option<&'static str>, Range) {
    let declared = match stream.color_range.as_str() {
        "pc" => Some(Range::Full),
        "tv" => Some(Range::Limited),
        _ => None,
    };
    let planar = |chroma, bits| Coded::Planar { chroma, bits };
    let name = stream.pix_fmt.as_str();
    let (full, layout) = match name.strip_prefix("yuvj") {
        Some(rest) => (true, rest),
        None => (false, name.strip_prefix("yuv").unwrap_or("")),
    };
    let range = declared.unwrap_or(if full { Range::Full } else { Range::Limited });
    let (chroma, depth) = match layout.split_at_checked(4) {
        Some(("420p", depth)) => (Chroma::Half, depth),
        Some(("422p", depth)) => (Chroma::HalfWidth, depth),
        Some(("444p", depth)) => (Chroma::Whole, depth),
        _ => (Chroma::None, "unknown"),
    };
    let bits = match depth {
        "" => Some(8),
        "9le" => Some(9),
        "10le" => Some(10),
        "12le" => Some(12),
        "14le" => Some(14),
        "16le" => Some(16),
        _ => None,
    };
    if let Some(bits) = bits {
        return (planar(chroma, bits), None, range);
    }
    match name {
        "gray" => (planar(Chroma::None, 8), None, declared.unwrap_or(Range::Full)),
        "gray10le" => (planar(Chroma::None, 10), None, declared.unwrap_or(Range::Full)),
        "gray12le" => (planar(Chroma::None, 12), None, declared.unwrap_or(Range::Full)),
        "gray16le" | "gray16be" => (planar(Chroma::None, 8), Some("gray"), declared.unwrap_or(Range::Full)),
        _ if ["yuv", "yuyv", "uyvy", "yvyu", "nv", "p010"].iter().any(|p| name.starts_with(p)) => {
            (planar(Chroma::Half, 8), Some(if full { "yuvj420p" } else { "yuv420p" }), range)
        }
        // RGB and palettes: our own conversion, the same as for image sequences.
        _ => (Coded::Rgb, Some("rgb24"), Range::Full),
    }
}

/// The time of every frame: from the packets where each is one frame, else from decoding all of them.
fn times(
    path: &Path,
    answer: &Answer,
    stream: &Stream,
    count_frames: bool,
) -> Result<(Vec<f64>, Vec<String>), MediaError> {
    let (numerator, denominator) = fraction(&stream.time_base).unwrap_or((1, 1));
    let mut notes = Vec::new();
    if !matches!(stream.field_order.as_str(), "" | "unknown" | "progressive") {
        notes.push("interlaced: each frame mixes two instants".to_owned());
    }
    if !count_frames && let Some(ticks) = packet_times(answer, stream) {
        return Ok((seconds(ticks, numerator, denominator), notes));
    }
    let (frames, _) = ffprobe(path, "frame=pts,best_effort_timestamp")?;
    let ticks: Option<Vec<i64>> = frames.frames.iter().map(|f| f.pts.or(f.best_effort_timestamp)).collect();
    if let Some(ticks) = ticks.filter(|ticks| ticks.is_sorted_by(|a, b| a < b)) {
        return Ok((seconds(ticks, numerator, denominator), notes));
    }
    let (rate, per) = fraction(&stream.r_frame_rate).unwrap_or((25, 1));
    notes
        .push(format!("the stream has no usable times: {:.6} fps from its header", rate as f64 / per as f64));
    Ok(((0..frames.frames.len()).map(|k| k as f64 * per as f64 / rate as f64).collect(), notes))
}

/// Times of the packets that become frames, or `None` where packets and frames may not correspond.
fn packet_times(answer: &Answer, stream: &Stream) -> Option<Vec<i64>> {
    let shown = |p: &&Packet| p.size != "0" && !p.flags.contains('D');
    let one_each = matches!(stream.field_order.as_str(), "" | "unknown" | "progressive")
        && !matches!(stream.codec_name.as_str(), "vp8" | "vp9" | "av1")
        && answer.packets.first().is_some_and(|p| p.flags.contains('K'))
        && !answer.packets.iter().any(|p| p.flags.contains('C'));
    let ticks: Option<Vec<i64>> = answer.packets.iter().filter(shown).map(|p| p.pts).collect();
    let mut sorted = ticks.filter(|_| one_each)?;
    sorted.sort_unstable();
    sorted.is_sorted_by(|a, b| a < b).then_some(sorted)
}

fn fraction(text: &str) -> Option<(u64, u64)> {
    let (numerator, denominator) = text.split_once('/')?;
    let (numerator, denominator) = (numerator.parse().ok()?, denominator.parse().ok()?);
    (numerator > 0 && denominator > 0).then_some((numerator, denominator))
}

//! The lines round the picture: title, track, time, hints, and what happened.

mod paint;
mod scale;
mod space;

use std::ops::{Range, RangeInclusive};

use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use honami_model::track::{Source, Status, TrackId};
use honami_workbench::review::Item;
use honami_workbench::versus::{Entrant, Sight};

use super::offers::offers;
use super::{fill, fitted, put, style, width};
use crate::app::action::{Action, Context, TABLE};
use crate::app::clock::rate_words;
use crate::app::correcting::{Moving, Tool, nudge_px};
use crate::app::keymap::{KeyMap, shown};
use crate::app::layout::{Lens, bar, column_of, frame_at};
use crate::app::panel::Panel;
use crate::app::recovery::Recovery;
use crate::app::skeleton::{Shaping, Skeletal};
use crate::app::sketching::Sketching;
use crate::app::state::{Job, Mode, Quiet, State};
use crate::app::tracks::TrackRow;
use crate::app::versus::{LETTERS, Sides, Versus};
use crate::term::encode::Frame;

/// Eight levels of a bar.
const BARS: [&str; 8] = ["▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"];

/// What the title says, each with how soon it is left out where there is no room, the highest first.
fn facts(state: &State, nth: usize) -> Vec<(u8, String)> {
    if let Mode::Move(moving) = &state.mode
        && let Tool::Place { to, .. } = moving.tool
    {
        return ways_of_moving(state, to);
    }
    if let Mode::Shape(_) = state.mode {
        return ways_of_shaping(state);
    }
    if let Mode::Paint(painting) = &state.mode {
        return paint::ways(state, painting);
    }
    if let Mode::Scale(scaling) = &state.mode {
        return scale::ways(state, scaling);
    }
    let counted = |n: usize, one: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") };
    let mut facts = vec![(0, counted(state.tracks.len(), "track"))];
    match &state.versus {
        Some(versus) => facts.push((1, runs_words(versus))),
        None => facts.extend(state.tracker.clone().map(|tracker| (5, tracker))),
    }
    let progress = state.review.progress();
    if progress.total() > 0 {
        facts.push((1, format!("{} to review, {} done", progress.open, progress.judged.done())));
    }
    facts.extend(state.groups.as_ref().map(|groups| (4, counted(groups.shown.len(), "group"))));
    facts.extend(scale::kept(state).map(|words| (3, words)));
    let lens = Lens::shown(state);
    facts.extend(
        (state.marks_all && nth > 1 && Skeletal::azimuth(state) == 0)
            .then(|| (3, format!("1 in {nth} marked"))),
    );
    facts.extend(turned_words(state).map(|words| (0, words)));
    facts.extend(state.read_only.is_some().then(|| (0, "read only".to_owned())));
    if state.zoom > 0 {
        let times = lens.magnification();
        let times = if times < 0.95 { format!("{times:.2}x") } else { format!("{times:.0}x") };
        facts.push((2, format!("{times}{}", if state.follow { " following" } else { "" })));
    }
    facts
}

/// Which runs are beside each other, and which of them are drawn.
fn runs_words(versus: &Versus) -> String {
    let name = |side: usize| {
        let Entrant { run, tracker, build, .. } = &versus.runs[side];
        // As much of it as tells the two apart.
        let hash = build.as_deref().and_then(|build| build.split(',').next());
        let hash = hash.map_or_else(String::new, |hash| format!(" {hash}"));
        format!("{} run {run} {tracker}{hash}", LETTERS[side])
    };
    match versus.sides {
        Sides::Both => format!("{} · {}", name(0), name(1)),
        Sides::One(side) => format!("only {}", name(side)),
    }
}

/// Where a sample is put, and by what it is moved from there.
fn ways_of_moving(state: &State, [x, y]: [f32; 2]) -> Vec<(u8, String)> {
    let hints = state.keys.hints(Context::Move);
    let keys = |word: &str| {
        let (keys, _) = hints.iter().find(|(_, other)| *other == word)?;
        Some(format!("{keys} {}", scaled(word, Context::Move, state.zoom)))
    };
    let digits = if state.zoom > 0 { 2 } else { 1 };
    let mut ways = vec![(0, format!("{x:.digits$}, {y:.digits$}"))];
    ways.extend(keys("1 px").map(|keys| (1, format!("{keys} a step"))));
    ways.extend(keys(".25").map(|keys| (4, keys)));
    ways.extend(state.mouse.then(|| (2, "click places".to_owned())));
    let closer = state.keys.keys_of(Context::Move, Action::ZoomIn);
    ways.extend(closer.map(|key| (3, format!("{key} closer"))));
    ways
}

/// From where a skeleton is seen that is gone round.
fn turned_words(state: &State) -> Option<String> {
    Some(Skeletal::azimuth(state))
        .filter(|azimuth| *azimuth != 0)
        .map(|azimuth| format!("seen from {azimuth}°"))
}

/// By what a bone is shaped, and from where it is seen.
fn ways_of_shaping(state: &State) -> Vec<(u8, String)> {
    let hints = state.keys.hints(Context::Shape);
    let keys = |word: &str| Some(format!("{} {word}", hints.iter().find(|(_, other)| *other == word)?.0));
    let mut ways: Vec<(u8, String)> = (0..)
        .zip(["plane", "lean", "gain", "go round", ".5°", "play"])
        .filter_map(|(nth, word)| Some((nth, keys(word)?)))
        .collect();
    ways.extend(turned_words(state).map(|words| (0, words)));
    ways
}

/// The title; in the picture every `nth` track is marked.
pub(super) fn title(state: &State, area: Rect, nth: usize, frame: &mut Frame) {
    let name = fitted(&state.name, width(&state.name).min(usize::from(area.width) / 2));
    let room = usize::from(area.width).saturating_sub(width(&name) + 2);
    let mut facts = facts(state, nth);
    let line =
        |facts: &[(u8, String)]| facts.iter().map(|(_, fact)| fact.as_str()).collect::<Vec<_>>().join(" · ");
    while width(&line(&facts)) > room {
        let last = (0..facts.len()).max_by_key(|&i| facts[i].0).unwrap_or(0);
        facts.remove(last);
    }
    let left = Line::from(vec![
        Span::styled(name, style::BOLD),
        Span::raw("  "),
        Span::styled(line(&facts), style::DIM),
    ]);
    put(frame, area, 0, &left);
    // Nothing is late where nothing moves: what was is not looked at again then.
    let late = state.link.late.filter(|_| state.play.is_some());
    let link = match (late, state.link.delay_ms, state.link.rate_kbs) {
        _ if state.link.is_silent => "no answers: 64 kB/s".to_owned(),
        (Some([ms, n_bytes]), ..) => {
            format!("{ms} ms late, {:.1} kB", f64::from(n_bytes) / 1e3)
        }
        (None, Some(ms), Some(rate)) => format!("{ms} ms {rate} kB/s"),
        (None, Some(ms), None) => format!("{ms} ms"),
        (None, None, _) => String::new(),
    };
    put_right(frame, area, &Line::styled(link, style::DIM), left.width());
}

/// As many of the words, parted so, as fit whole.
fn whole(words: Vec<String>, part: &str, room: usize) -> String {
    let mut line = String::new();
    for word in words {
        let parted = if line.is_empty() { word } else { format!("{part}{word}") };
        if width(&line) + width(&parted) <= room {
            line.push_str(&parted);
        }
    }
    line
}

/// A line at the right end of a row, where `taken` cells at the left leave room for it.
pub(super) fn put_right(frame: &mut Frame, area: Rect, line: &Line<'_>, taken: usize) {
    let width = line.width();
    if taken + 2 + width <= usize::from(area.width) {
        frame.cells.set_line(area.right() - width as u16, area.y, line, area.width);
    }
}

pub(super) fn track(state: &State, area: Rect, frame: &mut Frame) {
    let Some(row) = state.selected_row() else {
        let line = if state.tracks.is_empty() {
            "no tracks yet: t r follows features, a adds one by hand"
        } else {
            "j selects a track"
        };
        put(frame, area, 0, &Line::styled(line, style::DIM));
        return;
    };
    let group = state.groups.as_ref().and_then(|g| g.of(row.id));
    let mut spans = vec![
        Span::styled("● ", style::group_text(group)),
        Span::styled(format!("track {}", row.id), style::BOLD),
    ];
    let most = usize::from(area.width) / 3;
    spans.extend(row.name.iter().map(|name| Span::raw(format!("  {}", fitted(name, width(name).min(most))))));
    let left = Line::from(spans);
    let room = usize::from(area.width).saturating_sub(left.width() + 2);
    let right = match &state.mode {
        Mode::Move(moving) if moving.model().is_some() => offers(moving, room),
        _ => Line::styled(whole(words(state, row), " · ", room), style::DIM),
    };
    let free = usize::from(area.width).saturating_sub(left.width() + right.width() + 5);
    put(frame, area, 0, &left);
    put_right(frame, area, &right, left.width());
    if free >= 8 {
        let bars = sparkline(state, row.id, free.min(40));
        frame.cells.set_string(area.x + left.width() as u16 + 2, area.y, bars, style::DIM);
    }
}

/// What is known of the sample here; and of the track's doubtful segment, where it has one, instead of its numbers.
fn words(state: &State, row: &TrackRow) -> Vec<String> {
    let sample = row.span.get(state.frame);
    let mut words = vec![match sample {
        None => "not here".to_owned(),
        Some(sample) if sample.source == Source::Key => "key-frame".to_owned(),
        Some(sample) if sample.source == Source::Interpolated && sample.status.is_seen() => {
            "interpolated".to_owned()
        }
        Some(sample) => match sample.status {
            Status::Lost => "lost",
            Status::Tracked | Status::Newborn => sample.source.word(),
            Status::Occluded => "occluded",
            Status::Outside => "outside",
            Status::Rejected => "rejected",
        }
        .to_owned(),
    }];
    words.extend(state.versus.as_deref().and_then(|versus| sight_words(versus, row.id, state.frame)));
    match state.doubt() {
        Some(item) => {
            // Its numbers are of that frame, not of this one: the first of them is not shown without it.
            let at = if item.worst == state.frame {
                "worst here".into()
            } else {
                format!("worst at {}", item.worst)
            };
            let reasons: Vec<String> = item.reasons.codes().map(|code| measured(code, item)).collect();
            words.push(format!("{at}: {}", reasons.join(", ")));
        }
        None => {
            let quality = sample.map(|sample| sample.quality).unwrap_or_default();
            words.extend(quality.fb_px.map(fb_words));
            words.extend(quality.ncc.map(ncc_words));
        }
    }
    words.extend(space::words(state, row));
    words
}

/// What two runs say of a track in a frame.
fn sight_words(versus: &Versus, track: TrackId, frame: u32) -> Option<String> {
    let paired = versus.compared.as_ref()?.track(track);
    Some(match paired.and_then(|paired| paired.sight(frame)) {
        None => "not in A and B".to_owned(),
        Some(Sight::Both(px)) => format!("A–B {px:.2} px"),
        Some(Sight::Alone(side)) => format!("only {} sees it", LETTERS[side]),
        Some(Sight::Neither) => "neither sees it".to_owned(),
    })
}

fn fb_words(fb_px: f32) -> String {
    format!("FB {fb_px:.*} px", if fb_px < 0.1 { 3 } else { 2 })
}

fn ncc_words(ncc: f32) -> String {
    format!("NCC {ncc:.2}").replace("0.", ".")
}

/// A reason with what was measured of it.
fn measured(code: &str, item: &Item) -> String {
    let parts = &item.parts;
    let words = match code {
        "FB" => parts.fb_px.map(|px| format!("FB {px:.1} px")),
        "NCC" => parts.likeness().map(ncc_words),
        "NBR" => parts.nbr_px.map(|px| format!("NBR {px:.0} px")),
        "DIS" => item.disagreement(),
        "GRP" => parts.group_px.map(|px| format!("GRP {px:.0} px")),
        _ => None,
    };
    words.unwrap_or_else(|| code.to_owned())
}

/// Largest suspicion over the clip, so many cells wide; blank where the track is not.
pub(super) fn sparkline(state: &State, track: TrackId, width: usize) -> String {
    let n = state.clip.n_frames() as usize;
    let Some(standing) = state.review.track(track) else { return " ".repeat(width) };
    (0..width)
        .map(|i| {
            let frames = i * n / width..((i + 1) * n / width).max(i * n / width + 1);
            let suspicions = frames.filter_map(|f| standing.at(u32::try_from(f).ok()?));
            suspicions.reduce(f32::max).map_or(" ", |p| BARS[((p * 8.0) as usize).min(7)])
        })
        .collect()
}

pub(super) fn time(state: &State, area: Rect, frame: &mut Frame) {
    let n = state.clip.n_frames();
    let bar = bar(area, n);
    if bar.width < 4 || area.height == 0 {
        return;
    }
    frame.cells.set_string(area.x, area.y, "0", style::DIM);
    frame.cells.set_string(bar.right(), area.y, state.last_frame().to_string(), style::DIM);
    let row = state.selected_row();
    let outliers = state.groups.as_ref().map_or(&[][..], |g| &g.outlier_frames);
    let affected = match &state.mode {
        Mode::Move(moving) => moving.affected(),
        Mode::Sketch(sketching) => sketching.correction().map(|ghost| ghost.affected.clone()),
        _ => None,
    };
    let range = state.range.map(|range| range.frames(state.frame));
    let looped = state.play.and_then(|play| play.loop_frames(n));
    for x in bar.left()..bar.right() {
        let frames = frame_at(bar, n, x)..=frame_at(bar, n, x + 1).max(frame_at(bar, n, x) + 1) - 1;
        let lost = row.is_some_and(|row| {
            frames
                .clone()
                .any(|f| row.span.get(f).is_some_and(|s| matches!(s.status, Status::Lost | Status::Rejected)))
        });
        let is_looped =
            looped.as_ref().is_some_and(|l| l.contains(frames.start()) || frames.contains(l.start()));
        let next = outliers.partition_point(|f| f < frames.start());
        let outlier = outliers.get(next).is_some_and(|f| f <= frames.end());
        let (glyph, style) = match () {
            () if affected.as_ref().is_some_and(|a| overlap(a, &frames)) => ("━", style::ACCENT),
            () if range.as_ref().is_some_and(|r| overlap(r, &frames)) => ("▄", style::ACCENT),
            () if is_looped => (if lost { "░" } else { "═" }, style::ACCENT),
            () if lost => ("░", style::ERROR),
            () if *frames.start() >= state.n_ready.max(1) => ("·", style::DIM),
            () if outlier => ("╌", style::DIM),
            () if row.is_some_and(|row| !row.span.frames().contains(frames.start())) => ("┄", style::DIM),
            () => ("─", style::DIM),
        };
        frame.cells.set_string(x, area.y, glyph, style);
    }
    for key in row.iter().flat_map(|row| &row.keys) {
        frame.cells.set_string(column_of(bar, n, *key), area.y, "◆", style::KEY);
    }
    let on_key = row.is_some_and(|row| row.keys.binary_search(&state.frame).is_ok());
    let now = if on_key { "◆" } else { "┃" };
    frame.cells.set_string(column_of(bar, n, state.frame), area.y, now, style::ACCENT.patch(style::BOLD));
}

/// Whether some frame is in both.
fn overlap(range: &Range<u32>, frames: &RangeInclusive<u32>) -> bool {
    range.start <= *frames.end() && *frames.start() < range.end
}

pub(super) fn hints(state: &State, area: Rect, frame: &mut Frame) {
    let mut left = match &state.mode {
        Mode::Prompt(typed) => format!("go to frame {typed}▏"),
        Mode::Name(typed) => format!("name {typed}▏"),
        Mode::GroupName(typed) => format!("name of the group {typed}▏"),
        Mode::Label(typed) => format!("letters of a track {typed}▏"),
        Mode::Move(moving) => moving_words(moving, state.frame),
        Mode::Sketch(sketching) => sketching_words(sketching, state.frame),
        Mode::Paint(painting) => paint::words(painting),
        Mode::Scale(scaling) => scale::words(scaling),
        _ => {
            let t_s = state.clip.times.get(state.frame).unwrap_or_default();
            let mut words = format!("{}/{}  {t_s:.2} s", state.frame, state.last_frame());
            words.extend(state.range.map(|range| format!("  {}", range.words(state.frame))));
            words.extend(Some(state.picked.len()).filter(|n| *n > 0).map(|n| format!("  {n} picked")));
            words
        }
    };
    left.push_str(&play_words(state));
    if let Mode::History { at, .. } = state.mode
        && let Some((entry, _)) = state.history.row(at)
    {
        left = format!("edit {}  {}  {}", entry.id, entry.author, entry.time);
    }
    if let Mode::Dial(_) = state.mode {
        let dial = state.motion.dial_words();
        left.push_str(&format!("  showing {}", dial.as_deref().unwrap_or("all directions")));
    }
    match state.mode {
        Mode::Place([x, y]) => left.push_str(&format!("  new feature at {x:.1}, {y:.1}")),
        Mode::Root([x, y]) => left.push_str(&format!("  root at {x:.1}, {y:.1}")),
        Mode::Shape(ref shaping) => left = shaping_words(shaping),
        _ => {}
    }
    if state.count.is_some() || !state.pending.is_empty() {
        let count = state.count.map_or_else(String::new, |n| n.to_string());
        left.push_str(&format!("  {}{}", count, shown(&state.pending)));
    }
    let left = Line::raw(narrowed(left, state.mode.context(), area.width));
    put(frame, area, 0, &left);
    let room = usize::from(area.width).saturating_sub(left.width() + 2);
    put_right(frame, area, &hint_line(state, room), left.width());
}

/// As many of its parts as have room, where something is open beside the hint that keeps it; of what is being typed
/// its end.
fn narrowed(left: String, context: Context, columns: u16) -> String {
    let kept = if context == Context::Paint {
        "  ⏎ find, keep  ? help"
    } else if context == Context::Scale {
        "  ⏎ keep  ? help"
    } else if matches!(context, Context::Place | Context::Move | Context::Slide | Context::Shape) {
        "  ⏎ keep"
    } else {
        ""
    };
    let room = usize::from(columns).saturating_sub(width(kept));
    if width(&left) <= room {
        return left;
    }
    if context.is_text() {
        let ends = left.char_indices().map(|(at, _)| &left[at..]);
        let end = ends.skip(1).find(|end| width(end) < room).unwrap_or_default();
        return format!("…{end}");
    }
    whole(left.split("  ").map(str::to_owned).collect(), "  ", room)
}

/// How the clip plays, and what it loses: `  ▶ ½x  loop ±8  12 of 25 pictures/s`.
fn play_words(state: &State) -> String {
    let Some(play) = state.play else { return String::new() };
    let mut words = vec![if play.rate < 0.0 { "  ◀" } else { "  ▶" }.to_owned()];
    let rate = rate_words((play.rate.abs() * 100.0).round() as u32);
    words.extend(Some(rate).filter(|rate| !rate.is_empty()).map(|rate| format!(" {rate}")));
    words.extend(play.around.map(|around| format!("  loop ±{around}")));
    words.extend(state.dropped.map(|[shown, due]| format!("  {shown} of {due} pictures/s")));
    words.concat()
}

/// Which bone is shaped, and how it is to be: `group 3 bud  plane 30°, gain 1.5`.
fn shaping_words(shaping: &Shaping) -> String {
    let shape = if shaping.shape.is_grown() { "as it grows".to_owned() } else { shaping.shape.to_string() };
    format!("{}  {shape}", shaping.bone.name)
}

/// What is moved, how far, by which model, and which frames that affects.
fn moving_words(moving: &Moving, frame: u32) -> String {
    let (from, to) = (moving.from, moving.to());
    let moved = (to[0] - from[0]).hypot(to[1] - from[1]);
    let mut words = match moving.tool {
        Tool::Place { model, .. } => {
            let pending = if moving.is_pending() { " …" } else { "" };
            format!("{}  {moved:.2} px {}{pending}", moving.frame, model.word())
        }
        Tool::Slide(frames) => format!("{}  {frames:+.2} frames, {moved:.2} px", moving.frame),
    };
    if let Some(affected) = moving.affected() {
        words.push_str(&format!("  affects {}-{}", affected.start, affected.end - 1));
    }
    if let Some(walked) = moving.walked {
        words.push_str(&format!("  at {walked}"));
    } else if frame != moving.frame {
        words.push_str(&format!("  seeing {frame}"));
    }
    words
}

/// What was drawn so far, how late it was taken to be, and the step of the keys.
fn sketching_words(sketching: &Sketching, frame: u32) -> String {
    let mut words = format!("{frame}  sketch");
    match &sketching.ghost {
        Some(Ok(ghost)) if !ghost.affected.is_empty() => {
            words.push_str(&format!("  {}-{}", ghost.affected.start, ghost.affected.end - 1));
        }
        Some(Err(_)) => words.push_str("  too short"),
        _ => {}
    }
    if let Some([hand, link]) = sketching.late_ms() {
        words.push_str(&format!("  hand {hand} + link {link} ms"));
    }
    if (sketching.step - 1.0).abs() > 0.0 {
        words.push_str(&format!("  step {}", sketching.step));
    }
    words
}

/// A word of a hint, nudges in the image pixels that they are at this magnification.
fn scaled(word: &str, context: Context, zoom: u8) -> String {
    let unit = match word {
        _ if !matches!(context, Context::Place | Context::Move | Context::Scale) => None,
        "1 px" => Some((1.0, " px")),
        ".25" => Some((0.25, "")),
        ".1" => Some((0.1, "")),
        _ => None,
    };
    let Some((by, unit)) = unit.filter(|_| zoom > 0) else { return word.to_owned() };
    let digits = format!("{:.4}", by * nudge_px(zoom));
    format!("{}{unit}", digits.trim_end_matches('0').trim_start_matches('0'))
}

/// As many hints as there is room for; the help is always one of them.
fn hint_line(state: &State, room: usize) -> Line<'static> {
    let context = state.mode.context();
    let useful: Vec<&str> = TABLE
        .iter()
        .filter(|info| is_useful(state, info.action))
        .filter_map(|info| info.action.word_in(context))
        .collect();
    let mut hints: Vec<(String, String)> = state
        .keys
        .hints(context)
        .into_iter()
        .filter(|(_, word)| useful.contains(word))
        .map(|(keys, word)| match accept_word(state).filter(|_| word == "accept") {
            Some(word) => (keys, word.to_owned()),
            None => (keys, scaled(word, context, state.zoom)),
        })
        .collect();
    // What is open can be kept, and what is marked worked on: that must be seen on the narrowest screen.
    hints.sort_by_key(|(_, word)| match word.as_str() {
        "set" | "keep" | "find, keep" | "go on" => 0,
        "pen" | "brush" => 1,
        "back" if matches!(context, Context::Paint | Context::Scale) => 2,
        "model" if context == Context::Move => 1,
        "back" if matches!(context, Context::Move | Context::Shape) => 2,
        "shape" | "end" | "lost" | "occluded" | "take away" | "average" => 1,
        "flick" | "take A" | "take B" => 2,
        "skeleton" | "bones" | "go round" if context == Context::Review => 2,
        "key-frame" => 4,
        _ => 3,
    });
    fitting(hints, &["help"], room)
}

/// What keys do on a screen of its own, as far as there is room: what `later` names last, help and the way out always.
pub(super) fn own_hints(keys: &KeyMap, context: Context, later: &[&str], room: usize) -> Line<'static> {
    let mut hints = keys.hints(context);
    hints.sort_by_key(|(_, word)| later.contains(word));
    let hints = hints.into_iter().map(|(keys, word)| (keys, word.to_owned()));
    fitting(hints.collect(), &["help", "leave"], room)
}

/// As many hints as there is room for, the first first; those to be kept stand at the end.
fn fitting(hints: Vec<(String, String)>, kept: &[&str], room: usize) -> Line<'static> {
    let cells = |(keys, word): &(String, String)| width(keys) + 1 + width(word) + 2;
    let (mut kept, hints): (Vec<_>, Vec<_>) =
        hints.into_iter().partition(|(_, word)| kept.contains(&word.as_str()));
    while kept.iter().map(cells).sum::<usize>() > room + 2 {
        kept.pop();
    }
    let mut used: usize = kept.iter().map(cells).sum();
    let mut shown: Vec<(String, String)> = Vec::new();
    for hint in hints {
        used += cells(&hint);
        if used > room + 2 {
            break;
        }
        shown.push(hint);
    }
    shown.extend(kept);
    let mut spans = Vec::new();
    for (i, (keys, word)) in shown.into_iter().enumerate() {
        spans.push(Span::raw(if i > 0 { "  " } else { "" }));
        spans.push(Span::styled(keys, style::ACCENT));
        spans.push(Span::styled(format!(" {word}"), style::DIM));
    }
    Line::from(spans)
}

/// What Enter does while reviewing, and to a scale bar; `None` where it does nothing that has room to be said.
fn accept_word(state: &State) -> Option<&'static str> {
    if let Mode::Scale(scaling) = &state.mode {
        return Some(if scaling.bar.is_some() { "keep" } else { "set" });
    }
    if !matches!(state.mode, Mode::Review) || state.read_only.is_some() {
        return None;
    }
    let is_confirmed = || {
        let row = state.selected_row()?;
        let sample = row.span.get(state.frame)?;
        Some(sample.source != Source::Key && sample.status.is_seen())
    };
    match state.panel {
        // Frames of lines are seen beside them.
        Some(Panel::Prints) => None,
        _ if state.opened().is_some() => Some("accept"),
        Some(Panel::Skeleton) if state.skeleton.pose.is_some() => Some("shape"),
        Some(Panel::Queue) if state.versus.is_none() && !state.review.queue.is_empty() => Some("open"),
        _ if state.current_item().is_some() => Some("open"),
        _ => is_confirmed()?.then_some("key-frame"),
    }
}

/// Whether a hint makes sense now.
fn is_useful(state: &State, action: Action) -> bool {
    if let Mode::Scale(scaling) = &state.mode {
        // Nothing moves ends that are set.
        return scaling.is_placing()
            || matches!(action, Action::Accept | Action::Back | Action::Erase | Action::Help);
    }
    if !matches!(state.mode, Mode::Review) {
        return true;
    }
    match action {
        Action::Accept => accept_word(state).is_some(),
        Action::NextItem => state.versus.is_some() || !state.review.queue.is_empty(),
        Action::VersusFlick => state.versus.is_some(),
        Action::TakeA | Action::TakeB => {
            let side = usize::from(action == Action::TakeB);
            let shows = state.versus.as_deref().is_some_and(|versus| versus.sides.shows(side));
            shows && state.read_only.is_none()
        }
        // Beside two runs there is no room for what has nothing to do with them.
        Action::AddFeature | Action::RunClusterer if state.versus.is_some() => false,
        Action::Skeleton => {
            let is_near = matches!(state.panel, Some(Panel::Groups | Panel::Skeleton));
            is_near && state.groups.is_some() && !state.skeleton.is_on
        }
        Action::PanelSkeleton => state.skeleton.is_on && state.panel != Some(Panel::Skeleton),
        Action::OrbitLeft | Action::OrbitRight => {
            state.skeleton.pose.is_some() && state.panel == Some(Panel::Skeleton)
        }
        Action::MoveSample => !state.tracks.is_empty() && state.read_only.is_none(),
        Action::RunTracker => state.tracks.is_empty() && state.job.is_none() && state.read_only.is_none(),
        Action::RetrackBoth => state.selected.is_some() && state.job.is_none() && state.read_only.is_none(),
        Action::RunClusterer => state.tracks.len() > 1 && state.job.is_none() && state.read_only.is_none(),
        Action::GoOn => state.recovery.is_some() && state.job.is_none() && state.read_only.is_none(),
        Action::Range => state.range.is_some_and(|range| range.to.is_none()),
        Action::MarkLost | Action::MarkOccluded | Action::DeleteRange => state.range.is_some(),
        Action::Average => state.picked.len() > 1,
        Action::AddFeature => state.read_only.is_none(),
        _ => true,
    }
}

/// Over the lowest rows of the picture: the job that runs, and what happened last.
pub(super) fn notices(state: &State, area: Rect, frame: &mut Frame) {
    let mut lines = Vec::new();
    if let Some(notice) = &state.notice {
        let style = if notice.is_error { style::ERROR } else { style::ACCENT };
        let rows = wrapped(&notice.text, usize::from(area.width.saturating_sub(2)));
        lines.extend(rows.into_iter().map(|row| Line::styled(row, style)));
    }
    lines.extend(
        state
            .recovery
            .as_ref()
            .filter(|_| state.notice.is_some())
            .map(|recovery| recovery_line(recovery, state)),
    );
    if let Some(job) = &state.job {
        match job.quiet.as_ref().filter(|_| !job.is_stopping) {
            Some(quiet) => {
                let rows =
                    wrapped(&quiet_words(job, quiet, state), usize::from(area.width.saturating_sub(2)));
                lines.extend(rows.into_iter().map(|row| Line::styled(row, style::ERROR)));
            }
            None => lines.push(job_line(job, state, area.width)),
        }
    }
    let n = (lines.len() as u16).min(area.height);
    let rows = Rect { y: area.bottom() - n, height: n, ..area };
    fill(frame, rows, style::PANEL);
    let inside = Rect { x: rows.x + 1, width: rows.width.saturating_sub(2), ..rows };
    for (row, line) in (0..).zip(lines) {
        put(frame, inside, row, &line);
    }
}

/// A text in rows, broken between words; within one that is longer than a row.
pub(super) fn wrapped(text: &str, room: usize) -> Vec<String> {
    let mut rows = vec![String::new()];
    let mut add = |part: &str, gap: &str| {
        let used = rows.last().map_or(0, |row| width(row));
        if used > 0 && used + width(gap) + width(part) > room {
            rows.push(String::new());
        }
        if let Some(row) = rows.last_mut() {
            row.push_str(if row.is_empty() { "" } else { gap });
            row.push_str(part);
        }
    };
    for word in text.split_whitespace() {
        if width(word) <= room {
            add(word, " ");
            continue;
        }
        for (i, letter) in Span::raw(word).styled_graphemes(Style::new()).enumerate() {
            add(letter.symbol, if i == 0 { " " } else { "" });
        }
    }
    rows
}

/// `! goes on from frame 212   P o what it printed`.
fn recovery_line(recovery: &Recovery, state: &State) -> Line<'static> {
    let key = |action, words: &str| {
        let key = state.keys.keys_of(Context::Review, action).unwrap_or_default();
        [Span::styled(key, style::ACCENT), Span::raw(format!(" {words}   "))]
    };
    let prints =
        if state.prints.n() > 0 { key(Action::PanelPrints, "what it printed").to_vec() } else { Vec::new() };
    Line::from([key(Action::GoOn, &recovery.words).to_vec(), prints].concat())
}

/// `my-flow, frame 212: no sign of life for 12 s   W waits   I ends it   Esc stops`.
fn quiet_words(job: &Job, quiet: &Quiet, state: &State) -> String {
    let Quiet { plugin, frame, seconds, at, is_asked, .. } = quiet;
    let place = frame.map_or_else(|| job.what.clone(), |frame| format!("frame {frame}"));
    let mut words = format!("{plugin}, {place}: no sign of life for {seconds} s");
    if !at.is_empty() && !is_asked {
        words.push_str(&format!(" (at: {at})"));
    }
    let answers = [(Action::WaitOn, "waits"), (Action::EndPlugin, "ends it")];
    for (action, word) in answers.into_iter().filter(|_| *is_asked) {
        let key = state.keys.keys_of(Context::Review, action).unwrap_or_default();
        words.push_str(&format!(", {key} {word}"));
    }
    words + ", Esc stops"
}

fn job_line(job: &Job, state: &State, width: u16) -> Line<'static> {
    let (done, total) = job.done;
    let part = if total > 0 { (done as f64 / total as f64).min(1.0) } else { 0.0 };
    let left = state.now.saturating_sub(job.since).as_secs_f64() * (1.0 / part.max(1e-6) - 1.0);
    let bar_width = usize::from(width / 5).clamp(6, 30);
    let eighths = (part * bar_width as f64 * 8.0) as usize;
    let mut bar = "█".repeat(eighths / 8);
    bar.push_str(["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"][eighths % 8]);
    let blank = bar_width.saturating_sub(bar.chars().count());
    let rest = match job {
        _ if job.is_stopping => "stopping …".to_owned(),
        _ if total == 0 => "Esc stops".to_owned(),
        _ if job.keeps_frames && done > 0 => {
            let (first, last) = (job.first, job.first + done - 1);
            format!("{left:.0} s left   Esc stops, keeps {first}-{last}")
        }
        _ => format!("{left:.0} s left   Esc stops"),
    };
    let count = if total > 0 { format!(" {done}/{total}") } else { String::new() };
    Line::from(vec![
        Span::styled(format!("{}  ", job.plugin), style::BOLD),
        Span::raw(format!("{}{count}  ▕", job.what)),
        Span::styled(bar, style::ACCENT),
        Span::raw(format!("{}▏ {rest}", " ".repeat(blank))),
    ])
}

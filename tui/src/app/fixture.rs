//! A small project for tests: 100 frames at 25 per second, tracks 1, 2 and 7, three leaves of a hierarchy.

pub(super) mod skeleton;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use honami_model::clip::{Clip, FrameTimes};
use honami_model::correct::{Correction, Layers};
use honami_model::document::{ClusteringId, Key, Origin, RunId, Track};
use honami_model::edit::Edit;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::history::{Entry, EntryId};
use honami_model::over::{Laid, Over};
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_workbench::matting::{Part, Parts};
use honami_workbench::offer::{Errors, Wish};
use honami_workbench::plugins::{Hosting, Level, Param, Prospect};
use honami_workbench::review::{Evidence, Kind, Review, Subject};
use honami_workbench::versus::{Compared, Entrant, Paired, disagreement};
use ratatui::layout::Rect;

use super::correcting::{Answer, Ask};
use super::form::{Plugin, Task};
use super::groups::Groups;
use super::layout::Lens;
use super::prints::Print;
use super::state::State;
use super::tracks::TrackRow;
use super::update::{Effect, Fact, Msg, update};
use super::view::Shot;
use crate::term::input::{Mouse, MouseKind};

/// The clustering that is shown.
pub(super) const CLUSTERING: ClusteringId = ClusteringId(1);

/// The state that tests begin with.
pub(super) fn state() -> State {
    let times = FrameTimes::constant(100, 25.0).expect("a rate");
    let mut state = State::new("malva".to_owned(), Clip { width: 320, height: 240, times }, (80, 24));
    state.tracks = vec![row(1, 0..100, &[10, 50]), row(2, 0..60, &[]), row(7, 20..100, &[30])];
    state.tracks[0].name = Some("bud-left".to_owned());
    state.selected = Some(TrackId(1));
    state.groups = Some(groups(2));
    state.tracker = Some("klt 0.1.0".to_owned());
    state.plugins = plugins();
    state.n_ready = 100;
    state.history.grow(edits(), EntryId(3));
    review(&mut state);
    state
}

/// What plugins print and log: of every level, from here and from elsewhere, long and short.
pub(super) fn prints(state: &mut State) {
    let print = |(frame, plugin, level, text): (Option<u32>, &str, Level, &str)| Print {
        frame,
        plugin: plugin.to_owned(),
        level,
        text: text.to_owned(),
    };
    let lines = [
        (None, "my-flow", Level::Debug, "window 21, levels 3"),
        (None, "my-flow", Level::Info, "weights read from flow.onnx"),
        (Some(0), "", Level::Info, "[libgomp] cannot set affinity"),
        (Some(40), "my-very-long-flow", Level::Warning, "12 of 135 points have no texture around them"),
        (Some(41), "my-flow", Level::Error, "died of SIGSEGV; it last printed: no memory for level 2"),
        (Some(41), "my-flow", Level::Warning, "started again at frame 41"),
    ];
    state.prints.add(lines.map(print));
}

/// The undo tree: after three edits one was taken back, and two others were made.
fn edits() -> Vec<Entry> {
    let labels = ["project made", "klt: 3 tracks", "track 1: key-frame at 10", "track 2 deleted", "7 groups"];
    let parents = [None, Some(0), Some(1), Some(2), Some(1)];
    let entry = |(id, (label, parent)): (u32, (&str, Option<u32>))| Entry {
        id: EntryId(id),
        parent: parent.map(EntryId),
        next: None,
        label: label.to_owned(),
        author: "ana".to_owned(),
        time: "2026-11-21T14:03:00Z".to_owned(),
    };
    (0..).zip(labels.into_iter().zip(parents)).map(entry).collect()
}

/// What there is to review, without pictures: forward-backward errors, losses and jumps.
pub(super) fn review(state: &mut State) {
    let subject = |row: &TrackRow| Subject {
        track: row.id,
        kind: Kind::Stepwise,
        span: Arc::clone(&row.span),
        rivals: Vec::new(),
        unseen: Vec::new(),
    };
    let evidence = Evidence::new(state.tracks.iter().map(subject).collect(), 1);
    state.review = Review::default();
    for row in &state.tracks {
        state.review.set(row.id, evidence.segments(row.id, &Default::default()));
    }
}

/// A track on a sway, with key-frames; frames 70 to 79 of it are lost, 40 is doubtful.
fn row(id: u32, frames: std::ops::Range<u32>, keys: &[u32]) -> TrackRow {
    let sample = |frame: u32| {
        let sway = 20.0 * (f64::from(frame) * 0.2).sin() as f32;
        let (status, source) = match frame {
            f if keys.contains(&f) => (Status::Tracked, Source::Key),
            70..80 => (Status::Lost, Source::Tracked),
            _ => (Status::Tracked, Source::Tracked),
        };
        let fb_px = if frame == 40 { 1.8 } else { 0.02 };
        let quality = match source {
            Source::Key => Quality::default(),
            _ => Quality { fb_px: Some(fb_px), ncc: Some(0.97) },
        };
        Sample { x: 40.0 * id as f32 + sway, y: 120.0, status, source, quality }
    };
    let span = Span { first_frame: frames.start, samples: frames.map(sample).collect() };
    TrackRow::new(TrackId(id), None, Arc::new(span))
}

/// What the world tells of a track when it is asked: its key-frames, over one run with all its samples.
pub(super) fn layers(state: &State, track: TrackId) -> Option<Layers> {
    let row = state.row(track)?;
    let key = |frame: &u32| Some((*frame, row.at(*frame).map(|[x, y]| Key::set(x, y))?));
    let track = Track {
        origin: Origin::Run(RunId(1)),
        name: row.name.clone(),
        keys: row.keys.iter().filter_map(key).collect(),
        over: BTreeMap::new(),
        judgements: BTreeMap::new(),
        deleted: false,
    };
    Some(Layers { id: row.id, track, runs: vec![(RunId(1), Span::clone(&row.span))] })
}

/// Presses keys, as the program does: what it asks the project is answered. Returns what else is to be done.
pub(super) fn press(state: &mut State, keys: &str) -> Vec<Effect> {
    let mut effects = Vec::new();
    for key in keys.split_whitespace() {
        effects.extend(send(state, Msg::Key(key.parse().expect("a key"))));
    }
    effects
}

/// What a word stands for: a key, `at:SECONDS` of the clock, `late:MS` for how late a picture was on screen, and
/// `press:COLUMN,ROW`, `drag:COLUMN,ROW`, `release:COLUMN,ROW` of the mouse's first button.
pub(super) fn msg(word: &str) -> Msg {
    let (name, value) = word.split_once(':').filter(|(_, value)| !value.is_empty()).unwrap_or((word, "0"));
    let n: f64 = value.split(',').next().and_then(|n| n.parse().ok()).expect("a number");
    let mouse = |kind| {
        let row = value.split(',').nth(1).and_then(|n| n.parse().ok()).expect("a row");
        Msg::Mouse(Mouse { kind, column: n as u16, row })
    };
    match name {
        "at" => Msg::Clock(Duration::from_secs_f64(n)),
        "late" => Msg::Fact(Fact::Late(Duration::from_secs_f64(n / 1e3))),
        "press" => mouse(MouseKind::Press(0)),
        "drag" => mouse(MouseKind::Drag(0)),
        "release" => mouse(MouseKind::Release(0)),
        key => Msg::Key(key.parse().expect("a key")),
    }
}

/// Sends one message, as the program does.
pub(super) fn send(state: &mut State, msg: Msg) -> Vec<Effect> {
    let mut left = Vec::new();
    for effect in update(state, msg) {
        match effect {
            Effect::Study(track) => {
                let layers = layers(state, track).map(Arc::new);
                let asked = update(state, Msg::Fact(Fact::Layers(layers)));
                asked.into_iter().for_each(|effect| answer(state, effect));
            }
            offer @ Effect::Offer(_) => answer(state, offer),
            other => left.push(other),
        }
    }
    left
}

/// Works out what is asked for: of errors nothing is known, and a tracker finds the feature half a pixel lower, up to
/// the neighbouring key-frames.
pub(super) fn answer(state: &mut State, effect: Effect) {
    let answer = match effect {
        Effect::Offer(Ask::Errors(track, _)) => Answer::Errors(track, Ok(Errors::default())),
        Effect::Offer(Ask::Ghost(Some(wish))) => {
            let ghost = ghost(state, &wish).map(Arc::new).ok_or_else(|| "nothing was found".to_owned());
            Answer::Ghost(wish, ghost)
        }
        _ => return,
    };
    update(state, Msg::Fact(Fact::Offered(answer)));
}

fn ghost(state: &State, wish: &Wish) -> Option<Correction> {
    let layers = layers(state, wish.track)?;
    let shown = layers.shown(&state.clip.times);
    let track = wish.track;
    let keys = wish.keys.iter().map(|&(frame, key)| Edit::SetKey { track, frame, key });
    let (before, after) = shown.keys_around(wish.frame);
    let frames = before.map_or(0, |key| key + 1)..after.unwrap_or(state.clip.n_frames());
    let lower =
        |sample: &Sample| Over::Sample(Laid { sample: Sample { y: sample.y + 0.5, ..*sample }, run: None });
    let over = frames.clone().map(|frame| shown.span().get(frame).map(lower)).collect();
    let lay = Edit::Lay { track, first_frame: frames.start, over };
    shown.correct(keys.chain([lay]).collect(), wish.model.word()).ok()
}

/// Two runs that can be beside each other, of the fixture's tracks.
pub(super) fn entrants() -> Vec<Entrant> {
    let entrant = |(run, radius, is_shown)| Entrant {
        run: RunId(run),
        plugin_id: "org.honami.klt".to_owned(),
        tracker: "klt".to_owned(),
        sha256: "3f2a".to_owned(),
        is_beside: false,
        build: None,
        params: format!("radius={radius}"),
        tracks: [1, 2, 7].map(TrackId).into_iter().collect(),
        frames: 0..100,
        is_shown,
    };
    [(4, 20, false), (2, 15, true), (1, 5, true)].map(entrant).to_vec()
}

/// Puts two runs beside each other. A has found what is shown; in B track 1 is 9 px off its way round frame 40 and half
/// a pixel elsewhere, track 2 is lost from frame 30 on, and track 7 is 3 px lower.
pub(super) fn versus(state: &mut State) {
    let [_, b, a] = <[Entrant; 3]>::try_from(entrants()).expect("three");
    let runs = [a.run, b.run];
    update(state, Msg::Fact(Fact::Versus(Some(Box::new([a, b])))));
    let in_b = |row: &TrackRow| {
        let sample = |(frame, sample): (u32, &Sample)| {
            let bump = 9.0 * (-f64::from(frame.abs_diff(40)).powi(2) / 50.0).exp() as f32;
            let (off, is_lost) = match row.id.0 {
                1 => (0.5 + bump, false),
                2 => (0.0, frame >= 30),
                _ => (3.0, false),
            };
            let status = if is_lost { Status::Lost } else { sample.status };
            Sample { y: sample.y + off, status, ..*sample }
        };
        let samples = row.span.frames().zip(&row.span.samples).map(sample).collect();
        Span { first_frame: row.span.first_frame, samples }
    };
    let paired = |row: &TrackRow| Paired { track: row.id, spans: [Span::clone(&row.span), in_b(row)] };
    let tracks: Vec<Paired> = state.tracks.iter().map(paired).collect();
    let compared = Compared { found: disagreement(&tracks), tracks };
    update(state, Msg::Fact(Fact::Compared(runs, Ok(Arc::new(compared)))));
}

/// Several hundred tracks more, beside and above one another.
pub(super) fn crowd(state: &mut State) {
    let still = |id: u32| {
        let mut row = row(id, 0..100, &[]);
        let samples = row.span.samples.iter().map(|s| {
            let (x, y) = ((id * 37 % 320) as f32, (id * 23 % 240) as f32);
            Sample { x, y, ..*s }
        });
        row.span = Arc::new(Span { first_frame: 0, samples: samples.collect() });
        row
    };
    state.tracks.extend((8..480).map(still));
}

/// The crowd's tracks in groups of several sizes, `k` of which are shown: in each every track is merged higher than the
/// one before, and of the groups neighbours first.
pub(super) fn grove(state: &mut State, k: u32) {
    crowd(state);
    let tracks: Vec<TrackId> = state.tracks.iter().map(|row| row.id).collect();
    let n = tracks.len() as u32;
    let (mut merges, mut roots): (Vec<Merge>, Vec<(u32, u32)>) = (Vec::new(), Vec::new());
    let mut merge = |a: (u32, u32), b: (u32, u32), height: f64| {
        merges.push(Merge { a: a.0, b: b.0, height, size: a.1 + b.1 });
        (n + merges.len() as u32 - 1, a.1 + b.1)
    };
    let mut leaves = 0..n;
    for (nth, size) in [31, 9, 60, 24, 3, 14, 45, 1].into_iter().cycle().enumerate() {
        let Some(first) = leaves.next() else { break };
        let join = |root, (step, leaf)| {
            merge(root, (leaf, 1), 1.0 + 0.02 * f64::from(step) + 0.1 * (nth % 3) as f64)
        };
        roots.push((1_u32..).zip(leaves.by_ref().take(size - 1)).fold((first, 1), join));
    }
    let mut height = 4.0;
    while roots.len() > 1 {
        let pairs = std::mem::take(&mut roots);
        for (nth, pair) in pairs.chunks(2).enumerate() {
            let joined = |b: &(u32, u32)| merge(pair[0], *b, height * (1.0 + 0.07 * nth as f64));
            roots.push(pair.get(1).map_or(pair[0], joined));
        }
        height *= 2.2;
    }
    let dendrogram = Dendrogram::new(n, merges).expect("a tree");
    state.groups = Some(Groups::new(
        "by bod".to_owned(),
        (CLUSTERING, tracks, dendrogram),
        (k, &[]),
        vec![30, 31, 32, 77],
    ));
}

pub(super) fn groups(k: u32) -> Groups {
    let merges = vec![Merge { a: 0, b: 1, height: 1.0, size: 2 }, Merge { a: 2, b: 3, height: 2.0, size: 3 }];
    let tracks = [1, 2, 7].map(TrackId).to_vec();
    Groups::new(
        "by movement".to_owned(),
        (CLUSTERING, tracks, Dendrogram::new(3, merges).expect("a tree")),
        (k, &[]),
        vec![90, 91],
    )
}

/// Nothing that is shut in, for this reason.
fn apart(hosting: Hosting, why: &str) -> Prospect {
    Prospect { hosting, sandbox: "none", why: why.to_owned(), is_bare: false }
}

/// The first tracker works in honami itself, though it did not come with it.
pub(super) fn bare(state: &mut State) {
    state.plugins[0].apart.is_bare = true;
}

/// The first tracker works in a process of its own, shut in as far as a kernel without landlock can.
pub(super) fn shut_in(state: &mut State) {
    let why = "this kernel has no landlock, which keeps files from it";
    state.plugins[0].apart = Prospect { sandbox: "partial", ..apart(Hosting::Isolated, why) };
}

fn plugins() -> Vec<Plugin> {
    let params = |json: &str| serde_json::from_str::<Vec<Param>>(json).expect("a schema");
    let plugin = |task, name: &str, params, can_detect| Plugin {
        task,
        name: name.to_owned(),
        version: "0.1.0".to_owned(),
        params,
        can_detect,
        apart: apart(Hosting::InProcess, "it works in honami itself: whatever ends it ends both"),
    };
    let klt = r#"[
        {"id":"radius","label":"window radius","doc":"half side of the window","unit":"px","type":"int",
         "default":10,"min":2,"max":50,"soft_min":null,"soft_max":40,"step":1},
        {"id":"motion","label":"motion model","type":"enum","default":"translation",
         "entries":[{"id":"translation","label":"translation"},{"id":"affine","label":"affine"}]},
        {"id":"check","label":"check backwards","type":"bool","default":true},
        {"id":"expire","label":"expire at NCC","advanced":true,"when":{"check":true},"type":"float",
         "default":0.55,"min":0.0,"max":1.0,"soft_min":null,"soft_max":null,"step":0.05},
        {"id":"label","label":"note","type":"string","default":"none"}
    ]"#;
    vec![
        plugin(Task::Track, "klt", params(klt), true),
        plugin(Task::Track, "flow", params("[]"), false),
        plugin(Task::Cluster, "movement", params("[]"), false),
    ]
}

/// A picture of bands for a state.
pub(super) fn shot(state: &State, area: Rect) -> Shot {
    let lens = Lens::of(state, area);
    let (columns, rows) = lens.size();
    let pixels =
        (0..rows).flat_map(|y| (0..columns).map(move |x| [(x / 8 * 8) as u8, (y / 8 * 16) as u8, 40]));
    Shot { frame: state.frame, lens, pixels: pixels.collect() }
}

/// The matte of the frame is found, of so many strokes: stripes of all parts.
pub(super) fn matted(state: &mut State, n_strokes: usize) {
    let (width, height) = (state.clip.width, state.clip.height);
    let part = |pixel: u32| Part::ALL[(pixel % width * Part::ALL.len() as u32 / width) as usize];
    let parts = Parts { width, height, parts: (0..width * height).map(part).collect() };
    let line = "20.0 % of the picture is kept".to_owned();
    update(state, Msg::Fact(Fact::Matted((state.frame, n_strokes), Arc::new(parts), line)));
}

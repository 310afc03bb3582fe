//! Every format there and back, what it loses, files as other programs write them, and files of nobody.

use std::io::Cursor;

use honami_model::track::TrackId;
use proptest::prelude::*;

use super::*;
use crate::{TrackRow, TrackTable};

mod fixtures;

const SIZE: [u32; 2] = [640, 480];
const N_FRAMES: u32 = 15;

fn outgoing(tracks: &[ForeignTrack]) -> Outgoing<'_> {
    Outgoing {
        tracks,
        size: SIZE,
        n_frames: N_FRAMES,
        fps: Some(25.0),
        variable_rate: false,
        origin: None,
        every_frame: false,
        box_px: 9.0,
    }
}

fn written(format: Format, what: &Outgoing<'_>) -> Vec<u8> {
    if matches!(format, Format::Csv | Format::Parquet) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tracks");
        let mut table = TrackTable::create(&path, format).unwrap().unwrap();
        for track in what.tracks {
            for (frame, &sample) in track.samples() {
                let track = TrackId(track.number.unwrap());
                let time_s = Some(f64::from(frame) / 25.0);
                table.write(&TrackRow { track, frame, time_s, sample, run: Some(3) }).unwrap();
            }
        }
        table.finish().unwrap();
        return std::fs::read(path).unwrap();
    }
    let mut file = Cursor::new(Vec::new());
    write(&mut file, format, what).unwrap();
    file.into_inner()
}

fn read_back(format: Format, bytes: &[u8]) -> ForeignTracks {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tracks");
    std::fs::write(&path, bytes).unwrap();
    // A table of MOT has no header line: without rows it is any empty file.
    if !bytes.is_empty() {
        assert_eq!(recognise(&path).unwrap(), format, "{}", String::from_utf8_lossy(bytes));
    }
    read(&path, format, &ReadOptions::of(SIZE), &Watch::default()).unwrap()
}

fn sample() -> impl Strategy<Value = Sample> {
    let source = prop_oneof![
        Just(Source::Key),
        Just(Source::Sketch),
        Just(Source::Tracked),
        Just(Source::Interpolated),
        Just(Source::Imported),
    ];
    let quality = (proptest::option::of(0.0_f32..9.0), proptest::option::of(-1.0_f32..=1.0));
    (0.0_f32..640.0, 0.0_f32..480.0, 0_u8..6, source, quality).prop_map(
        |(x, y, status, source, (fb_px, ncc))| Sample {
            x,
            y,
            status: Status::from_u8(status).unwrap(),
            source,
            quality: Quality { fb_px, ncc },
        },
    )
}

/// Up to four tracks, some with a gap, in order of their numbers.
fn tracks(sample: impl Strategy<Value = Sample>) -> impl Strategy<Value = Vec<ForeignTrack>> {
    let name = proptest::option::of("[a-z]{1,6} [a-z]{3}");
    let gap = proptest::option::of((1..6_usize, 1..4_u32));
    let one = (name, 0..6_u32, proptest::collection::vec(sample, 1..7), gap);
    let many = proptest::collection::btree_map(0_u32..1000, one, 1..5);
    many.prop_map(|tracks| {
        let track = |(number, (name, first_frame, samples, gap))| {
            let spans = in_two(Span { first_frame, samples }, gap).into_iter().map(Arc::new).collect();
            ForeignTrack { number: Some(number), name, spans }
        };
        tracks.into_iter().map(track).collect()
    })
}

/// Moves what comes after the first samples some frames on.
fn in_two(mut span: Span, gap: Option<(usize, u32)>) -> Vec<Span> {
    let Some((n_first, n_frames)) = gap.filter(|(n_first, _)| *n_first < span.samples.len()) else {
        return vec![span];
    };
    let samples = span.samples.split_off(n_first);
    let first_frame = span.frames().end + n_frames;
    vec![span, Span { first_frame, samples }]
}

/// What CVAT shows of each frame of the first track of its file: not seen, occluded. It takes the key-frames alone
/// and holds each until the next.
fn shown_by_cvat(file: &[u8]) -> Vec<(bool, bool)> {
    let text = std::str::from_utf8(file).unwrap();
    let mut keys = BTreeMap::new();
    for line in text.lines().take_while(|line| !line.contains("</track>")) {
        let word = |name: &str| {
            line.split_once(&format!(" {name}=\"")).map(|(_, rest)| rest.split('"').next().unwrap())
        };
        if line.contains("<points ") && word("keyframe") == Some("1") {
            let frame: u32 = word("frame").unwrap().parse().unwrap();
            assert!(frame < N_FRAMES, "the clip has no frame {frame}");
            let again = keys.insert(frame, (word("outside") == Some("1"), word("occluded") == Some("1")));
            assert_eq!(again, None, "frame {frame} comes twice");
        }
    }
    let held = |frame| keys.range(..=frame).next_back().map_or((true, false), |(_, &shown)| shown);
    (0..N_FRAMES).map(held).collect()
}

/// What the manual promises that is kept of a sample.
fn kept(format: Format, sample: Sample) -> Option<Sample> {
    let gone = matches!(sample.status, Status::Lost | Status::Outside | Status::Rejected);
    let status = if sample.status == Status::Newborn { Status::Tracked } else { sample.status };
    let plain = Sample { status, source: Source::Imported, quality: Quality::default(), ..sample };
    match format {
        Format::Csv | Format::Parquet => Some(sample),
        Format::Cvat => {
            let source = if sample.source == Source::Key { Source::Key } else { Source::Imported };
            Some(Sample { source, status: if gone { Status::Outside } else { status }, ..plain })
        }
        Format::DeepLabCut | Format::Mot => {
            let ncc = crate::trust(sample.quality).map(|trust| trust.max(1e-6));
            let ncc = ncc.filter(|&ncc| ncc < 1.0 && status == Status::Tracked);
            (!gone).then_some(Sample { quality: Quality { fb_px: None, ncc }, ..plain })
        }
        Format::Dltdv | Format::TrackMate => (status == Status::Tracked).then_some(plain),
        Format::TapVid => {
            let shifted = |v: f32| (f64::from(v) + 0.5) as f32 - 0.5;
            (!gone).then_some(Sample { x: shifted(plain.x), y: shifted(plain.y), ..plain })
        }
    }
}

/// What the manual promises that is kept of tracks.
fn expected(format: Format, tracks: &[ForeignTrack]) -> Vec<ForeignTrack> {
    let mut kept_tracks = Vec::new();
    for (n, track) in (1..).zip(tracks) {
        let (number, name) = match format {
            Format::Csv | Format::Parquet | Format::Mot => (track.number, None),
            Format::Cvat => (track.number, track.name.clone()),
            Format::DeepLabCut => (track.number.filter(|_| track.name.is_none()), track.name.clone()),
            Format::Dltdv => (Some(n), None),
            Format::TrackMate | Format::TapVid => (None, None),
        };
        let samples = track.samples().filter_map(|(frame, sample)| Some((frame, kept(format, *sample)?)));
        let mut draft = draft::Draft { number, name, ..draft::Draft::default() };
        let mut room = draft::Room::new();
        samples.for_each(|(frame, sample)| draft.put(&mut room, frame, sample).unwrap());
        kept_tracks.extend(draft.done().unwrap());
    }
    kept_tracks
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn what_the_manual_says_comes_back(tracks in tracks(sample())) {
        for format in Format::ALL {
            let bytes = written(format, &outgoing(&tracks));
            let back = read_back(format, &bytes).tracks;
            prop_assert_eq!(back, expected(format, &tracks), "{:?}", format);
        }
    }

    #[test]
    fn what_no_loss_is_named_for_comes_back_whole(tracks in tracks(sample())) {
        for format in Format::ALL.into_iter().filter(|format| *format != Format::TapVid) {
            let what = outgoing(&tracks);
            // Tracks alone, so that many have no loss at all.
            for track in tracks.iter().filter(|track| track.number == Some(1) || format != Format::Dltdv) {
                let one = [track.clone()];
                if losses(format, &Outgoing { tracks: &one, ..what }).is_empty() {
                    let back = read_back(format, &written(format, &Outgoing { tracks: &one, ..what })).tracks;
                    prop_assert_eq!(back, one.to_vec(), "{:?}", format);
                }
            }
        }
    }

    #[test]
    fn plain_tracks_lose_at_most_their_numbers(tracks in tracks((0_u16..2560, 0_u16..1920).prop_map(|(x, y)| {
        // Quarters of pixels: f32 has them also after a shift.
        seen([f32::from(x) / 4.0, f32::from(y) / 4.0], None)
    }))) {
        let tracks: Vec<ForeignTrack> = (1..).zip(tracks).map(|(n, track)| {
            ForeignTrack { number: Some(n), name: None, ..track }
        }).collect();
        for format in Format::ALL {
            let what = outgoing(&tracks);
            let back = read_back(format, &written(format, &what)).tracks;
            let mut lost = losses(format, &what);
            // These are lost on CVAT, not on us.
            lost.retain(|loss| loss.what != "samples between key-frames");
            if lost.is_empty() {
                prop_assert_eq!(&back, &tracks, "{:?}", format);
            } else {
                prop_assert_eq!(lost.iter().map(|loss| loss.what).collect::<Vec<_>>(), ["track numbers"]);
                prop_assert!(back.iter().zip(&tracks).all(|(back, track)| back.spans == track.spans), "{:?}", format);
            }
        }
    }

    #[test]
    fn cvat_shows_every_track_where_it_is_seen(tracks in tracks(sample()), every_frame: bool) {
        for track in &tracks {
            let what = outgoing(std::slice::from_ref(track));
            let file = written(Format::Cvat, &Outgoing { every_frame, ..what });
            let wanted = |frame| track.at(frame).map_or((true, false), |sample| match sample.status {
                Status::Tracked | Status::Newborn => (false, false),
                Status::Occluded => (false, true),
                Status::Lost | Status::Outside | Status::Rejected => (true, false),
            });
            prop_assert_eq!(shown_by_cvat(&file), (0..N_FRAMES).map(wanted).collect::<Vec<_>>());
            let n_left = String::from_utf8(file).unwrap().matches("keyframe=\"0\"").count() as u64;
            let lost = losses(Format::Cvat, &Outgoing { every_frame, ..what });
            let between = lost.iter().find(|loss| loss.what == "samples between key-frames");
            prop_assert_eq!(between.map_or(0, |loss| loss.n), n_left);
        }
    }

    #[test]
    fn every_origin_comes_back(tracks in tracks(sample()), origin in proptest::sample::select(Origin::ALL.to_vec())) {
        for format in [Format::Cvat, Format::DeepLabCut, Format::Dltdv, Format::TrackMate, Format::TapVid, Format::Mot] {
            let what = Outgoing { origin: Some(origin), ..outgoing(&tracks) };
            let options = ReadOptions { origin: Some(origin), ..ReadOptions::of(SIZE) };
            let back = parse(&written(format, &what), format, &options).unwrap().tracks;
            for (back, track) in back.iter().zip(expected(format, &tracks)) {
                for ((frame, a), (other, b)) in back.samples().zip(track.samples()) {
                    prop_assert!(frame == other && (a.x - b.x).abs() < 1e-4 && (a.y - b.y).abs() < 1e-4);
                }
            }
        }
    }

    #[test]
    fn what_nobody_wrote_is_an_error_and_no_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        for format in Format::ALL {
            prop_assert!(parse(&bytes, format, &ReadOptions::of(SIZE)).is_ok_and(|read| read.tracks.is_empty())
                || parse(&bytes, format, &ReadOptions::of(SIZE)).is_err() || format == Format::Mot);
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(
        tracks in tracks(sample()),
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3), 1..6),
    ) {
        for format in Format::ALL {
            let mut bytes = written(format, &outgoing(&tracks));
            for (at, byte, how) in &damage {
                let at = at.index(bytes.len().max(1));
                match how {
                    0 if !bytes.is_empty() => bytes[at] = *byte,
                    1 => bytes.truncate(at.max(1)),
                    _ => bytes.insert(at.min(bytes.len()), b"0919\"<,'-."[usize::from(*byte) % 10]),
                }
            }
            drop(parse(&bytes, format, &ReadOptions::of(SIZE)));
        }
    }
}

#[test]
fn words_and_endings_name_formats() {
    for format in Format::ALL {
        assert_eq!(format.word().parse(), Ok(format));
    }
    assert_eq!(Format::of_extension("CSV"), Some(Format::Csv));
    assert_eq!(Format::of_extension("npz"), Some(Format::TapVid));
    assert_eq!(Format::of_extension("xml"), None, "CVAT or TrackMate");
    assert!("avi".parse::<Format>().unwrap_err().to_string().ends_with("came avi"));
}

#[test]
fn losses_are_counted() {
    let key = Sample { source: Source::Key, ..seen([1.0, 2.0], None) };
    let hidden = seen([1.0, 2.0], Some(0.0));
    let lost = Sample { status: Status::Lost, ..hidden };
    let span = Span { first_frame: 0, samples: vec![key, hidden, lost, key] };
    let track = ForeignTrack { number: Some(1), name: Some("leaf".to_owned()), spans: vec![Arc::new(span)] };
    let tracks = [track];
    let lines =
        |format, what: Outgoing<'_>| losses(format, &what).iter().map(Loss::to_string).collect::<Vec<_>>();
    assert_eq!(
        lines(Format::Dltdv, outgoing(&tracks)),
        [
            "1 names: left out",
            "2 key-frames: become ordinary samples",
            "1 occluded samples: left out: the format cannot mark them",
            "1 lost samples: become missing",
        ]
    );
    assert_eq!(
        lines(Format::Cvat, outgoing(&tracks)),
        ["1 lost samples: become outside"],
        "samples where it is hidden and lost from are key-frames in CVAT"
    );
    let path =
        Span { first_frame: 0, samples: vec![key, seen([1.0, 2.0], None), seen([1.0, 2.0], None), key] };
    let path = [ForeignTrack { number: Some(1), name: None, spans: vec![Arc::new(path)] }];
    assert_eq!(
        lines(Format::Cvat, outgoing(&path)),
        ["2 samples between key-frames: CVAT itself draws straight lines there; --every-frame keeps them"]
    );
    let every_frame = Outgoing { every_frame: true, variable_rate: true, ..outgoing(&tracks) };
    assert_eq!(
        lines(Format::Cvat, every_frame),
        [
            "1 lost samples: become outside",
            "15 uneven frame times: only frames are counted",
            "2 key-frames: cannot be told from the rest: every frame is one",
        ]
    );
}

#[test]
fn the_manual_has_the_table_of_formats() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/formats.md");
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(&manual()), "docs/formats.md must contain:\n{}", manual());
}

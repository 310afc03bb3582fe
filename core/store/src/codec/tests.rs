//! Bytes and back; bytes that are none are refused, never read beyond.

use proptest::prelude::*;

use super::{SOURCES, read_block, records, write_block, write_record};
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};

fn any_sample() -> impl Strategy<Value = Sample> {
    let quality = (prop::option::of(0.0_f32..9.0), prop::option::of(-1.0_f32..1.0));
    (any::<(f32, f32)>(), 0_u8..6, 0_usize..5, quality).prop_map(|((x, y), status, source, (fb_px, ncc))| {
        Sample {
            x,
            y,
            status: Status::from_u8(status).expect("six of them"),
            source: SOURCES[source],
            quality: Quality { fb_px, ncc },
        }
    })
}

proptest! {
    #[test]
    fn blocks_and_records_come_back(
        spans in prop::collection::vec((any::<u32>(), 0_u32..1000, prop::collection::vec(any_sample(), 0..70)), 0..6)
    ) {
        let mut chunk = Vec::new();
        for (track, first_frame, samples) in &spans {
            write_record(&mut chunk, TrackId(*track), *first_frame, samples);
        }
        let got = records(&chunk).unwrap();
        prop_assert_eq!(got.len(), spans.len());
        for (record, (track, first_frame, samples)) in got.iter().zip(spans) {
            prop_assert_eq!((record.track, record.n_samples()), (TrackId(track), samples.len()));
            prop_assert_eq!(record.span().unwrap(), Span { first_frame, samples });
        }
    }

    #[test]
    fn other_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..90), cut in any::<prop::sample::Index>()) {
        if let Ok(samples) = read_block(&bytes) {
            let mut again = Vec::new();
            write_block(&mut again, &samples);
            prop_assert_eq!(&again, &bytes, "what is read is what was written");
        }
        drop(records(&bytes));
        let mut whole = Vec::new();
        write_record(&mut whole, TrackId(1), 2, &[Sample {
            x: 1.0, y: 2.0, status: Status::Lost, source: Source::Tracked, quality: Quality::default(),
        }]);
        let part = &whole[..cut.index(whole.len())];
        prop_assert!(part.is_empty() || records(part).is_err());
    }
}

#[test]
fn bytes_are_as_documented() {
    let sample = Sample {
        x: 1.0,
        y: -2.0,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality { fb_px: None, ncc: Some(0.5) },
    };
    let mut block = Vec::new();
    write_block(&mut block, &[sample]);
    let want = [1, 1, 0, 0, 0, 0b1001_0001, 0, 0, 128, 63, 0, 0, 0, 192, 0, 0, 0, 63];
    assert_eq!(block, want);
    let ways_to_break_it = [(0, 2), (1, 2), (5, 0b1001_0110), (5, 0b1010_1001), (5, 0b1101_0001)];
    for (at, byte) in ways_to_break_it {
        let mut broken = want;
        broken[at] = byte;
        assert!(read_block(&broken).is_err(), "byte {at} as {byte:#b}");
    }
}

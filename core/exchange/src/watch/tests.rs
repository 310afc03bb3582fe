//! Every format is read under watch, and ends when told to.

use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use super::*;
use crate::foreign::{Format, ReadOptions, read};
use crate::{TrackRow, TrackTable};

#[test]
fn what_was_read_is_counted_and_a_stop_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    for (format, name) in [(Format::Csv, "t.csv"), (Format::Parquet, "t.parquet"), (Format::Mot, "t.txt")] {
        let path = folder.path().join(name);
        if let Some(mut table) = TrackTable::create(&path, format).unwrap() {
            for frame in 0..2000 {
                let (x, y, quality) = (frame as f32, 2.0, Quality::default());
                let sample = Sample { x, y, status: Status::Tracked, source: Source::Imported, quality };
                let row = TrackRow { track: TrackId(7), frame, time_s: None, sample, run: None };
                table.write(&row).unwrap();
            }
            table.finish().unwrap();
        } else {
            let line = |frame: u32| format!("{},7,{frame}.5,19.5,1,1,0.9,-1,-1,-1\n", frame + 1);
            std::fs::write(&path, (0..2000).map(line).collect::<String>()).unwrap();
        }
        let options = ReadOptions::of([640, 480]);
        let watch = Watch::default();
        let tracks = read(&path, format, &options, &watch).unwrap().tracks;
        assert_eq!((tracks.len(), tracks[0].n_samples()), (1, 2000), "{name}");
        let n_bytes = std::fs::metadata(&path).unwrap().len();
        assert!(watch.n_bytes() >= n_bytes / 2, "{name}: {} of {n_bytes} bytes", watch.n_bytes());
        let stopped = Watch::default();
        stopped.stop();
        assert!(read(&path, format, &options, &stopped).is_err(), "{name}");
        assert_eq!(stopped.n_bytes(), 0);
    }
}

//! What a format cannot keep: one table, from which exports are counted and the manual is written.

use honami_model::track::{Quality, Sample, Source, Status};

use super::{ForeignTrack, Format, Outgoing, cvat};

/// Something that our tracks have and a format may lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Aspect {
    Number,
    /// The number, whatever it is.
    AnyNumber,
    /// The number of a track that has a name.
    NamedNumber,
    Name,
    KeyFrame,
    /// Samples that are no key-frames, where not every frame becomes one.
    Between,
    Occluded,
    Outside,
    Lost,
    Rejected,
    Newborn,
    /// Both parts of the quality.
    Quality,
    /// The quality, but one number of it is kept.
    Parts,
    Source,
    Times,
}

/// What happened to some of what was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// What is lost: `key-frames`.
    pub what: &'static str,
    /// How many.
    pub n: u64,
    /// What becomes of it.
    pub how: &'static str,
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}: {}", self.n, self.what, self.how)
    }
}

/// A format in the manual.
struct Sheet {
    format: Format,
    title: &'static str,
    keeps: &'static str,
    loses: &'static [(Aspect, &'static str)],
}

const LEFT_OUT: &str = "left out: the format cannot mark them";
const MISSING: &str = "become missing";
const ORDINARY: &str = "become ordinary samples";
const SEEN: &str = "become tracked";
const DROPPED: &str = "left out";
const COUNTED: &str = "only frames are counted";
const TRUST: &str = "become one number";

const SHEETS: [Sheet; 8] = [
    Sheet {
        format: Format::Csv,
        title: "own long table, CSV",
        keeps: "numbers, every sample with time, status, source, quality and run; key-frames by their source",
        loses: &[(Aspect::Name, DROPPED)],
    },
    Sheet {
        format: Format::Parquet,
        title: "own long table, Parquet",
        keeps: "as CSV, typed and smaller",
        loses: &[(Aspect::Name, DROPPED)],
    },
    Sheet {
        format: Format::Cvat,
        title: "CVAT for video XML 1.1",
        keeps: "numbers, names (as labels), key-frames, occluded, outside",
        loses: &[
            (Aspect::Lost, "become outside"),
            (Aspect::Rejected, "become outside"),
            (Aspect::Newborn, SEEN),
            (Aspect::Quality, DROPPED),
            (Aspect::Between, "CVAT itself draws straight lines there; --every-frame keeps them"),
            (Aspect::Source, "one word for a track: manual, semi-auto, auto"),
            (Aspect::Times, COUNTED),
        ],
    },
    Sheet {
        format: Format::DeepLabCut,
        title: "DeepLabCut CSV",
        keeps: "names or numbers (as body parts), trust (as likelihood), occluded (as likelihood 0)",
        loses: &[
            (Aspect::NamedNumber, "of named tracks: the name stands in their place"),
            (Aspect::KeyFrame, ORDINARY),
            (Aspect::Outside, MISSING),
            (Aspect::Lost, MISSING),
            (Aspect::Rejected, MISSING),
            (Aspect::Newborn, SEEN),
            (Aspect::Parts, TRUST),
            (Aspect::Source, DROPPED),
            (Aspect::Times, COUNTED),
        ],
    },
    Sheet {
        format: Format::Dltdv,
        title: "DLTdv xypts CSV",
        keeps: "positions",
        loses: &[
            (Aspect::Number, "counted anew from 1"),
            (Aspect::Name, DROPPED),
            (Aspect::KeyFrame, ORDINARY),
            (Aspect::Occluded, LEFT_OUT),
            (Aspect::Outside, MISSING),
            (Aspect::Lost, MISSING),
            (Aspect::Rejected, MISSING),
            (Aspect::Newborn, SEEN),
            (Aspect::Quality, DROPPED),
            (Aspect::Source, DROPPED),
            (Aspect::Times, COUNTED),
        ],
    },
    Sheet {
        format: Format::TrackMate,
        title: "TrackMate XML",
        keeps: "positions, the frame interval",
        loses: &[
            (Aspect::AnyNumber, "only their order is kept"),
            (Aspect::Name, DROPPED),
            (Aspect::KeyFrame, ORDINARY),
            (Aspect::Occluded, LEFT_OUT),
            (Aspect::Outside, MISSING),
            (Aspect::Lost, MISSING),
            (Aspect::Rejected, MISSING),
            (Aspect::Newborn, SEEN),
            (Aspect::Quality, DROPPED),
            (Aspect::Source, DROPPED),
            (Aspect::Times, "only the usual interval is kept"),
        ],
    },
    Sheet {
        format: Format::TapVid,
        title: "TAP-Vid npz",
        keeps: "positions as f32 after the shift of half a pixel, occluded",
        loses: &[
            (Aspect::AnyNumber, "only their order is kept"),
            (Aspect::Name, DROPPED),
            (Aspect::KeyFrame, ORDINARY),
            (Aspect::Outside, MISSING),
            (Aspect::Lost, MISSING),
            (Aspect::Rejected, MISSING),
            (Aspect::Newborn, SEEN),
            (Aspect::Quality, DROPPED),
            (Aspect::Source, DROPPED),
            (Aspect::Times, COUNTED),
        ],
    },
    Sheet {
        format: Format::Mot,
        title: "MOTChallenge CSV",
        keeps: "numbers (as ids), trust (as conf), occluded (as conf 0)",
        loses: &[
            (Aspect::Name, DROPPED),
            (Aspect::KeyFrame, ORDINARY),
            (Aspect::Outside, MISSING),
            (Aspect::Lost, MISSING),
            (Aspect::Rejected, MISSING),
            (Aspect::Newborn, SEEN),
            (Aspect::Parts, TRUST),
            (Aspect::Source, DROPPED),
            (Aspect::Times, COUNTED),
        ],
    },
];

impl Aspect {
    fn what(self) -> &'static str {
        match self {
            Self::Number | Self::AnyNumber | Self::NamedNumber => "track numbers",
            Self::Name => "names",
            Self::KeyFrame => "key-frames",
            Self::Between => "samples between key-frames",
            Self::Occluded => "occluded samples",
            Self::Outside => "samples outside the picture",
            Self::Lost => "lost samples",
            Self::Rejected => "rejected samples",
            Self::Newborn => "newborn samples",
            Self::Quality => "qualities",
            Self::Parts => "pairs of fb and ncc",
            Self::Source => "sources of samples",
            Self::Times => "uneven frame times",
        }
    }

    /// How many of it there are. Tracks of a file that counts them have the numbers 1, 2, 3 and so on.
    fn count(self, what: &Outgoing<'_>) -> usize {
        let tracks = what.tracks.iter();
        let samples = |counts: fn(&Sample) -> bool| {
            tracks.clone().map(|track| track.samples().filter(|(_, sample)| counts(sample)).count()).sum()
        };
        match self {
            Self::Number => (1..).zip(tracks).filter(|(n, track)| track.number != Some(*n)).count(),
            Self::AnyNumber => tracks.len(),
            Self::NamedNumber | Self::Name => {
                tracks.filter(|track: &&ForeignTrack| track.name.is_some()).count()
            }
            Self::KeyFrame => samples(|s| s.source == Source::Key),
            Self::Between => cvat::n_between(what),
            Self::Occluded => samples(|s| s.status == Status::Occluded),
            Self::Outside => samples(|s| s.status == Status::Outside),
            Self::Lost => samples(|s| s.status == Status::Lost),
            Self::Rejected => samples(|s| s.status == Status::Rejected),
            Self::Newborn => samples(|s| s.status == Status::Newborn),
            Self::Quality => samples(|s| s.quality != Quality::default()),
            Self::Parts => samples(|s| !is_one_number(s)),
            Self::Source => samples(|s| !matches!(s.source, Source::Key | Source::Imported)),
            Self::Times if what.variable_rate => what.n_frames as usize,
            Self::Times => 0,
        }
    }
}

/// Whether a number from 0 to 1 says all of a sample's quality.
fn is_one_number(sample: &Sample) -> bool {
    match sample.quality {
        Quality { fb_px: None, ncc: None } => true,
        Quality { fb_px: None, ncc: Some(ncc) } => sample.status.is_seen() && (1e-6..1.0).contains(&ncc),
        Quality { fb_px: Some(_), .. } => false,
    }
}

fn sheet(format: Format) -> impl Iterator<Item = &'static Sheet> {
    SHEETS.iter().filter(move |sheet| sheet.format == format)
}

/// What these tracks lose in this format; nothing is named that is not there.
#[must_use]
pub fn losses(format: Format, what: &Outgoing<'_>) -> Vec<Loss> {
    let of = |&(aspect, how): &(Aspect, &'static str)| {
        let n = aspect.count(what) as u64;
        (n > 0).then(|| Loss { what: aspect.what(), n, how })
    };
    let mut losses: Vec<Loss> = sheet(format).flat_map(|sheet| sheet.loses).filter_map(of).collect();
    if format == Format::Cvat && what.every_frame {
        let n = Aspect::KeyFrame.count(what) as u64;
        let how = "cannot be told from the rest: every frame is one";
        losses.extend((n > 0).then(|| Loss { what: Aspect::KeyFrame.what(), n, how }));
    }
    losses
}

/// The table of formats for the manual, as Markdown.
#[must_use]
pub fn manual() -> String {
    let mut text = "| `--format` | format | ending | pixels from | keeps | loses |\n".to_owned();
    text += "|---|---|---|---|---|---|\n";
    for Sheet { format, title, keeps, loses } in &SHEETS {
        let loses: Vec<String> =
            loses.iter().map(|(aspect, how)| format!("{} ({how})", aspect.what())).collect();
        let (word, ending, origin) = (format.word(), format.extension(), format.origin().word());
        text += &format!("| `{word}` | {title} | .{ending} | {origin} | {keeps} | {} |\n", loses.join("; "));
    }
    text
}

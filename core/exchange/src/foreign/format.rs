//! The formats: their names, and how a file is told from another.

use std::str::FromStr;

use crate::origin::Origin;

/// A format of tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Format {
    /// The own long table as CSV.
    Csv,
    /// The own long table as Parquet.
    Parquet,
    /// CVAT for video, XML 1.1.
    Cvat,
    /// DeepLabCut CSV: three header lines.
    DeepLabCut,
    /// DLTdv xypts CSV.
    Dltdv,
    /// TrackMate: its whole file or its simple tracks (read), simple tracks (written).
    TrackMate,
    /// TAP-Vid-style npz: `points`, `occluded`.
    TapVid,
    /// MOTChallenge CSV.
    Mot,
}

/// No such format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wanted a format: {}; came {came}", Format::words().join(", "))]
pub struct FormatError {
    came: String,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Csv,
        Self::Parquet,
        Self::Cvat,
        Self::DeepLabCut,
        Self::Dltdv,
        Self::TrackMate,
        Self::TapVid,
        Self::Mot,
    ];

    /// The word for it on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Cvat => "cvat",
            Self::DeepLabCut => "deeplabcut",
            Self::Dltdv => "dltdv",
            Self::TrackMate => "trackmate",
            Self::TapVid => "tapvid",
            Self::Mot => "mot",
        }
    }

    /// The words of all.
    #[must_use]
    pub fn words() -> Vec<&'static str> {
        Self::ALL.map(Self::word).to_vec()
    }

    /// Where it counts pixels from.
    #[must_use]
    pub fn origin(self) -> Origin {
        match self {
            Self::Csv | Self::Parquet | Self::DeepLabCut | Self::TrackMate => Origin::Centre,
            Self::Cvat | Self::TapVid => Origin::Corner,
            Self::Dltdv | Self::Mot => Origin::Top,
        }
    }

    /// The ending of its files, without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv | Self::DeepLabCut | Self::Dltdv => "csv",
            Self::Parquet => "parquet",
            Self::Cvat | Self::TrackMate => "xml",
            Self::TapVid => "npz",
            Self::Mot => "txt",
        }
    }

    /// The format that an ending alone names: of those with this ending the first, but none for `xml`, which
    /// two very different ones share.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        let extension = extension.to_ascii_lowercase();
        Self::ALL.into_iter().find(|format| format.extension() == extension && extension != "xml")
    }

    /// The format of a file that begins with this.
    #[must_use]
    pub fn of_content(head: &[u8]) -> Option<Self> {
        if head.starts_with(b"PAR1") {
            return Some(Self::Parquet);
        }
        if head.starts_with(b"PK\x03\x04") {
            return Some(Self::TapVid);
        }
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('<') {
            let has = |tag: &str| text.contains(tag);
            return match () {
                () if has("<annotations") => Some(Self::Cvat),
                () if has("<TrackMate") || has("<Tracks") => Some(Self::TrackMate),
                () => None,
            };
        }
        let line = text.lines().next()?;
        let words: Vec<&str> = line.split(',').map(|word| word.trim().trim_matches('"')).collect();
        let is_point = |word: &&str| word.starts_with("pt") && word.contains("_cam");
        match words[..] {
            ["scorer", ..] => Some(Self::DeepLabCut),
            [_, ..] if words.iter().any(is_point) => Some(Self::Dltdv),
            [_, ..] if words.contains(&"track") && words.contains(&"frame") => Some(Self::Csv),
            [_, _, _, _, _, _, ..] if words.iter().all(|word| word.parse::<f64>().is_ok()) => Some(Self::Mot),
            _ => None,
        }
    }
}

impl FromStr for Format {
    type Err = FormatError;

    fn from_str(text: &str) -> Result<Self, FormatError> {
        Self::ALL
            .into_iter()
            .find(|format| format.word() == text)
            .ok_or_else(|| FormatError { came: text.to_owned() })
    }
}

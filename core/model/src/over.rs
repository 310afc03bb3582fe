//! What corrections have laid over the runs of a track, frame by frame.

use serde::{Deserialize, Serialize};

use crate::document::RunId;
use crate::track::{Quality, Sample, Source, Status};

/// What lies over the runs in one frame; a person's work, which no tracker changes.
///
/// Written as an array: empty for [`Over::Nothing`], else `[x, y, status, source, fb, ncc, run]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub enum Over {
    /// This sample.
    Sample(Laid),
    /// No sample, also where a run has one: the track does not reach here, or is lost.
    Nothing,
}

/// A sample laid over the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laid {
    /// The sample; its position is finite.
    pub sample: Sample,
    /// The run it was found by, where a tracker found it.
    pub run: Option<RunId>,
}

impl Over {
    /// The sample, if there is one.
    #[must_use]
    pub fn sample(&self) -> Option<&Sample> {
        match self {
            Self::Sample(laid) => Some(&laid.sample),
            Self::Nothing => None,
        }
    }
}

/// The form in the project file: short, for there may be one for every frame of a track.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Sample(f32, f32, Status, Source, Option<f32>, Option<f32>, Option<RunId>),
    Nothing([u8; 0]),
}

impl From<Over> for Written {
    fn from(over: Over) -> Self {
        match over {
            Over::Nothing => Self::Nothing([]),
            Over::Sample(Laid { sample, run }) => {
                let Sample { x, y, status, source, quality } = sample;
                Self::Sample(x, y, status, source, quality.fb_px, quality.ncc, run)
            }
        }
    }
}

impl From<Written> for Over {
    fn from(written: Written) -> Self {
        match written {
            Written::Nothing([]) => Self::Nothing,
            Written::Sample(x, y, status, source, fb_px, ncc, run) => {
                let quality = Quality { fb_px, ncc };
                Self::Sample(Laid { sample: Sample { x, y, status, source, quality }, run })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_written() {
        let sample = Sample {
            x: 1.5,
            y: -0.1,
            status: Status::Occluded,
            source: Source::Sketch,
            quality: Quality { fb_px: None, ncc: Some(0.75) },
        };
        for (over, written) in [
            (None, "null"),
            (Some(Over::Nothing), "[]"),
            (
                Some(Over::Sample(Laid { sample, run: Some(RunId(3)) })),
                r#"[1.5,-0.1,"occluded","sketch",null,0.75,3]"#,
            ),
            (
                Some(Over::Sample(Laid { sample, run: None })),
                r#"[1.5,-0.1,"occluded","sketch",null,0.75,null]"#,
            ),
        ] {
            assert_eq!(serde_json::to_string(&over).expect("it can be written"), written);
            let read: Option<Over> = serde_json::from_str(written).expect("it can be read");
            assert_eq!(read, over);
        }
    }
}

//! Which errors are of what was typed.

use super::{CamerasError, WorkbenchError};

impl WorkbenchError {
    /// Whether other options, numbers or names are wanted than were typed: not another file, nor more room or work.
    #[must_use]
    pub fn is_as_typed(&self) -> bool {
        use honami_mechanics::{BeamsError, ForestError};
        use honami_structure::StructureError as Grown;
        match self {
            Self::PlantFile(error) => return error.is_as_typed(),
            Self::Weather(error) => return error.is_as_typed(),
            Self::Space(error) => return error.is_as_typed(),
            _ => {}
        }
        matches!(
            self,
            Self::MovieSize { .. }
                | Self::Media(honami_media::MediaError::Ending { .. })
                | Self::NoPlant { .. }
                | Self::Frames { .. }
                | Self::Groups { .. }
                | Self::NoSuchTracks
                | Self::Matte { source: honami_matting::MattingError::Option { .. }, .. }
                | Self::Kept(super::matte::MatteError::NoneOf { .. })
                | Self::EmptyRegion { .. }
                | Self::FarRoot { .. }
                | Self::Unit { .. }
                | Self::NoCarried { .. }
                | Self::Cameras(CamerasError::Pairs { .. })
                | Self::NoVertices
                | Self::TooFast { .. }
                | Self::Sensors(crate::error::SensorsError::Height(_))
                | Self::Piece(_)
                | Self::Scale(_)
                | Self::Structure(
                    Grown::Shift(_)
                        | Grown::Copies
                        | Grown::Root { .. }
                        // Where none was typed it is 0: no level of this skeleton has two bones.
                        | Grown::NoLevel { wanted: 1.., .. }
                        | Grown::Threshold { .. }
                        | Grown::TooFewJoints { .. }
                        | Grown::Unit(_)
                )
                | Self::Onto { source: Grown::Unit(_), .. }
                | Self::Units { .. }
                | Self::Pixels
                | Self::Pace { .. }
                | Self::Substeps { .. }
                | Self::Pull { .. }
                | Self::Spread { .. }
                | Self::Spacing { .. }
                | Self::Sensor { .. }
                | Self::Leaves(_)
                | Self::NoMeaning { .. }
                | Self::Drag { .. }
                | Self::Beams(BeamsError::Material(_) | BeamsError::Longest(_))
                | Self::TooManyModes { .. }
                | Self::Forest(ForestError::Damping { .. })
        )
    }
}

//! What may be typed of sensors that tracks are compared with.

use std::path::PathBuf;

use clap::Args;

use super::seconds;

#[derive(Args, Debug)]
pub(in crate::cli) struct Sensors {
    /// Tracks in space beside what sensors have recorded: places of markers in metres, `marker,time_s,x,y,z` or
    /// `time_s,NAME_x,NAME_y,NAME_z`. The clip is a project with tracks in space, or a
    /// table of them, `track,time_s,x_m,y_m,z_m`. docs/sensors.md.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["with", "truth", "tracks", "points", "frames", "quick", "set", "fps"])]
    pub(in crate::cli) sensors: Option<PathBuf>,
    /// With --sensors: the wind, columns beside one of times by the sensors' clock; drawn below.
    #[arg(long, value_name = "FILE", requires = "sensors")]
    pub(in crate::cli) wind: Option<PathBuf>,
    /// With --sensors: the sensors' clock is ahead by so many seconds (default: found by how both move).
    #[arg(long, value_name = "S", requires = "sensors", allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) offset: Option<f64>,
    /// With --sensors: height of the plant, metres, of which distances are told in percent.
    #[arg(long, value_name = "M", requires = "sensors", allow_negative_numbers = true)]
    pub(in crate::cli) height: Option<f64>,
    /// With --sensors: write both, brought together: marker,track,time_s,x_m,y_m,z_m,sensor_x_m,sensor_y_m,sensor_z_m.
    #[arg(long, value_name = "FILE", requires = "sensors")]
    pub(in crate::cli) csv: Option<PathBuf>,
}

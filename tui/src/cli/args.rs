//! The command line as typed. Stable: scripts and tests use it.

pub(super) mod cameras;
pub(super) mod grow;
pub(super) mod matte;
pub(super) mod plant;
pub(super) mod recipe;
pub(super) mod scale;
pub(super) mod sensors;
pub(super) mod slurm;
pub(super) mod space;
pub(super) mod spectrum;
pub(super) mod view;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use honami_model::brief::Brief;
use honami_model::track::{TrackId, TrackSet};
use honami_workbench::export::BOX_PX;
use honami_workbench::foreign::Format;
use honami_workbench::media::write::RATES;
use honami_workbench::movie::Layer;
use honami_workbench::origin::Origin;

/// Measures how plants move.
///
/// Tracks features of a plant in video, lets you correct the tracks in the terminal, finds the branches
/// behind the motion, and keeps everything with its provenance in one project file.
#[derive(Debug, Parser)]
#[command(name = "honami", version)]
pub(super) struct Cli {
    /// What to do; without a command, the terminal UI opens.
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// Project (.honami) to open in the terminal UI, or a clip to make one from.
    pub(super) project: Option<PathBuf>,
    /// Write what is done in the terminal UI to this new file, line by line; `honami replay` does it again.
    #[arg(long, value_name = "FILE", requires = "project")]
    pub(super) log: Option<PathBuf>,
    #[command(flatten)]
    pub(super) common: Common,
}

/// Options of every command.
#[derive(Args, Clone, Debug, Default)]
pub(super) struct Common {
    /// Print one JSON object for machines instead of text.
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// Say what plugins print and log, on standard error.
    #[arg(short, long, global = true)]
    pub(super) verbose: bool,
    /// Look for plugins in this file or folder first.
    #[arg(long = "plugin", value_name = "PATH", global = true)]
    pub(super) plugins: Vec<PathBuf>,
    /// Your own build tree: plugins built in this folder are found, and trusted while this honami runs.
    #[arg(long, value_name = "DIR", global = true)]
    pub(super) dev: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Make a project from a clip: a video, an image folder, or a pattern such as `frame_%04d.png`.
    New(New),
    /// Say where a project's clip is now, when it was moved.
    Relink(Relink),
    /// Follow features through the clip with a tracker plugin.
    Track(Track),
    /// Find the groups that move together with a clusterer plugin.
    Cluster(Cluster),
    /// Grow the branches behind the tracks: a skeleton that moves as filmed.
    Grow(grow::Grow),
    /// Shape the skeleton by hand: place its root, turn bones out of the picture, have them lean or swing otherwise.
    ///
    /// Without options, says how long bones are and what was done to which. The project keeps what was done; `honami grow` and
    /// `honami simulate` lay it over what grows, and `honami edit` undoes it. Numbers are of the bone as it grows, so that the
    /// same twice is the same, and all that a bone bears goes along. docs/skeletons.md has more.
    Shape(grow::Shape),
    /// Show a skeleton over its clip or in space, or a plant or a forest of it in the wind: in a window, in the terminal, in a
    /// file.
    ///
    /// The viewer, a program of its own beside this one, draws it: `cargo build --release -p honami-viewer` builds that.
    /// docs/viewer.md has more.
    View(Box<view::View>),
    /// Correct tracks from a script: one edit a line on standard input, one answer a line.
    ///
    /// An edit is answered once it is in the project file, with its number in the undo tree. The first edit that
    /// cannot be done ends the script; those before it are kept.
    #[command(after_help = honami_workbench::script::help())]
    Edit(Project),
    /// Run trackers side by side on a clip and say how far they can be trusted.
    Compare(Compare),
    /// Cameras, from pictures of a chessboard or of targets on bars: focal length, centre, distortion, and of two how they stand.
    Calibrate(cameras::Calibrate),
    /// How much of every pixel is plant, from a few strokes on a picture; and the mask of what is worth tracking.
    Matte(matte::Matte),
    /// How far the clocks of two clips are apart, with a standard error.
    Sync(space::Sync),
    /// Where tracks of two views are in space, metres: kept in the left project as tracks in space.
    Triangulate(space::Triangulate),
    /// How many metres a pixel is, by something in the picture whose length is known; without places, says it.
    Scale(scale::Scale),
    /// Frequencies of tracks and groups, in Hz from the frame times.
    Spectrum(spectrum::Spectrum),
    /// What moves together: where, along which line and how fast, by bi-orthogonal decomposition of the tracks.
    ///
    /// A row for each component that stands out of the noise, the strongest first: its share of all motion; its singular value,
    /// px; the frequency at which it is strongest, and how broad the peak is at half its power; the line along which it goes, 0
    /// degrees horizontal, 90 vertical, and how straight, 1 where no track goes any other way; how many tracks have half of it;
    /// and its spectrum, amplitudes from 0 Hz to half the frame rate.
    Components(Components),
    /// Vibration modes of a plant, and how it, or a forest of it, moves in the wind.
    Simulate(Box<plant::Simulate>),
    /// Write what was measured for other programs; docs/formats.md says what each format keeps.
    Export(Export),
    /// Read somebody else's tracks into a project: one run, and key-frames where the file has them.
    Import(Import),
    /// Render a clip of a moving plant whose truth is known.
    Synth(Synth),
    /// A generated clip, tracked and clustered; then the terminal UI.
    Demo(Demo),
    /// Five minutes in the terminal UI on a generated clip: what to press, one step at a time.
    Tutorial,
    /// What plugins there are and what they take.
    #[command(subcommand)]
    Plugin(Plugin),
    /// Follow a recipe with many clips: a project for each, and only what is missing or stale is done.
    ///
    /// A step is done again when the clip, its line, a plugin, a file that it reads, honami or a step before it is another, when
    /// the project was edited since, or when what it wrote is gone. A clip that fails holds up no other. Ctrl-C ends it, and the
    /// same line goes on. Exit status 1: a clip has failed, or it was stopped. docs/recipes.md has more.
    Run(recipe::Run),
    /// Make a project again from its recipe, in a folder for the time being, and say what differs: its runs sample by sample, its
    /// hierarchy of groups, and the files that its steps wrote. What was done by hand is not compared. Exit status 1: it
    /// differs.
    Rerun(Project),
    /// Recipes, from projects.
    #[command(subcommand)]
    Recipe(recipe::Recipe),
    /// Follow a recipe with many clips on a cluster: one array job of Slurm, which does the rest. docs/recipes.md has more.
    Submit(slurm::Submit),
    /// How submitted clips are: done, at work, waiting or failed; seconds and memory. Exit status 1: a clip has failed.
    Status(slurm::Submitted),
    /// End what was submitted; the same `honami submit` goes on.
    Cancel(slurm::Submitted),
    /// One task of what was submitted: how Slurm starts honami.
    #[command(hide = true)]
    Task(slurm::Task),
    /// The segments worth a look, the most doubtful first; how far the review is and what it has taken.
    Review(Project),
    /// Everything that was done to a project: runs, clusterings, edits.
    Log(Project),
    /// Do again what was done in a session of the terminal UI, without a terminal.
    ///
    /// The log is one that `--log` wrote or `P L` saved. The project must be as it was when the session began, such as a
    /// copy made then. Prints what the session said, and stops with status 1 where it now goes another way.
    /// docs/replay.md describes the log.
    Replay(Replay),
    /// The keys of the terminal UI as they are now, your own included.
    Keys(Keys),
    /// How fast it is here what theses have tables of.
    #[command(subcommand)]
    Bench(plant::Bench),
    /// What this machine has, what each missing piece would add, and how to install it.
    Doctor,
    /// Shell completions, on standard output.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// The manual pages, into a folder.
    Man {
        /// Folder to write them to; made if it is not there.
        folder: PathBuf,
    },
}

#[derive(Args, Debug)]
pub(super) struct Project {
    /// Project file (.honami).
    pub(super) project: PathBuf,
}

#[derive(Args, Debug)]
pub(super) struct Replay {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    /// Log of a session.
    pub(super) log: PathBuf,
}

#[derive(Args, Debug)]
pub(super) struct New {
    /// Project file to make; never overwritten.
    pub(super) project: PathBuf,
    /// Video, image folder or pattern.
    pub(super) clip: PathBuf,
    /// True frame rate, when the file's is wrong or an image sequence has none.
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = frames_per_second)]
    pub(super) fps: Option<f64>,
}

#[derive(Args, Debug)]
pub(super) struct Relink {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    /// The clip; its content must be what it was.
    pub(super) clip: PathBuf,
}

/// Which plugin, with which parameters.
#[derive(Args, Debug)]
pub(super) struct WithPlugin {
    /// Plugin: its short name or full id.
    #[arg(long, value_name = "NAME")]
    pub(super) with: Option<String>,
    /// Set a parameter; `honami plugin info NAME` lists them.
    #[arg(long = "set", value_name = "K=V")]
    pub(super) set: Vec<String>,
}

#[derive(Args, Debug)]
pub(super) struct Track {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    #[command(flatten)]
    pub(super) plugin: WithPlugin,
    /// Let this tracker choose the features (default: the project's own, where it has any).
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = "")]
    pub(super) detect: Option<String>,
    /// Features from a table `id,x,y[,frame]`.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["detect", "mask", "region", "every"])]
    pub(super) points: Option<PathBuf>,
    /// Image whose black pixels get no features (default: the mattes that the project keeps: honami matte).
    #[arg(long, value_name = "FILE", conflicts_with = "region")]
    pub(super) mask: Option<PathBuf>,
    /// Features everywhere, also outside the kept mattes.
    #[arg(long, conflicts_with_all = ["mask", "region", "points"])]
    pub(super) no_mask: bool,
    /// Rectangle in pixels outside which there are no features.
    #[arg(long, value_name = "X,Y,W,H")]
    pub(super) region: Option<Region>,
    /// Frames to track, the last one excluded (default: all).
    #[arg(long, value_name = "A..B")]
    pub(super) frames: Option<FrameRange>,
    /// Detect again every N frames, where no feature is near.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) every: Option<u32>,
    /// Go on with a run that was stopped or that failed, where it saw the features last, with its tracker as it is now
    /// (default: the newest such run that no newer one has replaced).
    #[arg(long, value_name = "RUN", num_args = 0..=1, conflicts_with_all = ["with", "set", "detect", "points", "mask", "no_mask", "region", "frames", "every", "watch"])]
    pub(super) resume: Option<Option<u32>>,
    /// Stay when all is tracked, and track again with every rebuilt file of the plugin, until Ctrl-C.
    #[arg(long)]
    pub(super) watch: bool,
}

#[derive(Args, Debug)]
pub(super) struct Cluster {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    #[command(flatten)]
    pub(super) plugin: WithPlugin,
    /// Number of groups to cut the hierarchy into.
    #[arg(long, value_name = "K")]
    pub(super) groups: Option<u32>,
}

/// Trackers side by side on the same points. With a truth: δavg, share of visible samples within 1, 2, 4, 8, 16 px of
/// it, averaged, and the five shares, a lost sample being a miss; median, of the errors, px; track, median over points of
/// the median error of a point; surv, share of frames before the first error above 16 px or loss; ok, share of points
/// within 8 px throughout; occl, share of samples whose visibility is told rightly; prec, of the samples called seen the
/// share that is visible and within 8 px; rec, of the visible ones the share that is called seen and within 8 px; lost,
/// share of the visible samples. Always: kept, share of points seen in every frame; back, median distance from the start
/// when tracked to the end and back, px, and the share within 1 px; keys, median distance of key-frames that are tracked
/// to from the one before, px; ms, mean and 95 % of the times of a frame in the tracker, one thread; MB, growth of memory.
/// The row "static" tracks nothing.
#[derive(Args, Debug)]
pub(super) struct Compare {
    /// Clip, or project whose clip, tracks and key-frames are used; several images are a clip, too.
    #[arg(required = true)]
    pub(super) clip: Vec<PathBuf>,
    /// Tracker to run; give it once for each (default: anchored).
    #[arg(long, value_name = "NAME")]
    pub(super) with: Vec<String>,
    /// True positions, a table `track,frame,x,y,visible,branch`; or the true flow between two pictures, a .flo file.
    #[arg(long, value_name = "FILE")]
    pub(super) truth: Option<PathBuf>,
    /// Tracks that another program made of the same points, as a table of tracks.
    #[arg(long, value_name = "NAME=FILE")]
    pub(super) tracks: Vec<Foreign>,
    /// Features from a table `id,x,y[,frame]` (default: from the truth, else the project's own, else as the first
    /// tracker finds them).
    #[arg(long, value_name = "FILE")]
    pub(super) points: Option<PathBuf>,
    /// Frames to compare on, the last one excluded (default: all).
    #[arg(long, value_name = "A..B")]
    pub(super) frames: Option<FrameRange>,
    /// Neither track back nor leave key-frames out: half the time.
    #[arg(long)]
    pub(super) quick: bool,
    /// Draw it, too: shares, growth of errors, distribution of errors.
    #[arg(long, value_name = "FILE.svg")]
    pub(super) svg: Option<PathBuf>,
    /// Set a parameter of every tracker that has it.
    #[arg(long = "set", value_name = "K=V")]
    pub(super) set: Vec<String>,
    /// True frame rate of the clip.
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = frames_per_second)]
    pub(super) fps: Option<f64>,
    #[command(flatten)]
    pub(super) beside: sensors::Sensors,
}

#[derive(Args, Debug)]
pub(super) struct Components {
    /// Project file (.honami), or a table of tracks (.csv) with the time of every frame.
    pub(super) project: PathBuf,
    /// Files to write: .svg, maps, curves and spectra; .csv, how far each track goes with each component,
    /// component,track,x_px,y_px,dx_px,dy_px, and beside it as .chronos.csv how each goes in time,
    /// component,frame,time_s,chronos. A track's motion is the sum of dx_px, dy_px times chronos.
    #[arg(value_name = "OUT")]
    pub(super) out: Vec<PathBuf>,
    /// So many at most, the strongest first.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) most: u32,
}

#[derive(Args, Debug)]
pub(super) struct Export {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    /// What to write.
    pub(super) what: ExportWhat,
    /// File to write; its ending names the format: .csv, .parquet, .npz, .txt (MOTChallenge); of tracks in space .csv, .c3d; of a movie .mp4 (by ffmpeg),
    /// .y4m, or a new folder for PNG images.
    pub(super) out: PathBuf,
    /// csv, parquet, cvat, deeplabcut, dltdv, trackmate, tapvid or mot.
    #[arg(long, value_name = "F")]
    pub(super) format: Option<Format>,
    /// Only these tracks, for instance 3,7,10-19.
    #[arg(long, value_name = "LIST")]
    pub(super) tracks: Option<Numbers>,
    /// Only the tracks of these groups, for instance 1,3.
    #[arg(long, value_name = "LIST")]
    pub(super) groups: Option<Numbers>,
    /// Count pixels from centre, corner, top, bottom or normalised (default: as the format does).
    #[arg(long, value_name = "O")]
    pub(super) origin: Option<Origin>,
    /// CVAT: make every frame a key-frame, because CVAT draws straight lines between them.
    #[arg(long)]
    pub(super) every_frame: bool,
    /// MOTChallenge: side of the box around a point, pixels.
    #[arg(long = "box", value_name = "PX", default_value_t = BOX_PX)]
    pub(super) box_px: f64,
    /// Mask: of which frame.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) frame: u32,
    #[command(flatten)]
    pub(super) movie: Movie,
}

/// What a movie is to show.
#[derive(Args, Debug)]
#[command(next_help_heading = "Movies")]
pub(super) struct Movie {
    /// What is drawn over the clip: tracks, trails, groups (an ellipse round 95 % of each), skeleton, motion (colours of
    /// velocities), arrows, labels (numbers and names of groups), time (default: tracks, trails, and the skeleton where one
    /// grows).
    #[arg(long, value_name = "WHAT,…", value_delimiter = ',')]
    pub(super) show: Vec<Layer>,
    /// Frames of the clip, the last one excluded (default: all).
    #[arg(long, value_name = "A..B")]
    pub(super) frames: Option<FrameRange>,
    /// Size of the movie, pixels: the picture keeps its shape, with black beside it.
    #[arg(long, value_name = "WxH", conflicts_with = "scale")]
    pub(super) size: Option<Size>,
    /// So many times as wide and as high as the clip (default: 1).
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    pub(super) scale: Option<f64>,
    /// Frames a second of the movie: fewer than of the clip is slow motion (default: as filmed).
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = movie_rate)]
    pub(super) fps: Option<f64>,
    /// How long trails are, seconds of the clip (default: 0.5).
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub(super) trail: Option<f64>,
}

#[derive(Args, Debug)]
pub(super) struct Import {
    /// Project file (.honami).
    pub(super) project: PathBuf,
    /// File to read; what it is, is seen from how it begins.
    pub(super) file: PathBuf,
    /// csv, parquet, cvat, deeplabcut, dltdv, trackmate, tapvid or mot.
    #[arg(long, value_name = "F")]
    pub(super) format: Option<Format>,
    /// It counts pixels from centre, corner, top, bottom or normalised (default: as the format does).
    #[arg(long, value_name = "O")]
    pub(super) origin: Option<Origin>,
    /// Size of the pictures it was made on, if not the clip's: positions are scaled.
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<Size>,
    /// DLTdv: the camera whose points are wanted.
    #[arg(long, value_name = "N")]
    pub(super) camera: Option<u32>,
    /// TrackMate: how many of its units of length a pixel is wide.
    #[arg(long, value_name = "F")]
    pub(super) pixel_size: Option<f64>,
    /// Take key-frames as samples like all others.
    #[arg(long)]
    pub(super) no_keys: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ExportWhat {
    /// The shown tracks: track,frame,time_s,x,y,status,source,quality,fb,ncc,run. Status: lost 0, tracked 1,
    /// occluded 2, outside 3, rejected 4, newborn 5.
    Tracks,
    /// The group of every track, numbered as on the screen: track,group,name.
    Groups,
    /// Tracks in space: track,frame,time_s,x_m,y_m,z_m,ex_m,ey_m,ez_m,residual_px; metres in the left camera's axes, x right,
    /// y down, z forward, with standard errors; or .c3d, for programs of motion capture: millimetres.
    Space,
    /// What reviewers have found: track,first_frame,end_frame,verdict,stands,reasons,reviewer,time,keystrokes,key_frames,seconds.
    Verdicts,
    /// What the review of every track has taken: track,segments,keystrokes,key_frames,seconds.
    Effort,
    /// The mask of the kept matte that counts in --frame, as .png: white where features are looked for.
    Mask,
    /// The clip with what was measured drawn over it. Filled marks were measured, hollow ones predicted or put between, crosses
    /// are where a track was lost; key-frames have a ring.
    Movie,
}

#[derive(Args, Debug)]
pub(super) struct Synth {
    /// Clip to write: a .y4m or .mp4 file, or a folder of PNG files. The truth goes beside it. Of a --target a new folder.
    pub(super) out: PathBuf,
    /// Film no plant but a target that is carried before two cameras, to try `calibrate` on: both clips, where the target's
    /// points are seen, and the true cameras.
    #[arg(long, value_name = "TARGET", conflicts_with_all = ["wind", "leaves", "plant"])]
    pub(super) target: Option<cameras::TargetKind>,
    /// How hard it blows: mean leaf displacement of 1.5, 3.4 or 5.8 px per frame at 960x720; of a --plant gusts of 3, 8 or
    /// 18 m/s.
    #[arg(long, default_value = "calm")]
    pub(super) wind: Wind,
    /// Number of frames.
    #[arg(long, value_name = "T", default_value_t = 150, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(super) frames: u32,
    /// Size in pixels.
    #[arg(long, value_name = "WxH", default_value = "960x720")]
    pub(super) size: Size,
    /// Frames per second.
    #[arg(long, value_name = "F", default_value_t = 25.0)]
    pub(super) fps: f64,
    /// Number of leaves.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) leaves: Option<u32>,
    /// The same seed gives the same clip.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(super) seed: u64,
    /// Film this plant as a simulator moves it, with leaves on the ends of its branches: what `simulate` takes.
    #[arg(long, value_name = "PLANT")]
    pub(super) plant: Option<String>,
    /// Of a .mtg plant: only parts of these classes, such as S.
    #[arg(long, value_name = "C,…", value_delimiter = ',', requires = "plant")]
    pub(super) classes: Vec<String>,
    /// Of a plant: metres of a unit of length, where its file does not say; of a project's skeleton, of a pixel.
    #[arg(long, value_name = "M", requires = "plant", allow_negative_numbers = true)]
    pub(super) unit: Option<f64>,
    /// Of a plant: how many modes, the slowest first (default: 25, or as many as a small plant has).
    #[arg(long, value_name = "M", requires = "plant", value_parser = clap::value_parser!(u32).range(1..=5000))]
    pub(super) modes: Option<u32>,
    /// Of a plant: who moves it, a simulator's short name or full id.
    #[arg(long, value_name = "NAME", requires = "plant")]
    pub(super) with: Option<String>,
    /// Of a plant: set a parameter of its simulator; `honami plugin info NAME` lists them.
    #[arg(long = "set", value_name = "K=V", requires = "plant")]
    pub(super) set: Vec<String>,
    /// Of a plant: in still air, the slowest mode pulled out by so many metres and let go.
    #[arg(
        long,
        value_name = "M",
        allow_negative_numbers = true,
        requires = "plant",
        conflicts_with = "wind"
    )]
    pub(super) pull: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(clippy::enum_variant_names, reason = "wind is the word for its middle level, too")]
pub(super) enum Wind {
    /// 1.5 px per frame.
    Calm,
    /// 3.4 px per frame.
    Wind,
    /// 5.8 px per frame.
    Storm,
}

#[derive(Args, Debug)]
pub(super) struct Keys {
    /// Only say what is wrong with the configuration; fail where anything is.
    #[arg(long)]
    pub(super) check: bool,
}

/// Folder of the demo.
pub(super) const DEMO: &str = "honami-demo";

#[derive(Args, Debug)]
pub(super) struct Demo {
    /// Do everything but open the terminal UI.
    #[arg(long)]
    pub(super) headless: bool,
    /// Folder for the clip and the project (default: honami-demo in the current folder).
    #[arg(long, value_name = "DIR", default_value = DEMO)]
    pub(super) folder: PathBuf,
}

#[derive(Debug, Subcommand)]
pub(super) enum Plugin {
    /// Every plugin on the search path.
    List,
    /// One plugin: what it does, its parameters, where it comes from.
    Info {
        /// Short name or full id.
        name: String,
    },
    /// Begin a plugin of your own: a folder with one that works, to be changed.
    ///
    /// A tracker that speaks TraX, as those of the VOT challenges do, becomes a plugin as it is: --lang trax, and after
    /// -- how its server is started.
    New {
        /// Its name: a letter, then letters, digits, `-` and `_`.
        name: String,
        /// What it does.
        #[arg(long, value_enum, default_value_t = Kind::Tracker)]
        kind: Kind,
        /// What it is written in.
        #[arg(long, value_enum, default_value_t = Lang::Python)]
        lang: Lang,
        /// Of trax: how its server is started.
        #[arg(last = true)]
        command: Vec<String>,
    },
    /// Let a third party's plugin be loaded, as its files are now.
    Allow {
        /// Its file, or the name of one that `honami plugin list` shows.
        plugin: String,
    },
    /// Never load this plugin, also when it is named, and also one that came with honami.
    Deny {
        /// Its file, or the name of one that `honami plugin list` shows.
        plugin: String,
    },
    /// Hold a plugin against what honami asks of all, before anybody relies on it.
    ///
    /// Levels: 1 the file, 2 loading, 3 the ABI, 4 parameters, 5 state, 6 frames, 7 a tracker's truth, 8 a clusterer's,
    /// 9 running (repeatable, any number of threads, stopped at once), 10 stress. Each check has a process of its own;
    /// the level that was reached is kept for this content of the file, and `honami plugin list` shows it.
    ///
    /// A line a level, and in full what has failed or is doubtful; -v gives a line a check. What is installed, but not
    /// allowed yet, may be checked: it is shut in as always. What was denied is not.
    ///
    /// Exit status: 0 passed, 1 a check has failed or none could be done, 2 wrong usage, 3 passed with doubts.
    Check(Check),
    /// Let a plugin start again that has failed three times within ten minutes.
    Retry {
        /// Short name or full id, or its file.
        name: String,
        /// Also let it work in honami's own process again, though honami has ended while it was inside.
        #[arg(long)]
        in_process: bool,
    },
}

#[derive(Args, Debug)]
pub(super) struct Check {
    /// Its file (a shared library, a Python plugin or its manifest), or the name of one that `honami plugin list` shows.
    pub(super) plugin: String,
    /// How far to go.
    #[arg(long, value_name = "1..10", default_value_t = 9, value_parser = clap::value_parser!(u8).range(1..=10))]
    pub(super) level: u8,
    /// Only checks with this in their id.
    #[arg(long, value_name = "TEXT")]
    pub(super) only: Option<String>,
    /// No checks with this in their id.
    #[arg(long, value_name = "TEXT")]
    pub(super) skip: Option<String>,
    /// Seed of every random choice.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Only this plugin of a library that has several.
    #[arg(long, value_name = "ID")]
    pub(super) plugin_id: Option<String>,
    /// Do one check in this very process, for a debugger.
    #[arg(long, value_name = "CHECK:SEED")]
    pub(super) reproduce: Option<String>,
    /// Write the report as JUnit's XML, too.
    #[arg(long, value_name = "FILE")]
    pub(super) junit: Option<PathBuf>,
    /// Answer at standard input: how honami starts its own processes.
    #[arg(long, hide = true, requires = "reproduce")]
    pub(super) answer: bool,
}

/// Languages that a plugin can be begun in.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum Lang {
    Python,
    Rust,
    C,
    Cpp,
    Trax,
}

/// Kinds of plugins that can be begun.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum Kind {
    Tracker,
    Clusterer,
    Structure,
}

/// The frame rate of a movie.
fn movie_rate(text: &str) -> Result<f64, String> {
    let fps = text.parse().ok().filter(|fps| RATES.contains(fps));
    let (least, most) = (Brief(*RATES.start()), Brief(*RATES.end()));
    fps.ok_or_else(|| format!("wanted {least} to {most} frames per second, got {text}"))
}

/// A frame rate.
fn frames_per_second(text: &str) -> Result<f64, String> {
    let fps = text.parse().ok().filter(|fps: &f64| fps.is_finite() && *fps > 0.0);
    fps.ok_or_else(|| format!("wanted frames per second, a number above 0, got {text}"))
}

/// A time.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite());
    seconds.ok_or_else(|| format!("wanted seconds, a number, got {text}"))
}

/// A frequency, or 0 for none.
fn hertz(text: &str) -> Result<f64, String> {
    let hz = text.parse().ok().filter(|hz: &f64| hz.is_finite() && *hz >= 0.0);
    hz.ok_or_else(|| format!("wanted hertz, a number of 0 or more, got {text}"))
}

/// `A..B`, the last one excluded; an open end reaches to the clip's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FrameRange {
    pub(super) start: u32,
    pub(super) end: Option<u32>,
}

impl std::str::FromStr for FrameRange {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("wanted frames as A..B, for instance 0..100 or 50.., got {text}");
        let (a, b) = text.split_once("..").ok_or_else(wanted)?;
        let number = |word: &str| word.parse::<u32>().map_err(|_not_a_number| wanted());
        let start = if a.is_empty() { 0 } else { number(a)? };
        let end = if b.is_empty() { None } else { Some(number(b)?) };
        if end.is_some_and(|end| end <= start) {
            return Err(wanted());
        }
        Ok(Self { start, end })
    }
}

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Region {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl std::str::FromStr for Region {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
        match numbers[..] {
            [x, y, width, height] if width > 0.0 && height > 0.0 && text.matches(',').count() == 3 => {
                Ok(Self { x, y, width, height })
            }
            _ => Err(format!("wanted a rectangle as x,y,w,h in pixels, got {text}")),
        }
    }
}

/// `WxH` in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl std::str::FromStr for Size {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (w, h) = text.split_once('x')?;
            Some(Self { width: w.parse().ok()?, height: h.parse().ok()? })
        };
        parse()
            .filter(|size| (16..=8192).contains(&size.width) && (16..=8192).contains(&size.height))
            .ok_or_else(|| format!("wanted a size as WxH between 16x16 and 8192x8192, got {text}"))
    }
}

/// `NAME=FILE`: somebody else's tracks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Foreign {
    pub(super) name: String,
    pub(super) file: PathBuf,
}

impl std::str::FromStr for Foreign {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, file)) if !name.is_empty() && !file.is_empty() => {
                Ok(Self { name: name.to_owned(), file: PathBuf::from(file) })
            }
            _ => Err(format!("wanted tracks as NAME=FILE, for instance opencv=tracks.csv, got {text}")),
        }
    }
}

/// `3,7,10-19`: numbers and ranges of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Numbers(Vec<std::ops::RangeInclusive<u32>>);

impl Numbers {
    /// As tracks.
    pub(super) fn tracks(&self) -> TrackSet {
        self.numbers().map(TrackId).collect()
    }

    /// One after the other.
    pub(super) fn numbers(&self) -> impl Iterator<Item = u32> {
        self.0.iter().cloned().flatten()
    }
}

impl std::str::FromStr for Numbers {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("wanted numbers as 3,7,10-19, got {text}");
        let range = |word: &str| {
            let (first, last) = word.split_once('-').unwrap_or((word, word));
            let (first, last): (u32, u32) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
            // As many as a project of the largest kind has.
            (first <= last && last - first < 10_000_000).then_some(first..=last)
        };
        text.split(',').map(range).collect::<Option<_>>().map(Self).ok_or_else(wanted)
    }
}

//! What can keep a job from its end.

mod cameras;
pub(crate) mod matte;
mod sensors;
mod space;
mod typed;

use std::ops::Range;
use std::path::PathBuf;

use honami_model::brief::{Brief, counted};
use honami_model::document::RunId;
use honami_model::track::TrackId;

pub use cameras::CamerasError;
pub use sensors::SensorsError;
pub use space::SpaceError;

/// Why a use-case failed: what was wanted, what came, what to do, in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorkbenchError {
    /// The clip could not be read.
    #[error(transparent)]
    Media(#[from] honami_media::MediaError),
    /// The project could not be read or written.
    #[error(transparent)]
    Store(#[from] honami_store::StoreError),
    /// A plugin could not be found, loaded or used.
    #[error(transparent)]
    Plugin(#[from] honami_host::HostError),
    /// A table could not be read or written.
    #[error(transparent)]
    Table(#[from] honami_exchange::TableError),
    /// A file of another program could not be read or written.
    #[error(transparent)]
    Foreign(#[from] honami_exchange::foreign::ForeignError),
    /// A flow could not be read.
    #[error(transparent)]
    Flow(#[from] honami_exchange::flo::FlowError),
    /// A flow is not as large as the clip.
    #[error(
        "the flow is of {}x{} pixels, the clip of {}x{}: is it another pair's? {}",
        came[0], came[1], wanted[0], wanted[1], path.display()
    )]
    FlowSize {
        /// The file.
        path: PathBuf,
        /// Its width and height.
        came: [u32; 2],
        /// Width and height of the clip.
        wanted: [u32; 2],
    },
    /// A flow says nothing of more than two frames.
    #[error(
        "a flow goes from one picture to the next, but there are {n_frames} frames: give two pictures, or --frames A..A+2"
    )]
    FlowFrames {
        /// Frames to compare on.
        n_frames: u32,
    },
    /// A file was made on pictures of another size.
    #[error(
        "{}: made on pictures of {}x{} pixels, the clip has {}x{}: is it another clip's? \
         --size {}x{} scales its positions to the clip",
        path.display(), came[0], came[1], wanted[0], wanted[1], came[0], came[1]
    )]
    PictureSize {
        /// The file.
        path: PathBuf,
        /// Width and height that it names.
        came: [u32; 2],
        /// Width and height of the clip.
        wanted: [u32; 2],
    },
    /// A file has no sample within the clip.
    #[error("{}: no track of points in frames 0..{n_frames} of the clip", path.display())]
    NothingToImport {
        /// The file.
        path: PathBuf,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// No track is among those asked for.
    #[error("none of the tracks or groups asked for is shown")]
    NoSuchTracks,
    /// Tracks could not be compared.
    #[error(transparent)]
    Motion(#[from] honami_motion::MotionError),
    /// There is no spectrum.
    #[error(transparent)]
    Spectrum(#[from] honami_motion::spectrum::SpectrumError),
    /// A table of tracks does not say when its frames were.
    #[error("a spectrum needs the time of every frame: column time_s, no frame left out: {}", path.display())]
    NoTimes {
        /// The table.
        path: PathBuf,
    },
    /// A clip could not be generated.
    #[error(transparent)]
    Synth(#[from] honami_synth::SynthError),
    /// A file could not be read or written.
    #[error("{what}: {source}: {}", path.display())]
    Io {
        /// What was being done.
        what: &'static str,
        /// What the system said.
        source: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// A tracker measures no dense motion.
    #[error("{plugin} was asked for dense motion and offers none: only that of tracks can be shown")]
    NoDense {
        /// Its short name.
        plugin: String,
    },
    /// Components need more than a few tracks and frames.
    #[error(
        "components of motion need at least {} tracks in {} frames, to tell motion from noise; came {n_tracks} tracks in {n_frames} \
         frames",
        crate::components::FEWEST_TRACKS,
        crate::components::FEWEST_FRAMES
    )]
    TooFewToPart {
        /// Number of tracks.
        n_tracks: usize,
        /// Frames in which two or more of them are seen.
        n_frames: usize,
    },
    /// All tracks stand still.
    #[error("nothing moves: {n_tracks} tracks stand still in all {n_frames} frames")]
    Still {
        /// Number of tracks.
        n_tracks: usize,
        /// Number of frames.
        n_frames: usize,
    },
    /// A clip of one frame.
    #[error("nothing moves in a clip of one frame")]
    OneFrame,
    /// There is nothing to track.
    #[error(
        "there are no features to track: place some, give a table of points, or let the tracker find them"
    )]
    NoFeatures,
    /// The tracker does not choose features.
    #[error(
        "{plugin} does not find features itself: track once with a tracker that does, such as the default, \
         and then with {plugin}, which follows the same tracks; or give a table of points (--points)"
    )]
    CannotDetect {
        /// Its name.
        plugin: String,
    },
    /// Frames outside the clip were asked for.
    #[error(
        "frames {start}..{end} were asked for, but the clip has frames 0..{n_frames}: choose among these"
    )]
    Frames {
        /// First frame asked for.
        start: u32,
        /// One past the last.
        end: u32,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// A movie that is too small or too large.
    #[error(
        "a movie is 16 to 8192 pixels wide and high, not {width} x {height}: choose another --size or --scale"
    )]
    MovieSize {
        /// What came, pixels.
        width: f64,
        /// What came, pixels.
        height: f64,
    },
    /// A clip with a frame so long after the one before that its movie would never end.
    #[error(
        "the movie would have {n_frames:.1e} frames, since frame {frame} of the clip is {gap_s:.1e} s after the one before it: choose frames on \
         one side of it (--frames), or give the clip its true rate (honami new --fps)"
    )]
    MovieLength {
        /// Frames of the movie.
        n_frames: f64,
        /// The frame of the clip before which the longest gap is,
        frame: u32,
        /// and that, seconds.
        gap_s: f64,
    },
    /// A point lies outside the clip.
    #[error(
        "point {id} at ({x}, {y}) in frame {frame} is not in the clip of {width}x{height} and {n_frames} frames"
    )]
    Point {
        /// Its number.
        id: u32,
        /// Pixels, right.
        x: f32,
        /// Pixels, down.
        y: f32,
        /// Frame it was given in.
        frame: u32,
        /// Width of the clip.
        width: u32,
        /// Height of the clip.
        height: u32,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// The mask is not as large as the clip.
    #[error("the mask is {}x{} pixels, the clip {}x{}: {}", came.0, came.1, wanted.0, wanted.1, path.display())]
    MaskSize {
        /// Width and height of the clip.
        wanted: (u32, u32),
        /// Width and height of the mask.
        came: (u32, u32),
        /// The mask.
        path: PathBuf,
    },
    /// A mask that is a video.
    #[error("one picture is wanted that says where, and this has {n_frames}: {}", path.display())]
    MaskFrames {
        /// Its frames.
        n_frames: u32,
        /// The mask.
        path: PathBuf,
    },
    /// A mask with nothing to detect in.
    #[error("all of the mask is black: features are detected where it is not: {}", path.display())]
    EmptyMask {
        /// The mask.
        path: PathBuf,
    },
    /// A region with nothing to detect in.
    #[error("no pixel of the clip, {}x{}, lies in the region {x},{y},{w},{h}: features cannot be detected there", of.0, of.1)]
    EmptyRegion {
        /// Pixels, right.
        x: f64,
        /// Pixels, down.
        y: f64,
        /// Width, pixels.
        w: f64,
        /// Height, pixels.
        h: f64,
        /// Width and height of the clip.
        of: (u32, u32),
    },
    /// A hierarchy cannot be cut into that many groups.
    #[error("{} make 1 to {}, not {groups}", counted(*n_tracks, "track"), counted(*n_tracks, "group"))]
    Groups {
        /// Groups asked for.
        groups: u32,
        /// Tracks that can be grouped.
        n_tracks: usize,
    },
    /// There are no tracks.
    #[error("there are no tracks yet: track features first")]
    NoTracks,
    /// There are tracks, and none has a movement.
    #[error("no track is seen in two frames, and tracks are grouped by their movement: track longer")]
    NoMovement,
    /// No clustering is shown.
    #[error("there are no groups yet: cluster the tracks first")]
    NoGroups,
    /// Nothing was judged.
    #[error("no segment was judged yet: `honami PROJECT` opens the queue")]
    NoVerdicts,
    /// No track is seen long enough for a spectrum.
    #[error("no track is seen in enough frames for a spectrum: track longer")]
    TooBrief,
    /// A point has a number that no track may have.
    #[error("point {id}: numbers of points go up to {max}; number them anew")]
    Number {
        /// The number.
        id: u32,
        /// The largest there may be.
        max: u32,
    },
    /// A true position lies beyond the clip.
    #[error(
        "the truth has frame {frame} of point {track}, but the clip has frames 0..{n_frames}: is it another clip's?"
    )]
    TruthFrame {
        /// The point.
        track: u32,
        /// The frame.
        frame: u32,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// A truth ends too early.
    #[error(
        "the truth ends with frame {}, but frames {start}..{wanted} are compared: is it another clip's? \
         --frames {start}..{end} compares as far as it goes", end.saturating_sub(1)
    )]
    TruthEnd {
        /// One past its last frame.
        end: u32,
        /// The first frame that is compared.
        start: u32,
        /// One past the last.
        wanted: u32,
    },
    /// A truth of other frames than a skeleton moves through.
    #[error(
        "the truth has frames {}..{}, and the skeleton moves through {}..{}: no frame is of both, and those are what is compared",
        truth.start, truth.end, grown.start, grown.end
    )]
    TruthApart {
        /// Frames of the truth.
        truth: Range<u32>,
        /// Frames of the skeleton.
        grown: Range<u32>,
    },
    /// A root far off the picture.
    #[error(
        "a root lies in the picture ({width}x{height} pixels) or up to {} pixels off it, not at {},{}: X,Y are right and \
         down from its upper left corner", width.max(height), Brief(*x), Brief(*y)
    )]
    FarRoot {
        /// Pixels, right.
        x: f64,
        /// Pixels, down.
        y: f64,
        /// Of the picture, pixels.
        width: u32,
        /// Of the picture, pixels.
        height: u32,
    },
    /// A true position lies outside the picture.
    #[error(
        "the truth shows point {track} at ({x}, {y}) in frame {frame}, but the clip has {width}x{height} pixels: \
         is it another clip's?"
    )]
    TruthPoint {
        /// The point.
        track: u32,
        /// The frame.
        frame: u32,
        /// Pixels, right.
        x: f64,
        /// Pixels, down.
        y: f64,
        /// Width of the clip.
        width: u32,
        /// Height of the clip.
        height: u32,
    },
    /// The truth names no point that was tracked.
    #[error("the truth shows none of the tracked points after their first frame")]
    NoTruth,
    /// No key-frame says where a re-tracking begins.
    #[error(
        "track {track} has no key-frame in {first}-{last} to track from: set one where the feature is seen"
    )]
    NoAnchor {
        /// The track.
        track: TrackId,
        /// The first frame asked for.
        first: u32,
        /// The last.
        last: u32,
    },
    /// A track was followed up to a key-frame and no further.
    #[error(
        "track {track} was followed as far as {frame} and no further: mark a range of frames beyond it first"
    )]
    Followed {
        /// The track.
        track: TrackId,
        /// The key-frame's frame.
        frame: u32,
    },
    /// The tracker follows a feature into no frame.
    #[error("track {track}: nothing was found from its key-frames, the track stays as it was")]
    LostAtOnce {
        /// The track.
        track: TrackId,
    },
    /// Passes would not meet the key-frames that there are now.
    #[error("track {track} was changed while it was re-tracked: nothing was laid, re-track it again")]
    Changed {
        /// The track.
        track: TrackId,
    },
    /// There is no run to go on with.
    #[error(
        "{}: only a run of a tracker that was stopped or that failed can be gone on with",
        run.map_or_else(|| "no run has ended early".to_owned(), |run| format!("run {run} has not ended early"))
    )]
    NothingToResume {
        /// The run that was asked for.
        run: Option<RunId>,
    },
    /// What a run was asked for is not in the project, or in words that this program does not know.
    #[error(
        "what run {run} was asked for is not kept in the project, or cannot be read: it cannot be gone on with; track again"
    )]
    RequestLost {
        /// The run.
        run: RunId,
    },
    /// No plugin tracks.
    #[error("there is no tracker to track with; see honami plugin list")]
    NoTracker,
    /// A correction cannot be done.
    #[error(transparent)]
    Refused(#[from] honami_model::correct::Refused),
    /// Groups stay as they are.
    #[error(transparent)]
    Regroup(#[from] honami_model::regroup::Refused),
    /// A skeleton stays as it is.
    #[error(transparent)]
    Shape(#[from] honami_model::shape::Refused),
    /// No bone bears these groups and no others.
    #[error("no bone bears {wanted} and nothing else: there are {names}")]
    NoBone {
        /// The groups asked for.
        wanted: String,
        /// The bones there are.
        names: String,
    },
    /// A file of a plant or of a wind could not be read.
    #[error(transparent)]
    PlantFile(#[from] honami_exchange::plant::PlantFileError),
    /// A point cache could not be written.
    #[error(transparent)]
    PointCache(#[from] honami_exchange::plant::PointCacheError),
    /// A plant could not be written with its motion.
    #[error(transparent)]
    Glb(#[from] honami_exchange::plant::GlbError),
    /// Neither a file of a plant nor the name of one.
    #[error(
        "{source_name:?} is no plant: a file whose name ends in .mtg, .swc, .csv, .mat or .honami is wanted, or \
         synth::tree:NODES,SEED of two nodes or more"
    )]
    NoPlant {
        /// As given.
        source_name: String,
    },
    /// A skeleton of a size that nobody has said.
    #[error("the skeleton of a project is in pixels: --unit M says how many metres one of them is")]
    Pixels,
    /// An option for files of other kinds.
    #[error("{option} says nothing of {source_name}: it is for plants in {}", of.join(", "))]
    NoMeaning {
        /// As typed.
        option: &'static str,
        /// Endings of files that it is for.
        of: Vec<String>,
        /// The plant.
        source_name: String,
    },
    /// Drag that air does not have.
    #[error(
        "branches have a drag coefficient of 0 to 10000 in air of 0 to 10000 kg/m3, not of {} in air of {}",
        Brief(*branches), Brief(*density)
    )]
    Drag {
        /// Coefficient.
        branches: f64,
        /// Kilograms per cubic metre.
        density: f64,
    },
    /// A plant cannot become beams.
    #[error(transparent)]
    Beams(#[from] honami_mechanics::BeamsError),
    /// A plant has no such modes.
    #[error(transparent)]
    Modes(#[from] honami_mechanics::ModesError),
    /// A forest cannot be, or does not go on.
    #[error(transparent)]
    Forest(#[from] honami_mechanics::ForestError),
    /// Or not in such details.
    #[error(transparent)]
    Detail(#[from] honami_mechanics::DetailError),
    /// A forest for which there is no room.
    #[error(
        "{copies} copies of {nodes} nodes take {} MB, and there are {}: fewer copies are wanted, or a plant of fewer nodes",
        bytes / 1_000_000, there / 1_000_000
    )]
    Memory {
        /// Of the plant.
        copies: usize,
        /// Of each.
        nodes: usize,
        /// Wanted.
        bytes: usize,
        /// Free.
        there: usize,
    },
    /// Winds for which there is no room.
    #[error(
        "the winds of {copies} copies in {steps} steps a frame take {} MB, and there are {}: fewer copies or --substeps are \
         wanted, or more frames a second",
        bytes / 1_000_000, there / 1_000_000
    )]
    WindMemory {
        /// Of the plant.
        copies: usize,
        /// Of a frame.
        steps: u32,
        /// Wanted.
        bytes: usize,
        /// Free.
        there: usize,
    },
    /// More modes than there are, or than can be found.
    #[error(
        "{asked} modes were asked for, and of this plant {most} can be had: --modes {most} is the greatest number"
    )]
    TooManyModes {
        /// Asked for.
        asked: usize,
        /// Of the plant.
        most: usize,
    },
    /// No shapes of numbers that are none.
    #[error(transparent)]
    Shapes(#[from] honami_mechanics::ShapesError),
    /// Modes for which there is no room.
    #[error(
        "to find {modes} modes of {nodes} nodes of beams takes {} MB, and there are {}: fewer modes are wanted, or a plant of \
         fewer nodes",
        bytes / 1_000_000, there / 1_000_000
    )]
    ModesMemory {
        /// Asked for.
        modes: usize,
        /// Of the beams.
        nodes: usize,
        /// Wanted.
        bytes: usize,
        /// Free.
        there: usize,
    },
    /// A clip for which there is no room.
    #[error(
        "{frames} frames of a plant of {nodes} nodes take {} MB, and there are {}: fewer frames are wanted",
        bytes / 1_000_000, there / 1_000_000
    )]
    FilmMemory {
        /// Of the clip.
        frames: u32,
        /// Of the beams.
        nodes: usize,
        /// Wanted.
        bytes: usize,
        /// Free.
        there: usize,
    },
    /// Files for which there is no room.
    #[error(
        "{}: {:.1} GB would be written there, and {:.1} are free: fewer copies, nodes or frames are wanted",
        path.display(), *bytes as f64 / 1e9, *there as f64 / 1e9
    )]
    Disk {
        /// The file that is too much.
        path: PathBuf,
        /// Wanted in its folder.
        bytes: u64,
        /// Free.
        there: u64,
    },
    /// The system gives no threads.
    #[error(transparent)]
    Threads(#[from] honami_mechanics::ThreadsError),
    /// Or not those for the wind.
    #[error("the system starts no {n} threads: {source}")]
    Pool {
        /// Asked for.
        n: usize,
        /// What it said.
        source: rayon::ThreadPoolBuildError,
    },
    /// Units that nothing is measured in.
    #[error(
        "units are more than 0: not {} m of length, nor {} of diameter to one of length",
        Brief(*unit), Brief(*diameters)
    )]
    Units {
        /// Metres.
        unit: f64,
        /// Of diameter, to one of length.
        diameters: f64,
    },
    /// Leaves that nothing weighs less than.
    #[error(transparent)]
    Leaves(#[from] honami_mechanics::LeavesError),
    /// Frames that do not follow one another.
    #[error(
        "a motion has 0.001 to 100000 frames a second, each of a step or more, and 100000 steps a second at most: of \
         shorter ones single precision loses a hundredth of the damping; not {fps:?} frames of {n_substeps} steps"
    )]
    Pace {
        /// Asked for.
        fps: f64,
        /// Steps a frame.
        n_substeps: u32,
    },
    /// Steps that a method does not bear, though shorter ones.
    #[error("{source}, or --substeps {n_substeps}")]
    Substeps {
        /// The limit.
        source: honami_mechanics::LimitError,
        /// Steps a frame that it bears.
        n_substeps: u32,
    },
    /// Sizes or masses out of all proportion.
    #[error(
        "sizes and masses of copies are spread by 0 to 4, by which they are up to 5 times as much, not by {size:?} and {mass:?}"
    )]
    Spread {
        /// Of sizes.
        size: f64,
        /// Of masses.
        mass: f64,
    },
    /// Copies that stand in one another, or nowhere.
    #[error("copies stand 0.001 to 100000 m apart, not {} m", Brief(*metres))]
    Spacing {
        /// Asked for.
        metres: f64,
    },
    /// Pulled out of all proportion.
    #[error("a plant is pulled by a number of metres from -1000 to 1000, not by {pull:e}")]
    Pull {
        /// Metres.
        pull: f64,
    },
    /// A sensor on no node.
    #[error("there is no node {node}: the beams have nodes 0 to {}, as --beams lists them", there - 1)]
    Sensor {
        /// Asked for.
        node: u32,
        /// Nodes.
        there: usize,
    },
    /// Something faster was asked for than can be seen.
    #[error(
        "nothing above {nyquist_hz} Hz can be seen at {} samples a second: --above is less, not {above_hz} Hz",
        2.0 * nyquist_hz
    )]
    TooFast {
        /// What was asked for, hertz.
        above_hz: f64,
        /// Half the rate, hertz.
        nyquist_hz: f64,
    },
    /// A record cannot be cut into such pieces.
    #[error(transparent)]
    Piece(#[from] crate::densities::PieceError),
    /// Nothing is left of a record between two times.
    #[error("{what}")]
    NothingLeft {
        /// What there is.
        what: String,
    },
    /// A file is no table of series.
    #[error("{}: {what}", path.display())]
    Series {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// No such wind.
    #[error(transparent)]
    Weather(#[from] honami_scene::weather::WeatherError),
    /// No skeleton grows from these tracks.
    #[error(transparent)]
    Structure(#[from] honami_structure::StructureError),
    /// A skeleton stands nowhere.
    #[error(transparent)]
    Skeleton(#[from] honami_model::skeleton::SkeletonError),
    /// A skeleton as large as asked for is none.
    #[error("with {} m a pixel, lengths in metres: {source}; is it the unit?", Brief(*unit))]
    Unit {
        /// Metres of a pixel.
        unit: f64,
        /// What is too large.
        source: honami_model::skeleton::SkeletonError,
    },
    /// Bones that no tube goes along.
    #[error(transparent)]
    Wood(#[from] honami_model::plant::PlantError),
    /// A plant cannot be put onto a skeleton.
    #[error("{}: {source}", path.display())]
    Onto {
        /// The plant.
        path: PathBuf,
        /// Why not.
        source: honami_structure::StructureError,
    },
    /// No plant that a skeleton could carry.
    #[error("plants to carry are read as .glb, .obj, .ply, .mtg, .swc, .csv or .mat, not as {}", path.display())]
    NoCarried {
        /// What was named.
        path: PathBuf,
    },
    /// A plant of nodes without a branch.
    #[error(
        "{}: the branches of a plant are what hangs on its forks, and this one has none: a plant that forks is wanted, or a \
         mesh, which is a branch itself", path.display()
    )]
    NoFork {
        /// The plant.
        path: PathBuf,
    },
    /// Branches for which there is no room.
    #[error(
        "the branches on all bones have {n_vertices} vertices, and {most} are carried at most: branches of fewer are wanted, \
         or fewer groups"
    )]
    TooManyVertices {
        /// On all bones.
        n_vertices: usize,
        /// At most.
        most: usize,
    },
    /// Branches for which there is not that memory.
    #[error(
        "the branches on all bones have {n_vertices} vertices and {n_triangles} triangles, which take {} MB until they are \
         written, and there are {}: branches of fewer are wanted, or fewer groups",
        bytes / 1_000_000, there / 1_000_000
    )]
    BranchesMemory {
        /// On all bones.
        n_vertices: usize,
        /// On all bones.
        n_triangles: usize,
        /// Wanted.
        bytes: usize,
        /// Free.
        there: usize,
    },
    /// A point cache of what has no vertices of its own.
    #[error("a .pc2 moves the vertices of one mesh: --onto takes an .obj or a .ply then")]
    NoVertices,
    /// There is no rig.
    #[error(transparent)]
    Rig(#[from] honami_exchange::skeleton::RigError),
    /// A `.glb` could not be written.
    #[error(transparent)]
    Document(#[from] honami_exchange::glb::DocumentError),
    /// There is no matte of a picture, or of what was painted on it.
    #[error("{source}: {}", path.display())]
    Matte {
        /// The picture, or the marks on it.
        path: PathBuf,
        /// Why.
        source: honami_matting::MattingError,
    },
    /// Cameras are not known.
    #[error(transparent)]
    Cameras(#[from] CamerasError),
    /// Two views do not tell where something is.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// What is kept of mattes.
    #[error(transparent)]
    Kept(#[from] matte::MatteError),
    /// Something is no scale bar.
    #[error(transparent)]
    Scale(#[from] crate::scale::ScaleError),
    /// Tracks and sensors say nothing together.
    #[error(transparent)]
    Sensors(#[from] SensorsError),
    /// A thread of the program has panicked.
    #[error("a fault of the program's own; the session's log has its report")]
    Fault,
    /// The caller stopped a job that keeps nothing.
    #[error("stopped")]
    Stopped,
}

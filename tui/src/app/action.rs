//! Every action of the terminal UI, in one table.
//!
//! The key map, the palette, the help, the hint line and the tests are made from it. A key has one meaning: where
//! it does different things in different places (Enter keeps, runs, goes), it is one action that every place
//! answers in its way.

/// Where keys are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Context {
    /// Looking at the clip and its tracks.
    Review,
    /// Choosing where a new feature goes.
    Place,
    /// Shaping a bone of the skeleton.
    Shape,
    /// Moving a sample.
    Move,
    /// Sliding a sample along its path.
    Slide,
    /// Drawing a track while the clip plays.
    Sketch,
    /// Painting what is plant and what lies behind it.
    Paint,
    /// Setting a scale bar.
    Scale,
    /// Setting the parameters of a plugin.
    Form,
    /// Choosing from a list by typing a part of its name.
    Menu,
    /// Setting which directions of motion are shown.
    Dial,
    /// Typing a number or a name.
    Prompt,
    /// Typing the letters on a track.
    Label,
    /// Going about in the undo tree.
    History,
    /// Choosing what to open, before anything is.
    Start,
    /// Looking at a forest in the wind.
    Forest,
}

impl Context {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Review,
        Self::Place,
        Self::Shape,
        Self::Move,
        Self::Slide,
        Self::Sketch,
        Self::Paint,
        Self::Scale,
        Self::Form,
        Self::Menu,
        Self::Dial,
        Self::Prompt,
        Self::Label,
        Self::History,
        Self::Start,
        Self::Forest,
    ];

    /// Its name in key maps and logs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Review => "review",
            Self::Place => "place",
            Self::Shape => "shape",
            Self::Move => "move",
            Self::Slide => "slide",
            Self::Sketch => "sketch",
            Self::Paint => "paint",
            Self::Scale => "scale",
            Self::Form => "form",
            Self::Menu => "menu",
            Self::Dial => "dial",
            Self::Prompt => "prompt",
            Self::Label => "label",
            Self::History => "history",
            Self::Start => "start",
            Self::Forest => "forest",
        }
    }

    /// Whether letters are text here, so that only other keys are commands.
    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self, Self::Menu | Self::Prompt | Self::Label)
    }
}

/// What the table says of an action.
#[derive(Debug)]
pub struct Info {
    /// The action.
    pub action: Action,
    /// Its name, for the palette, key maps and logs.
    pub name: &'static str,
    /// The keys that call it: each a sequence, keys apart by spaces.
    pub keys: &'static [&'static str],
    /// Where it works, and the word for what it does there. An empty word keeps it off the hint line.
    pub places: &'static [(Context, &'static str)],
    /// What it does, one line.
    pub doc: &'static str,
}

macro_rules! table {
    ($($action:ident $name:literal [$($keys:literal)*] [$($place:ident $word:literal)*] $doc:literal)*) => {
        /// Something a person can do.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Action {
            $(#[doc = $doc] $action,)*
        }

        /// All actions, in the order of help and hints.
        pub const TABLE: &[Info] = &[
            $(Info {
                action: Action::$action,
                name: $name,
                keys: &[$($keys),*],
                places: &[$((Context::$place, $word)),*],
                doc: $doc,
            },)*
        ];
    };
}

table! {
    // Moving about: hjkl and the arrows.
    Left "left" ["h" "Left"] [Review "" Place "1 px" Move "1 px" Form "change" Dial "turn" Slide "1 frame" Sketch "steer" Shape "plane" Forest "round" Paint "go" Scale "1 px"]
        "left: the previous frame, one pixel, or a smaller value; at a bone, its plane 5° back; at a forest, go round it"
    Down "down" ["j" "Down"] [Review "" Place "1 px" Move "1 px" Form "" Menu "" Dial "narrower" History "" Start "" Sketch "steer" Shape "lean" Forest "height" Paint "go" Scale "1 px"]
        "down: the next track, one pixel, or the next row; in the queue, the prints and the skeleton, their next row; at a bone, it leans 5° clockwise; at a forest, go lower"
    Up "up" ["k" "Up"] [Review "" Place "1 px" Move "1 px" Form "" Menu "" Dial "wider" History "" Start "" Sketch "steer" Shape "lean" Forest "height" Paint "go" Scale "1 px"]
        "up: the previous track, one pixel, or the previous row; in the queue, the prints and the skeleton, the row before; at a bone, it leans 5° counterclockwise; at a forest, go higher"
    Right "right" ["l" "Right"] [Review "" Place "1 px" Move "1 px" Form "change" Dial "turn" Slide "1 frame" Sketch "steer" Shape "plane" Forest "round" Paint "go" Scale "1 px"]
        "right: the next frame, one pixel, or a larger value; at a bone, its plane 5° on; at a forest, go round it"
    FineLeft "fine-left" ["H" "Shift-Left"] [Place ".25" Move ".25" Form "" Slide ".25" Sketch "" Shape ".5°" Forest "veer" Paint "1 px" Scale ".25"] "a quarter of a pixel left, or a tenth of a value's range down; at a bone, its plane half a degree back; at a forest, its wind turns 15° counterclockwise from above"
    FineDown "fine-down" ["J" "Shift-Down"] [Place ".25" Move ".25" Sketch "" Shape ".5°" Paint "1 px" Scale ".25"] "a quarter of a pixel down; at a bone, it leans half a degree clockwise"
    FineUp "fine-up" ["K" "Shift-Up"] [Place ".25" Move ".25" Sketch "" Shape ".5°" Paint "1 px" Scale ".25"] "a quarter of a pixel up; at a bone, it leans half a degree counterclockwise"
    FineRight "fine-right" ["L" "Shift-Right"] [Place ".25" Move ".25" Form "" Slide ".25" Sketch "" Shape ".5°" Forest "veer" Paint "1 px" Scale ".25"] "a quarter of a pixel right, or a tenth of a value's range up; at a bone, its plane half a degree on; at a forest, its wind turns 15° clockwise from above"
    Accept "accept" ["Enter"] [Place "place" Move "keep" Form "run" Menu "choose" Prompt "done" Review "accept" Dial "keep" History "go there" Slide "keep" Start "open" Sketch "keep" Shape "keep" Paint "find, keep" Scale "accept"]
        "accept: keep, place, run or go; reviewing: in the prints, go to the line's frame; else the open item; in the skeleton, shape the bone; else open the track's, or make a key-frame"
    Back "back" ["Esc" "Ctrl-c"] [Place "back" Move "back" Form "back" Menu "back" Prompt "back" Label "back" Review "" Dial "back" History "back" Slide "back" Start "" Sketch "back" Shape "back" Forest "" Paint "back" Scale "back"]
        "back: leave what is open, undone; while reviewing, stop the clip, the job or what grows, see the skeleton from the front, give up the range, then the picks, then the two runs"
    // Time.
    PlayPause "play" ["space"] [Review "play" Sketch "" Shape "play" Forest "play"] "play or pause; 200 space: at 200 %, from now on"
    PlayBackwards "play-backwards" ["B"] [Review "" Sketch ""] "play backwards, or pause"
    SlowForward "play-slow" [";"] [Review "" Sketch "play, draw"] "play slowly or pause; 25 ; : at 25 %, from now on"
    SlowBackward "play-slow-backwards" ["'"] [Review "" Sketch ""] "play slowly backwards, or pause"
    Loop "loop" ["b"] [Review ""] "loop round this frame, or stop; 12 b: 12 frames to both sides"
    NextItem "next-item" ["n"] [Review "next"] "open the next item of the queue, at its worst frame; of two runs, go to the next disagreement"
    PreviousItem "previous-item" ["p"] [Review ""] "open the previous item of the queue, or go to the disagreement before"
    WorstFrame "worst-frame" ["w"] [Review ""]
        "open the selected track's item at its worst frame; again, the track's next"
    Bisect "bisect" ["|"] [Review ""] "go half-way between the key-frames around"
    Reject "reject" ["R"] [Review ""] "the open item's track is of no use; on to the next item"
    Later "later" ["E"] [Review ""] "put the open item off; on to the next item"
    StepForward "step" ["."] [Review "" Move "" Slide "" Sketch "put, next" Shape "" Forest "step"] "one frame forward, or so many; while drawing, the point is put down here first"
    StepBack "step-back" [","] [Review "" Move "" Slide "" Sketch "" Shape ""] "one frame back"
    LeapForward "leap" [">"] [Review ""] "ten frames forward"
    LeapBack "leap-back" ["<"] [Review ""] "ten frames back"
    NextKey "next-key-frame" ["]"] [Review "" Move "" Slide "" Sketch ""] "go to the next key-frame of the selected track"
    PreviousKey "previous-key-frame" ["["] [Review "" Move "" Slide "" Sketch ""] "go to the previous key-frame of the selected track"
    GoStart "go-start" ["g s" "Home"] [Review ""] "go to the first frame"
    GoEnd "go-end" ["g e" "End"] [Review ""] "go to the last frame"
    GoFrame "go-frame" ["g f"] [Review ""] "go to a frame by its number (120 g f goes at once)"
    GoTrack "go-track" ["g t" "/"] [Review ""] "find a track by its number or name"
    GoLabel "go-label" ["g l"] [Review ""] "select a track by the letters that appear on it"
    GoKey "go-key-frame" ["g k"] [Review ""] "find a key-frame of the selected track"
    GoPlugin "go-plugin" ["g p"] [Review ""] "find a plugin and open its form"
    GoFile "open" ["g c"] [Review "" Start ""] "find another project or clip and open it"
    Sort "sort-tracks" ["S"] [Review ""] "sort the tracks by doubt, the worst first, or by number"
    // Work.
    MoveSample "move-sample" ["m"] [Review "move"] "move the sample here; it becomes a key-frame"
    CorrectTime "correct-time" ["T"] [Review ""] "slide the sample here along its path: what is right in space but not in time"
    Sketch "sketch" ["s"] [Review ""] "draw the selected track by mouse or arrows while the clip plays, or frame by frame"
    Paint "paint" ["e p"] [Review ""] "paint on this frame what is plant and what lies behind it: features are looked for in the matte that is found of it"
    Pen "pen" ["D"] [Paint "pen"] "put the pen down where it is, so that keys paint, or lift it"
    ScaleBar "scale-bar" ["e b"] [Review ""] "say what a pixel is in metres, by both ends of something in this frame whose length is known"
    RemoveScaleBar "remove-scale-bar" ["d b"] [Review ""] "take the scale bar away: what a pixel is in metres is not known then"
    WalkForward "walk" [")"] [Move ""] "walk one sample on along the path, while the picture stays"
    WalkBack "walk-back" ["("] [Move ""] "walk one sample back along the path, while the picture stays"
    Pin "pin" ["*"] [Review "" Move "end here"] "make the sample here, or walked to while moving, a key-frame as it is; a correction ends there"
    AddFeature "add-feature" ["a"] [Review "add"] "add a feature by hand"
    Range "range" ["r"] [Review "end"] "begin a range of frames here, or end it here; what marks and deletes works on it"
    MarkLost "mark-lost" ["x"] [Review "lost"] "the feature is lost: in the range, else from here to the next key-frame"
    MarkOccluded "mark-occluded" ["o"] [Review "occluded"] "the feature is hidden: in the range, else in this frame"
    MarkOutside "mark-outside" ["O"] [Review ""] "the feature is outside the picture: in the range, else in this frame"
    DeleteRange "delete-range" ["d r"] [Review "take away"] "take the samples of the range away (u brings them back)"
    DeleteTrack "delete-track" ["d d"] [Review ""] "delete the picked tracks, else the selected one (u brings them back)"
    Pick "pick-track" ["y"] [Review ""] "pick the selected track, or no longer: what marks and deletes works on all picked"
    PickGroup "pick-group" ["Y"] [Review ""] "pick the selected track's group, or no longer"
    Split "split-track" ["e s"] [Review ""] "cut the selected track in two: from here on it is a new one"
    Swap "swap-tracks" ["e x"] [Review ""] "exchange the selected track with another: in the range, else from here on"
    Join "join-tracks" ["e j"] [Review ""] "fill the selected track with another, which is deleted"
    Duplicate "duplicate-track" ["e d"] [Review ""] "make a new track like the selected one"
    Average "average-tracks" ["e a"] [Review "average"] "make a new track in the middle of the picked ones"
    TakeA "take-a" ["e A"] [Review "take A"] "keep what A of the two runs found: in the range, else in the disagreement that is open, else all of it; key-frames stay"
    TakeB "take-b" ["e B"] [Review "take B"] "keep what B of the two runs found: in the range, else in the disagreement that is open, else all of it; key-frames stay"
    NameTrack "name-track" ["e n"] [Review ""] "name the selected track"
    ClearKey "clear-key-frame" ["X" "d k"] [Review ""] "clear the key-frame here (u brings it back)"
    Erase "erase" ["Backspace"] [Menu "" Prompt "" Sketch "take back" Paint "take back" Scale "take back"] "take back a typed letter, the stroke drawn or painted last, or what was set last of a scale bar"
    EraseLine "erase-line" ["Ctrl-u"] [Menu "" Prompt ""] "empty the line that is being typed"
    RetrackBoth "retrack-both" ["t t"] [Review "re-track"] "track again from the key-frames on both sides, and blend"
    RetrackForward "retrack-forward" ["t f"] [Review ""] "track again from the key-frame here or before, up to the next"
    RetrackBackward "retrack-backward" ["t b"] [Review ""] "track again from the key-frame here or after, down to the one before"
    RunTracker "track" ["t r"] [Review "track"] "follow features with a tracker"
    GoOn "go-on" ["!"] [Review "go on"]
        "go on with a run that has ended early, with its tracker as it is now; let one start again that has failed too often"
    WaitOn "wait-on" ["W"] [Review ""] "wait for a plugin that gives no sign of life"
    EndPlugin "end-plugin" ["I"] [Review ""] "end the process of a plugin that gives no sign of life; another goes on where it was"
    RunClusterer "cluster" ["c"] [Review "cluster"] "group the tracks by their movement"
    MoreGroups "more-groups" ["+" "="] [Review "" Dial "gain" Sketch "step" Shape "gain" Forest "wind" Paint "width"] "one group more; at the dial, more gain; while drawing, a step twice as large; while painting, a brush a pixel wider; at a bone, it swings a tenth more; at a forest, a wind a quarter stronger"
    FewerGroups "fewer-groups" ["-"] [Review "" Dial "gain" Sketch "step" Shape "gain" Forest "wind" Paint "width"] "one group fewer; at the dial, less gain; while drawing, a step half as large; while painting, a brush a pixel narrower; at a bone, it swings a tenth less; at a forest, a wind that much weaker"
    MergeGroups "merge-groups" ["G m"] [Review ""] "merge the selected track's group with another: they stay one wherever the cut is"
    SplitGroup "split-group" ["G s"] [Review ""] "split the selected track's group in two, as it was merged"
    TakeIntoGroup "take-into-group" ["G t"] [Review ""] "take the picked tracks, else the selected one, into another group"
    NameGroup "name-group" ["G n"] [Review ""] "name the selected track's group"
    ReleaseGroups "release-groups" ["G r"] [Review ""] "forget the groups made by hand: they are those of the cut again"
    Wind "wind" ["i"] [Forest "other"] "type another wind, as honami simulate takes it"
    Skeleton "skeleton" ["v k" "G g"] [Review "skeleton"] "grow the skeleton of the groups and show it over the picture, or not"
    Window "window" ["v w"] [Review ""] "open the viewer's window on the skeleton, in step with the terminal; or close it"
    PlaceRoot "place-root" ["G p"] [Review ""] "place the root of the skeleton by hand: where the plant leaves the ground"
    ReleaseSkeleton "release-skeleton" ["G R"] [Review ""] "forget what was done to the skeleton by hand: it is as it grows again"
    ShapeBone "shape-bone" ["G b"] [Review ""] "shape the chosen bone of the skeleton by hand: its plane, how it leans, how far it swings"
    OrbitLeft "orbit-left" ["{"] [Review "go round" Shape "go round" Forest ""] "see the skeleton from 15° further round the plant, clockwise from above; the picture is left out; at a forest, go round it"
    OrbitRight "orbit-right" ["}"] [Review "go round" Shape "go round" Forest ""] "see the skeleton from 15° further round the plant, counterclockwise from above; the picture is left out; at a forest, go round it"
    Front "front-view" ["V"] [Review "" Shape "" Forest "front"] "see the skeleton from the front again, over the picture; a forest as it was seen at first"
    Undo "undo" ["u"] [Review ""] "undo: take the last edit back"
    Redo "redo" ["Ctrl-r"] [Review ""] "redo: do again what was undone"
    // Looking.
    ZoomIn "zoom-in" ["z"] [Review "" Place "" Move "" Slide "" Sketch "" Shape "" Forest "zoom" Paint "" Scale ""] "look closer, at the selected track or the cursor"
    ZoomOut "zoom-out" ["Z"] [Review "" Place "" Move "" Slide "" Sketch "" Shape "" Forest "zoom" Paint "" Scale ""] "look from farther away"
    PanLeft "pan-left" ["Ctrl-Left"] [Review "" Place "" Move "" Shape "" Paint "" Scale ""] "look a quarter of the view further left; a tenth of a pixel while placing or moving"
    PanDown "pan-down" ["Ctrl-Down"] [Review "" Place "" Move "" Shape "" Paint "" Scale ""] "look a quarter of the view further down; a tenth of a pixel while placing or moving"
    PanUp "pan-up" ["Ctrl-Up"] [Review "" Place "" Move "" Shape "" Paint "" Scale ""] "look a quarter of the view further up; a tenth of a pixel while placing or moving"
    PanRight "pan-right" ["Ctrl-Right"] [Review "" Place "" Move "" Shape "" Paint "" Scale ""] "look a quarter of the view further right; a tenth of a pixel while placing or moving"
    Centre "centre" ["C"] [Review ""] "bring the selected track to the middle"
    Follow "follow" ["f"] [Review ""] "keep the selected track in the middle, or not"
    MotionColours "motion" ["v v"] [Review ""] "show motion in colours: hue is direction, strength is speed; or not"
    MotionGainUp "motion-gain-up" ["v +"] [Review ""] "stronger colours of motion"
    MotionGainDown "motion-gain-down" ["v -"] [Review ""] "weaker colours of motion"
    MotionDial "motion-dial" ["v d"] [Review ""] "choose the directions of motion that are shown"
    MotionSource "motion-source" ["v f"] [Review ""] "show motion everywhere in the picture, if a tracker measures it"
    Versus "two-runs" ["A"] [Review ""] "show two runs over the picture, A and B, joined where they differ; or not"
    VersusFlick "flick-runs" ["F"] [Review "flick"] "of two runs beside each other show A, B, or both"
    VersusRuns "choose-runs" ["v a"] [Review ""] "choose the two runs that are shown beside each other"
    Marks "marks" ["M"] [Review ""] "mark all tracks in the picture, or only the selected one"
    Column "next-panel" ["Tab"] [Review "" Move "model" Paint "brush"] "show the next panel beside the picture, after the last none; while moving, offer the next correction: its error is that at key-frames left out; while painting, the next brush"
    PanelQueue "panel-queue" ["P q"] [Review ""] "show or hide the queue of doubtful segments"
    PanelTracks "panel-tracks" ["P t"] [Review ""] "show or hide the tracks"
    PanelGroups "panel-groups" ["P g"] [Review ""] "show or hide the groups"
    PanelSkeleton "panel-skeleton" ["P s"] [Review "bones"] "show or hide the bones of the skeleton; j and k choose one, Enter shapes it"
    PanelKeyFrames "panel-key-frames" ["P k"] [Review ""] "show or hide the key-frames of the selected track"
    PanelPlots "panel-plots" ["P p"] [Review ""] "show or hide curves: position, speed, quality, sway"
    PlotGroup "plot-group" ["P G"] [Review ""] "plot the selected track's group, or the track"
    WidePanel "panel-wide" ["P w"] [Review ""] "show the panel over all of the picture, or beside it"
    PanelVersus "panel-two-runs" ["P a"] [Review ""] "show or hide how two runs disagree"
    PanelPrints "panel-prints" ["P o"] [Review ""] "show or hide what plugins print and log"
    PanelLog "panel-log" ["P l"] [Review ""] "show or hide the log of this session"
    SaveLog "save-log" ["P L"] [Review ""] "save the log of this session beside the project; `honami replay` does it again"
    Glyphs "glyphs" ["v q"] [Review "" Forest "finer"] "show the picture in half blocks, quadrants, sextants or octants (what the font has)"
    Stills "stills" ["v s"] [Review ""] "show a picture that stays in the terminal's own pixels, or not"
    NextTheme "next-theme" ["v t"] [Review ""] "change the colours: the next theme"
    Mouse "mouse" ["v m"] [Review ""] "leave the mouse to the terminal, for selecting text, or take it back"
    History "history" ["U" "P u"] [Review "" History ""] "show the undo tree; j and k choose an edit there, Enter goes to it"
    Palette "palette" [":"] [Review "" Place "" Move "" Form "" Dial "" History "" Slide "" Sketch "" Shape "" Forest "" Paint "" Scale ""] "find any action by name, key or what it does"
    Help "help" ["?"] [Review "help" Place "" Move "" Form "help" Dial "help" History "help" Slide "" Sketch "help" Shape "help" Forest "help" Paint "help" Scale "help"] "list what works here; Enter does it"
    Tutorial "tutorial" ["g ?"] [Review ""] "five minutes on a generated clip: what to press, one step at a time"
    Redraw "redraw" ["Ctrl-l"] [Review "" Place "" Move "" Form "" Menu "" Prompt "" Dial "" Label "" History "" Slide "" Start "" Sketch "" Shape "" Forest "" Paint "" Scale ""] "paint the screen anew"
    Suspend "suspend" ["Ctrl-z"] [Review "" Place "" Move "" Form "" Menu "" Prompt "" Dial "" Label "" History "" Slide "" Start "" Sketch "" Shape "" Forest "" Paint "" Scale ""] "stop honami until `fg`"
    Quit "quit" ["q"] [Review "leave" Place "" Move "" Form "" Dial "" History "" Slide "" Start "leave" Sketch "" Shape "" Forest "leave" Paint "" Scale ""] "back; while reviewing and at a forest, leave honami"
    Leave "leave" ["Q"] [Review "" Place "" Move "" Form "" Dial "" History "" Slide "" Start "" Sketch "" Shape "" Forest "" Paint "" Scale ""] "leave honami (everything is kept; what is open is asked about first)"
}

impl Action {
    /// Its row of the table.
    #[must_use]
    pub fn info(self) -> &'static Info {
        // The table is made with the enum, in its order.
        &TABLE[self as usize]
    }

    /// The word for what it does in a place; `None` where it does not work.
    #[must_use]
    pub fn word_in(self, context: Context) -> Option<&'static str> {
        self.info().places.iter().find(|(place, _)| *place == context).map(|(_, word)| *word)
    }
}

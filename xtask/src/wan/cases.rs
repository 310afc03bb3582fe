//! What is measured: which link, which program, through what, before which terminal.

/// One session over one link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) link: Shape,
    pub(super) size: (u16, u16),
    pub(super) program: Program,
    pub(super) through: Through,
    /// How the terminal answers queries.
    pub(super) answers: &'static str,
    pub(super) clip: Clip,
}

/// A link: rate each way and delay there and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) mbit: f64,
    pub(super) rtt_ms: f64,
    /// How both ends' TCP decides how much may be on its way, as Linux calls it.
    pub(super) congestion: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Program {
    /// honami on a project without tracks.
    Honami,
    /// honami on a project of 10,000 tracks: only its start is measured.
    ManyTracks,
    /// The same picture drawn by ratatui's own backend, every key one draw.
    Plain,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Through {
    Ssh,
    /// `ssh -C`.
    Compressed,
    /// tmux at the far end of ssh.
    Tmux,
    Mosh,
}

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clip {
    /// A generated shrub in a storm.
    Storm,
    /// A real clip, where there is a data folder.
    Leaves,
}

const SLOW: Shape = Shape { mbit: 2.0, rtt_ms: 80.0, congestion: "cubic" };
const SLOWER: Shape = Shape { mbit: 1.0, rtt_ms: 150.0, congestion: "cubic" };
const FAIR: Shape = Shape { mbit: 20.0, rtt_ms: 40.0, congestion: "cubic" };
/// As fast as the emulator carries.
const UNSHAPED: Shape = Shape { mbit: 10_000.0, rtt_ms: 0.0, congestion: "cubic" };
const SMALL: (u16, u16) = (80, 24);
const LARGE: (u16, u16) = (120, 36);

const MAIN: Case = Case {
    name: "2mbit_80ms_80x24",
    link: SLOW,
    size: SMALL,
    program: Program::Honami,
    through: Through::Ssh,
    answers: "normal",
    clip: Clip::Storm,
};

pub(super) const ALL: &[Case] = &[
    MAIN,
    Case { name: "2mbit_80ms_80x24_leaves", clip: Clip::Leaves, ..MAIN },
    Case { name: "2mbit_80ms_120x36", size: LARGE, ..MAIN },
    Case { name: "2mbit_80ms_120x36_leaves", size: LARGE, clip: Clip::Leaves, ..MAIN },
    // Every ten seconds it lets next to nothing through for 200 ms, to measure the delay anew.
    Case { name: "2mbit_80ms_80x24_bbr", link: Shape { congestion: "bbr", ..SLOW }, ..MAIN },
    Case { name: "2mbit_80ms_80x24_compressed", through: Through::Compressed, ..MAIN },
    Case { name: "2mbit_80ms_80x24_tmux", through: Through::Tmux, ..MAIN },
    Case { name: "2mbit_80ms_80x24_mosh", through: Through::Mosh, ..MAIN },
    Case { name: "2mbit_80ms_80x24_silent", answers: "silent", ..MAIN },
    Case { name: "2mbit_80ms_80x24_slow", answers: "slow", ..MAIN },
    Case { name: "2mbit_80ms_80x24_lying", answers: "lying", ..MAIN },
    Case { name: "1mbit_150ms_80x24", link: SLOWER, ..MAIN },
    Case { name: "1mbit_150ms_80x24_leaves", link: SLOWER, clip: Clip::Leaves, ..MAIN },
    Case { name: "20mbit_40ms_80x24", link: FAIR, ..MAIN },
    Case { name: "unshaped_80x24", link: UNSHAPED, ..MAIN },
    Case { name: "2mbit_80ms_10k_tracks", program: Program::ManyTracks, ..MAIN },
    Case { name: "unshaped_10k_tracks", program: Program::ManyTracks, link: UNSHAPED, ..MAIN },
    Case { name: "plain_2mbit_80ms_80x24", program: Program::Plain, ..MAIN },
    Case { name: "plain_2mbit_80ms_80x24_mosh", program: Program::Plain, through: Through::Mosh, ..MAIN },
    Case { name: "plain_unshaped_80x24", program: Program::Plain, link: UNSHAPED, ..MAIN },
];

impl Case {
    /// Peak signal to noise ratio from which a paint counts, dB.
    pub(super) fn db(&self) -> f64 {
        if self.size == SMALL { 35.0 } else { 30.0 }
    }
}

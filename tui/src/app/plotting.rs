//! Curves worked out behind the screen: one lot at a time, and of those asked for meanwhile only the newest.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use honami_workbench::plots::{self, Plots};

use super::plotted::{PlotRequest, Subject};
use crate::term::signals::Waker;

type Lot = ((Subject, u64), Arc<Plots>);

/// What is being worked out.
pub(super) struct Plotting {
    waker: Waker,
    running: Option<(JoinHandle<Lot>, Arc<AtomicBool>)>,
    next: Option<PlotRequest>,
}

impl Plotting {
    pub(super) fn new(waker: Waker) -> Self {
        Self { waker, running: None, next: None }
    }

    /// Works these out next.
    pub(super) fn ask(&mut self, request: PlotRequest) -> std::io::Result<()> {
        self.next = Some(request);
        self.go_on()
    }

    /// What has been worked out; a panic was reported where it happened, and gives nothing.
    pub(super) fn news(&mut self) -> std::io::Result<Option<Lot>> {
        let done = self.running.take_if(|(_, ended)| ended.load(Ordering::Acquire));
        let lot = done.and_then(|(running, _)| running.join().ok());
        self.go_on()?;
        Ok(lot)
    }

    fn go_on(&mut self) -> std::io::Result<()> {
        if self.running.is_none()
            && let Some(PlotRequest { subject, tracks, times }) = self.next.take()
        {
            let ended = Arc::new(AtomicBool::new(false));
            let at_end = self.waker.at_end(&ended);
            let work = move || {
                let _wake = at_end;
                (subject, Arc::new(plots::of(&tracks, &times)))
            };
            let thread = std::thread::Builder::new().name("plots".to_owned()).spawn(work)?;
            self.running = Some((thread, ended));
        }
        Ok(())
    }
}

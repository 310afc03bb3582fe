//! Work behind the screen, one piece at a time; of those asked for meanwhile only the newest is done.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use crate::term::signals::Waker;

type Piece<T> = Box<dyn FnOnce() -> T + Send>;

/// What is being worked out, and what is next.
pub(super) struct Behind<T> {
    name: &'static str,
    waker: Waker,
    running: Option<(JoinHandle<T>, Arc<AtomicBool>)>,
    next: Option<Piece<T>>,
}

impl<T: Send + 'static> Behind<T> {
    /// Nothing yet; `name` is that of its threads.
    pub(super) fn new(name: &'static str, waker: Waker) -> Self {
        Self { name, waker, running: None, next: None }
    }

    /// Does this next.
    pub(super) fn ask(&mut self, work: impl FnOnce() -> T + Send + 'static) -> std::io::Result<()> {
        self.next = Some(Box::new(work));
        self.go_on()
    }

    /// Whether anything is being worked out.
    pub(super) fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// What has been worked out; a panic was reported where it happened, and gives nothing.
    pub(super) fn news(&mut self) -> std::io::Result<Option<T>> {
        let done = self.running.take_if(|(_, ended)| ended.load(Ordering::Acquire));
        let result = done.and_then(|(running, _)| running.join().ok());
        self.go_on()?;
        Ok(result)
    }

    /// Waits for what is being worked out, which nobody wants any more.
    pub(super) fn end(&mut self) {
        self.next = None;
        // A panic was reported where it happened.
        self.running.take().into_iter().for_each(|(running, _)| drop(running.join()));
    }

    fn go_on(&mut self) -> std::io::Result<()> {
        if self.running.is_none()
            && let Some(work) = self.next.take()
        {
            let ended = Arc::new(AtomicBool::new(false));
            let at_end = self.waker.at_end(&ended);
            let work = move || {
                let _wake = at_end;
                work()
            };
            let thread = std::thread::Builder::new().name(self.name.to_owned()).spawn(work)?;
            self.running = Some((thread, ended));
        }
        Ok(())
    }
}

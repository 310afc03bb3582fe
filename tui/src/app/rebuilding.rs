//! The files of plugins, looked after while a project is open: one that was rebuilt is read anew.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Instant;

use honami_workbench::plugins::{PluginInfo, Trust, Watch};
use honami_workbench::rebuilt::LOOK_EVERY;

use crate::term::signals::Waker;

/// Looks after files on a thread of its own, which ends when this is dropped.
pub(super) struct Rebuilding {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    is_news: AtomicBool,
    stop: AtomicBool,
}

impl Rebuilding {
    /// Begins; `None` where there are no plugins but those that came with honami, or no thread can be had.
    pub(super) fn start(plugins: &[PluginInfo], waker: Waker) -> Option<Self> {
        let others = plugins.iter().filter(|plugin| plugin.trust != Trust::Shipped);
        let files: BTreeMap<_, Watch> =
            others.map(|plugin| (plugin.library.clone(), Watch::of(plugin))).collect();
        if files.is_empty() {
            return None;
        }
        let (shared, watched) = (Arc::<Shared>::default(), files.into_values().collect());
        let theirs = Arc::clone(&shared);
        let work = move || watch(watched, &theirs, &waker);
        let thread = std::thread::Builder::new().name("rebuilding".to_owned()).spawn(work).ok()?;
        Some(Self { shared, thread: Some(thread) })
    }

    /// Whether a file is another one than when this was asked last.
    pub(super) fn is_news(&self) -> bool {
        self.shared.is_news.swap(false, Ordering::Relaxed)
    }
}

impl Drop for Rebuilding {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // One that has panicked has told so itself.
            thread.join().ok();
        }
    }
}

fn watch(mut files: Vec<Watch>, shared: &Shared, waker: &Waker) {
    // What is there now was read a moment ago.
    files.iter_mut().for_each(Watch::know);
    while !shared.stop.load(Ordering::Relaxed) {
        let now = Instant::now();
        // All are looked at: each keeps count of its own changes.
        if files.iter_mut().filter_map(|file| file.look(now).then_some(())).count() > 0 {
            shared.is_news.store(true, Ordering::Relaxed);
            waker.wake();
        }
        std::thread::park_timeout(LOOK_EVERY);
    }
}

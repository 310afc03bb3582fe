//! Plugins that are built again while they are at work: noticed, started behind the run, compared with the build before.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use honami_host::{CallContext, Flow, Host, HostError, Origin, Patience, PluginInfo, Tracker, Values, Watch};
use honami_store::Build;

use crate::progress::Progress;

mod beside;

pub use beside::Difference;
pub(crate) use beside::{Beside, Found, Stretch};

/// How often a plugin's file is looked at. A look asks a file system that may be on another machine.
pub const LOOK_EVERY: Duration = Duration::from_millis(250);

/// A build of a plugin, and what trackers are made of it with.
#[derive(Clone, Debug)]
pub(crate) struct Made {
    pub(crate) plugin: PluginInfo,
    pub(crate) params: Values,
    pub(crate) origin: Origin,
}

impl Made {
    /// Starts a tracker.
    pub(crate) fn start(
        host: &Host,
        plugin: PluginInfo,
        params: Values,
        cx: &CallContext<'_>,
    ) -> Result<(Tracker, Self), HostError> {
        let (tracker, origin) = host.tracker(&plugin, &params, cx)?;
        Ok((tracker, Self { plugin, params, origin }))
    }

    /// Starts a tracker of the same plugin as its file is now, with the same values.
    pub(crate) fn start_anew(&self, host: &Host, cx: &CallContext<'_>) -> Result<(Tracker, Self), HostError> {
        let plugin = self.plugin.again()?;
        let params = plugin.values_of(&self.plugin, &self.params)?;
        Self::start(host, plugin, params, cx)
    }

    /// Starts another tracker of this build, whatever has become of its file.
    pub(crate) fn start_again(
        &self,
        host: &Host,
        cx: &CallContext<'_>,
    ) -> Result<(Tracker, Self), HostError> {
        Self::start(host, host.kept(&self.plugin, &self.origin), self.params.clone(), cx)
    }

    pub(crate) fn build(&self) -> Build {
        let Origin { plugin_version, plugin_sha256, .. } = &self.origin;
        Build { version: plugin_version.clone(), sha256: plugin_sha256.clone() }
    }

    /// Whether its file is still the one that it was made from.
    pub(crate) fn is_in_its_file(&self) -> bool {
        self.plugin.sha256().is_ok_and(|sha256| sha256 == self.origin.plugin_sha256)
    }

    /// Whether both are of the same content.
    pub(crate) fn is(&self, other: &Self) -> bool {
        self.origin.plugin_sha256 == other.origin.plugin_sha256
    }
}

/// A tracker of a rebuilt file.
pub(crate) struct Ready {
    pub(crate) tracker: Tracker,
    pub(crate) made: Made,
}

/// Looks after the file of a plugin while it is at work, on a thread of its own: neither a slow file system nor the start
/// of another build keeps the run waiting.
pub(crate) struct Lookout {
    host: Host,
    first: Made,
    ready: Mutex<Option<Ready>>,
    stop: AtomicBool,
}

impl Lookout {
    /// For a run that began with this build.
    pub(crate) fn new(host: Host, first: Made) -> Self {
        Self { host, first, ready: Mutex::default(), stop: AtomicBool::new(false) }
    }

    /// Does some work while the file is looked after; what becomes of it is told.
    pub(crate) fn during<R>(&self, progress: &dyn Progress, work: impl FnOnce() -> R) -> R {
        /// Ends the watch also where the work panics.
        struct Relieved<'a>(&'a AtomicBool, Option<thread::Thread>);
        impl Drop for Relieved<'_> {
            fn drop(&mut self) {
                self.0.store(true, Ordering::Relaxed);
                self.1.iter().for_each(thread::Thread::unpark);
            }
        }
        thread::scope(|scope| {
            let watch = thread::Builder::new()
                .name("rebuilt".to_owned())
                .spawn_scoped(scope, || self.watch(progress));
            // Where no thread can be had the run goes on, with the build that it has.
            let thread = watch.ok().map(|watch| watch.thread().clone());
            let _watching = Relieved(&self.stop, thread);
            work()
        })
    }

    /// The newest build that is ready, once.
    pub(crate) fn take(&self) -> Option<Ready> {
        self.ready().take()
    }

    fn ready(&self) -> MutexGuard<'_, Option<Ready>> {
        self.ready.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self, progress: &dyn Progress) {
        let mut watch = Watch::of(&self.first.plugin);
        if !self.host.works_apart(&self.first.plugin) {
            // Nobody builds what came with honami meanwhile; its content need not be read again.
            watch.know();
        }
        let mut last = self.first.origin.plugin_sha256.clone();
        let name = &self.first.plugin.short_name;
        while !self.stop.load(Ordering::Relaxed) {
            if watch.look(Instant::now())
                && let Ok(sha256) = self.first.plugin.sha256()
                && sha256 != last
            {
                last = sha256;
                match self.start(progress) {
                    Ok(ready) => {
                        let build = ready.made.build();
                        *self.ready() = Some(ready);
                        progress.say(&format!("{name} was rebuilt: {build} takes over at the next frame"));
                    }
                    Err(_) if self.stop.load(Ordering::Relaxed) => {}
                    Err(error) => {
                        progress.say(&format!("{name} was rebuilt, and the build before goes on: {error}"));
                    }
                }
            }
            thread::park_timeout(LOOK_EVERY);
        }
    }

    fn start(&self, progress: &dyn Progress) -> Result<Ready, HostError> {
        let plugin = &self.first.plugin;
        if !self.host.works_apart(plugin) {
            let what = "it works in honami's own process, where nothing can take its place; HONAMI_HOSTING=isolated gives \
                        it one of its own"
                .to_owned();
            return Err(HostError::Usage { plugin: plugin.id.clone(), what });
        }
        let watch = |_: f64, _: &str| match self.stop.load(Ordering::Relaxed) {
            true => Flow::Stop,
            false => Flow::Continue,
        };
        let cx = CallContext {
            progress: &watch,
            log: &|level, text| progress.hear(&plugin.short_name, None, level, text),
            silent: &|_| Patience::Usual,
        };
        let (tracker, made) = self.first.start_anew(&self.host, &cx)?;
        Ok(Ready { tracker, made })
    }
}

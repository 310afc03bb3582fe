//! Winds that are worked out beside the window, one at a time; of those asked for meanwhile only the newest is.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread::Builder;

use anyhow::anyhow;
use honami_mechanics::wind::Wind;
use honami_scene::ForestScene;
use honami_scene::forest::live;
use honami_scene::weather::{Typed, WeatherError};

use super::knobs::Winds;
use crate::forest::MOST_BYTES;

/// What is to blow.
pub(super) struct Asked {
    /// As the knobs have it.
    pub(super) winds: Winds,
    /// It, read.
    pub(super) typed: Typed,
    /// Whether it begins when it blows; or else goes on, with other values.
    pub(super) begins: bool,
}

/// What came of it.
pub(super) struct Made {
    pub(super) winds: Winds,
    pub(super) begins: bool,
    pub(super) wind: anyhow::Result<Box<dyn Wind>>,
}

type Blown = Result<Box<dyn Wind>, WeatherError>;

/// A wind at work.
struct Running {
    winds: Winds,
    begins: bool,
    made: Receiver<Blown>,
}

/// Winds over what stands in a scene.
pub(super) struct Making {
    scene: Arc<ForestScene>,
    /// Called when one is there.
    wake: Arc<dyn Fn() + Send + Sync>,
    running: Option<Running>,
    next: Option<Asked>,
}

impl Making {
    pub(super) fn new(scene: Arc<ForestScene>, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { scene, wake, running: None, next: None }
    }

    pub(super) fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// Works this out next.
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub(super) fn ask(&mut self, asked: Asked) -> io::Result<()> {
        let begins = asked.begins || self.next.as_ref().is_some_and(|next| next.begins);
        self.next = Some(Asked { begins, ..asked });
        self.go_on()
    }

    /// What has been worked out, if it is.
    ///
    /// # Errors
    /// Where the system has no thread left for the next.
    pub(super) fn news(&mut self) -> io::Result<Option<Made>> {
        let Some(running) = &self.running else { return Ok(None) };
        let wind = match running.made.try_recv() {
            Ok(wind) => wind.map_err(anyhow::Error::from),
            Err(TryRecvError::Disconnected) => Err(anyhow!("the wind was stopped by a fault of its own")),
            Err(TryRecvError::Empty) => return Ok(None),
        };
        let made = self.running.take().map(|Running { winds, begins, .. }| Made { winds, begins, wind });
        self.go_on()?;
        Ok(made)
    }

    fn go_on(&mut self) -> io::Result<()> {
        if self.running.is_none()
            && let Some(Asked { winds, typed, begins }) = self.next.take()
        {
            let (tell, made) = sync_channel(1);
            let (scene, wake) = (Arc::clone(&self.scene), Arc::clone(&self.wake));
            let work = move || {
                // Nobody left to hear it: the window has closed, or shows another scene.
                tell.send(live::over(&scene, &typed, MOST_BYTES)).unwrap_or_default();
                wake();
            };
            Builder::new().name("wind".to_owned()).spawn(work)?;
            self.running = Some(Running { winds, begins, made });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    //! What is worked out of what was asked for.

    use super::{Asked, Made, Making};
    use crate::app::forest::knobs::Winds;
    use std::sync::Arc;

    fn next(making: &mut Making) -> Made {
        loop {
            if let Some(made) = making.news().unwrap() {
                return made;
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn of_winds_asked_for_meanwhile_the_newest_is_worked_out() {
        let mut making = Making::new(Arc::new(crate::testing::forest(40, 3, 1)), Arc::new(|| {}));
        let cases = [("steady", true), ("storm", true), ("storm:seed=2", false), ("air:cell=0.01", false)];
        for (n, wanted) in [(1, &[("steady", true)][..]), (3, &[("steady", true), ("storm:seed=2", true)])] {
            for (words, begins) in &cases[..n] {
                let winds = Winds::typed(words);
                making.ask(Asked { typed: winds.read().unwrap(), winds, begins: *begins }).unwrap();
            }
            for (words, begins) in wanted {
                let made = next(&mut making);
                assert!(made.wind.is_ok() && made.winds == Winds::typed(words), "{words}");
                assert_eq!(made.begins, *begins, "{words}: what was typed begins, however it was turned");
            }
            assert!(!making.is_busy() && making.news().unwrap().is_none());
        }
        // What cannot be is told when it has been tried.
        let winds = Winds::typed(cases[3].0);
        making.ask(Asked { typed: winds.read().unwrap(), winds, begins: true }).unwrap();
        let error = next(&mut making).wind.err().unwrap().to_string();
        assert!(error.contains("a larger cell, or less time"), "{error}");
    }
}

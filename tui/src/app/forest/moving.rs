//! The thread that moves a forest and draws it.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use honami_workbench::plant::sway::free;
use honami_workbench::scene::forest::live::{self, Live, LiveError};
use honami_workbench::scene::{ForestScene, Orbit, raster};

use super::Shot;
use crate::app::behind::Behind;
use crate::term::signals::Waker;

/// A forest that cannot keep pace goes on more slowly, by so many seconds a picture at most.
const MOST_S: f64 = 0.25;

/// What is to be seen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Order {
    pub(super) orbit: Orbit,
    pub(super) wind: String,
    /// How many winds have been typed: each begins anew, one that keys turn goes on.
    pub(super) n_typed: u32,
    /// Pixels, across and down,
    pub(super) size: [u32; 2],
    /// and how many down if they were square.
    pub(super) n_square: u32,
    pub(super) is_playing: bool,
    pub(super) n_steps: u32,
}

/// A forest in the hands of a thread.
pub(super) struct Worker {
    live: Arc<Mutex<Option<Live>>>,
    scene: Arc<ForestScene>,
    drawing: Behind<(Result<Shot, String>, String)>,
    is_busy: bool,
    /// What was asked for last, and when.
    last: Option<(Order, Duration)>,
    /// Seconds that the forest is to have come to.
    clock: f64,
    /// The wind that blows.
    wind: String,
}

impl Worker {
    pub(super) fn new(scene: ForestScene, waker: Waker) -> Self {
        let wind = scene.wind.clone();
        Self {
            live: Arc::new(Mutex::new(None)),
            scene: Arc::new(scene),
            drawing: Behind::new("forest", waker),
            is_busy: false,
            last: None,
            clock: 0.0,
            wind,
        }
    }

    pub(super) fn is_busy(&self) -> bool {
        self.is_busy
    }

    pub(super) fn wind(&self) -> &str {
        &self.wind
    }

    /// Whether a picture would be another than the last.
    pub(super) fn wants(&self, order: &Order) -> bool {
        order.is_playing || order.n_steps > 0 || self.last.as_ref().is_none_or(|(last, _)| last != order)
    }

    /// Has a picture drawn, of as much later as it is since the last.
    pub(super) fn ask(&mut self, order: Order, now: Duration) -> std::io::Result<()> {
        let since = self.last.as_ref().map_or(0.0, |(last, then)| {
            if last.is_playing { now.saturating_sub(*then).as_secs_f64().min(MOST_S) } else { 0.0 }
        });
        let begins = self.last.as_ref().is_some_and(|(last, _)| last.n_typed != order.n_typed);
        let played = if order.is_playing { since } else { 0.0 };
        self.clock += played + f64::from(order.n_steps) * self.scene.pace.step;
        self.last = Some((Order { n_steps: 0, ..order.clone() }, now));
        self.is_busy = true;
        let (live, scene, wind) = (Arc::clone(&self.live), Arc::clone(&self.scene), self.wind.clone());
        let until = self.clock;
        self.drawing.ask(move || draw(&live, &scene, (wind, begins), &order, until))
    }

    /// What has been drawn, or why nothing was.
    pub(super) fn news(&mut self) -> std::io::Result<Option<Result<Shot, String>>> {
        let Some((shot, wind)) = self.drawing.news()? else {
            if self.is_busy && !self.drawing.is_busy() {
                self.is_busy = false;
                return Ok(Some(Err("drawing was stopped by a fault of its own".to_owned())));
            }
            return Ok(None);
        };
        (self.is_busy, self.wind) = (false, wind);
        Ok(Some(shot))
    }
}

/// Goes on until a time, seconds, and draws; what it says is wrong with a wind leaves the one that blows. What is ordered begins
/// anew, or is the same wind with other values.
fn draw(
    live: &Mutex<Option<Live>>,
    scene: &Arc<ForestScene>,
    (mut wind, begins): (String, bool),
    order: &Order,
    until: f64,
) -> (Result<Shot, String>, String) {
    let mut live = live.lock().unwrap_or_else(PoisonError::into_inner);
    let drawn = (|| {
        let live = match &mut *live {
            Some(live) => live,
            none => {
                let n_threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
                none.insert(Live::new(Arc::clone(scene), n_threads, free())?)
            }
        };
        if begins {
            live.blow(&order.wind)?;
        } else if order.wind != wind {
            live.turn(live::wind(scene, &order.wind, free())?);
        }
        wind.clone_from(&order.wind);
        (0..steps_until(until, live.time(), scene.pace.step)).try_for_each(|_| live.step())?;
        let (time, blowing) = (live.time(), live.blowing(0));
        let camera = order.orbit.camera();
        let grove = live.grove().clone();
        let square = [order.size[0], order.n_square];
        let seen = live.seen(&camera, square)?;
        let pixels = squeezed(raster::forest(scene, &grove, &seen, &camera, square), square, order.size[1]);
        Ok(Shot { size: order.size, pixels, time, wind: blowing.into() })
    })();
    (drawn.map_err(|error: LiveError| error.to_string()), wind)
}

/// Whole steps from a time to another: what is left of one is there the next time.
fn steps_until(until: f64, time: f64, step: f64) -> u32 {
    ((until - time) / step + 1e-6).floor().max(0.0) as u32
}

/// The same picture in so many rows: each the mean of what it covers.
fn squeezed(pixels: Vec<[u8; 3]>, [width, height]: [u32; 2], n_rows: u32) -> Vec<[u8; 3]> {
    if n_rows == height {
        return pixels;
    }
    let rows: Vec<&[[u8; 3]]> = pixels.chunks_exact(width as usize).collect();
    let by = f64::from(height) / f64::from(n_rows);
    let mean = |row: u32, x: usize| {
        let (from, to) = (f64::from(row) * by, f64::from(row + 1) * by);
        let mut sum = [0.0; 3];
        for (k, own) in rows.iter().enumerate().take(to.ceil() as usize).skip(from as usize) {
            let share = (to.min(k as f64 + 1.0) - from.max(k as f64)).max(0.0) / by;
            sum = std::array::from_fn(|c| sum[c] + share * f64::from(own[x][c]));
        }
        sum.map(|v| v.round() as u8)
    };
    (0..n_rows)
        .flat_map(|row| (0..width as usize).map(move |x| (row, x)))
        .map(|(row, x)| mean(row, x))
        .collect()
}

#[cfg(test)]
mod tests {
    //! Winds that go on or begin, rows that become fewer, and steps.

    use super::{Arc, Mutex, Order, draw, squeezed, steps_until};
    use crate::app::forest::tests::copies;

    /// A squall that has come is twice as strong where its speed is; one that is typed is still on its way.
    #[test]
    fn a_wind_that_keys_turn_goes_on_and_one_that_is_typed_begins() {
        let scene = Arc::new(copies(1, "squall"));
        let blowing = |then: &str, begins: bool| {
            let live = Mutex::new(None);
            let speed_at = |wind: &str, begins: bool, until: f64| {
                let (orbit, wind) = (scene.orbit, wind.to_owned());
                let (size, n_square) = ([4, 4], 4);
                let order = Order { orbit, wind, n_typed: 0, size, n_square, is_playing: true, n_steps: 0 };
                let (shot, _) = draw(&live, &scene, ("squall".to_owned(), begins), &order, until);
                shot.unwrap().wind[0]
            };
            assert!(speed_at("squall", false, 0.0) < 1.0, "it is on its way");
            [speed_at("squall", false, 6.0), speed_at(then, begins, 6.0)]
        };
        let [before, then] = blowing("squall:speed=30", false);
        assert!(before > 14.0 && (then - 2.0 * before).abs() < 1e-9, "{before} {then}");
        let [before, then] = blowing("squall", true);
        assert!(before > 14.0 && then < 1.0, "{before} {then}");
    }

    /// A hundred pictures, 50 ms apart, take five seconds, however long a step is.
    #[test]
    fn no_part_of_a_step_is_lost() {
        for step in [0.01, 0.04, 0.1, 0.2] {
            let (mut n, mut clock) = (0, 0.0);
            for _ in 0..100 {
                clock += 0.05;
                n += steps_until(clock, f64::from(n) * step, step);
            }
            assert_eq!(n, (5.0_f64 / step).round() as u32, "steps of {step} s");
        }
    }

    #[test]
    fn rows_are_means_of_what_they_cover() {
        let grey = |v: u8| [v; 3];
        let four = vec![grey(4), grey(36), grey(60), grey(120)];
        for (n, wanted) in
            [(4, vec![4, 36, 60, 120]), (2, vec![20, 90]), (1, vec![55]), (3, vec![12, 48, 105])]
        {
            let wanted: Vec<[u8; 3]> = wanted.into_iter().map(grey).collect();
            assert_eq!(squeezed(four.clone(), [1, 4], n), wanted);
        }
    }
}

//! How far two clocks are apart: by what moves alike, or by a flash that both recorded.

use crate::CameraError;

pub use views::{Movement, by_movements};

mod views;

/// A value over time: of a track along one axis, or of a sensor.
#[derive(Clone, Copy, Debug)]
pub struct Signal<'a> {
    /// Seconds, growing.
    pub times_s: &'a [f64],
    /// One value each.
    pub values: &'a [f64],
}

/// How far two clocks are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// What happened at t by the first clock happened at `t + seconds` by the second.
    pub seconds: f64,
    /// Its standard error.
    pub error_s: f64,
    /// Correlation of both over the time that they share, -1..=1; of a flash, how much of the step the noise leaves, 0..=1.
    pub alike: f64,
    /// Another offset, far from it, at which both are nearly as alike: of what sways evenly, a whole swing away.
    pub rival_s: Option<f64>,
}

/// An offset that was tried.
#[derive(Clone, Copy, Debug)]
struct Tried {
    seconds: f64,
    alike: f64,
    /// Samples that were compared.
    n: usize,
}

impl Tried {
    /// The part of the movement that is not alike; no less than reading between samples leaves.
    fn unlike(&self) -> f64 {
        (1.0 - self.alike * self.alike).max(1e-6)
    }

    /// Logarithm of how likely it is beside chance, but for a factor: many samples that are alike say more than few.
    fn evidence(&self) -> f64 {
        -(self.n as f64) * self.unlike().ln()
    }
}

/// The most likely of the offsets that were tried, in their order, and its rival; `None` where none is so much alike.
fn best_of(tried: &[Tried], strangers: f64) -> Option<(Tried, Option<f64>)> {
    /// What a rival leaves unlike, of what the best leaves.
    const NEARLY: f64 = 4.0;
    let peaks = (0..tried.len()).filter(|&k| {
        let is_over = |other: Option<&Tried>| other.is_none_or(|other| tried[k].alike >= other.alike);
        is_over(k.checked_sub(1).and_then(|k| tried.get(k))) && is_over(tried.get(k + 1))
    });
    let peaks: Vec<Tried> = peaks.map(|k| tried[k]).filter(|tried| tried.alike >= strangers).collect();
    let by_evidence = |a: &&Tried, b: &&Tried| a.evidence().total_cmp(&b.evidence());
    let best = *peaks.iter().max_by(by_evidence)?;
    let is_rival = |other: &&Tried| {
        (other.seconds - best.seconds).abs() > f64::EPSILON && other.unlike() <= NEARLY * best.unlike()
    };
    let rival = peaks.iter().filter(is_rival).max_by(by_evidence);
    Some((best, rival.map(|rival| rival.seconds)))
}

/// Fewer samples than this say nothing.
const FEWEST: usize = 16;
/// Less alike than this, two signals are strangers.
const STRANGERS: f64 = 0.5;
/// Steps of Gauss and Newton; they need three.
const STEPS: usize = 20;

/// The offset, of at most `most_s` either way, at which the second signal is most likely the first, times a gain of either sign and
/// shifted: by how much they are alike, and over how many samples.
///
/// Both are compared over at least half of the shorter one, at the first one's times; the second is read between its samples
/// by cubics. The error is that of a least squares fit, with as many independent samples as the remainder's own correlation
/// leaves.
///
/// # Errors
/// [`CameraError::Signal`] of signals that are too short, not finite or whose times do not grow; [`CameraError::Strangers`] where nothing is
/// alike, as where one stands still; [`CameraError::AtTheEnd`] where the best offset is the largest that was allowed.
pub fn by_movement(first: Signal<'_>, second: Signal<'_>, most_s: f64) -> Result<Offset, CameraError> {
    first.check()?;
    second.check()?;
    let step = first.step_s().min(second.step_s()) / 2.0;
    let n = n_steps(&first, &second, most_s, step);
    let shortest = first.len_s().min(second.len_s());
    let tried = (-n..=n).map(|k| k as f64 * step).filter_map(|offset| {
        let together = first.beside(second, offset, shortest / 2.0)?;
        Some(Tried { seconds: offset, alike: together.fit()?.alike.abs(), n: together.mine.len() })
    });
    let (best, rival_s) = best_of(&tried.collect::<Vec<_>>(), STRANGERS).ok_or(CameraError::Strangers)?;
    let (start, mut offset) = (best.seconds, best.seconds);
    for _ in 0..STEPS {
        let fit = first
            .beside(second, offset, 0.0)
            .and_then(|together| together.fit())
            .ok_or(CameraError::Strangers)?;
        offset = (offset + fit.step_s).clamp(start - 2.0 * step, start + 2.0 * step);
        if fit.step_s.abs() < 1e-9 * step {
            break;
        }
    }
    let fit = first
        .beside(second, offset, 0.0)
        .and_then(|together| together.fit())
        .ok_or(CameraError::Strangers)?;
    let found = Offset { seconds: offset, error_s: fit.error_s, alike: fit.alike, rival_s };
    if is_beyond(start, offset, n, step) { Err(CameraError::AtTheEnd { offset: found }) } else { Ok(found) }
}

/// Steps of the search either way: no more than signals can be apart and still be of the same times.
fn n_steps(first: &Signal<'_>, second: &Signal<'_>, most_s: f64, step_s: f64) -> i64 {
    let [a, b] = [first.times_s, second.times_s];
    let farthest = (b[b.len() - 1] - a[0]).abs().max((b[0] - a[a.len() - 1]).abs());
    (most_s.min(farthest) / step_s).ceil().max(1.0) as i64
}

/// Whether what was best at the end of the search, `start`, is better yet beyond it, at `seconds`.
fn is_beyond(start: f64, seconds: f64, n: i64, step_s: f64) -> bool {
    let is_end = (start / step_s).round().abs() >= n as f64;
    is_end && seconds.abs() > start.abs() + 0.9 * step_s
}

/// When a lamp was switched on: the time of the greatest step up of a region's brightness, to a part of a frame.
///
/// Frame k gathers light from `times_s[k]` for `exposure` of a frame's length (0..=1; 1 where it is not known): if a frame's brightness
/// lies between that before and that after, the lamp was lit for that part of the exposure. Where no frame does, it was
/// switched on while the shutter was closed, and the error says how long that is. `rounded` is the standard error that values about
/// some brightness have from being kept as whole numbers: an even lamp in a clean clip has no other noise.
///
/// # Errors
/// [`CameraError::Signal`] as [`by_movement`]; [`CameraError::NoFlash`] where no step stands out of the noise fivefold.
pub fn flash_s(
    brightness: Signal<'_>,
    exposure: f64,
    rounded: impl Fn(f64) -> f64,
) -> Result<(f64, f64), CameraError> {
    /// A step is so many times the noise.
    const OUTSTANDING: f64 = 5.0;
    /// Frames before and after that tell the levels.
    const LEVEL: usize = 8;
    brightness.check()?;
    let (times, values) = (brightness.times_s, brightness.values);
    let n = values.len();
    let level = |frames: std::ops::Range<usize>| {
        let mut sorted = values[frames].to_vec();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted[sorted.len() / 2];
        let off: Vec<f64> = sorted.iter().map(|v| (v - middle).powi(2)).collect();
        (middle, off.iter().sum::<f64>() / (off.len() - 1) as f64)
    };
    // A step over two frames, as one of them may be half lit; its first frame is the last that is dark.
    let steps = (2..n - 3).map(|k| (values[k + 2] - values[k], k));
    let Some((_, dark)) = steps.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) else {
        return Err(CameraError::NoFlash);
    };
    let (before, noise_before) = level((dark + 1).saturating_sub(LEVEL)..dark + 1);
    let (after, noise_after) = level(dark + 2..(dark + 2 + LEVEL).min(n));
    let (rise, noise) = (after - before, f64::midpoint(noise_before, noise_after).sqrt());
    if rise <= OUTSTANDING * noise {
        return Err(CameraError::NoFlash);
    }
    let frame = dark + 1;
    let length = times[frame + 1] - times[frame];
    let open = exposure.clamp(0.0, 1.0) * length;
    let lit = ((values[frame] - before) / rise).clamp(0.0, 1.0);
    let coarse = [before, after, values[frame]].map(rounded).into_iter().fold(0.0, f64::max);
    let unsure = noise.hypot(coarse) / rise;
    let closed = length - open;
    // A shutter that never closes leaves no doubt between frames.
    let (start, error) = if closed <= 0.0 || (lit > 3.0 * unsure && lit < 1.0 - 3.0 * unsure) {
        (times[frame] + open * (1.0 - lit), open * unsure)
    } else {
        // Not lit at all: between this frame's exposure and the next; lit all the time: between the one before and this.
        let opens = if lit < 0.5 { times[frame + 1] } else { times[frame] };
        (opens - closed / 2.0, (closed / 12.0_f64.sqrt()).hypot(open * unsure))
    };
    Ok((start, error))
}

impl Signal<'_> {
    fn check(&self) -> Result<(), CameraError> {
        let is_whole = self.times_s.len() == self.values.len() && self.values.len() >= FEWEST;
        let is_finite = self.times_s.iter().chain(self.values).all(|v| v.is_finite());
        let grows = self.times_s.windows(2).all(|pair| pair[1] > pair[0]);
        if is_whole && is_finite && grows {
            return Ok(());
        }
        Err(CameraError::Signal { fewest: FEWEST, times: self.times_s.len(), values: self.values.len() })
    }

    fn len_s(&self) -> f64 {
        self.times_s[self.times_s.len() - 1] - self.times_s[0]
    }

    fn step_s(&self) -> f64 {
        self.len_s() / (self.times_s.len() - 1) as f64
    }

    /// This signal, and the other one so much later, at this one's times; `None` where they share less than this time.
    fn beside(&self, other: Signal<'_>, offset_s: f64, least_s: f64) -> Option<Together> {
        let mut together =
            Together { mine: Vec::new(), theirs: Vec::new(), slopes: Vec::new(), step_s: self.step_s() };
        let mut span = (f64::INFINITY, f64::NEG_INFINITY);
        for (&t, &value) in self.times_s.iter().zip(self.values) {
            if let Some((theirs, slope)) = other.at(t + offset_s) {
                together.mine.push(value);
                together.theirs.push(theirs);
                together.slopes.push(slope);
                span = (span.0.min(t), span.1.max(t));
            }
        }
        (together.mine.len() >= FEWEST && span.1 - span.0 >= least_s).then_some(together)
    }

    /// Value and slope between samples, of two at least: the cubic whose slopes at samples are those of the parabolas through their
    /// neighbours. `None` before the first and after the last.
    #[must_use]
    pub fn at(&self, t: f64) -> Option<(f64, f64)> {
        let (times, values) = (self.times_s, self.values);
        let n = times.len();
        if !(times[0]..=times[n - 1]).contains(&t) {
            return None;
        }
        let i = times.partition_point(|&time| time <= t).clamp(1, n - 1) - 1;
        let rate = |i: usize| (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
        let slope = |i: usize| match i {
            0 => rate(0),
            _ if i == n - 1 => rate(n - 2),
            _ => {
                let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
                (rate(i - 1) * after + rate(i) * before) / (before + after)
            }
        };
        let h = times[i + 1] - times[i];
        let u = (t - times[i]) / h;
        let (a, b, da, db) = (values[i], values[i + 1], slope(i) * h, slope(i + 1) * h);
        let (c2, c3) = (3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db);
        Some((a + u * (da + u * (c2 + u * c3)), (da + u * (2.0 * c2 + u * 3.0 * c3)) / h))
    }
}

/// Two signals at the same times.
struct Together {
    mine: Vec<f64>,
    theirs: Vec<f64>,
    slopes: Vec<f64>,
    step_s: f64,
}

struct Fit {
    alike: f64,
    step_s: f64,
    error_s: f64,
}

impl Together {
    /// `mine ≈ gain · theirs(t + offset) + shift`, and the step of the offset that brings it closer; `None` where one stands still.
    fn fit(&self) -> Option<Fit> {
        let n = self.mine.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (mine, theirs, slope) = (mean(&self.mine), mean(&self.theirs), mean(&self.slopes));
        let (mut mm, mut mt, mut tt) = (0.0, 0.0, 0.0);
        for (m, t) in self.mine.iter().zip(&self.theirs) {
            let (m, t) = (m - mine, t - theirs);
            (mm, mt, tt) = (mm + m * m, mt + m * t, tt + t * t);
        }
        let alike = mt / (mm * tt).sqrt();
        let gain = mt / tt;
        if !(alike.is_finite() && gain.abs() > 0.0) {
            return None;
        }
        // What the slope has beside the signal itself: gain and shift are free.
        let along: f64 =
            self.slopes.iter().zip(&self.theirs).map(|(s, t)| (s - slope) * (t - theirs)).sum::<f64>() / tt;
        let (mut ss, mut sr, mut rr, mut next, mut last) = (0.0, 0.0, 0.0, 0.0, None);
        for ((m, t), s) in self.mine.iter().zip(&self.theirs).zip(&self.slopes) {
            let left = (m - mine) - gain * (t - theirs);
            let own = gain * ((s - slope) - along * (t - theirs));
            (ss, sr, rr) = (ss + own * own, sr + own * left, rr + left * left);
            next += last.map_or(0.0, |last: f64| last * left);
            last = Some(left);
        }
        if ss <= 0.0 {
            return None;
        }
        // What is left is not independent from sample to sample; of a correlation c there are (1 - c) / (1 + c) as many.
        let c = (next / rr.max(f64::MIN_POSITIVE)).clamp(0.0, 0.99);
        let variance = rr / (n - 3.0) * (1.0 + c) / (1.0 - c);
        // Rounding leaves nothing: a millionth of a sample is as good as exact.
        let error_s = (variance / ss).sqrt().max(1e-6 * self.step_s);
        Some(Fit { alike, step_s: sr / ss, error_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::staged::Noise;

    /// A sway of two tones that dies away, and another push.
    fn sway(t: f64) -> f64 {
        let push = |since: f64| if since < 0.0 { 0.0 } else { (-0.4 * since).exp() * (since * 7.0).sin() };
        push(t - 0.5) + 0.6 * push(t - 3.1) + 0.2 * (t * 2.3).sin()
    }

    fn sampled(fps: f64, n: usize, clock_s: f64, gain: f64, noise: &mut Noise) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..n).map(|k| k as f64 / fps).collect();
        let values = times.iter().map(|t| gain * sway(t - clock_s) + 3.0 + noise.draw()).collect();
        (times, values)
    }

    fn signal((times_s, values): &(Vec<f64>, Vec<f64>)) -> Signal<'_> {
        Signal { times_s, values }
    }

    #[test]
    fn movement_tells_the_offset_to_a_part_of_a_frame() {
        // The second's clock is ahead by 0.4137 s; it is a sensor with another rate, unit and sign.
        for (fps, gain) in [(25.0, 1.0), (40.0, -120.0), (60.0, 0.3)] {
            let first = sampled(25.0, 250, 0.0, 1.0, &mut Noise::new(1, 0.0));
            let second = sampled(fps, (fps * 9.0) as usize, 0.4137, gain, &mut Noise::new(2, 0.0));
            let found = by_movement(signal(&first), signal(&second), 2.0).unwrap();
            assert!((found.seconds - 0.4137).abs() < 0.002, "{fps} fps: {found:?}");
            assert!(found.alike * gain.signum() > 0.99, "{found:?}");
        }
    }

    #[test]
    fn errors_of_offsets_are_those_of_many_trials() {
        let (mut squares, mut told, n) = (0.0, 0.0, 100);
        for seed in 0..n {
            let first = sampled(25.0, 250, 0.0, 1.0, &mut Noise::new(seed, 0.1));
            let second = sampled(30.0, 300, 0.2, 1.0, &mut Noise::new(1000 + seed, 0.02));
            let found = by_movement(signal(&first), signal(&second), 1.0).unwrap();
            squares += (found.seconds - 0.2).powi(2);
            told += found.error_s.powi(2);
        }
        let ratio = (squares / told).sqrt();
        assert!((0.7..1.4).contains(&ratio), "{ratio}");
    }

    #[test]
    fn strangers_and_what_stands_still_are_named() {
        let first = sampled(25.0, 250, 0.0, 1.0, &mut Noise::new(1, 0.0));
        let still = (first.0.clone(), vec![4.0; 250]);
        let mut noise = Noise::new(9, 1.0);
        let stranger = (first.0.clone(), (0..250).map(|_| noise.draw()).collect());
        for other in [still, stranger] {
            assert_eq!(by_movement(signal(&first), signal(&other), 1.0), Err(CameraError::Strangers));
        }
        let short = (first.0[..9].to_vec(), first.1[..9].to_vec());
        assert!(matches!(
            by_movement(signal(&short), signal(&first), 1.0),
            Err(CameraError::Signal { values: 9, .. })
        ));
        let back = (first.0.iter().rev().copied().collect(), first.1.clone());
        assert!(matches!(by_movement(signal(&first), signal(&back), 1.0), Err(CameraError::Signal { .. })));
    }

    /// Brightness of frames that gather light for a part of their length, of a lamp that is lit at a time.
    fn lamp(fps: f64, exposure: f64, lit_s: f64, noise: &mut Noise) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..60).map(|k| f64::from(k) / fps).collect();
        let open = exposure / fps;
        let value = |t: &f64| 20.0 + 100.0 * ((t + open - lit_s) / open).clamp(0.0, 1.0) + noise.draw();
        let values = times.iter().map(value).collect();
        (times, values)
    }

    #[test]
    fn an_offset_beyond_the_search_is_not_told() {
        let times: Vec<f64> = (0..400).map(|k| f64::from(k) / 25.0).collect();
        let moved = |t: f64| (2.0 * t).sin() + 0.6 * (3.7 * t + 0.4).sin() + 0.3 * (0.9 * t * t / 8.0).cos();
        let first: Vec<f64> = times.iter().map(|&t| moved(t)).collect();
        let second: Vec<f64> = times.iter().map(|&t| moved(t - 0.2)).collect();
        let of = |most_s| {
            let signals = [&first, &second].map(|values| Signal { times_s: &times, values });
            by_movement(signals[0], signals[1], most_s)
        };
        assert!((of(0.5).unwrap().seconds - 0.2).abs() < 1e-3);
        assert!((of(0.2).unwrap().seconds - 0.2).abs() < 1e-3);
        assert!(matches!(of(0.1), Err(CameraError::AtTheEnd { .. })), "{:?}", of(0.1));
    }

    #[test]
    fn a_flash_tells_its_time_to_a_part_of_a_frame() {
        for exposure in [1.0, 0.5, 0.2] {
            for k in 0..40 {
                let lit = 1.0 + f64::from(k) * 0.0031;
                let frames = lamp(25.0, exposure, lit, &mut Noise::new(k as u64, 1.0));
                let (found, error) = flash_s(signal(&frames), exposure, |_| 0.0).unwrap();
                // Uniform where the shutter was closed: never beyond √3 of its standard deviation.
                assert!((found - lit).abs() < 4.5 * error, "{exposure}, {lit}: {found} ± {error}");
                let most = if exposure < 1.0 { 0.04 * (1.0 - exposure) / 3.4 + 1e-3 } else { 0.002 };
                assert!(error < most, "{error}");
            }
        }
        // A clean lamp that is kept as whole numbers: twenty levels of brightness, thirty times.
        for k in 0..30 {
            let lit = 1.0 + f64::from(k) * 0.0013;
            let (times, values) = lamp(25.0, 1.0, lit, &mut Noise::new(0, 0.0));
            let values: Vec<f64> = values.into_iter().map(|v| (v / 5.0).round()).collect();
            let (found, error) = flash_s(signal(&(times, values)), 1.0, |_| 0.29).unwrap();
            assert!((found - lit).abs() < 4.8 * error && error < 0.002, "{lit}: {found} ± {error}");
        }
    }

    #[test]
    fn where_nothing_flashes_it_is_said() {
        let mut noise = Noise::new(3, 1.0);
        let frames = ((0..60).map(f64::from).collect(), (0..60).map(|_| noise.draw()).collect());
        assert_eq!(flash_s(signal(&frames), 1.0, |_| 0.0), Err(CameraError::NoFlash));
        let even = ((0..60).map(f64::from).collect(), vec![5.0; 60]);
        assert_eq!(flash_s(signal(&even), 1.0, |_| 0.0), Err(CameraError::NoFlash));
    }
}

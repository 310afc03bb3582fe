//! The link's model against simulated links.

use super::*;

/// A link with one queue: bytes per second, and delay there and back.
struct Wire {
    rate: f64,
    delay: Duration,
    free: Duration,
}

/// What holding a key for some seconds comes to.
#[derive(Debug)]
struct Outcome {
    frames_per_s: f64,
    /// Longest time from sending to answer.
    worst: Duration,
    budget: usize,
    window: usize,
    goodput: f64,
}

/// Sends as much as the model allows for `seconds`, on a wire.
fn play(rate: f64, delay_ms: u64, seconds: u64) -> Outcome {
    let mut link = Link::default();
    let mut wire = Wire { rate, delay: Duration::from_millis(delay_ms), free: Duration::ZERO };
    let mut answers: VecDeque<(Duration, Duration)> = VecDeque::new();
    let (mut n_frames, mut worst) = (0, Duration::ZERO);
    let mut now = Duration::ZERO;
    // The first thing sent is a short probe, as in the program.
    let mut probe = Some(60);
    let warm_up = Duration::from_secs(2);
    while now < Duration::from_secs(seconds) {
        while answers.front().is_some_and(|&(at, _)| at <= now) {
            let Some((at, sent)) = answers.pop_front() else { break };
            link.answered(at);
            if at > warm_up {
                n_frames += 1;
                worst = worst.max(at - sent);
            }
        }
        link.check(now);
        if link.next_slot(now).is_some_and(|slot| slot <= now) {
            let size = probe.take().unwrap_or_else(|| link.budget_at(now));
            link.sent(now, size);
            let begin = wire.free.max(now + wire.delay / 2);
            wire.free = begin + Duration::from_secs_f64(size as f64 / wire.rate);
            answers.push_back((wire.free + wire.delay / 2, now));
        }
        now += Duration::from_millis(1);
    }
    Outcome {
        frames_per_s: f64::from(n_frames) / (seconds - warm_up.as_secs()) as f64,
        worst,
        budget: link.budget(),
        window: link.window(),
        goodput: link.goodput().unwrap_or(0.0),
    }
}

#[test]
fn frames_fit_the_link() {
    // Rate in B/s, delay in ms; at least so many frames per second, each on screen within so many ms.
    for (rate, delay, frames, within_ms) in [
        (235e3, 80, 24.0, 160),  // 2 Mbit/s
        (118e3, 150, 20.0, 250), // 1 Mbit/s
        (2.3e6, 40, 30.0, 70),   // 20 Mbit/s
        (60e3, 80, 20.0, 200),   // 0.5 Mbit/s
        (100e6, 0, 50.0, 5),     // the same machine
        (30e3, 600, 10.0, 1000), // a satellite
    ] {
        let outcome = play(rate, delay, 70);
        eprintln!("{rate:>9} B/s {delay:>3} ms: {outcome:?}");
        assert!(outcome.frames_per_s >= frames, "{rate} B/s, {delay} ms: {outcome:?}");
        assert!(outcome.worst <= Duration::from_millis(within_ms), "{rate} B/s, {delay} ms: {outcome:?}");
    }
}

#[test]
fn goodput_is_measured_within_a_tenth() {
    let outcome = play(235e3, 80, 10);
    assert!((outcome.goodput / 235e3 - 1.0).abs() < 0.1, "{outcome:?}");
    assert!((7500..9000).contains(&outcome.budget) && outcome.window == 4, "{outcome:?}");
}

#[test]
fn a_silent_terminal_gets_a_fixed_rate_until_it_speaks() {
    let mut link = Link::default();
    let (mut now, mut n_bytes) = (Duration::ZERO, 0);
    while now < Duration::from_secs(12) {
        link.check(now);
        if link.next_slot(now).is_some_and(|slot| slot <= now) {
            let size = link.budget();
            link.sent(now, size);
            n_bytes += size;
        }
        now += Duration::from_millis(1);
    }
    assert!(link.is_silent());
    assert!((600_000..680_000).contains(&n_bytes), "{n_bytes} bytes in 12 s");
    link.answered(now);
    assert!(!link.is_silent());
}

#[test]
fn surplus_answers_are_no_harm() {
    let mut link = Link::default();
    for ms in 0..10 {
        link.answered(Duration::from_millis(ms));
    }
    link.sent(Duration::from_millis(20), 100);
    assert!(link.is_waiting());
    assert_eq!(link.delay(), None);
}

#[test]
fn whoever_answers_what_was_not_asked_and_whoever_stands_between_gets_a_fixed_rate() {
    for lies in [true, false] {
        let mut link = Link::default();
        if !lies {
            link.relay();
        }
        let (mut now, mut n_bytes) = (Duration::ZERO, 0);
        while now < Duration::from_secs(10) {
            if link.next_slot(now).is_some_and(|slot| slot <= now) {
                let size = link.budget_at(now);
                link.sent(now, size);
                n_bytes += size;
                // At once, and of liars twice.
                (0..1 + u32::from(lies)).for_each(|_| link.answered(now));
            }
            now += Duration::from_millis(1);
        }
        assert!((1_700_000..1_900_000).contains(&n_bytes), "{n_bytes} bytes in 10 s");
    }
}

/// After one frame a second, answered as a wire of 2 Mbit/s and 80 ms does.
fn calm() -> (Link, Duration) {
    let mut link = Link::default();
    for k in 0..20 {
        let now = Duration::from_secs(k);
        let n_bytes = if k == 0 { 60 } else { 8000 };
        link.sent(now, n_bytes);
        link.answered(now + Duration::from_millis(80 + n_bytes as u64 / 235));
    }
    (link, Duration::from_secs(20))
}

#[test]
fn answers_to_queries_given_up_say_nothing_of_the_link() {
    let (mut link, mut now) = calm();
    let (delay, goodput) = (link.delay(), link.goodput());
    // A stall: three frames go, nothing comes; then all answers at once, while frames go on.
    for _ in 0..3 {
        link.sent(now, 8000);
        now += Duration::from_millis(40);
    }
    now += Duration::from_secs(6);
    link.check(now);
    assert!(link.is_silent());
    for _ in 0..5 {
        link.sent(now, 8000);
        now += Duration::from_millis(1);
        link.answered(now);
    }
    assert!(!link.is_silent());
    assert_eq!((link.delay(), link.goodput()), (delay, goodput));
    // After a calm second the link is measured again.
    now += Duration::from_secs(2);
    link.sent(now, 8000);
    link.answered(now + Duration::from_millis(100));
    assert_ne!(link.goodput(), goodput);
}

#[test]
fn two_frames_after_a_pause_fit_into_what_tcp_lets_go() {
    let (mut link, now) = calm();
    let at = |ms| now + Duration::from_millis(ms);
    let mut burst = 0;
    for ms in [0, 40] {
        burst += link.budget_at(at(ms));
        link.sent(at(ms), link.budget_at(at(ms)));
    }
    assert!(burst <= FIRST_BURST, "{burst} bytes");
    assert_eq!(link.budget_at(at(200)), link.budget());
    // On the same machine there is nothing to wait for.
    let mut near = Link::default();
    near.sent(Duration::ZERO, 20_000);
    near.answered(Duration::from_millis(1));
    assert!(near.budget_at(Duration::from_secs(1)) > FIRST_BURST / 2);
}

#[test]
fn a_frame_is_not_sent_into_the_queue_of_the_one_before() {
    let (mut link, now) = calm();
    link.sent(now, 8000);
    let slot = link.next_slot(now).map(|slot| slot - now);
    assert!(slot.is_some_and(|slot| slot >= Duration::from_millis(30)), "{slot:?}");
}

#[test]
fn what_is_on_its_way_is_as_old_as_the_first_and_as_large_as_the_last() {
    let ms = Duration::from_millis;
    let mut link = Link::default();
    assert_eq!(link.on_its_way(ms(5)), None);
    link.sent(ms(10), 4000);
    link.sent(ms(30), 900);
    assert_eq!(link.on_its_way(ms(100)), Some((ms(90), 900)));
    link.answered(ms(110));
    assert_eq!(link.on_its_way(ms(110)), Some((ms(80), 900)));
    link.answered(ms(120));
    assert_eq!(link.on_its_way(ms(130)), None);
}

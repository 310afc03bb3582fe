//! Many instances: calls from several threads, and one at a time.

use crate::tools::{of_zoo, point, push, start, stream};
use honami_host::{CallContext, Kind};

#[test]
fn instances_work_beside_each_other_and_move_between_threads() {
    let info = of_zoo(Kind::Tracker, "drift");
    let track = || {
        let cx = CallContext::silent();
        let mut tracker = start(&info, &["speed=0.5"]).unwrap();
        tracker.begin(stream(), &cx).unwrap();
        tracker.seed(&[point(1, 0.0, 0.0)], &cx).unwrap();
        let mut last = 0.0;
        for n in 0..50 {
            // Each call from a thread of its own: the ABI allows any thread, one at a time.
            last = std::thread::scope(|scope| {
                scope.spawn(|| push(&mut tracker, n).unwrap()[0].rows[0].x).join().unwrap()
            });
        }
        last
    };
    std::thread::scope(|scope| {
        let all: Vec<_> = (0..4).map(|_| scope.spawn(track)).collect();
        for thread in all {
            assert_eq!(thread.join().unwrap().to_bits(), 24.5_f32.to_bits());
        }
    });
}

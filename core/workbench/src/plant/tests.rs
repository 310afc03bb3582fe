//! What a plant may take.

use super::*;
use crate::plant::sway::bytes_of_winds;

#[test]
fn modes_that_have_no_room_are_refused_with_the_figures() {
    room(2740, 25, 100 << 20).unwrap();
    let error = room(100_000, 5000, 16_000_000_000).unwrap_err().to_string();
    let wanted = "to find 5000 modes of 100000 nodes of beams takes 96400 MB, and there are 16000: fewer modes are wanted";
    assert!(error.starts_with(wanted), "{error}");
}

#[test]
fn winds_of_a_frame_are_its_times_and_three_numbers_a_copy_and_step() {
    for (copies, steps, wanted) in
        [(1, 1, 12 + 8), (3, 100, 3600 + 800), (1, 0, 0), (usize::MAX, 2, usize::MAX)]
    {
        assert_eq!(bytes_of_winds(copies, steps), wanted, "{copies} {steps}");
    }
}

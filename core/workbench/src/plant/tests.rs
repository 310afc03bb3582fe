//! What a plant may take.

use super::*;

#[test]
fn modes_that_have_no_room_are_refused_with_the_figures() {
    room(2740, 25, 100 << 20).unwrap();
    let error = room(100_000, 5000, 16_000_000_000).unwrap_err().to_string();
    let wanted = "to find 5000 modes of 100000 nodes of beams takes 96400 MB, and there are 16000: fewer modes are wanted";
    assert!(error.starts_with(wanted), "{error}");
}

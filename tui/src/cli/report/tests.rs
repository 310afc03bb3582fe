//! What is said while a command works.

use super::*;

#[test]
fn a_silence_is_told_with_its_end() {
    for (is_spared, wanted) in [
        (false, "no sign of life for 4 s; after 10 s it is ended"),
        (true, "no sign of life for 4 s; it is not ended"),
    ] {
        let [since, at_most] = [4, 10].map(Duration::from_secs);
        let silence = Silence { since, is_too_long: false, at_most, is_spared };
        assert_eq!(silence_words(silence), wanted);
    }
}

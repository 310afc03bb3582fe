//! What is told to be typed.

use super::*;

#[test]
fn a_path_is_told_as_a_shell_takes_it() {
    for (path, wanted) in [
        ("/a/clip-1.honami", "/a/clip-1.honami"),
        ("my clip.honami", "'my clip.honami'"),
        ("ada's", r"'ada'\''s'"),
        ("$(x)", "'$(x)'"),
        ("~a", "'~a'"),
    ] {
        assert_eq!(quoted(Path::new(path)), wanted);
    }
}

//! What a shell makes of paths.

use std::path::Path;

use super::quoted;

#[test]
fn a_shell_takes_what_is_quoted_as_one_word() {
    for (path, wanted) in [
        ("/lab/my-flow.so", "/lab/my-flow.so"),
        ("/lab/two words.so", "'/lab/two words.so'"),
        ("/lab/it's.so", r"'/lab/it'\''s.so'"),
        ("$HOME/a;b", "'$HOME/a;b'"),
    ] {
        assert_eq!(quoted(Path::new(path)), wanted);
    }
}

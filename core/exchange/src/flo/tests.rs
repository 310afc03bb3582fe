//! Files of flow: bytes laid down by hand, what is read back, and what is refused.

use proptest::prelude::*;

use super::{Flow, read, write};

/// A file of these words.
fn file(words: &[[u8; 4]]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.flo");
    std::fs::write(&path, words.as_flattened()).unwrap();
    (folder, path)
}

fn f(v: f32) -> [u8; 4] {
    v.to_le_bytes()
}

fn i(v: i32) -> [u8; 4] {
    v.to_le_bytes()
}

#[test]
fn bytes_by_hand() {
    // Two pixels in one row: (1.5, -2), and one of which nothing is known.
    let (_folder, path) = file(&[*b"PIEH", i(2), i(1), f(1.5), f(-2.0), f(1e10), f(0.0)]);
    let flow = read(&path).unwrap();
    assert_eq!(flow, Flow { width: 2, height: 1, vectors: vec![Some([1.5, -2.0]), None] });
    write(&path, &flow).unwrap();
    assert_eq!(
        std::fs::read(&path).unwrap()[..20],
        [*b"PIEH", i(2), i(1), f(1.5), f(-2.0)].as_flattened()[..]
    );
    assert_eq!(read(&path).unwrap(), flow);
}

#[test]
fn what_is_no_flow_is_refused() {
    for (words, said) in [
        (vec![], "no .flo file"),
        (vec![*b"PIEH"], "no .flo file"),
        (vec![f(202_021.0), i(1), i(1), f(0.0), f(0.0)], "no .flo file"),
        (vec![*b"PIEH", i(-1), i(1)], "-1x1 pixels"),
        (vec![*b"PIEH", i(1), i(0)], "1x0 pixels"),
        (vec![*b"PIEH", i(i32::MAX), i(i32::MAX)], "2147483647x2147483647 pixels"),
        (vec![*b"PIEH", i(2), i(1), f(0.0), f(0.0)], "takes 28 bytes, this file has 20"),
        (vec![*b"PIEH", i(1), i(1), f(0.0), f(0.0), f(0.0)], "takes 20 bytes, this file has 24"),
    ] {
        let (_folder, path) = file(&words);
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains(said) && error.ends_with("a.flo"), "{words:?}: {error}");
    }
    assert!(read(std::path::Path::new("missing.flo")).unwrap_err().to_string().contains("missing.flo"));
}

#[test]
fn between_pixels_it_is_bilinear_and_beside_unknown_ones_unknown() {
    let known = [Some([0.0, 1.0]), Some([2.0, 1.0]), None, Some([4.0, 5.0]), Some([6.0, 5.0]), None];
    let flow = Flow { width: 3, height: 2, vectors: known.to_vec() };
    for (at, wanted) in [
        ([0.0, 0.0], Some([0.0, 1.0])),
        ([1.0, 1.0], Some([6.0, 5.0])),
        ([0.5, 0.0], Some([1.0, 1.0])),
        ([0.5, 0.5], Some([3.0, 3.0])),
        ([1.5, 0.0], None),
        ([2.0, 0.0], None),
        ([-0.1, 0.0], None),
        ([0.0, 1.1], None),
        ([f32::NAN, 0.0], None),
    ] {
        assert_eq!(flow.at(at), wanted, "{at:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_is_written_reads_back_to_the_same_bits(
        (width, vectors) in (1_usize..9).prop_flat_map(|width| {
            let vector = proptest::option::of(prop::array::uniform2(-1e9_f32..1e9));
            (Just(width), proptest::collection::vec(vector, width..width * 8))
        })
    ) {
        let height = vectors.len() / width;
        let vectors = vectors[..height * width].to_vec();
        let flow = Flow { width: width as u32, height: height as u32, vectors };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.flo");
        write(&path, &flow).unwrap();
        prop_assert_eq!(read(&path).unwrap(), flow);
    }
}

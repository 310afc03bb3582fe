//! The bytes of a cache.

use super::{PointCache, PointCacheError};

#[test]
fn a_cache_is_its_header_and_a_float_a_coordinate() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sway.pc2");
    let places = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [1.5, 2.5, 3.5], [4.5, 5.5, 6.5]];
    let mut cache = PointCache::create(&path, 2, 2).unwrap();
    for place in places {
        cache.push(place).unwrap();
    }
    assert!(!path.exists());
    cache.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(&bytes[..12], b"POINTCACHE2\0");
    let word = |at: usize| bytes[at..at + 4].try_into().unwrap();
    assert_eq!([12, 16, 28].map(|at| i32::from_le_bytes(word(at))), [1, 2, 2]);
    let floats: Vec<u32> =
        (32..bytes.len()).step_by(4).map(|at| f32::from_le_bytes(word(at)).to_bits()).collect();
    let wanted: Vec<u32> = places.concat().iter().map(|v| v.to_bits()).collect();
    assert_eq!(floats, wanted);
}

#[test]
fn more_points_than_the_format_counts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = PointCache::create(&folder.path().join("a.pc2"), 1 << 31, 2).unwrap_err();
    assert!(matches!(error, PointCacheError::Points(_)));
}

/// A cache of others differs in nothing but the sign of a nothing.
#[test]
fn caches_of_others_are_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pc2");
    for _again in 0..2 {
        PointCache::create(&path, 1, 0).unwrap().finish().unwrap();
    }
    let own = std::fs::read(&path).unwrap();
    let theirs = [
        b"POINTCACHE2\0".to_vec(),
        [1, 1, 0].map(i32::to_le_bytes).concat(),
        1_f32.to_le_bytes().to_vec(),
        vec![0; 4],
    ]
    .concat();
    assert_eq!((own.len(), own.iter().zip(&theirs).filter(|(a, b)| a != b).count()), (theirs.len(), 1));
    for theirs in [theirs.clone(), theirs[..20].to_vec()] {
        std::fs::write(&path, &theirs).unwrap();
        let error = PointCache::create(&path, 1, 0).unwrap_err();
        assert!(matches!(error, PointCacheError::File(crate::table::TableError::Unlike { .. })), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), theirs);
    }
}

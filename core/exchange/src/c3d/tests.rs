//! Bytes of a small file, word by word as the format's manual has them, and all of it read back by following its links.

use std::collections::BTreeMap;

use super::*;

fn fix(frame: u32, place_m: [f64; 3], error_m: f32) -> Fix {
    Fix { frame, place_m, errors_m: [error_m, 0.0, 0.0], residual_px: 0.2 }
}

fn written(what: &Points<'_>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.c3d");
    write(&path, what).unwrap();
    std::fs::read(&path).unwrap()
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Type, dimensions and bytes of every parameter by `GROUP:NAME`, read as the manual says: from link to link until there is none.
fn parameters(bytes: &[u8]) -> BTreeMap<String, (i8, Vec<usize>, Vec<u8>)> {
    let (mut at, mut groups, mut found) = (BLOCK + 4, BTreeMap::new(), Vec::new());
    loop {
        let (n, id) = (bytes[at] as usize, bytes[at + 1] as i8);
        let name = String::from_utf8(bytes[at + 2..at + 2 + n].to_vec()).unwrap();
        let link = at + 2 + n;
        if id < 0 {
            groups.insert(-id, name);
        } else {
            let (of, n_sizes) = (bytes[link + 2] as i8, bytes[link + 3] as usize);
            let sizes: Vec<usize> = bytes[link + 4..][..n_sizes].iter().map(|&b| b as usize).collect();
            let n_bytes = sizes.iter().product::<usize>() * of.unsigned_abs() as usize;
            found.push((id, name, (of, sizes, bytes[link + 4 + n_sizes..][..n_bytes].to_vec())));
        }
        match u16_at(bytes, link) {
            0 => break,
            far => at = link + far as usize,
        }
    }
    found.into_iter().map(|(id, name, value)| (format!("{}:{name}", groups[&id]), value)).collect()
}

#[test]
fn every_word_is_where_the_manual_has_it() {
    let a = [fix(4, [0.1, -0.2, 3.2], 0.001), fix(5, [0.11, -0.2, 3.2], 0.002)];
    let b = [fix(6, [-0.5, 0.0, 2.0], 9.0)];
    let points = vec![("T1".to_owned(), &a[..]), ("tip".to_owned(), &b[..])];
    let bytes = written(&Points { points, fps: 25.0 });
    assert_eq!(bytes.len() % BLOCK, 0);
    // The header: where parameters begin, the key, points, frames from 1, no gaps filled, floats, where data begin, the rate.
    assert_eq!(bytes[..2], [2, 0x50]);
    let words = [2, 3, 4, 5, 6, 10].map(|word| u16_at(&bytes, 2 * (word - 1)));
    assert_eq!(words, [2, 0, 5, 7, 0, 0]);
    let scale = f32_at(&bytes, 12);
    assert!((scale + 0.1).abs() < 1e-6, "{scale}");
    let data = (u16_at(&bytes, 16) as usize - 1) * BLOCK;
    assert_eq!(bytes[20..24], 25_f32.to_le_bytes());
    // Parameters: how many blocks, and Intel's numbers; data follow.
    assert_eq!((bytes[BLOCK + 1], bytes[BLOCK + 3]), (0x50, 84));
    assert_eq!(data, BLOCK + bytes[BLOCK + 2] as usize * BLOCK);
    let all = parameters(&bytes);
    for (name, of, sizes, value) in [
        ("POINT:USED", 2, vec![], vec![2, 0]),
        ("POINT:FRAMES", 2, vec![], vec![3, 0]),
        ("POINT:RATE", 4, vec![], 25_f32.to_le_bytes().to_vec()),
        ("POINT:SCALE", 4, vec![], scale.to_le_bytes().to_vec()),
        ("POINT:DATA_START", 2, vec![], bytes[16..18].to_vec()),
        ("POINT:UNITS", -1, vec![2], b"mm".to_vec()),
        ("POINT:LABELS", -1, vec![3, 2], b"T1 tip".to_vec()),
        ("ANALOG:USED", 2, vec![], vec![0, 0]),
        ("TRIAL:ACTUAL_START_FIELD", 2, vec![2], vec![5, 0, 0, 0]),
        ("TRIAL:ACTUAL_END_FIELD", 2, vec![2], vec![7, 0, 0, 0]),
    ] {
        assert_eq!(all.get(name), Some(&(of, sizes, value)), "{name}");
    }
    // Frame by frame, point by point: millimetres, both cameras' bits and the residual in steps of the scale; -1 where there is none.
    let none = [0.0, 0.0, 0.0, -1.0];
    let seen = |residual: u8| f32::from(3 * 256 + u16::from(residual));
    let wanted = [
        [100.0, -200.0, 3200.0, seen(10)],
        none,
        [110.0, -200.0, 3200.0, seen(20)],
        none,
        none,
        [-500.0, 0.0, 2000.0, seen(127)],
    ];
    for (k, wanted) in wanted.iter().enumerate() {
        let came = [0, 1, 2, 3].map(|c| f32_at(&bytes, data + 16 * k + 4 * c));
        assert_eq!(came.map(f32::to_bits), wanted.map(f32::to_bits), "number {k}: {came:?}");
    }
    assert!(bytes[data + 16 * 6..].iter().all(|&byte| byte == 0));
}

#[test]
fn labels_are_short_plain_and_never_twice() {
    let long = "the leaf at the very end of the longest branch";
    let wanted = ["tip", "tip", "Blatt süd", long, long, "tip_2"];
    let given = labels(wanted.into_iter());
    let cut = "the_leaf_at_the_very_end_of_the_";
    let again = "the_leaf_at_the_very_end_of_th_2";
    assert_eq!(given, ["tip", "tip_2", "Blatt_s_d", cut, again, "tip_2_2"]);
}

#[test]
fn more_points_than_a_dimension_counts_are_labelled_in_parts_and_too_many_are_named() {
    let fixes = [fix(70_000, [1.0; 3], 0.0)];
    let points =
        |n: usize| Points { points: (0..n).map(|k| (format!("T{k}"), &fixes[..])).collect(), fps: 50.0 };
    let bytes = written(&points(600));
    let all = parameters(&bytes);
    let n = |name: &str| all[name].1[1];
    assert_eq!(["POINT:LABELS", "POINT:LABELS2", "POINT:LABELS3"].map(n), [255, 255, 90]);
    // Frame 70001 is more than 16 bits.
    assert_eq!(u16_at(&bytes, 6), u16::MAX);
    assert_eq!(all["TRIAL:ACTUAL_START_FIELD"].2, 70_001_u32.to_le_bytes());
    let folder = tempfile::tempdir().unwrap();
    let refused = write(&folder.path().join("t.c3d"), &points(30_000)).unwrap_err();
    assert!(refused.to_string().contains("here are 30000"), "{refused}");
    assert!(matches!(write(&folder.path().join("t.c3d"), &points(0)), Err(C3dError::Empty)));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

//! Headers of arrays: those of NumPy, and those of nobody.

use super::*;

#[test]
fn headers_of_numpy_are_read() {
    let table = [
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 2), }  \n", "<f4", false, vec![3, 4, 2]),
        ("{'shape': (5,), 'fortran_order': True, 'descr': \"|b1\"}", "|b1", true, vec![5]),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (), }", "|O", false, vec![]),
    ];
    for (text, descr, fortran_order, shape) in table {
        assert_eq!(literal(text), Some(Literal { descr: descr.to_owned(), fortran_order, shape }));
    }
}

#[test]
fn anything_else_is_no_header() {
    for text in [
        "",
        "{}",
        "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'fortran_order': Maybe, 'shape': (1,)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 2)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), 'run': __import__('os')}",
        "{'descr': '<f4",
        "['descr']",
    ] {
        assert_eq!(literal(text), None, "{text}");
    }
}

#[test]
fn a_written_header_reads_back() {
    let bytes = header("<f4", &[7, 11, 2]);
    assert_eq!(bytes.len() % 64, 0);
    let read = head(&mut &bytes[..], "points").unwrap();
    assert_eq!((read.shape, read.kind, read.big_endian), (vec![7, 11, 2], Kind::F32, false));
    let error = head(&mut &header("|O", &[1])[..], "points").unwrap_err();
    assert!(error.to_string().contains("objects are pickles, which honami never loads"), "{error}");
}

//! Meshes as other programs write them are read; what is none is named with its line; what is written is read back.

use proptest::prelude::*;

use super::*;

/// A square in the plane of the first two axes, its corners as files name them.
const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.5], [2.0, 0.0, 0.5], [2.0, 1.0, 0.5], [0.0, 1.0, 0.5]];
const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

#[track_caller]
fn is_square(format: MeshFormat, bytes: &[u8]) {
    let (mesh, _) = format.read(bytes).unwrap();
    assert_eq!((mesh.positions, mesh.triangles), (SQUARE.to_vec(), HALVES.to_vec()));
}

#[test]
fn wavefront_is_read_however_corners_are_named() {
    let vertices = "# by hand\no square\nv 0 0 .5\nv 2 0 .5 1 0 0\nv 2 1 5e-1\n  v\t0 1 0.5 \n";
    for faces in [
        "f 1 2 3 4\n",
        "f 1/1/1 2/2/2 3//3 4/4\n",
        "f -4 -3 -2 -1",
        "s 1\nf 1 2 3\nf 1 3 4\n",
        "f 1 2 \\\n 3 4\r\n",
    ] {
        is_square(MeshFormat::Obj, format!("{vertices}{faces}").as_bytes());
    }
    is_square(MeshFormat::Obj, format!("f 1 2 3 4\n{vertices}").as_bytes());
    let looks = format!("{vertices}usemtl bark\nvt 0 1\nf 1 2 3 4\n");
    let (_, notes) = MeshFormat::Obj.read(looks.as_bytes()).unwrap();
    assert!(notes[0].contains("those of .glb stay") && notes.len() == 1);
}

const HEADER: &str = "comment by hand\nobj_info none\nelement camera 1\nproperty list uchar short zoom\nproperty double far\n\
    element vertex 4\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uint8 int32 vertex_index\nproperty ushort flags\nend_header\n";

/// The square behind [`HEADER`] as numbers, each turned by `order`.
fn numbers(order: fn(Vec<u8>) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = vec![2];
    bytes.extend([order((-3_i16).to_le_bytes().into()), order(7_i16.to_le_bytes().into())].concat());
    bytes.extend(order(1e9_f64.to_le_bytes().into()));
    for [x, y, z] in SQUARE {
        bytes.push(255);
        bytes.extend(order(x.to_le_bytes().into()));
        bytes.extend([y, z].into_iter().flat_map(|v| order((v as f32).to_le_bytes().into())));
    }
    bytes.push(4);
    bytes.extend((0..4_i32).flat_map(|corner| order(corner.to_le_bytes().into())));
    bytes.extend(order(9_u16.to_le_bytes().into()));
    bytes
}

#[test]
fn stanford_is_read_in_all_three_orders() {
    let text = "2 -3 7 1e9\n255 0 0 .5\n255 2 0 .5\n255 2 1 .5\n255 0 1 .5\n4 0 1 2 3 9\n";
    is_square(MeshFormat::Ply, format!("ply\nformat ascii 1.0\n{HEADER}{text}").as_bytes());
    let head = |format: &str| format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
    let little = [head("binary_little_endian"), numbers(|bytes| bytes)].concat();
    is_square(MeshFormat::Ply, &little);
    let reversed = |bytes: Vec<u8>| bytes.into_iter().rev().collect();
    is_square(MeshFormat::Ply, &[head("binary_big_endian"), numbers(reversed)].concat());
    // Cut anywhere it is refused, and nothing is read beyond the end.
    for end in 0..little.len() - 2 {
        assert!(MeshFormat::Ply.read(&little[..end]).is_err(), "{end}");
    }
}

#[test]
fn what_is_left_out_of_stanford_is_named() {
    let text = "2 -3 7 1e9\n255 0 0 .5\n255 2 0 .5\n255 2 1 .5\n255 0 1 .5\n4 0 1 2 3 9\n";
    let notes = |header: &str, text: &str| {
        MeshFormat::Ply.read(format!("ply\nformat ascii 1.0\n{header}{text}").as_bytes()).unwrap().1
    };
    let wanted = [
        "left out of the .ply: camera (rows: 1)",
        "left out of the .ply: red of vertex",
        "left out of the .ply: flags of face",
    ];
    assert_eq!(notes(HEADER, text), wanted);
    let header =
        HEADER.replace("double far", "double far\nelement tristrips 0\nproperty list int int vertex_indices");
    assert_eq!(notes(&header, text), wanted);
    let strip = HEADER.replace("element camera 1", "element tristrips 1");
    assert!(notes(&strip, text)[0].contains("tristrips (rows: 1)"));
    let corners = "property list uint8 int32 vertex_index\n";
    let end = HEADER.find("element face").unwrap();
    let plain = HEADER[HEADER.find("element vertex").unwrap()..end].replace("property uchar red\n", "");
    let header = format!("{plain}element face 1\n{corners}end_header\n");
    assert!(notes(&header, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").is_empty());
}

#[test]
fn rows_of_nothing_are_passed_over() {
    let header = HEADER.replace("element vertex", "element junk 18446744073709551615\nelement vertex");
    let header = format!("ply\nformat binary_little_endian 1.0\n{header}");
    is_square(MeshFormat::Ply, &[header.into_bytes(), numbers(|bytes| bytes)].concat());
}

#[test]
fn what_is_no_mesh_is_named() {
    let ply = |rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}"
        )
    };
    for (format, text, wanted) in [
        (
            MeshFormat::Obj,
            "v 0 0 0\nv 0 nan 0\n".to_owned(),
            "line 2: a vertex is three finite numbers, not \"v 0 nan 0\"",
        ),
        (MeshFormat::Obj, "v 0 0\n".to_owned(), "line 1: a vertex is three"),
        (MeshFormat::Obj, "v 0 0 0\nf 1 1 x\n".to_owned(), "line 2: a polygon is three"),
        (MeshFormat::Obj, "v 0 0 0\nf 1 1\n".to_owned(), "line 2: a polygon is three"),
        (MeshFormat::Obj, "v 0 0 0\nf 1 1 2\nf 1 1 1\n".to_owned(), "line 2: vertex 2 of 1 was wanted"),
        (MeshFormat::Obj, "v 0 0 0\nf -2 1 1\n".to_owned(), "line 2: a polygon is three"),
        (MeshFormat::Obj, "v 0 0 0\nf 0 1 1\n".to_owned(), "line 2: a polygon is three"),
        (MeshFormat::Ply, "solid\n".to_owned(), "line 1: a .ply begins with `ply`"),
        (MeshFormat::Ply, String::new(), "ends with `end_header`"),
        (MeshFormat::Ply, "ply\nformat morse 1.0\n".to_owned(), "line 2: a format is ascii"),
        (MeshFormat::Ply, "ply\nproperty float x\n".to_owned(), "line 2: a property is of an element"),
        (MeshFormat::Ply, "ply\nelement vertex many\n".to_owned(), "line 2: an element has a number"),
        (
            MeshFormat::Ply,
            "ply\nelement vertex 1\nproperty list x\n".to_owned(),
            "line 3: a property is of a kind",
        ),
        (MeshFormat::Ply, "ply\nelement vertex 1\nend_header\n".to_owned(), "a header names a format"),
        (MeshFormat::Ply, ply("0 0 nan\n3 0 0 0\n"), "vertex 0 lies at [0.0, 0.0, NaN]"),
        (MeshFormat::Ply, ply("0 0 0\n3 0 0 1\n"), "a face has vertex 1"),
        (MeshFormat::Ply, ply("0 0 0\n3 0 0 -1\n"), "a face has vertex -1: a whole number below 2^32"),
        (MeshFormat::Ply, ply("0 0 0\n3 0 0 4294967296\n"), "a face has vertex 4294967296: a whole"),
        (MeshFormat::Ply, ply("0 0 0\n3 0 0 0.7\n"), "a face has vertex 0.7: a whole"),
        (MeshFormat::Ply, ply("0 0 0\n-1\n"), "a list of face has -1 numbers: a whole"),
        (MeshFormat::Ply, ply("0 0 0\nnan\n"), "a list of face has NaN numbers: a whole"),
        (MeshFormat::Ply, ply("0 0 0\n4000000000 0 0 1\n"), "the file ends in row 0 of 1 of face"),
        (
            MeshFormat::Ply,
            ply("0 0 0\n").replace("vertex 1\n", "vertex 99999999999999\n"),
            "99999999999999 rows of vertex cannot be in the 6 bytes that are left",
        ),
        (
            MeshFormat::Ply,
            "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nend_header\n0\n".to_owned(),
            "rows of vertex cannot be",
        ),
    ] {
        let error = format.read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(wanted), "{text:?}: {error}");
    }
}

#[test]
fn frames_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    for (name, colours) in
        [("a.obj", &[][..]), ("b.ply", &[]), ("c.obj", &[[255, 0, 51]; 4]), ("d.PLY", &[[1, 2, 3]; 4])]
    {
        let path = folder.path().join(name);
        let format = MeshFormat::of(&path).unwrap();
        let frame = Frame { positions: &SQUARE, triangles: &HALVES, colours };
        write_frame(&path, format, &frame).unwrap();
        is_square(format, &std::fs::read(&path).unwrap());
        // It is written over, and others are not.
        write_frame(&path, format, &frame).unwrap();
        std::fs::write(&path, "ply\nformat ascii 1.0\nmine\n").unwrap();
        assert!(matches!(write_frame(&path, format, &frame), Err(TableError::Unlike { .. })));
    }
    let text = String::from_utf8(obj::written(&Frame {
        positions: &SQUARE,
        triangles: &HALVES,
        colours: &[[255, 0, 51]; 4],
    }));
    assert!(text.unwrap().contains("v 2 1 0.5 1.000 0.000 0.200\n"));
    assert_eq!((MeshFormat::of(Path::new("a.glb")), MeshFormat::of(Path::new("obj"))), (None, None));
}

proptest! {
    #[test]
    fn nothing_that_is_read_ends_the_program(bytes in prop::collection::vec(any::<u8>(), 0..400), cut in 0..300_usize) {
        let header = format!("ply\nformat binary_little_endian 1.0\n{HEADER}");
        let begun = [&header.as_bytes()[..cut.min(header.len())], &bytes].concat();
        let whole = [header.as_bytes(), &bytes].concat();
        for bytes in [&bytes, &begun, &whole] {
            for format in [MeshFormat::Obj, MeshFormat::Ply] {
                if let Ok((mesh, _)) = format.read(bytes) {
                    let n = mesh.positions.len();
                    prop_assert!(mesh.triangles.iter().flatten().all(|corner| (*corner as usize) < n));
                }
            }
        }
    }

    #[test]
    fn axes_go_there_and_back(place in prop::array::uniform3(-9.0..9.0_f64)) {
        for up in [Up::Y, Up::Z] {
            prop_assert_eq!(up.written(up.read(place)).map(f64::to_bits), place.map(f64::to_bits));
        }
        prop_assert_eq!(Up::Y.read([1.0, 2.0, 3.0]).map(|v| v as i32), [1, -3, 2]);
    }
}

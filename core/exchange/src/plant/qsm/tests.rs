//! Trees of cylinders, right and wrong.

use super::mat::matrix;
use super::{parse_mat, parse_table};

const HEAD: &str = "radius,length,start_x,start_y,start_z,axis_x,axis_y,axis_z,parent\n";

/// Parent, position and radius.
type Row = (Option<u32>, [f64; 3], f64);

fn nodes(text: &str) -> Result<Vec<Row>, String> {
    let measured = parse_table(text).map_err(|error| error.to_string())?;
    Ok(measured.plant.nodes().iter().map(|node| (node.parent, node.position, node.radius)).collect())
}

/// A trunk of two cylinders; one branch from the end of the first, one from where the second begins, one from the foot.
#[test]
fn a_cylinder_is_joined_to_the_nearer_end_of_what_bears_it() {
    let rows = "0.2,1,0,0,0,0,0,2,0\n0.1,1,0,0,1,0,0,1,1\n0.05,1,0.1,0,1.1,1,0,0,2\n0.05,2,0,0,0,0,1,0,1\n";
    let wanted = vec![
        (None, [0.0, 0.0, 0.0], 0.2),
        (Some(0), [0.0, 0.0, 1.0], 0.2),
        (Some(1), [0.0, 0.0, 2.0], 0.1),
        (Some(1), [1.1, 0.0, 1.1], 0.05),
        (Some(0), [0.0, 2.0, 0.0], 0.05),
    ];
    assert_eq!(nodes(&format!("{HEAD}{rows}")), Ok(wanted.clone()));
    // The names that other programs give, in any order.
    let other = "Parent;radius (m);Length;StartX;StartY;StartZ;axis_1;axis_2;axis_3\n";
    let turned: String = rows
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{};{}\n", cells[8], cells[..8].join(";"))
        })
        .collect();
    assert_eq!(nodes(&format!("{}{turned}", other.replace(" (m)", ""))), Ok(wanted));
}

#[test]
fn what_is_no_cylinder_is_named_with_its_line() {
    let cases = [
        ("", "a tree of cylinders has one at least, this has none"),
        ("0.2,1,0,0,0,0,0,1,7\n", "line 2: cylinder 1 is borne by 7, there are 1"),
        (
            "-0.2,1,0,0,0,0,0,1,0\n",
            "line 2: a cylinder has a radius of more than 0 m and a length of 0 m or more, not of -0.2 m and 1 m",
        ),
        ("0.2,1,0,0,0,0,0,0,0\n", "line 2: an axis that points nowhere"),
        ("0.2,1,0,0,0,0,0,1,0.5\n", "line 2: a parent is a whole number of 0 or more, not 0.5"),
        ("0.2,1,0,0,,0,0,1,0\n", "line 2: \"\" is no number"),
        (
            "0.2,1,0,0,0,0,0,1,2\n0.2,1,0,0,1,0,0,1,1\n",
            "line 2: node 1 stands on itself, through its parents",
        ),
    ];
    for (rows, wanted) in cases {
        assert_eq!(nodes(&format!("{HEAD}{rows}")), Err(wanted.to_owned()), "{rows:?}");
    }
    let error = nodes("radius,length\n1,2\n").unwrap_err();
    assert_eq!(error, "a table of cylinders has a column start_x, this one has radius, length");
}

/// An element: kind, size, data, filled up to eight bytes.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn file(name: &str, n_columns: u32, numbers: &[f32], is_packed: bool) -> Vec<u8> {
    let n_rows = numbers.len() as u32 / n_columns;
    let mut parts = element(6, &[7, 0, 0, 0, 0, 0, 0, 0]);
    parts.extend(element(5, &[n_rows.to_le_bytes(), n_columns.to_le_bytes()].concat()));
    parts.extend(element(1, name.as_bytes()));
    parts.extend(element(7, &numbers.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>()));
    let whole = element(14, &parts);
    let mut bytes = format!("{:124}", "MATLAB 5.0 MAT-file").into_bytes();
    bytes.extend([0, 1, b'I', b'M']);
    if is_packed {
        use std::io::Write as _;
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        packed.write_all(&whole).unwrap();
        let packed = packed.finish().unwrap();
        bytes.extend([15_u32.to_le_bytes(), (packed.len() as u32).to_le_bytes()].concat());
        bytes.extend(packed);
    } else {
        bytes.extend(whole);
    }
    bytes
}

#[test]
fn a_matrix_is_read_packed_or_not_and_cut_short_anywhere_is_an_error() {
    // Two cylinders, column by column.
    let columns =
        [[0.2, 0.1], [1.0, 1.0], [0.0; 2], [0.0; 2], [0.0, 1.0], [0.0; 2], [0.0; 2], [1.0; 2], [0.0, 1.0]];
    let numbers: Vec<f32> = columns.concat();
    for is_packed in [false, true] {
        let bytes = file("CylData", 9, &numbers, is_packed);
        let measured = parse_mat(&bytes).unwrap();
        assert_eq!(measured.plant.nodes().len(), 3);
        assert!((measured.plant.height() - 2.0).abs() < 1e-6);
        for end in 0..bytes.len() - 1 {
            assert!(matrix(&bytes[..end], "cyl").is_err(), "{end} of {}", bytes.len());
        }
    }
    let error = parse_mat(&file("other", 9, &numbers, false)).unwrap_err().to_string();
    assert_eq!(error, "a MATLAB file has a matrix of cylinders whose name begins with Cyl; this has other");
    assert!(parse_mat(b"MATLAB 7.3").unwrap_err().to_string().contains("as CSV"));
}

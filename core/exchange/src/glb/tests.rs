//! Scenes of others: where meshes stand in them, and what cannot be read.

use super::*;

/// A triangle with indices of 8 bits, vertices 16 bytes apart, and nodes that turn, scale and move it.
pub(crate) fn scene(change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut numbers: Vec<u8> = vec![0, 1, 2, 0];
    for place in [[1.0_f32, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        numbers.extend(place.iter().chain(&[f32::NAN]).flat_map(|v| v.to_le_bytes()));
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut words = json!({
        "asset": { "version": "2.0", "copyright": "somebody" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 2] }],
        "nodes": [
            { "translation": [10.0, 0.0, 0.0], "scale": [2.0, 2.0, 2.0], "children": [1] },
            { "rotation": [0.0, half, 0.0, half], "mesh": 0 },
            { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1], "mesh": 0, "name": "leaf" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 1 }, "indices": 0 }] }],
        "accessors": [
            { "componentType": 5121, "type": "SCALAR", "count": 3, "bufferView": 0 },
            { "componentType": 5126, "type": "VEC3", "count": 3, "bufferView": 1, "min": [0, 0, 0], "max": [1, 1, 1] },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 3 },
            { "buffer": 0, "byteOffset": 4, "byteLength": 48, "byteStride": 16 },
        ],
        "buffers": [{ "byteLength": numbers.len() }],
    });
    change(&mut words);
    file(words.to_string().into_bytes(), &numbers)
}

fn file(mut words: Vec<u8>, numbers: &[u8]) -> Vec<u8> {
    words.resize(words.len().next_multiple_of(4), b' ');
    let whole = 28 + words.len() + numbers.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend([2, whole, words.len()].iter().flat_map(|n| (*n as u32).to_le_bytes()));
    bytes.extend([b"JSON", &words[..]].concat());
    bytes.extend((numbers.len() as u32).to_le_bytes());
    bytes.extend([b"BIN\0", numbers].concat());
    bytes
}

#[test]
fn meshes_are_where_their_nodes_put_them() {
    let document = Document::read(&scene(|_| {})).unwrap();
    let (mesh, pieces) = document.pieces().unwrap();
    // A quarter turn about y leads x to -z and z to x; then twice as large, then 10 to the right. y is up.
    let wanted = [
        [10.0, 2.0, 0.0],
        [10.0, 0.0, 2.0],
        [12.0, 0.0, 0.0],
        [1.0, 0.0, 5.0],
        [0.0, 0.0, 6.0],
        [0.0, -1.0, 5.0],
    ];
    for (found, wanted) in mesh.positions.iter().zip(wanted) {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {wanted:?}");
    }
    assert_eq!((mesh.positions.len(), mesh.triangles), (6, vec![[0, 1, 2], [3, 4, 5]]));
    assert_eq!(pieces.iter().map(|piece| (piece.node, piece.mesh)).collect::<Vec<_>>(), [(1, 0), (2, 0)]);
    assert!(document.notes().is_empty());
    let noted = Document::read(&scene(|words| {
        words["animations"] = json!([{}]);
        words["nodes"][1]["extensions"] = json!({ "EXT_mesh_gpu_instancing": {} });
        words["images"] = json!([{ "uri": "bark.png" }, { "uri": "data:image/png;base64,AA==" }]);
    }));
    let notes = noted.unwrap().notes().join(". ");
    for wanted in ["animations are left out", "1 of its pictures", "nodes say by EXT_mesh_gpu_instancing"] {
        assert!(notes.contains(wanted), "{notes}");
    }
}

#[test]
fn trees_are_named_and_stand_where_their_root_nodes_do() {
    let trees = Document::read(&scene(|_| {})).unwrap().trees().unwrap();
    let tree = |name: &str, pivot| Tree { name: name.to_owned(), pivot };
    assert_eq!(trees, [tree("node 0", [10.0, 0.0, 0.0]), tree("leaf", [0.0, 0.0, 5.0])]);
    let turned = scene(|words| words["nodes"][2]["matrix"] = json!([1, 2]));
    assert!(Document::read(&turned).unwrap().trees().is_err());
}

/// Each vertex has a shape that takes it as far again from the origin.
#[test]
fn shapes_are_as_much_as_nodes_or_else_meshes_say() {
    let plain = Document::read(&scene(|_| {})).unwrap().pieces().unwrap().0;
    let shaped = scene(|words| {
        words["meshes"][0]["primitives"][0]["targets"] = json!([{ "NORMAL": 1 }, { "POSITION": 1 }]);
        words["meshes"][0]["weights"] = json!([1, 2.0]);
        words["nodes"][1]["weights"] = json!([0, -0.5]);
    });
    let (mesh, _) = Document::read(&shaped).unwrap().pieces().unwrap();
    for (row, (found, was)) in mesh.positions.iter().zip(&plain.positions).enumerate() {
        let (origin, size) = if row < 3 { ([10.0, 0.0, 0.0], 0.5) } else { ([0.0, 0.0, 5.0], 3.0) };
        for axis in 0..3 {
            let wanted = origin[axis] + size * (was[axis] - origin[axis]);
            assert!((found[axis] - wanted).abs() < 1e-12, "{row}: {found:?} {was:?}");
        }
    }
}

#[test]
fn lists_of_points_and_lines_have_no_triangles() {
    for (mode, n) in [(0, 0), (1, 0), (4, 2), (5, 2), (6, 2)] {
        let bytes = scene(|words| words["meshes"][0]["primitives"][0]["mode"] = mode.into());
        let (mesh, pieces) = Document::read(&bytes).unwrap().pieces().unwrap();
        assert_eq!((mesh.triangles.len(), mesh.positions.len(), pieces.len()), (n, 6, 2));
    }
    let bytes = scene(|words| words["meshes"][0]["primitives"][0]["indices"] = Value::Null);
    assert_eq!(Document::read(&bytes).unwrap().pieces().unwrap().0.triangles, [[0, 1, 2], [3, 4, 5]]);
}

/// Six corners, as the standard's own formulas make triangles of them, however many there are.
#[test]
fn strips_and_fans_are_unrolled() {
    let corners = [0_u8, 1, 2, 1, 0, 2];
    for n in 0..=corners.len() {
        for mode in [5, 6] {
            let bytes = scene(|words| {
                words["meshes"][0]["primitives"][0]["mode"] = mode.into();
                words["accessors"][0] =
                    json!({ "componentType": 5121, "type": "SCALAR", "count": n, "bufferView": 2 });
                words["scenes"][0]["nodes"] = json!([2]);
                words["bufferViews"]
                    .as_array_mut()
                    .unwrap()
                    .push(json!({ "byteOffset": 52, "byteLength": n }));
            });
            let mut document = Document::read(&bytes).unwrap();
            document.numbers.extend(corners);
            let strip = |k: usize| [corners[k], corners[k + 1 + k % 2], corners[k + 2 - k % 2]];
            let fan = |k: usize| [corners[0], corners[k + 1], corners[k + 2]];
            let wanted: Vec<[u8; 3]> =
                (0..n.saturating_sub(2)).map(|k| if mode == 5 { strip(k) } else { fan(k) }).collect();
            let found = document.pieces().unwrap().0.triangles;
            assert_eq!(found, wanted.iter().map(|it| it.map(u32::from)).collect::<Vec<_>>(), "{mode} {n}");
        }
    }
}

/// What is counterclockwise in a mesh is so in the scene, whether left and right are exchanged or all three axes are.
#[test]
fn mirrors_do_not_turn_inside_out() {
    for (scale, is_mirror) in [([-1, 1, 1], true), ([-2, -2, 1], false), ([-1, -1, -1], true)] {
        let bytes = scene(|words| words["nodes"][2] = json!({ "scale": scale, "mesh": 0 }));
        let (mesh, pieces) = Document::read(&bytes).unwrap().pieces().unwrap();
        let last = if is_mirror { [3, 5, 4] } else { [3, 4, 5] };
        assert_eq!(mesh.triangles, [[0, 1, 2], last], "{scale:?}");
        assert_eq!(pieces[1].turned, if is_mirror { vec![vec![[0, 2, 1]]] } else { Vec::new() });
        assert!(pieces[0].turned.is_empty());
    }
}

#[test]
fn what_is_not_read_is_named() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 22] = [
        (|words| words["buffers"][0]["uri"] = "far.bin".into(), "export it as one .glb"),
        (|words| words["buffers"] = json!([]), "export it as one .glb"),
        (|words| words["asset"] = "2.0".into(), "`asset`, an object"),
        (|words| words["asset"] = Value::Null, "`asset`, an object"),
        (|words| words["skins"] = json!([{}]), "bound to bones already"),
        (
            |words| {
                words["extensionsRequired"] = json!(["KHR_texture_transform", "KHR_draco_mesh_compression"])
            },
            "readers that know KHR_draco_mesh_compression",
        ),
        (|words| words["accessors"][1]["sparse"] = json!({}), "accessor 1 are packed"),
        (|words| words["accessors"][1]["componentType"] = 5122.into(), "accessor 1 are packed"),
        (|words| words["accessors"][1]["count"] = 4_000_000_000_u64.into(), "beyond the end"),
        (|words| words["bufferViews"][1]["byteOffset"] = u64::MAX.into(), "beyond the end"),
        (
            |words| words["bufferViews"][1]["byteStride"] = 8.into(),
            "accessor 1 take 12 bytes and begin every 8",
        ),
        (
            |words| words["bufferViews"][0]["byteStride"] = 0.into(),
            "accessor 0 take 1 bytes and begin every 0",
        ),
        (
            |words| {
                words["bufferViews"][1]["byteStride"] = 0.into();
                words["accessors"][1]["count"] = 4_000_000_000_000_u64.into();
            },
            "begin every 0",
        ),
        (|words| words["accessors"][1]["count"] = u64::MAX.into(), "beyond the end"),
        (|words| words["accessors"][0]["bufferView"] = 7.into(), "accessor 0 are packed"),
        (|words| words["accessors"][1]["count"] = 2.into(), "a corner that is none"),
        (|words| words["nodes"][1]["children"] = json!([0]), "no trees"),
        (|words| words["scenes"][0]["nodes"] = json!([9]), "no trees"),
        (|words| words["nodes"][0]["children"] = json!(vec![1; 1_000_000]), "no trees"),
        (
            |words| {
                words["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 2 }]);
                words["meshes"][0]["weights"] = json!([1]);
                let mut shorter = words["accessors"][1].clone();
                shorter["count"] = 2.into();
                words["accessors"].as_array_mut().unwrap().push(shorter);
            },
            "a shape of mesh 0 is not of its vertices",
        ),
        (|words| words["nodes"][0]["scale"] = json!([1.0, "2"]), "3 numbers of a node"),
        (|words| words["meshes"] = json!([{}]), "mesh 0 has no primitives"),
    ];
    for (change, wanted) in cases {
        let error =
            Document::read(&scene(change)).and_then(|document| document.pieces()).unwrap_err().to_string();
        assert!(error.contains(wanted), "{wanted}: {error}");
    }
}

#[test]
fn what_is_too_much_cut_or_no_scene_is_no_document() {
    // A mesh that is small, and stands in as many places as fill the memory.
    let forest = scene(|words| {
        words["nodes"] = vec![json!({ "mesh": 0 }); 10_000].into();
        words["scenes"][0]["nodes"] = (0..10_000).collect();
        let primitive = words["meshes"][0]["primitives"][0].take();
        words["meshes"][0]["primitives"] = vec![primitive; 2_000].into();
    });
    let error = Document::read(&forest).unwrap().pieces().unwrap_err().to_string();
    assert!(error.contains("have 140000000 vertices and corners, and 134217728 are read at most"), "{error}");
    let whole = scene(|_| {});
    for end in 0..whole.len() {
        let read = Document::read(&whole[..end]).and_then(|document| document.pieces());
        assert!(read.is_err(), "cut at {end}");
    }
    assert!(Document::read(&file(b"no".to_vec(), &[])).unwrap_err().to_string().contains("no JSON"));
    // Words that are no object have no scene.
    let document = Document::read(&file(b"[1]".to_vec(), &[]));
    assert!(document.is_err());
}

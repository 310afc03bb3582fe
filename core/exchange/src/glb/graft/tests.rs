//! What is grafted stands where it was put, with all that it needs, each once, and nothing else.

use super::super::tests::scene;
use super::*;

/// The scene of the other tests, with a picture on its triangle, and much that is not needed.
fn painted() -> Document {
    let bytes = scene(|words| {
        words["asset"]["copyright"] = "a painter".into();
        words["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_materials_variants"]);
        let coat = json!({ "clearcoatTexture": { "index": 1 } });
        words["materials"] = json!([
            { "name": "unused" },
            { "pbrMetallicRoughness": { "baseColorTexture": { "index": 2, "texCoord": 0 } },
              "extensions": { "KHR_materials_clearcoat": coat }, "extras": { "index": 9 } },
        ]);
        words["textures"] = json!([{}, { "source": 1 }, { "source": 1, "sampler": 1 }]);
        words["samplers"] = json!([{}, { "wrapS": 10497 }]);
        words["images"] = json!([{ "uri": "no.png" }, { "mimeType": "image/png", "bufferView": 2 }]);
        words["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "buffer": 0, "byteOffset": 1, "byteLength": 2 }));
        let primitive = &mut words["meshes"][0]["primitives"][0];
        primitive["material"] = 1.into();
        primitive["targets"] = json!([{ "POSITION": 1 }]);
        primitive["extensions"] = json!({ "KHR_materials_variants": { "mappings": [{ "material": 0 }] } });
        words["nodes"][2]["weights"] = json!([0.0]);
    });
    Document::read(&bytes).unwrap()
}

#[test]
fn pieces_stand_where_they_are_put_with_what_they_need() {
    let from = painted();
    let (mesh, pieces) = from.pieces().unwrap();
    assert_eq!(pieces.iter().map(Piece::tree).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(pieces.iter().map(Piece::n_vertices).collect::<Vec<_>>(), [3, 3]);
    let mut into = Document::of(&mesh);
    let mut grafting = Grafting::of(&from);
    // x goes twice as far along y, y along z, z along x; both pieces, and the second once more.
    let axes = [[0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]];
    let origins = [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [-7.0, 0.0, 0.5]];
    for (piece, origin) in [0, 1, 1].into_iter().zip(origins) {
        let put = grafting.graft(&mut into, &pieces[piece], axes, origin);
        assert_eq!((put.mesh, put.n_vertices()), (1, 3));
    }
    let last = into.words["nodes"].as_array().unwrap().len() - 1;
    assert_eq!(
        (&into.words["nodes"][last]["name"], &into.words["nodes"][last]["weights"]),
        (&"leaf".into(), &json!([0.0]))
    );
    into.credit(&[&from, &from]);
    let placed = into.pieces().unwrap().0;
    for (row, place) in placed.positions[6..].iter().enumerate() {
        let [x, y, z] = mesh.positions[[0, 1, 2, 3, 4, 5, 3, 4, 5][row]];
        let [a, b, c] = origins[row / 3];
        let wanted = [a + 2.0 * z, b + 2.0 * x, c + 2.0 * y];
        assert!(place.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{row}: {place:?} {wanted:?}");
    }
    assert_eq!(placed.triangles[2..], [[6, 7, 8], [9, 10, 11], [12, 13, 14]]);
    let words = &into.words;
    let sizes = ["meshes", "materials", "textures", "samplers", "images"]
        .map(|list| words[list].as_array().unwrap().len());
    assert_eq!(sizes, [2, 2, 2, 1, 1], "its own and one of each, two textures of one picture");
    let material = &words["materials"][1];
    let texture = |at: &Value| words["textures"][at["index"].as_u64().unwrap() as usize].clone();
    let base = texture(&material["pbrMetallicRoughness"]["baseColorTexture"]);
    let coat = texture(&material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]);
    assert_eq!((base, coat), (json!({ "source": 0, "sampler": 0 }), json!({ "source": 0 })));
    assert_eq!((&words["samplers"][0]["wrapS"], &material["extras"]["index"]), (&10497.into(), &9.into()));
    let view = &words["bufferViews"][words["images"][0]["bufferView"].as_u64().unwrap() as usize];
    let first = view["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(into.numbers[first..first + 2], [1, 2]);
    let primitive = &words["meshes"][1]["primitives"][0];
    assert_eq!(primitive["targets"][0]["POSITION"], primitive["attributes"]["POSITION"]);
    assert!(primitive["extensions"].is_null(), "they speak of rows that are not here");
    assert_eq!(
        (&words["asset"]["copyright"], words["extensionsUsed"].as_array().unwrap().len()),
        (&"a painter".into(), 2)
    );
}

/// Words of others that name what there is not are no fault of ours, and no panic.
#[test]
fn rows_that_there_are_not_stay_empty() {
    let mut from = painted();
    from.words["bufferViews"][2]["byteOffset"] = u64::MAX.into();
    from.words["meshes"][0]["primitives"][0]["material"] = 77.into();
    let accessor = &mut from.words["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
    *accessor = 3.into();
    from.words["accessors"].as_array_mut().unwrap().resize(4, json!({ "bufferView": 3 }));
    from.words["bufferViews"].as_array_mut().unwrap().push(5.into());
    let (_, pieces) = from.pieces().unwrap();
    let mut into = Document::empty();
    let put = Grafting::of(&from).graft(
        &mut into,
        &pieces[1],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [0.0; 3],
    );
    assert!((put.mesh, &into.words["materials"][0]) == (0, &Value::Null));
    assert_eq!(
        into.pieces().unwrap().0,
        Document::read(&scene(|words| words["scenes"][0]["nodes"] = json!([2]))).unwrap().pieces().unwrap().0
    );
}

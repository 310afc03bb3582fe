//! What is put together says the same as a mesh and as a scene; libraries of every kind, and what is none.

use honami_model::clip::FrameTimes;

use super::super::{Blend, Carried, Out, write};
use super::*;

/// A stem of 2, and two branches from its end, in two frames.
fn fork() -> Skeleton {
    let joint = |parent: u32, length: f64| Joint { parent: Some(parent), length, ..Joint::default() };
    let joints = vec![Joint::default(), joint(0, 2.0), joint(1, 1.0), joint(1, 1.5)];
    let lean = |degrees: f64| [degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()];
    let directions = [0.0, 2.0, 30.0, -40.0, 0.0, -2.0, 35.0, -50.0].map(lean).to_vec();
    Skeleton::new([3.0, 0.0, 1.0], joints, directions, FrameTimes::constant(2, 25.0).unwrap()).unwrap()
}

/// A shoot of three edges with a leaf, y up; and a trunk of three nodes with a branch of two.
const SHOOT: &str = "v 0 0 0\nv .1 1 0\nv 0 2 0\nv .7 1 .2\nf 1 2 3\nf 2 4 3\n";
const TREE: &str = "1 1 0 0 0 .2 -1\n2 1 0 0 1 .2 1\n3 1 0 0 2 .1 2\n4 1 1 0 1 .1 2\n5 1 2 0 1.5 .1 4\n";

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().to_owned();
    for (name, text) in [
        ("shoot.obj", SHOOT),
        ("tree.swc", TREE),
        ("stick.swc", "1 1 0 0 0 .2 -1\n2 1 0 0 1 .2 1\n"),
        ("point.obj", "v 1 1 1\nf 1 1 1\n"),
        ("cloud.obj", "v 1 1 1\n"),
        ("ring.obj", "v 1 0 0\nv 0 0 1\nv -1 0 0\nv 0 0 -1\nf 1 2 3 4\n"),
        ("apart.obj", "v 50 0 0\nv 50.1 1 0\nv 50 2 0\nf 1 2 3\n"),
        ("twig.obj", "v 0 0 0\nv 1 -.05 .05\nv 2 -1 0\nf 1 2 3\n"),
    ] {
        std::fs::write(root.join(name), text).unwrap();
    }
    (folder, move |name| root.join(name))
}

fn carried(bound: Bound) -> Carried {
    Carried {
        bound: Some(bound),
        library: None,
        unit: 0.5,
        blend: Blend::Linear,
        fewer: None,
        again_s: None,
        are_weights_shown: false,
    }
}

#[test]
fn a_mesh_and_a_scene_of_branches_are_one() {
    let (_folder, at) = folder();
    // A mesh, which is a branch, and a plant of nodes that has one.
    let grove = Library::read(&[at("shoot.obj"), at("tree.swc")], None).unwrap();
    let skeleton = fork();
    for seed in 0..6 {
        let bound = Bound::assembled(&skeleton, &grove, 0.5, seed, 0).unwrap();
        let assembled = bound.assembled.unwrap();
        assert_eq!((assembled.n_branches, assembled.n_grafts, assembled.n_bare), (2, 2, 0));
        let (scene, pieces) = bound.document.pieces().unwrap();
        assert_eq!(
            (scene.positions.len(), &scene.triangles, pieces.len()),
            (bound.mesh.positions.len(), &bound.mesh.triangles, 3)
        );
        assert_eq!(bound.bindings.len(), scene.positions.len());
        for (a, b) in scene.positions.iter().zip(&bound.mesh.positions) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-6), "numbers of files have 32 bits: {a:?} {b:?}");
        }
        // A stem of one bone: two rings, tubes on no other.
        let of_stem = |binding: &honami_model::mesh::Binding| binding.shares().all(|(bone, _)| bone == 1);
        assert!(bound.bindings[..12].iter().all(of_stem) && !of_stem(&bound.bindings[13]));
        let same = Bound::assembled(&skeleton, &grove, 0.5, seed, 0).unwrap();
        assert_eq!(
            (&same.mesh, &same.bindings, &same.document),
            (&bound.mesh, &bound.bindings, &bound.document)
        );
        let other = Bound::assembled(&skeleton, &grove, 0.5, seed, 1).unwrap().mesh;
        assert_ne!(other, bound.mesh);
        // Of the same skeleton: what is drawn is the branches.
        let carried = Carried { library: Some((grove.clone(), seed)), ..carried(bound) };
        let sibling = carried.of_sibling(&skeleton, 1).unwrap().into_owned();
        assert_eq!(sibling.bound.unwrap().mesh, other);
    }
}

/// Of trees of nodes of a scene each is a branch of its own, wherever it stands.
#[test]
fn a_scene_has_as_many_branches_as_trees_of_nodes() {
    let (_folder, at) = folder();
    let shoot = Library::read(&[at("shoot.obj")], None).unwrap();
    let mut grove = Document::empty();
    let (_, pieces) = shoot.documents[0].pieces().unwrap();
    let turned = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for x in [-5.0, 9.0] {
        let _piece = Grafting::of(&shoot.documents[0]).graft(&mut grove, &pieces[0], turned, [x, 1.0, 2.0]);
    }
    grove.write(&at("grove.glb")).unwrap();
    let library = Library::read(&[at("grove.glb")], None).unwrap();
    assert_eq!((library.n_branches(), library.documents.len()), (2, 1));
    let [one, other] = [0, 1].map(|row| &library.branches[row]);
    assert_eq!((&one.mesh.triangles, one.mesh.positions.len()), (&other.mesh.triangles, 4));
    assert!((one.branch.breadth() - shoot.branches[0].branch.breadth()).abs() < 1e-6);
    assert!((other.branch.breadth() - shoot.branches[0].branch.breadth()).abs() < 1e-6);
    let bound = Bound::assembled(&fork(), &library, 1.0, 3, 0).unwrap();
    write(&fork(), 0, Out::Rig, &carried(bound), &at("out.glb")).unwrap();
}

/// Those that are none are left out by the names of their root nodes, where others are there; of these it is told which do not
/// begin where their root nodes stand.
#[test]
fn trees_that_are_no_branches_are_left_out() {
    let (_folder, at) = folder();
    let upright = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let grove = |names: &[&str]| {
        let mut grove = Document::empty();
        for (x, name) in (0..).zip(names) {
            let Read { document, pieces, .. } = read(&at(&format!("{name}.obj")), None).unwrap().unwrap();
            let _piece =
                Grafting::of(&document).graft(&mut grove, &pieces[0], upright, [f64::from(x), 1.0, 2.0]);
        }
        let path = at("grove.glb");
        grove.write(&path).unwrap();
        // All nodes are called so; those that are wanted are as long.
        let mut bytes = std::fs::read(&path).unwrap();
        let find = |bytes: &[u8], from: usize, what: &str| {
            from + bytes[from..].windows(what.len()).position(|found| found == what.as_bytes()).unwrap()
        };
        let mut from = find(&bytes, 0, "\"nodes\":[");
        for name in names {
            from = find(&bytes, from, "\"plant\"");
            bytes[from + 1..from + 6].copy_from_slice(format!("{name:_<5}").as_bytes());
        }
        std::fs::write(&path, bytes).unwrap();
        Library::read(&[path], None)
    };
    let library = grove(&["shoot", "ring", "point", "apart"]).unwrap();
    let notes: Vec<&str> = library.notes.iter().map(|(_, note)| note.as_str()).collect();
    assert_eq!(
        notes,
        [
            "left out, for they have no triangle or go nowhere: ring_, point",
            "begins where it is lowest, for its pivot is outside it or in its middle: apart"
        ]
    );
    assert_eq!([Begin::Pivot, Begin::Lowest, Begin::Fork].map(|begin| library.n_that(begin)), [1, 1, 0]);
    assert!(Bound::assembled(&fork(), &library, 1.0, 3, 0).is_ok());
    let error = grove(&["point", "ring"]).unwrap_err().to_string();
    assert!(error.contains("grove.glb: a branch goes from its foot"), "{error}");
    assert_eq!(told(&["a"; 10]), "a, a, a, a, a, a, a, a and 2 more");
}

/// A twig along x that droops is held by the origin of its file, and hangs on the bone by that.
#[test]
fn meshes_are_held_by_their_pivots() {
    let (_folder, at) = folder();
    let library = Library::read(&[at("twig.obj"), at("apart.obj"), at("tree.swc")], None).unwrap();
    let wanted = (
        at("apart.obj"),
        "begins where it is lowest, for its pivot is outside it or in its middle".to_owned(),
    );
    // The plant of nodes has a note of its own, about its units.
    assert_eq!(library.notes[0], wanted);
    assert!(library.notes.iter().all(|(path, _)| *path != at("twig.obj")));
    assert_eq!([Begin::Pivot, Begin::Lowest, Begin::Fork].map(|begin| library.n_that(begin)), [1, 1, 1]);
    let twig = Library::read(&[at("twig.obj")], None).unwrap();
    let bound = Bound::assembled(&fork(), &twig, 1.0, 3, 0).unwrap();
    let ends = bound.rest.places(bound.rest.rest());
    let n = bound.mesh.positions.len();
    for (first, bone) in [(n - 6, 2), (n - 3, 3)] {
        for (vertex, place) in [(first, ends[1]), (first + 2, ends[bone])] {
            let found = bound.mesh.positions[vertex];
            assert!((0..3).all(|k| (found[k] - place[k]).abs() < 1e-9), "{vertex}: {found:?} {place:?}");
        }
    }
}

#[test]
fn what_memory_is_not_there_for_is_refused_with_both_figures() {
    assert!(check_room(1_000_000, 2_000_000, 5_000_000, 570_000_000).is_ok());
    for (n_vertices, there, wanted) in [
        (
            1_000_000,
            569_999_999,
            "1000000 vertices and 2000000 triangles, which take 570 MB until they are written, and there are 569",
        ),
        (1 << 27, usize::MAX, "134217728 vertices, and 67108864 are carried at most"),
    ] {
        let error = check_room(n_vertices, 2_000_000, 5_000_000, there).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

/// Bones that all begin at the root leave no stem, and the plant is its branches.
#[test]
fn a_skeleton_of_ends_alone_has_no_tubes() {
    let (_folder, at) = folder();
    let library = Library::read(&[at("shoot.obj")], None).unwrap();
    let joint = Joint { parent: Some(0), length: 1.0, ..Joint::default() };
    let joints = vec![Joint::default(), joint.clone(), joint];
    let times = FrameTimes::constant(1, 25.0).unwrap();
    let star = Skeleton::new([0.0; 3], joints, vec![[0.0, 0.0, 1.0]; 3], times).unwrap();
    let bound = Bound::assembled(&star, &library, 1.0, 1, 0).unwrap();
    assert_eq!(bound.sizes(), [8, 4]);
    assert_eq!(bound.document.pieces().unwrap().1.len(), 2);
    write(&star, 0, Out::Rig, &carried(bound.clone()), &at("star.glb")).unwrap();
    write(&star, 0, Out::Usd, &carried(bound), &at("star.usda")).unwrap();
}

#[test]
fn what_is_no_library_says_why() {
    let (_folder, at) = folder();
    Document::empty().write(&at("bare.glb")).unwrap();
    for (names, up, wanted) in [
        (
            &["stick.swc"][..],
            None,
            "stick.swc: the branches of a plant are what hangs on its forks, and this one has none",
        ),
        (&["shoot.obj", "point.obj"], None, "point.obj: a branch goes from its foot"),
        (&["cloud.obj"], None, "cloud.obj: a plant to carry has a triangle at least"),
        (&["bare.glb"], None, "bare.glb"),
        (&["none.glb"], None, "none.glb: "),
        (&["leaf.txt"], None, "not as"),
        (&["tree.swc"], Some(Up::Z), "--up says nothing of"),
    ] {
        let paths: Vec<PathBuf> = names.iter().map(|name| at(name)).collect();
        let error = Library::read(&paths, up).unwrap_err().to_string();
        assert!(error.contains(wanted), "{wanted}: {error}");
    }
    assert!(
        Library::read(&[at("tree.swc"), at("shoot.obj")], Some(Up::Z)).is_ok(),
        "of what it can be typed of"
    );
    let none = Library { documents: Vec::new(), branches: Vec::new(), notes: Vec::new() };
    let error = Bound::assembled(&fork(), &none, 1.0, 1, 0).unwrap_err().to_string();
    assert!(error.contains("one branch at least"), "{error}");
}

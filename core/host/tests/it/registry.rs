//! The search path: who wins, who is trusted, what is said of the rest.

use crate::tools::{named, scratch, start, zoo};
use honami_host::{HostError, Kind, Registry, SearchPath, Trust, TrustBook};
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// A folder with the zoo in it.
fn folder(name: &str, file: &str) -> PathBuf {
    let folder = scratch().join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::set_permissions(&folder, Permissions::from_mode(0o755)).unwrap();
    fs::copy(zoo(), folder.join(file)).unwrap();
    fs::set_permissions(folder.join(file), Permissions::from_mode(0o644)).unwrap();
    folder
}

fn trust(registry: &Registry) -> Vec<(&Path, &Trust)> {
    let drifts = registry.plugins().iter().chain(registry.shadowed()).filter(|p| p.short_name == "drift");
    drifts.map(|plugin| (plugin.library.as_path(), &plugin.trust)).collect()
}

#[test]
fn the_first_of_the_search_path_wins() {
    let (given, beside) = (folder("given", "a.so"), folder("beside", "b.so"));
    let third_party = folder("third-party", "c.so");
    fs::write(beside.join("honami"), "").unwrap();
    fs::write(beside.join("notes.txt"), "no plugin").unwrap();
    let all = SearchPath {
        named: vec![given.clone()],
        executable: Some(beside.join("honami")),
        installed: vec![third_party.clone(), scratch().join("nowhere")],
        ..SearchPath::default()
    };
    let registry = Registry::scan_path(&all);
    assert!(registry.problems().is_empty(), "{:?}", registry.problems());
    let found = trust(&registry);
    assert_eq!(found[0], (given.join("a.so").as_path(), &Trust::Named));
    assert_eq!(found[1], (beside.join("b.so").as_path(), &Trust::Shipped));
    assert_eq!(found[2].0, third_party.join("c.so"));
    let untrusted =
        Registry::scan_path(&SearchPath { installed: vec![third_party], ..SearchPath::default() });
    let refused =
        start(untrusted.find(Kind::Tracker, "drift").unwrap(), &[]).expect_err("not trusted").to_string();
    assert!(
        refused.contains("c.so is not trusted: it is a third party's; `honami plugin allow "),
        "{refused}"
    );
}

#[test]
fn beside_the_executable_nobody_else_may_write() {
    let beside = folder("writable", "b.so");
    let executable = beside.join("honami");
    fs::write(&executable, "").unwrap();
    let path = SearchPath { executable: Some(executable), ..SearchPath::default() };
    fs::set_permissions(beside.join("b.so"), Permissions::from_mode(0o646)).unwrap();
    let registry = Registry::scan_path(&path);
    let Trust::No(why) = trust(&registry)[0].1 else { panic!("{registry:?}") };
    assert!(why.contains("others may write it: chmod go-w") && why.ends_with("b.so"), "{why}");
    fs::set_permissions(beside.join("b.so"), Permissions::from_mode(0o644)).unwrap();
    fs::set_permissions(&beside, Permissions::from_mode(0o777)).unwrap();
    assert!(matches!(trust(&Registry::scan_path(&path))[0].1, Trust::No(_)));
}

#[test]
fn what_a_person_allowed_is_loaded_until_it_changes() {
    let installed = folder("installed", "d.so");
    let library = installed.join("d.so");
    let book = TrustBook::in_folder(scratch().join("trust"));
    let path = SearchPath { installed: vec![installed], book: book.clone(), ..SearchPath::default() };
    let trusted = || Registry::scan_path(&path).find(Kind::Tracker, "drift").unwrap().clone();
    assert!(matches!(trusted().trust, Trust::No(_)));
    let sha256 = book.allow(&library).unwrap();
    let allowed = trusted();
    assert_eq!(allowed.trust, Trust::Allowed { sha256 });
    start(&allowed, &[]).unwrap();
    // Written anew with the same bytes it is the same; with others it is another, also to who looked before.
    let bytes = fs::read(&library).unwrap();
    fs::write(&library, &bytes).unwrap();
    assert_eq!(trusted().trust, allowed.trust);
    fs::write(&library, [bytes.as_slice(), b"more"].concat()).unwrap();
    for info in [allowed, trusted()] {
        let refused = start(&info, &[]).expect_err("changed").to_string();
        assert!(refused.contains("d.so is not trusted: it has changed since you allowed it"), "{refused}");
    }
    book.deny(&library).unwrap();
    assert!(matches!(trusted().trust, Trust::No(why) if why.contains("it was denied")));
    let named = SearchPath { named: vec![library.clone()], book: book.clone(), ..SearchPath::default() };
    assert!(
        matches!(&Registry::scan_path(&named).plugins()[0].trust, Trust::No(why) if why.contains("it was denied"))
    );
    book.allow(&library).unwrap();
    assert!(matches!(trusted().trust, Trust::Allowed { .. }));
}

#[test]
fn what_came_with_honami_is_not_loaded_when_a_person_has_denied_it() {
    let beside = folder("denied", "b.so");
    let library = beside.join("b.so");
    fs::write(beside.join("honami"), "").unwrap();
    let book = TrustBook::in_folder(scratch().join("trust-of-shipped"));
    let executable = Some(beside.join("honami"));
    let path = SearchPath { executable, book: book.clone(), ..SearchPath::default() };
    assert_eq!(trust(&Registry::scan_path(&path))[0].1, &Trust::Shipped);
    book.deny(&library).unwrap();
    let denied = Registry::scan_path(&path);
    let refused = start(denied.find(Kind::Tracker, "drift").unwrap(), &[]).expect_err("denied").to_string();
    assert!(refused.contains(&format!("`honami plugin allow {}`", library.display())), "{refused}");
    book.allow(&library).unwrap();
    assert_eq!(trust(&Registry::scan_path(&path))[0].1, &Trust::Shipped);
}

#[test]
fn an_installed_library_may_have_a_folder_of_its_own_and_what_was_built_beside_another_may_not() {
    let inner = folder("with-folders/mine", "e.so");
    let outer = inner.parent().unwrap().to_owned();
    let found = |path: SearchPath| Registry::scan_path(&path).plugins().len();
    assert!(found(SearchPath { installed: vec![outer.clone()], ..SearchPath::default() }) > 0);
    assert_eq!(found(SearchPath { named: vec![outer], ..SearchPath::default() }), 0);
}

#[test]
fn what_is_built_in_ones_own_tree_is_found_and_trusted_unless_others_may_write_it() {
    let tree = folder("tree", "other.txt");
    let built = tree.join("target/debug");
    fs::create_dir_all(&built).unwrap();
    let library = built.join("d.so");
    fs::copy(folder("built", "d.so").join("d.so"), &library).unwrap();
    let book = TrustBook::in_folder(scratch().join("trust-of-dev"));
    let path = SearchPath { dev: vec![tree], book: book.clone(), ..SearchPath::default() };
    let found = |path: &SearchPath| Registry::scan_path(path).find(Kind::Tracker, "drift").unwrap().clone();
    assert_eq!((found(&path).trust, found(&path).library), (Trust::Dev, library.clone()));
    start(&found(&path), &[]).unwrap();
    // What is installed from there is one's own, too, and without the tree it is a third party's.
    let installed = SearchPath { installed: vec![built], dev: path.dev.clone(), ..SearchPath::default() };
    assert_eq!(found(&installed).trust, Trust::Dev);
    assert!(matches!(found(&SearchPath { dev: Vec::new(), ..installed }).trust, Trust::No(_)));
    fs::set_permissions(&library, Permissions::from_mode(0o666)).unwrap();
    assert!(matches!(found(&path).trust, Trust::No(why) if why.contains("others may write it: chmod go-w")));
    fs::set_permissions(&library, Permissions::from_mode(0o644)).unwrap();
    book.deny(&library).unwrap();
    assert!(matches!(found(&path).trust, Trust::No(why) if why.contains("it was denied")));
}

#[test]
fn nothing_takes_the_place_of_a_file_that_was_named_and_cannot_be_used() {
    let (broken, installed) = (folder("broken", "f.so"), folder("whole", "f.so"));
    fs::write(broken.join("f.so"), "int main() {").unwrap();
    let whole = SearchPath { installed: vec![installed.clone()], ..SearchPath::default() };
    let found = |path: SearchPath, name: &str| {
        let registry = Registry::scan_path(&path);
        let found = registry.find(Kind::Tracker, name).map(|plugin| plugin.library.clone());
        found.map_err(|error| error.to_string())
    };
    let file = installed.join("f.so");
    let words = |error: &String| error.contains("is no 64-bit ELF library") && error.contains("is not taken");
    // The file was named, or its folder and in it a file of that name; the file of another name was not meant.
    for (named, dev, is_whole) in [
        (vec![broken.join("f.so")], vec![], false),
        (vec![broken.clone()], vec![], false),
        (vec![], vec![broken.clone()], false),
        (vec![folder("other", "g.so"), broken.join("f.so")], vec![], true),
    ] {
        let found = found(SearchPath { named: named.clone(), dev, ..whole.clone() }, "drift");
        assert_eq!(found.is_ok(), is_whole, "{named:?}: {found:?}");
        assert!(found.is_ok() || found.as_ref().is_err_and(words), "{found:?}");
    }
    fs::rename(broken.join("f.so"), broken.join("h.so")).unwrap();
    assert_eq!(found(SearchPath { named: vec![broken], ..whole }, "drift"), Ok(file));
}

#[test]
fn what_others_may_write_cannot_be_allowed() {
    let installed = folder("shared", "e.so");
    let library = installed.join("e.so");
    let book = TrustBook::in_folder(scratch().join("trust-shared"));
    for (place, mode, usual) in [(&library, 0o646, 0o644), (&installed, 0o777, 0o755)] {
        fs::set_permissions(place, Permissions::from_mode(mode)).unwrap();
        let refused = book.allow(&library).expect_err("others may write it").to_string();
        let wanted = format!("others may write it: chmod go-w {}", place.display());
        assert!(refused.contains(&wanted), "{refused}");
        fs::set_permissions(place, Permissions::from_mode(usual)).unwrap();
    }
    std::os::unix::fs::symlink(&library, installed.join("link.so")).unwrap();
    let refused = book.allow(&installed.join("link.so")).expect_err("a link").to_string();
    assert!(refused.contains("is no file but a link"), "{refused}");
    book.allow(&library).unwrap();
}

#[test]
fn plugins_are_found_by_short_name_or_id_and_kind() {
    let registry = named(&[zoo()]);
    let id =
        |name| registry.find(Kind::Tracker, name).map(|plugin| plugin.id.clone()).map_err(|e| e.to_string());
    assert_eq!(id("drift").unwrap(), "org.honami.zoo.drift");
    assert_eq!(id("org.honami.zoo.drift").unwrap(), "org.honami.zoo.drift");
    assert_eq!(
        id("chain").unwrap_err(),
        "there is no tracker \"chain\"; there are: drift, delayed, panics, tint"
    );
    let wrong_kind = registry.find(Kind::Clusterer, "drift").unwrap_err();
    assert!(matches!(wrong_kind, HostError::NotFound { .. }));
}

#[test]
fn parameters_are_refused_before_the_plugin_sees_them() {
    let registry = named(&[zoo()]);
    let info = registry.find(Kind::Tracker, "drift").unwrap();
    let refused = [
        ("speed=11", "speed: wanted a number, -10 to 10 (px/frame), got \"11\""),
        ("speed=nan", "speed: wanted a number, -10 to 10 (px/frame), got \"NaN\""),
        ("life=2.5", "life: wanted a whole number, 0 to 100 (frame), got \"2.5\""),
        ("way=up", "way: wanted one of right, down, got \"up\""),
        ("corner=1", "corner: wanted x,y, got \"1\""),
        ("dice=-1", "dice: wanted a whole number from 0, got \"-1\""),
        (
            "sped=1",
            "there is no parameter \"sped\" (did you mean speed?); there are: speed, way, life, note, corner, dice",
        ),
        ("colour=1", "there is no parameter \"colour\"; there are: speed, way, life, note, corner, dice"),
        ("speed", "\"speed\" is not of the form name=value"),
    ];
    for (setting, wanted) in refused {
        assert_eq!(start(info, &[setting]).expect_err(setting).to_string(), wanted);
    }
}

/// A rebuilt plugin is a new one, also under the old name, while the old one is in use.
#[test]
fn a_file_that_changes_is_loaded_anew() {
    let folder = folder("changing", "zoo.so");
    let registry = named(&[&folder.join("zoo.so")]);
    let info = registry.find(Kind::Tracker, "drift").unwrap();
    let first = start(info, &[]).unwrap();
    let hash = info.sha256().unwrap();
    // Trailing bytes belong to no section: another file, the same code. Written in place, as a careless copy would.
    let mut bytes = fs::read(zoo()).unwrap();
    bytes.extend(*b"another build");
    fs::write(folder.join("zoo.so"), &bytes).unwrap();
    let second = start(info, &[]).unwrap();
    assert_ne!(info.sha256().unwrap(), hash);
    drop((first, second));
    let kept = |hash: &str| fs::metadata(scratch().join("store").join(format!("{hash}.so"))).unwrap();
    for hash in [hash, info.sha256().unwrap()] {
        assert_eq!(kept(&hash).permissions().mode() & 0o777, 0o400);
    }
}

//! Folders as lists to choose from.

use super::*;

#[test]
fn a_folder_lists_projects_then_clips_then_folders() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    for name in ["b.mp4", "a.MOV", "z.honami", "notes.txt", ".hidden.mp4", "1.png", "2.png"] {
        fs::write(root.join(name), []).unwrap();
    }
    fs::create_dir(root.join("more")).unwrap();
    let listing = list(&root).unwrap();
    let names: Vec<&str> = listing.rows.iter().map(|row| row.0.as_str()).collect();
    assert_eq!(names, ["z.honami", "./", "a.MOV", "b.mp4", "more/", "../"]);
    assert_eq!(listing.rows[1].2, Lead::File(root.clone()), "pictures are a clip");
    let typed = |path: &str| follow(&Lead::Typed(root.join(path)));
    assert_eq!(typed("b.mp4"), Ok(Found::File(root.join("b.mp4"))));
    assert_eq!(typed("%d.png"), Ok(Found::File(root.join("%d.png"))));
    assert!(matches!(typed("more"), Ok(Found::Folder(more)) if more.rows.len() == 1));
    assert_eq!(typed("none"), Err(format!("there is no file {}", root.join("none").display())));
    assert!(follow(&Lead::Folder(root.join("none"))).unwrap_err().contains("cannot be listed"));
}

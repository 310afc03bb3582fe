//! The cache folder: complete files only, bounded, deletable, rebuilt when damaged, shared by processes.

use std::fs::File;
use std::sync::Arc;

use super::*;
use crate::source::sequence;

fn cache_file(place: &Place) -> PathBuf {
    let name = place.names("cache").into_iter().find(|name| name.ends_with(".frames")).unwrap();
    place.cache().join(name)
}

/// Opens and waits until all frames are in the cache.
fn fill(place: &Place, name: &str, options: &OpenOptions) -> Vec<Vec<u8>> {
    let media = open(&place.path(name), options).unwrap();
    let frames = bytes_of(&media);
    media.settle();
    frames
}

#[test]
fn frames_are_decoded_once() {
    let place = Place::new();
    let folder = place.png_folder("clip", 6, 16, 12);
    let want = fill(&place, "clip", &place.options());
    assert_eq!(place.cached(), ["frames"]);
    let media = place.open("clip");
    assert_eq!(media.n_ready(), 6);
    assert!(media.try_frame(5).unwrap().is_some());
    // The images could be gone by now: nothing decodes them again.
    (0..6).for_each(|k| std::fs::remove_file(folder.join(format!("f{k}.png"))).unwrap());
    assert_eq!(bytes_of(&media), want);
}

#[test]
fn damage_is_found_and_mended() {
    let place = Place::new();
    place.png_folder("clip", 6, 16, 12);
    let want = fill(&place, "clip", &place.options());
    let path = cache_file(&place);
    let sound = std::fs::read(&path).unwrap();
    let mut other_head = sound.clone();
    other_head[20] ^= 1;
    let incomplete = [&sound[..36], &[0; 4], &sound[40..]].concat();
    for damaged in [
        &sound[..100],
        &sound[..sound.len() - 1],
        &[],
        &other_head,
        &incomplete,
        &[sound.as_slice(), b"x"].concat(),
    ] {
        std::fs::write(&path, damaged).unwrap();
        assert_eq!(fill(&place, "clip", &place.options()), want);
        assert_eq!(std::fs::read(&path).unwrap(), sound);
    }
    // Deleted while in use: what is mapped stays.
    let media = place.open("clip");
    std::fs::remove_dir_all(place.cache()).unwrap();
    assert_eq!(bytes_of(&media), want);
    assert_eq!(fill(&place, "clip", &place.options()), want);
}

#[test]
fn what_a_killed_process_left_is_removed() {
    let place = Place::new();
    place.png_folder("clip", 3, 8, 8);
    std::fs::create_dir(place.cache()).unwrap();
    let [dead, alive] = ["dead.1-0.part", "alive.2-0.part"].map(|name| place.cache().join(name));
    std::fs::write(&dead, "half").unwrap();
    let held = File::create(&alive).unwrap();
    held.lock().unwrap();
    fill(&place, "clip", &place.options());
    assert!(!dead.exists());
    assert!(alive.exists(), "somebody fills it");
}

#[test]
fn stopping_early_leaves_nothing() {
    let place = Place::new();
    place.png_folder("clip", 40, 64, 64);
    let media = place.open("clip");
    let frame = media.frame(0).unwrap();
    drop(media);
    assert!(!place.cached().contains(&"part".to_owned()), "{:?}", place.cached());
    assert_eq!(frame.bytes(), gray(64, 64, 0).as_raw().as_slice(), "a frame outlives its clip");
}

#[test]
fn the_oldest_idle_file_makes_room() {
    let place = Place::new();
    let one_clip = 4096 + 4 * 64 * 64;
    let options = OpenOptions { cache_bytes: Some(2 * one_clip + 100), ..place.options() };
    let mut frames = Vec::new();
    for (name, first) in [("a", 0), ("b", 10), ("c", 20), ("d", 30)] {
        let folder = place.path(name);
        std::fs::create_dir(&folder).unwrap();
        (0..4).for_each(|k| gray(64, 64, first + k).save(folder.join(format!("{k}.png"))).unwrap());
        frames.push((name, (0..4).map(|k| gray(64, 64, first + k).into_raw()).collect::<Vec<_>>()));
    }
    let (a, b) = ((&frames[0].1), (&frames[1].1));
    assert_eq!(fill(&place, "a", &options), *a);
    assert_eq!(fill(&place, "b", &options), *b);
    let in_use = open(&place.path("a"), &options).unwrap();
    fill(&place, "c", &options);
    assert_eq!(place.cached(), ["frames", "frames"], "b had to go, a is in use");
    let also_in_use = open(&place.path("c"), &options).unwrap();
    let third = open(&place.path("d"), &options).unwrap();
    assert!(third.notes().iter().any(|note| note.contains("full of clips in use")), "{:?}", third.notes());
    for (media, (name, want)) in [(&in_use, &frames[0]), (&also_in_use, &frames[2]), (&third, &frames[3])] {
        assert_eq!(bytes_of(media), *want, "{name}");
    }
}

#[test]
fn a_clip_above_the_bound_is_decoded_on_demand() {
    let place = Place::new();
    place.png_folder("clip", 9, 16, 12);
    let want = fill(&place, "clip", &place.options());
    std::fs::remove_dir_all(place.cache()).unwrap();
    for recent_frames in [None, Some(2)] {
        let options = OpenOptions { cache_bytes: Some(5000), recent_frames, ..place.options() };
        let media = open(&place.path("clip"), &options).unwrap();
        assert!(media.notes().iter().any(|note| note.contains("on demand")), "{:?}", media.notes());
        assert_eq!(media.n_ready(), 9);
        assert!(media.try_frame(3).unwrap().is_none());
        assert_eq!(bytes_of(&media), want);
        assert_exact(&media);
    }
    assert!(place.cached().is_empty());
}

#[test]
fn a_folder_that_cannot_be_written_is_no_obstacle() {
    let place = Place::new();
    place.png_folder("clip", 3, 8, 8);
    std::fs::write(place.cache(), "a file where the folder should be").unwrap();
    let media = place.open("clip");
    assert!(media.notes().iter().any(|note| note.contains("on demand")), "{:?}", media.notes());
    assert_eq!(bytes_of(&media).len(), 3);
}

#[test]
fn two_openings_at_once_each_fill_their_own() {
    let place = Place::new();
    place.png_folder("clip", 30, 48, 48);
    let options = place.options();
    let want: Vec<Vec<u8>> = (0..30).map(|k| gray(48, 48, k).into_raw()).collect();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(fill(&place, "clip", &options), want));
        }
    });
    assert_eq!(place.cached(), ["frames"]);
    assert_eq!(fill(&place, "clip", &options), want);
}

#[test]
fn a_full_disk_costs_speed_only() {
    let place = Place::new();
    place.png_folder("clip", 5, 16, 12);
    let options = OpenOptions { cache_bytes: Some(0), ..place.options() };
    let like = open(&place.path("clip"), &options).unwrap();
    let (files, notes) = sequence::list(like.source()).unwrap();
    let probed = sequence::probe(like.source(), files, notes).unwrap();
    let mut filling = place.filling(probed.shape, 5);
    filling.refuse_writes().unwrap();
    let head = place.head(probed.shape, 5);
    let media = Media::filling(head, Arc::from(probed.source), filling).unwrap();
    assert_eq!(bytes_of(&media), bytes_of(&like));
    assert!(media.late_note().unwrap().contains("cannot be kept any more"), "{:?}", media.late_note());
    assert_eq!(media.n_ready(), 5);
    assert!(place.cached().is_empty());
}

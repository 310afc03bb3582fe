//! Pictures of a small skeleton, over a clip that is known to the pixel.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use honami_scene::skeleton::{Bone, Carried, Film, Group, Joint};
use honami_scene::{Orbit, SkeletonScene};

use super::*;
use crate::target::{Size, Target};
use crate::testing;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;
const N_FRAMES: u32 = 6;

/// What the picture of the clip shows at a pixel: greys, which clips keep for each pixel, and none like another near by in
/// place or time.
fn filmed(frame: u32, x: u32, y: u32) -> [u8; 3] {
    [(20 + (37 * x + 101 * y + 59 * frame) % 211) as u8; 3]
}

fn clip(folder: &Path) -> PathBuf {
    let clip = folder.join("clip");
    std::fs::create_dir(&clip).unwrap();
    for frame in 0..N_FRAMES {
        let pixels: Vec<[u8; 3]> =
            (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| filmed(frame, x, y))).collect();
        honami_media::write::still(&clip.join(format!("{frame:02}.png")), &pixels, WIDTH, HEIGHT).unwrap();
    }
    clip
}

/// A trunk with two branches that sway, one of them away from the camera, and a mirror image of that.
fn scene() -> SkeletonScene {
    let joint = |parent, group, copy_of, node| Joint {
        parent,
        group,
        copy_of,
        bone: Some(Bone { node, gain: 1.0, ..Bone::default() }),
        rest: [0.0, 0.0, 1.0],
        ..Joint::default()
    };
    let joints = vec![
        Joint::default(),
        joint(Some(0), None, None, 4),
        joint(Some(1), Some(0), None, 2),
        joint(Some(1), Some(1), None, 3),
        joint(Some(1), Some(1), Some(3), 3),
    ];
    let sway = |frame: u32| 3.0 * frame as f32;
    let place = |frame: u32| {
        let s = sway(frame);
        [
            [48.0, 0.0, -66.0],
            [48.0, 0.0, -42.0],
            [20.0 + s, 0.0, -20.0],
            [70.0 + s, -14.0, -14.0],
            [70.0 + s, 14.0, -14.0],
        ]
    };
    let group = |joint, colour, wide: f32| Group {
        colour,
        joint: Some(joint),
        half_axes: [[wide, 0.0, 0.0], [0.0, 0.0, 8.0], [0.0, 8.0, 0.0]],
        ..Group::default()
    };
    let leaf = |track, joint: u32, group, by: [f32; 2]| Carried {
        track,
        joint,
        group: Some(group),
        places: (0..N_FRAMES)
            .map(|frame| {
                let [x, y, z] = place(frame)[joint as usize];
                [x + by[0], y - 4.0, z + by[1]]
            })
            .collect(),
    };
    SkeletonScene {
        clip: Film { width: WIDTH, height: HEIGHT, n_frames: N_FRAMES, ..Film::default() },
        joints,
        places: (0..N_FRAMES).flat_map(place).collect(),
        times: (0..N_FRAMES).map(|frame| f64::from(frame) / 10.0).collect(),
        groups: vec![group(2, [255, 209, 0], 12.0), group(3, [0, 200, 255], 9.0)],
        leaves: vec![leaf(1, 2, 0, [-9.0, 3.0]), leaf(2, 3, 1, [8.0, 4.0])],
        ..SkeletonScene::default()
    }
}

struct Taken {
    pixels: Vec<[u8; 3]>,
    width: u32,
}

impl Taken {
    fn at(&self, x: u32, y: u32) -> [u8; 3] {
        self.pixels[(y * self.width + x) as usize]
    }
}

/// So many times as large as the clip.
fn take(
    gpu: &Gpu,
    picture: &mut SkeletonPicture,
    times: u32,
    samples: u32,
    orbit: Orbit,
    time: f64,
) -> Taken {
    let size = Size { width: times * WIDTH, height: times * HEIGHT, samples };
    let target = Target::new(gpu, size).unwrap();
    picture.draw(gpu, &target, &Shot { time, camera: orbit.camera() }).unwrap();
    Taken { pixels: target.read(gpu).unwrap(), width: size.width }
}

/// How far two colours are apart in the part that differs most.
fn apart(a: [u8; 3], b: [u8; 3]) -> u8 {
    (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or_default()
}

#[test]
fn the_clip_is_where_it_was_filmed_to_the_pixel() {
    let Some(gpu) = testing::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene();
    scene.clip.path = Some(clip(folder.path()));
    scene.first_frame = 0;
    let mut picture = SkeletonPicture::new(scene, BTreeSet::from([Part::Clip]));
    assert_eq!(picture.without_clip, None);
    for (time, frame) in [(0.0, 0), (0.31, 3), (9.0, N_FRAMES - 1), (0.26, 2)] {
        let orbit = picture.orbit();
        let taken = take(&gpu, &mut picture, 1, 1, orbit, time);
        let mut worst = 0;
        // All of it: the root's mark is of the bones, which are off.
        for (x, y) in (0..WIDTH).flat_map(|x| (0..HEIGHT).map(move |y| (x, y))) {
            let wanted = filmed(frame, x, y).map(|v| (f32::from(v) * 0.86).round() as u8);
            worst = worst.max(apart(taken.at(x, y), wanted));
        }
        assert!(worst <= 3, "frame {frame}: {worst}");
    }
}

#[test]
fn an_empty_picture_says_so() {
    let mut scene = scene();
    scene.groups.iter_mut().for_each(|group| group.half_axes = Default::default());
    let mut picture = SkeletonPicture::new(scene, BTreeSet::from([Part::Ellipsoids, Part::Copies]));
    let line = "nothing is seen of the skeleton: it has no ellipsoids, no copies";
    assert_eq!(picture.why_empty().as_deref(), Some(line));
    picture.parts.clear();
    assert_eq!(picture.why_empty().as_deref(), Some("nothing is seen of the skeleton: no part is on"));
    picture.parts.insert(Part::Bones);
    assert_eq!(picture.why_empty(), None);
    picture.parts = BTreeSet::from([Part::Ellipsoids]);
    picture.scene.groups[0].half_axes[0][1] = 2.0;
    assert_eq!(picture.why_empty(), None);
}

#[test]
fn joints_are_drawn_where_they_are_in_their_colours() {
    let Some(gpu) = testing::gpu() else { return };
    let mut picture = SkeletonPicture::new(scene(), BTreeSet::from([Part::Bones]));
    let orbit = picture.orbit();
    for frame in [0, 5] {
        let taken = take(&gpu, &mut picture, 4, 4, orbit, f64::from(frame) / 10.0);
        let is_like = |[red, green, blue]: [u8; 3], wanted: &str| match wanted {
            "yellow" => red > 110 && green > 90 && blue < 110,
            "blue" => blue > 110 && green > 80 && red < 110,
            "gray" => red.abs_diff(blue) < 16 && red > 90,
            _ => red < 60 && green < 60 && blue < 70,
        };
        let s = 3 * frame;
        for (x, y, wanted) in
            [(20 + s, 20, "yellow"), (70 + s, 14, "blue"), (48, 52, "gray"), (4, 40, "dark"), (40, 4, "dark")]
        {
            // The middle of the pixel of the clip.
            let is = taken.at(4 * x + 2, 4 * y + 2);
            assert!(is_like(is, wanted), "frame {frame} at {x},{y}: {is:?} is not {wanted}");
        }
    }
    let (plain, chosen) = (take(&gpu, &mut picture, 2, 4, orbit, 0.0), {
        picture.chosen = Some(Chosen::Bone(2));
        take(&gpu, &mut picture, 2, 4, orbit, 0.0)
    });
    let changed: Vec<usize> =
        (0..plain.pixels.len()).filter(|k| apart(plain.pixels[*k], chosen.pixels[*k]) > 8).collect();
    let is_near = |k: &usize| (*k as u32 % plain.width) < 2 * 52 && (*k as u32 / plain.width) < 2 * 46;
    assert!(changed.len() > 100 && changed.iter().all(is_near), "the chosen bone alone is strong");
}

#[test]
fn places_are_seen_where_they_are_drawn() {
    let Some(gpu) = testing::gpu() else { return };
    let picture = SkeletonPicture::new(scene(), Part::usual());
    let target = Target::new(&gpu, Size { width: 3 * WIDTH, height: 3 * HEIGHT, samples: 1 }).unwrap();
    let shot = Shot { time: 0.0, camera: picture.orbit().camera() };
    let [x, y] = picture.seen(&shot, &target, [10.0, 33.0, -20.0]).unwrap();
    assert!((x - 31.5).abs() < 1e-2 && (y - 61.5).abs() < 1e-2, "{x} {y}");
    let [right, down] = picture.placed(&shot, &target, [x, y]);
    assert!(
        (right - 10.0).abs() < 1e-6 && (down - 20.0).abs() < 1e-6,
        "and is what is seen there: {right} {down}"
    );
    let tip = |x: f32, y: f32| picture.nearest(&shot, &target, [3.0 * x + 1.5, 3.0 * y + 1.5], 12.0);
    assert_eq!((tip(21.0, 20.0), tip(70.0, 16.0), tip(48.0, 42.0)), (Some(2), Some(3), Some(4)));
    assert_eq!((tip(30.0, 20.0), tip(48.0, 66.0)), (None, None), "too far; and the root ends no bone");
}

#[test]
fn a_clip_of_another_size_or_none_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut small = scene();
    small.clip.path = Some(clip(folder.path()));
    small.clip.width = 100;
    let told = SkeletonPicture::new(small.clone(), Part::usual()).without_clip.unwrap();
    assert!(told.contains("6 frames of 96x72, and 6 of 100x72 were wanted"), "{told}");
    let other = Film { sha256: Some("0".repeat(64)), width: WIDTH, ..small.clip.clone() };
    let told =
        SkeletonPicture::new(SkeletonScene { clip: other, ..scene() }, Part::usual()).without_clip.unwrap();
    assert!(told.contains("another lies at"), "{told}");
    small.clip.path = Some(folder.path().join("none.y4m"));
    assert!(SkeletonPicture::new(small, Part::usual()).without_clip.is_some());
    assert_eq!(SkeletonPicture::new(scene(), Part::usual()).without_clip, None, "nobody wants it");
}

#[test]
fn pictures_are_those_that_were_looked_at() {
    let Some(gpu) = testing::gpu() else { return };
    let all: BTreeSet<Part> = Part::ALL.into_iter().collect();
    for (name, chosen, turned) in
        [("front", Some(Chosen::Bone(3)), [0.0, 0.0]), ("space", Some(Chosen::Track(1)), [0.6_f32, 0.25])]
    {
        let mut picture = SkeletonPicture::new(scene(), all.clone());
        picture.chosen = chosen;
        let orbit = Orbit { azimuth: turned[0], elevation: turned[1], ..picture.orbit() };
        let taken = take(&gpu, &mut picture, 3, 4, orbit, 0.5);
        let again = take(&gpu, &mut picture, 3, 4, orbit, 0.5);
        assert!(taken.pixels == again.pixels, "{name}: the same twice is the same");
        let truth = testing::truth(&format!("skeleton_{name}"), &taken.pixels, 3 * WIDTH);
        let unlike = testing::unlike(&taken.pixels, &truth);
        assert!(testing::is_alike(&taken.pixels, &truth), "{name}: {unlike:.4} of the pixels");
    }
}

//! Exact random access, on generated clips and on every real one; both decoders bit for bit.

use super::*;

#[test]
fn generated_clips_are_exact() {
    let place = Place::new();
    place.png_folder("pngs", 12, 33, 17);
    let mut clips = vec!["pngs"];
    for (name, arguments) in [
        ("a.y4m", "-f lavfi -i testsrc2=s=35x21:r=25:d=1 -pix_fmt yuv420p a.y4m"),
        ("a.mp4", "-f lavfi -i testsrc2=s=64x48:r=25:d=2 -pix_fmt yuv420p -c:v libx264 -bf 3 a.mp4"),
        ("a.avi", "-f lavfi -i testsrc2=s=64x48:r=25:d=1 -c:v mjpeg a.avi"),
        // Where seeking goes wrong: open GOPs, and a transport stream.
        (
            "open.mp4",
            "-f lavfi -i testsrc2=s=64x48:r=30:d=3 -pix_fmt yuv420p -c:v libx264 -x264-params open-gop=1:keyint=12:bframes=3 open.mp4",
        ),
        ("a.ts", "-f lavfi -i testsrc2=s=64x48:r=25:d=2 -pix_fmt yuv420p -c:v libx264 -g 10 a.ts"),
        ("a.webm", "-f lavfi -i testsrc2=s=64x48:r=25:d=1 -pix_fmt yuv420p -c:v libvpx-vp9 -b:v 200k a.webm"),
        ("a.gif", "-f lavfi -i testsrc2=s=64x48:r=10:d=1 a.gif"),
    ] {
        if ffmpeg(place.dir.path(), arguments) {
            clips.push(name);
        }
    }
    for clip in clips {
        for cache_bytes in [None, Some(0)] {
            let options = OpenOptions { cache_bytes, recent_frames: Some(4), ..place.options() };
            assert_exact(&open(&place.path(clip), &options).unwrap());
        }
    }
}

#[test]
fn real_clips_are_exact_with_both_decoders() {
    const FORKS: &str = "video/tuning_forks/tuning_";
    let clips: [(String, u32, Option<f64>, bool); 9] = [
        ("video/malva.mp4".to_owned(), 378, None, true),
        ("video/leaves_cut.mp4".to_owned(), 175, None, true),
        ("video/reeds_wind.mp4".to_owned(), 870, None, true),
        ("video/mdn_flower_cc0.mp4".to_owned(), 150, None, true),
        (format!("{FORKS}32hz_500fps.mp4"), 1728, Some(500.0), true),
        (format!("{FORKS}64hz_1000fps.mp4"), 3336, Some(1000.0), true),
        (format!("{FORKS}128hz_250fps.mp4"), 888, Some(250.0), true),
        ("video/WavingTrees".to_owned(), 287, None, false),
        ("video/tree.avi".to_owned(), 68, None, false),
    ];
    for (name, n_frames, fps, is_h264) in clips {
        let Some(path) = data(&name) else { return };
        let place = Place::new();
        let mut found = Vec::new();
        for decoder in [Decoder::Builtin, Decoder::Ffmpeg] {
            let takes_it = match decoder {
                Decoder::Builtin => is_h264 || path.is_dir(),
                _ => !path.is_dir() && ffmpeg_version().is_some(),
            };
            if takes_it {
                let media = open(&path, &OpenOptions { fps, decoder, ..place.options() }).unwrap();
                assert_eq!(media.clip().n_frames(), n_frames, "{name}");
                found.push((media.clip().clone(), assert_exact(&media)));
            }
        }
        assert!(found.windows(2).all(|pair| pair[0] == pair[1]), "{name}: the decoders differ");
        if let (Some(fps), Some((clip, _))) = (fps, found.first()) {
            assert_eq!(clip.times.get(n_frames - 1), Some(f64::from(n_frames - 1) / fps), "{name}");
        }
    }
}

#[test]
fn tree_avi_has_its_own_times() {
    let Some(path) = data("video/tree.avi") else { return };
    if ffmpeg_version().is_none() {
        eprintln!("skipped: needs ffmpeg");
        return;
    }
    let media = open(&path, &Place::new().options()).unwrap();
    let times = &media.clip().times;
    // Slots 0, 11, 17, 24 of 15 fps; the second frame of an even rate would come after 1/15 s.
    let slots: Vec<f64> = times.as_slice()[..4].iter().map(|t| t / 0.066_667).collect();
    for (slot, want) in slots.iter().zip([0.0, 11.0, 17.0, 24.0]) {
        assert!((slot - want).abs() < 1e-9, "{slots:?}");
    }
    assert!(times.is_variable());
    assert!(
        media.notes().iter().any(|note| note.contains("68 frames at an irregular rate")),
        "{:?}",
        media.notes()
    );
}

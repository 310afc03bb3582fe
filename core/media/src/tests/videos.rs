//! Videos that ffmpeg makes here: samples against known planes, odd containers, both decoders alike.

use honami_model::picture::Range;

use super::*;
use crate::write::{Format, Movie, Mp4, Y4m};

const SIZE: (u32, u32) = (18, 10);

/// A lossless 4:4:4 source of `n` frames; the planes of each.
fn source(place: &Place, n: u32) -> Vec<[Vec<u8>; 3]> {
    let (width, height) = SIZE;
    let mut file = format!("YUV4MPEG2 W{width} H{height} F25:1 Ip C444\n").into_bytes();
    let mut frames = Vec::new();
    for k in 0..n {
        // Within the limited range, so that no step has a reason to clip.
        let planes = [k, k + 50, k + 90].map(|seed| {
            gray(width, height, seed).into_raw().iter().map(|v| 16 + v % 200).collect::<Vec<u8>>()
        });
        file.extend(b"FRAME\n");
        file.extend(planes.concat());
        frames.push(planes);
    }
    std::fs::write(place.path("source.y4m"), file).unwrap();
    frames
}

#[test]
fn luma_is_untouched_in_every_sampling_and_depth() {
    let place = Place::new();
    let frames = source(&place, 3);
    for (format, colour, range) in [
        ("yuv420p", true, Range::Limited),
        ("yuv422p", true, Range::Limited),
        ("yuv444p", true, Range::Limited),
        ("yuv420p10le", true, Range::Limited),
        ("yuv422p10le", true, Range::Limited),
        ("yuv444p12le", true, Range::Limited),
    ] {
        let name = format!("{format}.mkv");
        let make = format!(
            "-i source.y4m -c:v ffv1 -pix_fmt {format} -sws_dither none -sws_flags accurate_rnd {name}"
        );
        if !ffmpeg(place.dir.path(), &make) {
            return;
        }
        let media = place.open(&name);
        assert_eq!(media.has_colour(), colour, "{format}");
        for (n, want) in (0..).zip(&frames) {
            let frame = media.frame(n).unwrap();
            assert_eq!(frame.planes().range, range, "{format}");
            assert_eq!(frame.planes().y.data, want[0], "{format}, frame {n}");
        }
    }
}

#[test]
fn rgb_and_gray_video_is_what_images_are() {
    let place = Place::new();
    let folder = place.path("frames");
    std::fs::create_dir(&folder).unwrap();
    for k in 0..3 {
        rgb(18, 10, k).save(folder.join(format!("{k}.png"))).unwrap();
    }
    let gray_folder = place.png_folder("gray", 3, 18, 10);
    assert!(gray_folder.is_dir());
    for (input, make) in [
        ("frames", "-i frames/%d.png -c:v png out.mkv"),
        ("frames", "-i frames/%d.png -c:v ffv1 -pix_fmt bgr0 out.mkv"),
        ("gray", "-i gray/f%d.png -c:v ffv1 -pix_fmt gray out.mkv"),
        ("gray", "-i gray/f%d.png -c:v ffv1 -pix_fmt gray16le out.mkv"),
    ] {
        if !ffmpeg(place.dir.path(), make) {
            return;
        }
        let (video, images) = (place.open("out.mkv"), place.open(input));
        assert_eq!(video.frame(0).unwrap().planes().range, Range::Full, "{make}");
        assert_eq!(bytes_of(&video), bytes_of(&images), "{make}");
    }
}

#[test]
fn both_decoders_agree_on_h264() {
    let place = Place::new();
    let size = "-f lavfi -i testsrc2=s=98x66:r=30:d=2";
    let test = &format!("{size} -pix_fmt yuv420p -c:v libx264");
    // Noise makes the encoder use all its tools.
    let noisy = format!("{size} -vf noise=alls=14:allf=t -pix_fmt yuv420p -c:v libx264 -bf 3");
    for (name, make, range, note) in [
        ("b-frames", format!("{noisy} -x264-params b-pyramid=normal:ref=4"), Range::Limited, None),
        ("temporal direct", format!("{noisy} -x264-params direct=temporal"), Range::Limited, None),
        ("explicit weights", format!("{noisy} -x264-params weightp=2 -vf fade=d=2"), Range::Limited, None),
        ("slices", format!("{noisy} -x264-params slices=3"), Range::Limited, None),
        ("no CABAC", format!("{noisy} -x264-params cabac=0:8x8dct=1"), Range::Limited, None),
        ("lossy", format!("{noisy} -crf 45"), Range::Limited, None),
        ("baseline", format!("{test} -profile:v baseline"), Range::Limited, None),
        ("intra", format!("{test} -g 1"), Range::Limited, None),
        ("full range", test.replace("yuv420p", "yuvj420p"), Range::Full, None),
        (
            "variable rate",
            format!("{test} -vf select=not(mod(n\\,5))+eq(n\\,7) -fps_mode vfr"),
            Range::Limited,
            Some("irregular"),
        ),
        ("faststart", format!("{test} -movflags +faststart -bf 2"), Range::Limited, None),
        ("not square", format!("{test} -vf setsar=4/3"), Range::Limited, Some("square")),
    ] {
        let make = format!("{make} out.mp4");
        if !ffmpeg(place.dir.path(), &make) {
            return;
        }
        agree(&place, "out.mp4", name, range, note);
    }
    // Cut within a group of pictures without decoding: an edit list hides the frames before.
    ffmpeg(place.dir.path(), &format!("{test} -bf 2 -g 60 long.mp4"));
    ffmpeg(place.dir.path(), "-ss 0.7 -i long.mp4 -c copy cut.mp4");
    agree(&place, "cut.mp4", "edit list", Range::Limited, None);
    for (degrees, note) in [("90", "turned"), ("180", "turned"), ("270", "turned")] {
        ffmpeg(place.dir.path(), &format!("-i long.mp4 -c copy -metadata:s:v:0 rotate={degrees} turned.mp4"));
        agree(&place, "turned.mp4", degrees, Range::Limited, Some(note));
    }
}

fn agree(place: &Place, file: &str, name: &str, range: Range, note: Option<&str>) {
    let [one, other] = [Decoder::Ffmpeg, Decoder::Builtin]
        .map(|decoder| open(&place.path(file), &OpenOptions { decoder, ..place.options() }).unwrap());
    assert_eq!(one.clip(), other.clip(), "{name}");
    assert_eq!(bytes_of(&one), bytes_of(&other), "{name}");
    assert_eq!(one.notes().len(), other.notes().len(), "{name}: {:?} {:?}", one.notes(), other.notes());
    for media in [&one, &other] {
        assert_eq!(media.frame(0).unwrap().planes().range, range, "{name}");
        assert_eq!(media.clip().times.get(0), Some(0.0), "{name}");
        let said = note.is_none_or(|note| media.notes().iter().any(|said| said.contains(note)));
        assert!(said, "{name}: {:?}", media.notes());
    }
}

#[test]
fn rotation_makes_upright() {
    let place = Place::new();
    // White in the upper left corner of a lying picture. ffmpeg itself turns it upright for the expected bytes.
    let make = "-f lavfi -i color=black:s=64x32:d=0.2 -vf drawbox=w=16:h=16:c=white:t=fill -pix_fmt yuv420p -c:v libx264";
    if !ffmpeg(place.dir.path(), &format!("{make} lying.mp4")) {
        return;
    }
    let lying = place.open("lying.mp4");
    assert_eq!((lying.clip().width, lying.clip().height), (64, 32));
    for degrees in [90, 180, 270] {
        let turn = format!("-i lying.mp4 -c copy -metadata:s:v:0 rotate={degrees} turned.mp4");
        ffmpeg(place.dir.path(), &turn);
        ffmpeg(place.dir.path(), "-i turned.mp4 -f yuv4mpegpipe -pix_fmt yuv420p upright.y4m");
        let (turned, upright) = (place.open("turned.mp4"), place.open("upright.y4m"));
        assert_eq!(turned.clip().width, if degrees == 180 { 64 } else { 32 });
        assert_eq!(bytes_of(&turned), bytes_of(&upright), "{degrees}");
    }
}

#[test]
fn a_miscounted_stream_is_counted_the_next_time() {
    let place = Place::new();
    if !ffmpeg(place.dir.path(), "-f lavfi -i testsrc2=s=64x48:r=10:d=1 -pix_fmt yuvj420p -c:v mjpeg a.avi") {
        return;
    }
    // One packet becomes rubbish: it is in the index, but gives no frame.
    let mut file = std::fs::read(place.path("a.avi")).unwrap();
    let starts: Vec<usize> =
        (0..file.len() - 3).filter(|&at| file[at..].starts_with(&[0xff, 0xd8, 0xff])).collect();
    file[starts[4]..starts[5] - 16].fill(0);
    std::fs::write(place.path("b.avi"), file).unwrap();
    let media = place.open("b.avi");
    let n = media.clip().n_frames();
    let error = media.frame(n - 1).unwrap_err().to_string();
    assert!(error.contains(&format!("its index promises {n}; open it again")), "{error}");
    drop(media);
    let again = place.open("b.avi");
    assert_eq!(again.clip().n_frames(), n - 1);
    assert!(again.clip().times.is_variable(), "the gap stays");
    assert_exact(&again);
}

#[test]
fn movies_come_back() {
    let place = Place::new();
    for (colour, range) in [(false, Range::Full), (true, Range::Full), (true, Range::Limited)] {
        let (width, height) = (36, 20);
        let format = Format { width, height, fps: 30_000.0 / 1001.0, colour, range };
        let shape = crate::source::Shape { width, height, colour, range };
        // Smooth, so that compression keeps it close.
        let frames: Vec<Vec<u8>> =
            (0..5).map(|k| (0..shape.frame_len()).map(|at| 60 + (at % 36) as u8 + 4 * k).collect()).collect();
        let mut movies: Vec<(&str, Box<dyn Movie>)> =
            vec![("out.y4m", Box::new(Y4m::create(&place.path("out.y4m"), &format).unwrap()))];
        match Mp4::create(&place.path("out.mp4"), &format) {
            Ok(movie) => movies.push(("out.mp4", Box::new(movie))),
            Err(error) => assert!(error.to_string().contains("apt install ffmpeg"), "{error}"),
        }
        for (name, mut movie) in movies {
            frames.iter().for_each(|frame| movie.push(&shape.planes(frame)).unwrap());
            movie.finish().unwrap();
            let media = place.open(name);
            assert_eq!(media.frame(0).unwrap().planes().range, range, "{name}");
            assert!((media.clip().times.nominal_fps().unwrap() - format.fps).abs() < 1e-6, "{name}");
            assert_eq!(media.clip().n_frames(), 5, "{name}");
            for (got, want) in bytes_of(&media).iter().zip(&frames) {
                let luma = || got[..720].iter().zip(&want[..720]);
                let worst = luma().map(|(a, b)| a.abs_diff(*b)).max().unwrap();
                assert!(worst <= if name == "out.y4m" { 0 } else { 6 }, "{name} {colour} {range:?}: {worst}");
            }
        }
    }
}

/// Players guess by the size of a picture where nothing is said, and ffmpeg, told nothing else, makes the RGB of it that went in.
#[test]
fn compressed_movies_say_how_their_colours_are_meant() {
    let place = Place::new();
    let pixels = vec![[200, 40, 60]; 1280 * 720];
    for range in [Range::Limited, Range::Full] {
        let format = Format { width: 1280, height: 720, fps: 25.0, colour: true, range };
        let Ok(movie) = Mp4::create(&place.path("out.mp4"), &format) else { return };
        let mut movie: Box<dyn Movie> = Box::new(movie);
        movie.push_rgb(&pixels).unwrap();
        movie.finish().unwrap();
        let shown = std::process::Command::new("ffprobe")
            .args([
                "-v",
                "error",
                "-show_entries",
                "stream=color_space,color_primaries,color_transfer,color_range",
            ])
            .args(["-of", "default=noprint_wrappers=1"])
            .arg(place.path("out.mp4"))
            .output()
            .unwrap();
        let shown = String::from_utf8(shown.stdout).unwrap();
        let word = if range == Range::Full { "pc" } else { "tv" };
        for (name, value) in
            [("range", word), ("space", "smpte170m"), ("primaries", "bt709"), ("transfer", "iec61966-2-1")]
        {
            assert!(shown.lines().any(|line| line == format!("color_{name}={value}")), "{name}: {shown}");
        }
        ffmpeg(place.dir.path(), "-i out.mp4 -pix_fmt rgb24 -f rawvideo out.rgb");
        let [r, g, b] = std::fs::read(place.path("out.rgb")).unwrap()[..3].try_into().unwrap();
        let off = [r, g, b].iter().zip(pixels[0]).map(|(a, b): (&u8, u8)| a.abs_diff(b)).max().unwrap();
        assert!(off <= 4, "{range:?}: {r} {g} {b}");
    }
}

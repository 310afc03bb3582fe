//! Bad input: one clear line each, and nothing left behind.

use std::sync::Arc;

use super::*;
use crate::MediaError;
use crate::source::{Decode, Source};

/// The error of opening, or else of reading the last frame.
fn failure(place: &Place, name: &str, decoder: Decoder) -> String {
    let options = OpenOptions { decoder, ..place.options() };
    let error = open(&place.path(name), &options)
        .and_then(|media| media.frame(media.clip().n_frames() - 1).map(drop));
    let line = error.expect_err(name).to_string();
    assert!(!line.contains('\n') && line.len() < 400, "{line}");
    line
}

#[test]
fn without_any_program() {
    let place = Place::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(place.path(name), bytes).unwrap();
    let y4m = |body: &[u8]| [b"YUV4MPEG2 W4 H2 F25:1 Cmono\n", body].concat();
    let frame = b"FRAME\n01234567";
    std::fs::create_dir(place.path("empty")).unwrap();
    let mixed = place.png_folder("mixed", 3, 8, 8);
    gray(9, 8, 3).save(mixed.join("f3.png")).unwrap();
    let both = place.png_folder("both", 3, 8, 8);
    (0..3).for_each(|k| gray(8, 8, k).save(both.join(format!("right{k}.png"))).unwrap());
    let cut = place.png_folder("cut", 3, 8, 8);
    let whole = std::fs::read(cut.join("f2.png")).unwrap();
    std::fs::write(cut.join("f2.png"), &whole[..whole.len() / 2]).unwrap();
    write("nothing.mp4", b"");
    write("a.y4m", &y4m(b""));
    write("b.y4m", &y4m(&[frame.as_slice(), b"FRAME\n0123"].concat()));
    write("c.y4m", &y4m(&[frame.as_slice(), b"YUV4MPEG2 W8 H2 F25:1 Cmono\n"].concat()));
    write("d.y4m", &y4m(&[frame.as_slice(), b"PIXELS\n"].concat()));
    write("e.y4m", b"YUV4MPEG2 W0 H2 F25:1\n");
    write("f.y4m", b"YUV4MPEG2 W4 H2 F25:1 C420p10\n");
    write("g.y4m", b"YUV4MPEG2 W4 H2 F25:1");
    write("no index.mp4", b"\0\0\0\x10ftypisom\0\0\0\0\0\0\0\x08mdat");
    write("short.mp4", b"\0\0\0\x10ftypisom\0\0\0\0\0\0\xff\x08moov");
    write("text.mp4", b"This is only a text, whatever its name says.");
    write("fake.png", b"\x89PNG\r\n\x1a\nno more");
    for (name, want) in [
        ("missing.mp4", "no such file, folder or image pattern: "),
        ("nowhere/img%03d.png", "no such file, folder or image pattern: "),
        ("empty", "no PNG, JPEG, TIFF or BMP image in it: "),
        ("mixed/*.jpg", "no PNG, JPEG, TIFF or BMP image in it: "),
        ("mixed", "frame 3 is 9x8, the frames before it are 8x8; a clip has one size: "),
        ("both", "holds several image sequences (f*.png, right*.png); name one of them as a pattern: "),
        ("cut", "damaged or cut short ("),
        ("nothing.mp4", "has no frame: "),
        ("a.y4m", "has no frame: "),
        ("b.y4m", "damaged or cut short (the file ends within frame 1): "),
        ("c.y4m", "damaged or cut short (a second stream begins at frame 1): "),
        ("d.y4m", "damaged or cut short (no frame where frame 1 should begin): "),
        ("e.y4m", "damaged or cut short (its frames are said to be 0x2): "),
        ("f.y4m", "Y4M with samples C420p10; 8-bit mono, 420, 422 and 444 are read: "),
        ("g.y4m", "damaged or cut short (a header line has no end): "),
        ("no index.mp4", "damaged or cut short (it has no index (moov box)): "),
        ("short.mp4", "damaged or cut short (the file ends within its index): "),
        ("text.mp4", "this kind of file needs ffmpeg (apt install ffmpeg): "),
        ("fake.png", "damaged or cut short ("),
    ] {
        let line = failure(&place, name, Decoder::Builtin);
        assert!(line.starts_with(want), "{name}: {line}");
        assert!(line.contains(place.dir.path().to_str().unwrap()), "{name}: {line}");
        assert!(place.cached().is_empty(), "{name} left {:?}", place.cached());
    }
    place.png_folder("good", 2, 4, 4);
    for fps in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error =
            open(&place.path("good"), &OpenOptions { fps: Some(fps), ..place.options() }).unwrap_err();
        assert!(matches!(error, MediaError::Rate { .. }), "{error}");
    }
    let beyond = place.open("good").frame(2).unwrap_err().to_string();
    assert_eq!(beyond, "frame 2 of a clip of 2 frames (they count from 0)");
}

#[test]
fn videos() {
    let place = Place::new();
    let test = "-f lavfi -i testsrc2=r=25:d=1";
    if !ffmpeg(
        place.dir.path(),
        &format!("{test}:s=64x48 -pix_fmt yuv420p -c:v libx264 -movflags +faststart good.mp4"),
    ) {
        return;
    }
    let make = |arguments: &str| assert!(ffmpeg(place.dir.path(), arguments));
    make(&format!("{test}:s=64x48 -c:v mpeg4 part2.mp4"));
    make(&format!("{test}:s=64x48 -pix_fmt yuv420p10le -c:v libx264 ten.mp4"));
    make(&format!(
        "{test}:s=64x48 -pix_fmt yuv420p -c:v libx264 -movflags frag_keyframe+empty_moov pieces.mp4"
    ));
    make("-f lavfi -i sine=d=1 sound.mp4");
    make(&format!("{test}:s=64x48 -c:v mjpeg a.avi"));
    for (name, size) in [("a.mjpeg", "64x48"), ("b.mjpeg", "96x80")] {
        make(&format!("{test}:s={size} -pix_fmt yuvj420p -c:v mjpeg -f mjpeg {name}"));
    }
    let [a, b] = ["a.mjpeg", "b.mjpeg"].map(|name| std::fs::read(place.path(name)).unwrap());
    std::fs::write(place.path("grows.mjpeg"), [a, b].concat()).unwrap();
    let whole = std::fs::read(place.path("good.mp4")).unwrap();
    std::fs::write(place.path("cut.mp4"), &whole[..whole.len() * 2 / 3]).unwrap();
    std::fs::write(place.path("head.mp4"), &whole[..60]).unwrap();
    std::fs::write(place.path("notes.txt"), "A text, line by line.\n".repeat(50)).unwrap();
    let mut noise = vec![0; 5000];
    rand::Rng::fill_bytes(&mut Pcg64Mcg::seed_from_u64(7), &mut noise);
    std::fs::write(place.path("noise.mov"), noise).unwrap();
    for (name, decoder, want) in [
        ("cut.mp4", Decoder::Ffmpeg, "damaged or cut short ("),
        ("cut.mp4", Decoder::Builtin, "damaged or cut short (the file ends before sample "),
        ("head.mp4", Decoder::Ffmpeg, "not a video ("),
        ("head.mp4", Decoder::Builtin, "damaged or cut short ("),
        ("notes.txt", Decoder::Ffmpeg, "not a video (a text file): "),
        ("noise.mov", Decoder::Ffmpeg, "not a video ("),
        ("sound.mp4", Decoder::Ffmpeg, "not a video (no video stream in it): "),
        ("sound.mp4", Decoder::Builtin, "not a video (no video stream in it): "),
        ("part2.mp4", Decoder::Builtin, "mp4v video needs ffmpeg (apt install ffmpeg): "),
        ("ten.mp4", Decoder::Builtin, "H.264 of more than 8 bits needs ffmpeg (apt install ffmpeg): "),
        ("pieces.mp4", Decoder::Builtin, "a fragmented MP4 needs ffmpeg (apt install ffmpeg): "),
        ("a.avi", Decoder::Builtin, "this kind of file needs ffmpeg (apt install ffmpeg): "),
        (
            "grows.mjpeg",
            Decoder::Ffmpeg,
            "frame 25 is 96x80, the frames before it are 64x48; a clip has one size: ",
        ),
    ] {
        let line = failure(&place, name, decoder);
        assert!(line.starts_with(want), "{name}: {line}");
        let left: Vec<_> = place.cached().into_iter().filter(|kind| kind != "recount").collect();
        assert!(left.is_empty(), "{name} left {left:?}");
    }
    assert_exact(&place.open("pieces.mp4"));
}

/// Damaged files may fail in any way but by a panic or without an end, with the cache as without it.
#[test]
fn damaged_mp4_never_panics() {
    let place = Place::new();
    let make = "-f lavfi -i testsrc2=s=48x32:r=10:d=1 -pix_fmt yuv420p -c:v libx264 -bf 2 -g 5 a.mp4";
    if !ffmpeg(place.dir.path(), make) {
        return;
    }
    let sound = std::fs::read(place.path("a.mp4")).unwrap();
    let moov = sound.windows(4).position(|w| w == b"moov").unwrap();
    // Frames up to the first error, and that.
    let outcome = |cache_bytes| {
        let options = OpenOptions { decoder: Decoder::Builtin, cache_bytes, ..place.options() };
        let mut frames = Vec::new();
        let end = open(&place.path("b.mp4"), &options).and_then(|media| {
            let mut keep = |n| media.frame(n).map(|frame| frames.push(frame.bytes().to_vec()));
            (0..media.clip().n_frames()).try_for_each(&mut keep)
        });
        let line = end.err().map(|error| error.to_string());
        assert!(line.as_ref().is_none_or(|line| !line.contains("breaks down")), "{line:?}");
        (frames, line)
    };
    let mut n_opened = 0;
    for seed in 0..400 {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut bytes = sound.clone();
        // One time in two the index, which is small, else anywhere.
        let range = if seed % 2 == 0 { moov..bytes.len() } else { 0..bytes.len() };
        for _ in 0..random.random_range(1..4) {
            bytes[random.random_range(range.clone())] = random.random();
        }
        std::fs::write(place.path("b.mp4"), &bytes).unwrap();
        let on_demand = outcome(Some(0));
        n_opened += u32::from(!on_demand.0.is_empty());
        assert!(outcome(None) == on_demand, "seed {seed}: the cache makes a difference");
    }
    assert!(n_opened > 100, "{n_opened} of 400 could be opened");
}

/// Gives two frames, then panics.
struct Breaking;

struct Giving(u8);

impl Source for Breaking {
    fn recipe(&self) -> String {
        "breaking".to_owned()
    }

    fn decode(&self, _wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        Ok((0, Box::new(Giving(0))))
    }
}

impl Decode for Giving {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        assert!(self.0 < 2, "no code 77\nat all");
        frame.fill(self.0);
        self.0 += 1;
        Ok(true)
    }
}

#[test]
fn a_panic_of_the_decoder_is_an_error_for_every_reader() {
    let place = Place::new();
    let shape = Shape { width: 4, height: 2, colour: false, range: honami_model::picture::Range::Full };
    let (source, filling) = (Arc::new(Breaking), place.filling(shape, 4));
    for media in [
        Media::filling(place.head(shape, 4), source.clone(), filling).unwrap(),
        Media::on_demand(place.head(shape, 4), source),
    ] {
        std::thread::scope(|scope| {
            for n in [2, 3, 2] {
                let media = &media;
                scope.spawn(move || {
                    let line = media.frame(n).unwrap_err().to_string();
                    let want = "damaged or cut short (the decoder breaks down on it: no code 77; copy it";
                    assert!(line.starts_with(want) && !line.contains('\n'), "{line}");
                });
            }
        });
        assert!(place.cached().is_empty(), "{:?}", place.cached());
        assert_eq!([0, 1].map(|n| media.frame(n).unwrap().bytes()[7]), [0, 1]);
    }
}

#[test]
fn writers_leave_nothing_half_made() {
    use crate::write::{Format, create};
    use honami_model::picture::Range;
    let place = Place::new();
    let format = Format { width: 4, height: 2, fps: 25.0, colour: false, range: Range::Full };
    let (shape, other) = ([16_u8; 8], [16_u8; 6]);
    let planes = |data, width| honami_model::picture::Planes {
        y: honami_model::picture::Gray::packed(data, width, 2),
        uv: None,
        range: Range::Full,
    };
    for name in ["a.y4m", "images", "a.mp4"] {
        let mut movie = match create(&place.path(name), &format) {
            Ok(movie) => movie,
            Err(error) => {
                assert!(error.to_string().contains("apt install ffmpeg"), "{name}: {error}");
                continue;
            }
        };
        movie.push(&planes(&shape, 4)).unwrap();
        let error = movie.push(&planes(&other, 3)).unwrap_err().to_string();
        assert_eq!(error, "a frame of 3x2 gray Full range cannot go into a movie of 4x2 gray Full range");
        drop(movie);
        assert!(place.names("").is_empty(), "{name} left {:?}", place.names(""));
    }
    let missing = format!("{} is no folder: make it first", place.path("nowhere").display());
    for (name, want) in [
        ("nowhere/a.y4m", missing.as_str()),
        ("nowhere/a.mp4", &missing),
        ("a.png", "movies are written as .mp4, .y4m or a folder of PNG images, not .png: "),
        ("a.webm", "movies are written as .mp4, .y4m or a folder of PNG images, not .webm: "),
    ] {
        let line = create(&place.path(name), &format).err().expect(name).to_string();
        assert!(line.starts_with(want), "{line}");
    }
    std::fs::create_dir(place.path("full")).unwrap();
    std::fs::write(place.path("full/mine.txt"), "mine").unwrap();
    let line = create(&place.path("full"), &format).err().expect("a full folder").to_string();
    assert!(line.contains("not an empty folder"), "{line}");
    assert_eq!(place.names("full"), ["mine.txt"]);
}

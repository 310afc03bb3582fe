//! Every kind of image and of Y4M against bytes worked out here, in floating point.

use honami_model::picture::Range;
use image::codecs::jpeg::JpegEncoder;

use super::*;
use crate::open_images;

/// Rounded mean of a block, a rounding of .5 upwards.
fn mean(values: &[u8]) -> u8 {
    (values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64 + 0.5).floor() as u8
}

/// Means of 2x2 blocks of a plane, fewer at the edges.
fn half(plane: &[u8], width: usize, across: usize, down: usize) -> Vec<u8> {
    let rows: Vec<&[u8]> = plane.chunks(width).collect();
    let blocks = rows.chunks(down).flat_map(|rows| {
        (0..width).step_by(across).map(|x| {
            let block: Vec<u8> =
                rows.iter().flat_map(|row| &row[x..(x + across).min(width)]).copied().collect();
            mean(&block)
        })
    });
    blocks.collect()
}

#[test]
fn images_in_natural_order_with_any_name() {
    let place = Place::new();
    let folder = place.path("my plant");
    std::fs::create_dir(&folder).unwrap();
    for (name, frame) in [("leaf 10.PNG", 2), ("leaf 2.PNG", 1), ("Leaf 1.PNG", 0), ("leaf 11.PNG", 3)] {
        gray(9, 7, frame).save(folder.join(name)).unwrap();
    }
    std::fs::write(folder.join("notes.txt"), "not an image").unwrap();
    let want = |frame| gray(9, 7, frame).into_raw();
    for path in ["my plant", "my plant/?eaf *.PNG"] {
        let media = place.open(path);
        assert_eq!(media.clip().times.nominal_fps(), Some(25.0));
        assert!(media.notes().iter().any(|note| note.contains("25 fps")), "{:?}", media.notes());
        assert_eq!(bytes_of(&media), [0, 1, 2, 3].map(want));
    }
    let named = ["leaf 11.PNG", "Leaf 1.PNG"].map(|name| folder.join(name));
    let listed = open_images(&named, &place.options()).unwrap();
    assert_eq!(bytes_of(&listed), [want(3), want(0)], "as they are listed");
    let numbered = place.open("my plant/leaf %d.PNG");
    assert_eq!(numbered.clip().n_frames(), 3, "the L of the first one is upper-case");
    let timed = open(&folder, &OpenOptions { fps: Some(500.0), ..place.options() }).unwrap();
    assert_eq!(timed.clip().times.get(3), Some(3.0 / 500.0));
    assert!(timed.notes().is_empty(), "{:?}", timed.notes());
}

#[test]
fn every_kind_of_gray_image() {
    let place = Place::new();
    let narrow = |v: u16| (f64::from(v) / 257.0).round() as u8;
    let picture = gray(11, 6, 3);
    let wide = ImageBuffer::from_fn(11, 6, |x, y| image::Luma([(x * 6007 + y * 811) as u16]));
    picture.save(place.path("a.BMP")).unwrap();
    picture.save(place.path("a.TIF")).unwrap();
    wide.save(place.path("b.tiff")).unwrap();
    wide.save(place.path("b.png")).unwrap();
    let flat = GrayImage::from_pixel(11, 6, image::Luma([131]));
    let jpeg = std::fs::File::create(place.path("c.JPEG")).unwrap();
    JpegEncoder::new_with_quality(jpeg, 100).encode_image(&flat).unwrap();
    let from_wide: Vec<u8> = wide.as_raw().iter().map(|&v| narrow(v)).collect();
    for (name, want) in [
        ("a.TIF", picture.as_raw()),
        ("b.tiff", &from_wide),
        ("b.png", &from_wide),
        ("c.JPEG", flat.as_raw()),
    ] {
        let media = place.open(name);
        assert_eq!(media.frame(0).unwrap().bytes(), want, "{name}");
        assert!(!media.has_colour(), "{name}");
    }
    // BMP has no gray: a palette comes as colour, and gray stays exactly gray.
    let bmp = place.open("a.BMP");
    assert_eq!(bmp.frame(0).unwrap().planes().y.data, picture.as_raw().as_slice());
}

#[test]
fn rgb_becomes_full_range_bt601() {
    let place = Place::new();
    let (width, height) = (7, 5);
    let picture = rgb(width, height, 1);
    let wide: ImageBuffer<image::Rgb<u16>, Vec<u16>> = DynamicImage::from(picture.clone()).into_rgb16();
    picture.save(place.path("a.png")).unwrap();
    picture.save(place.path("a.bmp")).unwrap();
    wide.save(place.path("a.tiff")).unwrap();
    let planes = |gains: [f64; 3], bias: f64, pixel: [f64; 3]| {
        let value: f64 = gains.iter().zip(pixel).map(|(g, v)| g * v).sum::<f64>() + bias;
        value.round().clamp(0.0, 255.0) as u8
    };
    let want_y: Vec<u8> =
        picture.pixels().map(|p| planes([0.299, 0.587, 0.114], 0.0, p.0.map(f64::from))).collect();
    for name in ["a.png", "a.bmp", "a.tiff"] {
        let media = place.open(name);
        let frame = media.frame(0).unwrap();
        let got = frame.planes();
        assert_eq!(got.range, Range::Full);
        assert_eq!(got.y.data, want_y, "{name}");
        let (u, v) = got.uv.unwrap();
        for y in 0..3 {
            for x in 0..4 {
                // The right column and the lower row have no neighbour: they count twice.
                let mut colour = [0.0; 3];
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let p = picture.get_pixel((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                    (0..3).for_each(|c| colour[c] += f64::from(p.0[c]) / 4.0);
                }
                let at = (4 * y + x) as usize;
                assert_eq!(u[at], planes([-0.168_736, -0.331_264, 0.5], 128.0, colour), "{name} Cb {x},{y}");
                assert_eq!(v[at], planes([0.5, -0.418_688, -0.081_312], 128.0, colour), "{name} Cr {x},{y}");
            }
        }
    }
}

#[test]
fn y4m_of_odd_size_in_every_sampling() {
    let place = Place::new();
    let (width, height) = (7_usize, 5_usize);
    let y = gray(7, 5, 1).into_raw();
    for (samples, chroma_size, across, down) in [
        ("mono", None, 0, 0),
        ("420jpeg", Some((4, 3)), 1, 1),
        ("422", Some((4, 5)), 1, 2),
        ("444", Some((7, 5)), 2, 2),
    ] {
        let head = format!("YUV4MPEG2 W{width} H{height} F30000:1001 Ip C{samples}\n");
        let mut file = head.into_bytes();
        let mut want = y.clone();
        file.extend(b"FRAME Ixyz\n");
        file.extend(&y);
        for seed in [5, 6] {
            let Some((w, h)) = chroma_size else { break };
            let chroma = gray(w, h, seed).into_raw();
            want.extend(half(&chroma, w as usize, across, down));
            file.extend(&chroma);
        }
        file.extend(b"FRAME\n");
        file.extend(vec![77; want_stored(samples)]);
        std::fs::write(place.path("a.y4m"), &file).unwrap();
        let media = place.open("a.y4m");
        assert_eq!(media.frame(0).unwrap().bytes(), want, "{samples}");
        assert!(media.frame(1).unwrap().bytes().iter().all(|&b| b == 77), "{samples}");
        assert_eq!(media.clip().times.as_slice(), [0.0, 1001.0 / 30_000.0]);
        assert_eq!(media.frame(0).unwrap().planes().range, Range::Limited);
        assert!(place.cached().is_empty(), "it is raw already");
    }
}

/// Bytes of a 7x5 frame in a Y4M file.
fn want_stored(samples: &str) -> usize {
    35 + match samples {
        "420jpeg" => 24,
        "422" => 40,
        "444" => 70,
        _ => 0,
    }
}

#[test]
fn a_folder_means_its_longest_sequence() {
    let place = Place::new();
    let folder = place.png_folder("trees", 3, 8, 8);
    gray(20, 10, 0).save(folder.join("mask_00247.BMP")).unwrap();
    let media = place.open("trees");
    assert_eq!(media.clip().n_frames(), 3);
    let note = "the sequence is f*.png; 1 other image is left out: mask_00247.BMP";
    assert!(media.notes().contains(&note.to_owned()), "{:?}", media.notes());
    let one = place.open("trees/mask_00247.BMP");
    assert_eq!((one.clip().n_frames(), one.clip().width), (1, 20));
}

#[test]
fn the_hash_names_content_and_order() {
    let place = Place::new();
    let folder = place.png_folder("a", 3, 8, 8);
    let before = place.open("a").sha256();
    assert_eq!(before.len(), 64);
    std::fs::rename(&folder, place.path("b")).unwrap();
    assert_eq!(place.open("b").sha256(), before, "moving the folder changes nothing");
    std::fs::rename(place.path("b/f2.png"), place.path("b/f7.png")).unwrap();
    let renamed = place.open("b").sha256();
    assert_ne!(renamed, before);
    gray(8, 8, 9).save(place.path("b/f7.png")).unwrap();
    assert_ne!(place.open("b").sha256(), renamed);
    std::fs::write(place.path("abc"), "abc").unwrap();
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"; // FIPS 180-2, B.1
    assert_eq!(crate::sha256_of_file(&place.path("abc")).unwrap(), abc);
}

#[test]
fn pictures_that_are_written_are_those_that_are_read() {
    use crate::write::{Format, create};
    let place = Place::new();
    let (width, height) = (7, 5);
    let picture = rgb(width, height, 1);
    picture.save(place.path("a.png")).unwrap();
    let want = bytes_of(&place.open("a.png"));
    let pixels: Vec<[u8; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
    for name in ["a.y4m", "images"] {
        let format = Format { width, height, fps: 25.0, colour: true, range: Range::Full };
        let mut movie = create(&place.path(name), &format).unwrap();
        let error = movie.push_rgb(&pixels[1..]).unwrap_err().to_string();
        assert_eq!(error, "a frame of 34 pixels cannot go into a movie of 35 pixels", "{name}");
        movie.push_rgb(&pixels).unwrap();
        movie.finish().unwrap();
        assert_eq!(bytes_of(&place.open(name)), want, "{name}");
    }
    let first = image::open(place.path("images/frame_00000.png")).unwrap();
    assert_eq!(first.into_rgb8(), picture, "images keep every colour");
}

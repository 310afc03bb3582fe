//! What scribbles and trimaps say, and which say nothing.

use super::*;

const SOURCE: [u8; 3] = [120, 130, 90];

fn scribbled(painted: &[(usize, [u8; 3])]) -> Result<Vec<Mark>, MattingError> {
    // A black and a white pixel of the picture itself are no marks.
    let mut source = vec![SOURCE; 20];
    (source[0], source[1]) = ([0; 3], [255; 3]);
    let mut copy = source.clone();
    painted.iter().for_each(|&(pixel, colour)| copy[pixel] = colour);
    from_scribbles(&Picture::new(5, 4, &source).unwrap(), &Picture::new(5, 4, &copy).unwrap())
}

#[test]
fn what_was_painted_black_or_white_is_marked() {
    let soft = [(4, [200; 3]), (5, [26, 0, 0]), (6, [255, 255, 229])];
    let hard = [(7, [0; 3]), (8, [25, 0, 25]), (9, [255; 3]), (10, [230, 255, 240]), (11, SOURCE)];
    let marks = scribbled(&[&soft[..], &hard[..]].concat()).unwrap();
    let marked = marks.iter().enumerate().filter(|(_, mark)| **mark != Mark::Unknown);
    let marked: Vec<(usize, Mark)> = marked.map(|(pixel, mark)| (pixel, *mark)).collect();
    use Mark::{Background, Foreground};
    assert_eq!(marked, [(7, Background), (8, Background), (9, Foreground), (10, Foreground)]);
}

#[test]
fn a_trimap_is_black_gray_and_white() {
    let source = vec![SOURCE; 12];
    let picture = Picture::new(4, 3, &source).unwrap();
    let trimap = [0, 25, 26, 128, 229, 230, 255, 90, 90, 90, 90, 90];
    let marks = from_trimap(&picture, &trimap, [4, 3]).unwrap();
    let alphas: Vec<Option<f64>> = marks.iter().map(|mark| mark.alpha()).collect();
    assert_eq!(alphas[..7], [Some(0.0), Some(0.0), None, None, None, Some(1.0), Some(1.0)]);
    assert!(alphas[7..].iter().all(|alpha| alpha.is_none()));
    let wrong = MattingError::Size { wanted: [4, 3], came: [3, 4] };
    assert_eq!(from_trimap(&picture, &trimap, [3, 4]), Err(wrong));
    assert_eq!(
        from_trimap(&picture, &trimap[1..], [4, 3]),
        Err(MattingError::Pixels { wanted: 12, came: 11 })
    );
    assert_eq!(from_trimap(&picture, &[128; 12], [4, 3]), Err(MattingError::NothingMarked));
}

#[test]
fn scribbles_that_say_too_little_have_a_name() {
    use MattingError::{NoBackground, NoCopy, NoForeground, NothingMarked, Size};
    assert_eq!(scribbled(&[]), Err(NothingMarked));
    assert_eq!(scribbled(&[(3, [200; 3])]), Err(NothingMarked));
    assert_eq!(scribbled(&[(3, [0; 3])]), Err(NoForeground));
    assert_eq!(scribbled(&[(3, [255; 3])]), Err(NoBackground));
    let noisy: Vec<(usize, [u8; 3])> = (2..8).map(|pixel| (pixel, [121, 130, 90])).collect();
    assert_eq!(scribbled(&noisy), Err(NoCopy { percent: 30 }));

    let (source, other) = ([SOURCE; 12], [SOURCE; 16]);
    let [a, b] = [Picture::new(4, 3, &source).unwrap(), Picture::new(4, 4, &other).unwrap()];
    assert_eq!(from_scribbles(&a, &b), Err(Size { wanted: [4, 3], came: [4, 4] }));
    let said = from_scribbles(&a, &b).unwrap_err().to_string();
    assert_eq!(said, "scribbles or trimap are 4x4 pixels, the picture 4x3: paint on a copy of the picture");
}

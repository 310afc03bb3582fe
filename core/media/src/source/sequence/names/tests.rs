//! Natural order, patterns and what makes a sequence.

use super::*;

#[test]
fn numbers_sort_by_value() {
    let mut names =
        ["img10.png", "img2.png", "IMG1.png", "img02.png", "a.png", "img2b.png", "img2", "10.png", "9.png"];
    names.sort_by(|a, b| natural(a, b));
    assert_eq!(
        names,
        ["9.png", "10.png", "a.png", "IMG1.png", "img2", "img02.png", "img2.png", "img2b.png", "img10.png"]
    );
}

#[test]
fn patterns() {
    for (pattern, name, want) in [
        ("f%d.png", "f7.png", true),
        ("f%d.png", "f123.png", true),
        ("f%04d.png", "f0007.png", true),
        ("f%04d.png", "f12345.png", true),
        ("f%04d.png", "f7.png", false),
        ("f%04d.png", "f00007.png", false),
        ("f%04d.png", "fa007.png", false),
    ] {
        assert_eq!(printf(pattern).is_some_and(|p| p.matches(name)), want, "{pattern} {name}");
    }
    for (pattern, name, want) in [
        ("*.png", "a b.png", true),
        ("*.png", "a.PNG", false),
        ("b?0*.bmp", "b00012.bmp", true),
        ("*a*b", "xaaxbb", true),
        ("*a*b", "xaaxbc", false),
        ("?", "ä", true),
        ("", "a", false),
    ] {
        assert_eq!(glob(pattern, name), want, "{pattern} {name}");
    }
    assert!(printf("100%.png").is_none() && printf("%s.png").is_none());
}

#[test]
fn numberless_names() {
    for (name, want) in [
        ("frame_0001.png", "frame_*.png"),
        ("7.png", "*.png"),
        ("Sample14 L3 Amp0.1b.tif", "Sample14 L3 Amp0.*b.tif"),
        ("ä2ö.png", "ä*ö.png"),
        ("cover.jpg", "cover.jpg"),
    ] {
        assert_eq!(numberless(name), want);
    }
}

//! Scale bars through the real program: kept, told, undone, and what follows from them.

use honami_tests::Bench;

#[test]
fn a_scale_is_kept_undone_and_makes_densities_of_metres() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 40, "--wind wind");
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami");
    assert!(bench.text("scale p.honami").contains("no scale"));
    let density = |unit: &str| {
        let answer = bench.json("spectrum p.honami --csv d.csv");
        assert_eq!(answer["welch"]["unit"], unit);
        let row = honami_tests::rows(&bench.path("d.csv")).into_iter().nth(9).unwrap();
        row["density"].parse::<f64>().unwrap()
    };
    let in_pixels = density("px²/Hz");
    let made = bench.json("scale p.honami 10,20 40,60 --length 50cm --length-error 5mm --frame 3");
    assert_eq!(made["edits"][0]["label"], "scale: 0.5 m are 50.0 px");
    let shown = bench.json("scale p.honami");
    assert_eq!(shown["scale"], made["scale"]);
    let number = |name: &str| shown["scale"][name].as_f64().unwrap();
    assert!((number("m_per_px") - 0.01).abs() < 1e-12, "{shown}");
    // Half a pixel at both ends of 50, and one in a hundred of the length.
    assert!((number("relative_error") - 0.0002_f64.sqrt().hypot(0.01)).abs() < 1e-4, "{shown}");
    // Down to the right, as seen.
    assert!((number("direction_deg") - (180.0 - 53.130_102)).abs() < 1e-3, "{shown}");
    let in_metres = density("m²/Hz");
    assert!((in_metres / in_pixels / 1e-4 - 1.0).abs() < 1e-6, "{in_metres} {in_pixels}");
    let text = bench.text("scale p.honami");
    assert!(text.contains("10.0000 mm/px ± 1.73 %") && text.contains("towards the camera"), "{text}");
    bench.json("scale p.honami --remove");
    assert_eq!(bench.json("scale p.honami")["scale"], serde_json::Value::Null);
    assert!(bench.text("log p.honami").contains("scale removed"));
    density("px²/Hz");
}

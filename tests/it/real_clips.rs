//! Real clips, where `HONAMI_DATA` names a folder that has them: numbers that were measured elsewhere, too.

use honami_tests::{Bench, Row, by_track, data};
use serde_json::Value;

/// Harris corners and a small window, as in the reference run of the data's README.
const HARRIS: &str = "--set method=harris --set quality=0.001 --set distance=5 --set radius=7 --set levels=3 \
                      --set max_features=400";

/// A project `p.honami` of a real clip, and what `new` said of it.
fn project(name: &str, options: &str) -> Option<(Bench, Value)> {
    let clip = data(name)?;
    let bench = Bench::new();
    let args = ["new", "p.honami", clip.to_str().unwrap(), "--json"];
    let new = bench.run(args.into_iter().chain(options.split_whitespace())).json();
    Some((bench, new))
}

/// Tracks that are seen in every frame, each time with less than a pixel between the way there and back.
fn n_kept(samples: &[Row], n_frames: usize) -> usize {
    let is_good = |row: &&Row| row["status"] == "1" && row["fb"].parse::<f64>().is_ok_and(|fb| fb < 1.0);
    let is_kept = |rows: &&Vec<&Row>| {
        rows.len() == n_frames && rows[0]["status"] == "1" && rows[1..].iter().all(is_good)
    };
    by_track(samples).values().filter(is_kept).count()
}

#[test]
fn leaves_in_wind_are_kept_over_the_whole_clip() {
    // Clip, frames, width, height, tracks that must be kept, and how many groups.
    for (name, n_frames, size, at_least) in
        [("video/malva.mp4", 378, [640, 360], 130), ("video/leaves_cut.mp4", 175, [494, 278], 350)]
    {
        let Some((bench, new)) = project(name, "") else { continue };
        assert_eq!(
            (&new["frames"], &new["width"], &new["height"]),
            (&n_frames.into(), &size[0].into(), &size[1].into())
        );
        assert!((new["fps"].as_f64().unwrap() - 25.0).abs() < 1e-6 && new["variable_rate"] == false, "{new}");
        let track = bench.json(&format!("track p.honami --with klt {HARRIS}"));
        assert!(track["tracks"].as_u64().unwrap() <= 400, "{name}: {track}");
        let kept = n_kept(&bench.samples("p.honami"), n_frames);
        assert!(kept >= at_least, "{name}: {kept} tracks are kept");
        let cluster = bench.json("cluster p.honami --groups 4");
        let sizes = cluster["groups"].as_array().unwrap().iter().map(|size| size.as_u64().unwrap());
        assert_eq!(
            (sizes.clone().count(), sizes.sum::<u64>()),
            (4, track["tracks"].as_u64().unwrap()),
            "{name}"
        );
        let spectrum = bench.json("spectrum p.honami");
        let sways = spectrum["lines"][0]["peaks"].as_array().unwrap();
        assert!(sways.iter().all(|peak| peak["may_be_alias"] == false), "{name}: {sways:?}");
    }
}

#[test]
fn tuning_forks_sound_as_they_should() {
    let Some(regions) = data("video/tuning_forks/rois_x_y_w_h.csv") else { return };
    let regions = honami_tests::rows(&regions);
    // Fork and camera; between which frequencies the strongest sway lies, and whether it is an alias.
    for (fork_hz, fps, range_hz, is_alias) in [
        (32, 500, 31.9..32.1, false),
        (64, 1000, 63.9..64.1, false),
        // 128 Hz is above half the frame rate: it looks like 250 - 128 Hz.
        (128, 250, 121.9..122.2, true),
    ] {
        let name = format!("video/tuning_forks/tuning_{fork_hz}hz_{fps}fps.mp4");
        let Some((bench, new)) = project(&name, &format!("--fps {fps}")) else { return };
        assert!((new["fps"].as_f64().unwrap() - f64::from(fps)).abs() < 1e-6, "{name}: {new}");
        let is_it = |row: &&Row| row["fork_hz"] == fork_hz.to_string() && row["true_fps"] == fps.to_string();
        let region = regions.iter().find(is_it).unwrap();
        let region = ["x", "y", "w", "h"].map(|column| region[column].as_str()).join(",");
        bench.json(&format!("track p.honami --with klt --region {region}"));
        let spectrum = bench.json("spectrum p.honami");
        let peak = &spectrum["lines"][0]["peaks"][0];
        assert!(range_hz.contains(&peak["hz"].as_f64().unwrap()), "{name}: {peak}");
        assert_eq!(peak["may_be_alias"], is_alias, "{name}: {peak}");
        assert_eq!(bench.text("spectrum p.honami").contains("may be an alias"), is_alias, "{name}");
        let aliases = peak["aliases_hz"].as_array().unwrap().iter().map(|hz| hz.as_f64().unwrap());
        let n_true = aliases.filter(|hz| (hz - f64::from(fork_hz)).abs() < 0.2).count();
        assert_eq!(n_true, usize::from(is_alias), "{name}: the fork itself is among the aliases: {peak}");
    }
}

#[test]
fn an_irregular_clip_keeps_its_times() {
    let Some((bench, new)) = project("video/tree.avi", "") else { return };
    assert_eq!((&new["frames"], &new["variable_rate"]), (&68.into(), &true.into()));
    let notes = new["notes"].to_string();
    assert!(notes.contains("68") && notes.contains("irregular"), "{notes}");
    bench.json("track p.honami --with klt");
    let samples = bench.samples("p.honami");
    let last =
        samples.iter().filter(|row| row["frame"] == "67").map(|row| row["time_s"].parse::<f64>().unwrap());
    // 68 of 444 slots at 15 fps: the clip lasts half a minute, not 4.5 s.
    assert!(last.clone().count() > 0 && last.into_iter().all(|time_s| time_s > 25.0));
}

#[test]
fn a_folder_of_images_is_a_clip() {
    let Some((bench, new)) = project("video/WavingTrees", "--fps 15") else { return };
    assert_eq!((&new["width"], &new["height"]), (&160.into(), &120.into()));
    assert!([287, 288].map(Value::from).contains(&new["frames"]), "{new}");
    let track = bench.json("track p.honami --with klt --frames 0..40");
    assert!(track["tracks"].as_u64().unwrap() > 20, "{track}");
}

#[test]
fn what_a_hard_clip_loses_is_reported() {
    let Some((bench, _)) = project("video/reeds_wind.mp4", "") else { return };
    let track = bench.json(&format!("track p.honami --with klt --frames 0..60 --set lose_fb=1 {HARRIS}"));
    let (tracks, lost) = (track["tracks"].as_u64().unwrap(), track["lost"].as_u64().unwrap());
    assert!(lost * 2 > tracks, "reeds in a storm are not followed by such a tracker: {track}");
    let samples = bench.samples("p.honami");
    let is_last_lost = |rows: &&Vec<&Row>| rows.last().unwrap()["status"] != "1" || rows.len() < 60;
    let left = track["outside"].as_u64().unwrap();
    assert_eq!(by_track(&samples).values().filter(is_last_lost).count() as u64, lost + left, "{track}");
}

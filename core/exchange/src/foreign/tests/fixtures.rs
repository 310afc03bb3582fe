//! Small files as other programs write them, from their published descriptions, and what is wrong with wrong ones.

use std::io::Write as _;

use super::*;

/// Each track: number, name, and its samples as `frame x y status`, a `*` behind key-frames.
fn told(read: &ForeignTracks) -> Vec<String> {
    let line = |track: &ForeignTrack| {
        let called = format!("{:?} {}", track.number, track.name.as_deref().unwrap_or("-"));
        let samples = track.samples().map(|(frame, s)| {
            let key = if s.source == Source::Key { "*" } else { "" };
            format!(" | {frame} {} {} {:?}{key}", s.x, s.y, s.status)
        });
        std::iter::once(called).chain(samples).collect()
    };
    read.tracks.iter().map(line).collect()
}

fn options() -> ReadOptions {
    ReadOptions::of(SIZE)
}

fn text(format: Format, text: &str) -> ForeignTracks {
    assert_eq!(Format::of_content(text.as_bytes()), Some(format));
    parse(text.as_bytes(), format, &options()).unwrap()
}

#[test]
fn cvat_for_video() {
    let read = text(
        Format::Cvat,
        r#"<?xml version="1.0" encoding="utf-8"?>
<annotations><version>1.1</version>
<meta><task><size>12</size><original_size><width>320</width><height>240</height></original_size></task></meta>
<track id="4" label="leaf &amp; stem" source="manual">
  <points frame="2" keyframe="1" outside="0" occluded="0" points="10.50,20.50" z_order="0">
    <attribute name="side">left</attribute></points>
  <points frame="3" keyframe="0" outside="0" occluded="1" points="11.5,20.5" z_order="0"/>
  <points frame="4" keyframe="1" outside="1" occluded="0" points="12.5,20.5" z_order="0"/>
</track>
<track id="5" label="track"><box frame="0" outside="0" occluded="0" keyframe="1" xtl="1" ytl="1" xbr="2" ybr="2"/></track>
<track id="6" label="pair"><points frame="0" keyframe="1" outside="0" occluded="0" points="1,1;2,2"/>
  <skeleton frame="0"><points label="a" frame="0" keyframe="1" outside="0" occluded="0" points="3,3"/></skeleton></track>
</annotations>"#,
    );
    assert_eq!(told(&read), ["Some(4) leaf & stem | 2 10 20 Tracked* | 3 11 20 Occluded | 4 12 20 Outside*"]);
    assert_eq!(read.size, Some([320, 240]));
    assert_eq!(
        read.dropped,
        [
            "1 attributes of points",
            "2 boxes and other shapes that are no points",
            "1 shapes of several points: only single ones are tracks"
        ]
    );
}

#[test]
fn cvat_is_told_where_tracks_begin_hide_and_end() {
    let seen = |x: f32| seen([x, 2.0], None);
    let span = |first_frame, samples| Arc::new(Span { first_frame, samples });
    let key = Sample { source: Source::Key, ..seen(1.0) };
    let hidden = Sample { status: Status::Occluded, ..seen(2.0) };
    let spans = vec![span(1, vec![seen(0.0), key, hidden]), span(13, vec![seen(3.0), seen(4.0)])];
    let track = [ForeignTrack { number: Some(7), name: None, spans }];
    let file = written(Format::Cvat, &outgoing(&track));
    let text = String::from_utf8(file.clone()).unwrap();
    let shapes: Vec<&str> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("<points ")?.split(" z_order=\"0\"").next())
        .collect();
    assert_eq!(
        shapes,
        [
            r#"frame="1" keyframe="1" outside="0" occluded="0" points="0.5,2.5""#,
            r#"frame="2" keyframe="1" outside="0" occluded="0" points="1.5,2.5""#,
            r#"frame="3" keyframe="1" outside="0" occluded="1" points="2.5,2.5""#,
            r#"frame="4" keyframe="1" outside="1" occluded="0" points="2.5,2.5""#,
            r#"frame="13" keyframe="1" outside="0" occluded="0" points="3.5,2.5""#,
            r#"frame="14" keyframe="0" outside="0" occluded="0" points="4.5,2.5""#,
        ]
    );
    assert_eq!(read_back(Format::Cvat, &file).tracks, track, "what was added for CVAT is left out again");
}

#[test]
fn deeplabcut_of_networks_of_people_and_of_several_animals() {
    let network = "scorer,net,net,net,net,net,net\nbodyparts,tip,tip,tip,track_7,track_7,track_7\n\
                   coords,x,y,likelihood,x,y,likelihood\n0,1.5,2.5,0.25,,,\n1,2.5,3.5,1.0,9,8,0.0\n";
    let read = text(Format::DeepLabCut, network);
    assert_eq!(
        told(&read),
        ["None tip | 0 1.5 2.5 Tracked | 1 2.5 3.5 Tracked", "Some(7) - | 1 9 8 Occluded"]
    );
    assert_eq!(read.tracks[0].at(0).unwrap().quality.ncc, Some(0.25));
    assert_eq!(read.tracks[0].at(1).unwrap().quality.ncc, None, "no doubt is stated");
    let person = "scorer,,,me,me\nbodyparts,,,tip,tip\ncoords,,,x,y\n\
                  labeled-data,clip,img0003.png,1,2\nlabeled-data,clip,img0012.png,NaN,NaN\n";
    assert_eq!(told(&text(Format::DeepLabCut, person)), ["None tip | 3 1 2 Tracked"]);
    let animals =
        "scorer,n,n,n,n\nindividuals,a,a,b,b\nbodyparts,tip,tip,tip,tip\ncoords,x,y,x,y\n0,1,2,3,4\n";
    assert_eq!(
        told(&text(Format::DeepLabCut, animals)),
        ["None a tip | 0 1 2 Tracked", "None b tip | 0 3 4 Tracked"]
    );
}

#[test]
fn dltdv_of_both_origins_and_several_cameras() {
    let one = "pt1_cam1_X,pt1_cam1_Y,pt2_cam1_X,pt2_cam1_Y\n1,1,NaN,NaN\n2.5,480,640,480\n";
    assert_eq!(
        told(&text(Format::Dltdv, one)),
        ["Some(1) - | 0 0 0 Tracked | 1 1.5 479 Tracked", "Some(2) - | 1 639 479 Tracked"]
    );
    let bottom = ReadOptions { origin: Some(Origin::Bottom), ..options() };
    let read = parse(one.as_bytes(), Format::Dltdv, &bottom).unwrap();
    assert_eq!(told(&read)[0], "Some(1) - | 0 0 479 Tracked | 1 1.5 0 Tracked");
    let two = "pt1_cam1_X,pt1_cam1_Y,pt1_cam2_X,pt1_cam2_Y\n1,1,5,6\n";
    let error = parse(two.as_bytes(), Format::Dltdv, &options()).unwrap_err();
    assert_eq!(error.to_string(), "line 1: wanted one of the cameras 1, 2 (--camera), came `none`");
    let second = ReadOptions { camera: Some(2), ..options() };
    assert_eq!(told(&parse(two.as_bytes(), Format::Dltdv, &second).unwrap()), ["Some(1) - | 0 4 5 Tracked"]);
}

#[test]
fn trackmate_whole_with_a_gap_a_split_and_a_filter() {
    let spot = |id: u32, frame: u32, x: f64| {
        format!(
            r#"<Spot ID="{id}" name="ID{id}" FRAME="{frame}" POSITION_X="{x}" POSITION_Y="2.0" POSITION_Z="0.0" QUALITY="7"/>"#
        )
    };
    let edge = |a: u32, b: u32| format!(r#"<Edge SPOT_SOURCE_ID="{a}" SPOT_TARGET_ID="{b}" LINK_COST="1"/>"#);
    let file = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?><TrackMate version="7.10.2"><Model spatialunits="micron" timeunits="sec">
<AllSpots nspots="8"><SpotsInFrame frame="0">{}{}</SpotsInFrame><SpotsInFrame frame="1">{}</SpotsInFrame>
<SpotsInFrame frame="3">{}{}</SpotsInFrame><SpotsInFrame frame="4">{}{}</SpotsInFrame></AllSpots>
<AllTracks><Track name="Track_0" TRACK_ID="0">{}{}{}{}</Track><Track name="bud" TRACK_ID="1">{}</Track>
<Track name="Track_2" TRACK_ID="2">{}</Track></AllTracks>
<FilteredTracks><TrackID TRACK_ID="0"/><TrackID TRACK_ID="1"/></FilteredTracks></Model>
<Settings><ImageData filename="a.tif" width="320" height="240" nframes="5" pixelwidth="0.5" pixelheight="0.5" timeinterval="0.1"/></Settings></TrackMate>"#,
        spot(1, 0, 1.0),
        spot(2, 0, 8.0),
        spot(3, 1, 1.5),
        spot(4, 3, 2.5),
        spot(5, 3, 9.0),
        spot(6, 4, 3.0),
        spot(7, 4, 9.5),
        edge(1, 3),
        edge(4, 3),
        edge(3, 5),
        edge(4, 6),
        edge(2, 7),
        edge(2, 3),
    );
    let read = text(Format::TrackMate, &file);
    assert_eq!(
        told(&read),
        [
            "Some(0) - | 0 2 4 Tracked | 1 3 4 Tracked | 3 5 4 Tracked | 4 6 4 Tracked",
            "None - | 3 18 4 Tracked",
            "Some(1) bud | 0 16 4 Tracked | 4 19 4 Tracked",
        ]
    );
    assert_eq!(read.size, Some([320, 240]));
    let dropped = ["1 splits and merges: the track is cut there", "1 tracks that TrackMate's filter hides"];
    assert_eq!(read.dropped, dropped);
}

#[test]
fn trackmate_simple_in_pixels_and_in_microns() {
    let file = |unit: &str| {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Tracks nTracks=\"1\" spaceUnits=\"{unit}\" frameInterval=\"0.1\" \
             timeUnits=\"sec\" generationDateTime=\"now\" from=\"TrackMate v7\">\n  <particle nSpots=\"2\">\n    \
             <detection t=\"0\" x=\"4.0\" y=\"2.0\" z=\"0.0\" />\n    <detection t=\"2\" x=\"5.0\" y=\"2.0\" z=\"1.0\" />\n  \
             </particle>\n</Tracks>"
        )
    };
    let read = text(Format::TrackMate, &file("pixel"));
    assert_eq!(told(&read), ["None - | 0 4 2 Tracked | 2 5 2 Tracked"]);
    assert_eq!(read.dropped, ["1 heights z"]);
    let error = parse(file("micron").as_bytes(), Format::TrackMate, &options()).unwrap_err().to_string();
    assert!(
        error.ends_with("wanted pixel, or the width of a pixel (--pixel-size), came `micron`"),
        "{error}"
    );
    let scaled = ReadOptions { pixel_size: Some(0.5), ..options() };
    let read = parse(file("micron").as_bytes(), Format::TrackMate, &scaled).unwrap();
    assert_eq!(told(&read), ["None - | 0 8 4 Tracked | 2 10 4 Tracked"]);
}

#[test]
fn mot_truth_and_detections() {
    let truth = "1,3,10,20,5,7,1,1,0.8\n3,3,11,20,5,7,0,1,0.1\n1,9,1,1,1,1,1,1,1\n";
    let read = text(Format::Mot, truth);
    assert_eq!(told(&read), ["Some(3) - | 0 11 22 Tracked | 2 12 22 Occluded", "Some(9) - | 0 0 0 Tracked"]);
    assert_eq!(read.dropped, ["1 boxes of other sizes than the first: only centres are kept"]);
    let score = text(Format::Mot, "1,3,10,20,5,7,87.5,-1,-1,-1\n");
    assert_eq!(score.tracks[0].at(0).unwrap().quality, Quality::default());
}

/// An array: name, header and data.
type Array<'a> = (&'a str, &'a str, &'a [u8]);

/// An archive of arrays.
fn npz(arrays: &[Array<'_>]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, header, data) in arrays {
        archive.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let length = u16::try_from(header.len()).unwrap().to_le_bytes();
        archive.write_all(&[b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn tapvid_of_numpy() {
    let floats = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let points = floats(&[0.5, 0.5, 1.5, 0.5, f64::NAN, f64::NAN, 8.0, 4.0]);
    let file = npz(&[
        ("video", "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 1, 1, 3), }", &[0; 6]),
        ("points", "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2, 2), }\n", &points),
        ("occluded", "{'descr': '|b1', 'fortran_order': False, 'shape': (2, 2), }\n", &[0, 1, 1, 0]),
    ]);
    let read = parse(&file, Format::TapVid, &options()).unwrap();
    assert_eq!(told(&read), ["None - | 0 0 0 Tracked | 1 1 0 Occluded", "None - | 1 7.5 3.5 Tracked"]);
    assert_eq!(read.dropped, ["1 video"]);
    let shares = ReadOptions { origin: Some(Origin::Normalised), size: [8, 4], ..options() };
    let read = parse(&file, Format::TapVid, &shares).unwrap();
    assert_eq!(told(&read)[0], "None - | 0 3.5 1.5 Tracked | 1 11.5 1.5 Occluded");
}

#[test]
fn arrays_that_are_not_read_say_why() {
    let table: [(&[Array<'_>], &str); 5] = [
        (&[("a", "x", &[])], "archive: wanted the array occluded, came `a.npy`"),
        (
            &[("occluded", "{'descr': '|O', 'fortran_order': False, 'shape': (1, 1), }", b"\x80\x03")],
            "occluded: wanted plain numbers; objects are pickles, which honami never loads (docs/formats.md has a \
             converter), came `|O`",
        ),
        (
            &[("occluded", "{'descr': '|b1', 'fortran_order': True, 'shape': (1, 1), }", &[0])],
            "occluded: wanted C order (np.ascontiguousarray), came `Fortran order`",
        ),
        (
            &[("occluded", "{'descr': '|b1', 'fortran_order': False, 'shape': (99999, 99999), }", &[0])],
            "more than 50000000 samples: split the file",
        ),
        (
            &[("occluded", "{'descr': '|b1', 'fortran_order': False, 'shape': (9999, 1000), }", &[0])],
            "occluded: wanted a whole array, came `failed to fill whole buffer`",
        ),
    ];
    for (arrays, wanted) in table {
        let error = parse(&npz(arrays), Format::TapVid, &options()).unwrap_err();
        assert_eq!(error.to_string(), wanted);
    }
}

#[test]
fn what_is_wrong_with_a_cvat_file_is_named() {
    let deep = format!("<annotations>{}", "<a>".repeat(100));
    let bomb = "<!DOCTYPE a [<!ENTITY b \"bbbb\"><!ENTITY c \"&b;&b;\">]><annotations>&c;</annotations>";
    let point = |points: &str| {
        format!(
            "<annotations>\n<track id=\"1\" label=\"a\">\n<points frame=\"0\" keyframe=\"1\" outside=\"0\" \
             occluded=\"0\" points=\"{points}\"/></track></annotations>"
        )
    };
    let table = [
        (Format::Cvat, deep.as_str(), "line 1: wanted at most 64 elements inside each other, came `a`"),
        (Format::Cvat, bomb, "line 1: wanted XML without a document type, came `<!DOCTYPE`"),
        (Format::Cvat, &point("1"), "line 3, points of <points>: wanted a position as x,y, came `1`"),
        (Format::Cvat, &point("1,NaN"), "line 3, points of <points>: wanted a position as x,y, came `1,NaN`"),
        (
            Format::Cvat,
            &point("1,1e99"),
            "line 3, points of <points>: wanted a position as x,y, came `1,1e99`",
        ),
        (
            Format::Cvat,
            "<annotations><track id=\"1\">",
            "line 1: wanted </track>, came `the end of the file`",
        ),
        (
            Format::Cvat,
            "<annotations><image id=\"0\"/></annotations>",
            "element <image>: wanted `CVAT for video 1.1`: export the task anew in that format, came ``CVAT for images``",
        ),
    ];
    refused(&table);
}

#[test]
fn what_is_wrong_with_other_files_is_named() {
    let table = [
        (Format::Mot, "0,1,1,1,1,1,1\n", "line 1, column frame: wanted 1 or more, came `0`"),
        (Format::Mot, "1,-1,1,1,1,1,1\n", "line 1, column id: wanted a whole number of 0 or more, came `-1`"),
        (Format::Mot, "1,1,1,1,1,1\n1,1,2,2,1,1\n", "track 1 has frame 0 twice: each frame once is wanted"),
        (Format::Mot, "1,1,nan,1,1,1\n", "line 1, column left: wanted a finite number, came `nan`"),
        (Format::Dltdv, "pt1_cam1_X,pt1_cam1_Y\n1,2\n3\n", "line 3: wanted 2 columns, came `1 columns`"),
        (
            Format::Dltdv,
            "pt1_cam1_X,pt1_cam1_Y\n1,NaN\n",
            "line 2, column pt1_cam1_Y: wanted a number where there is an x, came `nothing`",
        ),
        (
            Format::Dltdv,
            "pt1_cam1_X,pt1_cam1_Z\n",
            "line 1, column 2: wanted a title like pt1_cam1_X, came `pt1_cam1_Z`",
        ),
        (
            Format::DeepLabCut,
            "scorer,a,a\nbodyparts,b,b\ncoords,x,z\n",
            "line coords, column 3: wanted x, y or likelihood of one body part, came `z`",
        ),
        (
            Format::DeepLabCut,
            "scorer,a,a\nbodyparts,b,b\ncoords,x,y\none,1,2\n",
            "line 4, column 1: wanted a frame, or a picture whose name ends in one, came `one`",
        ),
        (
            Format::DeepLabCut,
            "scorer,a,a,a\nbodyparts,b,b,b\ncoords,x,y,likelihood\n0,1,2,3\n",
            "line 4, column likelihood of b: wanted a number from 0 to 1, came `3`",
        ),
        (
            Format::TrackMate,
            "<Tracks><detection t=\"0\" x=\"1\" y=\"1\"/></Tracks>",
            "line 1, detection of <detection>: wanted a <particle> around it, came `none`",
        ),
        (
            Format::TapVid,
            "no archive",
            "archive: wanted a zip archive as np.savez writes it, came `invalid Zip archive: Could not find EOCD`",
        ),
    ];
    refused(&table);
}

/// Each text is no file of its format, for the reason that is given.
#[track_caller]
fn refused(table: &[(Format, &str, &str)]) {
    for (format, text, wanted) in table {
        let error = parse(text.as_bytes(), *format, &options()).unwrap_err();
        assert_eq!(error.to_string(), *wanted);
    }
}

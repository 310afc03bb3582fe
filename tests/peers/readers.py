"""Other people's readers on what honami exports.

    readers.py list    the readers, what each needs, and whether that is installed, as JSON
    readers.py NAME    reads in the current folder and compares with table.csv, honami's own table

Files: csv.csv parquet.parquet cvat.xml deeplabcut.csv dltdv.csv trackmate.xml tapvid.npz mot.txt.
`trackmate_whole` writes a whole TrackMate file of the tracks, whole.xml, and what pytrackmate reads from it, whole.json.
"""

import csv
import importlib.util
import json
import sys
from xml.etree import ElementTree

LOST, TRACKED, OCCLUDED, OUTSIDE, REJECTED, NEWBORN = range(6)


def table():
    """{track: {frame: (x, y, status, source)}}"""
    tracks = {}
    with open("table.csv", newline="") as file:
        for row in csv.DictReader(file):
            sample = float(row["x"]), float(row["y"]), int(row["status"]), row["source"]
            tracks.setdefault(int(row["track"]), {})[int(row["frame"])] = sample
    return tracks


def seen(tracks=None):
    """{(track, frame): (x, y)} of what was seen"""
    tracks = tracks or table()
    samples = ((t, f, s) for t, frames in tracks.items() for f, s in frames.items())
    return {(t, f): s[:2] for t, f, s in samples if s[2] in (TRACKED, NEWBORN)}


def same(theirs, ours, tolerance=1e-3):
    assert theirs, "nothing was read"
    assert set(theirs) == set(ours), f"{len(theirs)} samples, not {len(ours)}: {sorted(set(theirs) ^ set(ours))[:5]}"
    for key, (x, y) in ours.items():
        a, b = theirs[key]
        assert abs(a - x) < tolerance and abs(b - y) < tolerance, f"{key}: {(a, b)}, not {(x, y)}"


def order():
    return {track: place for place, track in enumerate(sorted(table()))}


def by_order():
    places = order()
    return {(places[t], f): at for (t, f), at in seen().items()}


def parquet_rows(columns):
    rows = zip(columns["track"], columns["frame"], columns["x"], columns["y"], columns["status"], columns["source"])
    ours = {(t, f): s for t, frames in table().items() for f, s in frames.items()}
    theirs = {(t, f): (x, y, s, w) for t, f, x, y, s, w in rows}
    assert set(theirs) == set(ours)
    assert all(theirs[key][2:] == ours[key][2:] for key in ours)
    same({k: v[:2] for k, v in theirs.items()}, {k: v[:2] for k, v in ours.items()}, 1e-4)


def pyarrow_parquet():
    import pyarrow.parquet

    read = pyarrow.parquet.read_table("parquet.parquet")
    types = {field.name: str(field.type) for field in read.schema}
    assert types["track"] == types["frame"] == "uint32" and types["status"] == "uint8", types
    assert types["time_s"] == "double" and types["x"] == types["ncc"] == "float", types
    assert types["source"] == "string" and types["run"] == "uint64", types
    parquet_rows(read.to_pydict())


def polars_parquet():
    import polars

    parquet_rows(polars.read_parquet("parquet.parquet").to_dict(as_series=False))


def pandas_deeplabcut():
    import pandas

    read = pandas.read_csv("deeplabcut.csv", header=[0, 1, 2], index_col=0)
    theirs = {}
    for (scorer, part), frame in read.T.groupby(level=[0, 1]):
        frame = frame.T[scorer][part]
        for n, row in frame.dropna(subset=["x", "y"]).iterrows():
            if row["likelihood"] > 0:
                theirs[int(part.removeprefix("track_")), int(n)] = row["x"], row["y"]
    same(theirs, seen())


def movement_deeplabcut():
    from movement.io import load_poses

    data = load_poses.from_dlc_file("deeplabcut.csv", fps=25)
    theirs = {}
    for part in data.keypoints.values:
        for n in range(data.sizes["time"]):
            sample = data.isel(time=n).sel(keypoints=part).squeeze()
            x, y = (float(sample.position.sel(space=axis)) for axis in "xy")
            if x == x and float(sample.confidence) > 0:
                theirs[int(str(part).removeprefix("track_")), n] = x, y
    same(theirs, seen())


def pandas_dltdv():
    import pandas

    read = pandas.read_csv("dltdv.csv")
    places = {place + 1: track for track, place in order().items()}
    theirs = {}
    for point, track in places.items():
        for n, x, y in zip(read.index, read[f"pt{point}_cam1_X"], read[f"pt{point}_cam1_Y"]):
            if x == x:
                theirs[track, n] = x - 1, y - 1
    same(theirs, seen())


def numpy_tapvid():
    import numpy as np

    with np.load("tapvid.npz", allow_pickle=False) as file:
        points, occluded = file["points"], file["occluded"]
    assert points.dtype == np.float32 and occluded.dtype == bool, (points.dtype, occluded.dtype)
    assert points.shape == (*occluded.shape, 2), (points.shape, occluded.shape)
    theirs = {(int(n), int(t)): tuple(points[n, t] - 0.5) for n, t in zip(*np.nonzero(~occluded))}
    same(theirs, by_order())


def motmetrics_mot():
    import motmetrics

    read = motmetrics.io.loadtxt("mot.txt", fmt="mot16")
    theirs = {}
    for (frame, track), row in read.iterrows():
        if row["Confidence"] > 0:
            # motmetrics turns MATLAB's pixels, from 1, into pixels from 0.
            theirs[int(track), int(frame) - 1] = row["X"] + (row["Width"] - 1) / 2, row["Y"] + (row["Height"] - 1) / 2
    same(theirs, seen())


def elementtree_trackmate():
    root = ElementTree.parse("trackmate.xml").getroot()
    assert root.tag == "Tracks" and int(root.get("nTracks")) == len(root) and root.get("spaceUnits") == "pixel"
    theirs = {}
    for place, particle in enumerate(root):
        assert int(particle.get("nSpots")) == len(particle)
        for spot in particle:
            theirs[place, int(spot.get("t"))] = float(spot.get("x")), float(spot.get("y"))
    same(theirs, by_order())


def elementtree_cvat():
    root = ElementTree.parse("cvat.xml").getroot()
    assert root.findtext("version") == "1.1"
    ours = {(t, f): s for t, frames in table().items() for f, s in frames.items()}
    theirs, n_keys = {}, 0
    for track in root.iter("track"):
        for point in track:
            if point.get("honami") == "end":
                continue
            x, y = (float(v) - 0.5 for v in point.get("points").split(","))
            status = OUTSIDE if point.get("outside") == "1" else OCCLUDED if point.get("occluded") == "1" else TRACKED
            key = int(track.get("id")), int(point.get("frame"))
            theirs[key] = x, y
            was = ours[key][2]
            assert status == {LOST: OUTSIDE, REJECTED: OUTSIDE, NEWBORN: TRACKED}.get(was, was), (key, status, was)
            is_key = point.get("keyframe") == "1" and point.get("honami") is None
            assert is_key == (ours[key][3] == "key"), key
    same(theirs, {key: sample[:2] for key, sample in ours.items()})


def datumaro_cvat():
    import datumaro

    read = datumaro.Dataset.import_from("cvat.xml", "cvat")
    theirs, keys = {}, {}
    for item in read:
        for shape in item.annotations:
            track, frame = int(shape.attributes["track_id"]), int(item.attributes["frame"])
            gone, hidden = shape.attributes["outside"], shape.attributes["occluded"]
            if not gone:
                theirs[track, frame] = tuple(v - 0.5 for v in shape.points[:2])
            if shape.attributes["keyframe"]:
                keys.setdefault(track, {})[frame] = "gone" if gone else "hidden" if hidden else "seen"
    words = {TRACKED: "seen", NEWBORN: "seen", OCCLUDED: "hidden"}
    ours = {(t, f): words.get(s[2], "gone") for t, frames in table().items() for f, s in frames.items()}
    tracks = table()
    same(theirs, {(t, f): tracks[t][f][:2] for (t, f), status in ours.items() if status != "gone"}, 0.01)
    # CVAT takes the key-frames alone and holds each until the next, the last one to the end of the clip.
    n_frames = int(ElementTree.parse("cvat.xml").findtext("meta/task/size"))
    for track in tracks:
        shown = "gone"
        for frame in range(n_frames):
            shown = keys[track].get(frame, shown)
            assert shown == ours.get((track, frame), "gone"), (track, frame, shown)


def trackmate_whole():
    import pytrackmate

    spots, edges, n = {}, {}, 0
    pixel = 0.5
    for track, frames in table().items():
        before = None
        for frame, (x, y, status, _) in sorted(frames.items()):
            if status not in (TRACKED, NEWBORN):
                continue
            n += 1
            position = f'POSITION_X="{x * pixel}" POSITION_Y="{y * pixel}" POSITION_Z="0.0" POSITION_T="{frame / 25}"'
            features = 'QUALITY="1.0" RADIUS="2.5" VISIBILITY="1"'
            spots.setdefault(frame, []).append(f'<Spot ID="{n}" name="ID{n}" {position} FRAME="{frame}" {features}/>')
            if before:
                edges.setdefault(track, []).append(f'<Edge SPOT_SOURCE_ID="{before}" SPOT_TARGET_ID="{n}"/>')
            before = n
    with open("whole.xml", "w") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?><TrackMate version="7.10.2">')
        file.write('<Model spatialunits="micron" timeunits="sec"><FeatureDeclarations><SpotFeatures>')
        for feature in ["FRAME", "POSITION_T", "POSITION_X", "POSITION_Y", "POSITION_Z", "QUALITY", "VISIBILITY"]:
            file.write(f'<Feature feature="{feature}" name="{feature}" isint="false"/>')
        file.write("</SpotFeatures></FeatureDeclarations><AllSpots>")
        for frame, lines in sorted(spots.items()):
            file.write(f'<SpotsInFrame frame="{frame}">{"".join(lines)}</SpotsInFrame>')
        file.write("</AllSpots><AllTracks>")
        for track, lines in edges.items():
            file.write(f'<Track name="Track_{track}" TRACK_ID="{track}">{"".join(lines)}</Track>')
        file.write("</AllTracks><FilteredTracks>")
        file.write("".join(f'<TrackID TRACK_ID="{track}"/>' for track in edges))
        file.write('</FilteredTracks></Model><Settings><ImageData width="160" height="120" nframes="40" ')
        file.write(f'pixelwidth="{pixel}" pixelheight="{pixel}" timeinterval="0.04"/>')
        file.write('<InitialSpotFilter feature="QUALITY" value="0.0" isabove="true"/><SpotFilterCollection/>')
        file.write("</Settings></TrackMate>")
    read = pytrackmate.trackmate_peak_import("whole.xml", get_tracks=True)
    read = read[read["label"].notna()] if "label" in read else read
    times = read["t_stamp"] if "t_stamp" in read else read["t"]
    spots = [[int(t), float(x) / pixel, float(y) / pixel] for t, x, y in zip(times, read["x"], read["y"])]
    assert spots, "pytrackmate read nothing"
    with open("whole.json", "w") as file:
        json.dump(spots, file)


READERS = {
    "pyarrow_parquet": ("pyarrow", pyarrow_parquet),
    "polars_parquet": ("polars", polars_parquet),
    "pandas_deeplabcut": ("pandas", pandas_deeplabcut),
    "movement_deeplabcut": ("movement", movement_deeplabcut),
    "pandas_dltdv": ("pandas", pandas_dltdv),
    "numpy_tapvid": ("numpy", numpy_tapvid),
    "motmetrics_mot": ("motmetrics", motmetrics_mot),
    "elementtree_trackmate": ("xml", elementtree_trackmate),
    "elementtree_cvat": ("xml", elementtree_cvat),
    "datumaro_cvat": ("datumaro", datumaro_cvat),
    "trackmate_whole": ("pytrackmate", trackmate_whole),
}

if __name__ == "__main__":
    name = sys.argv[1]
    if name == "list":
        there = lambda package: importlib.util.find_spec(package) is not None
        print(json.dumps([{"name": n, "needs": needs, "there": there(needs)} for n, (needs, _) in READERS.items()]))
    else:
        READERS[name][1]()

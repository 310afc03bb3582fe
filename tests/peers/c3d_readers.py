"""Where two readers of C3D, ezc3d and c3d, have places, and where the table of the same tracks has them: python3 c3d_readers.py
PLACES.c3d PLACES.csv. Fails where they are more than a thousandth of a millimetre apart, or where one sees what the other does not."""

import csv
import sys

import c3d
import ezc3d
import numpy as np

FARTHEST_MM = 1e-3


def main(path: str, table: str) -> None:
    with open(table, newline="") as lines:
        rows = list(csv.DictReader(lines))
    tracks = sorted({int(row["track"]) for row in rows})
    frames = [int(row["frame"]) for row in rows]
    first, n_frames = min(frames), max(frames) - min(frames) + 1
    wanted = np.full((n_frames, len(tracks), 3), np.nan)
    errors = np.full((n_frames, len(tracks)), np.nan)
    for row in rows:
        at = (int(row["frame"]) - first, tracks.index(int(row["track"])))
        wanted[at] = [1e3 * float(row[name]) for name in ("x_m", "y_m", "z_m")]
        errors[at] = 1e3 * np.hypot(np.hypot(float(row["ex_m"]), float(row["ey_m"])), float(row["ez_m"]))

    one = ezc3d.c3d(path)
    point = one["parameters"]["POINT"]
    scale = abs(point["SCALE"]["value"][0])
    assert point["UNITS"]["value"] == ["mm"], point["UNITS"]
    assert len(set(point["LABELS"]["value"])) == len(tracks), point["LABELS"]
    # ezc3d counts frames from 0, as we do; the file from 1.
    assert one["header"]["points"]["first_frame"] == first, one["header"]["points"]
    data = one["data"]["points"][:3].transpose(2, 1, 0)
    agree("ezc3d", data, wanted)
    residuals = one["data"]["meta_points"]["residuals"][0].T

    with open(path, "rb") as file:
        other = c3d.Reader(file)
        assert other.point_rate == point["RATE"]["value"][0]
        assert other.first_frame == first + 1, other.first_frame
        places = np.stack([points for _, points, _ in other.read_frames()])
    seen = places[:, :, 3] >= 0
    agree("c3d", np.where(seen[:, :, None], places[:, :, :3], np.nan), wanted)
    far = np.abs(places[:, :, 3] - np.minimum(errors, 127 * scale))[seen].max()
    assert far <= 0.51 * scale, f"residuals are {far} mm apart, their step is {scale}"
    print(f"{len(tracks)} tracks, {n_frames} frames; residuals of {np.nanmin(residuals):.0f} to {np.nanmax(residuals):.0f}")


def agree(name: str, came: np.ndarray, wanted: np.ndarray) -> None:
    assert came.shape == wanted.shape, f"{name}: {came.shape}, wanted {wanted.shape}"
    assert (np.isnan(came) == np.isnan(wanted)).all(), f"{name} sees what is not there, or misses what is"
    far = np.nanmax(np.abs(came - wanted))
    assert far < FARTHEST_MM, f"{name}: {far} mm apart"


main(*sys.argv[1:])

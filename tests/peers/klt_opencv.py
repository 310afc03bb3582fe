"""OpenCV's KLT on the same frames and points: the peer of honami's tracker.

    klt_opencv.py bench DIR              serves the benchmark: commands on standard input, answers as JSON lines
    klt_opencv.py track CLIP POINTS OUT  follows points through a clip, for accuracy tables

`bench`: DIR holds frame_0000.pgm ..., points.npy (pairs, n, 2) float32 and settings.json. The command `time` runs
every pair once and answers the milliseconds; `positions` writes opencv.npy (pairs, n, 3): x, y, found.

`track`: CLIP is whatever cv2.VideoCapture opens (a video, or frame_%04d.png), POINTS a table id,x,y; OUT becomes a
table track,frame,x,y,status with status 1 tracked or 0 lost; a lost point stays where it was lost. Options:
--radius 10 --levels 4.

One thread: cv2.setNumThreads(1).
"""

import argparse
import csv
import json
import sys
import time
from pathlib import Path

import cv2
import numpy as np


def settings(radius, levels):
    side = 2 * radius + 1
    return dict(
        winSize=(side, side),
        maxLevel=levels - 1,
        criteria=(cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 0.01),
        minEigThreshold=1e-4,
    )


def milliseconds(work):
    start = time.perf_counter()
    result = work()
    return 1e3 * (time.perf_counter() - start), result


def bench(folder):
    folder = Path(folder)
    given = json.loads((folder / "settings.json").read_text())
    lk = settings(given["radius_px"], given["levels"])
    frames = [cv2.imread(str(f), cv2.IMREAD_UNCHANGED) for f in sorted(folder.glob("frame_*.pgm"))]
    points = np.load(folder / "points.npy")
    pairs = list(zip(frames, frames[1:], points))
    size, top = lk["winSize"], lk["maxLevel"]

    def full(a, b, p):
        return cv2.calcOpticalFlowPyrLK(a, b, p, None, **lk)

    def pyramids(a, b, _):
        # What the call above makes inside: gradients of the first picture only. The Python binding takes no
        # ready pyramids, so the search alone is the difference of the two times.
        cv2.buildOpticalFlowPyramid(a, size, top, withDerivatives=True)
        cv2.buildOpticalFlowPyramid(b, size, top, withDerivatives=False)

    print(json.dumps({"peer": f"OpenCV {cv2.__version__}"}), flush=True)
    for command in sys.stdin:
        answer = {}
        if command.strip() == "time":
            answer["full_ms"] = [milliseconds(lambda: full(*pair))[0] for pair in pairs]
            answer["pyramids_ms"] = [milliseconds(lambda: pyramids(*pair))[0] for pair in pairs]
        elif command.strip() == "positions":
            found = [full(*pair)[:2] for pair in pairs]
            table = [np.hstack([to.reshape(-1, 2), ok.reshape(-1, 1)]) for to, ok in found]
            np.save(folder / "opencv.npy", np.asarray(table, np.float32))
        else:
            sys.exit(f"klt_opencv.py: unknown command {command!r}; wanted `time` or `positions`")
        print(json.dumps(answer), flush=True)


def track(clip, points, out, radius, levels):
    with open(points, newline="") as file:
        rows = list(csv.DictReader(file))
    ids = [int(row["id"]) for row in rows]
    at = np.array([[float(row["x"]), float(row["y"])] for row in rows], np.float32)
    alive = np.ones(len(at), bool)
    lk = settings(radius, levels)
    capture = cv2.VideoCapture(str(clip))
    before, frame = None, 0
    with open(out, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["track", "frame", "x", "y", "status"])
        while True:
            ok, picture = capture.read()
            if not ok:
                break
            gray = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.ndim == 3 else picture
            if before is not None and alive.any():
                to, found, _ = cv2.calcOpticalFlowPyrLK(before, gray, at[alive], None, **lk)
                found = found.ravel() == 1
                still = np.flatnonzero(alive)
                at[still[found]] = to[found]
                alive[still[~found]] = False
            table.writerows([i, frame, f"{x:.4f}", f"{y:.4f}", int(a)] for i, (x, y), a in zip(ids, at, alive))
            before, frame = gray, frame + 1
    if frame == 0:
        sys.exit(f"klt_opencv.py: no frame could be read from {clip}")


def main():
    cv2.setNumThreads(1)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("bench").add_argument("folder")
    follow = commands.add_parser("track")
    for name in ("clip", "points", "out"):
        follow.add_argument(name)
    follow.add_argument("--radius", type=int, default=10)
    follow.add_argument("--levels", type=int, default=4)
    args = parser.parse_args()
    if args.command == "bench":
        bench(args.folder)
    else:
        track(args.clip, args.points, args.out, args.radius, args.levels)


if __name__ == "__main__":
    main()

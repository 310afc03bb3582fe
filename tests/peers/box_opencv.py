"""OpenCV's template matching on the same frames and features: the peer of honami's box matching.

    box_opencv.py frames CLIP DIR PAIRS  writes PAIRS pairs of consecutive frames, spread over a clip, as PGM
    box_opencv.py bench DIR              serves the benchmark: commands on standard input, answers as JSON lines

`bench`: DIR holds frame_0000.pgm ... (pairs of consecutive frames) and features.json: radius, search, and for every
pair the pixels [x, y] whose windows are looked for, all of them search + radius inside. The command `time` runs
matchTemplate (TM_SQDIFF) and minMaxLoc for every feature and answers the milliseconds of every pair, once as they are
and once with a search window of a single position, which is what the calls themselves take; `answers` answers the best
displacement [dx, dy] of every feature.

One thread: cv2.setNumThreads(1).
"""

import json
import sys
import time
from pathlib import Path

import cv2
import numpy as np


def frames(clip, folder, pairs):
    folder, wanted = Path(folder), int(pairs)
    capture, read = cv2.VideoCapture(clip), []
    while True:
        ok, picture = capture.read()
        if not ok:
            break
        read.append(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.ndim == 3 else picture)
    if len(read) < 2:
        sys.exit(f"box_opencv.py: two or more frames wanted, {len(read)} could be read from {clip}")
    starts = np.linspace(0, len(read) - 2, min(wanted, len(read) - 1)).astype(int)
    for i, start in enumerate(starts):
        cv2.imwrite(str(folder / f"frame_{2 * i:04}.pgm"), read[start])
        cv2.imwrite(str(folder / f"frame_{2 * i + 1:04}.pgm"), read[start + 1])


def bench(folder):
    folder = Path(folder)
    given = json.loads((folder / "features.json").read_text())
    radius, search = given["radius_px"], given["search_px"]
    names = sorted(folder.glob("frame_*.pgm"))
    pictures = [cv2.imread(str(name), cv2.IMREAD_UNCHANGED) for name in names]
    pairs = list(zip(pictures[::2], pictures[1::2], given["features"]))

    def window(picture, x, y, reach):
        return picture[y - reach : y + reach + 1, x - reach : x + reach + 1]

    def run(pair, search):
        first, second, features = pair
        start = time.perf_counter()
        found = []
        for x, y in features:
            costs = cv2.matchTemplate(
                window(second, x, y, radius + search), window(first, x, y, radius), cv2.TM_SQDIFF
            )
            found.append(cv2.minMaxLoc(costs)[2])
        return 1e3 * (time.perf_counter() - start), found

    print(json.dumps({"peer": f"OpenCV {cv2.__version__}"}), flush=True)
    for command in sys.stdin:
        if command.strip() == "time":
            answer = {"ms": [run(pair, search)[0] for pair in pairs], "calls_ms": [run(pair, 0)[0] for pair in pairs]}
        elif command.strip() == "answers":
            found = [run(pair, search)[1] for pair in pairs]
            answer = {"steps": [[[x - search, y - search] for x, y in pair] for pair in found]}
        else:
            sys.exit(f"box_opencv.py: unknown command {command!r}; wanted `time` or `answers`")
        print(json.dumps(answer), flush=True)


def main():
    cv2.setNumThreads(1)
    commands = {"frames": (frames, 3), "bench": (bench, 1)}
    work, n = commands.get(sys.argv[1] if len(sys.argv) > 1 else "", (None, 0))
    if work is None or len(sys.argv) != 2 + n:
        sys.exit(__doc__)
    work(*sys.argv[2:])


if __name__ == "__main__":
    main()

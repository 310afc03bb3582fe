"""Where bvhio has the ends of bones in a motion, and where the table of the same skeleton has them: python3 bvh_bvhio.py
MOTION.bvh JOINTS.csv. Fails where they are more than 1e-4 px apart."""

import csv
import sys

import bvhio

FARTHEST = 1e-4


def main(motion: str, table: str) -> None:
    frames: dict[int, dict[int, tuple[int, list[float]]]] = {}
    with open(table, newline="") as lines:
        for row in csv.DictReader(lines):
            place = [float(row["x_px"]), -float(row["y_px"]), -float(row["depth_px"])]
            parent = int(row["parent"]) if row["parent"] else -1
            frames.setdefault(int(row["frame"]), {})[int(row["joint"])] = (parent, place)
    root = bvhio.readAsHierarchy(motion)
    joints = [joint for joint, _, _ in root.layout() if joint.Name.startswith("bone_")]
    worst = 0.0
    for index, frame in enumerate(sorted(frames)):
        root.loadPose(index)
        rows = frames[frame]
        origin = rows[0][1]
        for joint in joints:
            # A joint is where its bone begins: at the end of the bone that it hangs on.
            parent, _ = rows[int(joint.Name.removeprefix("bone_"))]
            wanted = [there - here for there, here in zip(rows[parent][1], origin)]
            found = list(joint.PositionWorld)
            worst = max(worst, *(abs(a - b) for a, b in zip(wanted, found)))
    print(f"{len(joints)} bones, {len(frames)} frames: {worst:.1e} px apart at most")
    if worst > FARTHEST or not joints:
        sys.exit(1)


main(*sys.argv[1:])

#!/usr/bin/env python3
"""The modes of a plant by OpenSees, on the same beams, beside honami's (needs openseespy).

    python3 tests/peers/beams_opensees.py HONAMI PLANT [OPTIONS of honami simulate…]

Prints JSON: both lists of frequencies and the largest relative difference; fails where that is more than 1e-8.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import openseespy.opensees as ops

TOLERANCE = 1e-8


def ours(program, args):
    """honami's frequencies, and the beams that it has made: node, parent, place, radius; the wood."""
    with tempfile.TemporaryDirectory() as folder:
        beams = pathlib.Path(folder) / "beams.csv"
        command = [program, "simulate", *args, "--json", "--beams", str(beams)]
        answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        with open(beams, newline="") as file:
            rows = list(csv.DictReader(file))
    return [mode["hz"] for mode in answer["modes"]], rows, answer["material"]


def theirs(rows, wood, n_modes):
    """The frequencies of the same beams: elasticBeamColumn with consistent mass."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    young, density = wood["young"], wood["density"]
    shear = young / (2 * (1 + wood["poisson"]))
    place = {}
    for row in rows:
        node = int(row["node"])
        place[node] = [float(row[axis]) for axis in "xyz"]
        ops.node(node, *place[node])
        if row["parent"] == "":
            ops.fix(node, 1, 1, 1, 1, 1, 1)
            continue
        parent, radius = int(row["parent"]), float(row["radius"])
        along = [b - a for a, b in zip(place[parent], place[node])]
        length = math.dist(place[parent], place[node])
        # Any direction that is not along the beam.
        ops.geomTransf("Linear", node, *((0, 0, 1) if abs(along[2]) < 0.9 * length else (1, 0, 0)))
        area, inertia = math.pi * radius**2, math.pi * radius**4 / 4
        section = (area, young, shear, 2 * inertia, inertia, inertia)
        ops.element("elasticBeamColumn", node, parent, node, *section, node, "-mass", density * area, "-cMass")
    return [math.sqrt(value) / (2 * math.pi) for value in ops.eigen(n_modes)]


def main():
    program, args = sys.argv[1], sys.argv[2:]
    found, rows, wood = ours(program, args)
    peer = theirs(rows, wood, len(found))
    worst = max(abs(a / b - 1) for a, b in zip(found, peer))
    print(json.dumps({"honami": found, "opensees": peer, "worst": worst, "nodes": len(rows)}))
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())

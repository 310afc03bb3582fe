#!/usr/bin/env python3
"""Compares honami's linkage with SciPy's on the same condensed matrix (needs numpy and scipy).

    python3 tests/peers/linkage_scipy.py            N = 2000, non-metric distances; prints JSON lines
    python3 tests/peers/linkage_scipy.py --truth    writes core/motion/truth/linkage_scipy.txt anew
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy
from scipy.cluster.hierarchy import linkage

ROOT = pathlib.Path(__file__).resolve().parents[2]


def distances(n, seed):
    """Positive, symmetric, and no metric."""
    return np.random.default_rng(seed).gamma(2.0, 1.0, n * (n - 1) // 2)


def write_truth():
    condensed = distances(32, 1)
    lines = [f"# scipy {scipy.__version__} linkage: distances of 32 things, then average, then ward: a b height size"]
    lines.append(" ".join(repr(float(d)) for d in condensed))
    for method in ("average", "ward"):
        for a, b, height, size in linkage(condensed, method):
            lines.append(f"{int(a)} {int(b)} {float(height)!r} {int(size)}")
    path = ROOT / "core/motion/truth/linkage_scipy.txt"
    path.write_text("\n".join(lines) + "\n")


def compare(n):
    condensed = distances(n, 2)
    with tempfile.TemporaryDirectory() as folder:
        matrix = pathlib.Path(folder, "distances.f64")
        condensed.tofile(matrix)
        for method in ("average", "ward"):
            cargo = ["cargo", "run", "-q", "--release", "-p", "honami-motion", "--example", "linkage", "--"]
            ours = json.loads(subprocess.check_output(cargo + [str(n), method, str(matrix)], cwd=ROOT))
            start = time.perf_counter()
            theirs = linkage(condensed, method)
            scipy_ms = 1e3 * (time.perf_counter() - start)
            rows = np.array(ours["rows"])
            print(json.dumps({
                "method": method, "n": n,
                "same_merges": bool((rows[:, [0, 1, 3]] == theirs[:, [0, 1, 3]]).all()),
                "largest_difference": float(np.abs(rows[:, 2] - theirs[:, 2]).max()),
                "honami_ms": ours["ms"], "scipy_ms": scipy_ms,
            }))


if __name__ == "__main__":
    write_truth() if "--truth" in sys.argv else compare(2000)

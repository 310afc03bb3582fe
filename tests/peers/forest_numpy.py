"""Positions of forests as numpy's product of matrices, cell by cell: {"KxNxM": frames per second}.

Cells are given as KxNxM. Linear displacements alone: no wind, no modes, no lengths kept. The median of five runs.
"""

import json
import sys
import time

import numpy


def fps(copies, nodes, modes, runs=5, seconds=0.3):
    rng = numpy.random.default_rng(1)
    amplitudes = rng.standard_normal((copies, modes), dtype=numpy.float32)
    shapes = rng.standard_normal((modes, 3 * nodes), dtype=numpy.float32)
    out = numpy.empty((copies, 3 * nodes), dtype=numpy.float32)
    numpy.matmul(amplitudes, shapes, out=out)
    found = []
    for _ in range(runs):
        begun, n = time.perf_counter(), 0
        while n < 2 or time.perf_counter() - begun < seconds:
            numpy.matmul(amplitudes, shapes, out=out)
            n += 1
        found.append(n / (time.perf_counter() - begun))
    return sorted(found)[runs // 2]


cells = [tuple(int(word) for word in cell.split("x")) for cell in sys.argv[1:]]
print(json.dumps({"x".join(map(str, cell)): fps(*cell) for cell in cells}))

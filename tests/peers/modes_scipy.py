"""SciPy's slowest vibrations of the same matrices: the peer of honami's modes.

    modes_scipy.py FOLDER MODES  serves the benchmark: a line on standard input is a turn, answered by a line of JSON

FOLDER holds the two matrices by blocks of six by six, as raw numbers of this machine: parents.i32, where -1 is clamped,
and of `stiffness` and `mass` a file of each node's own blocks, .own.f64, and one of its rows in its parent's columns,
.link.f64, column by column.

A turn is ARPACK about 0 (eigsh) on factors by SuperLU, with the order of columns that fits symmetric matrices: on a
plant that takes two thirds of what eigsh does by itself. One thread.
"""

import json
import pathlib
import sys
import time

import numpy
import scipy
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import LinearOperator, eigsh, splu

SIX = 6


def matrix(folder, name, parents):
    """Both triangles, by columns."""
    nodes = numpy.arange(len(parents))
    own, link = (
        numpy.fromfile(folder / f"{name}.{part}.f64").reshape(-1, SIX, SIX).transpose(0, 2, 1) for part in ("own", "link")
    )
    borne = parents >= 0
    blocks = numpy.concatenate([own, link[borne], link[borne].transpose(0, 2, 1)])
    rows = numpy.concatenate([nodes, nodes[borne], parents[borne]])
    columns = numpy.concatenate([nodes, parents[borne], nodes[borne]])
    row = (SIX * rows[:, None, None] + numpy.arange(SIX)[None, :, None]).repeat(SIX, 2)
    column = (SIX * columns[:, None, None] + numpy.arange(SIX)[None, None, :]).repeat(SIX, 1)
    height = SIX * len(parents)
    return coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=(height, height)).tocsc()


def turn(stiffness, mass, modes):
    begun = time.perf_counter()
    factors = splu(stiffness, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    solve = LinearOperator(stiffness.shape, factors.solve)
    values = eigsh(stiffness, modes, mass, sigma=0.0, OPinv=solve, return_eigenvectors=True)[0]
    ms = 1e3 * (time.perf_counter() - begun)
    return {"ms": ms, "hz": sorted(float(value) ** 0.5 / (2 * numpy.pi) for value in values)}


def main():
    folder, modes = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    parents = numpy.fromfile(folder / "parents.i32", dtype=numpy.int32)
    stiffness, mass = (matrix(folder, name, parents) for name in ("stiffness", "mass"))
    print(json.dumps({"peer": f"SciPy {scipy.__version__}"}), flush=True)
    for _ in sys.stdin:
        print(json.dumps(turn(stiffness, mass, modes)), flush=True)


main()

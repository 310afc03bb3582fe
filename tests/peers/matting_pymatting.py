"""PyMatting's closed-form matting: the peer of honami's, served to the benchmark.

Says its name, then answers as often as it is given on standard input: a line `WIDTH HEIGHT`, the picture's bytes (red,
green, blue, row by row) and those of its trimap (0 background, 255 foreground, 128 unknown). An answer is a line with
the seconds it took, and the opacities as little-endian 32-bit floats.
"""

import sys
import time

import numpy as np
import pymatting


def alpha(picture, trimap):
    return pymatting.estimate_alpha_cf(picture, trimap, laplacian_kwargs={"epsilon": 1e-7})


def warm_up():
    """What is compiled when it is first called is no part of what is measured."""
    trimap = np.full((24, 24), 0.5)
    trimap[:4], trimap[-4:] = 0.0, 1.0
    alpha(np.random.default_rng(1).random((24, 24, 3)), trimap)


def main():
    given, out = sys.stdin.buffer, sys.stdout.buffer
    # It prints warnings where answers go.
    sys.stdout = sys.stderr
    warm_up()
    out.write(f"PyMatting {pymatting.__version__}\n".encode())
    out.flush()
    while line := given.readline():
        width, height = map(int, line.split())
        picture = np.frombuffer(given.read(3 * width * height), np.uint8).reshape(height, width, 3) / 255.0
        marks = np.frombuffer(given.read(width * height), np.uint8).reshape(height, width)
        trimap = np.where(marks == 128, 0.5, marks / 255.0)
        start = time.perf_counter()
        found = alpha(picture, trimap)
        out.write(f"{time.perf_counter() - start}\n".encode())
        out.write(found.astype("<f4").tobytes())
        out.flush()


if __name__ == "__main__":
    main()

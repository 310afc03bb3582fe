"""A small TraX server for tests: looks for the first picture of its region, in plain Python.

Arguments: the form of images that it takes, and the version of the protocol; `quits`: says quit at the third frame,
`hangs`: is silent from there on, and leaves a file `here`, `babbles`: says a line without end.
"""
import base64
import os
import signal
import struct
import sys
import zlib

FORM, VERSION, QUITS = sys.argv[1], int(sys.argv[2]), "quits" in sys.argv


def pixels(uri):
    """Rows of green bytes."""
    scheme, rest = uri.split(":", 1)
    if scheme == "image":
        width, height, form, data = rest.split(";")
        assert form == "rgb", form
        data, width, height = base64.b64decode(data), int(width), int(height)
        return [data[3 * width * y + 1:3 * width * (y + 1):3] for y in range(height)]
    png = open(rest[2:], "rb").read() if scheme == "file" else base64.b64decode(rest.split(";")[1])
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack_from(">I4s", png, at)
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", png, at + 8)
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + size]
        at += size + 12
    data = zlib.decompress(data)
    return [data[(3 * width + 1) * y + 2:(3 * width + 1) * (y + 1):3] for y in range(height)]


def cut(rows, x, y, size):
    if x < 0 or y < 0 or y + size > len(rows) or x + size > len(rows[0]):
        return None
    return [rows[j][x:x + size] for j in range(y, y + size)]


def look(rows, first, x, y, size):
    def miss(place):
        here = cut(rows, *place, size)
        if here is None:
            return float("inf")
        return sum((a - b) ** 2 for one, other in zip(here, first) for a, b in zip(one, other)) + (place != (x, y))

    return min(((x + i, y + j) for j in range(-3, 4) for i in range(-3, 4)), key=miss)


print("this line is not of the protocol")
print(f"@@TRAX:hello trax.version={VERSION} trax.name=small trax.image={FORM}; \"trax.region=rectangle;polygon;\"", flush=True)
region, n = None, 0
for line in sys.stdin:
    name, *words = line.strip().removeprefix("@@TRAX:").split(" ")
    words = [word.strip('"') for word in words]
    if name == "quit":
        break
    if name == "initialize":
        x, y, width, _ = map(float, words[-1].split(","))
        region, first = (round(x), round(y), round(width)), None
    if name == "frame" or VERSION < 4:
        n += 1
        if QUITS and n == 3:
            print("@@TRAX:quit", flush=True)
            break
        if "hangs" in sys.argv and n == 3:
            open(os.path.join(os.environ["TMPDIR"], "here"), "w").close()
            signal.pause()
        while "babbles" in sys.argv and n == 3:
            sys.stdout.write("x" * 4096)
        rows = pixels(words[0])
        if first is None:
            first = cut(rows, *region)
        elif first:
            region = (*look(rows, first, *region), region[2])
        print(f"@@TRAX:state {region[0]},{region[1]},{region[2]},{region[2]}", flush=True)

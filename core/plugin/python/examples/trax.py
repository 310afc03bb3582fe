"""A tracker that speaks TraX, as those of the VOT challenges do, unmodified: each point is a small rectangle, followed by a
process of its own. https://github.com/votchallenge/trax/blob/master/docs/protocol.rst
"""
import base64
import contextlib
import os
import re
import select
import struct
import subprocess
import tempfile
import time
import zlib

import honami
import numpy as np

COMMAND = ["python3", "tracker.py"]  # how a server is started
READS = []  # folders that it needs, beside those of the system


class Settings(honami.Params):
    side = honami.Int(31, 5, 301, unit="px", doc="Side of the rectangle that stands for a point.")
    most = honami.Int(50, 1, 400, doc="The most points, each of which costs a process.")
    patience_s = honami.Float(5, 0.1, 600, unit="s", doc="How long a server may work on a frame.")


START_S = 60  # until its first answer: it may have a network to load
LINE_BYTES_MAX = 1 << 20


class Gone(Exception):
    """A server is of no more use; the text is what it did."""


class Server:
    """A process that follows one rectangle."""

    def __init__(self):
        self.process = subprocess.Popen(COMMAND, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        os.set_blocking(self.process.stdin.fileno(), False)
        self.bytes, self.patience_s, self.until = b"", START_S, time.monotonic() + START_S
        try:
            self.agree(*self.hear("hello"))
        except BaseException:
            self.kill()
            raise

    def agree(self, _, about):
        self.version = int(about.get("trax.version", "1"))
        said = about.get("trax.image", "path").split(";")
        self.images = [form for form in FORMS if form in said]
        regions = [form for form in about.get("trax.region", "rectangle").split(";") if form]
        self.is_polygon = "rectangle" not in regions
        if not self.images or (self.is_polygon and "polygon" not in regions):
            raise honami.Error(f"takes images as {about.get('trax.image')} and regions as {about.get('trax.region')}: "
                               f"wanted one of {', '.join(FORMS)}, and rectangle or polygon")
        if about.get("trax.channels", "color").strip(";") != "color":
            raise honami.Error(f"wants the channels {about['trax.channels']}; a clip has color alone")

    def say(self, name, *words):
        words = "".join(' "%s"' % word.replace("\\", "\\\\").replace('"', '\\"') for word in words)
        left = memoryview(f"@@TRAX:{name}{words}\n".encode())
        self.until = time.monotonic() + self.patience_s
        while left:
            honami.progress(-1, "telling the TraX server")
            if time.monotonic() > self.until:
                raise Gone(f"heard nothing for {self.patience_s:g} s")
            try:
                if select.select([], [self.process.stdin], [], 0.1)[1]:
                    left = left[os.write(self.process.stdin.fileno(), left):]
            except BrokenPipeError:
                raise Gone("ended") from None

    def hear(self, *wanted):
        """Words and properties of its next message; everything else that it prints is a line of the log."""
        is_late = False
        while True:
            while b"\n" not in self.bytes:
                honami.progress(-1, "waiting for the TraX server")
                if is_late:
                    raise Gone(f"gave no answer for {self.patience_s:g} s")
                if len(self.bytes) > LINE_BYTES_MAX:
                    raise Gone("said a line without end")
                is_late = time.monotonic() > self.until  # once more, for what it has said while others were heard
                if select.select([self.process.stdout], [], [], 0 if is_late else 0.1)[0]:
                    more = os.read(self.process.stdout.fileno(), 1 << 16)
                    if not more:
                        raise Gone("ended")
                    self.bytes += more
            line, self.bytes = self.bytes.split(b"\n", 1)
            line = line.decode(errors="replace").strip()
            if not line.startswith("@@TRAX:"):
                honami.log(line)
                continue
            name, *rest = line[len("@@TRAX:"):].split(" ", 1)
            if name == "quit":
                raise Gone("quit")
            if name not in wanted:
                raise honami.Error(f"the TraX server says {name}, wanted {wanted[0]}")
            found = [a or b for a, b in re.findall(r'"((?:[^"\\]|\\.)*)"|(\S+)', rest[0] if rest else "")]
            found = [re.sub(r"\\(.)", lambda m: "\n" if m[1] == "n" else m[1], word) for word in found]
            pairs = [re.fullmatch(r"([\w.]{1,64})=(.*)", word, re.S) for word in found]
            return [word for word, pair in zip(found, pairs) if not pair], {p[1]: p[2] for p in pairs if p}

    def state(self):
        """Where it sees the middle of its region; None where it says that it does not."""
        words, _ = self.hear("state", "status")
        try:
            numbers = [float(number) for number in words[0].split(",")]
        except (IndexError, ValueError):
            raise honami.Error(f"the TraX server says that the region is {words}") from None
        if len(numbers) < 4 or not np.isfinite(numbers).all():
            return None
        if len(numbers) == 4:
            left, top, width, height = numbers
            return np.array([left + (width - 1) / 2, top + (height - 1) / 2])
        corners = np.array(numbers[:len(numbers) // 2 * 2]).reshape(-1, 2)
        return (corners.min(0) + corners.max(0) - 1) / 2

    def follow(self, picture, x, y, side):
        """Begins with the square around (x, y)."""
        left, top = x - (side - 1) / 2, y - (side - 1) / 2
        numbers = [left, top, side, side]
        if self.is_polygon:
            numbers = [left, top, left + side, top, left + side, top + side, left, top + side]
        region = ",".join(f"{number:.4f}" for number in numbers)
        if self.version < 4:
            self.say("initialize", picture.uri(self.images[0]), region)
        else:
            self.say("initialize", region)
            self.say("frame", picture.uri(self.images[0]))
        return self.state()

    def end(self):
        self.patience_s = 0.5  # to be told
        with contextlib.suppress(Gone):
            self.say("quit")
            self.process.stdin.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(0.5)
        self.kill()

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


def unreadable():
    """The first folder that its command needs and that cannot be read, and why."""
    for path in READS + [word for word in COMMAND if os.path.isabs(word)]:
        try:
            os.listdir(path) if os.path.isdir(path) else open(path, "rb").close()
        except OSError as error:
            return path if path in READS else os.path.dirname(path), error.strerror
    return None


FORMS = ("memory", "path", "buffer")


class Picture:
    """A frame in colours, in whatever form a server takes it; made when first asked for."""

    def __init__(self, frame, folder):
        gray = frame.gray.astype("f4")
        rgb = [gray, gray, gray]
        if frame.cb is not None:
            height, width = gray.shape
            at = np.ix_(np.arange(height) * frame.cb.shape[0] // height, np.arange(width) * frame.cb.shape[1] // width)
            cb, cr = frame.cb[at] - np.float32(128), frame.cr[at] - np.float32(128)
            rgb = [gray + 1.402 * cr, gray - 0.344136 * cb - 0.714136 * cr, gray + 1.772 * cb]  # BT.601
        self.rgb = np.stack(rgb, 2).round().clip(0, 255).astype("u1")
        self.folder, self.said = folder, {}

    def uri(self, form):
        if form not in self.said:
            self.said[form] = getattr(self, form)()
        return self.said[form]

    def memory(self):
        height, width, _ = self.rgb.shape
        return f"image:{width};{height};rgb;{base64.b64encode(self.rgb.tobytes()).decode()}"

    def buffer(self):
        return f"data:image/png;{base64.b64encode(self.png()).decode()}"

    def path(self):
        self.file = os.path.join(self.folder, f"{time.monotonic_ns()}.png")
        with open(self.file, "wb") as file:
            file.write(self.png())
        return f"file://{self.file}"

    def png(self):
        height, width, _ = self.rgb.shape
        rows = np.zeros((height, 1 + 3 * width), "u1")  # each begins with its filter, none
        rows[:, 1:] = self.rgb.reshape(height, -1)
        chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
                  (b"IDAT", zlib.compress(rows.tobytes(), 1)), (b"IEND", b"")]
        chunks = [struct.pack(">I", len(d)) + n + d + struct.pack(">I", zlib.crc32(n + d)) for n, d in chunks]
        return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)

    def forget(self):
        if hasattr(self, "file"):
            os.remove(self.file)


@honami.tracker("org.honami.template", "A TraX server for each point", params=Settings, deterministic=False,
                doc="Each point is a small rectangle, followed by a process of its own.")
class Trax:
    def __init__(self):
        self.points = {}

    def begin(self, stream):
        self.end()  # of a stream that has failed
        self.last = None
        self.folder = tempfile.mkdtemp()

    def seed(self, points):
        for i, x, y in zip(points.id.tolist(), points.x.tolist(), points.y.tolist()):
            self.drop(i)
            if len(self.points) == self.params.most:
                raise honami.Error(f"{self.params.most} points at most: each has a process of its own (--set most=N)")
            self.points[i] = {"at": np.array([x, y]), "server": None, "off": 0}
            if self.last is not None:
                self.follow(i, self.last)

    def follow(self, i, picture):
        """Starts a server; what it says of the first frame is what was seeded."""
        point, command = self.points[i], " ".join(COMMAND)
        try:
            point["server"] = Server()
        except (Gone, OSError) as error:
            if folder := unreadable():
                raise honami.Error(f"{folder[0]} cannot be read ({folder[1]}), and {command} needs it: wanted a folder in "
                                   "READS of this file that is not your home or above it") from None
            said = f"{error} before it said hello" if isinstance(error, Gone) else f"cannot be started: {error}"
            raise honami.Error(f"{command} {said}: is it a TraX server?") from None
        try:
            seen = point["server"].follow(picture, *point["at"], self.params.side)
            point["off"] = 0 if seen is None else point["at"] - seen
            point["server"].patience_s = self.params.patience_s
        except Gone as gone:
            self.part(i, gone)

    def retire(self, ids):
        for i in ids.tolist():
            self.drop(i)

    def push(self, frame):
        picture, status, is_first = Picture(frame, self.folder), {}, self.last is None
        asked = []
        for i, point in self.points.items():
            status[i] = honami.LOST
            if is_first:
                self.follow(i, picture)
                status[i] = honami.TRACKED if point["server"] else honami.LOST
            elif point["server"]:
                asked.append(i)
        for i in list(asked):
            try:
                server = self.points[i]["server"]
                server.say("frame", picture.uri(server.images[0]))
            except Gone as gone:
                self.part(i, gone)
                asked.remove(i)
        for i in asked:
            status[i] = self.look(i, frame.gray.shape)
        if self.last is not None:
            self.last.forget()
        self.last = picture
        x, y = np.array([point["at"] for point in self.points.values()]).reshape(-1, 2).T
        return honami.Points(list(status), x, y, list(status.values()))

    def look(self, i, shape):
        point = self.points[i]
        try:
            seen = point["server"].state()
        except Gone as gone:
            self.part(i, gone)
            return honami.LOST
        if seen is None:
            return honami.LOST
        point["at"] = x, y = seen + point["off"]
        is_inside = -0.5 <= x < shape[1] - 0.5 and -0.5 <= y < shape[0] - 0.5
        return honami.TRACKED if is_inside else honami.OUTSIDE

    def part(self, i, gone):
        """Of a server that is of no more use."""
        honami.log(f"the TraX server of point {i} {gone}: its point is lost", 2)
        self.points[i]["server"].kill()
        self.points[i]["server"] = None

    def drop(self, i):
        point = self.points.pop(i, None)
        if point and point["server"]:
            point["server"].end()

    def end(self):
        for i in list(self.points):
            self.drop(i)


honami.run(license="MIT OR Apache-2.0", exec=True, read=READS)

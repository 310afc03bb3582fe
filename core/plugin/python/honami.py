"""Plugins for honami in Python: one file, standard library and numpy.

    import honami

    class Settings(honami.Params):
        radius = honami.Int(7, 1, 50, unit="px", doc="Half the side of the window.")

    @honami.tracker("org.me.mine", "My tracker", params=Settings)
    class Mine:
        def begin(self, stream): ...         # stream.width, .height, .fps, .max_threads, .seed, .reversed
        def seed(self, points): ...          # points.id, .x, .y: arrays; they hold in the frame pushed last
        def push(self, frame): ...           # frame.gray: rows x columns of bytes; .cb, .cr, .index, .time_s
            return honami.Points(id, x, y, status)

    honami.run()

`self.params` holds the values of the parameters. A tracker may also have `retire(ids)`, `end()`,
`detect(frame, max_features, mask, points)`, which returns `honami.Features(x, y, score)`, and `field(a, b)`, which
returns `honami.Field(gx, gy, step, u, v, known)`. One with `save()`, which returns bytes with all that later frames depend
on, and `load(bytes)`, which comes after `begin` in their place, goes on with the same numbers when its process has died; it
only gets what it saved under the same parameters and the same `state_version`, a number of its class. Arrays that it is
given are gone after the call: copy what you keep. One that follows every point by itself
derives from `honami.PointByPoint`, which does all of this, and writes two functions.

    @honami.clusterer("org.me.groups", "My groups", params=Settings)
    class Groups:
        def cluster(self, tracks): ...       # tracks.id; .x, .y: tracks x frames, NaN where not seen; .frame, .time_s
            return honami.Tree(merges)       # rows a, b, height, as of scipy.cluster.hierarchy.linkage

    @honami.structure("org.me.branches", "My branches", params=Settings)
    class Branches:
        def grow(self, filmed): ...          # all of the above, and .parent, .group, .root, .mask
            return honami.Skeleton(root, parent, length, pose, bears)

`filmed.parent` is, of every group, the group that it is part of (-1 for the whole, group 0), `filmed.group`, of every
track, its group, which has no parts (-1: none), `filmed.root` x and y of where the plant leaves the ground, or None, and
`filmed.mask` rows x columns of bytes, not 0 where branches may be, or None.

`python3 mine.py --honami-manifest` writes `mine.honami.json`, from which honami lists the plugin and draws its form
without running it. Write it anew when parameters change. What is printed is a line of the plugin's log.
"""

import io
import json
import mmap
import os
import select
import signal
import socket
import struct
import sys
import threading
import traceback
import zlib
from types import SimpleNamespace

import numpy as np

LOST, TRACKED, OCCLUDED, OUTSIDE, REJECTED, NEWBORN = range(6)

_FAILED, _UNSUPPORTED, _DATA, _CANCELLED, _INTERNAL = -1, -2, -5, -8, -10
_PAGE = 4096


class Error(Exception):
    """The input cannot be worked on; the text is for the user."""


class Cancelled(Exception):
    """The user wants to stop. Let it pass through your code."""


class _Param:
    def __init__(self, kind, default, **more):
        self.default = default
        self.schema = {"type": kind, "default": default, **{k: v for k, v in more.items() if v is not None}}


def Int(default, min, max, *, unit=None, label=None, group=None, doc=None):
    return _Param("int", default, min=min, max=max, unit=unit, label=label, group=group, doc=doc)


def Float(default, min, max, *, unit=None, label=None, group=None, doc=None):
    return _Param("float", float(default), min=float(min), max=float(max), unit=unit, label=label, group=group, doc=doc)


def Bool(default, *, label=None, group=None, doc=None):
    return _Param("bool", default, label=label, group=group, doc=doc)


def Enum(default, entries, *, label=None, group=None, doc=None):
    """`entries`: ids with labels, as {"fast": "Fast", "good": "Good"}."""
    entries = [{"id": id, "label": words} for id, words in entries.items()]
    return _Param("enum", default, entries=entries, label=label, group=group, doc=doc)


def File(default="", *, label=None, group=None, doc=None):
    """A file that the plugin reads; it can open no others."""
    return _Param("path", default, mode="open", label=label, group=group, doc=doc)


class Params:
    """Base of a class whose attributes are parameters."""

    @classmethod
    def _schema(cls):
        return [{"id": id, **p.schema} for id, p in vars(cls).items() if isinstance(p, _Param)]

    def __init__(self, values):
        for id, param in vars(type(self)).items():
            if isinstance(param, _Param):
                setattr(self, id, values.get(id, param.default))


def Points(id, x, y, status, fb=None, ncc=None):
    """A row a live point: id, position, status; optionally the error there and back, and the likeness."""
    columns = {"id": (id, "u4"), "x": (x, "f4"), "y": (y, "f4"), "status": (status, "u1")}
    return {"honami.points/1": {**columns, **_optional(fb=fb, ncc=ncc)}}


def Features(x, y, score):
    """Places worth following, best first."""
    return {"honami.features/1": {"x": (x, "f4"), "y": (y, "f4"), "score": (score, "f4")}}


def Field(gx, gy, step, u, v, known=None):
    """Displacements at the nodes of a grid: node (i, j) lies at (gx + i step, gy + j step); u, v are rows x columns."""
    ny, nx = np.shape(u)
    one = {"gx": ([gx], "f4"), "gy": ([gy], "f4"), "step": ([step], "f4"), "nx": ([nx], "u4"), "ny": ([ny], "u4")}
    vectors = {"u": (np.ravel(u), "f4"), "v": (np.ravel(v), "f4")}
    if known is not None:
        vectors["known"] = (np.ravel(known), "u1")
    return {"honami.vectors/1": vectors, "honami.grid/1": one}


def Tree(merges, outlier=None, distance=None, frame=None):
    """Merges, a row each: what is merged and how far it is apart. Leaf k is track k, row r makes cluster n + r.

    `outlier` and `distance`, if frames are judged: a number each of `frame`, those of the tracks.
    """
    merges = np.array([row[:3] for row in merges], "f8").reshape(-1, 3)
    sizes = [1] * (len(merges) + 1)
    for a, b, _ in merges:
        sizes.append(sizes[int(a)] + sizes[int(b)])
    a, b, height = merges.T
    tree = {"a": (a, "u4"), "b": (b, "u4"), "height": (height, "f8"), "size": (sizes[len(merges) + 1:], "u4")}
    if outlier is None:
        return {"honami.dendrogram/1": tree}
    judged = {"frame": (frame, "i8"), "outlier": (outlier, "u1"), "distance": (distance, "f8")}
    return {"honami.dendrogram/1": tree, "honami.frames/1": judged}


def Skeleton(root, parent, length, pose, bears, leaves=None, offsets=None):
    """Joints at the ends of bones, each after its parent; pixels; x right, y away from the camera, z up.

    `root`: x, y, z of the first joint, which has parent -1 and length 0; `pose`: frames x joints x 3, the way each bone
    points, of length 1 (of the root it says nothing); `bears`: pairs of a joint and a group that it has become; `leaves`:
    pairs of a joint and a track that it carries, `offsets`: leaves x frames x 3, from the joint to it.
    """
    bears = np.reshape(bears, (-1, 2))
    tables = {
        "honami.joints/1": {"parent": (parent, "i4"), "length": (length, "f8")},
        "honami.root/1": {axis: ([v], "f8") for axis, v in zip("xyz", root)},
        "honami.pose/1": {"d": (np.reshape(pose, (-1, 3)), "f8")},
        "honami.bears/1": {"joint": (bears[:, 0], "u4"), "group": (bears[:, 1], "u4")},
    }
    if leaves is not None:
        leaves = np.reshape(leaves, (-1, 2))
        tables["honami.leaves/1"] = {"joint": (leaves[:, 0], "u4"), "track": (leaves[:, 1], "u4")}
        tables["honami.offsets/1"] = {"d": (np.reshape(offsets, (-1, 3)), "f8")}
    return tables


def window(gray, x, y, r, outside=None):
    """The window of radius r around the pixel nearest to (x, y), copied; None where it leaves the picture.

    With `outside`, a number, there is always one, of integers: what lies outside the picture has that number.
    """
    (height, width), side = gray.shape, 2 * r + 1
    left, top = [int(np.clip(np.floor(v + 0.5) - r, -side, n)) for v, n in ((x, width), (y, height))]
    leaves = not (0 <= left <= width - side and 0 <= top <= height - side)
    if leaves and outside is None:
        return None
    inner = gray[max(top, 0):max(top + side, 0), max(left, 0):max(left + side, 0)]
    if outside is None:
        return inner.copy()
    whole = np.full((side, side), outside, "i4")
    down, right = max(-top, 0), max(-left, 0)
    whole[down:down + inner.shape[0], right:right + inner.shape[1]] = inner
    return whole


class PointByPoint:
    """Base of a tracker that follows every point by itself.

    `start(gray, x, y)` returns what is remembered of a point where it was seeded: an array, a number or None;
    `follow(gray, x, y, first)` where the point is in the next picture: x, y and its status. `first` is what was remembered.
    """

    def begin(self, stream):
        self._live, self._last = {}, None

    def seed(self, points):
        for id, x, y in zip(points.id.tolist(), points.x.tolist(), points.y.tolist()):
            self._live[id] = x, y, None if self._last is None else self.start(self._last, x, y)

    def retire(self, ids):
        for id in ids.tolist():
            self._live.pop(id, None)

    def push(self, frame):
        rows = []
        for id, (x, y, first) in self._live.items():
            progress(len(rows) / len(self._live), "following points")
            if self._last is None:
                first = self.start(frame.gray, x, y)
            x, y, status = self.follow(frame.gray, x, y, first)
            self._live[id] = x, y, first
            rows.append((id, x, y, status))
        self._last = frame.gray.copy()
        return Points(*(zip(*rows) if rows else [()] * 4))

    def save(self):
        kept = {f"first {id}": first for id, (_, _, first) in self._live.items() if first is not None}
        if self._last is not None:
            kept["last"] = self._last
        file = io.BytesIO()
        np.savez(file, id=list(self._live), at=[(x, y) for x, y, _ in self._live.values()], **kept)
        return file.getvalue()

    def load(self, data):
        kept = np.load(io.BytesIO(data), allow_pickle=False)  # what is pickled could run anything
        points = zip(kept["id"].tolist(), kept["at"].tolist())
        self._live = {id: (x, y, kept.get(f"first {id}")) for id, (x, y) in points}
        self._last = kept.get("last")


def _optional(**columns):
    return {name: (values, "f4") for name, values in columns.items() if values is not None}


_plugins = {}


def tracker(id, name, *, params=Params, doc="", cite=(), deterministic=True):
    """Makes a class a tracker."""

    def keep(cls):
        interfaces = ["honami.tracker/1"] + [f"honami.{f}/1" for f in ("detect", "field") if hasattr(cls, f)]
        interfaces += ["honami.state/1"] if hasattr(cls, "save") and hasattr(cls, "load") else []
        return _keep(cls, id, name, "tracker", interfaces, params, doc, cite, deterministic)

    return keep


def clusterer(id, name, *, params=Params, doc="", cite=(), deterministic=True):
    """Makes a class a clusterer."""
    return lambda cls: _keep(cls, id, name, "clusterer", ["honami.clusterer/1"], params, doc, cite, deterministic)


def structure(id, name, *, params=Params, doc="", cite=(), deterministic=True):
    """Makes a class a structure builder."""
    return lambda cls: _keep(cls, id, name, "structure", ["honami.structure/1"], params, doc, cite, deterministic)


def _keep(cls, id, name, kind, interfaces, params, doc, cite, deterministic):
    caps = {"latency": 0, "deterministic": deterministic, "parallel_instances": True, "pixels": ["gray8"]}
    cls.Params, _plugins[id] = params, cls
    cls._manifest = {"id": id, "kind": kind, "name": name, "doc": doc, "cite": list(cite),
                     "interfaces": interfaces, "caps": caps, "params": params._schema()}
    return cls


def progress(fraction, text=""):
    """Says how far the work is, 0 to 1; call it every quarter of a second, or the host takes you for dead."""
    _host.progress(fraction, text)


def log(text, level=1):
    """Writes a line to the log: 0 debug, 1 information, 2 warning, 3 error."""
    _host.say({"m": "log", "level": level, "text": str(text)})


def run(library=None, version="0", license="", exec=False, read=()):
    """Serves the host that has started this program, or writes the manifest.

    `exec`: it starts other programs; `read`: files and folders that it reads beside those that parameters name. The user
    sees both before they allow it.
    """
    if "--honami-manifest" in sys.argv:
        return _write_manifest(library, version, license, {"exec": exec, "read": list(read)})
    global _host
    _host = _Host()
    _host.serve()


def _manifest_file(script):
    return os.path.splitext(os.path.abspath(script))[0] + ".honami.json"


def _kept_manifest():
    """What honami knows of the plugins: it runs a copy of the program with its manifest beside it."""
    with open(_manifest_file(sys.argv[0])) as file:
        return json.load(file)["plugins"]


def _write_manifest(library, version, license, needs):
    script = os.path.abspath(sys.argv[0])
    plugins = [cls._manifest for cls in _plugins.values()]
    about = {"id": library or plugins[0]["id"], "version": version, "license": license}
    manifest = {"honami": 1, "abi": [1, 1], "library": about, "plugins": plugins,
                "exec": ["python3", os.path.basename(script)], "needs": needs}
    path = _manifest_file(script)
    with open(path, "w") as file:
        json.dump(manifest, file, indent=1)
    print(path)


class _Host:
    """The other end: a line of JSON a message, pictures and columns in two shared memories."""

    def __init__(self):
        # The plugin is not to find the socket at its standard input.
        self.socket = socket.socket(fileno=os.dup(0))
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        sys.stdout.reconfigure(line_buffering=True)
        self.turn = threading.Lock()
        threading.Thread(target=self.end_with_host, daemon=True).start()
        line, memories, _, _ = socket.recv_fds(self.socket, _PAGE, 2)
        self.hello = json.loads(line)
        self.input = mmap.mmap(memories[0], 0, access=mmap.ACCESS_READ)
        self.output_file, self.output = memories[1], mmap.mmap(memories[1], 0)
        self.used, self.text, self.fraction = _PAGE, "", 0.0

    def end_with_host(self):
        gone = select.poll()
        gone.register(self.socket, select.POLLRDHUP)
        gone.poll()
        os.killpg(0, signal.SIGKILL)  # and what the plugin has started

    def say(self, message):
        with self.turn:
            self.socket.sendall(json.dumps(message).encode() + b"\n")

    def progress(self, fraction, text):
        beat = struct.unpack_from("<Q", self.output, 8)[0] + 1
        struct.pack_into("<Qd", self.output, 8, beat, fraction)
        if text != self.text:
            self.text = text
            self.say({"m": "at", "text": text})
        if struct.unpack_from("<I", self.output, 0)[0]:
            raise Cancelled

    def serve(self):
        plugin = _plugins.get(self.hello["plugin"])
        if plugin is None:
            why = f"has no plugin {self.hello['plugin']!r}: write its manifest anew"
            return self.say({"m": "refused", "kind": "unusable", "why": why})
        if plugin._manifest not in _kept_manifest():
            script = os.path.basename(sys.argv[0])
            why = f"has other parameters than its manifest: `python3 {script} --honami-manifest` writes it anew"
            return self.say({"m": "refused", "kind": "unusable", "why": why})
        try:
            self.instance, self.gone, self.values = plugin(), set(), {}
        except Exception as error:
            traceback.print_exc()
            text = "".join(traceback.format_exception_only(error)).strip()
            return self.say({"m": "refused", "kind": "failed", "code": _INTERNAL, "text": text})
        self.instance.params = plugin.Params({})
        self.say({"m": "done"})
        for line in self.socket.makefile("rb"):
            ask = json.loads(line)
            self.say({"m": "done", **self.answer(ask)})

    def answer(self, ask):
        try:
            return {"code": 0, "tables": self.lay_down(getattr(self, "on_" + ask["m"])(ask) or {})}
        except Cancelled:
            return {"code": _CANCELLED}
        except Error as error:
            return {"code": _DATA, "text": str(error)}
        except Exception as error:
            traceback.print_exc()
            what = "".join(traceback.format_exception_only(error)).strip()
            of_plugin = [at for at in traceback.extract_tb(error.__traceback__) if at.filename != __file__]
            where = f", {os.path.basename(of_plugin[-1].filename)} line {of_plugin[-1].lineno}" if of_plugin else ""
            return {"code": _INTERNAL, "text": what + where}

    def on_set_params(self, ask):
        self.values = ask["values"]
        self.instance.params = type(self.instance).Params(ask["values"])

    def on_begin(self, ask):
        self.gone = set()
        version = getattr(self.instance, "state_version", 0)
        stream = [ask[name] for name in ("width", "height", "reversed", "seed", "birth_first", "birth_count")]
        self.setting = [self.hello["plugin"], version, self.values, stream]
        self.call("begin", SimpleNamespace(**ask))

    def on_seed(self, ask):
        points = self.points(ask["points"])
        self.gone -= set(points.id.tolist())
        self.instance.seed(points)

    def on_retire(self, ask):
        ids = self.column(ask["ids"], "id", "u4")
        self.gone |= set(ids.tolist())
        self.call("retire", ids)

    def on_push(self, ask):
        tables = self.instance.push(self.frame(ask["frame"])) or {}
        if self.gone and "honami.points/1" in tables:
            rows = tables["honami.points/1"]
            live = ~np.isin(rows["id"][0], list(self.gone))
            tables["honami.points/1"] = {n: (np.asarray(c)[live], kind) for n, (c, kind) in rows.items()}
        return tables

    def on_end(self, ask):
        return self.call("end")

    def on_save(self, ask):
        head = json.dumps([self.setting, sorted(self.gone)]).encode()
        saved = struct.pack("<I", len(head)) + head + bytes(self.instance.save())
        return {"honami.state/1": {"bytes": (np.frombuffer(struct.pack("<I", zlib.crc32(saved)) + saved, "u1"), "u1")}}

    def on_load(self, ask):
        saved = self.column(ask["state"], "bytes", "u1").tobytes()
        if len(saved) < 8 or struct.unpack_from("<I", saved)[0] != zlib.crc32(saved[4:]):
            raise Error("what was saved is cut or damaged")
        end = 8 + struct.unpack_from("<I", saved, 4)[0]
        try:
            setting, gone = json.loads(saved[8:end])
            if setting != self.setting:
                raise Error("what was saved is of another plugin or version, of other parameters or another stream")
            self.instance.load(saved[end:])
        except Error:
            raise
        except Exception as error:
            raise Error(f"what was saved cannot be read: {error}")
        self.gone = set(gone)

    def on_detect(self, ask):
        mask = self.plane(ask["mask"]) if ask["mask"] else None
        points = self.points(ask["points"])
        return self.instance.detect(self.frame(ask["frame"]), ask["max_features"], mask, points)

    def on_field(self, ask):
        return self.instance.field(self.frame(ask["from"]), self.frame(ask["to"]))

    def on_cluster(self, ask):
        return self.instance.cluster(self.tracks(ask))

    def on_grow(self, ask):
        filmed, groups = self.tracks(ask["movement"]), ask["groups"]
        of = {"rows": len(filmed.id), "at": groups["at"]}
        filmed.parent, filmed.group = self.column(groups, "parent", "i4"), self.column(of, "group", "i4")
        filmed.root, filmed.mask = ask["root"], self.plane(ask["mask"]) if ask["mask"] else None
        return self.instance.grow(filmed)

    def call(self, name, *args):
        return getattr(self.instance, name)(*args) if hasattr(self.instance, name) else None

    def column(self, table, name, kind):
        return np.frombuffer(self.input, "<" + kind, table["rows"], table["at"][name])

    def points(self, table):
        return SimpleNamespace(**{n: self.column(table, n, k) for n, k in [("id", "u4"), ("x", "f4"), ("y", "f4")]})

    def tracks(self, ask):
        """Positions as tracks x frames, NaN where a track was not seen."""
        table, times = ask["tracks"], ask["times"]
        samples = {"rows": ask["n_samples"], "at": table["at"]}
        x, y, status = [self.column(samples, n, k) for n, k in [("x", "f4"), ("y", "f4"), ("status", "u1")]]
        first, length, offset = [self.column(table, n, k) for n, k in [("frame0", "i8"), ("len", "u4"), ("offset", "u8")]]
        frame = self.column(times, "frame", "i8")
        seen = np.isin(status, (TRACKED, NEWBORN))
        whole = np.full((2, len(first), len(frame)), np.nan)
        for k, (start, n, at) in enumerate(zip(first.tolist(), length.tolist(), offset.tolist())):
            to = start - int(frame[0])
            whole[:, k, to:to + n] = np.where(seen[at:at + n], (x[at:at + n], y[at:at + n]), np.nan)
        return SimpleNamespace(id=self.column(table, "id", "u4"), x=whole[0], y=whole[1], frame=frame,
                               time_s=self.column(times, "time_s", "f8"), width=ask["width"], height=ask["height"],
                               max_threads=ask["max_threads"], seed=ask["seed"])

    def plane(self, plane):
        height, width = plane["height"], plane["width"]
        return np.frombuffer(self.input, "u1", height * width, plane["at"]).reshape(height, width)

    def frame(self, frame):
        cb, cr = [self.plane(plane) for plane in frame["chroma"]] if frame.get("chroma") else (None, None)
        gray = self.plane(frame["gray"])
        return SimpleNamespace(gray=gray, cb=cb, cr=cr, index=frame["index"], time_s=frame["time_s"])

    def lay_down(self, tables):
        """Writes result tables where the host reads them."""
        self.used, said = _PAGE, {}
        for schema, columns in tables.items():
            arrays = {n: np.ascontiguousarray(values, "<" + kind) for n, (values, kind) in columns.items()}
            rows = {len(array) for array in arrays.values()}
            if len(rows) != 1:
                raise Error(f"columns of {schema} have {sorted(rows)} rows, wanted the same in all")
            said[schema] = {"rows": rows.pop(), "at": {n: self.put(array) for n, array in arrays.items()}}
        return said

    def put(self, array):
        at, size = self.used, array.nbytes
        end = (at + size + 63) // 64 * 64
        if end > len(self.output):
            os.ftruncate(self.output_file, 1 << (end - 1).bit_length())
            self.output = mmap.mmap(self.output_file, 0)
        self.output[at:at + size] = array.tobytes()
        self.used = end
        return at

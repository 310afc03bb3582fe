"""A tracker that looks for every point's first picture of it, near where it was last."""
import io

import honami
import numpy as np


class Settings(honami.Params):
    radius = honami.Int(7, 2, 30, unit="px", doc="Half the side of the template.")
    search = honami.Int(6, 1, 30, unit="px", doc="How far a point may move from frame to frame.")


@honami.tracker("org.honami.template", "Templates of the first frame", params=Settings,
                doc="Looks for the first picture of every point, near where it was last.")
class Template:
    def begin(self, stream):
        self.at, self.first, self.last = {}, {}, None

    def seed(self, points):
        for i, x, y in zip(points.id.tolist(), points.x.tolist(), points.y.tolist()):
            self.at[i] = (x, y)
            self.first[i] = None if self.last is None else honami.window(self.last, x, y, self.params.radius)

    def retire(self, ids):
        for i in set(ids.tolist()) & set(self.at):
            del self.at[i], self.first[i]

    def push(self, frame):
        status, edge = [], self.params.radius + self.params.search
        wide = np.pad(frame.gray.astype("i4"), edge, constant_values=-30000)  # nothing looks like what is outside
        for n, i in enumerate(self.at):
            honami.progress(n / len(self.at), "looking for templates")
            if self.last is None:
                self.first[i] = honami.window(frame.gray, *self.at[i], self.params.radius)
            status.append(self.look(wide, i, edge))
        self.last = frame.gray.copy()
        x, y = zip(*self.at.values()) if self.at else ((), ())
        return honami.Points(list(self.at), x, y, status)

    def look(self, wide, i, edge):
        """Moves a point to where its template fits best; it stays where all look alike."""
        (x, y), s = self.at[i], self.params.search
        near = honami.window(wide, x + edge, y + edge, edge)
        if self.first[i] is None or near is None:
            return honami.LOST
        windows = np.lib.stride_tricks.sliding_window_view(near, self.first[i].shape)
        miss = ((windows - self.first[i].astype("i4")) ** 2).sum((2, 3))
        miss[s, s] -= 1
        j, k = np.unravel_index(miss.argmin(), miss.shape)
        self.at[i] = (x + int(k) - s, y + int(j) - s)
        return honami.TRACKED

    def save(self):
        kept = {f"first {i}": window for i, window in self.first.items() if window is not None}
        if self.last is not None:
            kept["last"] = self.last
        file = io.BytesIO()
        np.savez(file, id=list(self.at), at=list(self.at.values()), **kept)
        return file.getvalue()

    def load(self, data):
        kept = np.load(io.BytesIO(data), allow_pickle=False)  # what is pickled could run anything
        ids = kept["id"].tolist()
        self.at = dict(zip(ids, map(tuple, kept["at"].tolist())))
        self.first = {i: kept.get(f"first {i}") for i in ids}
        self.last = kept.get("last")


honami.run(license="MIT OR Apache-2.0")

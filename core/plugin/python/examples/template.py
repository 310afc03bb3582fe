"""A tracker that looks for every point's first picture of it, near where it was last."""
import pickle

import honami
import numpy as np


class Settings(honami.Params):
    radius = honami.Int(7, 2, 30, unit="px", doc="Half the side of the template.")
    search = honami.Int(6, 1, 30, unit="px", doc="How far a point may move from frame to frame.")


@honami.tracker("org.honami.template", "Templates of the first frame", params=Settings)
class Template:
    def begin(self, stream):
        self.at, self.templates, self.gray = {}, {}, None

    def seed(self, points):
        self.at.update({int(i): (int(round(x)), int(round(y))) for i, x, y in zip(points.id, points.x, points.y)})
        self.templates.update({int(i): None for i in points.id})
        if self.gray is not None:
            self.templates.update({int(i): self.cut(self.gray, *self.at[int(i)]) for i in points.id})

    def cut(self, gray, x, y, more=0):
        r = self.params.radius + more
        whole = x >= r and y >= r and x + r < gray.shape[1] and y + r < gray.shape[0]
        return gray[y - r:y + r + 1, x - r:x + r + 1].astype("f4") if whole else None

    def look(self, gray, i):
        (x, y), s, n = self.at[i], self.params.search, 2 * self.params.radius + 1
        if self.templates[i] is None:  # seeded before the first frame
            self.templates[i] = self.cut(gray, x, y)
        near = self.cut(gray, x, y, s)
        if near is None or self.templates[i] is None:
            return honami.LOST
        windows = np.lib.stride_tricks.sliding_window_view(near, (n, n))
        j, k = np.unravel_index(((windows - self.templates[i]) ** 2).sum((2, 3)).argmin(), windows.shape[:2])
        self.at[i] = (x + k - s, y + j - s)
        return honami.TRACKED

    def push(self, frame):
        status = [self.look(frame.gray, i) for i in self.at]
        self.gray = frame.gray.copy()
        x, y = zip(*self.at.values()) if self.at else ((), ())
        return honami.Points(list(self.at), x, y, status)

    def save(self):
        return pickle.dumps((self.at, self.templates, self.gray))

    def load(self, data):
        self.at, self.templates, self.gray = pickle.loads(data)


honami.run()

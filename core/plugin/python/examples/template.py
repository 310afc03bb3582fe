"""A tracker that looks for every point's first picture of it, near where it was last."""
import honami
import numpy as np


class Settings(honami.Params):
    radius = honami.Int(7, 2, 30, unit="px", doc="Half the side of the template.")
    search = honami.Int(6, 1, 30, unit="px", doc="How far a point may move from frame to frame.")


@honami.tracker("org.honami.template", "Templates of the first frame", params=Settings,
                doc="Looks for the first picture of every point, near where it was last.")
class Template(honami.PointByPoint):
    def start(self, gray, x, y):
        return honami.window(gray, x, y, self.params.radius)

    def follow(self, gray, x, y, first):
        s = self.params.search
        if first is None:
            return x, y, honami.LOST
        near = honami.window(gray, x, y, self.params.radius + s, outside=-30000)  # nothing looks like what is outside
        windows = np.lib.stride_tricks.sliding_window_view(near, first.shape)
        miss = ((windows - first) ** 2).sum((2, 3)) + 1
        miss[s, s] -= 1  # it stays where all look alike
        j, k = np.unravel_index(miss.argmin(), miss.shape)
        # What misses by half of the template's own contrast is something else: at the border, the point has left.
        if near.min() < 0 and 2 * miss[j, k] > first.size * first.var():
            return x, y, honami.LOST
        return x + int(k) - s, y + int(j) - s, honami.TRACKED


honami.run(license="MIT OR Apache-2.0")

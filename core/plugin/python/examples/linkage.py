"""A clusterer: average linkage of how much the distance between two tracks changes."""
import honami
import numpy as np


class Settings(honami.Params):
    unknown = honami.Float(50, 0, 1000, unit="px", doc="How far apart tracks count that were never seen together.")


@honami.clusterer("org.honami.linkage", "Average linkage", params=Settings,
                  doc="Groups tracks by how much the distance between them changes.")
class Linkage:
    def cluster(self, tracks):
        n = len(tracks.id)
        apart = np.array([self.from_all(tracks, k) for k in range(n)]).reshape(n, n)
        np.fill_diagonal(apart, np.inf)
        number, size, merges = np.arange(len(apart)), np.ones(len(apart)), []
        for r in range(len(apart) - 1):
            honami.progress(0.5 + 0.5 * r / len(apart), "merging")
            i, j = sorted(np.unravel_index(apart.argmin(), apart.shape))
            merges.append((number[i], number[j], apart[i, j]))
            row = (size[i] * apart[i] + size[j] * apart[j]) / (size[i] + size[j])
            apart[i], apart[:, i], apart[j], apart[:, j], apart[i, i] = row, row, np.inf, np.inf, np.inf
            number[i], size[i] = len(apart) + r, size[i] + size[j]
        return honami.Tree(merges)

    def from_all(self, tracks, k):
        """Standard deviation of what lies between track k and each other, over the frames in which both are seen."""
        honami.progress(0.5 * k / len(tracks.id), "comparing tracks")
        between = np.stack([tracks.x - tracks.x[k], tracks.y - tracks.y[k]])
        n = np.isfinite(between[0]).sum(1)
        mean = np.nansum(between, 2) / np.maximum(n, 1)
        sway = np.sqrt(np.nansum((between - mean[:, :, None]) ** 2, (0, 2)) / np.maximum(n, 1))
        return np.where(n > 0, sway, self.params.unknown)


honami.run(license="MIT OR Apache-2.0")

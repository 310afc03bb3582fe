"""A structure builder: a bone from the root to the middle of every group."""
import honami
import numpy as np


class Settings(honami.Params):
    leaves = honami.Bool(True, label="Leaves", doc="Whether every bone carries the tracks of its group.")


@honami.structure("org.honami.fan", "Fan", params=Settings, doc="A bone from the root to the middle of every group.")
class Fan:
    def grow(self, filmed):
        groups = [k for k in range(len(filmed.parent)) if k not in filmed.parent]
        places = np.stack([filmed.x, filmed.y], 2)
        middle = np.array([self.middle(places[filmed.group == k], len(filmed.time_s)) for k in groups])
        below = (middle[..., 0].mean(), middle[..., 1].max())
        root = np.array(below if filmed.root is None else filmed.root)
        apart = (middle - root) * (1, -1)  # right and up
        far = np.linalg.norm(apart, axis=2)
        length = far.mean(1)
        if (length < 1e-6).any():
            raise honami.Error("a group is where the root is")
        way = np.where(far[..., None] > 0, apart / np.maximum(far, 1e-300)[..., None], (0, 1))
        pose = np.zeros((len(filmed.time_s), 1 + len(groups), 3))
        pose[:, 1:, ::2] = way.swapaxes(0, 1)
        parent = [-1] + [0] * len(groups)
        bears = [(1 + k, group) for k, group in enumerate(groups)]
        leaves = [(joint, track) for joint, group in bears for track in np.flatnonzero(filmed.group == group)]
        offsets = np.zeros((len(leaves), len(pose), 3))
        for leaf, (joint, track) in enumerate(leaves):
            end = root + length[joint - 1] * way[joint - 1] * (1, -1)
            at = np.where(np.isfinite(places[track]), places[track], middle[joint - 1])
            offsets[leaf, :, ::2] = (at - end) * (1, -1)
        some = (leaves, offsets) if self.params.leaves and leaves else ()
        return honami.Skeleton((root[0], 0, -root[1]), parent, [0, *length], pose, bears, *some)

    def middle(self, places, n_frames):
        """The mean of tracks; where none is seen as in the frame before, and at first as when one is."""
        honami.progress(0.5, "following groups")
        n = np.isfinite(places[..., 0]).sum(0)
        if not n.any():
            raise honami.Error("a group is never seen")
        mean = np.nansum(places, 0) / np.maximum(n, 1)[:, None]
        last = np.maximum.accumulate(np.where(n > 0, np.arange(n_frames), -1))
        return mean[np.where(last < 0, np.flatnonzero(n)[0], last)]


honami.run(license="MIT OR Apache-2.0")

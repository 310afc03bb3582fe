"""Where Pixar's USD has the vertices of a rig, and where the frames of the same motion have them: python3 usd_skel.py
RIG.usda FRAMES/%04d.ply. Fails where they are more than 1e-4 of the plant's size apart, and on what USD's own validators
complain of."""

import sys

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel, UsdValidation

FARTHEST = 1e-4


def vertices(path: str) -> np.ndarray:
    with open(path, "rb") as file:
        header, _, rows = file.read().partition(b"end_header\n")
    n = int(header.split(b"element vertex ")[1].split()[0])
    width = 15 if b"red" in header else 12
    columns = np.frombuffer(rows, np.uint8, width * n).reshape(n, width)[:, :12]
    return np.ascontiguousarray(columns).view("<f4").astype(float)


def main(rig: str, frames: str) -> None:
    stage = Usd.Stage.Open(rig)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    complaints = UsdValidation.ValidationContext(validators).Validate(stage)
    assert not complaints, [complaint.GetErrorAsString() for complaint in complaints]
    root = UsdSkel.Root(stage.GetDefaultPrim())
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    (binding,) = cache.ComputeSkelBindings(root, Usd.PrimDefaultPredicate)
    skeleton = cache.GetSkelQuery(binding.GetSkeleton())
    (skin,) = binding.GetSkinningTargets()
    rest = UsdGeom.Mesh(skin.GetPrim()).GetPointsAttr().Get()
    size = float(np.ptp(np.array(rest), axis=0).max())
    codes = skeleton.GetAnimQuery().GetJointTransformTimeSamples()
    worst, moved = 0.0, 0.0
    for frame, code in enumerate(codes):
        poses = skeleton.ComputeSkinningTransforms(Usd.TimeCode(code))
        points = type(rest)(rest)
        assert skin.ComputeSkinnedPoints(poses, points, Usd.TimeCode(code))
        worst = max(worst, float(np.abs(np.array(points) - vertices(frames % frame)).max()))
        moved = max(moved, float(np.abs(np.array(points) - np.array(rest)).max()))
    print(f"{len(rest)} vertices, {len(codes)} frames: {worst / size:.1e} of the size apart at most, moved {moved / size:.1e}")
    if worst > FARTHEST * size or moved <= 10 * FARTHEST * size:
        sys.exit(1)


main(*sys.argv[1:])

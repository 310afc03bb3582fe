"""Where pygltflib's reading of a rig has the joints, and where the table of the same skeleton has them: python3
glb_readers.py RIG.glb JOINTS.csv METRES_OF_A_PIXEL MORE, where the rig has so many more keys than the table has frames: 1, of a
loop, which ends as it begins. Fails where they are more than 1e-4 of the plant's size apart, and where
trimesh finds no mesh in it."""

import csv
import sys

import numpy as np
import pygltflib
import trimesh

FARTHEST = 1e-4
KINDS = {5123: np.uint16, 5125: np.uint32, 5126: np.float32}
COUNTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def numbers(gltf: pygltflib.GLTF2, index: int) -> np.ndarray:
    accessor = gltf.accessors[index]
    view = gltf.bufferViews[accessor.bufferView]
    first = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    columns = COUNTS[accessor.type]
    kind = KINDS[accessor.componentType]
    found = np.frombuffer(gltf.binary_blob(), kind, accessor.count * columns, first)
    return found.reshape(accessor.count, columns).astype(float)


def matrix(turn: np.ndarray, by: list[float]) -> np.ndarray:
    x, y, z, w = turn
    made = np.eye(4)
    made[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    made[:3, 3] = by
    return made


def main(rig: str, table: str, unit: str, more: str) -> None:
    metres = float(unit)
    frames: dict[int, dict[int, tuple[int, np.ndarray]]] = {}
    with open(table, newline="") as lines:
        for row in csv.DictReader(lines):
            place = metres * np.array([float(row["x_px"]), -float(row["y_px"]), -float(row["depth_px"])])
            parent = int(row["parent"]) if row["parent"] else -1
            frames.setdefault(int(row["frame"]), {})[int(row["joint"])] = (parent, place)
    gltf = pygltflib.GLTF2().load(rig)
    animation = gltf.animations[0]
    turns = {}
    for channel in animation.channels:
        sampler = animation.samplers[channel.sampler]
        times = numbers(gltf, sampler.input)[:, 0]
        turns[channel.target.node] = numbers(gltf, sampler.output)
    assert len(times) == len(frames) + int(more) and (np.diff(times) > 0).all(), (len(times), len(frames))
    backs = [abs((turn[0] * turn[-1]).sum()) for turn in turns.values()]
    assert more == "0" or min(backs) > 1 - 1e-6, backs
    worst, size = 0.0, 0.0
    for index, frame in enumerate(sorted(frames)):
        rows, found = frames[frame], {}
        open_nodes = [(gltf.skins[0].skeleton, np.eye(4))]
        while open_nodes:
            node, before = open_nodes.pop()
            turn = turns[node][index] if node in turns else np.array([0, 0, 0, 1])
            pose = before @ matrix(turn, gltf.nodes[node].translation)
            found[gltf.nodes[node].name] = pose[:3, 3]
            open_nodes.extend((child, pose) for child in gltf.nodes[node].children or [])
        for name, place in found.items():
            kind, _, number = name.partition("_")
            joint = 0 if kind == "root" else rows[int(number)][0] if kind == "bone" else int(number)
            # The root of the rig is in the origin.
            wanted = rows[joint][1] - rows[0][1]
            worst = max(worst, np.linalg.norm(place - found["root"] - wanted))
            size = max(size, np.linalg.norm(wanted))
    meshes = trimesh.load(rig, force="scene").geometry.values()
    n_faces = sum(len(mesh.faces) for mesh in meshes)
    print(f"{len(found)} joints, {len(frames)} frames, {n_faces} faces: {worst / size:.1e} of the size apart at most")
    if worst > FARTHEST * size or n_faces == 0:
        sys.exit(1)


main(*sys.argv[1:])

# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP models on disk: which images they hold, and where the cameras stand."""
import struct
from pathlib import Path


def _read_binary(file):
    """(name, quaternion, translation) of cam_from_world, one an image."""
    data = file.read_bytes()
    (count,) = struct.unpack_from("<Q", data, 0)
    images, at = [], 8
    for _ in range(count):
        values = struct.unpack_from("<I7d", data, at)
        at += 4 + 7 * 8 + 4  # id, pose, camera
        end = data.index(b"\0", at)
        name = data[at:end].decode(errors="surrogateescape")
        images.append((name, values[1:5], values[5:8]))
        (points,) = struct.unpack_from("<Q", data, end + 1)
        at = end + 9 + points * 24
    return images


def _read_text(file):
    lines = [line for line in file.read_text(errors="surrogateescape").split("\n") if not line.startswith("#")]
    images = []
    for line in lines[::2]:  # every second one lists points
        words = line.split(maxsplit=9)
        if len(words) == 10:
            pose = [float(word) for word in words[1:8]]
            images.append((words[9], pose[:4], pose[4:]))
    return images


def _centre(quaternion, translation):
    """-R^T t of the unit quaternion w, x, y, z."""
    w, x, y, z = quaternion
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return tuple(-sum(rows[i][axis] * translation[i] for i in range(3)) for axis in range(3))


def _images(model):
    binary = Path(model) / "images.bin"
    return _read_binary(binary) if binary.exists() else _read_text(Path(model) / "images.txt")


def registered_names(model):
    return [name for name, _, _ in _images(model)]


def centres_of(model):
    """{name: camera centre}"""
    return {name: _centre(quaternion, translation) for name, quaternion, translation in _images(model)}


def models_in(folder):
    """Model folders below, largest first: the folder itself for a continued model, else 0, 1, …"""
    folders = [folder] if (folder / "images.bin").exists() else [
        part for part in folder.iterdir() if (part / "images.bin").exists()]
    return sorted(folders, key=lambda part: (-len(registered_names(part)), part.name))

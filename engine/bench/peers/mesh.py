# SPDX-License-Identifier: MIT
"""Corners of a mesh file and its convex hull: peers take convex bodies."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull, QhullError

FloatArray = npt.NDArray[np.float64]
HULL_TOLERANCE = 1e-3  # -, volume a hull may have beyond its mesh and still be the same body


@dataclass(frozen=True)
class Hull:
    """Convex body in mesh units."""

    vertices: FloatArray  # [V, 3]
    triangles: npt.NDArray[np.int64]  # [T, 3], seen anticlockwise from outside


def hull_of_mesh(file: Path, volume: float) -> Hull | None:
    """The hull of an OBJ file's corners, if the mesh of that volume (mesh units) is convex; else
    None, as for files of other kinds."""
    if file.suffix.lower() != ".obj":
        return None
    rows = [line.split()[1:4] for line in file.read_text("utf-8").splitlines() if line[:2] == "v "]
    try:
        hull = ConvexHull(np.array(rows, float))
    except (QhullError, ValueError):
        return None
    if hull.volume > volume * (1 + HULL_TOLERANCE):
        return None
    renumbered = np.full(len(rows), -1)
    renumbered[hull.vertices] = np.arange(len(hull.vertices))
    points = hull.points[hull.vertices]
    triangles = renumbered[hull.simplices]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, [0, 2, 1]]
    return Hull(points, triangles)

# SPDX-License-Identifier: MIT
"""Makes the meshes that ship with Verisim: fox.obj, torus.obj and knot.obj (closed, z up, metres).

Run `python3 make_meshes.py` in this folder to write them again; only NumPy is needed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]
Field = Callable[[Array], Array]  # points [n, 3] -> signed distance-like value [n], < 0 inside


def round_cone(points: Array, start: list[float], end: list[float], r0: float, r1: float) -> Array:
    """Distance to a capsule whose radius runs linearly from r0 to r1 (close to exact)."""
    a, axis = np.array(start), np.array(end) - np.array(start)
    share = np.clip((points - a) @ axis / (axis @ axis), 0, 1)
    distance = np.linalg.norm(points - a - share[:, None] * axis, axis=1)
    value: Array = distance - (r0 + (r1 - r0) * share)
    return value


def ellipsoid(points: Array, center: list[float], radii: list[float]) -> Array:
    """Value near the distance to an axis-aligned ellipsoid, exact on its surface."""
    scaled = (points - np.array(center)) / np.array(radii)
    length = np.linalg.norm(scaled, axis=1)
    slope = np.linalg.norm(scaled / np.array(radii), axis=1)
    value: Array = length * (length - 1) / np.maximum(slope, 1e-9)
    return value


def smooth_union(a: Array, b: Array, width: float) -> Array:
    """Minimum of two fields, rounded where they differ by less than `width` (m)."""
    overlap = np.maximum(width - np.abs(a - b), 0) / width
    value: Array = np.minimum(a, b) - overlap * overlap * width / 4
    return value


def fox_field(points: Array) -> Array:
    """A standing fox, nose along +x, left along +y, feet on z = 0, about 1 m long."""
    p = points.copy()
    p[:, 1] = np.abs(p[:, 1])  # left and right alike
    parts: list[tuple[Array, float]] = [
        # chest to rump, slimmer at the waist
        (round_cone(p, [-0.17, 0, 0.375], [0.02, 0, 0.365], 0.105, 0.098), 0.05),
        (round_cone(p, [0.02, 0, 0.365], [0.17, 0, 0.385], 0.098, 0.118), 0.05),
        # neck with a ruff, head with wide cheeks, long pointed snout
        (round_cone(p, [0.2, 0, 0.43], [0.285, 0, 0.55], 0.095, 0.082), 0.06),
        (ellipsoid(p, [0.31, 0, 0.61], [0.105, 0.11, 0.09]), 0.04),
        (round_cone(p, [0.3, 0.05, 0.585], [0.268, 0.162, 0.545], 0.068, 0.028), 0.04),
        (round_cone(p, [0.36, 0, 0.59], [0.5, 0, 0.555], 0.062, 0.024), 0.05),
        (round_cone(p, [0.505, 0, 0.566], [0.512, 0, 0.566], 0.024, 0.02), 0.012),
        # pointed ears
        (round_cone(p, [0.282, 0.07, 0.645], [0.258, 0.112, 0.83], 0.068, 0.014), 0.02),
        # front leg and paw
        (round_cone(p, [0.19, 0.08, 0.33], [0.2, 0.09, 0.03], 0.064, 0.048), 0.04),
        (ellipsoid(p, [0.222, 0.09, 0.018], [0.078, 0.054, 0.047]), 0.03),
        # hind leg: thigh, shin back to the hock, foot forward
        (round_cone(p, [-0.165, 0.076, 0.34], [-0.145, 0.086, 0.245], 0.09, 0.068), 0.05),
        (round_cone(p, [-0.145, 0.088, 0.245], [-0.235, 0.09, 0.145], 0.066, 0.049), 0.03),
        (round_cone(p, [-0.235, 0.09, 0.145], [-0.225, 0.09, 0.03], 0.049, 0.046), 0.03),
        (ellipsoid(p, [-0.198, 0.09, 0.018], [0.082, 0.054, 0.047]), 0.03),
        # bushy tail: thin root, thick brush, pointed tip
        (round_cone(p, [-0.24, 0, 0.41], [-0.315, 0, 0.36], 0.05, 0.074), 0.04),
        (round_cone(p, [-0.315, 0, 0.36], [-0.42, 0, 0.3], 0.074, 0.1), 0.04),
        (round_cone(p, [-0.42, 0, 0.3], [-0.555, 0, 0.34], 0.1, 0.02), 0.04),
    ]
    value, _ = parts[0]
    for part, width in parts[1:]:
        value = smooth_union(value, part, width)
    return np.maximum(value, -points[:, 2])  # flat feet


def gradient(field: Field, points: Array) -> Array:
    step = 1e-5
    sides = [field(points + d) - field(points - d) for d in step * np.eye(3)]
    slope: Array = np.stack(sides, axis=1) / (2 * step)
    return slope


def surface_nets(field: Field, axes: list[Array]) -> tuple[Array, Triangles]:
    """Closed triangle mesh of field = 0: one vertex per cell that the surface passes through.

    axes: the grid's x, y and z coordinates, rising, not necessarily even; the surface stays inside.
    The dual of a grid (Gibson 1998): each grid edge that the surface crosses becomes one
    quadrilateral between the four cells around it.
    """
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    value = field(corners.reshape(-1, 3)).reshape(corners.shape[:3])

    # Mean of the crossing points on the twelve edges of each cell.
    cells = [len(axis) - 1 for axis in axes]
    total, number = np.zeros((*cells, 3)), np.zeros(cells)
    quads: list[NDArray[np.int64]] = []
    inside = value < 0
    for axis in range(3):
        lower = [slice(None)] * 3
        upper = [slice(None)] * 3
        lower[axis], upper[axis] = slice(None, -1), slice(1, None)
        v0, v1 = value[tuple(lower)], value[tuple(upper)]
        index = np.argwhere(inside[tuple(lower)] != inside[tuple(upper)])
        share = v0[tuple(index.T)] / (v0[tuple(index.T)] - v1[tuple(index.T)])
        place = corners[tuple(index.T)].copy()
        place[:, axis] += share * np.diff(axes[axis])[index[:, axis]]
        b, c = (axis + 1) % 3, (axis + 2) % 3
        around = []
        for db, dc in ((-1, -1), (0, -1), (0, 0), (-1, 0)):  # counter-clockwise seen from +axis
            neighbor = index.copy()
            neighbor[:, b] += db
            neighbor[:, c] += dc
            np.add.at(total, tuple(neighbor.T), place)
            np.add.at(number, tuple(neighbor.T), 1)
            around.append(np.ravel_multi_index(tuple(neighbor.T), tuple(cells)))
        quad = np.stack(around, axis=1)
        leaves = inside[tuple(lower)][tuple(index.T)]  # the normal then points along +axis
        quads.append(np.where(leaves[:, None], quad, quad[:, ::-1]))
    quad = np.concatenate(quads)
    used, flat = np.unique(quad, return_inverse=True)
    vertices = total.reshape(-1, 3)[used] / number.reshape(-1)[used, None]
    return vertices, split_quads(vertices, flat.reshape(quad.shape))


def split_quads(vertices: Array, quad: Triangles) -> Triangles:
    """Two triangles per quadrilateral, along the shorter diagonal."""
    diagonals = [vertices[quad[:, i]] - vertices[quad[:, i + 2]] for i in (0, 1)]
    first = np.linalg.norm(diagonals[0], axis=1) <= np.linalg.norm(diagonals[1], axis=1)
    along_02 = quad[:, [0, 1, 2, 0, 2, 3]]
    along_13 = quad[:, [1, 2, 3, 1, 3, 0]]
    triangles: Triangles = np.where(first[:, None], along_02, along_13).reshape(-1, 3)
    return triangles


def settle_on_surface(field: Field, vertices: Array, triangles: Triangles, rounds: int) -> Array:
    """Evens the triangles out, then brings every vertex back onto field = 0, `rounds` times."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    for _ in range(rounds):
        total, number = np.zeros_like(vertices), np.zeros(len(vertices))
        np.add.at(total, edges[:, 0], vertices[edges[:, 1]])
        np.add.at(number, edges[:, 0], 1)
        vertices = 0.7 * vertices + 0.3 * total / number[:, None]
        for _ in range(3):
            slope = gradient(field, vertices)
            squared = np.maximum((slope * slope).sum(axis=1), 0.1)
            vertices = vertices - (field(vertices) / squared)[:, None] * slope
    return vertices


def make_fox() -> tuple[Array, Triangles]:
    body = 0.033  # cell of the body; head and ears, above z = 0.5, get flatter cells
    axes = [
        -0.6513 + body * np.arange(38),
        body * (np.arange(16) - 7.5),  # the mirror plane y = 0 runs through the middle of cells
        np.concatenate([-0.0611 + body * np.arange(17), 0.49 + 0.021 * np.arange(19)]),
    ]
    vertices, triangles = surface_nets(fox_field, axes)
    return settle_on_surface(fox_field, vertices, triangles, 3), triangles


def grid_triangles(num_u: int, num_v: int) -> Triangles:
    """Triangles of a closed num_u x num_v grid of vertices that wraps round in both directions."""
    u, v = np.meshgrid(np.arange(num_u), np.arange(num_v), indexing="ij")
    u1, v1 = (u + 1) % num_u, (v + 1) % num_v
    a, b, c, d = u * num_v + v, u1 * num_v + v, u1 * num_v + v1, u * num_v + v1
    triangles: Triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return triangles


def tube(curve: Array, radius: float, num_around: int) -> tuple[Array, Triangles]:
    """Tube of constant radius about a closed curve [n, 3] that is nowhere straight."""
    tangent = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    bend = np.roll(curve, -1, axis=0) - 2 * curve + np.roll(curve, 1, axis=0)
    normal = bend - (bend * tangent).sum(axis=1, keepdims=True) * tangent
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    binormal = np.cross(tangent, normal)
    angle = 2 * np.pi * np.arange(num_around) / num_around
    ring = np.cos(angle)[:, None] * normal[:, None] + np.sin(angle)[:, None] * binormal[:, None]
    vertices: Array = (curve[:, None] + radius * ring).reshape(-1, 3)
    return vertices, grid_triangles(len(curve), num_around)[:, ::-1]


def make_torus() -> tuple[Array, Triangles]:
    """Ring radius 0.35 m, tube radius 0.15 m, lying flat."""
    t = 2 * np.pi * np.arange(48) / 48
    return tube(0.35 * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1), 0.15, 24)


def make_knot() -> tuple[Array, Triangles]:
    """Trefoil knot, about 0.9 m across."""
    t = 2 * np.pi * np.arange(120) / 120
    x, y = np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)
    return tube(0.13 * np.stack([x, y, -1.2 * np.sin(3 * t)], axis=1), 0.075, 16)


def require_closed(name: str, vertices: Array, triangles: Triangles) -> float:
    """Volume, m^3. Raises ValueError unless it is > 0 and edges have two opposite half-edges."""
    half_edges = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3))
    broken = [e for e, n in half_edges.items() if n != 1 or half_edges.get((e[1], e[0])) != 1]
    if broken:
        raise ValueError(f"{name}: {len(broken)} edges not shared by two, first {broken[0]}")
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    volume = float((a * np.cross(b, c)).sum() / 6)
    if volume <= 0:
        raise ValueError(f"{name}: volume {volume} m^3 is not positive")
    return volume


def write_obj(path: Path, vertices: Array, triangles: Triangles) -> None:
    lines = ["# SPDX-License-Identifier: MIT", f"# Made by {Path(__file__).name}. Metres, z up."]
    lines += [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices + 0.0]
    lines += [f"f {a} {b} {c}" for a, b, c in triangles + 1]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    folder = Path(__file__).resolve().parent
    for name, make in (("fox", make_fox), ("torus", make_torus), ("knot", make_knot)):
        vertices, triangles = make()
        volume = require_closed(name, vertices, triangles)
        write_obj(folder / f"{name}.obj", vertices, triangles)
        print(
            f"{name}.obj: {len(triangles)} triangles, {volume:.5f} m^3, "
            f"{vertices.min(axis=0).round(3)} to {vertices.max(axis=0).round(3)} m"
        )


if __name__ == "__main__":
    main()

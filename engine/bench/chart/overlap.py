# SPDX-License-Identifier: MIT
"""How deep bodies lie in each other, by poses alone: the same tests for every engine.

Boxes: the separating-axis test over 15 axes. Spheres: exact. Convex meshes: points on the edges of
each against the faces of the other, so that a crossing of two edges is seen at the nearest point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
POINTS_PER_EDGE = 9  # of a mesh


def overlaps(position: Array, orientation_wxyz: Array, half: Array) -> Array:
    """Depths (m) of all pairs of boxes that overlap, and of boxes in the floor z = 0.

    half: half edges (m), [3] of all or [N, 3] of each.
    """
    axes = _axes(orientation_wxyz)
    halves = np.broadcast_to(half, position.shape)
    pairs = near_pairs(position, np.linalg.norm(halves, axis=1))
    between = box_depths(position, axes, halves, pairs)
    in_floor = _box_reach(axes, halves, np.array([0.0, 0, 1])) - position[:, 2]
    found: Array = np.concatenate([between[between > 0], in_floor[in_floor > 0]])
    return found


def near_pairs(position: Array, radius: Array) -> Indices:
    """Pairs of bodies whose bounding spheres overlap, [P, 2]; a few may be huge (walls)."""
    typical = float(np.median(radius))
    is_big = radius > 4 * typical
    small, big = np.flatnonzero(~is_big), np.flatnonzero(is_big)
    tree = cKDTree(position[small])
    pairs = small[tree.query_pairs(2 * float(radius[small].max(initial=0)), output_type="ndarray")]
    with_big = np.array([(i, j) for j in big for i in small], dtype=np.intp).reshape(-1, 2)
    pairs = np.concatenate([pairs.reshape(-1, 2), with_big])
    apart = np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
    kept: Indices = pairs[apart < radius[pairs].sum(axis=1)]
    return kept


def box_depths(position: Array, axes: Array, halves: Array, pairs: Indices) -> Array:
    """Depth (m) of each pair of boxes; negative: apart."""
    a, b = axes[pairs[:, 0]], axes[pairs[:, 1]]  # columns: the boxes' own axes
    apart = position[pairs[:, 1]] - position[pairs[:, 0]]
    crossed = np.cross(a[:, :, :, None], b[:, :, None, :], axis=1).reshape(-1, 3, 9)
    length = np.linalg.norm(crossed, axis=1, keepdims=True)
    is_parallel = length[:, 0] < 1e-6
    crossed = crossed / np.where(length < 1e-6, 1, length)
    directions = np.concatenate([a, b, crossed], axis=2)  # [P, 3, 15]
    reach = _reach(a, directions, halves[pairs[:, 0]]) + _reach(b, directions, halves[pairs[:, 1]])
    depth = reach - np.abs(np.einsum("pi,pik->pk", apart, directions))
    depth[:, 6:][is_parallel] = np.inf
    least: Array = depth.min(axis=1, initial=np.inf)
    return least


def _axes(orientation_wxyz: Array) -> Array:
    return Rotation.from_quat(orientation_wxyz[:, [1, 2, 3, 0]]).as_matrix()


def _reach(axes: Array, directions: Array, halves: Array) -> Array:
    along = np.abs(np.einsum("pij,pik->pkj", axes, directions))
    reach: Array = np.einsum("pkj,pj->pk", along, halves)
    return reach


def _box_reach(axes: Array, halves: Array, normal: Array) -> Array:
    reach: Array = (np.abs(np.einsum("pij,i->pj", axes, normal)) * halves).sum(axis=1)
    return reach


@dataclass(frozen=True)
class Hull:
    """A convex mesh about its centre of mass."""

    points: Array  # [K, 3], on its edges
    normals: Array  # [F, 3], outward
    offsets: Array  # [F]: inside where normal . x < offset


def hull_of(vertices: Array) -> Hull:
    """Of the vertices about the centre of mass (m)."""
    hull = ConvexHull(vertices)
    edges = {
        tuple(sorted((int(simplex[i]), int(simplex[(i + 1) % 3]))))
        for simplex in hull.simplices
        for i in range(3)
    }
    share = np.linspace(0, 1, POINTS_PER_EDGE)[:, None]
    points = np.concatenate(
        [vertices[a] * (1 - share) + vertices[b] * share for a, b in sorted(edges)]
    )
    return Hull(np.unique(points.round(12), axis=0), hull.equations[:, :3], -hull.equations[:, 3])


def hull_depths(
    position: Array, axes: Array, hulls: Sequence[Hull | None], pairs: Indices
) -> Array:
    """Depth (m) of each pair of convex meshes: the deepest sampled point of one in the other."""
    depths = np.empty(len(pairs))
    for n, (a, b) in enumerate(pairs):
        depths[n] = max(
            _deepest(position, axes, hulls, a, b), _deepest(position, axes, hulls, b, a)
        )
    return depths


def _deepest(position: Array, axes: Array, hulls: Sequence[Hull | None], a: int, b: int) -> float:
    """Of the points of a in b; negative: all outside."""
    own, other = hulls[a], hulls[b]
    assert own is not None and other is not None
    world = own.points @ axes[a].T + position[a]
    local = (world - position[b]) @ axes[b]
    inside = (other.offsets[None] - local @ other.normals.T).min(axis=1)
    return float(inside.max())


@dataclass(frozen=True)
class Solids:
    """The bodies of a scene, as overlap tests need them; all boxes, all spheres, or all meshes
    among the free ones, and boxes alone among the fixed ones."""

    kind: str  # box | sphere | mesh
    is_free: npt.NDArray[np.bool_]  # [B]
    halves: Array  # [B, 3], half edges of boxes (m); 0 of others
    radii: Array  # [B], bounding (of spheres: their own)
    hulls: tuple[Hull | None, ...]
    plane: tuple[Array, float] | None  # normal, offset (m)

    def depths(self, position: Array, orientation_wxyz: Array) -> Array:
        """Depths (m, > 0) of every overlap with a free body in it, the ground's included."""
        axes = _axes(orientation_wxyz)
        pairs = near_pairs(position, self.radii)
        pairs = pairs[self.is_free[pairs].any(axis=1)]
        both = self.is_free[pairs].all(axis=1)
        found = [
            self._between(position, axes, pairs[both]),
            self._walls(position, axes, pairs[~both]),
        ]
        if self.plane is not None:
            normal, offset = self.plane
            free = np.flatnonzero(self.is_free)
            found.append(self._below(axes, normal)[free] - (position[free] @ normal - offset))
        depth = np.concatenate(found)
        positive: Array = depth[depth > 0]
        return positive

    def _between(self, position: Array, axes: Array, pairs: Indices) -> Array:
        if self.kind == "box":
            return box_depths(position, axes, self.halves, pairs)
        if self.kind == "sphere":
            apart = np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
            depth: Array = self.radii[pairs].sum(axis=1) - apart
            return depth
        return hull_depths(position, axes, self.hulls, pairs)

    def _walls(self, position: Array, axes: Array, pairs: Indices) -> Array:
        """Of free bodies in fixed boxes."""
        if self.kind == "box":
            return box_depths(position, axes, self.halves, pairs)
        depths = np.empty(len(pairs))
        for n, (a, b) in enumerate(pairs):
            free, wall = (a, b) if self.is_free[a] else (b, a)
            apart = position[free] - position[wall]
            along = apart @ axes[wall]
            gaps = np.abs(along) - self.halves[wall]
            side = int(gaps.argmax())  # the face that is nearest: walls are large
            normal = axes[wall][:, side] * np.sign(along[side])
            depths[n] = self._below(axes, normal)[free] - gaps[side]
        return depths

    def _below(self, axes: Array, normal: Array) -> Array:
        """How far (m) each body reaches against `normal` from its centre."""
        if self.kind == "box":
            return _box_reach(axes, self.halves, normal)
        if self.kind == "sphere":
            return self.radii
        return np.array(
            [
                0.0 if hull is None else float((-(hull.points @ axis.T) @ normal).max())
                for hull, axis in zip(self.hulls, axes, strict=True)
            ]
        )


def solids_of(scene: dict[str, Any], folder: Path) -> Solids:
    """Of a scene as read; meshes are files relative to `folder`."""
    bodies = scene["bodies"]
    free = np.array([body.get("motion", "free") == "free" for body in bodies])
    kinds = {_kind(body["shape"]) for body, is_free in zip(bodies, free, strict=True) if is_free}
    assert len(kinds) == 1, "overlap tests take free bodies of one kind"
    halves, radii, hulls = np.zeros((len(bodies), 3)), np.zeros(len(bodies)), []
    for n, body in enumerate(bodies):
        shape, hull = body["shape"], None
        if "box_m" in shape:
            halves[n] = np.array(shape["box_m"], dtype=float) / 2
            radii[n] = np.linalg.norm(halves[n])
        elif "sphere_radius_m" in shape:
            radii[n] = shape["sphere_radius_m"]
        else:
            hull = _mesh_hull(folder / shape["mesh"], float(shape.get("scale", 1)))
            radii[n] = np.linalg.norm(hull.points, axis=1).max()
        hulls.append(hull)
    plane = None
    if "ground" in scene:
        ground = scene["ground"]["plane"]
        normal = np.array(ground.get("normal", (0, 0, 1)), dtype=float)
        plane = (normal / np.linalg.norm(normal), float(ground.get("offset_m", 0)))
    return Solids(kinds.pop(), free, halves, radii, tuple(hulls), plane)


def _kind(shape: dict[str, Any]) -> str:
    return "box" if "box_m" in shape else "sphere" if "sphere_radius_m" in shape else "mesh"


def _mesh_hull(file: Path, scale: float) -> Hull:
    from verisim.engine import inspect_shape

    lines = file.read_text("utf-8").splitlines()
    vertices = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], dtype=float)
    centre = np.array(inspect_shape(file)["center_of_mass_m"])
    return hull_of((vertices - centre) * scale)

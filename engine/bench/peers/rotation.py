# SPDX-License-Identifier: MIT
"""Quaternions (w first, body to world) and principal axes, as the peers' scenes need them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def quaternion_product(a: FloatArray, b: FloatArray) -> FloatArray:
    """a after b; [..., 4]."""
    aw, ax, ay, az = np.moveaxis(np.asarray(a, float), -1, 0)
    bw, bx, by, bz = np.moveaxis(np.asarray(b, float), -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def turned(quaternion: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors [N, 3] turned by one unit quaternion."""
    w, axis = quaternion[0], quaternion[1:]
    twice = 2 * np.cross(axis, vectors)
    result: FloatArray = vectors + w * twice + np.cross(axis, twice)
    return result


def principal_axes(tensor: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Principal moments [3], rising, and the unit quaternion that turns the tensor's frame into
    the principal one. tensor: symmetric 3 x 3."""
    moments, columns = np.linalg.eigh(tensor)
    if np.linalg.det(columns) < 0:
        columns[:, 0] = -columns[:, 0]
    # Columns are the principal axes seen in the tensor's frame; the transpose turns into them.
    return moments, _quaternion_of(columns.T)


def _quaternion_of(matrix: FloatArray) -> FloatArray:
    """Unit quaternion of a rotation matrix: the eigenvector of Bar-Itzhack's symmetric matrix
    (Bar-Itzhack 2000, version 3) of the greatest eigenvalue."""
    m = matrix
    k = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2]],
            [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2]],
            [m[1, 0] - m[0, 1], m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    quaternion: FloatArray = np.linalg.eigh(k)[1][:, -1]
    return quaternion if quaternion[0] >= 0 else -quaternion

# SPDX-License-Identifier: MIT
"""The pose log and its file: where every body was at each sampled time."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


class PoseLogError(ValueError):
    """A pose log file that cannot be used; the message names file, array and hint."""


def _slopes(time_s: FloatArray, position_m: FloatArray) -> FloatArray:
    """Velocities by second-order differences; zero for a single time."""
    if time_s.size < 2:
        return np.zeros_like(position_m)
    slopes: FloatArray = np.gradient(position_m, time_s, axis=0)
    return slopes


@dataclass
class PoseLog:
    """Poses of B bodies at T times. World frame, centre of mass, SI units."""

    names: list[str]  # [B], file order
    time_s: FloatArray  # [T]
    position_m: FloatArray  # [T, B, 3]
    orientation_wxyz: FloatArray  # [T, B, 4], body to world
    linear_velocity_m_s: FloatArray  # [T, B, 3]
    angular_velocity_rad_s: FloatArray  # [T, B, 3]

    def save(self, file: Path, more: Mapping[str, npt.NDArray[Any]] | None = None) -> None:
        """Writes FILE.npz (no pickles, the same bytes for the same poses), by rename; with `more`
        arrays beside those of a pose log."""
        arrays: dict[str, Any] = {
            "names": np.array(self.names, dtype=np.str_),
            "time_s": self.time_s,
            "position_m": self.position_m,
            "orientation_wxyz": self.orientation_wxyz,
            "linear_velocity_m_s": self.linear_velocity_m_s,
            "angular_velocity_rad_s": self.angular_velocity_rad_s,
            **(more or {}),
        }
        temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
        try:
            with temporary.open("wb") as stream:
                np.savez(stream, **arrays)
            temporary.replace(file)
        finally:
            temporary.unlink(missing_ok=True)

    @classmethod
    def load(cls, file: Path) -> PoseLog:
        """Reads FILE.npz. Linear velocities that are absent follow from the
        positions; angular ones are zero then. Raises PoseLogError."""
        try:
            with np.load(file, allow_pickle=False) as arrays:
                data = dict(arrays.items())
        except (OSError, ValueError, zipfile.BadZipFile) as error:
            raise PoseLogError(
                f"{file}: not a pose log that can be read ({error})\n"
                "  hint: a pose log is an .npz written by `verisim simulate SCENE --poses FILE.npz`"
            ) from error
        for key in ("names", "time_s", "position_m", "orientation_wxyz"):
            if key not in data:
                raise PoseLogError(
                    f"{file}: array {key} is missing; found: {', '.join(sorted(data)) or 'none'}"
                )
        names = [str(name) for name in data["names"]]
        time_s = np.ascontiguousarray(data["time_s"], dtype=np.float64)
        num_times, num_bodies = time_s.size, len(names)

        def array(key: str, width: int) -> FloatArray:
            shape = (num_times, num_bodies, width)
            if key not in data and key == "linear_velocity_m_s":
                return _slopes(time_s, data["position_m"])
            if key not in data and key == "angular_velocity_rad_s":
                return np.zeros(shape)
            values = np.ascontiguousarray(data[key], dtype=np.float64)
            if values.shape != shape:
                raise PoseLogError(
                    f"{file}: {key} has shape {values.shape}; allowed: {shape} "
                    "(times, bodies, components)"
                )
            if not np.isfinite(values).all():
                raise PoseLogError(f"{file}: {key} holds numbers that are not finite")
            return values

        if num_times == 0 or time_s.ndim != 1 or not (np.diff(time_s) > 0).all():
            raise PoseLogError(f"{file}: time_s must be a list of rising times")
        return cls(
            names=names,
            time_s=time_s,
            position_m=array("position_m", 3),
            orientation_wxyz=array("orientation_wxyz", 4),
            linear_velocity_m_s=array("linear_velocity_m_s", 3),
            angular_velocity_rad_s=array("angular_velocity_rad_s", 3),
        )

# SPDX-License-Identifier: MIT
"""LAMMPS as a program of its own (it is GPL: never linked or imported): spheres with linear springs
and friction history, one by one or bound into rigid bodies."""

from __future__ import annotations

import math
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from verisim.bench.peers.rotation import quaternion_product, turned
from verisim.bench.peers.scene import PeerBody, PeerScene

FloatArray = npt.NDArray[np.float64]
PROGRAM = "lmp"
STEPS_PER_CONTACT = {"default": 40, "20": 20}
LEAST_RESTITUTION = 0.05  # a linear dashpot that returns nothing would never let go
SKIN_PER_RADIUS = 0.2  # of neighbour lists
LEAST_TIMED_S = 0.05
FIELDS = "x y z vx vy vz omegax omegay omegaz"
RIGID_FIELDS = "x y z quatw quati quatj quatk vx vy vz omegax omegay omegaz"


def cannot_pose(scene: PeerScene) -> str | None:
    """What of this scene LAMMPS cannot take: it has spheres, level planes and walls of boxes."""
    free = [body for body in scene.bodies if body.motion == "free"]
    kinds = {body.shape.kind for body in free}
    if not (kinds == {"sphere"} or kinds == {"spheres"}):
        return "spheres alone or bodies of spheres alone"
    for body in scene.bodies:
        if body.motion == "fixed" and (body.shape.kind != "box" or not _is_upright(body)):
            return "fixed bodies: upright boxes alone"
    if any(max(abs(value) for value in plane.normal) != 1 for plane in scene.planes):
        return "planes across an axis alone"
    if scene.one_pair_value() is None:
        return "one restitution and one friction"
    return None


def run(
    scene: PeerScene, job: dict[str, Any], folder: Path, limit_s: float
) -> tuple[FloatArray | None, dict[str, Any]]:
    """States [frames, bodies, 13] and the result as the other drivers give it."""
    free = [i for i, body in enumerate(scene.bodies) if body.motion == "free"]
    is_rigid = scene.bodies[free[0]].shape.kind == "spheres"
    (folder / "spheres.data").write_text(_data([scene.bodies[i] for i in free], is_rigid), "utf-8")
    if is_rigid:
        (folder / "bodies.txt").write_text(_rigid_bodies([scene.bodies[i] for i in free]), "utf-8")
    (folder / "in.lmp").write_text(_script(scene, job, is_rigid), "utf-8")
    command = [PROGRAM, "-in", "in.lmp", "-log", "log.lammps", "-screen", "none", "-nocite"]
    try:
        done = subprocess.run(
            command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=limit_s
        )
    except subprocess.TimeoutExpired:
        return None, {"failed": f"did not return within {limit_s:.0f} s"}
    log_file = folder / "log.lammps"
    log = log_file.read_text("utf-8", "replace") if log_file.exists() else ""
    result: dict[str, Any] = {"version": _first(r"LAMMPS \(([^)]*)\)", log) or "", "failed": None}
    said = _first(r"ERROR[^:\n]*: ([^\n]*)", log)
    if done.returncode != 0 or said:
        return None, {**result, "failed": said or f"lmp ended with status {done.returncode}"}
    rows = _dumped(folder / "poses.dump")
    states = _states(scene, free, rows, is_rigid)
    frames = len(states) - 1
    timed = max(0, frames - job["warm_up_frames"])
    result["simulated_s"] = timed / scene.frame_rate_hz
    result["cpu_s"] = _cpu_s(log) if timed else 0.0
    if frames < job["num_frames"]:
        result["failed"] = f"time limit of {job['time_limit_s']} s at {rows.shape[0] - 1} frames"
    if not np.isfinite(states).all():
        good = np.isfinite(states).all(axis=(1, 2))
        states = states[: int(np.argmin(good))]
        result["failed"] = "numbers that are not finite"
    return states, result


def _is_upright(body: PeerBody) -> bool:
    return abs(body.orientation_wxyz[0]) == 1


def _extent(body: PeerBody) -> float:
    """Radius about the centre of mass, m."""
    arms = np.linalg.norm(np.asarray(body.shape.centres), axis=1)
    return float(arms.max()) + body.shape.radius


def _first(pattern: str, text: str) -> str | None:
    found = re.search(pattern, text)
    return found[1].strip() if found else None


def _cpu_s(log: str) -> float:
    """Of the last run: loop time less the dump's, by the share of the processor it had where the
    loop is long enough for LAMMPS to know it."""
    loop = float(re.findall(r"Loop time of (\S+)", log)[-1])
    share = float(re.findall(r"(\S+)% CPU use", log)[-1]) / 100
    output = re.findall(r"Output\s*\|\s*(\S+)", log)
    stepping = max(loop - float(output[-1]), 0.1 * loop) if output else loop
    return stepping * (share if loop > LEAST_TIMED_S else 1)


def _contact(scene: PeerScene, config: str, dt: float, mass: float) -> str:
    """kn kt gamma_n gamma_t friction dampflag: a linear spring and dashpot whose contact of
    effective mass `mass` lasts the configuration's number of steps and returns the restitution."""
    restitution, friction = scene.one_pair_value() or (0.0, 0.0)
    duration = STEPS_PER_CONTACT[config] * dt
    gamma = -2 * math.log(max(restitution, LEAST_RESTITUTION)) / duration
    stiffness = mass * ((math.pi / duration) ** 2 + gamma**2 / 4)
    return f"{stiffness!r} {2 / 7 * stiffness!r} {gamma!r} {gamma / 2!r} {friction!r} 1"


def _script(scene: PeerScene, job: dict[str, Any], is_rigid: bool) -> str:
    free = [body for body in scene.bodies if body.motion == "free"]
    mass = min(body.mass for body in free)
    radius = min(body.shape.radius for body in free)
    dt, per_frame = job["dt_s"], job["steps_per_frame"]
    pair = _contact(scene, job["config"], dt, mass / 2)
    wall = _contact(scene, job["config"], dt, mass)
    lines = ["units si", "atom_style sphere", "boundary m m m", "newton off", "comm_modify vel yes"]
    if is_rigid:
        lines += ["atom_modify map array"]
        lines += ["fix mol all property/atom mol ghost yes"]
        lines += ["read_data spheres.data fix mol NULL Molecules"]
        lines += ["neigh_modify exclude molecule/intra all"]
        lines += [f"comm_modify cutoff {4 * max(map(_extent, free))!r}"]
    else:
        lines += ["read_data spheres.data"]
    lines += [
        f"neighbor {SKIN_PER_RADIUS * radius!r} bin",
        "neigh_modify delay 0 every 1 check yes page 1000000 one 10000",
        f"pair_style gran/hooke/history {pair}",
        "pair_coeff * *",
        f"timestep {dt!r}",
    ]
    strength = math.sqrt(sum(value**2 for value in scene.gravity))
    if strength > 0:
        down = " ".join(repr(value / strength) for value in scene.gravity)
        lines.append(f"fix fall all gravity {strength!r} vector {down}")
    for i, plane in enumerate(scene.planes):
        axis = max(range(3), key=lambda k: abs(plane.normal[k]))
        at = repr(plane.offset * plane.normal[axis])
        sides = f"{at} NULL" if plane.normal[axis] > 0 else f"NULL {at}"
        lines.append(f"fix plane{i} all wall/gran hooke/history {wall} {'xyz'[axis]}plane {sides}")
    for i, body in enumerate(scene.bodies):
        if body.motion == "fixed":
            edges = " ".join(
                f"{centre - half!r} {centre + half!r}"
                for centre, half in zip(body.position, body.shape.half_extents, strict=True)
            )
            lines.append(f"region box{i} block {edges} side out")
            lines.append(f"fix box{i} all wall/gran/region hooke/history {wall} region box{i}")
    if is_rigid:
        lines += ["fix move all rigid/small molecule infile bodies.txt"]
        lines += [f"compute pose all rigid/local move mol {RIGID_FIELDS}"]
        fields = " ".join(f"c_pose[{k + 1}]" for k in range(1 + len(RIGID_FIELDS.split())))
        lines += [f"dump poses all local {per_frame} poses.dump {fields}"]
        lines += ["dump_modify poses sort 1 format float %.17g"]
    else:
        lines += ["fix move all nve/sphere"]
        lines += [f"dump poses all custom {per_frame} poses.dump id {FIELDS}"]
        lines += ["dump_modify poses sort id format float %.17g"]
    lines += ["thermo_style custom step", "thermo 1000000000"]
    lines += [f"timer timeout {math.ceil(job['time_limit_s'])} every 100"]
    if job["warm_up_frames"] > 0:
        lines.append(f"run {job['warm_up_frames'] * per_frame}")
    lines.append(f"run {(job['num_frames'] - job['warm_up_frames']) * per_frame}")
    return "\n".join([*lines, ""])


def _data(bodies: list[PeerBody], is_rigid: bool) -> str:
    """Spheres in the world: places, sizes, velocities, and which body each belongs to."""
    atoms: list[str] = []
    velocities: list[str] = []
    molecules: list[str] = []
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for number, body in enumerate(bodies, 1):
        place, spin = np.asarray(body.position), np.asarray(body.angular_velocity)
        arms = np.zeros((1, 3))
        if is_rigid:
            arms = turned(np.asarray(body.orientation_wxyz), np.asarray(body.shape.centres))
        density = body.mass / len(arms) / (4 / 3 * math.pi * body.shape.radius**3)
        for arm in arms:
            at, velocity = place + arm, np.asarray(body.linear_velocity) + np.cross(spin, arm)
            low, high = np.minimum(low, at), np.maximum(high, at)
            one = len(atoms) + 1
            atoms.append(f"{one} 1 {2 * body.shape.radius!r} {density!r} {_row(at)}")
            velocities.append(f"{one} {_row(velocity)} {_row(spin)}")
            molecules.append(f"{one} {number}")
    margin = 4 * max(body.shape.radius for body in bodies)
    lines = ["spheres", "", f"{len(atoms)} atoms", "1 atom types", ""]
    for axis, a, b in zip("xyz", low - margin, high + margin, strict=True):
        lines.append(f"{float(a)!r} {float(b)!r} {axis}lo {axis}hi")
    lines += ["", "Atoms", "", *atoms, "", "Velocities", "", *velocities]
    if is_rigid:
        lines += ["", "Molecules", "", *molecules]
    return "\n".join([*lines, ""])


def _rigid_bodies(bodies: list[PeerBody]) -> str:
    """Our masses and inertias in place of those of the spheres: one line per body."""
    lines = [str(len(bodies))]
    for number, body in enumerate(bodies, 1):
        columns = turned(np.asarray(body.orientation_wxyz), np.eye(3)).T
        tensor = columns @ np.diag(body.inertia) @ columns.T
        momentum = tensor @ np.asarray(body.angular_velocity)
        moments = (tensor[0, 0], tensor[1, 1], tensor[2, 2])
        products = (tensor[0, 1], tensor[0, 2], tensor[1, 2])
        numbers = [body.mass, *body.position, *moments, *products]
        numbers += [*body.linear_velocity, *momentum]
        lines.append(f"{number} {_row(np.asarray(numbers))} 0 0 0")
    return "\n".join([*lines, ""])


def _row(values: FloatArray) -> str:
    return " ".join(repr(float(value)) for value in values)


def _dumped(file: Path) -> FloatArray:
    """Rows [frames, bodies, columns] of a text dump, in the order of its first column."""
    frames: list[FloatArray] = []
    rows: list[list[str]] = []
    wanted = False
    with file.open(encoding="utf-8") as stream:
        for line in stream:
            if line.startswith("ITEM:"):
                if rows:
                    frames.append(np.array(rows, dtype=np.float64))
                rows, wanted = [], line.startswith(("ITEM: ATOMS", "ITEM: ENTRIES"))
            elif wanted:
                rows.append(line.split())
    if rows:
        frames.append(np.array(rows, dtype=np.float64))
    whole = [frame for frame in frames if len(frame) == len(frames[0])]
    return np.stack(whole)


def _states(scene: PeerScene, free: list[int], rows: FloatArray, is_rigid: bool) -> FloatArray:
    """Poses of all bodies; single spheres keep the orientation of the start, which LAMMPS does not
    follow."""
    states = np.empty((len(rows), len(scene.bodies), 13))
    for i, body in enumerate(scene.bodies):
        states[:, i, 0:3], states[:, i, 3:7] = body.position, body.orientation_wxyz
        states[:, i, 7:10], states[:, i, 10:13] = body.linear_velocity, body.angular_velocity
    if not is_rigid:
        states[:, free, 0:3], states[:, free, 7:13] = rows[:, :, 1:4], rows[:, :, 4:10]
        return states
    # LAMMPS turns the axes of inertia as it finds them; the first frame says where they stand.
    start = states[:1, free, 3:7]
    own = quaternion_product(rows[:1, :, 4:8] * np.array([1.0, -1, -1, -1]), start)
    states[:, free, 0:3] = rows[:, :, 1:4]
    states[:, free, 3:7] = quaternion_product(rows[:, :, 4:8], own)
    states[:, free, 7:13] = rows[:, :, 8:14]
    return states

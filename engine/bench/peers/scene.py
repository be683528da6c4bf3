# SPDX-License-Identifier: MIT
"""One of our scenes as any rigid-body engine can take it: shapes, masses, poses, pair values."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from ruamel.yaml import YAML

from verisim.bench.peers.mesh import hull_of_mesh
from verisim.bench.peers.rotation import principal_axes, quaternion_product, turned
from verisim.engine import inspect_shape, load_scene

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # w first
FloatArray = npt.NDArray[np.float64]

# Defaults of scene files (stimuli/schema/scene.json).
DEFAULT_RESTITUTION = 0.5
DEFAULT_FRICTION = 0.5
DEFAULT_FRAME_RATE_HZ = 60.0
DEFAULT_GRAVITY_M_S2 = (0.0, 0.0, -9.81)


@dataclass(frozen=True)
class PeerShape:
    """What a body looks like in its own frame, m, about its centre of mass and along its
    principal axes of inertia. `kind` says which of the others count."""

    kind: Literal["box", "sphere", "mesh", "spheres"]
    half_extents: Vector = (0.0, 0.0, 0.0)
    radius: float = 0.0  # sphere; of each of `spheres`
    vertices: tuple[Vector, ...] = ()  # mesh: corners of its convex hull
    triangles: tuple[tuple[int, int, int], ...] = ()  # mesh: of the hull, outward
    centres: tuple[Vector, ...] = ()  # spheres


@dataclass(frozen=True)
class PeerBody:
    """One rigid body. Inertia is diagonal: the frame is the principal one."""

    name: str
    motion: Literal["free", "fixed"]
    shape: PeerShape
    material: int  # row of the pair tables
    mass: float  # kg
    inertia: Vector  # kg m2, about the principal axes
    position: Vector  # centre of mass
    orientation_wxyz: Quaternion  # principal frame to world
    linear_velocity: Vector
    angular_velocity: Vector  # world frame
    # Scene frame to principal frame: a logged orientation times this is the scene's own.
    frame_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PeerPlane:
    """Solid below normal . x = offset."""

    normal: Vector
    offset: float
    material: int


@dataclass(frozen=True)
class PeerScene:
    """A scene in SI units, z up, with nothing left to look up. `problems`: what no peer can pose
    (tethers, wind, moved bodies, hollow meshes …), one sentence each."""

    name: str
    gravity: Vector
    duration_s: float
    frame_rate_hz: float
    planes: tuple[PeerPlane, ...]
    bodies: tuple[PeerBody, ...]
    # Pair values by material, symmetric: what the two materials give together.
    restitution: tuple[tuple[float, ...], ...]
    friction: tuple[tuple[float, ...], ...]
    tethers: tuple[dict[str, Any], ...] = ()
    problems: tuple[str, ...] = field(default=())

    def as_json(self) -> dict[str, Any]:
        """All of it as JSON values."""
        return asdict(self)

    def num_frames(self) -> int:
        """Frames after the one at time 0."""
        return max(1, round(self.duration_s * self.frame_rate_hz))

    def smallest_body(self) -> float:
        """Greatest width of the smallest free body, m; infinite if there are none."""
        return min((_width(b.shape) for b in self.bodies if b.motion == "free"), default=math.inf)

    def scaled(self, factor: float) -> PeerScene:
        """The same motion with all lengths times `factor`; masses and times as they are."""

        def longer(vector: Vector, power: int = 1) -> Vector:
            return _vector(np.asarray(vector) * factor**power)

        bodies = tuple(
            replace(
                body,
                shape=replace(
                    body.shape,
                    half_extents=longer(body.shape.half_extents),
                    radius=body.shape.radius * factor,
                    vertices=tuple(longer(corner) for corner in body.shape.vertices),
                    centres=tuple(longer(centre) for centre in body.shape.centres),
                ),
                inertia=longer(body.inertia, 2),
                position=longer(body.position),
                linear_velocity=longer(body.linear_velocity),
            )
            for body in self.bodies
        )
        planes = tuple(replace(plane, offset=plane.offset * factor) for plane in self.planes)
        return replace(self, gravity=longer(self.gravity), bodies=bodies, planes=planes)

    def pairs_that_can_meet(self) -> set[tuple[int, int]]:
        """Pairs of materials of which at least one is a free body's, smaller row first."""
        free = [body.material for body in self.bodies if body.motion == "free"]
        num_free = {material: free.count(material) for material in set(free)}
        fixed = {body.material for body in self.bodies if body.motion == "fixed"}
        fixed |= {plane.material for plane in self.planes}
        pairs = {(min(a, b), max(a, b)) for a in num_free for b in fixed}
        for a in num_free:
            pairs |= {(min(a, b), max(a, b)) for b in num_free if a != b or num_free[a] > 1}
        return pairs

    def one_pair_value(self) -> tuple[float, float] | None:
        """(restitution, friction) if all pairs that can meet share them, else None."""
        pairs = self.pairs_that_can_meet()
        values = {(self.restitution[a][b], self.friction[a][b]) for a, b in pairs}
        return values.pop() if len(values) == 1 else (None if values else (0.0, 0.0))


def peer_scene(scene_path: Path, overrides: Mapping[str, object] | None = None) -> PeerScene:
    """The neutral form of a scene file with overrides applied. Raises SceneError or MeshError as
    the engine does; what peers cannot pose is listed in `problems`."""
    scene = load_scene(scene_path, overrides or {})
    data: dict[str, Any] = YAML(typ="safe", pure=True).load(io.StringIO(scene.resolved_yaml))
    names = list(data["materials"])
    restitution, friction, problems = _pair_tables(data, names)
    bodies = [_body(item, data, names, scene_path.parent, problems) for item in data["bodies"]]
    planes = []
    if "ground" in data:
        ground = data["ground"]
        normal = np.asarray(ground["plane"].get("normal", (0, 0, 1)), float)
        planes.append(
            PeerPlane(
                _vector(normal / np.linalg.norm(normal)),
                float(ground["plane"].get("offset_m", 0)),
                names.index(ground["material"]),
            )
        )
    modules = data.get("modules", {})
    if "wind" in modules:
        problems.append("wind")
    tethers = tuple(dict(item) for item in modules.get("tethers", []))
    if tethers:
        problems.append("tethers")
    return PeerScene(
        name=scene.name,
        gravity=_vector(data.get("gravity_m_s2", DEFAULT_GRAVITY_M_S2)),
        duration_s=scene.duration_s,
        frame_rate_hz=scene.frame_rate_hz,
        planes=tuple(planes),
        bodies=tuple(bodies),
        restitution=restitution,
        friction=friction,
        tethers=tethers,
        problems=tuple(dict.fromkeys(problems)),
    )


def _width(shape: PeerShape) -> float:
    """Greatest edge, width along an axis, or diameter (of one of a body of spheres), m."""
    if shape.kind == "box":
        return 2 * max(shape.half_extents)
    if shape.kind == "mesh":
        return float(np.ptp(np.asarray(shape.vertices), axis=0).max())
    return 2 * shape.radius


Table = tuple[tuple[float, ...], ...]


def _pair_tables(data: dict[str, Any], names: list[str]) -> tuple[Table, Table, list[str]]:
    """Geometric means of two materials unless material_pairs says otherwise."""
    problems: list[str] = []
    tables: dict[str, list[list[float]]] = {}
    defaults = {"restitution": DEFAULT_RESTITUTION, "friction": DEFAULT_FRICTION}
    for key, default in defaults.items():
        own = [float(data["materials"][name].get(key, default)) for name in names]
        tables[key] = [[math.sqrt(a * b) for b in own] for a in own]
    for pair in data.get("material_pairs", []):
        a, b = (names.index(name) for name in pair["materials"])
        for key, table in tables.items():
            if key in pair:
                table[a][b] = table[b][a] = float(pair[key])
    rolling = [item.get("rolling_friction", 0) for item in data["materials"].values()]
    rolling += [item.get("rolling_friction", 0) for item in data.get("material_pairs", [])]
    if any(value > 0 for value in rolling):
        problems.append("rolling friction")
    restitution, friction = (tuple(map(tuple, tables[key])) for key in defaults)
    return restitution, friction, problems


def _body(
    item: dict[str, Any],
    data: dict[str, Any],
    names: list[str],
    folder: Path,
    problems: list[str],
) -> PeerBody:
    motion = item.get("motion", "free")
    if motion not in ("free", "fixed"):
        problems.append("bodies that follow a pose log")
        motion = "fixed"
    density = float(data["materials"][item["material"]]["density_kg_m3"])
    shape, mass, inertia, frame = _mass_and_shape(item["shape"], density, folder, problems)
    if motion == "free" and data.get("physics", {}).get("method") == "seed":
        shape = _particles_of_box(shape, data["physics"].get("particle_size_m"))
    orientation = np.asarray(item.get("orientation_wxyz", (1, 0, 0, 0)), float)
    orientation /= np.linalg.norm(orientation)
    inverse = frame * np.array([1.0, -1, -1, -1])
    start = quaternion_product(orientation, inverse)
    return PeerBody(
        name=str(item["name"]),
        motion=motion,
        shape=shape,
        material=names.index(item["material"]),
        mass=mass,
        inertia=inertia,
        position=_vector(item.get("position_m", (0, 0, 0))),
        orientation_wxyz=(float(start[0]), float(start[1]), float(start[2]), float(start[3])),
        linear_velocity=_vector(item.get("velocity_m_s", (0, 0, 0))),
        angular_velocity=_vector(item.get("angular_velocity_rad_s", (0, 0, 0))),
        frame_wxyz=(float(frame[0]), float(frame[1]), float(frame[2]), float(frame[3])),
    )


def _mass_and_shape(
    shape: dict[str, Any], density: float, folder: Path, problems: list[str]
) -> tuple[PeerShape, float, Vector, FloatArray]:
    """Shape, mass, principal moments, and the turn from the scene's frame to the principal one."""
    straight = np.array([1.0, 0, 0, 0])
    if "box_m" in shape:
        x, y, z = (float(edge) for edge in shape["box_m"])
        mass = density * x * y * z
        moments = _vector(mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y]))
        return PeerShape("box", half_extents=(x / 2, y / 2, z / 2)), mass, moments, straight
    if "sphere_radius_m" in shape:
        radius = float(shape["sphere_radius_m"])
        mass = density * 4 / 3 * math.pi * radius**3
        moment = 0.4 * mass * radius**2
        return PeerShape("sphere", radius=radius), mass, (moment, moment, moment), straight
    file, scale = folder / shape["mesh"], float(shape.get("scale", 1))
    found: dict[str, Any] = dict(inspect_shape(file))
    mass = density * found["volume_m3"] * scale**3
    tensor = density * scale**5 * np.asarray(found["inertia_m5"], float)
    moments_array, frame = principal_axes(tensor)
    hull = hull_of_mesh(file, float(found["volume_m3"]))
    if hull is None:
        problems.append(f"mesh {file.name}, which is not convex or not an OBJ file")
        return PeerShape("mesh"), mass, _vector(moments_array), frame
    centred = (hull.vertices - np.asarray(found["center_of_mass_m"], float)) * scale
    corners = tuple(_vector(corner) for corner in turned(frame, centred))
    triangles = tuple((int(a), int(b), int(c)) for a, b, c in hull.triangles)
    body = PeerShape("mesh", vertices=corners, triangles=triangles)
    return body, mass, _vector(moments_array), frame


def _particles_of_box(shape: PeerShape, size: float | None) -> PeerShape:
    """Method seed fills a box with a lattice of touching spheres where they fit evenly; where they
    do not, and for other shapes, the shape stays as it is."""
    if shape.kind != "box" or size is None:
        return shape
    edges = 2 * np.asarray(shape.half_extents)
    counts = np.round(edges / size).astype(int)
    if (counts < 1).any() or np.abs(counts * size - edges).max() > 1e-9 * size:
        return shape
    rows = [(np.arange(count) + 0.5 - count / 2) * size for count in counts]
    lattice = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1).reshape(-1, 3)
    return PeerShape(
        "spheres",
        half_extents=shape.half_extents,
        radius=size / 2,
        centres=tuple(_vector(centre) for centre in lattice),
    )


def _vector(values: Any) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z

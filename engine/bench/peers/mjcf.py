# SPDX-License-Identifier: MIT
"""A scene as MuJoCo's XML. Masses, inertias and pair values are ours; the solver's settings are
those of the configuration."""

from __future__ import annotations

import math
from itertools import combinations

from verisim.bench.peers.scene import PeerBody, PeerPlane, PeerScene, PeerShape

# Room for contacts and constraints, touched only as far as used.
ARENA_MIB_PER_BODY, LEAST_ARENA_MIB = 1, 64
# Share of a contact's force that its spring decides: MuJoCo's own 0.9 to 0.95 is soft.
STIFF_IMPEDANCE = "0.99 0.9999 0.0005"
LEAST_RESTITUTION = 1e-3  # a half swing of a spring cannot return nothing
TUNED_OPTIONS = 'cone="elliptic" impratio="100" noslip_iterations="10" iterations="200"'


def mjcf(scene: PeerScene, config: str, dt_s: float) -> str:
    """The model, one body per free body in their order, each with a free joint."""
    one = scene.one_pair_value()
    default = _pair_attributes(*(one or (0.0, 0.0)), config, dt_s)
    options = "" if config == "default" else f' {TUNED_OPTIONS} tolerance="1e-12"'
    if config == "tuned+rk4":
        options += ' integrator="RK4"'
    lines = [
        "<mujoco>",
        '<compiler angle="radian" balanceinertia="false" fitaabb="false"/>',
        f'<size memory="{max(LEAST_ARENA_MIB, ARENA_MIB_PER_BODY * len(scene.bodies))}M"/>',
        f'<option timestep="{dt_s!r}" gravity="{_row(scene.gravity)}"{options}/>',
        f"<default><geom {default}/></default>",
        "<asset>",
        *_meshes(scene),
        "</asset>",
        "<worldbody>",
    ]
    contact = "" if one is not None else ' contype="0" conaffinity="0"'
    lines += [_plane(plane, i, contact) for i, plane in enumerate(scene.planes)]
    lines += [_body(body, i, contact) for i, body in enumerate(scene.bodies)]
    lines.append("</worldbody>")
    if one is None:
        lines += ["<contact>", *_pairs(scene, config, dt_s), "</contact>"]
    return "\n".join([*lines, "</mujoco>", ""])


def _row(values: tuple[float, ...]) -> str:
    return " ".join(repr(value) for value in values)


def _pair_attributes(restitution: float, friction: float, config: str, dt_s: float) -> str:
    """Friction and the contact's spring. MuJoCo has no coefficient of restitution: a spring and
    dashpot per unit mass of that damping ratio return it, stiff enough for so many steps in a half
    swing without damping."""
    tuned = config != "default"
    impedance = f' solimp="{STIFF_IMPEDANCE}"' if tuned or restitution >= LEAST_RESTITUTION else ""
    if restitution >= LEAST_RESTITUTION:
        rate = math.pi / ((20 if tuned else 10) * dt_s)
        ratio = -math.log(restitution) / math.hypot(math.pi, math.log(restitution))
        solref = f"{-(rate**2)!r} {-2 * ratio * rate!r}"
    else:
        solref = f"{2 * dt_s!r} 1" if tuned else "0.02 1"
    spring = f'solref="{solref}"{impedance}'
    if friction <= 0:
        return f'condim="1" {spring}'
    return f'condim="3" friction="{friction!r} 0.005 0.0001" {spring}'


def _meshes(scene: PeerScene) -> list[str]:
    lines = []
    for i, body in enumerate(scene.bodies):
        if body.shape.kind == "mesh":
            corners = " ".join(_row(corner) for corner in body.shape.vertices)
            faces = " ".join(f"{a} {b} {c}" for a, b, c in body.shape.triangles)
            lines.append(f'<mesh name="m{i}" vertex="{corners}" face="{faces}" inertia="exact"/>')
    return lines


def _geoms(shape: PeerShape, i: int, place: str, contact: str) -> list[str]:
    name = f'name="g{i}_0"'
    if shape.kind == "box":
        size = _row(shape.half_extents)
        return [f'<geom {name} type="box" size="{size}"{place}{contact}/>']
    if shape.kind == "sphere":
        return [f'<geom {name} type="sphere" size="{shape.radius!r}"{place}{contact}/>']
    if shape.kind == "mesh":
        return [f'<geom {name} type="mesh" mesh="m{i}"{place}{contact}/>']
    return [
        f'<geom name="g{i}_{k}" type="sphere" size="{shape.radius!r}" pos="{_row(at)}"{contact}/>'
        for k, at in enumerate(shape.centres)
    ]


def _plane(plane: PeerPlane, i: int, contact: str) -> str:
    at = _row(tuple(plane.offset * value for value in plane.normal))
    axis = _row(plane.normal)
    size = 'type="plane" size="0 0 1"'
    return f'<geom name="p{i}" {size} pos="{at}" zaxis="{axis}"{contact}/>'


def _body(body: PeerBody, i: int, contact: str) -> str:
    place = f'pos="{_row(body.position)}" quat="{_row(body.orientation_wxyz)}"'
    geoms = "".join(_geoms(body.shape, i, "", contact))
    if body.motion == "fixed":
        return f'<body name="b{i}" {place}>{geoms}</body>'
    inertial = f'<inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{_row(body.inertia)}"/>'
    return f'<body name="b{i}" {place}><freejoint/>{inertial}{geoms}</body>'


def _pairs(scene: PeerScene, config: str, dt_s: float) -> list[str]:
    """Every pair of geoms that can meet, with its own values."""
    lines = []

    def add(a: str, b: str, material_a: int, material_b: int) -> None:
        restitution = scene.restitution[material_a][material_b]
        friction = scene.friction[material_a][material_b]
        values = _pair_attributes(restitution, friction, config, dt_s)
        values = values.replace("0.005 0.0001", f"{friction!r} 0.005 0.0001 0.0001")
        lines.append(f'<pair geom1="{a}" geom2="{b}" {values}/>')

    def names(i: int) -> list[str]:
        return [f"g{i}_{k}" for k in range(max(1, len(scene.bodies[i].shape.centres)))]

    for i, body in enumerate(scene.bodies):
        if body.motion == "free":
            for k, plane in enumerate(scene.planes):
                for geom in names(i):
                    add(f"p{k}", geom, plane.material, body.material)
    for i, j in combinations(range(len(scene.bodies)), 2):
        a, b = scene.bodies[i], scene.bodies[j]
        if "free" in (a.motion, b.motion):
            for geom_a in names(i):
                for geom_b in names(j):
                    add(geom_a, geom_b, a.material, b.material)
    return lines

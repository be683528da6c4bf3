# SPDX-License-Identifier: MIT
"""Our scenes reach other engines with the same masses, inertias, frames and pair values. No other
engine is needed here."""

from __future__ import annotations

import math
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from peer_scenes import EDGES, ball, box, write_scene, write_turned_box

from verisim import engine
from verisim.bench import peers
from verisim.bench.peers import driver_run, lammps
from verisim.bench.peers.install import MUJOCO_VERSION
from verisim.bench.peers.mjcf import mjcf
from verisim.bench.peers.rotation import principal_axes, quaternion_product, turned

ROOT = Path(__file__).resolve().parents[2]
SCENES = sorted((ROOT / "tests/data/peer_failures").glob("*.yaml"))
SCENES = [file for file in SCENES if file.stem != "limits"]
SCENES += sorted((ROOT / "stimuli/scenes").glob("*.yaml"))


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_masses_and_starts_are_the_engines(file: Path) -> None:
    scene = peers.peer_scene(file, {"duration_s": 1e-3})
    run = engine.simulate(file, {"duration_s": 1e-3})
    assert [body.name for body in scene.bodies] == run.poses.names
    for i, (body, found) in enumerate(zip(scene.bodies, run.summary["bodies"], strict=True)):
        if body.motion == "free":
            assert body.mass == pytest.approx(found["mass_kg"], rel=1e-12)  # measured 4e-16
        start = quaternion_product(np.array(body.orientation_wxyz), np.array(body.frame_wxyz))
        along = abs(float(start @ run.poses.orientation_wxyz[0, i]))
        assert along == pytest.approx(1, abs=1e-12)  # measured 4e-16
        assert body.position == tuple(run.poses.position_m[0, i])


def test_a_mesh_is_turned_onto_its_axes_of_inertia_and_its_poses_back(tmp_path: Path) -> None:
    mesh = write_turned_box(tmp_path)
    start = [0.5, 0.5, 0.5, 0.5]
    shape = {"mesh": mesh.name, "scale": 2}
    file = write_scene(tmp_path, [box(shape=shape, orientation_wxyz=start)])
    body = peers.peer_scene(file).bodies[0]
    x, y, z = 2 * EDGES
    mass = 500 * x * y * z
    moments = sorted([mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z)])
    # Meshes are read in single precision: measured 5e-8.
    assert body.mass == pytest.approx(mass, rel=1e-6)
    assert sorted(body.inertia) == pytest.approx([mass / 12 * (x * x + y * y), *moments], rel=1e-6)
    # In the principal frame the corners are those of an upright box about its centre.
    corners = np.abs(np.array(body.shape.vertices))
    assert corners == pytest.approx(np.tile(corners[0], (8, 1)), abs=1e-6)
    assert sorted(corners[0]) == pytest.approx(sorted(EDGES), abs=1e-6)
    assert len(body.shape.triangles) == 12
    back = quaternion_product(np.array(body.orientation_wxyz), np.array(body.frame_wxyz))
    assert back == pytest.approx(start, abs=1e-12)


def test_triangles_of_a_hull_look_outward(tmp_path: Path) -> None:
    mesh = write_turned_box(tmp_path)
    body = peers.peer_scene(write_scene(tmp_path, [box(shape={"mesh": mesh.name})])).bodies[0]
    corners = np.array(body.shape.vertices)
    for a, b, c in body.shape.triangles:
        outward = np.cross(corners[b] - corners[a], corners[c] - corners[a])
        assert outward @ corners[a] > 0


def test_moments_along_principal_axes_are_those_of_the_tensor() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        root = rng.normal(size=(3, 3))
        tensor = root @ root.T
        moments, quaternion = principal_axes(tensor)
        axes = rng.normal(size=(7, 3))
        expected = np.einsum("ij,jk,ik->i", axes, tensor, axes)
        found = (turned(quaternion, axes) ** 2) @ moments
        assert found == pytest.approx(expected, rel=1e-10)  # measured 1e-14


def test_pairs_have_geometric_means_unless_the_scene_says_otherwise(tmp_path: Path) -> None:
    materials = {
        "wood": {"density_kg_m3": 500, "restitution": 0.9, "friction": 0.2},
        "rubber": {"density_kg_m3": 1000, "restitution": 0.4, "friction": 0.8},
        "ice": {"density_kg_m3": 900},
    }
    pairs = [{"materials": ["ice", "wood"], "friction": 0.01}]
    file = write_scene(tmp_path, [ball()], materials=materials, material_pairs=pairs)
    scene = peers.peer_scene(file)
    assert scene.restitution[0][1] == pytest.approx(0.6)
    assert scene.friction[0][1] == pytest.approx(0.4)
    assert scene.restitution[1][2] == pytest.approx(math.sqrt(0.4 * 0.5))  # 0.5 by default
    assert scene.friction[0][2] == scene.friction[2][0] == 0.01


def test_one_pair_value_counts_only_what_can_meet(tmp_path: Path) -> None:
    materials = {
        "wood": {"density_kg_m3": 500, "restitution": 0.9, "friction": 0.2},
        "floor": {"density_kg_m3": 500, "restitution": 0.4, "friction": 0.8},
    }
    ground = {"plane": {"offset_m": -1}, "material": "floor"}
    one = write_scene(tmp_path, [ball()], materials=materials, ground=ground)
    values = peers.peer_scene(one).one_pair_value()
    assert values == pytest.approx((0.6, 0.4))  # a single ball never meets its own kind
    two = write_scene(
        tmp_path, [ball(), box(position_m=[1, 0, 0])], materials=materials, ground=ground
    )
    assert peers.peer_scene(two).one_pair_value() is None


def test_scenes_that_peers_cannot_pose_say_why(tmp_path: Path) -> None:
    line = {"body": "ball", "anchor_m": [0, 0, 2]}
    modules = {"wind": {"velocity_m_s": [1, 0, 0]}, "tethers": [line]}
    rolling = {"wood": {"density_kg_m3": 500, "rolling_friction": 0.1}}
    file = write_scene(tmp_path, [ball(position_m=[0, 0, 1])], modules=modules, materials=rolling)
    scene = peers.peer_scene(file)
    config = peers.PeerConfig("bullet", "default")
    assert peers.cannot_pose(config, scene) == "no rolling friction, no wind, no tethers"
    run = peers.run_peer(config, scene, 1 / 60, tmp_path, time_limit_s=1)
    assert run.failed == "no rolling friction, no wind, no tethers"
    assert run.poses.position_m.tolist() == [[[0, 0, 1]]]
    hollow = peers.peer_scene(ROOT / "stimuli/scenes/fox_tumble.yaml")
    why = peers.cannot_pose(config, hollow)
    assert why is not None
    assert "fox.obj" in why


def test_an_engine_that_is_missing_is_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver_run, "missing", lambda name: f"{name}: not built")
    scene = peers.peer_scene(write_scene(tmp_path, [ball()]))
    for config in peers.contestants():
        if peers.cannot_pose(config, scene) is None:
            run = peers.run_peer(config, scene, 1 / 60, tmp_path, time_limit_s=1)
            assert run.failed == f"{config.engine}: not built"
    assert "no peer named" in str(peers.missing("havok"))


def test_a_driver_that_dies_is_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    driver = tmp_path / "driver"
    driver.write_text("#!/bin/sh\necho broken pipes >&2\nexit 3\n", "utf-8")
    driver.chmod(0o755)
    monkeypatch.setattr(driver_run, "missing", lambda _: None)
    monkeypatch.setattr(driver_run, "driver_of", lambda _: driver)
    scene = peers.peer_scene(write_scene(tmp_path, [ball()]))
    config = peers.PeerConfig("ode", "20")
    run = peers.run_peer(config, scene, 1 / 60, tmp_path / "runs", time_limit_s=1)
    assert run.failed == "driver ended with status 3: broken pipes"
    assert list((tmp_path / "runs").iterdir()) == []


def test_steps_divide_a_frame_and_are_no_longer_than_asked(tmp_path: Path) -> None:
    scene = peers.peer_scene(write_scene(tmp_path, [ball()]))
    asked = {1 / 60: 1, 1 / 240: 4, 1 / 1000: 17, 1 / 4000: 67, 1: 1}
    for dt, steps in asked.items():
        assert peers.steps_per_frame(scene, dt) == steps
    assert scene.num_frames() == 30


def test_a_seed_box_becomes_spheres_with_the_mass_of_the_box(tmp_path: Path) -> None:
    physics = {"method": "seed", "particle_size_m": 0.2 / 3}
    wall = box(name="wall", motion="fixed", position_m=[1, 0, 0])
    file = write_scene(tmp_path, [box(), wall], physics=physics)
    body, fixed = peers.peer_scene(file).bodies
    centres = np.array(body.shape.centres)
    assert centres.shape == (27, 3)
    assert np.abs(centres).max() + body.shape.radius == pytest.approx(0.1)
    assert centres.mean(axis=0) == pytest.approx([0, 0, 0], abs=1e-15)
    assert body.mass == pytest.approx(4)
    assert body.inertia == pytest.approx([4 / 6 * 0.04] * 3)
    assert fixed.shape.kind == "box"


@pytest.mark.parametrize("config", peers.CONFIGS["mujoco"])
def test_the_model_for_mujoco_holds_our_masses_and_every_pair(config: str, tmp_path: Path) -> None:
    materials = {
        "wood": {"density_kg_m3": 500, "restitution": 0.2, "friction": 0.5},
        "rubber": {"density_kg_m3": 500, "restitution": 0.8, "friction": 0.5},
    }
    bodies = [ball(), box(material="rubber", position_m=[1, 0, 0]), box(name="b", motion="fixed")]
    scene = peers.peer_scene(write_scene(tmp_path, bodies, materials=materials))
    model = ElementTree.fromstring(mjcf(scene, config, 1e-3))
    masses = [float(item.get("mass", "")) for item in model.iter("inertial")]
    assert masses == [scene.bodies[0].mass, scene.bodies[1].mass]
    pairs = {(item.get("geom1"), item.get("geom2")) for item in model.iter("pair")}
    among = {(f"g{a}_0", f"g{b}_0") for a, b in ((0, 1), (0, 2), (1, 2))}
    assert pairs == {("p0", "g0_0"), ("p0", "g1_0"), *among}


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("config", peers.CONFIGS["lammps"])
def test_springs_for_lammps_return_the_restitution_in_the_steps_meant(
    config: str, restitution: float, tmp_path: Path
) -> None:
    materials = {"wood": {"density_kg_m3": 500, "restitution": restitution, "friction": 0.5}}
    scene = peers.peer_scene(write_scene(tmp_path, [ball()], materials=materials))
    dt, mass = 1e-4, 2.5
    kn, _, gamma = map(float, lammps._contact(scene, config, dt, mass).split()[:3])
    x, v, steps, fine = 0.0, 1.0, 0, dt / 1000
    while x >= 0:
        v -= fine * (kn / mass * x + gamma * v)
        x += fine * v
        steps += 1
    assert -v == pytest.approx(restitution, abs=2e-3)  # measured at most 8e-5
    assert steps / 1000 == pytest.approx(lammps.STEPS_PER_CONTACT[config], rel=1e-3)


def test_every_engine_has_its_default_first_and_its_settings_in_words() -> None:
    assert {config.engine for config in peers.contestants()} == set(peers.CONFIGS)
    keys = [config.key for config in peers.contestants()]
    assert len(keys) == len(set(keys))
    for configs in peers.CONFIGS.values():
        assert all(configs.values())


def test_the_extra_names_the_version_that_is_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["optional-dependencies"]["peers"] == [f"mujoco=={MUJOCO_VERSION}"]
    assert not any("mujoco" in name for name in project["dependencies"])


def test_small_bodies_reach_engines_with_lengths_of_their_own_in_longer_units(
    tmp_path: Path,
) -> None:
    small = ball(shape={"sphere_radius_m": 0.005}, velocity_m_s=[1, 0, 0], position_m=[0, 2, 0])
    scene = peers.peer_scene(write_scene(tmp_path, [small]))
    rapier, ode = peers.PeerConfig("rapier", "stiff"), peers.PeerConfig("ode", "20")
    assert driver_run.length_unit(ode, scene) == 1
    unit = driver_run.length_unit(rapier, scene)
    assert unit == pytest.approx(50)
    longer, body = scene.scaled(unit), scene.scaled(unit).bodies[0]
    assert longer.gravity[2] == pytest.approx(-9.81 * 50)
    assert (body.position[1], body.linear_velocity[0]) == pytest.approx((100, 50))
    assert body.mass == scene.bodies[0].mass
    assert body.inertia == pytest.approx([0.4 * body.mass * 0.25**2] * 3)
    # A thin plate is no small body, nor a ball of the least width.
    plate = box(shape={"box_m": [1, 1, 1e-4]})
    for body_of_usual_size in (plate, ball(shape={"sphere_radius_m": 0.05})):
        usual = peers.peer_scene(write_scene(tmp_path, [body_of_usual_size]))
        assert driver_run.length_unit(rapier, usual) == 1

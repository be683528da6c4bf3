# SPDX-License-Identifier: MIT
"""Each engine that is installed moves our bodies as mechanics says where every engine agrees."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from peer_scenes import EDGES, ball, box, write_scene, write_turned_box

from verisim.bench import peers
from verisim.bench.peers import PeerConfig, PeerRun

CONFIGS = [config for config in peers.contestants() if config.engine != "lammps"]
LAMMPS = PeerConfig("lammps", "default")


def run(config: PeerConfig, file: Path, *, dt_s: float = 1 / 240, **more: float) -> PeerRun:
    why = peers.missing(config.engine)
    if why is not None:
        pytest.skip(why)
    folder = file.parent / "runs"
    limits = {"time_limit_s": 20.0, **more}
    return peers.run_peer(config, peers.peer_scene(file), dt_s, folder, **limits)


@pytest.mark.parametrize("config", [*CONFIGS, LAMMPS], ids=lambda config: config.key)
def test_free_flight_is_straight_and_spins_on(config: PeerConfig, tmp_path: Path) -> None:
    flying = ball(velocity_m_s=[1, 2, 3], angular_velocity_rad_s=[0, 0, 2])
    file = write_scene(tmp_path, [flying], gravity_m_s2=[0, 0, 0], ground=None)
    found = run(config, file)
    assert found.failed is None
    assert found.version
    assert found.dt_s == pytest.approx(1 / 240)
    assert found.cpu_s > 0
    assert found.simulated_s == pytest.approx(0.5)
    assert found.poses.time_s == pytest.approx(np.arange(31) / 60)
    # Jolt damps by 0.05 per second unless told not to: measured 2.5 %. Rapier's
    # single precision wanders: measured 6e-5; the others 1e-6.
    tolerance = 0.02 if config.key == "jolt-default" else 2e-4
    assert found.poses.position_m[-1, 0] == pytest.approx([0.5, 1, 1.5], rel=tolerance)
    assert found.poses.angular_velocity_rad_s[-1, 0, 2] == pytest.approx(2, rel=2 * tolerance)
    if config.engine != "lammps":  # which does not follow the orientation of a sphere
        half = np.radians(90 / np.pi)  # 1 rad
        turn = found.poses.orientation_wxyz[-1, 0]
        assert abs(turn @ [np.cos(half), 0, 0, np.sin(half)]) == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.key)
def test_a_mesh_comes_to_rest_on_its_face_in_the_frame_of_its_file(
    config: PeerConfig, tmp_path: Path
) -> None:
    mesh = write_turned_box(tmp_path)
    start = [np.cos(0.5), 0, 0, np.sin(0.5)]
    body = box(
        shape={"mesh": mesh.name}, orientation_wxyz=start, position_m=[0, 0, EDGES[2] / 2 + 0.01]
    )
    found = run(config, write_scene(tmp_path, [body], duration_s=1))
    assert found.failed is None
    assert found.poses.orientation_wxyz[0, 0] == pytest.approx(start, abs=1e-12)
    # Jolt lets bodies sink into its slop of 20 mm, Bullet keeps a margin: measured 6 mm at most.
    assert found.poses.position_m[-1, 0, 2] == pytest.approx(EDGES[2] / 2, abs=0.012)
    assert abs(found.poses.orientation_wxyz[-1, 0] @ start) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.key)
def test_a_bead_rolls_and_lies_as_deep_as_a_large_ball(config: PeerConfig, tmp_path: Path) -> None:
    radius = 0.005
    bead = ball(
        shape={"sphere_radius_m": radius}, position_m=[0, 0, radius], velocity_m_s=[0.1, 0, 0]
    )
    found = run(config, write_scene(tmp_path, [bead]), dt_s=1e-3)
    assert found.failed is None
    # Measured at most 1.4 % of the radius deep (MuJoCo, Rapier), and 2.5 % slow (Jolt's damping).
    assert found.poses.position_m[-1, 0, 2] == pytest.approx(radius, abs=0.03 * radius)
    assert found.poses.linear_velocity_m_s[-1, 0, 0] == pytest.approx(0.5 / 7, rel=0.04)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.key)
def test_values_of_a_pair_reach_the_contact(config: PeerConfig, tmp_path: Path) -> None:
    materials = {
        "wood": {"density_kg_m3": 500, "restitution": 0, "friction": 0.6},
        "ice": {"density_kg_m3": 500, "restitution": 0, "friction": 0.6},
    }
    pairs = [{"materials": ["ice", "wood"], "friction": 0}]
    moving = {"velocity_m_s": [2, 0, 0]}
    bodies = [
        box(name="rough", position_m=[0, 0, 0.1], **moving),
        box(name="slick", position_m=[0, 1, 0.1], **{**moving, "material": "ice"}),
    ]
    file = write_scene(tmp_path, bodies, materials=materials, material_pairs=pairs)
    found = run(config, file)
    assert found.failed is None
    rough, slick = found.poses.position_m[-1, :, 0]
    assert slick == pytest.approx(1, rel=0.02)
    # Braked by 0.6 g it stops after 0.34 m: measured 0.30 (Rapier, Coulomb) to 0.39.
    assert rough == pytest.approx(4 / 2 / 0.6 / 9.81, abs=0.08)


@pytest.mark.parametrize("config", [*CONFIGS, LAMMPS], ids=lambda config: config.key)
def test_bodies_of_spheres_stand_on_their_lowest_ones(config: PeerConfig, tmp_path: Path) -> None:
    physics = {"method": "seed", "particle_size_m": 0.1}
    wall = box(name="wall", motion="fixed", position_m=[0.25, 0, 0.1])
    body = box(position_m=[0, 0, 0.101], orientation_wxyz=[np.cos(0.2), 0, 0, np.sin(0.2)])
    file = write_scene(tmp_path, [body, wall], physics=physics)
    found = run(config, file, dt_s=1e-4 if config == LAMMPS else 1 / 240)
    assert found.failed is None
    assert found.poses.position_m[-1, 0] == pytest.approx([0, 0, 0.1], abs=0.01)
    turn = found.poses.orientation_wxyz[-1, 0]
    assert abs(turn @ [np.cos(0.2), 0, 0, np.sin(0.2)]) == pytest.approx(1, abs=1e-3)
    assert found.poses.position_m[-1, 1] == pytest.approx([0.25, 0, 0.1])


@pytest.mark.parametrize("engine", peers.CONFIGS)
def test_a_run_out_of_time_keeps_what_it_has(engine: str, tmp_path: Path) -> None:
    bodies = [ball(name=f"ball{i}", position_m=[0.3 * i, 0, 0.3]) for i in range(20)]
    config = next(item for item in peers.contestants() if item.engine == engine)
    file = write_scene(tmp_path, bodies, duration_s=1e3)
    dt, limit = (1e-5, 1.0) if engine == "lammps" else (1e-4, 0.05)
    found = run(config, file, dt_s=dt, time_limit_s=limit)
    assert found.failed is not None
    assert found.failed.startswith("time limit of")
    assert 1 < len(found.poses.time_s) < 60_000
    assert 0 < found.simulated_s < 1e3


@pytest.mark.parametrize("engine", peers.CONFIGS)
def test_the_warm_up_is_logged_but_not_timed(engine: str, tmp_path: Path) -> None:
    config = next(item for item in peers.contestants() if item.engine == engine)
    file = write_scene(tmp_path, [ball(position_m=[0, 0, 0.2])])
    found = run(config, file, dt_s=1e-3, warm_up_s=0.3)
    assert found.failed is None
    assert found.simulated_s == pytest.approx(0.2)
    assert len(found.poses.time_s) == 31


@pytest.mark.parametrize("engine", peers.CONFIGS)
def test_the_same_run_twice_gives_the_same_poses(engine: str, tmp_path: Path) -> None:
    config = next(item for item in peers.contestants() if item.engine == engine)
    bodies = [ball(name=f"b{i}", position_m=[0.05 * i, 0.01 * i, 0.2 + 0.25 * i]) for i in range(5)]
    file = write_scene(tmp_path, bodies)
    dt = 1e-4 if engine == "lammps" else 1 / 240
    first, second = (run(config, file, dt_s=dt) for _ in range(2))
    assert first.poses.position_m.tobytes() == second.poses.position_m.tobytes()

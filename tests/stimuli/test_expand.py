# SPDX-License-Identifier: MIT
"""Sets expand to stimuli with stable ids, and content keys follow the content alone."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from ruamel.yaml import YAML
from small_sets import BALL_SCENE, write_set

from verisim.stimuli import Stimulus, expand, load_set
from verisim.stimuli.expand import content_key

ENGINE = {"version": "1", "build": "abc"}
CROSSED = """\
schema: 1
name: crossed
scenes: [ball, other]
factors:
  stiffness: {set: physics.stiffness_n_m, levels: {low: 500, high: 5000}, reference: high}
  steps: {set: physics.dt_s, levels: [1e-3, 2e-3], only: [ball]}
seeds: [1, 2]
roles:
  practice: [{scene: other}]
  catch: [{scene: ball, name: up, set: {gravity_m_s2: [0, 0, 3]}, seed: 5}]
"""


def test_a_set_expands_to_scenes_by_levels_by_seeds_and_its_roles(library: Path) -> None:
    stimuli = expand(load_set(write_set(library, CROSSED)))
    assert [s.id for s in stimuli] == [
        "ball__stiffness-low__steps-1e-3__s1",
        "ball__stiffness-low__steps-1e-3__s2",
        "ball__stiffness-low__steps-2e-3__s1",
        "ball__stiffness-low__steps-2e-3__s2",
        "ball__stiffness-high__steps-1e-3__s1",
        "ball__stiffness-high__steps-1e-3__s2",
        "ball__stiffness-high__steps-2e-3__s1",
        "ball__stiffness-high__steps-2e-3__s2",
        "other__stiffness-low__s1",
        "other__stiffness-low__s2",
        "other__stiffness-high__s1",
        "other__stiffness-high__s2",
        "other__practice-1__s1",
        "ball__catch-up__s5",
    ]
    assert stimuli[1].overrides == {"physics.stiffness_n_m": 500, "physics.dt_s": 1e-3, "seed": 2}
    assert stimuli[-1].overrides == {"gravity_m_s2": [0, 0, 3], "seed": 5}
    assert [s.role for s in stimuli[-2:]] == ["practice", "catch"]


def test_the_reference_has_the_same_scene_seed_and_levels_of_factors_without_one(
    library: Path,
) -> None:
    by_id = {s.id: s for s in expand(load_set(write_set(library, CROSSED)))}
    low = by_id["ball__stiffness-low__steps-2e-3__s2"]
    assert low.reference == "ball__stiffness-high__steps-2e-3__s2"
    assert by_id[low.reference].reference == ""
    assert by_id["other__practice-1__s1"].reference == ""


def test_ids_are_unique_and_do_not_depend_on_what_else_the_set_holds(library: Path) -> None:
    stimuli = expand(load_set(write_set(library, CROSSED)))
    ids = {s.id for s in stimuli}
    assert len(ids) == len(stimuli)
    fewer = CROSSED.replace("[ball, other]", "[other]").replace(", only: [ball]", "")
    fewer = fewer.replace("  steps: {set: physics.dt_s, levels: [1e-3, 2e-3]}\n", "")
    assert {s.id for s in expand(load_set(write_set(library, fewer)))} < ids


def only_stimulus(library: Path, extra: str = "") -> Stimulus:
    text = f"schema: 1\nname: one\nscenes: [ball]\n{extra}"
    return expand(load_set(write_set(library, text)))[0]


def test_the_content_key_changes_exactly_when_what_decides_the_bytes_changes(
    library: Path,
) -> None:
    scene = library / "scenes" / "ball.yaml"
    mesh = library / "scenes" / "shape.obj"
    mesh.write_text("v 0 0 0\n")
    with_mesh = BALL_SCENE.format(name="ball").replace(
        "{sphere_radius_m: 0.1}", "{mesh: shape.obj}"
    )
    scene.write_text(with_mesh)
    level = "factors: {f: {set: physics.dt_s, levels: {a: VALUE}}}\n"

    def key(
        extra: str = level.replace("VALUE", "1e-3"),
        profile: str = "stimulus",
        size: tuple[int, int] = (64, 64),
        engine: dict[str, str] = ENGINE,
    ) -> str:
        return content_key(only_stimulus(library, extra), profile, size, engine)

    keys = {
        "as it is": key(),
        "other level": key(level.replace("VALUE", "2e-3")),
        "other seed": key(level.replace("VALUE", "1e-3") + "seeds: [2]\n"),
        "other profile": key(profile="master"),
        "other size": key(size=(64, 66)),
        "other version": key(engine={**ENGINE, "version": "2"}),
        "other build": key(engine={**ENGINE, "build": "def"}),
    }
    mesh.write_text("v 0 0 1\n")
    keys["other mesh"] = key()
    mesh.write_text("v 0 0 0\n")
    scene.write_text(with_mesh + "# a word\n")
    keys["other scene file"] = key()
    scene.write_text(with_mesh)
    assert len(set(keys.values())) == len(keys), Counter(keys.values())

    assert key() == keys["as it is"]
    assert key(level.replace("VALUE", "0.001")) == keys["as it is"]
    assert key(level.replace("{f:", "{renamed:").replace("VALUE", "1e-3")) == keys["as it is"]
    (library / "scenes" / "other.yaml").write_text("changed")
    assert key() == keys["as it is"]


def test_a_mesh_named_by_an_override_counts(library: Path) -> None:
    mesh = library / "scenes" / "shape.obj"
    extra = "factors: {f: {set: bodies.ball.shape.mesh, levels: {a: shape.obj}}}\n"
    keys = set()
    for content in ("v 0 0 0\n", "v 0 0 1\n"):
        mesh.write_text(content)
        keys.add(content_key(only_stimulus(library, extra), "stimulus", (64, 64), ENGINE))
    assert len(keys) == 2


def shipped_sets() -> list[Path]:
    import verisim.stimuli

    return sorted((Path(verisim.stimuli.__file__).parent / "sets").glob("*.yaml"))


@pytest.mark.parametrize("file", shipped_sets(), ids=lambda file: file.stem)
def test_shipped_sets_expand_to_what_their_files_say(file: Path) -> None:
    stimuli = expand(load_set(file))
    document = YAML(typ="safe", pure=True).load(file.read_text("utf-8"))
    expected = 0
    for scene in document["scenes"]:
        clips = len(document.get("seeds", [1]))
        for factor in document.get("factors", {}).values():
            clips *= len(factor["levels"]) if scene in factor.get("only", [scene]) else 1
        expected += clips
    counts = Counter(s.role for s in stimuli)
    assert counts["test"] == expected
    for role in ("practice", "catch"):
        assert counts[role] == len(document.get("roles", {}).get(role, []))
    assert {s.scene for s in stimuli if s.role == "test"} == set(document["scenes"])
    ids = {s.id for s in stimuli}
    assert all(s.reference in ids for s in stimuli if s.reference)


def test_the_demo_set_has_about_twelve_test_clips_of_at_least_three_scenes() -> None:
    (demo,) = (file for file in shipped_sets() if file.stem == "demo")
    tests = [s for s in expand(load_set(demo)) if s.role == "test"]
    assert 10 <= len(tests) <= 14
    assert len({s.scene for s in tests}) >= 3

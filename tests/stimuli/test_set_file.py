# SPDX-License-Identifier: MIT
"""The set file is read strictly, and says everything that is wrong with it at once."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_sets import write_set

from verisim.stimuli import SetError, load_set


def problems(library: Path, text: str) -> list[str]:
    with pytest.raises(SetError) as caught:
        load_set(write_set(library, text))
    return [str(problem) for problem in caught.value.problems]


def test_a_sound_set_is_read_with_its_defaults(library: Path) -> None:
    stimulus_set = load_set(write_set(library, "schema: 1\nname: plain\nscenes: [ball]\n"))
    assert stimulus_set.scenes == ("ball",)
    assert stimulus_set.seeds == (1,)
    assert stimulus_set.size == (1280, 720)
    assert stimulus_set.profile == "stimulus"
    assert stimulus_set.factors == ()
    assert stimulus_set.role_clips == ()


def test_levels_are_a_list_a_named_map_or_maps_of_scene_keys(library: Path) -> None:
    text = """\
schema: 1
name: levels
scenes: [ball, other]
factors:
  steps: {set: physics.dt_s, levels: [1e-3, 2e-3], only: [ball]}
  pull: {set: gravity_m_s2, levels: {down: [0, 0, -9.81], none: [0, 0, 0]}}
  both: {levels: {easy: {}, hard: {physics.damping_ratio: 0.2, physics.stiffness_n_m: 1000}}}
"""
    steps, pull, both = load_set(write_set(library, text)).factors
    assert [(level.name, level.overrides) for level in steps.levels] == [
        ("1e-3", {"physics.dt_s": 1e-3}),
        ("2e-3", {"physics.dt_s": 2e-3}),
    ]
    assert pull.levels[1].overrides == {"gravity_m_s2": [0, 0, 0]}
    assert both.levels[0].overrides == {}
    assert both.levels[1].overrides == {"physics.damping_ratio": 0.2, "physics.stiffness_n_m": 1000}
    assert steps.applies_to("ball") and not steps.applies_to("other")


def test_all_problems_are_reported_at_once_each_with_line_key_value_and_allowed(
    library: Path,
) -> None:
    text = """\
schema: 2
name: two words
sceens: [ball]
scenes: [ball, bal, ball]
factors:
  Stiffness: {set: physics.stiffness_n_m, levels: {low: 50, high: 500}, reference: hihg}
  speed: {set: seed, levels: [1, 1]}
  empty: {set: physics.dt_s}
seeds: [1, -1, 1]
roles: {exam: [{scene: ball}], catch: [{name: x}]}
profile: best
size: 63x64
"""
    found = problems(library, text)
    expected: list[tuple[int, str, *tuple[str, ...]]] = [
        (1, "schema", "saw 2"),
        (2, "name", "saw two words"),
        (3, "sceens", "an unknown key", "did you mean scenes?"),
        (4, "scenes.1", "saw bal", "did you mean ball?"),
        (4, "scenes.2", "each scene once"),
        (6, "factors.Stiffness", "small letters"),
        (6, "factors.Stiffness.reference", "saw hihg", "did you mean high?"),
        (7, "factors.speed.set", "saw seed"),
        (7, "factors.speed.levels.1", "each level once"),
        (8, "factors.empty.levels", "required"),
        (9, "seeds.1", "saw -1"),
        (9, "seeds.2", "each seed once"),
        (10, "roles.exam", "an unknown key"),
        (10, "roles.catch.0.scene", "required"),
        (11, "profile", "saw best", "stimulus, master, preview"),
        (12, "size", "saw 63x64", "even"),
    ]
    for line, key, *words in expected:
        start = f"{library}/sets/small.yaml:{line}: {key}:"
        alternatives = [text for text in found if text.startswith((start, start[:-1] + ";"))]
        assert any(all(word in text for word in words) for text in alternatives), (key, found)
    assert len(found) == len(expected), found


def test_two_factors_that_set_the_same_key_of_a_scene_are_refused(library: Path) -> None:
    text = """\
schema: 1
name: clash
scenes: [ball, other]
factors:
  a: {set: physics.dt_s, levels: [1e-3, 2e-3]}
  b: {levels: {x: {physics.dt_s: 1e-3}}, only: [other]}
"""
    (message,) = problems(library, text)
    assert "factors.b" in message and "factor a sets physics.dt_s in other too" in message
    load_set(write_set(library, text.replace("2e-3]}", "2e-3], only: [ball]}")))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("schema: [1\n", "expected"),
        ("", "an empty file"),
        ("- 1\n", "a map of: schema"),
        ("schema: 1\nname: n\nscenes: []\n", "at least one"),
        ("schema: 1\nname: n\nscenes: [ball]\nname: m\n", "the same key twice"),
        ("schema: 1\nname: n\nscenes: [ball]\nfactors: {f: {levels: [1]}}\n", "{scene key: value"),
        ("schema: 1\nname: n\nscenes: [ball]\nfactors: {f: {set: a, levels: {x: ~}}}\n", "null"),
        ("schema: 1\nname: n\nscenes: [ball]\nfactors: {f: {set: a, levels: {x: .nan}}}\n",
         "finite"),
        ("schema: 1\nname: n\nscenes: [ball]\nfactors: {f: {set: a, levels: [[1, 2]]}}\n",
         "give levels names"),
    ],
)  # fmt: skip
def test_broken_files_give_a_clear_message(library: Path, text: str, words: str) -> None:
    assert any(words in message for message in problems(library, text))


def test_a_missing_set_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(SetError, match=r"none\.yaml: saw No such file"):
        load_set(tmp_path / "none.yaml")

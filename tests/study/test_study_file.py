# SPDX-License-Identifier: MIT
"""Study files and stimulus directories: every mistake at once, its line, what is allowed."""

from __future__ import annotations

import json
import random
from itertools import pairwise
from pathlib import Path

import pytest
from study_tools import STUDY, build_stimuli, write_study

import verisim.study
from verisim.study.problems import StudyError
from verisim.study.server import check_study
from verisim.study.server.questions import QUESTION_KINDS, Question
from verisim.study.server.questions.answer import Answer, Percept
from verisim.study.server.samplers.units import Unit, mix, separate, single
from verisim.study.server.stimulus_set import Stimulus, load_stimulus_set
from verisim.study.server.study_file import load_study

STUDIES = Path(verisim.study.__file__).parent / "studies"


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


def test_the_studies_of_the_project_are_right() -> None:
    paths = sorted(STUDIES.glob("*.yaml"))
    assert [path.name for path in paths] == [
        "collision_thresholds.yaml",
        "realism_ratings.yaml",
        "seed_questions.yaml",
        "which_is_real.yaml",
    ]
    for path in paths:
        assert check_study(path) == []


def test_the_seed_study_asks_the_papers_questions() -> None:
    study = load_study(STUDIES / "seed_questions.yaml")
    assert [(q.key, q.kind) for q in study.questions] == [
        ("collision", "rating"),
        ("rotation", "rating"),
        ("speed", "bipolar"),
        ("fun", "slider"),
        ("note", "comment"),
    ]
    assert study.contact["en"] in study.consent["en"].html
    assert "@" not in study.consent["en"].html  # no address is built in


def test_every_mistake_is_reported_at_once_with_its_line(tmp_path: Path) -> None:
    text = (
        STUDY.replace("schema: 1", "schema: 2")
        .replace("points: 7", "points: 70")
        .replace("points: 5", "points: 4")
        .replace("kind: slider", "kind: dial")
        .replace("max_chars: 50", "max_char: 50")
        .replace("rest_every: 3", "rest_every: true")
        .replace("sampler: random", "sampler: magic")
        .replace("primary: realism", "primary: note")
        .replace("consent: consent.md", "consent: missing.md")
        + "colour: blue\n"
    )
    path = write_study(tmp_path, text)
    problems = [str(problem) for problem in check_study(path)]
    for part, words in (
        ("schema: 2", "schema: 2 is not allowed; allowed: 1"),
        ("points: 70", "questions[0].points: 70 is not allowed; allowed: a whole number from 2"),
        ("points: 4", "questions[1].points: 4 is not allowed; allowed: 3 | 5 | 7 | 9 | 11"),
        ("kind: dial", "questions[2].kind: 'dial' is not allowed; allowed: rating | bipolar"),
        ("max_char: 50", "questions[3].max_char: unknown key; allowed: kind, key, prompt"),
        ("rest_every: true", "trial.rest_every: true is not allowed"),
        ("sampler: magic", "order.sampler: 'magic' is not allowed; allowed: random"),
        ("primary: note", "analysis.primary: 'note' is not allowed; allowed: realism | speed"),
        ("consent: missing.md", "cannot be read: No such file"),
        ("colour: blue", "colour: unknown key; allowed: schema, name"),
    ):
        where = f"{path}:{line_of(text, part)}: "
        found = [p for p in problems if p.startswith(where) and words in p]
        assert len(found) == 1 and "\n  hint: " in found[0], (words, problems)
    assert len(problems) == 10


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: [1", "not YAML"),
        ("a: 1\na: 2", "a: written twice"),
        ("- 1", "is not a mapping"),
        ("", "name: missing"),
        ("a: &x [*x]", "nested deeper"),
        ("a: !!python/object:os.system {}", "the tag tag:yaml.org,2002:python/object:os.system"),
    ],
)
def test_files_that_are_no_study_are_refused_plainly(tmp_path: Path, text: str, words: str) -> None:
    path = write_study(tmp_path, text)
    assert any(words in str(problem) for problem in check_study(path)), check_study(path)


def test_a_study_in_two_languages_needs_every_text_twice(tmp_path: Path) -> None:
    path = write_study(tmp_path, STUDY.replace("[en]", "[en, no]"))
    messages = "\n".join(str(problem) for problem in check_study(path))
    assert "questions[0].prompt.no: missing" in messages
    assert "consent: 'consent.md' is not a mapping" in messages


def test_a_consent_text_needs_a_version_and_known_words(tmp_path: Path) -> None:
    path = write_study(tmp_path)
    (tmp_path / "consent.md").write_text("Hello {nobody}\n")
    assert "unknown {nobody}; allowed: {title}, {contact}, {data_note}" in str(check_study(path)[0])
    (tmp_path / "consent.md").write_text("Hello\n")
    assert "has no line `Version:" in str(check_study(path)[0])


def all_questions() -> list[Question]:
    return load_study(STUDIES / "seed_questions.yaml").questions


def test_every_kind_accepts_what_its_scripted_rater_answers() -> None:
    rng = random.Random(1)
    questions = example_questions()
    assert {question.kind for question in questions} == set(QUESTION_KINDS)
    for question in questions:
        for i in range(200):
            quality = i / 199
            qualities = (quality, rng.random()) if question.kind == "choice" else (quality,)
            percept = Percept(qualities, (rng.random() < 0.5,), 2000.0)
            answers = question.simulate(percept, rng)
            assert question.find_faults(answers) == [], (question.key, answers)
        for language in question.prompt:
            assert question.meaning(language) and json.dumps(question.page_fields(language))


def example_questions() -> list[Question]:
    """Every question of the example studies; together they use every kind."""
    studies = ("realism_ratings", "collision_thresholds", "which_is_real")
    return [
        question
        for name in studies
        for study in [load_study(STUDIES / f"{name}.yaml")]
        for question in [*study.questions, *study.end_questions]
    ] + [q for q in all_questions() if q.kind == "slider"]


@pytest.mark.parametrize("value", [0, 8, 3.5, -1, None, 1e9])
def test_a_rating_takes_only_its_points(value: float | None) -> None:
    for question in all_questions()[:3]:
        assert question.find_fault(Answer(value, None)) is not None


def make_clip(name: str, scene: str, role: str = "test") -> Unit:
    return single(
        Stimulus(
            name, scene, role, "seed", 1, "", name, "0" * 64, 1, 1, 1, 30.0, 1, 1.0, "", {}, {}
        )
    )


def test_no_scene_follows_itself_where_that_is_possible() -> None:
    clips = [
        make_clip(f"{scene}{i}", scene) for scene, n in ("a5", "b3", "c2") for i in range(int(n))
    ]
    for seed in range(200):
        ordered = separate(clips, random.Random(seed))
        assert sorted(c.name for c in ordered) == sorted(c.name for c in clips)
        assert all(x.scene != y.scene for x, y in pairwise(ordered)), seed
    # 9 against 1 cannot be separated; all are shown all the same.
    lopsided = [make_clip(str(i), "a") for i in range(9)] + [make_clip("b", "b")]
    assert len(separate(lopsided, random.Random(1))) == 10


def test_catch_clips_are_mixed_in_and_never_first() -> None:
    tests = [make_clip(f"t{i}", "s") for i in range(6)]
    catches = [make_clip(f"c{i}", "s", "catch") for i in range(3)]
    places = set()
    for seed in range(100):
        roles = [unit.kind for unit in mix(tests, catches, random.Random(seed))]
        assert roles.count("catch") == 3 and roles[0] == "test"
        assert "catch catch" not in " ".join(roles)
        places.add(roles.index("catch"))
    assert len(places) > 3


@pytest.fixture
def broken_set(tmp_path: Path) -> Path:
    build_stimuli(tmp_path / "mini")
    return tmp_path / "mini"


def test_a_stimulus_directory_is_verified_clip_by_clip(broken_set: Path) -> None:
    clips = sorted((broken_set / "clips").glob("*.mp4"))
    clips[0].write_bytes(clips[0].read_bytes() + b"x")
    clips[1].unlink()
    clips[2].with_suffix(".json").write_text("{")
    sidecar = json.loads(clips[3].with_suffix(".json").read_text())
    clips[3].with_suffix(".json").write_text(json.dumps({**sidecar, "video_sha256": "f" * 64}))
    manifest = broken_set / "manifest.csv"
    text = manifest.read_text().replace(",practice,", ",warmup,").replace("clips/van", "../van")
    manifest.write_text(text)
    with pytest.raises(StudyError) as caught:
        load_stimulus_set(broken_set)
    message = str(caught.value)
    for words in (
        "has sha256",
        "does not exist",
        "cannot be read",
        "describes another video",
        "role: 'warmup' is not allowed; allowed: test | practice | catch",
        "lies outside the directory",
    ):
        assert words in message, message
    assert message.count("manifest.csv:") >= 6 and "hint:" in message


def test_a_missing_stimulus_directory_names_the_command_that_makes_it(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="verisim stimuli build"):
        load_stimulus_set(tmp_path / "none")

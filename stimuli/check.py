# SPDX-License-Identifier: MIT
"""Everything that is wrong with a stimulus set and its scenes, before anything runs."""

from __future__ import annotations

from pathlib import Path

from verisim.stimuli.expand import Stimulus, expand
from verisim.stimuli.problems import Problem, SetError
from verisim.stimuli.set_file import StimulusSet, load_set


def check_set(file: Path | str) -> list[Problem]:
    """Every problem of the set file and, when that is sound, of each scene at each level."""
    try:
        stimulus_set = load_set(file)
    except SetError as error:
        return error.problems
    return scene_problems(stimulus_set, expand(stimulus_set))


def scene_problems(stimulus_set: StimulusSet, stimuli: list[Stimulus]) -> list[Problem]:
    """What the engine's loader has against the scenes; each message once, with the first
    stimulus that meets it."""
    from verisim import engine

    problems: list[Problem] = []
    seen: set[str] = set()
    for stimulus in stimuli:
        try:
            scene = engine.load_scene(stimulus.scene_file, stimulus.overrides)
        except (engine.SceneError, engine.PoseLogError, engine.MeshError) as error:
            message = str(error)
        else:
            if scene.name == stimulus.scene:
                continue
            message = (
                f"{stimulus.scene_file}: name: saw {scene.name}; allowed: {stimulus.scene}\n"
                "  hint: a scene has the name of its file, so that clips are named after it"
            )
        if message not in seen:
            seen.add(message)
            where = f"{stimulus_set.file}: {stimulus.id}"
            problems.append(Problem(where, "", "", "a scene that loads", message))
    return problems

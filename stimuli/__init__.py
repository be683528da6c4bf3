# SPDX-License-Identifier: MIT
"""Stimulus sets: from one YAML file to clips with known physics, known error and known cost."""

from verisim.stimuli.build import BuildResult, build_set
from verisim.stimuli.check import check_set
from verisim.stimuli.cost import measure_cost
from verisim.stimuli.expand import Stimulus, expand
from verisim.stimuli.problems import Problem, SetError, StimuliError
from verisim.stimuli.set_file import StimulusSet, load_set

__all__ = [
    "BuildResult",
    "Problem",
    "SetError",
    "StimuliError",
    "Stimulus",
    "StimulusSet",
    "build_set",
    "check_set",
    "expand",
    "load_set",
    "measure_cost",
]

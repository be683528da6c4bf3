# SPDX-License-Identifier: MIT
"""What a bench scene is: a scene file or its generator, its errors, and how it is posed."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from verisim.bench.chart.trial import Measure, Scene
from verisim.bench.files import write_whole

FOLDER = Path(__file__).parent.parent / "scenes"


@dataclass(frozen=True)
class BenchScene:
    """A scene of the chart; the first measure is the one that fronts are drawn of."""

    key: str
    title: str
    about: str
    measures: tuple[Measure, ...]
    make: Callable[[], Scene] | None = None  # None: scenes/KEY.yaml
    meshes: Mapping[str, str] = field(default_factory=dict)  # of a made scene, by file name
    settings: Mapping[str, Mapping[str, float | str]] = field(default_factory=dict)  # by method
    not_posed: Mapping[str, str] = field(default_factory=dict)  # method -> why
    warm_up_s: float = 0  # simulated before costs count
    is_dear: bool = False  # seconds a run: quick rungs alone, even in a full bench
    quick_duration_s: float | None = None

    def write(self, folder: Path) -> Path:
        """The scene file: the committed one, or the generated one in `folder`."""
        if self.make is None:
            return FOLDER / f"{self.key}.yaml"
        scene = json.dumps(self.make(), indent=1) + "\n"  # YAML too
        for name, text in {f"{self.key}.yaml": scene, **self.meshes}.items():
            file = folder / name
            if not file.is_file() or file.read_text("utf-8") != text:
                write_whole(file, text)
        return folder / f"{self.key}.yaml"

    @property
    def needs_reference(self) -> bool:
        return any(measure.is_own for measure in self.measures)

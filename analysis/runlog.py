# SPDX-License-Identifier: MIT
"""What an analysis was made from and with, so that it can be made again. Holds no times."""

from __future__ import annotations

import hashlib
import platform
from importlib import metadata
from typing import TYPE_CHECKING

from verisim.analysis.agreement import NUM_DRAWS, SEED
from verisim.analysis.scores import CONFIDENCE

if TYPE_CHECKING:
    from verisim.analysis.report import Findings

PACKAGES = ("verisim", "numpy", "pandas", "scipy", "matplotlib", "jinja2")


def run_log(found: Findings) -> dict[str, object]:
    """Versions, seed, sha256 of every input file, and row counts."""
    files = found.export.sha256
    lines = "".join(f"{sha}  {name}\n" for name, sha in files.items())
    return {
        "study": found.export.study,
        "source": found.source,
        "sections": list(found.sections),
        "versions": {"python": platform.python_version()}
        | {name: _version(name) for name in PACKAGES},
        "seed": SEED,
        "bootstrap_draws": NUM_DRAWS,
        "confidence": CONFIDENCE,
        "input_sha256": hashlib.sha256(lines.encode()).hexdigest(),
        "files_sha256": files,
        "rows": {name: len(table) for name, table in sorted(found.export.tables.items())},
        "num_analysed": len(found.cohort.analysed),
        "num_flagged": len(found.cohort.flagged),
        "tables": sorted(name for name, table in found.tables.items() if len(table)),
        "messages": found.messages,
    }


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed as a package"

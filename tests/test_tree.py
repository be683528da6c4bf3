# SPDX-License-Identifier: MIT
"""The arrows between folders hold, and documents name files that exist."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# Folder -> folders of engine/ it may include.
CPP_ARROWS = {
    "shape": {"shape"},
    "dem": {"dem"},
    "scene": {"scene", "dem", "shape"},
    "render": {"render", "dem"},
    "clip": {"clip", "scene", "dem", "shape", "render"},
    "view": {"view", "clip", "scene", "dem", "shape", "render"},
    "python": {"python", "view", "clip", "scene", "dem", "shape", "render"},
}
# Folder -> parts of the verisim package it may import.
PYTHON_ARROWS = {
    "study": {"study"},
    "analysis": {"analysis"},
    "stimuli": {"stimuli", "engine", "_engine", "clip", "pose_log"},
    "engine/bench": {"bench", "engine", "stimuli", "analysis"},
}


@pytest.mark.parametrize("folder", CPP_ARROWS)
def test_cpp_folders_include_only_what_the_arrows_allow(folder: str) -> None:
    for file in sorted((ROOT / "engine" / folder).glob("*.[hc]*")):
        for included in re.findall(r'#include "(\w+)/', file.read_text("utf-8")):
            assert included in CPP_ARROWS[folder], f"{file} includes {included}/"


@pytest.mark.parametrize("folder", ["dem", "scene", "shape"])
def test_physics_folders_know_nothing_of_pictures(folder: str) -> None:
    for file in sorted((ROOT / "engine" / folder).glob("*.[hc]*")):
        text = file.read_text("utf-8")
        assert not re.search(r"#include <(glm|GL|GLFW|libav)", text), file
        if folder == "dem":
            for header in re.findall(r"#include <(\w+)/", text):
                assert header == "Eigen", f"{file} includes {header}"


def _imports(file: Path) -> set[str]:
    modules: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            modules |= {f"{node.module}.{alias.name}" for alias in node.names}
    return modules


@pytest.mark.parametrize("folder", PYTHON_ARROWS)
def test_python_folders_import_only_what_the_arrows_allow(folder: str) -> None:
    files = [f for f in (ROOT / folder).rglob("*.py") if "node_modules" not in f.parts]
    assert files
    for file in files:
        for module in _imports(file):
            if module.startswith("verisim."):
                part = module.split(".")[1]
                if part == "__version__":
                    continue
                assert part in PYTHON_ARROWS[folder], f"{file} imports {module}"


def test_bench_takes_from_analysis_only_how_figures_look() -> None:
    for file in (ROOT / "engine/bench").rglob("*.py"):
        for module in _imports(file):
            if module.startswith("verisim.analysis"):
                assert module == "verisim.analysis.style", f"{file} imports {module}"


SOURCES = sorted(
    file
    for pattern in ("*.cpp", "*.h", "*.py", "*.ts")
    for file in ROOT.rglob(pattern)
    if not {"build", "out", ".venv", "node_modules", "dist"} & set(file.relative_to(ROOT).parts)
)


def test_every_source_file_names_its_licence() -> None:
    missing = [str(f) for f in SOURCES if "SPDX-License-Identifier: MIT" not in f.read_text()[:400]]
    assert not missing


DOCUMENTS = [
    file
    for file in ROOT.rglob("*.md")
    if not {"build", "out", ".venv", "node_modules"} & set(file.relative_to(ROOT).parts)
]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda f: str(f.relative_to(ROOT)))
def test_documents_link_only_to_files_that_exist(document: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", document.read_text("utf-8")):
        assert (document.parent / target).exists(), f"{document} links to {target}"


def test_lock_files_hold_no_download_addresses() -> None:
    for file in (".ci/requirements.txt", "study/web/package-lock.json"):
        assert "://" not in re.sub(r'"url": "[^"]*"', "", (ROOT / file).read_text("utf-8")), file


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text("utf-8").splitlines()) <= 150

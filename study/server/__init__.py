# SPDX-License-Identifier: MIT
"""The study server: shows clips, asks, and stores every answer before it says so."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verisim.study.server.browser_raters import simulate_in_browser
    from verisim.study.server.erasure import erase_participant
    from verisim.study.server.run_server import serve
    from verisim.study.server.scripted_raters import simulate
    from verisim.study.server.study_file import check_study

__all__ = ["check_study", "erase_participant", "serve", "simulate", "simulate_in_browser"]

# Loaded on first use: checking a study file should not wait for a web server's libraries.
_HOMES = {
    "check_study": "study_file",
    "erase_participant": "erasure",
    "serve": "run_server",
    "simulate": "scripted_raters",
    "simulate_in_browser": "browser_raters",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)

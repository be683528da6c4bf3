# SPDX-License-Identifier: MIT
"""Accessibility findings of axe on a page as it is."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Page
from study_site import WEB

AXE = WEB / "node_modules" / "axe-core" / "axe.min.js"


def findings(page: Page) -> list[str]:
    """Critical and serious findings."""
    page.evaluate(AXE.read_text())
    # The busy and progress bars move; colours are judged once they stand still.
    report: dict[str, Any] = page.evaluate("axe.run(document)")
    return [
        f"{it['id']}: {node['html']}"
        for it in report["violations"]
        if it["impact"] in ("critical", "serious")
        for node in it["nodes"]
    ]

# SPDX-License-Identifier: MIT
"""What a piece of work answers once it is committed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Reply:
    status: int
    body: dict[str, Any]


STORED = Reply(201, {"stored": True, "duplicate": False})
DUPLICATE = Reply(200, {"stored": True, "duplicate": True})

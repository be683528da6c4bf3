# SPDX-License-Identifier: MIT
"""An error that is told to the page: status, code, message, hint."""

from __future__ import annotations

from typing import Any


class ApiError(Exception):
    """A refused request."""

    def __init__(self, status: int, code: str, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.status = status
        self.code = code
        self.message = message
        self.hint = hint

    def body(self) -> dict[str, Any]:
        return {"error": {"code": self.code, "message": self.message, "hint": self.hint}}

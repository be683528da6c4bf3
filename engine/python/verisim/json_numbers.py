# SPDX-License-Identifier: MIT
"""Numbers as JSON can hold them: a run that blew up has infinities, JSON has not."""

from __future__ import annotations

import math
from typing import Any


def finite_numbers(value: Any) -> Any:
    """The value with every number that is not finite replaced by None: JSON has none."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite_numbers(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite_numbers(item) for item in value]
    return value

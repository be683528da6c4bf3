# SPDX-License-Identifier: MIT
"""JSON as it is stored: keys sorted, no NaN, words as they are."""

from __future__ import annotations

import json
from typing import Any


def to_json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, sort_keys=True, allow_nan=False)

# SPDX-License-Identifier: MIT
"""Hides which clip is which: names become codes, so that an analysis can be settled beforehand."""

from __future__ import annotations

import hashlib
import hmac
from typing import Any

from verisim.study.export.columns import BLINDED_HASHES, BLINDED_NAMES

Row = dict[str, Any]

# Besides names, hashes and levels, these give a clip away; a blind export leaves them empty.
KEPT_OF_ENGINE = ("study", "source", "stimulus", "method", "engine_version")
GIVEAWAYS = ("num_bytes", "seed", "order_seed", "order_sha256", "track", "correct")


class Blinding:
    """Codes that stay the same within a database and say nothing without its key."""

    def __init__(self, key: str) -> None:
        self._key = key.encode()

    def code(self, column: str, value: str) -> str:
        """Returns the code of a name: the same name gets the same code in every column of clips."""
        kind = "clip" if column in ("stimulus", "stimulus_b", "reference") else column
        digest = hmac.new(self._key, f"{kind}:{value}".encode(), hashlib.sha256).hexdigest()
        return f"{kind.removeprefix('factor_')}_{digest[:10]}"

    def hide(self, table: str, rows: list[Row]) -> list[Row]:
        return [self._hide_row(table, row) for row in rows]

    def _hide_row(self, table: str, row: Row) -> Row:
        hidden = dict(row)
        for column, value in row.items():
            is_name = column in BLINDED_NAMES or column.startswith("factor_")
            if value and is_name:
                hidden[column] = self.code(column, str(value))
            elif (
                column in BLINDED_HASHES
                or column in GIVEAWAYS
                or (table == "engine" and column not in KEPT_OF_ENGINE)
            ):
                hidden[column] = None
        return hidden

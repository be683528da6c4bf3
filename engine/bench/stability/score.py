# SPDX-License-Identifier: MIT
"""How good the predictions are, beside a predictor that knows nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields

from verisim.bench.stability.cells import HOLDS
from verisim.bench.stability.tables import Cell, RunLog, is_right


@dataclass(frozen=True)
class Score:
    """Counts of a map, or of all."""

    map: str
    method: str
    cells: int
    right: int  # outcome is one of those predicted
    near: int  # cells beside one with another prediction (up to eight neighbours)
    near_right: int
    slack_right: int  # right, or as predicted for a neighbour
    holds_right: int  # holding or failing is as predicted, whichever failure
    trivial: int  # right if the map's most frequent outcome were predicted everywhere
    failed: int  # cells whose outcome is not ok

    @property
    def share(self) -> float:
        return self.right / self.cells


SCORE_COLUMNS = tuple(field.name for field in fields(Score))
COUNTS = SCORE_COLUMNS[2:]


def score_cells(cells: Sequence[Cell], log: RunLog) -> list[Score]:
    """A score for each map, and the sum of all last: its trivial predictor knows each map's most
    frequent outcome, which makes it a strong one."""
    groups: dict[str, list[Cell]] = {}
    for cell in cells:
        groups.setdefault(cell.of.name, []).append(cell)
    scores = [_score(group, log) for group in groups.values()]
    sums = {name: sum(getattr(score, name) for score in scores) for name in COUNTS}
    return [*scores, Score("all", "all", **sums)]


def _score(cells: Sequence[Cell], log: RunLog) -> Score:
    found = {(cell.x, cell.y): log.rows[cell.inputs_sha256]["outcome"] for cell in cells}
    at = {(cell.x, cell.y): cell for cell in cells}
    xs, ys = sorted({x for x, _ in at}), sorted({y for _, y in at})
    near = near_right = slack = 0
    for cell in cells:
        around = [
            at[x, y]
            for x in _beside(xs, cell.x)
            for y in _beside(ys, cell.y)
            if (x, y) != (cell.x, cell.y)
        ]
        if any(other.prediction.codes != cell.prediction.codes for other in around):
            near += 1
            near_right += is_right(cell, log)
        allowed = {code for each in [cell, *around] for code in each.prediction.codes}
        slack += found[cell.x, cell.y] in allowed
    return Score(
        map=cells[0].of.key,
        method=cells[0].of.method,
        cells=len(cells),
        right=sum(is_right(cell, log) for cell in cells),
        near=near,
        near_right=near_right,
        slack_right=slack,
        holds_right=sum(
            (found[cell.x, cell.y] == HOLDS) == (HOLDS in cell.prediction.codes) for cell in cells
        ),
        trivial=Counter(found.values()).most_common(1)[0][1],
        failed=sum(code != HOLDS for code in found.values()),
    )


def _beside(values: list[float], value: float) -> list[float]:
    index = values.index(value)
    return values[max(0, index - 1) : index + 2]


def percent(part: float, whole: float) -> str:
    """A share for people; – where there is nothing to share."""
    return f"{100 * part / whole:.1f} %" if whole else "–"

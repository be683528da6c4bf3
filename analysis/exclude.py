# SPDX-License-Identifier: MIT
"""Counts who took part and who is flagged; flags only split the analysis, nothing is deleted."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from verisim.analysis.load import Export

ALL = "all"
UNFLAGGED = "without flagged"


@dataclass(frozen=True)
class Step:
    """One stage of the flow: how many reached it, and where the others went."""

    name: str
    count: int
    lost: str = ""


@dataclass(frozen=True)
class Cohort:
    """Who is analysed. analysed includes flagged; unflagged leaves them out."""

    analysed: frozenset[str]
    flagged: frozenset[str]

    @property
    def unflagged(self) -> frozenset[str]:
        return self.analysed - self.flagged

    def sets(self) -> dict[str, frozenset[str]]:
        """The participant sets that every result is given for."""
        return {ALL: self.analysed} | ({UNFLAGGED: self.unflagged} if self.flagged else {})


def choose_cohort(export: Export) -> Cohort:
    """Participants who completed and answered at least one test clip, with their flags."""
    people, ratings = export.tables["participants"], export.tables["ratings"]
    completed = set(people.loc[people["state"] == "completed", "participant_id"])
    is_answer = ratings["value"].notna() | (ratings["value_text"] != "")
    answered = ratings[(ratings["trial_kind"] == "test") & is_answer]
    analysed = frozenset(completed & set(answered["participant_id"]))
    rules = export.tables["exclusions"]
    flagged = frozenset(rules.loc[rules["flagged"] == 1, "participant_id"])
    return Cohort(analysed, flagged & analysed)


def participant_flow(export: Export, cohort: Cohort) -> list[Step]:
    """Enrolled → consented → completed → analysed → analysed without flagged."""
    people = export.tables["participants"]
    state = people["state"]
    consented = people["consented_utc"].ne("") | state.isin(
        ["consented", "active", "completed", "stopped", "screened_out"]
    )
    completed = int((state == "completed").sum())
    declined = int((state == "declined").sum())
    unfinished = int((consented & state.isin(["consented", "active"])).sum())
    stopped = int((consented & (state == "stopped")).sum())
    screened_out = int((consented & (state == "screened_out")).sum())
    withdrawn = int((consented & (state == "withdrawn")).sum())
    waiting = len(people) - int(consented.sum()) - declined
    return [
        Step("enrolled", len(people)),
        Step(
            "consented",
            int(consented.sum()),
            _parts([(declined, "declined"), (waiting, "left before answering")]),
        ),
        Step(
            "completed",
            completed,
            _parts(
                [
                    (unfinished, "unfinished"),
                    (stopped, "stopped early"),
                    (screened_out, "screen did not fit"),
                    (withdrawn, "withdrew"),
                ]
            ),
        ),
        Step(
            "analysed",
            len(cohort.analysed),
            _parts([(completed - len(cohort.analysed), "without an answer to a test clip")]),
        ),
        Step("without flagged", len(cohort.unflagged), _parts([(len(cohort.flagged), "flagged")])),
    ]


def presentation_flow(export: Export, cohort: Cohort) -> list[Step]:
    """Planned → shown → seen to the end → answered → of test clips → analysed."""
    people, shown = export.tables["participants"], export.tables["presentations"]
    answered_ids = set(export.tables["ratings"]["presentation_id"])
    answered_ids |= set(export.tables["comments"]["presentation_id"])
    ended = shown[shown["completed"] == 1]
    answered = shown[shown["presentation_id"].isin(answered_ids)]
    test = answered[answered["trial_kind"] == "test"]
    analysed = test[test["participant_id"].isin(cohort.analysed)]
    other = answered["trial_kind"].value_counts()
    kinds = [(int(other.get(kind, 0)), kind) for kind in ("practice", "catch", "repeat")]
    broken = len(shown) - len(ended)
    return [
        Step("planned", int(people["num_trials_planned"].sum())),
        Step("shown", len(shown)),
        Step("seen to the end", len(ended), _parts([(broken, "broken off")])),
        Step("answered", len(answered)),
        Step("test clips", len(test), _parts(kinds)),
        Step(
            "analysed",
            len(analysed),
            _parts([(len(test) - len(analysed), "of people who did not complete")]),
        ),
    ]


def flag_table(export: Export, cohort: Cohort) -> pd.DataFrame:
    """Per rule: its limit, how many analysed participants it flags, and who."""
    rules = export.tables["exclusions"]
    rules = rules[rules["participant_id"].isin(cohort.analysed)]
    rows = []
    for rule, group in rules.groupby("rule", sort=True):
        flagged = sorted(group.loc[group["flagged"] == 1, "participant_id"])
        rows.append(
            {
                "rule": rule,
                "limit": " / ".join(sorted(set(group["limit"]))),
                "num_checked": group["participant_id"].nunique(),
                "num_flagged": len(flagged),
                "flagged_participants": " ".join(flagged),
            }
        )
    return pd.DataFrame(rows, columns=list(FLAG_COLUMNS))


FLAG_COLUMNS = ("rule", "limit", "num_checked", "num_flagged", "flagged_participants")


def _parts(parts: list[tuple[int, str]]) -> str:
    return ", ".join(f"{count} {name}" for count, name in parts if count > 0)

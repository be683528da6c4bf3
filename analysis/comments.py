# SPDX-License-Identifier: MIT
"""Lists what people wrote beside what they answered, and counts plain words and themes."""

from __future__ import annotations

import re
from collections import Counter

import pandas as pd

from verisim.analysis.load import Export

# Themes a realism study meets again and again, found by the start of a word. They count how
# often a word family occurs, not what was meant: "did not sink" counts as sinking.
THEMES = {
    "sinking": ("sink", "sank", "sunk", "penetrat", "through", "overlap", "inside"),
    "floating": ("float", "hover", "weightless", "levitat"),
    "bouncing": ("bounc", "rebound", "spring", "rubber"),
    "jitter": ("jitter", "shak", "trembl", "vibrat", "wobbl", "twitch"),
    "slow": ("slow", "sluggish", "lag"),
    "fast": ("fast", "quick", "sudden", "abrupt", "jump"),
    "rotation": ("spin", "rotat", "turn", "tumbl", "roll"),
    "sliding": ("slid", "slip", "glid", "friction"),
}
STOP_WORDS = frozenset(
    """a about after all also an and any are as at be been but by can could did do does for from had
    has have he her his how i if in into is it its just like looked looks me more my no not of off
    on or out over seem seemed seems she so some that the their them then there these they this to
    too up very was way we were what when which while who with would you your""".split()  # noqa: SIM905
)
REDACTED = "[redacted]"  # what the export says where a researcher took the words out
WORD = re.compile(r"[^\W\d_]+(?:['’][^\W\d_]+)?")


def comment_rows(export: Export, participants: frozenset[str]) -> pd.DataFrame:
    """One row per comment on a test clip, with that person's answers to the same showing."""
    rows = export.tables["comments"]
    rows = rows[
        rows["participant_id"].isin(participants)
        & (rows["trial_kind"] == "test")
        & ~rows["comment"].str.strip().isin(["", REDACTED])
    ]
    columns = ["stimulus", "participant_id", "presentation_id", "question", "comment"]
    rows = rows[columns].sort_values(columns, kind="stable")
    ratings = export.tables["ratings"]
    ratings = ratings[ratings["value"].notna()]
    # A question with several items has no single answer to stand beside a comment.
    whole = ratings[ratings["item"] == ""]
    answers = whole.pivot(index="presentation_id", columns="question", values="value")
    answers = answers.reindex(columns=list(export.questions)).add_prefix("rating_")
    return rows.merge(answers.reset_index(), on="presentation_id", how="left")


def theme_counts(comments: pd.DataFrame) -> pd.DataFrame:
    """Per clip and theme: how many comments use a word of that family. Themes never met are out."""
    rows = []
    for stimulus, group in comments.groupby("stimulus", sort=True):
        words = [_words(text) for text in group["comment"]]
        for theme, starts in THEMES.items():
            count = sum(any(word.startswith(starts) for word in text) for text in words)
            if count:
                rows.append([stimulus, theme, count, len(group)])
    return pd.DataFrame(rows, columns=["stimulus", "theme", "num_comments", "of_comments"])


def word_counts(comments: pd.DataFrame, limit: int = 30) -> pd.DataFrame:
    """The words used in most comments, each comment counted once; ties by alphabet."""
    counter: Counter[str] = Counter()
    for text in comments["comment"]:
        counter.update({word for word in _words(text) if word not in STOP_WORDS and len(word) > 2})
    common = sorted(counter.items(), key=lambda item: (-item[1], item[0]))[:limit]
    return pd.DataFrame(common, columns=["word", "num_comments"])


def _words(text: str) -> list[str]:
    return [word.casefold() for word in WORD.findall(text)]

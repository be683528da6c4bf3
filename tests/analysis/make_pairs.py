# SPDX-License-Identifier: MIT
"""Makes export trees of studies that show two clips at a time, by the rules of `verisim export`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from make_export import Row, Tree, make_tree

CHOICE = {"key": "which", "kind": "choice", "min": 1, "max": 2, "prompt": "Which one is real?"}
LAYOUTS = ("sequential", "side_by_side")
Answer = tuple[str, str, str, str, float | None]  # person, layout, first clip, second, choice


def make_pair_tree(answers: Sequence[Answer], *, clips: Sequence[str] = ()) -> Tree:
    """The sound export, its ratings replaced by these choices; None: not sure.

    clips: of one scene, `scene/level`; the last one is the reference of the others. Default: those
    of make_export.
    """
    people = sorted({person for person, *_ in answers})
    tree = make_tree(len(people))
    tree.description["questions"] = [CHOICE]
    tree.description["study"]["analysis"]["primary"] = "which"
    records = dict(zip(people, tree.tables["participants"], strict=True))
    if clips:
        some, engine = dict(tree.tables["stimuli"][0]), dict(tree.tables["engine"][0])
        tree.tables["stimuli"] = [
            some | {"stimulus": clip, "scene": "s", "sha256": f"{k:064x}",
                    "content_key": f"{k:064x}", "factor_stiffness": clip,
                    "reference": "" if clip == clips[-1] else clips[-1]}
            for k, clip in enumerate(clips)
        ]  # fmt: skip
        tree.tables["engine"] = [engine | {"stimulus": clip} for clip in clips]
    stimuli = {row["stimulus"]: row for row in tree.tables["stimuli"]}
    for table in ("ratings", "presentations", "comments"):
        tree.tables[table] = []
    for index, (person, layout, first, second, choice) in enumerate(answers):
        who = records[person]
        shown: Row = {
            "study": "mini", "participant_id": who["participant_id"], "source": who["source"],
            "session_id": f"S-{who['participant_id']}", "presentation_id": f"pair-{index}",
            "trial_index": index, "trial_kind": "test", "block": "main", "layout": layout,
            "stimulus": first, "stimulus_sha256": stimuli[first]["sha256"],
            "stimulus_b": second, "stimulus_b_sha256": stimuli[second]["sha256"],
        }  # fmt: skip
        tree.tables["presentations"].append(
            shown | {"completed": 1, "num_plays": 1, "frames_total": 180, "frames_dropped": 0,
                     "stall_count": 0, "stall_ms": 0, "hidden_ms": 0}
        )  # fmt: skip
        tree.tables["ratings"].append(
            shown | {
                "scene": stimuli[first]["scene"], "method": "seed", "question": "which",
                "question_kind": "choice", "value": "" if choice is None else choice,
                "value_text": "not_sure" if choice is None else "", "rt_ms": 900,
                "factor_stiffness": stimuli[first]["factor_stiffness"],
                "rt_origin": "video_end", "num_plays": 1,
                "answered_utc": "2026-03-01T09:00:00Z",
            }
        )  # fmt: skip
    return tree


def answers_of_people(
    num: int, pairs: Sequence[tuple[str, str]], d_prime: float, lean: float = 0.0, seed: int = 1
) -> list[Answer]:
    """People who see the reference d_prime stronger and lean towards the second clip.

    pairs: (clip, reference), each seen once by everybody; sides and layouts take turns.
    """
    rng = np.random.default_rng(seed)
    answers: list[Answer] = []
    for person in range(num):
        for k, (clip, reference) in enumerate(pairs):
            is_first = (person + k) % 2 == 0
            feels = rng.normal(0, 1, 2) + (np.array([d_prime, 0]) if is_first else [0, d_prime])
            choice = 1.0 if feels[0] - feels[1] > lean * np.sqrt(2) else 2.0
            shown = (reference, clip) if is_first else (clip, reference)
            layout = LAYOUTS[(person // 2 + k) % 2]
            answers.append((f"p{person:03d}", layout, *shown, choice))
    return answers

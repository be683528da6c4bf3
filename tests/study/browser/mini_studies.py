# SPDX-License-Identifier: MIT
"""Mini studies that each show some part of what the page can do."""

from __future__ import annotations

from study_site import STUDY

HEAD = STUDY[: STUDY.index("trial:")]
TAIL = STUDY[STUDY.index("order:") :]

ALL_KINDS = (
    HEAD
    + """\
trial: {layout: single, replays: 1, fixation_ms: [50, 100], grey_ms: 50, rest_every: 2}
questions:
  - {key: realism, kind: rating, points: 7, prompt: {en: How real was it?}, ends: {en: [not, very]}}
  - key: smooth
    kind: rating
    points: 3
    prompt: {en: How smooth?}
    ends: {en: [bad, good]}
    labels: {en: [bad, fair, good]}
  - {key: speed, kind: bipolar, points: 5, prompt: {en: How fast was it?},
     ends: {en: [too slow, too fast]}, middle: {en: just right}}
  - {key: natural, kind: slider, prompt: {en: How natural?}, ends: {en: [not, very]}}
  - {key: possible, kind: yes_no, prompt: {en: Could it happen?}}
  - {key: moved, kind: category, prompt: {en: What moved?},
     options: {thing: {en: a thing}, animal: {en: an animal}, other: {en: something else}}}
  - {key: laws, kind: checklist, prompt: {en: Which rules held?},
     items: {gravity: {en: Things fall}, solid: {en: Things stay apart}}}
  - {key: fun, kind: fun}
  - {key: feel, kind: emotion, points: 5, items: {calm: {en: calm}, uneasy: {en: uneasy}}}
  - {key: sure, kind: confidence, points: 4}
  - {key: when, kind: mark, max_marks: 2, prompt: {en: When did it look wrong?}}
  - {key: why, kind: comment, max_chars: 200, prompt: {en: Why?}, ask: {if: possible == 0}}
"""
    + TAIL
)

PAIRS = (
    HEAD
    + """\
trial: {layout: [sequential, side_by_side], replays: 1, fixation_ms: [50, 60], gap_ms: 300}
questions:
  - {key: which, kind: choice, not_sure: true, prompt: {en: Which one is real?}}
  - {key: sure, kind: confidence, points: 3}
order: {sampler: random, seed: 7, pairs: {with: all}}
analysis: {primary: which}
"""
)

SCREENED = """\
trial: {layout: single, replays: 0, fixation_ms: [50, 60], rest_every: 0}
SCREENquestions:
  - {key: realism, kind: rating, points: 7, prompt: {en: How real was it?}, ends: {en: [not, very]}}
completion: {screened_out: {code: OUT1, return_url: "https://example.org/out?cc={code}"}}
"""


STRICT_SCREEN = """\
screen:
  phone: refuse
  min_viewport_px: [1000, 600]
  refresh: RULE
  fullscreen: FULLSCREEN
  calibration: require
  distance_mm: [300, 600, 1500]
  px_per_degree: [20, 60]
"""
ROOM_ONLY = "screen: {refresh: ignore, codec: false, fullscreen: off}\n"


def with_screen(refresh: str = "flag", fullscreen: str = "off", rules: str = STRICT_SCREEN) -> str:
    screen = rules.replace("RULE", refresh).replace("FULLSCREEN", fullscreen)
    return HEAD + SCREENED.replace("SCREEN", screen) + TAIL


IN_TWO_LANGUAGES = """\
schema: 1
name: mini
title: Bewegt es sich wie echt?
contact: nobody@example.org
set: mini
languages: [en, de]
consent: {en: consent.md, de: consent.md}
instructions: {en: instructions.md, de: instructions.md}
thanks: {en: thanks.md, de: thanks.md}
trial: {layout: single, replays: 0, fixation_ms: [50, 60], rest_every: 2, rest_min_s: 1}
questions:
  - {key: possible, kind: yes_no, prompt: {en: Could it happen?, de: Ist das möglich?}}
end_questions:
  - {key: trouble, kind: yes_no, prompt: {en: Any trouble?, de: Gab es Probleme?}}
  - {key: how, kind: comment, prompt: {en: How did you decide?, de: Wie entschieden Sie?}}
practice: {feedback: true, question: possible, answers: {clip_0: 1}}
completion:
  code: DONE7
  return_url: "https://example.org/back?cc={code}"
  partial: {code: PART3, from_share: 0}
order: {sampler: random, seed: 7}
analysis: {primary: possible}
"""

# SPDX-License-Identifier: MIT
"""The registry of question kinds: add a file with a kind and name it here."""

from verisim.study.server.questions.bipolar import BipolarQuestion
from verisim.study.server.questions.comment import CommentQuestion
from verisim.study.server.questions.question import Question
from verisim.study.server.questions.rating import RatingQuestion
from verisim.study.server.questions.slider import SliderQuestion

QUESTION_KINDS: dict[str, type[Question]] = {
    kind.kind: kind for kind in (RatingQuestion, BipolarQuestion, SliderQuestion, CommentQuestion)
}

__all__ = ["QUESTION_KINDS", "Question"]

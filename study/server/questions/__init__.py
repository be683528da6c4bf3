# SPDX-License-Identifier: MIT
"""The registry of question kinds: add a file with a kind and name it here."""

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.bipolar import BipolarQuestion
from verisim.study.server.questions.category import CategoryQuestion
from verisim.study.server.questions.checklist import ChecklistQuestion
from verisim.study.server.questions.choice import ChoiceQuestion
from verisim.study.server.questions.comment import CommentQuestion
from verisim.study.server.questions.emotion import EmotionQuestion
from verisim.study.server.questions.mark import MarkQuestion
from verisim.study.server.questions.points import ConfidenceQuestion, FunQuestion, RatingQuestion
from verisim.study.server.questions.question import Question
from verisim.study.server.questions.slider import SliderQuestion
from verisim.study.server.questions.yes_no import YesNoQuestion

QUESTION_KINDS: dict[str, type[Question]] = {
    kind.kind: kind
    for kind in (
        RatingQuestion,
        BipolarQuestion,
        SliderQuestion,
        YesNoQuestion,
        ChoiceQuestion,
        CategoryQuestion,
        ChecklistQuestion,
        FunQuestion,
        EmotionQuestion,
        ConfidenceQuestion,
        CommentQuestion,
        MarkQuestion,
    )
}

__all__ = ["QUESTION_KINDS", "Answer", "Percept", "Question", "Scale"]

# SPDX-License-Identifier: MIT
"""Which questions a trial asks, and whether a set of answers to them can be stored."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from verisim.study.server.api_error import ApiError
from verisim.study.server.bodies import Response
from verisim.study.server.questions import Answer, Question
from verisim.study.server.questions.ask import Condition

Asked = list[tuple[Question, Condition | None]]


def questions_of_trial(questions: Sequence[Question], seed: str, trial_index: int) -> Asked:
    """Returns what a trial may ask and under which conditions; the participant's seed decides."""
    asked: Asked = []
    for question in questions:
        may_ask, condition = question.ask.draw(f"{seed}:{trial_index}:{question.key}")
        if may_ask:
            asked.append((question, condition))
    return asked


def check_answers(asked: Asked, responses: Iterable[Response]) -> None:
    """Refuses unknown, repeated, missing, hidden and impossible answers; all faults at once."""
    by_key = {question.key: question for question, _ in asked}
    faults: list[str] = []
    given: dict[tuple[str, str], Answer] = {}
    for response in responses:
        place = (response.question, response.item)
        if response.question not in by_key:
            known = ", ".join(by_key) or "nothing"
            faults.append(f"{response.question}: unknown here; asked: {known}")
        elif place in given:
            faults.append(f"{name_of(*place)}: answered twice")
        given.setdefault(place, Answer(response.value, response.value_text))
    answered = {place: answer for place, answer in given.items() if not answer.is_skipped}
    for question, condition in asked:
        own = {item: answer for (key, item), answer in answered.items() if key == question.key}
        if condition is not None and not condition.holds(answered):
            if own:
                faults.append(f"{question.key}: is not asked after these answers")
            continue
        faults.extend(f"{question.key}: {fault}" for fault in question.find_faults(own))
    if faults:
        raise invalid("responses", "; ".join(faults))


def name_of(question: str, item: str) -> str:
    return f"{question}.{item}" if item else question


def invalid(where: str, message: str) -> ApiError:
    return ApiError(422, "invalid", f"{where}: {message}", "correct the body")

// SPDX-License-Identifier: MIT
// Short free text with a limit and a counter.
import { type MakeField, frame, make } from "./field";

// Control characters and halves of a pair, which only pasting brings, and which no table can hold.
const UNWANTED = /(?![\n\t])\p{Cc}|\p{Surrogate}/gu;

export const makeComment: MakeField = (question, { texts, newTiming, onChange }) => {
  const timing = newTiming();
  const max_chars = question.max_chars ?? 500;
  const { element, prompt, side } = frame(question, texts);
  const area = make("textarea");
  area.id = `answer-${question.key}`;
  area.rows = 2;
  area.maxLength = max_chars;
  area.setAttribute("aria-labelledby", prompt.id);
  const counter = make("p", "counter");
  counter.id = `counter-${question.key}`;
  area.setAttribute("aria-describedby", counter.id);
  side.append(area, counter);

  const count = (): void => {
    counter.textContent = texts.charsLeft(max_chars - area.value.length);
  };
  area.addEventListener("input", () => {
    timing.typed();
    count();
    onChange();
  });
  // Coming back to a finished text and editing it is one change.
  let num_visits = 0;
  area.addEventListener("change", () => {
    timing.num_changes = num_visits;
    num_visits += 1;
  });
  count();

  const text = (): string => area.value.replace(UNWANTED, "").trim();
  return {
    question,
    element,
    answers: () => (text() ? [{ item: "", value: null, value_text: text(), timing }] : []),
    isAnswered: () => text() !== "",
    focus: () => area.focus(),
    takeDigit: () => null,
  };
};

// SPDX-License-Identifier: MIT
// Short free text with a limit and a counter.
import { type Answer, type MakeField, make } from "./field";

// Control characters and halves of a pair, which only pasting brings, and which no table can hold.
const UNWANTED = /(?![\n\t])\p{Cc}|\p{Surrogate}/gu;

export const makeComment: MakeField = (question, { texts, timing, onChange }) => {
  const max_chars = question.max_chars ?? 500;
  const element = make("div", "question comment");
  const side = make("div", "answer");
  const label = make("label", "prompt", question.prompt);
  const area = make("textarea");
  area.id = `answer-${question.key}`;
  area.rows = 2;
  area.maxLength = max_chars;
  label.htmlFor = area.id;
  if (question.optional) label.append(" ", make("span", "optional", texts.optional));
  const counter = make("p", "counter");
  counter.id = `counter-${question.key}`;
  area.setAttribute("aria-describedby", counter.id);
  side.append(area, counter);
  element.append(label, side);

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

  return {
    question,
    element,
    timing,
    answer(): Answer | null {
      const text = area.value.replace(UNWANTED, "").trim();
      return text ? { value: null, value_text: text } : null;
    },
    focus: () => area.focus(),
    takeDigit: () => false,
  };
};

// SPDX-License-Identifier: MIT
// Several items, each with the same row of choices: the per-law checklist and the emotion scales.
import { type Answer, type FieldContext, type MakeField, frame, make } from "./field";
import type { Question } from "./contract";
import { choiceOf } from "./question_options";
import { type RadioChoice, type RadioGroup, radioGroup } from "./radio_group";

/** Each law is kept, violated, or cannot be told. */
export const makeChecklist: MakeField = (question, context) =>
  makeGrid(question, context, (question.states ?? []).map(choiceOf), []);

/** Each feeling on the same points between two named ends. */
export const makeEmotion: MakeField = (question, context) => {
  const points = question.points ?? 5;
  const [low, high] = question.ends ?? ["", ""];
  const choices = Array.from({ length: points }, (_, i) => ({
    value: i + 1,
    value_text: null,
    name: context.texts.pointName(i + 1, points, i === 0 ? low : i === points - 1 ? high : ""),
    face: String(i + 1),
  }));
  return makeGrid(question, context, choices, [low, high]);
};

function makeGrid(question: Question, context: FieldContext, choices: RadioChoice[], ends: string[]) {
  const { element, prompt, side } = frame(question, context.texts);
  const grid = make("div", "grid");
  const groups: RadioGroup[] = (question.items ?? []).map((item) => {
    const row = make("div", "grid-row");
    const name = make("p", "grid-item", item.label);
    name.id = `item-${question.key}-${item.key}`;
    const points = make("div", "points");
    points.style.setProperty("--points", String(choices.length));
    const named_by = `${prompt.id} ${name.id}`;
    const group = radioGroup(points, `answer-${question.key}-${item.key}`, named_by, item.key, choices, context);
    points.append(...group.labels);
    row.append(name, points);
    grid.append(row);
    return group;
  });
  if (ends.length) {
    const head = make("div", "grid-row grid-ends");
    const words = make("div", "ends");
    words.append(...ends.map((end) => make("span", "", end)));
    head.append(make("span"), words);
    head.setAttribute("aria-hidden", "true");
    grid.prepend(head);
  }
  side.append(grid);

  const open = (): RadioGroup | undefined => groups.find((group) => group.answer() === null);
  const holding = (): RadioGroup | undefined =>
    groups.find((group) => group.labels.some((label) => label.contains(document.activeElement)));
  return {
    question,
    element,
    answers: (): Answer[] => groups.flatMap((group) => group.answer() ?? []),
    isAnswered: () => open() === undefined,
    focus: () => (open() ?? groups[0])?.focus(),
    // Keys walk down the rows: each answers the row that has the focus, or the first open one.
    takeDigit(digit: number) {
      const group = holding() ?? open();
      if (!group || digit < 1 || digit > choices.length || choices.length > 9) return null;
      group.choose(digit - 1);
      const next = open();
      next?.focus();
      return next ? ("more" as const) : ("done" as const);
    },
  };
}

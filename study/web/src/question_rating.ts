// SPDX-License-Identifier: MIT
// Rating on n points with labelled ends: one radio group; the number keys answer it.
import type { Question } from "./contract";
import { type Field, type MakeField, endLabels, frame, make } from "./field";
import { radioGroup } from "./radio_group";

/** A row of points 1..n between two named ends; the middle, or every point, may have a name as well. */
export const makeRating: MakeField = (question, context) => {
  const points = question.points ?? 7;
  const [low, high] = question.ends ?? ["", ""];
  const names = pointNames(question, points);
  const { element, prompt, side } = frame(question, context.texts);
  const row = make("div", "points");
  row.style.setProperty("--points", String(points));
  const choices = names.map((name, i) => ({
    value: i + 1,
    value_text: null,
    name: context.texts.pointName(i + 1, points, name),
    face: String(i + 1),
  }));
  const group = radioGroup(row, `answer-${question.key}`, prompt.id, "", choices, context);
  row.append(...group.labels);
  const middle = points % 2 ? (names[(points - 1) / 2] ?? "") : "";
  const named = names.filter(Boolean).length;
  side.append(row, named > (middle ? 3 : 2) ? everyLabel(names) : endLabels(low, middle || null, high));
  return groupField(question, element, group, points);
};

/** A field whose answer is one choice of one group. */
export function groupField(
  question: Question,
  element: HTMLElement,
  group: ReturnType<typeof radioGroup>,
  num_choices: number,
): Field {
  return {
    question,
    element,
    answers: () => [group.answer() ?? []].flat(),
    isAnswered: () => group.answer() !== null,
    focus: () => group.focus(),
    takeDigit(digit) {
      if (digit < 1 || digit > num_choices || num_choices > 9) return null; // from ten on a digit is ambiguous
      group.choose(digit - 1);
      return "done";
    },
  };
}

/** The name of each point, empty where it has none. */
function pointNames({ ends, labels }: Question, points: number): string[] {
  const names = Array.from({ length: points }, (_, i) => labels?.[i] ?? "");
  names[0] ||= ends?.[0] ?? "";
  names[points - 1] ||= ends?.[1] ?? "";
  return names;
}

/** A name under every point. */
function everyLabel(names: string[]): HTMLElement {
  const row = make("div", "ends every");
  row.style.setProperty("--points", String(names.length));
  row.setAttribute("aria-hidden", "true");
  row.append(...names.map((name) => make("span", "", name)));
  return row;
}


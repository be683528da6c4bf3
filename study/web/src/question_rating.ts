// SPDX-License-Identifier: MIT
// Rating on n points with labelled ends: one radio group; the number keys answer it.
import type { Question } from "./contract";
import { type Answer, type Field, type FieldContext, type MakeField, endLabels, make } from "./field";

export const makeRating: MakeField = (question, context) => makePoints(question, context, null);

/** A row of radio buttons 1..points; `middle` names the middle one. */
export function makePoints(
  question: Question,
  { texts, timing, onChange }: FieldContext,
  middle: string | null,
): Field {
  const points = question.points ?? 7;
  const [low, high] = question.ends ?? ["", ""];
  const element = make("div", `question ${question.kind}`);
  const prompt = make("p", "prompt", question.prompt);
  prompt.id = `prompt-${question.key}`;
  const side = make("div", "answer");
  const row = make("div", "points");
  row.style.setProperty("--points", String(points));
  const inputs: HTMLInputElement[] = [];
  for (let point = 1; point <= points; point += 1) {
    const end = point === 1 ? low : point === points ? high : "";
    const name = 2 * point === points + 1 && middle ? middle : end;
    const input = make("input");
    input.type = "radio";
    input.name = `answer-${question.key}`;
    input.value = String(point);
    input.setAttribute("aria-label", texts.pointName(point, points, name));
    input.addEventListener("change", () => {
      timing.answered();
      onChange();
    });
    const label = make("label", "point");
    label.append(input, make("span", "point-number", String(point)));
    inputs.push(input);
    row.append(label);
  }
  row.addEventListener("pointerdown", () => timing.touched());
  row.setAttribute("role", "radiogroup");
  row.setAttribute("aria-labelledby", prompt.id);
  side.append(row, endLabels(low, middle, high));
  element.append(prompt, side);


  const chosen = (): HTMLInputElement | undefined => inputs.find((input) => input.checked);
  return {
    question,
    element,
    timing,
    answer(): Answer | null {
      const input = chosen();
      return input ? { value: Number(input.value), value_text: null } : null;
    },
    focus: () => (chosen() ?? inputs[0])?.focus(),
    takeDigit(digit) {
      const input = inputs[digit - 1];
      if (!input || points > 9) return false; // with ten points and more a digit is ambiguous
      if (!input.checked) input.click();
      return true;
    },
  };
}

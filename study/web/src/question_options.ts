// SPDX-License-Identifier: MIT
// One of a few named answers: yes or no, a category, one clip of a pair. All options look alike; none is chosen.
import type { Option } from "./contract";
import { type FieldContext, type MakeField, frame, make } from "./field";
import { groupField } from "./question_rating";
import { type RadioChoice, radioGroup } from "./radio_group";

export const makeOptions: MakeField = (question, context) => {
  const options = Array.isArray(question.options) ? question.options : [];
  const ordered = context.is_reversed ? [...options].reverse() : options;
  const { element, prompt, side } = frame(question, context.texts);
  const row = make("div", ordered.length > 3 ? "options many" : "options");
  const group = radioGroup(row, `answer-${question.key}`, prompt.id, "", ordered.map(choiceOf), context);
  row.append(...group.labels);
  side.append(row);
  return groupField(question, element, group, ordered.length);
};

/** Which clip of a pair: the options lie as the clips lay, "not sure" between them. */
export const makeChoice: MakeField = (question, context: FieldContext) => {
  const by_layout = Array.isArray(question.options) ? {} : (question.options ?? {});
  const [first, second] = by_layout[context.layout] ?? [];
  const ordered = [first, question.not_sure, second].flatMap((option) => option ?? []);
  const { element, prompt, side } = frame(question, context.texts);
  const row = make("div", "options pair");
  const group = radioGroup(row, `answer-${question.key}`, prompt.id, "", ordered.map(choiceOf), context);
  row.append(...group.labels);
  side.append(row);
  const field = groupField(question, element, group, ordered.length);
  // 1 and 2 are the clips, 0 is "not sure", wherever they lie.
  field.takeDigit = (digit) => {
    if (digit > 2 || (digit === 0 && !question.not_sure)) return null;
    group.choose(digit === 0 ? 1 : digit === 1 ? 0 : ordered.length - 1);
    return "done";
  };
  return field;
};

export function choiceOf({ value, value_text, label }: Option): RadioChoice {
  return { value: value ?? null, value_text: value_text ?? null, name: label, face: label };
}

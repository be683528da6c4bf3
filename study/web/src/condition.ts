// SPDX-License-Identifier: MIT
// Whether a question that depends on another answer is to be asked.
import type { Condition } from "./contract";
import type { Answer } from "./field";

/** True while an answer exists and passes the test; a text is compared with the answer's word. */
export function holds(condition: Condition, answers: Answer[]): boolean {
  const answer = answers.find(({ item }) => item === condition.item);
  if (!answer) return false;
  const { value, value_text } = answer;
  if (typeof condition.value === "string") {
    return (value_text === condition.value) === (condition.op === "==");
  }
  if (value === null) return false;
  switch (condition.op) {
    case "<=": return value <= condition.value;
    case "<": return value < condition.value;
    case ">=": return value >= condition.value;
    case ">": return value > condition.value;
    case "==": return value === condition.value;
    case "!=": return value !== condition.value;
  }
}

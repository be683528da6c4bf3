// SPDX-License-Identifier: MIT
// What every question on the page can do, and the timing of its answer.
import type { Question } from "./contract";
import type { Texts } from "./texts";

export interface Answer {
  value: number | null;
  value_text: string | null;
}

/** Time is counted from the end of the clip's first full play. */
export class AnswerTiming {
  first_touch_ms: number | null = null;
  rt_ms: number | null = null;
  /** Changes of the answer after it was first given. */
  num_changes = 0;

  constructor(private readonly sinceClipEnd: () => number) {}

  touched(): void {
    this.first_touch_ms ??= this.sinceClipEnd();
  }

  answered(): void {
    this.touched();
    if (this.rt_ms !== null) this.num_changes += 1;
    this.rt_ms = this.sinceClipEnd();
  }

  /** Text grows letter by letter: the last one tells the time, but no letter is a change of mind. */
  typed(): void {
    this.touched();
    this.rt_ms = this.sinceClipEnd();
  }
}

export interface Field {
  readonly question: Question;
  readonly element: HTMLElement;
  readonly timing: AnswerTiming;
  /** null: not answered. */
  answer(): Answer | null;
  focus(): void;
  /** Answers by a number key; false where the key means nothing here. */
  takeDigit(digit: number): boolean;
}

export interface FieldContext {
  texts: Texts;
  timing: AnswerTiming;
  onChange: () => void;
}

export type MakeField = (question: Question, context: FieldContext) => Field;

/** Short form for building the page: make("p", "hint", "text"). */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  class_name = "",
  text = "",
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (class_name) element.className = class_name;
  if (text) element.textContent = text;
  return element;
}

/** The labels under a scale: ends, and the middle where it has one. The controls carry them for screen readers. */
export function endLabels(low: string, middle: string | null, high: string): HTMLElement {
  const row = make("div", middle === null ? "ends" : "ends three");
  row.setAttribute("aria-hidden", "true");
  row.append(make("span", "", low));
  if (middle !== null) row.append(make("span", "", middle));
  row.append(make("span", "", high));
  return row;
}

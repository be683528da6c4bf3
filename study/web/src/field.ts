// SPDX-License-Identifier: MIT
// What every question on the page can do, and the timing of its answer.
import type { Layout, Question } from "./contract";
import type { Texts } from "./texts";

/** Time is counted from the end of the clip's first full play, on forms without a clip from when the form appeared. */
export class AnswerTiming {
  first_touch_ms: number | null = null;
  rt_ms: number | null = null;
  /** Changes of the answer after it was first given. */
  num_changes = 0;

  constructor(private readonly sinceOrigin: () => number) {}

  touched(): void {
    this.first_touch_ms ??= this.sinceOrigin();
  }

  answered(): void {
    this.touched();
    if (this.rt_ms !== null) this.num_changes += 1;
    this.rt_ms = this.sinceOrigin();
  }

  /** Text grows letter by letter: the last one tells the time, but no letter is a change of mind. */
  typed(): void {
    this.touched();
    this.rt_ms = this.sinceOrigin();
  }
}

export interface Answer {
  /** Empty, or which item of the question this answers. */
  item: string;
  value: number | null;
  value_text: string | null;
  timing: AnswerTiming;
}

export interface Field {
  readonly question: Question;
  readonly element: HTMLElement;
  /** Given so far; a question with several items has one answer for each. */
  answers(): Answer[];
  /** True when nothing is missing. */
  isAnswered(): boolean;
  /** To the first control that wants an answer. */
  focus(): void;
  /** Answers by a number key; "more" where the question still wants something, null where the key means nothing here. */
  takeDigit(digit: number): "done" | "more" | null;
}

export interface FieldContext {
  texts: Texts;
  newTiming: () => AnswerTiming;
  onChange: () => void;
  layout: Layout;
  /** Options are drawn from last to first. */
  is_reversed: boolean;
  /** Shows the clip until the participant pauses it; the time in the clip (ms), null where they saw nothing. */
  watchForMark: (num: number) => Promise<number | null>;
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

/** The parts of every question: its words, and the place of its answer. */
export function frame(question: Question, texts: Texts): { element: HTMLElement; prompt: HTMLElement; side: HTMLElement } {
  const element = make("div", `question ${question.kind}`);
  const prompt = make("p", "prompt", question.prompt);
  prompt.id = `prompt-${question.key}`;
  if (question.optional) prompt.append(" ", make("span", "optional", texts.optional));
  const side = make("div", "answer");
  element.append(prompt, side);
  return { element, prompt, side };
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

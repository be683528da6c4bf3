// SPDX-License-Identifier: MIT
// The questions of one trial on one page: keys, missing answers, watching again, and the answers as records.
import type { Question, ResponseRecord } from "./contract";
import { AnswerTiming, type Field, make } from "./field";
import { MAKE_FIELD } from "./questions";
import type { Texts } from "./texts";

export interface FormEvents {
  onSubmit: (responses: ResponseRecord[]) => void;
  onWatchAgain: () => void;
}

export class QuestionForm {
  readonly element = make("form", "card questions");
  private readonly fields: Field[];
  private readonly warnings = new Map<Field, HTMLElement>();
  private readonly heading: HTMLElement;
  private readonly again = make("button", "button");
  private readonly submit = make("button", "button primary");
  private readonly status = make("p", "status");
  private is_sent = false;

  constructor(
    questions: Question[],
    private readonly texts: Texts,
    sinceClipEnd: () => number,
    private readonly events: FormEvents,
  ) {
    this.heading = make("h1", "visually-hidden", texts.questions_title);
    this.heading.tabIndex = -1;
    this.element.noValidate = true;
    this.element.append(this.heading);
    // Many questions stand beside their answers, so that all fit on one screen.
    this.element.classList.toggle("is-long", questions.length > 2);
    this.fields = questions.map((question) => {
      const field = MAKE_FIELD[question.kind](question, {
        texts,
        timing: new AnswerTiming(sinceClipEnd),
        onChange: () => this.warn(field, false),
      });
      this.addField(field);
      return field;
    });
    this.again.type = "button";
    this.again.addEventListener("click", events.onWatchAgain);
    this.submit.textContent = texts.next;
    this.status.setAttribute("role", "status");
    const row = make("div", "buttons");
    if (this.fields.some((field) => field.question.points)) row.append(make("p", "keys-hint", texts.keysHint));
    row.append(this.again, this.submit);
    this.element.append(row, this.status);
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
  }

  /** Shows how often the clip may still be watched again. */
  setReplaysLeft(num_left: number): void {
    this.again.hidden = num_left === 0;
    this.again.textContent = num_left === 1 ? this.texts.watch_again : this.texts.watchAgainLeft(num_left);
  }

  /** Puts the form in charge of the keyboard; `signal` ends that. */
  listen(signal: AbortSignal): void {
    document.addEventListener("keydown", (event) => this.onKey(event), { signal });
  }

  focus(): void {
    this.heading.focus({ preventScroll: true });
  }

  showSaving(is_saving: boolean): void {
    this.is_sent = is_saving;
    this.element.classList.toggle("is-saving", is_saving);
    this.status.textContent = is_saving ? this.texts.saving : "";
  }

  showProblem(text: string): void {
    this.showSaving(false);
    this.status.textContent = text;
  }

  private addField(field: Field): void {
    const warning = make("p", "missing", this.texts.missing);
    warning.hidden = true;
    warning.setAttribute("role", "alert");
    this.warnings.set(field, warning);
    field.element.lastElementChild?.append(warning);
    this.element.append(field.element);
  }

  private warn(field: Field, is_missing: boolean): void {
    const warning = this.warnings.get(field);
    if (warning) warning.hidden = !is_missing;
    field.element.classList.toggle("is-missing", is_missing);
  }

  private send(): void {
    if (this.is_sent) return;
    const missing = this.fields.filter((field) => !field.question.optional && field.answer() === null);
    for (const field of this.fields) this.warn(field, missing.includes(field));
    if (missing[0]) {
      missing[0].focus();
      return;
    }
    this.showSaving(true);
    this.events.onSubmit(this.responses());
  }

  private responses(): ResponseRecord[] {
    return this.fields.flatMap((field) => {
      const answer = field.answer();
      if (!answer) return []; // skipped
      return [{
        question: field.question.key,
        ...answer,
        rt_ms: field.timing.rt_ms ?? 0,
        rt_origin: "video_end" as const,
        first_touch_ms: field.timing.first_touch_ms,
        num_changes: field.timing.num_changes,
      }];
    });
  }

  /** A digit answers the question that has the focus, otherwise the first one without an answer, and moves on. */
  private onKey(event: KeyboardEvent): void {
    if (!/^[0-9]$/.test(event.key) || event.ctrlKey || event.metaKey || event.altKey || this.is_sent) return;
    const focused = this.fields.find((field) => field.element.contains(event.target as Node));
    const open = this.fields.find((field) => field.question.points && field.answer() === null);
    const field = focused ?? open;
    if (!field?.takeDigit(Number(event.key))) return;
    event.preventDefault();
    if (field.question.kind === "slider") return; // a digit is only a first step there
    const next = this.fields.find((other) => !other.question.optional && other.answer() === null);
    if (next) next.focus();
    else this.submit.focus();
    (next?.element ?? this.submit).scrollIntoView({ block: "nearest" });
  }
}

// SPDX-License-Identifier: MIT
// Questions on one page: keys, questions that depend on others, missing answers, and the answers as records.
import { holds } from "./condition";
import type { Condition, Layout, Question, QuestionKind, ResponseRecord } from "./contract";
import { AnswerTiming, type Field, make } from "./field";
import { MAKE_FIELD } from "./questions";
import type { Texts } from "./texts";

export interface FormSettings {
  texts: Texts;
  title: string;
  questions: Question[];
  conditions: Record<string, Condition>;
  /** Keys of questions whose options are drawn from last to first. */
  reversed: string[];
  layout: Layout;
  /** Milliseconds since the origin of response times. */
  sinceOrigin: () => number;
  rt_origin: ResponseRecord["rt_origin"];
  /** From the clip's onset to that origin; null where there was no clip. */
  onset_to_origin_ms: number | null;
  watchForMark?: (num: number) => Promise<number | null>;
  onSubmit: (responses: ResponseRecord[]) => void;
  onWatchAgain?: () => void;
}

/** Kinds that number keys do not answer in one stroke. */
const NO_DIGITS: QuestionKind[] = ["slider", "comment", "mark"];

export class QuestionForm {
  readonly element = make("form", "card questions");
  private readonly fields: Field[];
  private readonly warnings = new Map<Field, HTMLElement>();
  private readonly heading: HTMLElement;
  private readonly again = make("button", "button");
  private readonly submit = make("button", "button primary");
  private readonly status = make("p", "status");
  private readonly texts: Texts;
  private is_sent = false;

  constructor(private readonly settings: FormSettings) {
    const { texts, questions } = settings;
    this.texts = texts;
    this.heading = make("h1", "visually-hidden", settings.title);
    this.heading.tabIndex = -1;
    this.element.noValidate = true;
    // The pointer may lie on an answer by chance: nothing lights up under it before it moves.
    this.element.classList.add("is-fresh");
    this.element.addEventListener("pointermove", (event) => {
      if (event.movementX || event.movementY) this.element.classList.remove("is-fresh");
    });
    this.element.append(this.heading);
    // Many questions stand beside their answers, so that all fit on one screen.
    this.element.classList.toggle("is-long", questions.length > 2);
    this.fields = questions.map((question) => this.addField(question));
    this.showWhatIsAsked();
    this.again.type = "button";
    this.again.hidden = true;
    this.again.addEventListener("click", () => settings.onWatchAgain?.());
    this.submit.textContent = texts.next;
    this.status.setAttribute("role", "status");
    const row = make("div", "buttons");
    if (this.fields.some(({ question }) => !NO_DIGITS.includes(question.kind))) {
      row.append(make("p", "keys-hint", texts.keysHint));
    }
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

  showProblem(text: string): void {
    this.showSaving(false);
    this.status.textContent = text;
  }

  private showSaving(is_saving: boolean): void {
    this.is_sent = is_saving;
    this.element.classList.toggle("is-saving", is_saving);
    this.status.textContent = is_saving ? this.texts.saving : "";
  }

  private addField(question: Question): Field {
    const { texts, layout, reversed, sinceOrigin } = this.settings;
    const field = MAKE_FIELD[question.kind](question, {
      texts,
      layout,
      is_reversed: reversed.includes(question.key),
      newTiming: () => new AnswerTiming(sinceOrigin),
      watchForMark: this.settings.watchForMark ?? (() => Promise.resolve(null)),
      onChange: () => {
        this.warn(field, false);
        this.showWhatIsAsked();
      },
    });
    const warning = make("p", "missing", texts.missing);
    warning.hidden = true;
    warning.setAttribute("role", "alert");
    this.warnings.set(field, warning);
    field.element.lastElementChild?.append(warning);
    const place = make("div", "question-place");
    if (question.key in this.settings.conditions) place.setAttribute("aria-live", "polite");
    place.append(field.element);
    this.element.append(place);
    return field;
  }

  /** Questions that are asked as things stand, in order. A question can depend on one that is itself not asked. */
  private asked(): Field[] {
    const asked: Field[] = [];
    for (const field of this.fields) {
      const condition = this.settings.conditions[field.question.key];
      const decider = condition && asked.find(({ question }) => question.key === condition.question);
      if (!condition || (decider && holds(condition, decider.answers()))) asked.push(field);
    }
    return asked;
  }

  private showWhatIsAsked(): void {
    if (!this.fields) return; // while the fields are being made
    const asked = this.asked();
    for (const field of this.fields) field.element.hidden = !asked.includes(field);
  }

  private warn(field: Field, is_missing: boolean): void {
    const warning = this.warnings.get(field);
    if (warning) warning.hidden = !is_missing;
    field.element.classList.toggle("is-missing", is_missing);
  }

  private send(): void {
    if (this.is_sent) return;
    const missing = this.asked().filter((field) => !field.question.optional && !field.isAnswered());
    for (const field of this.fields) this.warn(field, missing.includes(field));
    if (missing[0]) {
      missing[0].focus();
      return;
    }
    this.showSaving(true);
    this.settings.onSubmit(this.responses());
  }

  private responses(): ResponseRecord[] {
    const { rt_origin, onset_to_origin_ms, reversed } = this.settings;
    return this.asked().flatMap(({ question, answers }) =>
      answers().map(({ item, value, value_text, timing }) => ({
        question: question.key,
        item,
        value,
        value_text,
        rt_ms: timing.rt_ms ?? 0,
        rt_onset_ms: onset_to_origin_ms === null ? null : (timing.rt_ms ?? 0) + onset_to_origin_ms,
        rt_origin,
        first_touch_ms: timing.first_touch_ms,
        num_changes: timing.num_changes,
        reversed: reversed.includes(question.key),
      })),
    );
  }

  /** A digit answers the question that has the focus, otherwise the first one without an answer, and moves on. */
  private onKey(event: KeyboardEvent): void {
    if (!/^[0-9]$/.test(event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.is_sent || this.element.inert || document.querySelector("dialog[open]")) return;
    const asked = this.asked();
    const focused = asked.find((field) => field.element.contains(event.target as Node));
    const open = asked.find((field) => !field.isAnswered() && !NO_DIGITS.includes(field.question.kind));
    const taken = (focused ?? open)?.takeDigit(Number(event.key));
    if (!taken) return;
    event.preventDefault();
    if (taken === "more") return;
    const next = this.asked().find((field) => !field.question.optional && !field.isAnswered());
    if (next) next.focus();
    else this.submit.focus();
    (next?.element ?? this.submit).scrollIntoView({ block: "nearest" });
  }
}

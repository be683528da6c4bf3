// SPDX-License-Identifier: MIT
// "Pause where it looked wrong": the clip plays again and the participant stops it; each stop is one mark.
import { type Answer, type AnswerTiming, type MakeField, frame, make } from "./field";

interface Mark {
  time_ms: number;
  timing: AnswerTiming;
}

export const makeMark: MakeField = (question, { texts, newTiming, onChange, watchForMark }) => {
  const max_marks = question.max_marks ?? 1;
  const { element, prompt, side } = frame(question, texts);
  const marks: Mark[] = [];
  let none_timing: AnswerTiming | null = null;
  let num_removed = 0;

  const watch = make("button", "button", texts.mark_start);
  const none = make("button", "button", question.none_label || texts.mark_none);
  const list = make("ul", "marks");
  for (const button of [watch, none]) button.type = "button";
  none.setAttribute("aria-pressed", "false");
  list.setAttribute("aria-live", "polite");
  list.setAttribute("aria-labelledby", prompt.id);
  const row = make("div", "mark-buttons");
  row.append(watch, none);
  side.append(row, list);

  const show = (): void => {
    watch.textContent = marks.length ? texts.mark_more : texts.mark_start;
    watch.disabled = marks.length >= max_marks;
    none.hidden = marks.length > 0;
    none.setAttribute("aria-pressed", String(none_timing !== null));
    list.hidden = marks.length === 0;
    list.replaceChildren(...marks.map((mark, i) => {
      const entry = make("li");
      const remove = make("button", "quiet", texts.mark_remove);
      remove.type = "button";
      remove.setAttribute("aria-label", `${texts.mark_remove}: ${texts.markAt(mark.time_ms)}`);
      remove.addEventListener("click", () => {
        marks.splice(i, 1);
        num_removed += 1;
        show();
        onChange();
        watch.focus();
      });
      entry.append(make("span", "", texts.markAt(mark.time_ms)), remove);
      return entry;
    }));
  };
  watch.addEventListener("click", () => {
    const timing = newTiming();
    timing.touched();
    void watchForMark(marks.length + 1).then((time_ms) => {
      if (time_ms === null) return watch.focus();
      timing.answered();
      none_timing = null;
      marks.push({ time_ms, timing });
      show();
      onChange();
      (watch.disabled ? list.querySelector("button") : watch)?.focus();
    });
  });
  none.addEventListener("click", () => {
    if (none_timing) none_timing = null;
    else {
      none_timing = newTiming();
      none_timing.answered();
    }
    show();
    onChange();
  });
  show();

  return {
    question,
    element,
    answers(): Answer[] {
      if (none_timing) return [{ item: "", value: null, value_text: "none", timing: none_timing }];
      return marks.map(({ time_ms, timing }, i) => {
        timing.num_changes = num_removed;
        return { item: `m${i + 1}`, value: time_ms, value_text: null, timing };
      });
    },
    isAnswered: () => marks.length > 0 || none_timing !== null,
    focus: () => watch.focus(),
    takeDigit: () => null,
  };
};

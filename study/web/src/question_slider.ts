// SPDX-License-Identifier: MIT
// Slider without a thumb until the first click or key, so that no start value suggests an answer.
import { type MakeField, endLabels, frame, make } from "./field";

export const makeSlider: MakeField = (question, { texts, newTiming, onChange }) => {
  const timing = newTiming();
  const min = question.min ?? 0;
  const max = question.max ?? 100;
  const step = question.step ?? 1;
  const [low, high] = question.ends ?? ["", ""];
  let value: number | null = null;

  const { element, prompt, side } = frame(question, texts);
  const track = make("div", "track");
  const line = make("span", "track-line");
  const thumb = make("span", "thumb");
  thumb.hidden = true;
  line.append(thumb);
  track.append(line);
  track.tabIndex = 0;
  track.setAttribute("role", "slider");
  track.setAttribute("aria-labelledby", prompt.id);
  track.setAttribute("aria-valuemin", String(min));
  track.setAttribute("aria-valuemax", String(max));
  side.append(track, endLabels(low, null, high));

  const middle = snap((min + max) / 2);
  const show = (): void => {
    // The role requires a number even where there is no answer; the text says that there is none.
    track.setAttribute("aria-valuenow", String(value ?? middle));
    const text = value === null ? texts.sliderEmpty(low, high) : texts.sliderValue(value, min, max, low, high);
    track.setAttribute("aria-valuetext", text);
    thumb.hidden = value === null;
    if (value !== null) thumb.style.left = `${(100 * (value - min)) / (max - min)}%`;
  };
  function snap(raw: number): number {
    const whole = min + Math.round((raw - min) / step) * step;
    return Number(Math.min(max, Math.max(min, whole)).toFixed(6));
  }
  const move = (raw: number): void => {
    value = snap(raw);
    show();
  };
  const settle = (): void => {
    timing.answered();
    onChange();
  };

  let before_drag: number | null = null;
  let is_dragging = false;
  const fromPointer = (event: PointerEvent): void => {
    const { left, width } = line.getBoundingClientRect();
    move(min + ((event.clientX - left) / width) * (max - min));
  };
  track.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    timing.touched();
    is_dragging = true;
    before_drag = value;
    track.setPointerCapture(event.pointerId);
    // A finger may be about to scroll the page: it counts when it moves sideways or lifts.
    if (event.pointerType !== "touch") fromPointer(event);
  });
  track.addEventListener("pointermove", (event) => {
    if (is_dragging) fromPointer(event);
  });
  track.addEventListener("pointerup", (event) => {
    if (!is_dragging) return;
    is_dragging = false;
    fromPointer(event);
    if (value !== before_drag) settle();
  });
  track.addEventListener("pointercancel", () => {
    is_dragging = false;
    value = before_drag;
    show();
  });

  const far = Math.max(step, (max - min) / 10);
  track.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const here = value;
    const wishes: Record<string, number> = {
      ArrowRight: (here ?? middle - step) + step,
      ArrowUp: (here ?? middle - step) + step,
      ArrowLeft: (here ?? middle + step) - step,
      ArrowDown: (here ?? middle + step) - step,
      PageUp: (here ?? middle - far) + far,
      PageDown: (here ?? middle + far) - far,
      Home: min,
      End: max,
    };
    const wish = wishes[event.key];
    if (wish === undefined) return;
    event.preventDefault();
    move(wish);
    if (value !== here) settle();
  });
  show();

  return {
    question,
    element,
    answers: () => (value === null ? [] : [{ item: "", value, value_text: null, timing }]),
    isAnswered: () => value !== null,
    focus: () => track.focus(),
    // 0 to 9 jump to tenths of the scale; only while the slider has the focus, see question_form.ts.
    takeDigit(digit) {
      const before = value;
      move(min + (digit / 10) * (max - min));
      if (value !== before) settle();
      return "more"; // a digit is only a first step
    },
  };
};

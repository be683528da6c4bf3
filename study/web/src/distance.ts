// SPDX-License-Identifier: MIT
// Asks how far the participant's eyes are from the screen.
import { make } from "./field";
import { focusTitle } from "./screens";
import type { Texts } from "./texts";

/** Millimetres; the limits come from the study. The field starts empty: a number that stands there would be taken over. */
export function askDistance(
  display: HTMLElement,
  texts: Texts,
  limits: { min: number; max: number },
): Promise<number> {
  return new Promise((resolve) => {
    const min_cm = Math.ceil(limits.min / 10);
    const max_cm = Math.floor(limits.max / 10);
    const form = make("form", "card message distance");
    form.noValidate = true;
    const label = make("label", "", texts.distance_label);
    const input = make("input", "number");
    input.id = "distance-cm";
    input.type = "number";
    input.inputMode = "decimal";
    input.min = String(min_cm);
    input.max = String(max_cm);
    input.step = "any";
    label.htmlFor = input.id;
    const wrong = make("p", "missing", texts.distanceWrong(min_cm, max_cm));
    wrong.id = "distance-wrong";
    wrong.setAttribute("role", "alert");
    wrong.hidden = true;
    const row = make("div", "buttons");
    row.append(make("button", "button primary", texts.carry_on));
    form.append(make("h1", "", texts.distance_title), make("p", "", texts.distance_text), label, input, wrong, row);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const distance_mm = 10 * input.valueAsNumber;
      wrong.hidden = distance_mm >= limits.min && distance_mm <= limits.max;
      if (wrong.hidden) return resolve(distance_mm);
      input.setAttribute("aria-describedby", wrong.id);
      input.focus();
    });
    display.replaceChildren(form);
    focusTitle(display);
  });
}

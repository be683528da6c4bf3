// SPDX-License-Identifier: MIT
// One row or column of radio buttons: the control behind ratings, options and grids.
import { type Answer, type FieldContext, make } from "./field";

export interface RadioChoice {
  value: number | null;
  value_text: string | null;
  /** What a screen reader says. */
  name: string;
  /** What stands on the button. */
  face: string;
}

export interface RadioGroup {
  /** One label with its radio button for each choice, to be placed by the caller. */
  readonly labels: HTMLLabelElement[];
  answer(): Answer | null;
  focus(): void;
  /** Chooses by position. */
  choose(i: number): void;
}

/** Makes the buttons inside `row`, which becomes their radio group, named by the elements in `labelled_by`. */
export function radioGroup(
  row: HTMLElement,
  name: string,
  labelled_by: string,
  item: string,
  choices: RadioChoice[],
  { newTiming, onChange }: FieldContext,
): RadioGroup {
  const timing = newTiming();
  const inputs = choices.map((choice, i) => {
    const input = make("input");
    input.type = "radio";
    input.name = name;
    input.value = choice.value_text ?? String(choice.value ?? i);
    input.setAttribute("aria-label", choice.name);
    input.addEventListener("change", () => {
      timing.answered();
      onChange();
    });
    return input;
  });
  const labels = choices.map((choice, i) => {
    const label = make("label", "point");
    label.append(inputs[i] as HTMLInputElement, make("span", "point-face", choice.face));
    return label;
  });
  row.addEventListener("pointerdown", () => timing.touched());
  row.setAttribute("role", "radiogroup");
  row.setAttribute("aria-labelledby", labelled_by);

  const chosen = (): number => inputs.findIndex((input) => input.checked);
  return {
    labels,
    answer() {
      const choice = choices[chosen()];
      return choice ? { item, value: choice.value, value_text: choice.value_text, timing } : null;
    },
    focus: () => inputs[Math.max(0, chosen())]?.focus(),
    choose(i) {
      if (!inputs[i]?.checked) inputs[i]?.click();
    },
  };
}

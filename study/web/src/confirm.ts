// SPDX-License-Identifier: MIT
// Asks once more before something that cannot be undone.
import { make } from "./field";

/** Resolves to true when the participant confirms. The way back has the focus; Escape goes back. */
export function confirmed(title: string, text: string, yes: string, no: string): Promise<boolean> {
  return new Promise((resolve) => {
    const dialog = make("dialog", "card confirm");
    const heading = make("h1", "", title);
    heading.id = "confirm-title";
    dialog.setAttribute("aria-labelledby", heading.id);
    const row = make("div", "buttons");
    const answer = (label: string, look: string, value: string): HTMLButtonElement => {
      const button = make("button", look, label);
      button.type = "button";
      button.addEventListener("click", () => dialog.close(value));
      return button;
    };
    const back = answer(no, "button primary", "no");
    row.append(answer(yes, "button", "yes"), back);
    dialog.append(heading, make("p", "", text), row);
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
    document.body.append(dialog);
    dialog.showModal();
    back.focus();
  });
}

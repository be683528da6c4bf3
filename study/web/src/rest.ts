// SPDX-License-Identifier: MIT
// The rest between blocks: at least as long as the study says, as long as the participant likes.
import { showMessage } from "./screens";
import type { Texts } from "./texts";

/** Resolves to "stop" where the participant ends here, "go" otherwise. */
export function rest(
  display: HTMLElement,
  texts: Texts,
  progress: { done: number; total: number },
  min_s: number,
  can_stop: boolean,
): Promise<"go" | "stop"> {
  return new Promise((resolve) => {
    const go = { label: texts.carry_on, is_primary: true, onPress: () => resolve("go") };
    const stop = { label: texts.stop_here, onPress: () => resolve("stop") };
    const card = showMessage(display, texts, {
      title: texts.rest_title,
      text: texts.restText(progress.done, progress.total),
      choices: can_stop ? [go, stop] : [go],
    });
    const button = card.querySelector<HTMLButtonElement>("button.primary");
    if (!button) return;
    const end_ms = performance.now() + 1000 * min_s;
    const count = (): void => {
      const left_s = Math.ceil((end_ms - performance.now()) / 1000);
      button.disabled = left_s > 0;
      button.textContent = left_s > 0 ? texts.restWait(left_s) : texts.carry_on;
      if (left_s > 0 && button.isConnected) setTimeout(count, 200);
    };
    count();
  });
}

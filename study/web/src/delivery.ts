// SPDX-License-Identifier: MIT
// Waits until the server has every answer and says what comes next, and tells the participant about the waiting.
import { RequestFailed, request } from "./api";
import { pause, waitMs } from "./back_off";
import type { Next } from "./contract";
import { downloadJson } from "./download";
import type { Outbox } from "./outbox";
import { type Message, showMessage } from "./screens";
import type { Texts } from "./texts";

const QUIET_MS = 400; // a usual answer takes some 20 ms: no screen flickers up for it

/** Calls `attempt` until it brings a result, with a waiting screen; throws what does not pass by itself. */
export async function patiently<T>(display: HTMLElement, texts: Texts, attempt: () => Promise<T>): Promise<T> {
  const quiet = setTimeout(() => showMessage(display, texts, { title: texts.loading, text: "", is_busy: true }), QUIET_MS);
  try {
    for (let num_failures = 1; ; num_failures += 1) {
      try {
        return await attempt();
      } catch (cause) {
        if (!(cause instanceof RequestFailed) || !cause.passes) throw cause;
        clearTimeout(quiet);
        if (num_failures === 1) {
          showMessage(display, texts, { title: texts.lost_title, text: texts.lost_start_text, is_busy: true });
        }
        await pause(waitMs(num_failures));
      }
    }
  } finally {
    clearTimeout(quiet);
  }
}

/** Resolves when the outbox is empty. A refused answer stays on the screen with a way to rescue it. */
export async function delivered(display: HTMLElement, texts: Texts, outbox: Outbox, onStartOver: () => void): Promise<void> {
  for (;;) {
    const stop = watchDelivery(display, texts, outbox);
    try {
      await outbox.emptied();
      return;
    } catch (cause) {
      stop();
      await showRefusal(display, texts, outbox, cause as RequestFailed, onStartOver);
    } finally {
      stop();
    }
  }
}

/** Shows "saving" and "connection lost" while the outbox works; returns the function that ends this. */
function watchDelivery(display: HTMLElement, texts: Texts, outbox: Outbox): () => void {
  let shown = "";
  const show = (name: string, message: Message): void => {
    if (shown === name) return;
    shown = name;
    showMessage(display, texts, message);
  };
  const quiet = setTimeout(() => show("saving", { title: texts.saving, text: "", is_busy: true }), QUIET_MS);
  const stop = outbox.watch((state) => {
    if (state.kind !== "waiting") return;
    clearTimeout(quiet);
    const download = { label: texts.download, onPress: () => void downloadLetters(outbox) };
    show("lost", { title: texts.lost_title, text: texts.lost_text, is_busy: true, choices: [download] });
  });
  return () => {
    clearTimeout(quiet);
    stop();
  };
}

function showRefusal(
  display: HTMLElement,
  texts: Texts,
  outbox: Outbox,
  failure: RequestFailed,
  onStartOver: () => void,
): Promise<void> {
  return new Promise((resolve) => {
    const discard = async (): Promise<void> => {
      const [refused] = await outbox.letters();
      if (refused) await outbox.discard(refused.token);
      onStartOver();
    };
    const startOver = { label: texts.start_over, onPress: () => void discard() };
    let has_copy = false;
    const show = (): void => {
      showMessage(display, texts, {
        title: texts.refused_title,
        text: texts.refused_text,
        detail: [failure.status, failure.code, failure.message, failure.hint].filter(Boolean).join(" · "),
        choices: [
          {
            label: texts.download,
            is_primary: true,
            onPress: () =>
              void downloadLetters(outbox).then(() => {
                has_copy = true;
                show();
              }),
          },
          { label: texts.try_again, onPress: () => resolve() },
          // Only a visit that the server does not know can never be delivered; and only with a copy in hand.
          ...(failure.status === 401 && has_copy ? [startOver] : []),
        ],
      });
    };
    show();
  });
}

async function downloadLetters(outbox: Outbox): Promise<void> {
  const letters = await outbox.letters();
  // The token stays on this device: the file may travel by mail.
  downloadJson("verisim-answers.json", letters.map(({ token: _, ...letter }) => letter));
}

export function fetchNext(display: HTMLElement, texts: Texts, token: string): Promise<Next> {
  return patiently(display, texts, () => request<Next>("/api/next", { token }));
}

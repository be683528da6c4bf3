// SPDX-License-Identifier: MIT
// How long to wait before a request is tried again, and what ends the wait early.

const FIRST_MS = 500;
const LONGEST_MS = 8_000; // a restarted server is found again within this time

/** Doubling waits with jitter, so that the pages of a whole lab do not come back in the same instant. */
export function waitMs(num_failures: number): number {
  const full = Math.min(LONGEST_MS, FIRST_MS * 2 ** Math.min(num_failures - 1, 10));
  return full * (0.5 + 0.5 * Math.random());
}

/** Resolves after `ms`, or as soon as the browser is online again or the page comes back into sight. */
export function pause(ms: number): Promise<void> {
  return new Promise((resolve) => {
    const finish = (): void => {
      clearTimeout(timer);
      window.removeEventListener("online", finish);
      document.removeEventListener("visibilitychange", onSight);
      resolve();
    };
    const onSight = (): void => {
      if (document.visibilityState === "visible") finish();
    };
    const timer = setTimeout(finish, ms);
    window.addEventListener("online", finish);
    document.addEventListener("visibilitychange", onSight);
  });
}

// SPDX-License-Identifier: MIT
// Plain screens: a title, some text, buttons; and the bar on top with title, progress and full screen.
import type { Study } from "./contract";
import { make } from "./field";
import type { Texts } from "./texts";

export interface Choice {
  label: string;
  is_primary?: boolean;
  onPress: (button: HTMLButtonElement) => void;
}

export interface Message {
  title: string;
  text: string;
  is_busy?: boolean;
  /** For the experimenter: shown small. */
  detail?: string;
  choices?: Choice[];
}

/** Replaces the content of `parent` by a card and moves the focus to its title, so that screen readers say it. */
export function showMessage(parent: HTMLElement, texts: Texts, message: Message): HTMLElement {
  const card = make("section", "card message");
  const title = make("h1", "", message.title);
  title.tabIndex = -1;
  if (message.is_busy) {
    card.setAttribute("role", "status");
    card.append(make("div", "busy"));
  }
  card.append(title);
  if (message.text) card.append(make("p", "", message.text));
  if (message.detail) {
    const details = make("details");
    details.append(make("summary", "", texts.details), make("code", "", message.detail));
    card.append(details);
  }
  if (message.choices?.length) {
    const row = make("div", "buttons");
    for (const choice of message.choices) {
      const button = make("button", choice.is_primary ? "button primary" : "button", choice.label);
      button.type = "button";
      button.addEventListener("click", () => choice.onPress(button));
      row.append(button);
    }
    card.append(row);
  }
  parent.replaceChildren(card);
  focusTitle(parent);
  return card;
}

/** Shows a title and a text with one button for each label; resolves to the number of the button pressed. */
export function choose(
  parent: HTMLElement,
  texts: Texts,
  words: { title: string; text: string; detail?: string },
  labels: string[],
): Promise<number> {
  return new Promise((resolve) => {
    const choices = labels.map((label, i) => ({ label, is_primary: i === 0, onPress: () => resolve(i) }));
    showMessage(parent, texts, { ...words, choices });
  });
}

/** The study's own HTML, under `title` where it brings none. */
export function titled(title: string, html: string): string {
  return /<h1[\s>]/i.test(html) ? html : make("h1", "", title).outerHTML + html;
}

/** Brings a new screen to its top and tells screen readers its title. */
export function focusTitle(parent: HTMLElement): void {
  window.scrollTo(0, 0);
  const title = parent.querySelector<HTMLElement>("h1, h2");
  if (!title) return;
  title.tabIndex = -1;
  title.focus({ preventScroll: true });
}

function part<T extends HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`index.html has no #${id}`);
  return element as T;
}

export function page(): HTMLElement {
  return part("page");
}

/** Fills the bar and the notice, once the study is known. */
export function showBar(study: Study, texts: Texts): void {
  document.title = study.title;
  document.documentElement.lang = study.language;
  part("bar").hidden = false;
  part("bar-title").textContent = study.title;
  if (study.simulated_notice) {
    part("notice").textContent = study.simulated_notice;
    part("notice").hidden = false;
  }
  const button = part<HTMLButtonElement>("bar-fullscreen");
  const label = (): void => {
    button.textContent = document.fullscreenElement ? texts.leave_fullscreen : texts.fullscreen;
  };
  button.hidden = !document.fullscreenEnabled;
  button.addEventListener("click", () => {
    const change = document.fullscreenElement
      ? document.exitFullscreen()
      : document.documentElement.requestFullscreen();
    change.catch(() => undefined); // refused by the browser: the study runs in a window as well
  });
  document.addEventListener("fullscreenchange", label);
  label();
}

/** Offers, in the corner of the bar, to end the participation; `signal` takes the offer back. */
export function offerStop(texts: Texts, onStop: () => void, signal: AbortSignal): void {
  const button = part<HTMLButtonElement>("bar-stop");
  button.textContent = texts.stop_here;
  button.hidden = false;
  button.addEventListener("click", onStop, { signal });
  signal.addEventListener("abort", () => {
    button.hidden = true;
  });
}

export function showProgress(done: number, total: number, texts: Texts): void {
  const bar = part("bar-progress");
  bar.hidden = false;
  bar.setAttribute("aria-label", texts.progress);
  bar.setAttribute("aria-valuemax", String(total));
  bar.setAttribute("aria-valuenow", String(done));
  bar.setAttribute("aria-valuetext", texts.progressText(done, total));
  const fill = bar.firstElementChild as HTMLElement;
  fill.style.width = `${total > 0 ? (100 * done) / total : 0}%`;
  part("bar-count").textContent = texts.progressShort(done, total);
}

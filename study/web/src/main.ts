// SPDX-License-Identifier: MIT
// Starts the page: checks the browser, fetches the study, runs the timeline, and shows the end.
import { initJsPsych } from "jspsych";
import { request } from "./api";
import type { Study } from "./contract";
import { patiently } from "./delivery";
import { measureEnvironment } from "./environment";
import { make } from "./field";
import { Outbox } from "./outbox";
import { focusTitle, page, showBar, showMessage, titled } from "./screens";
import { savedSession, visitFrom } from "./session";
import { StudyPage } from "./study_page";
import { type Texts, textsFor } from "./texts";
import { makeTimeline } from "./timeline";

const visit = visitFrom(location.href);
const first_texts = textsFor(visit.lang ?? navigator.language);

async function start(): Promise<void> {
  const lack = await browserLack();
  if (lack) {
    showMessage(page(), first_texts, { title: first_texts.browser_title, text: first_texts.browser_lacks[lack] });
    return;
  }
  const language = visit.lang === null ? "" : `?lang=${encodeURIComponent(visit.lang)}`;
  const study = await patiently(page(), first_texts, () => request<Study>(`/api/study${language}`));
  const texts = textsFor(study.language);
  showBar(study, texts);
  const outbox = await Outbox.open(study.name);
  const session = savedSession(study.name);
  const study_page = new StudyPage(study, texts, visit, measureEnvironment(), outbox, session);

  page().replaceChildren();
  const jsPsych = initJsPsych({
    display_element: page(),
    use_webaudio: false, // clips have no sound, and an idle AudioContext logs warnings
    on_trial_start: () => page().removeAttribute("tabindex"), // the page itself is no control
  });
  await jsPsych.run(makeTimeline(study_page));
  showEnd(study_page, texts);
}

function showEnd(study_page: StudyPage, texts: Texts): void {
  const { study, next, visit: here } = study_page;
  if (next.step === "declined") {
    const changedMind = { label: texts.changed_mind, onPress: () => study_page.startOver() };
    showMessage(page(), texts, { title: texts.declined_title, text: texts.declined_text, choices: [changedMind] });
    return;
  }
  const card = make("section", "card message");
  card.innerHTML = titled(texts.thanks_title, study.thanks_html);
  if (next.completion_code) card.append(completionCode(next.completion_code, texts));
  // On a computer of the lab the next participant follows; on their own device everybody takes part once.
  if (here.source === "lab" || here.source === "pilot") {
    const again = make("button", "button", texts.next_participant);
    again.addEventListener("click", () => study_page.startOver());
    card.append(again);
  }
  page().replaceChildren(card);
  focusTitle(page());
}

function completionCode(code: string, texts: Texts): HTMLElement {
  const box = make("div", "code-box");
  const copy = make("button", "button", texts.copy);
  copy.type = "button";
  copy.addEventListener("click", () => {
    void navigator.clipboard.writeText(code).then(() => {
      copy.textContent = texts.copied;
    });
  });
  box.append(make("span", "code-label", texts.code_label), make("code", "code", code), copy);
  return box;
}

/** What the browser lacks that no answer can do without. */
async function browserLack(): Promise<"secure" | "storage" | "video" | null> {
  if (!window.isSecureContext) return "secure"; // crypto.subtle, which proves the clips, exists only there
  if (!document.createElement("video").canPlayType('video/mp4; codecs="avc1.640028"')) return "video";
  try {
    localStorage.setItem("verisim check", "1");
    localStorage.removeItem("verisim check");
    await Outbox.open("check");
  } catch {
    return "storage";
  }
  return null;
}

function showBroken(cause: unknown): void {
  const detail = cause instanceof Error ? `${cause.name}: ${cause.message}` : String(cause);
  document.documentElement.classList.remove("has-stage");
  showMessage(page(), first_texts, {
    title: first_texts.broken_title,
    text: first_texts.broken_text,
    detail,
    choices: [{ label: first_texts.reload, is_primary: true, onPress: () => location.reload() }],
  });
}

window.addEventListener("error", (event) => showBroken(event.error ?? event.message));
window.addEventListener("unhandledrejection", (event) => showBroken(event.reason));
// Back and forward can bring a frozen page back in the middle of a clip: begin this position anew.
window.addEventListener("pageshow", (event) => {
  if (event.persisted) location.reload();
});
// The second click of a double click belongs to the screen that is gone, not to the button that came in its place.
document.addEventListener(
  "click",
  (event) => {
    if (event.detail < 2 || !(event.target as Element).closest("button")) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  },
  true,
);

start().catch(showBroken);

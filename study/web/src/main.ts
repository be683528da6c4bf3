// SPDX-License-Identifier: MIT
// Starts the page: checks the browser, fetches the study, runs the timeline, and shows the end.
import { initJsPsych } from "jspsych";
import { request } from "./api";
import type { Study } from "./contract";
import { fetchNext, patiently } from "./delivery";
import { showEnd } from "./end_page";
import { measureEnvironment } from "./environment";
import { Outbox } from "./outbox";
import { page, showBar, showMessage } from "./screens";
import { savedSession, visitFrom } from "./session";
import { StudyPage } from "./study_page";
import { textsFor } from "./texts";
import { makeTimeline } from "./timeline";
import { withdrawByLink } from "./withdraw_page";

const visit = visitFrom(location.href);
const first_texts = textsFor(visit.lang ?? navigator.language);

async function start(): Promise<void> {
  const lack = await browserLack();
  if (lack) {
    showMessage(page(), first_texts, { title: first_texts.browser_title, text: first_texts.browser_lacks[lack] });
    return;
  }
  if (visit.is_preview) {
    showMessage(page(), first_texts, { title: first_texts.preview_title, text: first_texts.preview_text });
    return;
  }
  let study = await patiently(page(), first_texts, () => fetchStudy(visit.lang));
  const session = savedSession(study.name);
  if (session && visit.withdrawal === null) {
    // The visit goes on in the language of its consent.
    const { language } = await fetchNext(page(), first_texts, session.token).catch(() => ({ language: null }));
    if (language && language !== study.language) study = await patiently(page(), first_texts, () => fetchStudy(language));
  }
  const texts = textsFor(study.language);
  showBar(study, texts);
  if (visit.withdrawal !== null) return withdrawByLink(visit.withdrawal, study, texts);
  if (study.state !== "open" && !session) {
    const [title, text] = texts.refusals[`study_${study.state}`] ?? [texts.thanks_title, ""];
    showMessage(page(), texts, { title, text });
    return;
  }
  const outbox = await Outbox.open(study.name);
  const study_page = new StudyPage(study, texts, visit, measureEnvironment(), outbox, session);

  page().replaceChildren();
  const jsPsych = initJsPsych({
    display_element: page(),
    use_webaudio: false, // clips have no sound, and an idle AudioContext logs warnings
    on_trial_start: () => page().removeAttribute("tabindex"), // the page itself is no control
  });
  await jsPsych.run(makeTimeline(study_page));
  showEnd(study_page);
}

function fetchStudy(lang: string | null): Promise<Study> {
  return request<Study>(`/api/study${lang === null ? "" : `?lang=${encodeURIComponent(lang)}`}`);
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

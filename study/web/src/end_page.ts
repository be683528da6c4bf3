// SPDX-License-Identifier: MIT
// The last page: thanks, completion code or the way back to the recruitment platform, and the right to withdraw.
import { confirmed } from "./confirm";
import type { Completion } from "./contract";
import { make } from "./field";
import { focusTitle, page, showMessage, titled } from "./screens";
import { firstAddress, visitFrom } from "./session";
import type { StudyPage } from "./study_page";
import type { Texts } from "./texts";

export function showEnd(study_page: StudyPage): void {
  const { next, study, texts } = study_page;
  if (next.step === "declined") {
    const changedMind = { label: texts.changed_mind, onPress: () => study_page.startOver() };
    const words = { title: texts.declined_title, text: texts.declined_text };
    const card = showMessage(page(), texts, study.kiosk ? words : { ...words, choices: [changedMind] });
    addNextParticipant(card, study_page);
    return;
  }
  const card = make("section", "card message end");
  if (next.step === "thanks") card.innerHTML = titled(texts.thanks_title, study.thanks_html);
  else if (next.step === "stopped") {
    card.append(make("h1", "", texts.stopped_title), make("p", "", texts.stopped_text));
  } else {
    card.append(make("h1", "", texts.screened_out_title), make("p", "", texts.screened_out_text));
    const reasons = make("ul", "reasons");
    reasons.append(...next.screen_problems.map(({ code }) => make("li", "", texts.screen_problems[code] ?? code)));
    card.append(reasons);
  }
  if (next.completion) addCompletion(card, next.completion, texts);
  if (next.withdraw_fragment) addWithdrawal(card, next.withdraw_fragment, study_page);
  addNextParticipant(card, study_page);
  page().replaceChildren(card);
  focusTitle(page());
}

function addCompletion(card: HTMLElement, { code, return_url }: Completion, texts: Texts): void {
  if (code) {
    const box = make("div", "code-box");
    box.append(make("span", "code-label", texts.code_label), make("code", "code", code), copyButton(code, texts));
    card.append(box);
  }
  if (return_url) {
    const link = make("a", "button primary", texts.return_to);
    link.href = return_url;
    link.rel = "noreferrer";
    const row = make("div", "buttons");
    row.append(link);
    card.append(row);
  }
}

function addWithdrawal(card: HTMLElement, fragment: string, study_page: StudyPage): void {
  const { texts } = study_page;
  const box = make("div", "withdrawal");
  const address = `${location.origin}/#${fragment}`;
  const link = make("a", "withdraw-link", address);
  link.href = address;
  link.target = "_blank"; // this page, with its code, stays
  link.rel = "noreferrer";
  const erase = make("button", "quiet", texts.withdraw_button);
  erase.type = "button";
  erase.addEventListener("click", () => {
    void confirmed(texts.withdraw_title, texts.withdraw_text, texts.withdraw_yes, texts.withdraw_no).then(async (is_sure) => {
      if (is_sure) addNextParticipant(await study_page.withdraw(page()), study_page);
    });
  });
  const row = make("div", "withdraw-row");
  row.append(copyButton(address, texts), erase);
  box.append(make("p", "", texts.withdraw_intro), link, row);
  card.append(box);
}

/** On a computer of the lab the next participant follows; on their own device everybody takes part once. */
function addNextParticipant(card: HTMLElement, study_page: StudyPage): void {
  const { study, texts } = study_page;
  const { source } = visitFrom(location.origin + firstAddress()); // by now the address no longer says it
  if (!study.kiosk && source !== "lab" && source !== "pilot") return;
  const again = make("button", "button", texts.next_participant);
  again.type = "button";
  again.addEventListener("click", () => study_page.startOver());
  const row = make("div", "buttons next-participant");
  row.append(again);
  card.append(row);
  if (!study.kiosk) return;
  row.append(make("p", "keys-hint", texts.next_key));
  document.addEventListener("keydown", (event) => {
    if (event.key.toLowerCase() !== "n" || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!document.querySelector("dialog[open]")) study_page.startOver();
  });
}

function copyButton(text: string, texts: Texts): HTMLElement {
  const copy = make("button", "button", texts.copy);
  copy.type = "button";
  copy.addEventListener("click", () => {
    void navigator.clipboard.writeText(text).then(() => {
      copy.textContent = texts.copied;
    });
  });
  return copy;
}

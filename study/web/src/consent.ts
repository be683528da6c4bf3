// SPDX-License-Identifier: MIT
// The consent page: the study's form, how long it takes, and the other languages it can be read in.
import type { Study } from "./contract";
import { make } from "./field";
import { titled } from "./screens";
import type { Texts } from "./texts";

export function consentHtml(study: Study, texts: Texts): string {
  const minutes = study.minutes === null ? "" : make("p", "minutes", texts.minutes(Math.ceil(study.minutes))).outerHTML;
  return languageLinks(study, texts) + titled(study.title, study.consent.html) + minutes;
}

function languageLinks({ languages, language, language_names }: Study, texts: Texts): string {
  if (languages.length < 2) return "";
  const nav = make("nav", "languages");
  nav.setAttribute("aria-label", texts.language);
  for (const code of languages) {
    const name = language_names[code] ?? code;
    if (code === language) {
      const here = make("span", "", name);
      here.setAttribute("aria-current", "true");
      nav.append(here);
      continue;
    }
    const asked = new URLSearchParams(location.search); // keeps links and outside names
    asked.set("lang", code);
    const link = make("a", "", name);
    link.href = `/?${asked}`;
    link.lang = code;
    nav.append(link);
  }
  return nav.outerHTML;
}

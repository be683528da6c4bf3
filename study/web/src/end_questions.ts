// SPDX-License-Identifier: MIT
// The questions about the whole session, after the last clip.
import { make } from "./field";
import { QuestionForm } from "./question_form";
import { focusTitle } from "./screens";
import type { StudyPage } from "./study_page";

export function askEndQuestions(display: HTMLElement, study_page: StudyPage): Promise<void> {
  const { study, texts } = study_page;
  const shown_ms = performance.now();
  return new Promise((resolve) => {
    const keys = new AbortController();
    const form = new QuestionForm({
      texts,
      title: texts.end_title,
      questions: study.end_questions,
      conditions: {},
      reversed: [],
      layout: "single",
      sinceOrigin: () => performance.now() - shown_ms,
      rt_origin: "form_shown",
      onset_to_origin_ms: null,
      onSubmit: (responses) => {
        study_page.endAnswered(responses).then(
          () => {
            keys.abort();
            resolve();
          },
          () => form.showProblem(texts.not_kept_text),
        );
      },
    });
    form.element.querySelector("h1")?.classList.remove("visually-hidden");
    form.element.querySelector("h1")?.after(make("p", "", texts.end_text));
    form.listen(keys.signal);
    display.replaceChildren(form.element);
    focusTitle(display);
  });
}

// SPDX-License-Identifier: MIT
// The order of screens as a jsPsych timeline. The server owns the position: each round asks it what comes next.
import callFunction from "@jspsych/plugin-call-function";
import htmlButtonResponse from "@jspsych/plugin-html-button-response";
import type { JsPsych } from "jspsych";
import { focusTitle, page, titled } from "./screens";
import type { StudyPage } from "./study_page";
import { VideoRatingPlugin } from "./video_rating_plugin";

type Timeline = Parameters<JsPsych["run"]>[0];
type Node = Record<string, unknown>;

export function makeTimeline(study_page: StudyPage): Timeline {
  const { study, texts } = study_page;
  const isAt = (step: string) => () => study_page.next.step === step;
  const trial = () => study_page.trial;
  const isPracticeStart = () => trial().first_of_kind && trial().trial_kind === "practice";
  const isMainStart = () => study_page.last_kind === "practice" && trial().trial_kind !== "practice";
  const progress = () => study_page.next.progress;
  const isFirstHere = () => study_page.last_kind === null && progress().done > 0;

  const consent = when(isAt("consent"), [
    screen(() => titled(study.title, study.consent.html), [texts.agree, texts.decline], async (display, choice) => {
      await study_page.decide(display, choice === 0);
    }),
  ]);
  const instructions = when(isAt("instructions"), [
    screen(() => titled(study.title, study.instructions_html), [texts.begin], () => study_page.instructionsRead()),
  ]);
  const trials = when(isAt("trial"), [
    when(isFirstHere, [plain(() => [texts.resume_title, texts.resume_text])]),
    when(() => !isFirstHere() && isPracticeStart(), [
      plain(() => [texts.practice_title, texts.practiceText(study.num_practice)]),
    ]),
    when(isMainStart, [plain(() => [texts.main_title, texts.mainText(study.num_trials)])]),
    when(() => trial().rest_before && !isFirstHere(), [
      plain(() => [texts.rest_title, texts.restText(progress().done, progress().total)]),
    ]),
    {
      type: VideoRatingPlugin,
      clip: () => study_page.clip,
      questions: () => study.questions.filter(({ key }) => trial().question_keys.includes(key)),
      replays: study.trial.replays,
      fixation_ms: study.trial.fixation_ms,
      texts: () => texts,
      store: study_page.answered.bind(study_page),
      report_broken_off: study_page.reportBrokenOff.bind(study_page),
      log: study_page.log,
    },
  ]);

  function plain(words: () => [title: string, text: string]): Node {
    return screen(() => {
      const [title, text] = words();
      return `<h1>${title}</h1><p>${text}</p>`;
    }, [texts.carry_on], () => Promise.resolve(), "message");
  }

  return [
    work((display) => study_page.advance(display)),
    {
      timeline: [consent, instructions, trials, work((display) => study_page.advance(display))],
      conditional_function: () => !isOver(study_page),
      loop_function: () => !isOver(study_page),
    },
  ] as unknown as Timeline;
}

function isOver({ next }: StudyPage): boolean {
  return next.step === "thanks" || next.step === "declined";
}

function when(condition: () => boolean, timeline: Node[]): Node {
  return { timeline, conditional_function: condition };
}

/** A text with buttons, the first one being the usual way on; then `onChoice` works, with the display to itself. */
function screen(
  html: () => string,
  choices: string[],
  onChoice: (display: HTMLElement, choice: number) => Promise<void>,
  look = "text",
): Node {
  let choice = 0;
  const show = {
    type: htmlButtonResponse,
    stimulus: html,
    choices,
    button_layout: "flex",
    button_html: (label: string, i: number) =>
      `<button type="button" class="button${i === 0 ? " primary" : ""}">${label}</button>`,
    css_classes: ["card", look],
    on_load: () => focusTitle(page()),
    on_finish: (data: { response: number }) => {
      choice = data.response;
    },
  };
  return { timeline: [show, work((display) => onChoice(display, choice))] };
}

/** Work between two screens. It may show waiting screens of its own. */
function work(task: (display: HTMLElement) => Promise<void>): Node {
  return {
    type: callFunction,
    async: true,
    func: (done: () => void) => {
      const display = document.getElementById("jspsych-content") ?? page();
      task(display).then(done, (cause: unknown) => {
        queueMicrotask(() => {
          throw cause; // to the page's error screen, see main.ts
        });
      });
    },
  };
}

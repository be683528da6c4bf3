// SPDX-License-Identifier: MIT
// The order of screens as a jsPsych timeline. The server owns the position: each round asks it what comes next.
import callFunction from "@jspsych/plugin-call-function";
import htmlButtonResponse from "@jspsych/plugin-html-button-response";
import type { JsPsych } from "jspsych";
import { consentHtml } from "./consent";
import type { Step } from "./contract";
import { askEndQuestions } from "./end_questions";
import { rest } from "./rest";
import { checkScreen } from "./screen_check";
import { focusTitle, page, titled } from "./screens";
import type { StudyPage } from "./study_page";
import { VideoRatingPlugin } from "./video_rating_plugin";

type Timeline = Parameters<JsPsych["run"]>[0];
type Node = Record<string, unknown>;

const LAST_STEPS: Step[] = ["thanks", "declined", "screened_out", "stopped"];

export function makeTimeline(study_page: StudyPage): Timeline {
  const { study, texts } = study_page;
  const isAt = (step: Step) => () => study_page.next.step === step;
  const trial = () => study_page.trial;
  const isPracticeStart = () => trial().first_of_kind && trial().trial_kind === "practice";
  const isMainStart = () => study_page.last_kind === "practice" && trial().trial_kind !== "practice";
  const progress = () => study_page.next.progress;
  const isFirstHere = () => study_page.last_kind === null && progress().done > 0;
  const needsFullscreen = () =>
    study.screen?.fullscreen === "require" && document.fullscreenEnabled && !document.fullscreenElement;
  const feedback = () => study_page.feedback;
  const clips_each = study.trial.layout === "single" ? 1 : 2;

  const consent = when(isAt("consent"), [
    screen(() => consentHtml(study, texts), [texts.agree, texts.decline], async (display, choice) => {
      await study_page.decide(display, choice === 0);
    }, "text", false),
  ]);
  const check = when(isAt("screen"), [work((display) => checkScreen(display, study_page))]);
  const instructions = when(isAt("instructions"), [
    screen(() => titled(study.title, study.instructions_html), [texts.begin], async () => {
      await study_page.instructionsRead();
    }),
  ]);
  const restScreen = when(() => trial().rest_before && !isFirstHere(), [
    work(async (display) => {
      const choice = await rest(display, texts, progress(), study.trial.rest_min_s, study.can_stop);
      if (choice === "stop") await study_page.stop();
      study_page.is_stopping = choice === "stop";
    }),
  ]);
  const trials = when(isAt("trial"), [
    when(isFirstHere, [plain(() => [texts.resume_title, texts.resume_text])]),
    when(() => !isFirstHere() && isPracticeStart(), [
      plain(() => [texts.practice_title, texts.practiceText(study.num_practice, clips_each)]),
    ]),
    when(isMainStart, [plain(() => [texts.main_title, texts.mainText(study.num_trials, clips_each)])]),
    restScreen,
    when(() => !study_page.is_stopping, [
      when(needsFullscreen, [work((display) => study_page.returnToFullscreen(display))]),
      {
        type: VideoRatingPlugin,
        trial,
        questions: () => study_page.questionsOf(trial()),
        timing: () => study.trial,
        texts: () => texts,
        store: study_page.answered.bind(study_page),
        report_broken_off: study_page.reportBrokenOff.bind(study_page),
        stop: study.can_stop ? study_page.stop.bind(study_page) : null,
        log: study_page.log,
      },
    ]),
  ]);
  const endQuestions = when(isAt("end_questions"), [work((display) => askEndQuestions(display, study_page))]);
  const shownFeedback = when(() => feedback() !== null, [
    plain(() => {
      const is_right = feedback()?.correct ?? false;
      return [texts.feedback_title(is_right), feedback()?.text ?? texts.feedbackText(is_right, clips_each)];
    }),
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
      timeline: [
        consent, check, instructions, trials, endQuestions,
        work((display) => study_page.advance(display)),
        shownFeedback,
      ],
      conditional_function: () => !isOver(study_page),
      loop_function: () => !isOver(study_page),
    },
  ] as unknown as Timeline;
}

function isOver({ next }: StudyPage): boolean {
  return LAST_STEPS.includes(next.step);
}

function when(condition: () => boolean, timeline: Node[]): Node {
  return { timeline, conditional_function: condition };
}

/** A text with buttons, the first one as the usual way on unless all must look alike; then `onChoice` works, with the display to itself. */
function screen(
  html: () => string,
  choices: string[],
  onChoice: (display: HTMLElement, choice: number) => Promise<void>,
  look = "text",
  has_usual_way = true,
): Node {
  let choice = 0;
  const show = {
    type: htmlButtonResponse,
    stimulus: html,
    choices,
    button_layout: "flex",
    button_html: (label: string, i: number) =>
      `<button type="button" class="button${i === 0 && has_usual_way ? " primary" : ""}">${label}</button>`,
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

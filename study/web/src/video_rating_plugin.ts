// SPDX-License-Identifier: MIT
// jsPsych plugin video-rating: one clip, then the questions about it. It knows nothing of servers: what is to be kept
// goes out through its function parameters.
import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import type { Clip, PresentationRecord, Question, ResponseRecord } from "./contract";
import { type Log, Presentation } from "./presentation";
import { playOnce, prepareVideo } from "./play";
import { ClipProblem, loadClip } from "./preload";
import { QuestionForm } from "./question_form";
import { focusTitle, showMessage } from "./screens";
import { Stage } from "./stage";
import type { Texts } from "./texts";

declare const APP_VERSION: string;

const info = {
  name: "video-rating",
  version: APP_VERSION,
  parameters: {
    /** The clip: address, sha256, size in bytes and pixels. */
    clip: { type: ParameterType.OBJECT, default: undefined },
    /** Questions in the order of the page. */
    questions: { type: ParameterType.COMPLEX, array: true, default: undefined },
    /** How often the clip may be watched again, after its first full play. */
    replays: { type: ParameterType.INT, default: 0 },
    /** Shortest and longest time of the fixation cross; drawn evenly in between. */
    fixation_ms: { type: ParameterType.INT, array: true, default: [500, 1500] },
    /** Grey before a replay and between the clip and the questions. */
    grey_ms: { type: ParameterType.INT, default: 200 },
    /** The error screen comes when the clip's bytes stay away for this long. */
    load_silence_ms: { type: ParameterType.INT, default: 20_000 },
    /** The page's words. */
    texts: { type: ParameterType.OBJECT, default: undefined },
    /** Keeps the answer for good; the page moves on when it resolves. */
    store: { type: ParameterType.FUNCTION, default: undefined },
    /** Takes a showing that was not followed by an answer: page left, clip broken. */
    report_broken_off: { type: ParameterType.FUNCTION, default: undefined },
    /** Takes events: stalls, replays, problems. */
    log: { type: ParameterType.FUNCTION, default: undefined },
  },
  data: {
    /** What the screen did. */
    presentation: { type: ParameterType.OBJECT },
    /** What was answered; rt_ms counts from the end of the first full play. */
    responses: { type: ParameterType.COMPLEX, array: true },
  },
  citations: { apa: "", bibtex: "" },
} as const;

type Info = typeof info;

interface Parameters {
  clip: Clip;
  questions: Question[];
  replays: number;
  fixation_ms: [number, number];
  grey_ms: number;
  load_silence_ms: number;
  texts: Texts;
  store: (presentation: PresentationRecord, responses: ResponseRecord[]) => Promise<void>;
  report_broken_off: (presentation: PresentationRecord) => void;
  log: Log;
}

/** The trial's data. */
interface Shown {
  presentation: PresentationRecord;
  responses: ResponseRecord[];
}

export class VideoRatingPlugin implements JsPsychPlugin<Info> {
  static readonly info = info;

  trial(display: HTMLElement, trial: TrialType<Info>, on_load: () => void): Promise<Shown> {
    const showing = new Showing(display, trial as unknown as Parameters);
    on_load();
    return showing.run();
  }
}

/** One trial from the grey before the clip to the stored answer. */
class Showing {
  private readonly video = document.createElement("video");
  private readonly stage: Stage;
  private readonly leaving = new AbortController();
  private presentation: Presentation | null = null;

  constructor(
    private readonly display: HTMLElement,
    private readonly trial: Parameters,
  ) {
    this.stage = new Stage(
      this.video,
      (size) => this.presentation?.setDisplayed(size.width_px, size.height_px),
      trial.texts,
    );
    window.addEventListener("pagehide", () => this.breakOff(), { signal: this.leaving.signal });
  }

  async run(): Promise<Shown> {
    let url = "";
    for (let attempt = 0; !url; attempt += 1) {
      try {
        url = await this.showFirst(attempt > 0);
      } catch (cause) {
        if (!(cause instanceof ClipProblem)) throw cause;
        await this.showProblem(cause);
      }
    }
    const answered = await this.ask();
    this.leaving.abort();
    this.video.removeAttribute("src");
    URL.revokeObjectURL(url);
    return answered;
  }

  /** Loads the clip and shows it in full once; returns the address of its bytes in memory. Throws ClipProblem. */
  private async showFirst(is_again: boolean): Promise<string> {
    const { trial, stage } = this;
    this.display.replaceChildren();
    stage.open(this.display, trial.clip);
    stage.showLoading(0);
    const bytes = await loadClip(trial.clip, trial.load_silence_ms, is_again, (share) => stage.showLoading(share));
    const url = URL.createObjectURL(bytes);
    try {
      await prepareVideo(this.video, url);
      const [low, high] = trial.fixation_ms;
      const fixation_ms = low + Math.random() * (high - low);
      const presentation = new Presentation(trial.log);
      stage.showCross();
      await after(fixation_ms);
      await inSight();
      this.presentation = presentation;
      stage.place();
      trial.log("fixation", presentation.id, { ms: fixation_ms });
      await this.play(presentation);
      await after(trial.grey_ms);
    } catch (cause) {
      URL.revokeObjectURL(url);
      throw cause;
    }
    stage.close();
    return url;
  }

  private play(presentation: Presentation): Promise<void> {
    const { video, stage, trial } = this;
    return playOnce({ video, stage, presentation, log: trial.log, press_to_start: trial.texts.press_to_start });
  }

  private async showProblem(problem: ClipProblem): Promise<void> {
    const { texts, log } = this.trial;
    log("clip_problem", this.presentation?.id ?? null, { failure: problem.failure, detail: problem.detail });
    this.breakOff();
    this.stage.close();
    await new Promise<void>((resolve) => {
      showMessage(this.display, texts, {
        title: texts.clip_title,
        text: `${texts.clip_text[problem.failure]} ${texts.clip_advice}`,
        detail: problem.message,
        choices: [{ label: texts.try_again, is_primary: true, onPress: () => resolve() }],
      });
    });
  }

  private breakOff(): void {
    if (this.presentation) this.trial.report_broken_off(this.presentation.record(false));
    this.presentation = null;
  }

  /** The questions in place of the clip, until an answer is stored. */
  private ask(): Promise<Shown> {
    const { trial, display } = this;
    const presentation = this.presentation as Presentation;
    const clip_end_ms = presentation.ended_ms ?? performance.now();
    let num_replays_left = trial.replays;
    return new Promise((resolve) => {
      const keys = new AbortController();
      const form = new QuestionForm(trial.questions, trial.texts, () => performance.now() - clip_end_ms, {
        onWatchAgain: () => {
          num_replays_left -= 1;
          void this.watchAgain(presentation, form, num_replays_left);
        },
        onSubmit: (responses) => {
          const record = presentation.record(true);
          trial.store(record, responses).then(
            () => {
              keys.abort();
              resolve({ presentation: record, responses });
            },
            () => form.showProblem(trial.texts.not_kept_text),
          );
        },
      });
      form.setReplaysLeft(num_replays_left);
      form.listen(keys.signal);
      display.replaceChildren(form.element);
      focusTitle(display);
    });
  }

  private async watchAgain(presentation: Presentation, form: QuestionForm, num_left: number): Promise<void> {
    const { trial, stage } = this;
    form.element.inert = true;
    stage.open(this.display, trial.clip);
    stage.showGrey();
    try {
      await after(trial.grey_ms);
      await this.play(presentation);
      await after(trial.grey_ms);
    } catch (cause) {
      // The clip was seen in full before: the questions can be answered all the same.
      trial.log("replay_problem", presentation.id, { detail: String(cause) });
    }
    stage.close();
    form.element.inert = false;
    form.setReplaysLeft(num_left);
    form.focus();
  }
}

function after(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** Resolves when the page is in sight, so that no clip plays unseen. */
function inSight(): Promise<void> {
  if (!document.hidden) return Promise.resolve();
  return new Promise((resolve) => {
    const look = (): void => {
      if (document.hidden) return;
      document.removeEventListener("visibilitychange", look);
      resolve();
    };
    document.addEventListener("visibilitychange", look);
  });
}

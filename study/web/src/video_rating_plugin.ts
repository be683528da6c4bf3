// SPDX-License-Identifier: MIT
// jsPsych plugin video-rating: one clip or a pair, then the questions about it. It knows nothing of servers: what is to
// be kept goes out through its function parameters.
import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import type { Log } from "./clip_evidence";
import { confirmed } from "./confirm";
import type { PresentationRecord, Question, ResponseRecord, Study, Trial } from "./contract";
import { makeVideo, playOnce, prepareVideo } from "./play";
import { playForMark } from "./play_for_mark";
import { ClipProblem, loadClips } from "./preload";
import { Presentation } from "./presentation";
import { QuestionForm } from "./question_form";
import { focusTitle, offerStop, showMessage } from "./screens";
import { Stage } from "./stage";
import type { Texts } from "./texts";

declare const APP_VERSION: string;

const info = {
  name: "video-rating",
  version: APP_VERSION,
  parameters: {
    /** What the server says of this trial: clips, layout, which questions under which conditions. */
    trial: { type: ParameterType.OBJECT, default: undefined },
    /** Questions in the order of the page. */
    questions: { type: ParameterType.COMPLEX, array: true, default: undefined },
    /** How trials are shown: replays, and times of fixation, grey and gap. */
    timing: { type: ParameterType.OBJECT, default: undefined },
    /** Grey before a replay and between the clip and the questions. */
    grey_after_ms: { type: ParameterType.INT, default: 200 },
    /** The error screen comes when the clip's bytes stay away for this long. */
    load_silence_ms: { type: ParameterType.INT, default: 20_000 },
    /** The page's words. */
    texts: { type: ParameterType.OBJECT, default: undefined },
    /** Keeps the answer for good; the page moves on when it resolves. */
    store: { type: ParameterType.FUNCTION, default: undefined },
    /** Takes a showing that was not followed by an answer: page left, clip broken. */
    report_broken_off: { type: ParameterType.FUNCTION, default: undefined },
    /** Ends the participation early; null where the study does not allow it. */
    stop: { type: ParameterType.FUNCTION, default: null },
    /** Takes events: stalls, replays, problems. */
    log: { type: ParameterType.FUNCTION, default: undefined },
  },
  data: {
    /** What the screen did. */
    presentation: { type: ParameterType.OBJECT },
    /** What was answered; rt_ms counts from the end of the last first play. */
    responses: { type: ParameterType.COMPLEX, array: true },
  },
  citations: { apa: "", bibtex: "" },
} as const;

type Info = typeof info;

interface Parameters {
  trial: Trial;
  questions: Question[];
  timing: Study["trial"];
  grey_after_ms: number;
  load_silence_ms: number;
  texts: Texts;
  store: (presentation: PresentationRecord, responses: ResponseRecord[]) => Promise<void>;
  report_broken_off: (presentation: PresentationRecord) => void;
  stop: (() => Promise<void>) | null;
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
  private readonly videos: HTMLVideoElement[];
  private readonly stage: Stage;
  private readonly leaving = new AbortController();
  private readonly positions: number[];
  private presentation: Presentation | null = null;
  private urls: string[] = [];

  constructor(
    private readonly display: HTMLElement,
    private readonly settings: Parameters,
  ) {
    const { clips, layout } = settings.trial;
    this.videos = clips.map(makeVideo);
    this.positions = clips.map((_, i) => i);
    this.stage = new Stage(
      this.videos,
      clips,
      layout,
      (size) => this.presentation?.setDisplayed(size),
      settings.texts,
    );
    window.addEventListener("pagehide", () => this.breakOff(), { signal: this.leaving.signal });
  }

  async run(): Promise<Shown> {
    for (let attempt = 0; this.urls.length === 0; attempt += 1) {
      try {
        await this.showFirst(attempt > 0);
      } catch (cause) {
        this.freeClips();
        if (!(cause instanceof ClipProblem)) throw cause;
        await this.showProblem(cause);
      }
    }
    const answered = await this.ask();
    this.leaving.abort();
    this.freeClips();
    return answered;
  }

  /** Loads the clips and shows each in full once. Throws ClipProblem. */
  private async showFirst(is_again: boolean): Promise<void> {
    const { settings, stage } = this;
    const { clips, layout } = settings.trial;
    this.display.replaceChildren();
    stage.open(this.display);
    stage.showLoading(0);
    this.urls = await loadClips(clips, settings.load_silence_ms, is_again, (share) => stage.showLoading(share));
    await Promise.all(this.videos.map((video, i) => prepareVideo(video, this.urls[i] ?? "")));
    const [low, high] = settings.timing.fixation_ms;
    const fixation_ms = low + Math.random() * (high - low);
    const presentation = new Presentation(clips, layout, settings.log);
    stage.showCross(this.clipNumber(0));
    await after(fixation_ms);
    await inSight();
    this.presentation = presentation;
    stage.place();
    settings.log("fixation", presentation.id, { ms: fixation_ms });
    await this.showClips(presentation);
    stage.close();
  }

  /** All clips of the trial in their layout, with the grey around them. */
  private async showClips(presentation: Presentation): Promise<void> {
    const { settings, stage } = this;
    const { timing, texts, log } = settings;
    const showing = { videos: this.videos, stage, presentation, log, press_to_start: texts.press_to_start };
    const endWatch = presentation.watchPage();
    try {
      stage.showGrey();
      await after(timing.grey_ms);
      if (settings.trial.layout === "side_by_side") await playOnce(showing, this.positions);
      else {
        for (const position of this.positions) {
          if (position > 0) {
            if (timing.gap_ms >= SHORTEST_CAPTION_MS) stage.showCross(this.clipNumber(position));
            await after(timing.gap_ms);
          }
          await playOnce(showing, [position]);
        }
      }
    } finally {
      endWatch();
    }
    await after(settings.grey_after_ms);
  }

  private clipNumber(position: number): string {
    const { trial, texts } = this.settings;
    return trial.layout === "sequential" ? texts.clipNumber(position + 1) : "";
  }

  private async showProblem(problem: ClipProblem): Promise<void> {
    const { texts, log } = this.settings;
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
    if (this.presentation) this.settings.report_broken_off(this.presentation.record(false));
    this.presentation = null;
  }

  private freeClips(): void {
    for (const video of this.videos) {
      video.onerror = null;
      video.removeAttribute("src");
      video.load(); // lets go of the decoder at once
    }
    for (const url of this.urls) URL.revokeObjectURL(url);
    this.urls = [];
  }

  /** The questions in place of the clip, until an answer is stored. */
  private ask(): Promise<Shown> {
    const { settings, display } = this;
    const { texts, trial } = settings;
    const presentation = this.presentation as Presentation;
    const clip_end_ms = presentation.ended_ms ?? performance.now();
    let num_replays_left = settings.timing.replays;
    return new Promise((resolve) => {
      const keys = new AbortController();
      const leave = (shown: Shown): void => {
        keys.abort();
        resolve(shown);
      };
      const stop = async (): Promise<void> => {
        if (!settings.stop || !(await confirmed(texts.stop_title, texts.stop_text, texts.stop_yes, texts.stop_no))) return;
        const record = presentation.record(false);
        this.breakOff();
        await settings.stop();
        leave({ presentation: record, responses: [] });
      };
      const form = new QuestionForm({
        texts,
        title: trial.clips.length > 1 ? texts.questions_title_pair : texts.questions_title,
        questions: settings.questions,
        conditions: trial.conditions,
        reversed: trial.reversed,
        layout: trial.layout,
        sinceOrigin: () => performance.now() - clip_end_ms,
        rt_origin: "video_end",
        onset_to_origin_ms: presentation.onset_ms === null ? null : clip_end_ms - presentation.onset_ms,
        watchForMark: () => this.watchForMark(presentation, form),
        onWatchAgain: () => {
          num_replays_left -= 1;
          void this.watchAgain(presentation, form, num_replays_left);
        },
        onSubmit: (responses) => {
          const record = presentation.record(true);
          settings.store(record, responses).then(
            () => leave({ presentation: record, responses }),
            () => form.showProblem(texts.not_kept_text),
          );
        },
      });
      form.setReplaysLeft(num_replays_left);
      form.listen(keys.signal);
      if (settings.stop) offerStop(texts, () => void stop(), keys.signal);
      display.replaceChildren(form.element);
      focusTitle(display);
    });
  }

  private async watchAgain(presentation: Presentation, form: QuestionForm, num_left: number): Promise<void> {
    await this.onStage(presentation, form, "replay_problem", () => this.showClips(presentation));
    form.setReplaysLeft(num_left);
    form.focus();
  }

  private async watchForMark(presentation: Presentation, form: QuestionForm): Promise<number | null> {
    const { settings, stage, videos } = this;
    const { texts, log } = settings;
    const showing = { videos, stage, presentation, log, press_to_start: texts.press_to_start };
    let time_ms: number | null = null;
    await this.onStage(presentation, form, "mark_problem", async () => {
      stage.leaveRoomBelow(MARK_PANEL_CSS_PX);
      time_ms = await playForMark(showing, texts).finally(() => stage.leaveRoomBelow(0));
    });
    return time_ms;
  }

  /** Brings the stage back over the form for a while. */
  private async onStage(presentation: Presentation, form: QuestionForm, problem: string, task: () => Promise<void>) {
    form.element.inert = true;
    this.stage.open(this.display);
    try {
      await task();
    } catch (cause) {
      // The clip was seen in full before: the questions can be answered all the same.
      this.settings.log(problem, presentation.id, { detail: String(cause) });
    }
    this.stage.close();
    form.element.inert = false;
  }
}

const MARK_PANEL_CSS_PX = 124; // a hint and a line of buttons, see app.css
const SHORTEST_CAPTION_MS = 300; // words that stand for less time only flicker

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

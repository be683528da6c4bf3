// SPDX-License-Identifier: MIT
// The shapes of the JSON that page and server exchange. Field names are those of the database.

export type QuestionKind =
  | "rating" | "bipolar" | "slider" | "yes_no" | "choice" | "category" | "checklist" | "fun" | "emotion" | "confidence"
  | "comment" | "mark";

/** A named answer: a number, a word, or both; both null means "cannot tell" only where the study says so. */
export interface Option {
  value?: number | null;
  value_text?: string | null;
  label: string;
}

export interface Question {
  key: string;
  kind: QuestionKind;
  prompt: string;
  optional: boolean;
  points?: number;
  ends?: [string, string];
  labels?: string[] | null; // one per point, empty where a point has no name
  max_chars?: number;
  min?: number;
  max?: number;
  step?: number;
  options?: Option[] | Partial<Record<Layout, Option[]>>; // by layout for kind "choice"
  not_sure?: Option | null;
  items?: { key: string; label: string }[];
  states?: Option[];
  max_marks?: number;
  none_label?: string;
}

/** A question is asked only while the answer to another one passes this test. */
export interface Condition {
  question: string;
  item: string;
  op: "<=" | "<" | ">=" | ">" | "==" | "!=";
  value: number | string;
}

/** What a screen must be and do; null parts are not asked for. */
export interface ScreenRules {
  phone: "allow" | "refuse";
  min_viewport: [number, number] | null; // CSS pixels that the study asks for, where its clips need less
  clip_px: [number, number]; // device pixels that the clips of a trial need beside each other
  refresh: "ignore" | "flag" | "refuse";
  frame_rates_hz: number[];
  codec: { mime: string; probe: Clip } | null;
  fullscreen: "off" | "offer" | "require";
  calibration: "off" | "offer" | "require";
  distance_mm: { min: number; max: number } | null;
  px_per_degree: [number, number] | null; // device pixels
}

export interface Study {
  name: string;
  title: string;
  languages: string[];
  language: string;
  language_names: Record<string, string>;
  state: "open" | "paused" | "closed" | "full";
  mode: "open" | "pilot" | "live";
  kiosk: boolean;
  consent: { version: string; sha256: string; html: string };
  instructions_html: string;
  thanks_html: string;
  trial: {
    layout: Layout;
    lock: string;
    replays: number;
    fixation_ms: [number, number];
    grey_ms: number; // between fixation and onset
    gap_ms: number; // between the clips of a sequential pair
    rest_every: number;
    rest_min_s: number;
  };
  num_trials: number;
  num_practice: number;
  minutes: number | null;
  can_stop: boolean;
  simulated_notice: string | null;
  screen: ScreenRules | null;
  questions: Question[];
  end_questions: Question[];
}

export type Layout = "single" | "sequential" | "side_by_side";

export interface Clip {
  sha256: string;
  url: string;
  num_bytes: number;
  width_px: number;
  height_px: number;
  frame_rate_hz: number;
  num_frames: number;
  duration_s: number;
}

export interface Trial {
  trial_id: number;
  trial_index: number;
  trial_kind: "practice" | "test" | "catch" | "repeat";
  layout: Layout;
  first_of_kind: boolean;
  clips: Clip[]; // of a pair: first or left, second or right
  question_keys: string[];
  conditions: Record<string, Condition>;
  reversed: string[]; // questions whose options are drawn from last to first
  rest_before: boolean;
  feedback: boolean; // the reply to the answer says whether it was right
}

export type Step =
  | "consent" | "screen" | "instructions" | "trial" | "end_questions" | "thanks" | "declined" | "screened_out" | "stopped";

export interface Completion {
  kind: "complete" | "partial" | "screened_out";
  code: string | null;
  return_url: string | null;
}

export interface ScreenProblem {
  code: string;
  fixable: boolean;
}

export interface Next {
  step: Step;
  progress: { done: number; total: number };
  language: string | null;
  completion: Completion | null;
  withdraw_fragment: string | null;
  screen_problems: ScreenProblem[];
  trial: Trial | null;
}

export interface ScreenVerdict {
  verdict: "passed" | "flagged" | "refused";
  px_per_degree: number | null;
  problems: ScreenProblem[];
}

export interface Feedback {
  correct: boolean;
  text: string | null;
}

/** What the screen did with one clip. Times are performance.now() of this page. */
export interface ClipRecord {
  position: number; // 0: alone, first or left; 1: second or right
  sha256: string;
  num_plays: number;
  onset_ms: number | null; // first frame on screen, first play
  first_frame_ms: number | null; // from the call of play() to that frame
  ended_ms: number | null; // end of the first full play
  frames_total: number | null; // decoded, all plays
  frames_dropped: number | null; // of those, never shown
  stall_count: number;
  stall_ms: number;
}

/** One showing of a trial: first onset, last end, sums over its clips, and what happened around them. */
export interface PresentationRecord extends Omit<ClipRecord, "position" | "sha256"> {
  presentation_id: string;
  hidden_ms: number; // clips playing while the page was out of sight
  blur_count: number; // the window lost the keyboard while clips were shown
  fullscreen: boolean;
  fullscreen_exits: number;
  displayed_w: number; // of one clip, device pixels
  displayed_h: number;
  device_pixel_ratio: number;
  scale: number | null; // device pixels per pixel of the clip, null where that is no whole number
  num_mark_plays: number;
  start_skew_ms: number | null; // side by side: right onset less left onset
  completed: boolean;
  clips: ClipRecord[];
}

export interface ResponseRecord {
  question: string;
  item: string;
  value: number | null;
  value_text: string | null;
  rt_ms: number;
  rt_onset_ms: number | null;
  rt_origin: "video_end" | "form_shown";
  first_touch_ms: number | null;
  num_changes: number;
  reversed: boolean;
}

export interface StudyEvent {
  seq: number;
  presentation_id: string | null;
  kind: string;
  t_ms: number;
  detail: Record<string, string | number | boolean | null> | null;
}

export interface Environment {
  browser: string;
  browser_version: string;
  os: string;
  is_mobile: boolean;
  screen_w: number;
  screen_h: number;
  viewport_w: number;
  viewport_h: number;
  device_pixel_ratio: number;
  refresh_hz: number | null;
  language: string;
  tz_offset_min: number;
  app_version: string;
}

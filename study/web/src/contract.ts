// SPDX-License-Identifier: MIT
// The shapes of the JSON that page and server exchange. Field names are those of the database.

export type QuestionKind = "rating" | "bipolar" | "slider" | "comment";

export interface Question {
  key: string;
  kind: QuestionKind;
  prompt: string;
  optional: boolean;
  points?: number;
  ends?: [string, string];
  labels?: string[]; // one per point, empty where a point has no name
  max_chars?: number;
  min?: number;
  max?: number;
  step?: number;
}

export interface Study {
  name: string;
  title: string;
  languages: string[];
  language: string;
  consent: { version: string; sha256: string; html: string };
  instructions_html: string;
  thanks_html: string;
  trial: {
    layout: string;
    lock: string;
    replays: number;
    fixation_ms: [number, number];
    rest_every: number;
  };
  num_trials: number;
  num_practice: number;
  simulated_notice: string | null;
  questions: Question[];
}

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
  layout: string;
  first_of_kind: boolean;
  clips: Clip[];
  question_keys: string[];
  rest_before: boolean;
}

export interface Next {
  step: "consent" | "instructions" | "trial" | "thanks" | "declined";
  progress: { done: number; total: number };
  completion_code: string | null;
  trial: Trial | null;
}

/** One showing of a clip: what the screen did. Times are performance.now() of this page. */
export interface PresentationRecord {
  presentation_id: string;
  num_plays: number;
  onset_ms: number | null; // first frame on screen, first play
  first_frame_ms: number | null; // from the call of play() to that frame
  ended_ms: number | null; // end of the first full play
  frames_total: number | null; // decoded, all plays
  frames_dropped: number | null; // of those, never shown
  stall_count: number;
  stall_ms: number;
  hidden_ms: number; // clip playing while the page was out of sight
  fullscreen: boolean;
  displayed_w: number; // device pixels
  displayed_h: number;
  completed: boolean;
}

export interface ResponseRecord {
  question: string;
  value: number | null;
  value_text: string | null;
  rt_ms: number;
  rt_origin: "video_end";
  first_touch_ms: number | null;
  num_changes: number;
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

// SPDX-License-Identifier: MIT
// Every word of the page that does not come from the study. Another language is another object of the same type.

const english = {
  // Consent and start
  agree: "I agree to take part",
  decline: "I do not take part",
  begin: "Begin",
  carry_on: "Continue",
  declined_title: "You decided not to take part",
  declined_text: "That is fine, and there is nothing more to do. You can close this page now.",
  changed_mind: "I changed my mind",
  resume_title: "Welcome back",
  resume_text: "Your earlier answers are safe. You go on where you were.",
  practice_title: "Practice first",
  practiceText: (n: number): string =>
    `${n === 1 ? "One clip" : `${n} clips`} to get used to the task. Each clip plays once, then the questions appear.`,
  main_title: "Practice is over",
  mainText: (n: number): string =>
    `Now the study itself begins: ${n === 1 ? "one clip" : `${n} clips`}. There are no right or wrong answers; your impression counts.`,
  rest_title: "Time for a short rest",
  restText: (done: number, total: number): string =>
    `You have done ${done} of ${total}. Look away from the screen for a moment and go on when you are ready.`,

  // Clip
  loading_clip: "Loading the clip",
  press_to_start: "Press to start the clip",
  clip_shown: "The clip is playing. The questions follow.",

  // Questions
  questions_title: "Your impression of the clip",
  keysHint: "Number keys answer the marked question.",
  pointName: (point: number, points: number, name: string): string => `${point} of ${points}${name ? `, ${name}` : ""}`,
  sliderEmpty: (low: string, high: string): string => `no answer yet; from ${low} to ${high}`,
  sliderValue: (value: number, min: number, max: number, low: string, high: string): string =>
    value === min ? `${value}, ${low}` : value === max ? `${value}, ${high}` : `${value} of ${max}`,
  optional: "(optional)",
  charsLeft: (n: number): string => `${n} characters left`,
  missing: "Please answer this question.",
  watch_again: "Watch the clip again",
  watchAgainLeft: (n: number): string => `Watch the clip again (${n} left)`,
  next: "Continue",
  progress: "Progress",
  progressText: (done: number, total: number): string => `${done} of ${total} done`,
  progressShort: (done: number, total: number): string => `${done} / ${total}`,
  fullscreen: "Full screen",
  leave_fullscreen: "Leave full screen",

  // Saving
  saving: "Saving your answer…",
  loading: "One moment…",
  lost_title: "Connection lost",
  lost_text: "Your answer is kept on this device. The page goes on by itself as soon as the study can be reached again; please leave it open.",
  lost_start_text: "The study cannot be reached. The page tries again by itself; please leave it open.",
  not_kept_title: "Your answer could not be kept",
  not_kept_text: "This device did not store your answer, perhaps because its disk is full. Your answer is still on the page: please try again.",
  download: "Download my answers",
  try_again: "Try again",

  // End
  thanks_title: "Thank you",
  code_label: "Your completion code",
  copy: "Copy",
  copied: "Copied",
  next_participant: "Start for the next participant",

  // Trouble
  refused_title: "Please tell the experimenter",
  refused_text: "The study did not accept an answer. Nothing is lost: it is kept on this device. Please download it and give the file to the experimenter.",
  session_lost_title: "This visit is no longer known",
  session_lost_text: "The study does not recognise this browser's earlier visit. Please tell the experimenter, or start from the beginning.",
  start_over: "Start from the beginning",
  clip_title: "The clip could not be shown",
  clip_text: {
    status: "The study did not deliver the clip.",
    no_bytes: "The clip did not arrive completely. The connection may be slow or interrupted.",
    wrong_bytes: "The clip arrived damaged.",
    not_playable: "This browser cannot play the clip.",
    stuck: "The clip stopped moving.",
  },
  clip_advice: "Nothing is lost. Please try again; if it happens again, tell the experimenter.",
  broken_title: "Something went wrong",
  broken_text: "Your answers so far are safe. Please load the page again; if this comes back, tell the experimenter.",
  reload: "Load the page again",
  details: "For the experimenter",
  browser_title: "This browser cannot run the study",
  browser_lacks: {
    secure: "The page must be opened through https, or through http://127.0.0.1 on the same computer.",
    storage: "The browser does not let this page keep your answers. A private window may be the reason: please use a normal one.",
    video: "The browser cannot play H.264 video. Please use a current Chrome, Edge, Firefox or Safari.",
  },
};

export type Texts = typeof english;

const LANGUAGES: Record<string, Texts> = { en: english };

/** The page's words in `language`, or in English where they are not translated. */
export function textsFor(language: string): Texts {
  return LANGUAGES[language.split("-")[0] ?? "en"] ?? english;
}

// SPDX-License-Identifier: MIT
// Every word of the page that does not come from the study, in English. Other languages are objects of the same type.
import { german } from "./texts_de";

const english = {
  // Consent and start
  agree: "I agree to take part",
  decline: "I do not take part",
  begin: "Begin",
  carry_on: "Continue",
  language: "Language",
  minutes: (n: number): string => `This takes about ${n} ${n === 1 ? "minute" : "minutes"}.`,
  declined_title: "You decided not to take part",
  declined_text: "That is fine, and there is nothing more to do. You can close this page now.",
  changed_mind: "I changed my mind",
  resume_title: "Welcome back",
  resume_text: "Your earlier answers are safe. You go on where you were.",
  practice_title: "Practice first",
  practiceText: (n: number, clips_each: number): string =>
    clips_each > 1
      ? `${n === 1 ? "One pair of clips" : `${n} pairs of clips`} to get used to the task. Both clips play once, then the questions appear.`
      : `${n === 1 ? "One clip" : `${n} clips`} to get used to the task. Each clip plays once, then the questions appear.`,
  main_title: "Practice is over",
  mainText: (n: number, clips_each: number): string => {
    const clips = clips_each > 1 ? (n === 1 ? "one pair of clips" : `${n} pairs of clips`) : n === 1 ? "one clip" : `${n} clips`;
    return `Now the study itself begins: ${clips}. From here on there are no right or wrong answers; your impression counts.`;
  },
  feedback_title: (is_right: boolean): string => (is_right ? "That is right" : "Not quite"),
  feedbackText: (is_right: boolean, clips_each: number): string => {
    const shown = clips_each > 1 ? "practice pair" : "practice clip";
    return is_right ? `You saw what this ${shown} was made to show.` : `This ${shown} was made to show something else.`;
  },
  rest_title: "Time for a short rest",
  restText: (done: number, total: number): string =>
    `You have done ${done} of ${total}. Look away from the screen for a moment and go on when you are ready.`,
  restWait: (seconds: number): string => `Continue (in ${seconds} s)`,
  end_title: "A few last questions",
  end_text: "These are about the session as a whole.",

  // Who may take part
  refusals: {
    link_needed: ["This study needs a personal link", "Please open the link that you were given."],
    link_unknown: ["This link is not known", "Please check that you opened the whole link, or ask the person who sent it."],
    link_used: ["This link was used before", "Each link is for one person and one visit. If you were interrupted, please use the same browser as before."],
    link_closed: ["This link is closed", "Please ask the person who sent it."],
    already_taken_part: ["You have taken part already", "Each person takes part once. Thank you for your interest."],
    study_paused: ["The study is paused", "Please try again later."],
    study_closed: ["The study is closed", "No more answers are collected. Thank you for your interest."],
    study_full: ["The study has enough participants", "No more answers are needed. Thank you for your interest."],
    not_simulated: ["This address is for scripted raters only", "Please use the address that you were given."],
    no_pilot_here: ["This study takes no pilot visits", "Please use the address that you were given."],
  } as Record<string, [title: string, text: string]>,
  preview_title: "This is a preview",
  preview_text: "Please accept the task first. The study then opens here.",

  // Screen
  check_again: "Check again",
  viewport_title: "The window is too small",
  viewportText: (w: number, h: number, now_w: number, now_h: number): string =>
    `The clips need a window of ${w} × ${h} pixels; this one has ${now_w} × ${now_h}. Please make it larger, zoom out, or go to full screen.`,
  fullscreen_title: "Full screen",
  fullscreen_text: "The clips are best seen without anything around them. You can leave full screen at any time with the Escape key.",
  fullscreen_needed: "This study runs in full screen. You can leave it at any time with the Escape key.",
  fullscreen_back_title: "Back to full screen",
  fullscreen_back_text: "This study runs in full screen. Please return to it before the next clip.",
  go_fullscreen: "Go to full screen",
  stay_in_window: "Stay in the window",
  card_title: "How large is your screen?",
  card_text: "Hold a bank card, or any card of that size, flat against the screen. Make the drawn card as wide as the real one: drag its right edge or use the arrow keys.",
  card_edge: "Width of the drawn card",
  cardWidth: (px: number): string => `${px} pixels`,
  card_done: "It has the same size",
  card_skip: "I have no card",
  distance_title: "How far are you from the screen?",
  distance_text: "From your eyes to the screen, roughly. An arm's length is about 60 cm. Please stay at that distance.",
  distance_label: "Distance in centimetres",
  distanceWrong: (min_cm: number, max_cm: number): string => `Please enter a number from ${min_cm} to ${max_cm}.`,
  checking_title: "Checking this screen",
  checking_text: "This takes a few seconds.",
  screen_title: "This screen does not fit yet",
  screened_out_title: "This device cannot show the study",
  screened_out_text: "Thank you for your interest. The clips cannot be shown here as the study needs it:",
  screen_problems: {
    phone: "The study needs a computer; it does not run on a phone.",
    viewport: "The window is too small for the clips.",
    refresh: "The refresh rate of this screen does not suit the clips.",
    codec: "This browser does not play the clips.",
    fullscreen: "The study runs in full screen.",
    calibration: "The size of the screen must be measured with a card.",
    distance: "The distance to the screen is outside of what the study allows.",
    px_per_degree: "From this distance the clips are too large or too small to the eye. Please sit nearer or further away.",
  } as Record<string, string>,

  // Clip
  loading_clip: "Loading the clip",
  press_to_start: "Press to start the clip",
  clip_shown: "The clip is playing. The questions follow.",
  clipNumber: (n: number): string => (n === 1 ? "First clip" : "Second clip"),

  // Questions
  questions_title: "Your impression of the clip",
  questions_title_pair: "Your impression of the two clips",
  keysHint: "You can answer with the number keys.",
  pointName: (point: number, points: number, name: string): string => `${point} of ${points}${name ? `, ${name}` : ""}`,
  sliderEmpty: (low: string, high: string): string => `no answer yet; from ${low} to ${high}`,
  sliderValue: (value: number, min: number, max: number, low: string, high: string): string =>
    value === min ? `${value}, ${low}` : value === max ? `${value}, ${high}` : `${value} of ${max}`,
  optional: "(optional)",
  charsLeft: (n: number): string => `${n} characters left`,
  missing: "Please answer this question.",
  watch_again: "Watch again",
  watchAgainLeft: (n: number): string => `Watch again (${n} left)`,
  next: "Continue",
  progress: "Progress",
  progressText: (done: number, total: number): string => `${done} of ${total} done`,
  progressShort: (done: number, total: number): string => `${done} / ${total}`,
  fullscreen: "Full screen",
  leave_fullscreen: "Leave full screen",

  // Marking a moment
  mark_start: "Play and pause",
  mark_more: "Mark another moment",
  mark_none: "Nothing looked wrong",
  mark_remove: "Remove",
  markAt: (ms: number): string => `at ${(ms / 1000).toFixed(2)} s`,
  mark_hint: "Press the space bar at the moment in question.",
  mark_paused: "Is this the moment? The arrow keys move frame by frame.",
  mark_over: "The clip is over. The arrow keys move back frame by frame.",
  mark_pause: "Pause",
  mark_earlier: "Earlier",
  mark_later: "Later",
  mark_here: "Mark this moment",
  mark_go_on: "Play on",
  mark_again: "Play again",
  mark_back: "Back",

  // Stopping
  stop_here: "Stop here",
  stop_title: "Stop taking part now?",
  stop_text: "Your answers so far are kept, and you get to the last page at once. You cannot go on later.",
  stop_yes: "Stop here",
  stop_no: "Go on",
  stopped_title: "You stopped early",
  stopped_text: "Thank you for the answers you gave. They are stored.",

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
  next_key: "or press N",
  return_to: "Return and finish",
  close_now: "You can close this page now.",
  withdraw_intro: "If you change your mind later, this personal link deletes all your answers. Keep it to yourself:",
  withdraw_button: "Delete my answers now",
  withdraw_title: "Delete all your answers?",
  withdraw_text: "Everything you answered is deleted from the study. This cannot be undone.",
  withdraw_yes: "Delete my answers",
  withdraw_no: "Keep my answers",
  withdrawn_title: "Your answers are deleted",
  withdrawn_text: "The study holds nothing more of your visit. You can close this page now.",
  withdrawal_unknown_title: "There is nothing to delete",
  withdrawal_unknown_text: "This link is not known, or the answers are deleted already.",

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

const LANGUAGES: Record<string, Texts> = { en: english, de: german };

/** The page's words in `language`, or in English where they are not translated. */
export function textsFor(language: string): Texts {
  return LANGUAGES[language.split("-")[0] ?? "en"] ?? english;
}

// SPDX-License-Identifier: MIT
// Plays a loaded clip once, from the first frame to the last, whatever the browser does in between.
import type { Log, Presentation } from "./presentation";
import { ClipProblem } from "./preload";
import type { Stage } from "./stage";

const STUCK_MS = 8_000; // in sight, not waiting for a press, and no frame for this long: give up

export interface Showing {
  video: HTMLVideoElement;
  stage: Stage;
  presentation: Presentation;
  log: Log;
  press_to_start: string;
}

/** Gives the video its bytes and waits until it can play to the end. Throws ClipProblem; never hangs. */
export async function prepareVideo(video: HTMLVideoElement, url: string): Promise<void> {
  video.muted = true; // clips have no sound, and muted videos may start without a press
  video.playsInline = true;
  video.preload = "auto";
  video.disablePictureInPicture = true;
  video.oncontextmenu = (event) => event.preventDefault();
  await new Promise<void>((resolve, reject) => {
    const give_up = setTimeout(() => reject(new ClipProblem("stuck", "the clip was not decoded")), STUCK_MS);
    video.oncanplaythrough = () => {
      clearTimeout(give_up);
      resolve();
    };
    video.onerror = () => {
      clearTimeout(give_up);
      reject(new ClipProblem("not_playable", video.error?.message ?? "unknown format"));
    };
    video.src = url;
    video.load();
  });
}

/** Shows and plays the clip from its start; resolves at its end. Throws ClipProblem. */
export async function playOnce(showing: Showing): Promise<void> {
  const { video, stage, presentation } = showing;
  if (video.currentTime > 0) {
    await new Promise((resolve) => {
      video.addEventListener("seeked", resolve, { once: true });
      video.currentTime = 0;
    });
  }
  stage.showVideo();
  const play = presentation.beginPlay(video);
  try {
    await playToEnd(showing, play.asked);
  } catch (cause) {
    play.end(false);
    throw cause;
  } finally {
    stage.showGrey();
  }
  play.end(true);
}

function playToEnd(showing: Showing, onAsked: () => void): Promise<void> {
  const { video, stage, presentation, log } = showing;
  return new Promise((resolve, reject) => {
    const watch = new AbortController();
    const listen = { signal: watch.signal };
    let is_blocked = false;
    let last_time = -1;
    let last_step_ms = performance.now();

    const finish = (problem: ClipProblem | null): void => {
      watch.abort();
      clearInterval(timer);
      if (problem) reject(problem);
      else resolve();
    };
    const go = (): void => {
      onAsked();
      video.play().catch((cause: DOMException) => {
        if (watch.signal.aborted || cause.name === "AbortError") return; // paused by the browser: resumed below
        if (cause.name !== "NotAllowedError") return finish(new ClipProblem("not_playable", cause.message));
        is_blocked = true;
        log("play_blocked", presentation.id, {});
        stage.showGrey();
        void stage.askToStart(showing.press_to_start).then(() => {
          is_blocked = false;
          last_step_ms = performance.now();
          stage.showVideo();
          go();
        });
      });
    };
    const resume = (): void => {
      if (video.paused && !video.ended && !is_blocked && !document.hidden) go();
    };
    // Media keys and power saving pause videos; a participant has no button to start them again.
    video.addEventListener("pause", resume, listen);
    document.addEventListener("visibilitychange", resume, listen);
    video.addEventListener("ended", () => finish(null), listen);
    video.addEventListener("error", () => {
      finish(new ClipProblem("not_playable", video.error?.message ?? "decoding failed"));
    }, listen);
    const timer = setInterval(() => {
      const now = performance.now();
      const has_moved = video.currentTime !== last_time;
      last_time = video.currentTime;
      if (has_moved || is_blocked || document.hidden) last_step_ms = now;
      else if (now - last_step_ms > STUCK_MS) {
        finish(new ClipProblem("stuck", `no frame for ${STUCK_MS} ms at ${video.currentTime} s`));
      }
    }, 250);
    go();
  });
}

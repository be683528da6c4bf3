// SPDX-License-Identifier: MIT
// Plays loaded clips once, from the first frame to the last, whatever the browser does in between.
import type { Log, PlayKind } from "./clip_evidence";
import type { Presentation } from "./presentation";
import { ClipProblem } from "./preload";
import type { Stage } from "./stage";

const STUCK_MS = 8_000; // in sight, not waiting for a press, and no frame for this long: give up

export interface Showing {
  videos: HTMLVideoElement[];
  stage: Stage;
  presentation: Presentation;
  log: Log;
  press_to_start: string;
}

export function makeVideo(): HTMLVideoElement {
  const video = document.createElement("video");
  video.muted = true; // clips have no sound, and muted videos may start without a press
  video.playsInline = true;
  video.preload = "auto";
  video.disablePictureInPicture = true;
  video.oncontextmenu = (event) => event.preventDefault();
  return video;
}

/** Gives the video its bytes and waits until it can play to the end. Throws ClipProblem; never hangs. */
export async function prepareVideo(video: HTMLVideoElement, url: string): Promise<void> {
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

/** Shows and plays the clips at `positions` together from their start; resolves at the end of the last. Throws ClipProblem. */
export async function playOnce(showing: Showing, positions: number[]): Promise<void> {
  const videos = positions.map((position) => showing.videos[position] as HTMLVideoElement);
  await Promise.all(videos.map(rewind));
  showing.stage.showVideos(videos);
  const plays = beginPlays(showing, positions, "show");
  try {
    await playToEnd(showing, videos, () => plays.forEach((play) => play.asked()), (i) => plays[i]?.end(true));
  } catch (cause) {
    videos.forEach((video, i) => {
      if (!video.ended) plays[i]?.end(false);
    });
    throw cause;
  } finally {
    showing.stage.showGrey();
  }
}

export function beginPlays({ presentation, videos }: Showing, positions: number[], kind: PlayKind) {
  return positions.flatMap((i) => {
    const video = videos[i];
    return video ? (presentation.clips[i]?.beginPlay(video, kind) ?? []) : [];
  });
}

export async function rewind(video: HTMLVideoElement): Promise<void> {
  if (video.currentTime === 0) return;
  await new Promise((resolve) => {
    video.addEventListener("seeked", resolve, { once: true });
    video.currentTime = 0;
  });
}

function playToEnd(
  showing: Showing,
  videos: HTMLVideoElement[],
  onAsked: () => void,
  onEnded: (i: number) => void,
): Promise<void> {
  const { stage, presentation, log } = showing;
  return new Promise((resolve, reject) => {
    const watch = new AbortController();
    const listen = { signal: watch.signal };
    const over = new Set<number>(); // ended, and told so: the attribute is true before the event comes
    let is_blocked = false;
    let last_times = "";
    let last_step_ms = performance.now();

    const finish = (problem: ClipProblem | null): void => {
      watch.abort();
      clearInterval(timer);
      if (problem) reject(problem);
      else resolve();
    };
    const onRefused = (cause: DOMException): void => {
      if (watch.signal.aborted || is_blocked || cause.name === "AbortError") return; // paused by the browser: resumed below
      if (cause.name !== "NotAllowedError") return finish(new ClipProblem("not_playable", cause.message));
      is_blocked = true;
      log("play_blocked", presentation.id, {});
      stage.showGrey();
      void stage.askToStart(showing.press_to_start).then(() => {
        is_blocked = false;
        last_step_ms = performance.now();
        stage.showVideos(videos);
        go();
      });
    };
    const go = (): void => {
      onAsked();
      // In one turn of the event loop, so that clips side by side begin with the same frame of the screen.
      for (const video of videos) if (!video.ended) video.play().catch(onRefused);
    };
    const resume = (): void => {
      if (is_blocked || document.hidden) return;
      for (const video of videos) if (video.paused && !video.ended) video.play().catch(onRefused);
    };
    document.addEventListener("visibilitychange", resume, listen);
    videos.forEach((video, i) => {
      // Media keys and power saving pause videos; a participant has no button to start them again.
      video.addEventListener("pause", resume, listen);
      video.addEventListener("ended", () => {
        onEnded(i);
        over.add(i);
        if (over.size === videos.length) finish(null);
      }, listen);
      video.addEventListener("error", () => {
        finish(new ClipProblem("not_playable", video.error?.message ?? "decoding failed"));
      }, listen);
    });
    const timer = setInterval(() => {
      const now = performance.now();
      const times = videos.map(({ currentTime }) => currentTime).join(" ");
      const has_moved = times !== last_times;
      last_times = times;
      if (has_moved || is_blocked || document.hidden) last_step_ms = now;
      else if (now - last_step_ms > STUCK_MS) {
        finish(new ClipProblem("stuck", `no frame for ${STUCK_MS} ms at ${times} s`));
      }
    }, 250);
    if (document.hidden) go(); // no frames come while the page is out of sight
    else requestAnimationFrame(go);
  });
}

// SPDX-License-Identifier: MIT
// The evidence of one showing: when frames came, how many were lost, stalls, and time out of sight.
import type { PresentationRecord } from "./contract";

type Detail = Record<string, string | number | boolean | null>;
export type Log = (kind: string, presentation_id: string | null, detail: Detail) => void;

/** The watch over one play. */
export interface Play {
  /** play() is called now. */
  asked(): void;
  /** The play is over; is_full: it ran from the first to the last frame. */
  end(is_full: boolean): void;
}

export class Presentation {
  readonly id = crypto.randomUUID();
  private num_plays = 0;
  private onset_ms: number | null = null;
  private first_frame_ms: number | null = null;
  private first_end_ms: number | null = null;
  private frames_total: number | null = null;
  private frames_dropped: number | null = null;
  private stall_count = 0;
  private stall_ms = 0;
  private hidden_ms = 0;
  private was_fullscreen = true;
  private displayed: [number, number] = [0, 0];

  constructor(private readonly log: Log) {}

  /** End of the first full play, the origin of response times (ms on the page's clock). */
  get ended_ms(): number | null {
    return this.first_end_ms;
  }

  setDisplayed(width_px: number, height_px: number): void {
    this.displayed = [width_px, height_px];
  }

  /** Watches one play of the video, from now until its end() is called. */
  beginPlay(video: HTMLVideoElement): Play {
    this.num_plays += 1;
    const play = this.num_plays;
    const watch = new AbortController();
    const listen = { signal: watch.signal };
    let asked_ms = performance.now();
    let num_callbacks = 0;
    let has_started = false;
    let stalled_since: number | null = null;
    let hidden_since: number | null = document.hidden ? asked_ms : null;
    if (!document.fullscreenElement) this.was_fullscreen = false;

    const start = (shown_ms: number, is_frame: boolean): void => {
      if (has_started) return;
      has_started = true;
      if (play > 1) return;
      this.onset_ms = shown_ms;
      // The first frame may stand on the screen already when play() is called.
      this.first_frame_ms = is_frame ? Math.max(0, shown_ms - asked_ms) : null;
    };
    const endStall = (): void => {
      if (stalled_since === null) return;
      const ms = performance.now() - stalled_since;
      stalled_since = null;
      this.stall_ms += ms;
      this.log("stall", this.id, { play, ms });
    };
    const endHidden = (): void => {
      if (hidden_since === null) return;
      const ms = performance.now() - hidden_since;
      hidden_since = null;
      this.hidden_ms += ms;
      this.log("hidden", this.id, { play, ms });
    };

    if ("requestVideoFrameCallback" in video) {
      const onFrame = (_now: number, frame: VideoFrameCallbackMetadata): void => {
        num_callbacks += 1;
        start(frame.presentationTime, true);
        if (!watch.signal.aborted) video.requestVideoFrameCallback(onFrame);
      };
      video.requestVideoFrameCallback(onFrame);
    } else {
      // Browsers without the callback: the event tells the onset to within a frame or two; first_frame_ms stays empty.
      (video as HTMLVideoElement).addEventListener("playing", () => start(performance.now(), false), listen);
    }
    video.addEventListener("playing", endStall, listen);
    video.addEventListener("waiting", () => {
      if (!has_started || video.ended || stalled_since !== null) return;
      this.stall_count += 1;
      stalled_since = performance.now();
    }, listen);
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) hidden_since ??= performance.now();
      else endHidden();
    }, listen);
    document.addEventListener("fullscreenchange", () => {
      if (!document.fullscreenElement) this.was_fullscreen = false;
    }, listen);

    const end = (is_full: boolean): void => {
      const ended_ms = performance.now();
      watch.abort();
      endStall();
      endHidden();
      if (is_full) this.first_end_ms ??= ended_ms;
      const after = video.getVideoPlaybackQuality();
      // The browser counts from the load of the clip; frames decoded ahead of the play belong to it.
      const total = after.totalVideoFrames - (this.frames_total ?? 0);
      const dropped = after.droppedVideoFrames - (this.frames_dropped ?? 0);
      this.frames_total = after.totalVideoFrames;
      this.frames_dropped = after.droppedVideoFrames;
      this.log(is_full ? "play_ended" : "play_broken_off", this.id, {
        play,
        frames_total: total,
        frames_dropped: dropped,
        frame_callbacks: num_callbacks,
        media_time_s: video.currentTime,
      });
    };
    const asked = (): void => {
      asked_ms = performance.now();
    };
    return { asked, end };
  }

  record(completed: boolean): PresentationRecord {
    return {
      presentation_id: this.id,
      num_plays: this.num_plays,
      onset_ms: this.onset_ms,
      first_frame_ms: this.first_frame_ms,
      ended_ms: this.first_end_ms,
      frames_total: this.frames_total,
      frames_dropped: this.frames_dropped,
      stall_count: this.stall_count,
      stall_ms: this.stall_ms,
      hidden_ms: this.hidden_ms,
      fullscreen: this.num_plays > 0 && this.was_fullscreen,
      displayed_w: this.displayed[0],
      displayed_h: this.displayed[1],
      completed,
    };
  }
}

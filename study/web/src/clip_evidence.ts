// SPDX-License-Identifier: MIT
// The evidence of one clip: when its frames came, how many were lost, and stalls.
import type { Clip, ClipRecord } from "./contract";

type Detail = Record<string, string | number | boolean | null>;
export type Log = (kind: string, presentation_id: string | null, detail: Detail) => void;
export type PlayKind = "show" | "mark";

/** The watch over one play. */
export interface Play {
  /** play() is called now. */
  asked(): void;
  /** The play is over; is_full: it ran from the first to the last frame. */
  end(is_full: boolean): void;
}

export class ClipEvidence {
  num_plays = 0;
  num_mark_plays = 0;
  onset_ms: number | null = null;
  ended_ms: number | null = null;
  private first_frame_ms: number | null = null;
  private frames_total: number | null = null;
  private frames_dropped: number | null = null;
  private frames_counted: [total: number, dropped: number] = [0, 0];
  private stall_count = 0;
  private stall_ms = 0;

  constructor(
    readonly clip: Clip,
    readonly position: number,
    private readonly presentation_id: string,
    private readonly log: Log,
  ) {}

  /** Watches one play of the video, from now until its end() is called. Plays for a mark are only counted and logged. */
  beginPlay(video: HTMLVideoElement, kind: PlayKind): Play {
    if (kind === "show") this.num_plays += 1;
    else this.num_mark_plays += 1;
    const play = kind === "show" ? this.num_plays : this.num_mark_plays;
    const about = { position: this.position, kind, play };
    const watch = new AbortController();
    const listen = { signal: watch.signal };
    let asked_ms = performance.now();
    let num_callbacks = 0;
    let has_started = false;
    let stalled_since: number | null = null;

    const start = (shown_ms: number, is_frame: boolean): void => {
      if (has_started) return;
      has_started = true;
      if (kind === "mark" || play > 1) return;
      this.onset_ms = shown_ms;
      // The first frame may stand on the screen already when play() is called.
      this.first_frame_ms = is_frame ? Math.max(0, shown_ms - asked_ms) : null;
    };
    const endStall = (): void => {
      if (stalled_since === null) return;
      const ms = performance.now() - stalled_since;
      stalled_since = null;
      if (kind === "show") this.stall_ms += ms;
      this.log("stall", this.presentation_id, { ...about, ms });
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
      if (kind === "show") this.stall_count += 1;
      stalled_since = performance.now();
    }, listen);

    return {
      asked: () => {
        asked_ms = performance.now();
      },
      end: (is_full) => {
        const now = performance.now();
        watch.abort();
        endStall();
        if (is_full && kind === "show") this.ended_ms ??= now;
        const frames = this.countFrames(video, kind);
        this.log(is_full ? "play_ended" : "play_broken_off", this.presentation_id, {
          ...about,
          ...frames,
          frame_callbacks: num_callbacks,
          media_time_s: video.currentTime,
        });
      },
    };
  }

  record(): ClipRecord {
    return {
      position: this.position,
      sha256: this.clip.sha256,
      num_plays: this.num_plays,
      onset_ms: this.onset_ms,
      first_frame_ms: this.first_frame_ms,
      ended_ms: this.ended_ms,
      frames_total: this.frames_total,
      frames_dropped: this.frames_dropped,
      stall_count: this.stall_count,
      stall_ms: this.stall_ms,
    };
  }

  /** The browser counts from the load of the clip; frames decoded ahead of a play belong to it. */
  private countFrames(video: HTMLVideoElement, kind: PlayKind): { frames_total: number; frames_dropped: number } {
    const { totalVideoFrames, droppedVideoFrames } = video.getVideoPlaybackQuality();
    const frames_total = totalVideoFrames - this.frames_counted[0];
    const frames_dropped = droppedVideoFrames - this.frames_counted[1];
    this.frames_counted = [totalVideoFrames, droppedVideoFrames];
    if (kind === "show") {
      this.frames_total = (this.frames_total ?? 0) + frames_total;
      this.frames_dropped = (this.frames_dropped ?? 0) + frames_dropped;
    }
    return { frames_total, frames_dropped };
  }
}

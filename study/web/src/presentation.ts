// SPDX-License-Identifier: MIT
// The evidence of one showing of a trial: its clips, and what happened to the page while they were shown.
import { ClipEvidence, type Log } from "./clip_evidence";
import type { Clip, Layout, PresentationRecord } from "./contract";
import type { ShownSize } from "./stage";

export class Presentation {
  readonly id = crypto.randomUUID();
  readonly clips: ClipEvidence[];
  private hidden_ms = 0;
  private blur_count = 0;
  private fullscreen_exits = 0;
  private was_fullscreen = true;
  private displayed: ShownSize = { scale: 0, width_px: 0, height_px: 0 };

  constructor(
    clips: Clip[],
    private readonly layout: Layout,
    private readonly log: Log,
  ) {
    this.clips = clips.map((clip, position) => new ClipEvidence(clip, position, this.id, log));
  }

  /** End of the last clip's first full play, the origin of response times (ms on the page's clock). */
  get ended_ms(): number | null {
    const ends = this.clips.map(({ ended_ms }) => ended_ms);
    return ends.includes(null) ? null : Math.max(...(ends as number[]));
  }

  get onset_ms(): number | null {
    const onsets = this.clips.flatMap(({ onset_ms }) => onset_ms ?? []);
    return onsets.length ? Math.min(...onsets) : null;
  }

  setDisplayed(size: ShownSize): void {
    this.displayed = size;
  }

  /** Watches the page while clips are shown, until the returned function is called. */
  watchPage(): () => void {
    const watch = new AbortController();
    const listen = { signal: watch.signal };
    let hidden_since: number | null = document.hidden ? performance.now() : null;
    if (!document.fullscreenElement) this.was_fullscreen = false;
    const endHidden = (): void => {
      if (hidden_since === null) return;
      const ms = performance.now() - hidden_since;
      hidden_since = null;
      this.hidden_ms += ms;
      this.log("hidden", this.id, { ms });
    };
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) hidden_since ??= performance.now();
      else endHidden();
    }, listen);
    window.addEventListener("blur", () => {
      this.blur_count += 1;
      this.log("blur", this.id, {});
    }, listen);
    document.addEventListener("fullscreenchange", () => {
      if (document.fullscreenElement) return;
      this.was_fullscreen = false;
      this.fullscreen_exits += 1;
      this.log("fullscreen_left", this.id, {});
    }, listen);
    return () => {
      watch.abort();
      endHidden();
    };
  }

  record(completed: boolean): PresentationRecord {
    const clips = this.clips.map((clip) => clip.record());
    const [first, second] = clips;
    if (!first) throw new Error("a showing without a clip");
    const sum = (values: (number | null)[]): number | null =>
      values.includes(null) ? null : (values as number[]).reduce((a, b) => a + b, 0);
    const is_pair = this.layout === "side_by_side" && second && second.onset_ms !== null && first.onset_ms !== null;
    const { scale, width_px, height_px } = this.displayed;
    return {
      presentation_id: this.id,
      num_plays: Math.max(...clips.map(({ num_plays }) => num_plays)),
      onset_ms: this.onset_ms,
      first_frame_ms: first.first_frame_ms,
      ended_ms: this.ended_ms,
      frames_total: sum(clips.map(({ frames_total }) => frames_total)),
      frames_dropped: sum(clips.map(({ frames_dropped }) => frames_dropped)),
      stall_count: clips.reduce((count, { stall_count }) => count + stall_count, 0),
      stall_ms: clips.reduce((ms, { stall_ms }) => ms + stall_ms, 0),
      hidden_ms: this.hidden_ms,
      blur_count: this.blur_count,
      fullscreen: first.num_plays > 0 && this.was_fullscreen,
      fullscreen_exits: this.fullscreen_exits,
      displayed_w: width_px,
      displayed_h: height_px,
      device_pixel_ratio: window.devicePixelRatio,
      scale: Number.isInteger(scale) && scale > 0 ? scale : null,
      num_mark_plays: Math.max(...this.clips.map(({ num_mark_plays }) => num_mark_plays)),
      start_skew_ms: is_pair ? (second.onset_ms as number) - (first.onset_ms as number) : null,
      completed,
      clips,
    };
  }
}

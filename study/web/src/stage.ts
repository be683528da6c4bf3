// SPDX-License-Identifier: MIT
// The grey field that covers the whole window while clips are shown: fixation cross, clips at their true pixels, grey.
import type { Clip, Layout } from "./contract";
import { make } from "./field";

export interface ShownSize {
  scale: number; // device pixels of the screen per pixel of the clip
  width_px: number; // device pixels
  height_px: number;
}

const PAIR_GAP_CSS_PX = 32; // grey between two clips side by side, less where they would not fit unscaled with it

/**
 * Size at which a clip is shown: the largest whole multiple of its own pixels that fits the room, so that no pixel is
 * interpolated unevenly; a clip larger than the room is scaled down until it fits.
 * All lengths in device pixels.
 */
export function fitClip(clip_w: number, clip_h: number, room_w: number, room_h: number): ShownSize {
  const room = Math.min(room_w / clip_w, room_h / clip_h);
  const scale = room >= 1 ? Math.floor(room) : room;
  return { scale, width_px: Math.round(clip_w * scale), height_px: Math.round(clip_h * scale) };
}

export class Stage {
  private readonly element = make("div", "stage");
  private readonly cross = make("div", "cross");
  private readonly caption = make("p", "stage-caption");
  private readonly loading = make("div", "loading");
  private room_below = 0; // CSS pixels
  private readonly onResize = (): void => this.place();

  constructor(
    private readonly videos: HTMLVideoElement[],
    private readonly clips: Clip[],
    private readonly layout: Layout,
    private readonly onPlaced: (size: ShownSize) => void,
    texts: { loading_clip: string; clip_shown: string },
  ) {
    for (const video of videos) video.setAttribute("aria-label", texts.clip_shown);
    this.loading.setAttribute("role", "progressbar");
    this.loading.setAttribute("aria-label", texts.loading_clip);
    this.loading.append(make("span", "", texts.loading_clip), make("i"));
    this.element.append(this.cross, this.caption, this.loading, ...videos);
    this.showGrey();
  }

  open(parent: HTMLElement): void {
    parent.append(this.element);
    document.documentElement.classList.add("has-stage");
    window.addEventListener("resize", this.onResize);
    this.place();
  }

  close(): void {
    window.removeEventListener("resize", this.onResize);
    document.documentElement.classList.remove("has-stage");
    this.element.remove();
  }

  showGrey(): void {
    this.show([]);
  }

  /** words: which clip of a pair comes next, under the cross. */
  showCross(words = ""): void {
    this.caption.textContent = words;
    this.show([this.cross, this.caption]);
  }

  showVideos(videos: HTMLVideoElement[]): void {
    this.show(videos);
  }

  /** share: of the clips' bytes, 0 to 1. Becomes visible after a moment only, see app.css. */
  showLoading(share: number): void {
    this.show([this.loading]);
    this.loading.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    this.loading.style.setProperty("--share", `${100 * share}%`);
  }

  private show(parts: HTMLElement[]): void {
    for (const other of [this.cross, this.caption, this.loading, ...this.videos]) {
      other.style.visibility = parts.includes(other) ? "visible" : "hidden";
    }
  }

  /** Keeps room for controls under the clip; the clip may get smaller for that, which is no showing to be recorded. */
  leaveRoomBelow(css_px: number): void {
    this.room_below = css_px;
    this.place();
  }

  /** Puts controls over the lower edge of the field, until the returned function is called. */
  addControls(controls: HTMLElement): () => void {
    this.element.append(controls);
    this.element.classList.add("has-controls");
    return () => {
      controls.remove();
      this.element.classList.remove("has-controls");
    };
  }

  /** Puts a button in the middle and resolves when it is pressed. */
  async askToStart(text: string): Promise<void> {
    const button = make("button", "button primary stage-button", text);
    button.type = "button";
    const remove = this.addControls(button);
    button.focus();
    await new Promise((resolve) => button.addEventListener("click", resolve, { once: true }));
    remove();
  }

  /** Sizes and centres the clips for the window as it is now; a pair side by side shares one scale. */
  place(): void {
    const [first] = this.clips;
    if (!first) return;
    const ratio = window.devicePixelRatio;
    const room_w = Math.floor(window.innerWidth * ratio);
    const room_h = Math.floor((window.innerHeight - this.room_below) * ratio);
    const is_pair = this.layout === "side_by_side";
    const usual_gap = is_pair ? Math.round(PAIR_GAP_CSS_PX * ratio) : 0;
    const fit = (gap: number): ShownSize =>
      fitClip(first.width_px, first.height_px, is_pair ? Math.floor((room_w - gap) / 2) : room_w, room_h);
    const is_tight = fit(usual_gap).scale < 1 && fit(0).scale >= 1;
    const size = fit(is_tight ? 0 : usual_gap);
    const gap = is_tight ? room_w - 2 * size.width_px : usual_gap;
    const left = Math.floor((room_w - (is_pair ? 2 * size.width_px + gap : size.width_px)) / 2);
    this.videos.forEach(({ style }, i) => {
      style.width = `${size.width_px / ratio}px`;
      style.height = `${size.height_px / ratio}px`;
      style.left = `${(left + (is_pair ? i * (size.width_px + gap) : 0)) / ratio}px`; // on whole device pixels
      style.top = `${Math.floor((room_h - size.height_px) / 2) / ratio}px`;
    });
    if (!this.room_below) this.onPlaced(size);
  }
}

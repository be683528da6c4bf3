// SPDX-License-Identifier: MIT
// The grey field that covers the whole window while a clip is shown: fixation cross, the clip at its true pixels, grey.
import type { Clip } from "./contract";
import { make } from "./field";

export interface ShownSize {
  scale: number; // device pixels of the screen per pixel of the clip
  width_px: number; // device pixels
  height_px: number;
}

/**
 * Size at which a clip is shown: the largest whole multiple of its own pixels that fits the window, so that no pixel is
 * interpolated unevenly; a clip larger than the window is scaled down until it fits.
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
  private readonly loading = make("div", "loading");
  private clip: Clip | null = null;
  private readonly onResize = (): void => this.place();

  constructor(
    private readonly video: HTMLVideoElement,
    private readonly onPlaced: (size: ShownSize) => void,
    texts: { loading_clip: string; clip_shown: string },
  ) {
    this.video.setAttribute("aria-label", texts.clip_shown);
    this.loading.setAttribute("role", "progressbar");
    this.loading.setAttribute("aria-label", texts.loading_clip);
    this.loading.append(make("span", "", texts.loading_clip), make("i"));
    this.element.append(this.cross, this.loading, video);
    this.showGrey();
  }

  open(parent: HTMLElement, clip: Clip): void {
    this.clip = clip;
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
    this.show(null);
  }

  showCross(): void {
    this.show(this.cross);
  }

  showVideo(): void {
    this.show(this.video);
  }

  /** share: of the clip's bytes, 0 to 1. Becomes visible after a moment only, see app.css. */
  showLoading(share: number): void {
    this.show(this.loading);
    this.loading.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    this.loading.style.setProperty("--share", `${100 * share}%`);
  }

  private show(part: HTMLElement | null): void {
    for (const other of [this.cross, this.loading, this.video]) {
      other.style.visibility = other === part ? "visible" : "hidden";
    }
  }

  /** Puts a button in the middle and resolves when it is pressed. */
  async askToStart(text: string): Promise<void> {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "button primary stage-button";
    button.textContent = text;
    this.element.append(button);
    button.focus();
    await new Promise((resolve) => button.addEventListener("click", resolve, { once: true }));
    button.remove();
  }

  /** Sizes and centres the clip for the window as it is now. */
  place(): void {
    if (!this.clip) return;
    const ratio = window.devicePixelRatio;
    const room_w = Math.floor(window.innerWidth * ratio);
    const room_h = Math.floor(window.innerHeight * ratio);
    const size = fitClip(this.clip.width_px, this.clip.height_px, room_w, room_h);
    const { style } = this.video;
    style.width = `${size.width_px / ratio}px`;
    style.height = `${size.height_px / ratio}px`;
    style.left = `${Math.floor((room_w - size.width_px) / 2) / ratio}px`; // on whole device pixels
    style.top = `${Math.floor((room_h - size.height_px) / 2) / ratio}px`;
    this.onPlaced(size);
  }
}

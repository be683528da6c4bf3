// SPDX-License-Identifier: MIT
// Plays the clip again until the participant pauses it, lets them move frame by frame, and returns the time they mark.
import { make } from "./field";
import { type Showing, beginPlays, rewind } from "./play";
import type { Texts } from "./texts";

/** Time in the clip (ms), or null where the participant goes back without a mark. */
export async function playForMark(showing: Showing, texts: Texts): Promise<number | null> {
  const { stage } = showing;
  const [video] = showing.videos;
  const clip = showing.presentation.clips[0]?.clip;
  if (!video || !clip) return null;
  const frame_s = 1 / clip.frame_rate_hz;
  const panel = make("div", "stage-panel");
  const hint = make("p", "", texts.mark_hint);
  hint.setAttribute("role", "status");
  const button = (words: string, look: string, onPress: () => void): HTMLButtonElement => {
    const made = make("button", `button ${look}`, words);
    made.type = "button";
    made.addEventListener("click", onPress);
    return made;
  };
  const watch = new AbortController();

  return new Promise((resolve, reject) => {
    let play: ReturnType<typeof beginPlays>[number] | undefined;
    const finish = (time_ms: number | null): void => {
      watch.abort();
      play?.end(video.ended);
      play = undefined;
      video.pause();
      remove();
      stage.showGrey();
      resolve(time_ms);
    };
    const run = async (): Promise<void> => {
      if (!play || video.ended) await rewind(video);
      if (watch.signal.aborted) return; // they went back meanwhile
      stage.showVideos([video]);
      hint.textContent = texts.mark_hint;
      panel.replaceChildren(hint, button(texts.mark_pause, "primary", pause));
      panel.querySelector("button")?.focus();
      play ??= beginPlays(showing, [0], "mark")[0];
      play?.asked();
      await video.play().catch(() => onPaused());
    };
    const begin = (): void => void run().catch(reject);
    const pause = (): void => video.pause(); // its event shows the buttons
    const onPaused = (): void => {
      if (watch.signal.aborted) return;
      const is_over = video.ended;
      hint.textContent = is_over ? texts.mark_over : texts.mark_paused;
      panel.replaceChildren(
        hint,
        button(texts.mark_earlier, "", () => step(-1)),
        button(texts.mark_later, "", () => step(1)),
        button(texts.mark_here, "primary", () => finish(Math.min(1000 * video.currentTime, 1000 * clip.duration_s))),
        button(is_over ? texts.mark_again : texts.mark_go_on, "", () => begin()),
        button(texts.mark_back, "", () => finish(null)),
      );
      panel.querySelector<HTMLElement>(".primary")?.focus();
    };
    const step = (num_frames: number): void => {
      video.currentTime = Math.max(0, Math.min(clip.duration_s - frame_s / 2, video.currentTime + num_frames * frame_s));
    };
    const remove = stage.addControls(panel);
    const listen = { signal: watch.signal };
    video.addEventListener("pause", onPaused, listen); // also at the end
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Escape") finish(null);
      else if (event.key === " " && !video.paused) video.pause();
      else if (event.key === "ArrowLeft" && video.paused) step(-1);
      else if (event.key === "ArrowRight" && video.paused) step(1);
      else return;
      event.preventDefault();
    }, listen);
    begin();
  });
}

// SPDX-License-Identifier: MIT
// Plays a clip of the study, tiny and muted, to see whether this browser decodes it.
import type { Clip } from "./contract";
import { makeVideo, prepareVideo } from "./play";
import { ClipProblem, loadClips } from "./preload";

const SILENCE_MS = 10_000;

/** True when pictures came, false when the browser cannot, null when the clip could not be fetched. */
export async function probeCodec(mime: string, probe: Clip, display: HTMLElement): Promise<boolean | null> {
  const video = makeVideo();
  if (!video.canPlayType(mime)) return false;
  let urls: string[];
  try {
    urls = await loadClips([probe], SILENCE_MS, false, () => undefined);
  } catch {
    return null;
  }
  video.className = "probe";
  video.setAttribute("aria-hidden", "true");
  display.append(video);
  try {
    await prepareVideo(video, urls[0] ?? "");
    await video.play();
    await new Promise<void>((resolve, reject) => {
      video.addEventListener("error", () => reject(video.error), { once: true });
      const give_up = setTimeout(() => reject(new Error("no picture came")), 1000 * probe.duration_s + 5_000);
      video.addEventListener("ended", () => {
        clearTimeout(give_up);
        resolve();
      }, { once: true });
    });
    return video.getVideoPlaybackQuality().totalVideoFrames > 0;
  } catch (cause) {
    // A browser that wants a press before it plays is asked for one at the first clip.
    if (cause instanceof DOMException && cause.name === "NotAllowedError") return true;
    return cause instanceof ClipProblem && cause.failure === "stuck" ? null : false;
  } finally {
    video.remove();
    video.removeAttribute("src");
    video.load();
    for (const url of urls) URL.revokeObjectURL(url);
  }
}

// SPDX-License-Identifier: MIT
// Fetches a whole clip before it is shown and proves that it is the clip the study means.
import type { Clip } from "./contract";

export type ClipFailure = "status" | "no_bytes" | "wrong_bytes" | "not_playable" | "stuck";

/** A clip that cannot be shown. `detail` is for the experimenter. */
export class ClipProblem extends Error {
  constructor(
    readonly failure: ClipFailure,
    readonly detail: string,
  ) {
    super(`${failure}: ${detail}`);
    this.name = "ClipProblem";
  }
}

/** Addresses of the clips' bytes in memory, to be revoked by the caller. Throws ClipProblem; never hangs. */
export async function loadClips(
  clips: Clip[],
  silence_ms: number,
  fresh: boolean,
  onProgress: (share: number) => void,
): Promise<string[]> {
  const blobs: Blob[] = [];
  for (const [i, clip] of clips.entries()) {
    blobs.push(await loadClip(clip, silence_ms, fresh, (share) => onProgress((i + share) / clips.length)));
  }
  return blobs.map((blob) => URL.createObjectURL(blob));
}

/**
 * The clip's bytes, checked for status, size and sha256.
 *
 * silence_ms: gives up after this long without a new byte; a slow line that still delivers is waited for.
 * Throws ClipProblem; never hangs.
 */
async function loadClip(
  clip: Clip,
  silence_ms: number,
  fresh: boolean,
  onProgress: (share: number) => void,
): Promise<Blob> {
  const silence = new AbortController();
  let timer = setTimeout(() => silence.abort(), silence_ms);
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let num_bytes = 0;
  try {
    const response = await fetch(clip.url, { signal: silence.signal, cache: fresh ? "reload" : "default" });
    if (!response.ok) throw new ClipProblem("status", `${response.status} for ${clip.url}`);
    if (!response.body) throw new ClipProblem("no_bytes", `no body for ${clip.url}`);
    const reader = response.body.getReader();
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      clearTimeout(timer);
      timer = setTimeout(() => silence.abort(), silence_ms);
      parts.push(value);
      num_bytes += value.length;
      onProgress(Math.min(1, num_bytes / clip.num_bytes));
      if (num_bytes > clip.num_bytes) break; // already wrong: do not fill the memory
    }
    if (num_bytes > clip.num_bytes) void reader.cancel();
  } catch (cause) {
    if (cause instanceof ClipProblem) throw cause;
    throw new ClipProblem("no_bytes", `${clip.url}: ${silence.signal.aborted ? `silent for ${silence_ms} ms` : cause}`);
  } finally {
    clearTimeout(timer);
  }
  if (num_bytes !== clip.num_bytes) {
    throw new ClipProblem("wrong_bytes", `${clip.url}: ${num_bytes} bytes, expected ${clip.num_bytes}`);
  }
  const blob = new Blob(parts, { type: "video/mp4" });
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", await blob.arrayBuffer()));
  const sha256 = Array.from(digest, (byte) => byte.toString(16).padStart(2, "0")).join("");
  if (sha256 !== clip.sha256) throw new ClipProblem("wrong_bytes", `${clip.url}: sha256 ${sha256}`);
  return blob;
}
